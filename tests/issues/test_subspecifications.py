"""Issue 164: a sub-specification changes no result, in no mode, however often it is used, pastified or not."""

from __future__ import annotations

import pytest

import rtamt

XS = [0.0, 6.0, 0.0, 0.0, 4.0, 6.0, 1.0, 0.0]
YS = [0.0, 0.0, 0.0, 6.0, 0.0, 0.0, 4.0, 0.0]
TIMES = list(range(len(XS)))

PAST = (
    "historically[0:3]((x >= 3) -> once[0:2](y >= 3)) and once[1:1](once[0:2](y >= 3))",
    "premise = x >= 3; seen = once[0:2](y >= 3); unused = once(x - y);"
    "historically[0:3](premise -> seen) and once[1:1](seen)",
)
FUTURE = (
    "always[0:3]((x >= 3) -> eventually[0:2](y >= 3)) and once[1:1](eventually[0:2](y >= 3))",
    "premise = x >= 3; answered = eventually[0:2](y >= 3); unused = eventually[0:4](x - y);"
    "always[0:3](premise -> answered) and once[1:1](answered)",
)


def pairs(values):
    return [[t, v] for t, v in zip(TIMES, values, strict=True)]


def discrete_offline(spec):
    return [value for _, value in spec.evaluate({"time": TIMES, "x": XS, "y": YS})]


def discrete_online(spec):
    return [spec.update(t, [("x", x), ("y", y)]) for t, x, y in zip(TIMES, XS, YS, strict=True)]


def dense_offline(spec):
    return spec.evaluate(["x", pairs(XS)], ["y", pairs(YS)])


def dense_online(spec):
    updates = zip(pairs(XS), pairs(YS), strict=True)
    return [point for x, y in updates for point in spec.update(["x", [x]], ["y", [y]])]


MODES = {
    "discrete offline": (rtamt.StlDiscreteTimeSpecification, discrete_offline),
    "discrete online": (rtamt.StlDiscreteTimeSpecification, discrete_online),
    "dense offline": (rtamt.StlDenseTimeSpecification, dense_offline),
    "dense online": (rtamt.StlDenseTimeSpecification, dense_online),
}


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize(
    ("texts", "pastified"), [(PAST, False), (PAST, True), (FUTURE, False), (FUTURE, True)]
)
def test_issue_164_a_stateful_subspecification_changes_no_result(mode, texts, pastified):
    make, run = MODES[mode]
    if "online" in mode and texts is FUTURE and not pastified:
        return  # refused, whole or in parts
    answers = []
    for text in texts:
        spec = make()
        for name in ("x", "y", "premise", "seen", "answered", "unused"):
            spec.declare_var(name, "float")
        spec.spec = text
        spec.parse()
        if pastified:
            spec.pastify()
        answers.append(run(spec))
    assert answers[0] == answers[1]
    assert len(set(map(str, answers[0]))) > 2, "something happens"


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize("texts", [PAST, FUTURE])
def test_in_the_modern_face_neither_named_nor_watched_subspecifications_change_a_result(time, texts):
    told = []
    for text, watch in ((texts[0], ()), (texts[1], ()), (texts[1], ("premise", "unused"))):
        *parts, last = text.split(";")
        required = ";".join([*parts, f"require it: {last}"])
        monitor = rtamt.parse(required).monitor(time=time, watch=watch)
        updates = [repr(monitor.update(t, x=x, y=y)) for t, x, y in zip(TIMES, XS, YS, strict=True)]
        told.append([*updates, repr(monitor.finish())])
    assert told[0] == told[1] == told[2]
