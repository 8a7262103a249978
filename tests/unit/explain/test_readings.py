"""Of numbers over time, the samples that matter: worked by hand, an example or more an operator."""

import pytest

import rtamt

X = [5, 4, 3, 2, -1, 6, 7]
Y = [-1, -2, -3, 4, -2, 5, -6]

# Formula, instant, (signal, start, end) of what the only cause reads, and of what the critical value comes from.
DISCRETE = [
    ("delay[2](x) >= 3", 4, [("x", 2, 2)], [("x", 2, 2)]),
    ("delay[3](x) >= 3", 1, [("x", 0, 0)], [("x", 0, 0)]),
    ("delay[3](x, y) >= 3", 1, [("y", 1, 1)], [("y", 1, 1)]),
    ("ahead[2](x) >= 3", 1, [("x", 3, 3)], [("x", 3, 3)]),
    ("ahead[2](x) >= 3", 6, [("x", 6, 6)], [("x", 6, 6)]),
    ("diff[2](x) >= 3", 4, [("x", 2, 2), ("x", 4, 4)], [("x", 2, 2), ("x", 4, 4)]),
    ("rate[2](x) >= 3", 4, [("x", 2, 2), ("x", 4, 4)], [("x", 2, 2), ("x", 4, 4)]),
    # y held last at 3, and not since.
    ("held(x, y >= 3) >= 3", 4, [("x", 3, 3), ("y", 3, 4)], [("x", 3, 3)]),
    ("held(x, y >= 3) >= 3", 3, [("x", 3, 3), ("y", 3, 3)], [("x", 3, 3)]),
    ("held(x, y >= 3) >= 3", 2, [("x", 0, 0), ("y", 0, 2)], [("x", 0, 0)]),
    ("held(x, y >= 3, x) >= 3", 2, [("x", 2, 2), ("y", 0, 2)], [("x", 2, 2)]),
    # The branch that is not taken is not read.
    ("(if y >= 3 then x else 8) >= 3", 3, [("x", 3, 3), ("y", 3, 3)], [("x", 3, 3)]),
    ("(if y >= 3 then 8 else x) >= 3", 2, [("x", 2, 2), ("y", 2, 2)], [("x", 2, 2)]),
    ("(if y >= 3 or x >= 3 then 8 else x) >= 3", 3, [("y", 3, 3)], [("y", 3, 3)]),
    # One large sample for a large maximum, all of them for a small one.
    ("maximum[0:3](x) >= 3", 4, [("x", 1, 1)], [("x", 1, 1)]),
    ("maximum[0:3](x) <= 3", 4, [("x", 1, 1)], [("x", 1, 1)]),
    ("maximum[0:3](x) <= 4", 4, [("x", 1, 4)], [("x", 1, 1)]),
    ("minimum[0:3](x) <= 3", 4, [("x", 4, 4)], [("x", 4, 4)]),
    ("x - minimum[0:3](x) >= 8", 6, [("x", 4, 4), ("x", 6, 6)], [("x", 4, 4), ("x", 6, 6)]),
    ("max(x, y) >= 3", 3, [("y", 3, 3)], [("y", 3, 3)]),
    ("min(x, y) >= 0", 3, [("x", 3, 3), ("y", 3, 3)], [("x", 3, 3)]),
    ("sum[1:2](x) >= 3", 4, [("x", 2, 3)], [("x", 2, 3)]),
    ("mean[0:2](x) >= 3", 4, [("x", 2, 4)], [("x", 2, 4)]),
    ("integral[0:2](x) >= 3", 4, [("x", 2, 4)], [("x", 2, 4)]),
    ("duration[0:2](x >= 2) >= 2", 4, [("x", 2, 4)], [("x", 2, 4)]),
    # Not the fall at 4, for which 3 is enough: nothing begins there.
    ("count[0:2](x >= 2) >= 2", 4, [("x", 1, 3)], [("x", 1, 3)]),
    ("(atleast[0:2](60%, x >= 2)) or y >= 9", 2, [("x", 2, 3)], None),
    ("(if atleast[0:4](60%, x >= 3) then y else 0) >= 3", 3, [("x", 5, 6), ("y", 3, 3)], None),
]

# Intervals of ticks: (signal, start, end, closed).
DENSE = [
    ("delay[2](x) >= 3", 4, [("x", 2, 2, True)], [("x", 2, 3, False)]),
    ("held(x, y >= 3) >= 3", 4, [("x", 3, 4, False), ("y", 3, 4, True)], [("x", 3, 4, False)]),
    ("(if y >= 3 then x else 8) >= 3", 3, [("x", 3, 3, True), ("y", 3, 3, True)], [("x", 3, 4, False)]),
    ("held(x, rise(y >= 3)) >= 3", 0, [("x", 0, 0, True), ("y", 0, 0, True)], [("x", 0, 1, False)]),
    ("maximum[0:3](x) >= 3", 4, [("x", 1, 2, False)], [("x", 1, 2, False)]),
    ("maximum[0:3](x) <= 4", 4, [("x", 1, 4, True)], [("x", 1, 2, False)]),
]


def data(spec):
    values = {"time": range(7), "x": X, "y": Y}
    return {name: values[name] for name in ("time", *spec.input_names)}


@pytest.mark.parametrize(("text", "at", "reads", "source"), DISCRETE)
def test_discrete(text, at, reads, source):
    spec = rtamt.parse(text)
    explanation = spec.evaluate(data(spec)).explain(at)
    (stretch,) = explanation.implicant
    assert sorted((r.signal, r.start, r.end) for r in stretch.reads) == sorted(reads)
    assert all(r.closed for r in stretch.reads)
    if source is not None:
        assert [(r.signal, r.start, r.end) for r in explanation.critical.reads] == source


@pytest.mark.parametrize(("text", "at", "reads", "source"), DENSE)
def test_dense(text, at, reads, source):
    spec = rtamt.parse(text, time="dense")
    explanation = spec.evaluate(data(spec)).explain(at)
    (stretch,) = explanation.implicant
    assert [(r.signal, r.start, r.end, r.closed) for r in stretch.reads] == reads
    assert [(r.signal, r.start, r.end, r.closed) for r in explanation.critical.reads] == source


def test_what_is_read_elsewhere_is_in_the_text():
    spec = rtamt.parse("always[3:4](held(x, y >= 3) - maximum[0:3](x) >= 0)")
    text = str(spec.evaluate(data(spec)).explain())
    assert text.splitlines()[2:] == [
        "critical point at 3 s: 'held(x, y >= 3) - maximum[0:3](x) >= 0' is -3, reading x at 0 s and at 3 s; the "
        "robustness follows it up to -2",
        "sufficient cause, independent of all other samples:",
        "  'held(x, y >= 3) - maximum[0:3](x) >= 0' fails at 3 s (-3), reading x at 0 s and at 3 s, y at 3 s",
    ]


def test_many_times_are_counted_in_the_text_and_listed_in_the_data():
    x = [9 if i % 5 == 0 else i % 5 for i in range(50)]
    result = rtamt.parse("always(maximum[0:5](x) >= 9)").evaluate({"x": x})
    (stretch,) = result.explain().implicant
    assert [r.start for r in stretch.reads] == list(range(0, 50, 5))
    assert result.explain().causes[0].endswith("reading x at 0 s, at 5 s, at 10 s and 7 more times")


def test_members_are_those_that_were_read_and_not_those_at_the_instant():
    text = "enum Mode { MANUAL, AUTO }; input Mode mode; input float x; held(mode, x > 3) == AUTO"
    explanation = rtamt.parse(text).evaluate({"mode": ["MANUAL", "AUTO"], "x": [5, 1]}).explain(1)
    assert str(explanation).splitlines()[1:] == [
        "critical point at 1 s: 'held(mode, x > 3) == AUTO' fails (mode is MANUAL), reading mode at 0 s; "
        "the robustness follows it up, not down",
        "sufficient cause, independent of all other samples:",
        "  'held(mode, x > 3) == AUTO' fails at 1 s (mode is MANUAL), reading mode at 0 s, x from 0 s to 1 s",
    ]
