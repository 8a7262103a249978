"""``result.explain()``: sentences, data, instants, words, and what cannot be taken apart."""

import json
from dataclasses import FrozenInstanceError, replace
from datetime import datetime, timedelta

import numpy as np
import pytest

import rtamt
from rtamt.errors import UsageError
from rtamt.explain.explanation import Reading
from rtamt.language.operators import STL

TEXT = "always(req >= 3 -> eventually[0:2](gnt >= 3))"
VIOLATED = {"req": [0, 6, 0, 0, 0], "gnt": [0, 0, 0, 1, 7]}
inf = float("inf")


def explained(text, data, at=None, **options):
    return rtamt.parse(text, **options).evaluate(data).explain(at)


def lines(explanation):
    return tuple(explanation.text(None).splitlines())


def test_it_prints_as_sentences():
    assert str(explained(TEXT, VIOLATED)) == (
        "violated, robustness -2: always(req >= 3 -> eventually[0:2](gnt >= 3))\n"
        "first violation at 1 s\n"
        "critical point at 3 s: 'gnt >= 3' is -2; the robustness follows it from -3 to 3\n"
        "sufficient cause, independent of all other samples:\n"
        "  'req >= 3' holds at 1 s (3)\n"
        "  'gnt >= 3' fails from 1 s to 3 s (-3 to -2)"
    )


def test_a_satisfied_formula_is_explained_too_and_nothing_idle_is_told():
    granted = {"req": [0, 6, 0, 0, 0], "gnt": [5, 0, 0, 4, 7]}
    assert lines(explained(TEXT, granted)) == (
        "satisfied, robustness 1: always(req >= 3 -> eventually[0:2](gnt >= 3))",
        "critical point at 3 s: 'gnt >= 3' is 1; the robustness follows it from -3 to 3",
        "sufficient cause, independent of all other samples:",
        "  'gnt >= 3' holds at 0 s (2)",
        "  'gnt >= 3' holds from 3 s to 4 s (1 to 4)",
    )


def test_in_dense_time_segments_end_where_they_end():
    data = {"req": ([0, 1.5, 2], [0, 6, 0]), "gnt": ([0, 3.75, 5], [0, 7, 0])}
    assert lines(explained(TEXT.replace("0:2", "0:1"), data, time="dense")) == (
        "violated, robustness -3: always(req >= 3 -> eventually[0:1](gnt >= 3))",
        "first violation at 1.5 s",
        "critical point at 1.5 s: 'req >= 3' is 3; the robustness follows it down to -3, not up",
        "sufficient cause, independent of all other samples:",
        "  'req >= 3' holds from 1.5 s until 2 s (3)",
        "  'gnt >= 3' fails from 1.5 s until 3 s (-3)",
    )


@pytest.mark.parametrize(
    ("text", "data", "sentence"),
    [
        ("x", [1], "critical point at 0 s: 'x' is 1; the robustness follows it"),
        ("x or x > 1", [1], "critical point at 0 s: 'x' is 1; the robustness follows it down to 0"),
        ("always x", [1, 2], "critical point at 0 s: 'x' is 1; the robustness follows it up to 2"),
        ("always(x or x > 1)", [1, 2], "critical point at 0 s: 'x' is 1; the robustness follows it from 0 to 2"),
        (
            "eventually(x and x >= 0)",
            [1, 1],
            "critical point at 0 s: 'x' is 1; others give the same robustness",
        ),
        (
            "always(x < 1 or eventually x >= 1)",
            [0, 2],
            "critical point at 1 s: 'x >= 1' is 1; the robustness follows it down to -1",
        ),
        ("x or 3 > 1", [1], "critical point at 0 s: '3 > 1' is 2, a constant"),
        ("x and false", [1], "no predicate decides the robustness: a constant of the formula does"),
        (
            "prev x",
            [1],
            "no predicate decides the robustness: a window before the start of the trace is empty",
        ),
        (
            "eventually[1:2] x",
            [1],
            "no predicate decides the robustness: a window after the end of the trace is empty",
        ),
    ],
)  # fmt: skip
def test_what_decides_the_robustness(text, data, sentence):
    assert explained(text, {"x": data}).summary[-2] == sentence


def test_a_verdict_that_rests_on_nothing_says_so():
    assert lines(explained("x or true", {"x": [1]})) == (
        "satisfied, robustness inf: x or true",
        "no predicate decides the robustness: a constant of the formula does",
        "the verdict depends on no predicate",
    )


@pytest.mark.parametrize(("text", "satisfied"), [("x >= 3", True), ("x > 3", False)])
def test_the_verdict_is_the_boolean_one_where_the_robustness_is_0(text, satisfied):
    explanation = explained(text, {"x": [3]})
    assert explanation.satisfied is satisfied
    assert lines(explanation)[0] == f"{'satisfied' if satisfied else 'violated'}, robustness 0: {text}"
    assert [(s.predicate, s.holds) for s in explanation.implicant] == [(text, satisfied)]


def test_a_satisfied_or_does_not_fall_with_its_critical_value():
    point = explained("x >= 0 or y >= 0", {"x": [3], "y": [2]}).critical
    assert (point.predicate, point.value, point.lowest, point.highest) == ("x >= 0", 3, 2, inf)


def test_predicates_are_quoted_as_they_were_written():
    text = "const float limit = 3; asked = req>=limit; out = always(asked -> gnt >=\n limit)"
    explanation = explained(text, {"req": [5], "gnt": [0]})
    assert [s.predicate for s in explanation.implicant] == ["req>=limit", "gnt >= 3"]


def test_as_data_it_is_what_json_can_hold():
    told = explained("always(x >= 3) and once[1:2] x", {"x": [5, 1, 4]}).to_dict()
    assert json.loads(json.dumps(told)) == told
    assert told == {
        "formula": "always(x >= 3) and once[1:2] x",
        "time": 0.0,
        "satisfied": False,
        "robustness": "-inf",
        "first_violation": 0.0,
        "critical": {
            "predicate": None, "time": 0.0, "start": 0.0, "end": 0.0, "value": "-inf", "polarity": 1,
            "lowest": "-inf", "highest": "-inf", "decided_by": "start", "reads": [],
        },
        "implicant": [],
    }  # fmt: skip
    (stretch,) = explained("always(x >= 3)", {"x": ([0, 2], [5, 4])}, time="dense").to_dict()["implicant"]
    assert stretch == {
        "predicate": "x >= 3", "holds": True, "start": 0.0, "end": None, "closed": False,
        "lowest": 1.0, "highest": 2.0, "reads": [{"signal": "x", "start": 0.0, "end": None, "closed": False}],
    }  # fmt: skip


def test_of_many_causes_one_for_each_predicate_and_those_closest_to_the_critical_point_are_printed():
    n = 400
    explanation = explained("always(eventually[0:1](x >= 3))", {"x": [4, 1] * n + [3]})
    assert explanation.satisfied
    assert len(explanation.causes) == n + 1
    first = str(explanation).splitlines()
    closest = [f"  'x >= 3' holds at {2 * i} s (1)" for i in range(n - 4, n)]
    assert first[3:] == [*closest, "  'x >= 3' holds at 800 s (0)", f"  {n - 4} more"]
    assert explanation.text(None).splitlines() == [
        *first[:3],
        *(f"  {cause}" for cause in explanation.causes),
    ]


def test_dates_are_dates_with_the_seconds_since_the_start_and_no_nanoseconds():
    timestamps = np.array([1_700_000_000_000_000_000 + i * 500_000_000 for i in range(3)])
    for times in (timestamps.astype("M8[ns]"), timestamps.astype("m8[ns]"), timestamps / 1e9):
        for time in ("discrete", "dense"):
            told = str(
                explained(
                    "always(x >= 3)",
                    {"time": times, "x": [5, 1, 4]},
                    time=time,
                    period="500ms" if time == "discrete" else None,
                )
            )
            assert "first violation at 2023-11-14 22:13:20.5 (+0.5 s)" in told
            assert "170000" not in told


def test_it_cannot_be_changed():
    explanation = explained("x", {"x": [1]})
    with pytest.raises(FrozenInstanceError):
        explanation.satisfied = False


@pytest.mark.parametrize(
    ("times", "at", "start"),
    [
        ([10.0, 10.1, 10.2], 10.1, 10.1),
        (np.array([10, 20, 30]), 20, 20.0),
        (np.array([10, 20, 30], "m8[ms]"), timedelta(milliseconds=20), np.timedelta64(20_000_000, "ns")),
        (
            np.array(["2024-01-01", "2024-01-02", "2024-01-03"], "datetime64[ns]"),
            datetime(2024, 1, 2),
            np.datetime64("2024-01-02", "ns"),
        ),
    ],
)
def test_dense_instants_are_told_as_the_caller_tells_time(times, at, start):
    explanation = explained("x >= 3", {"x": (times, [5, 1, 4])}, at, time="dense")
    (stretch,) = explanation.implicant
    assert stretch.start == explanation.time == explanation.critical.time == start
    assert type(explanation.time) is type(start)
    assert json.dumps(explanation.to_dict())


@pytest.mark.parametrize(
    ("at", "time", "message"),
    [
        (0.5, "discrete", "there is no sample at 0.5; the recording has 3, from 0 s to 2 s"),
        ("now", "discrete", "there is no sample at 'now'; the recording has 3, from 0 s to 2 s"),
        (3.0, "dense", "3.0 is no instant of the recording, which lasts from 0 s to 2 s"),
        ("now", "dense", "'now' is no instant of the recording, which lasts from 0 s to 2 s"),
        (-1, "dense", "-1 is no instant of the recording, which lasts from 0 s to 2 s"),
    ],
)
def test_an_instant_that_was_not_recorded(at, time, message):
    result = rtamt.parse("x").evaluate({"time": [0, 1, 2], "x": [1, 2, 3]}, time=time)
    with pytest.raises(UsageError) as caught:
        result.explain(at)
    assert str(caught.value) == message


def test_a_recording_of_too_many_ticks():
    data = {"x": (np.array([0, 2**60]), [1, 2])}
    result = rtamt.parse("x").evaluate(data, time="dense", time_unit="ns")
    with pytest.raises(UsageError) as caught:
        result.explain()
    assert str(caught.value) == (
        "the recording has too many ticks to be explained; choose a coarser resolution, such as resolution='1us'"
    )


def test_an_operator_with_a_definition_only_is_taken_as_a_whole():
    def median(x, a, b):
        return np.array(
            [np.sort(x[max(0, t - b) : t - a + 1])[0 if t < b else b // 2] for t in range(len(x))]
        )

    record = {"name": "median", "spellings": ("median",), "definition": median, "kernel": None, "dual": None}
    language = STL.extend(replace(STL["once"], **record))
    text, data = "always[2:3] median[0:2](x)", {"x": [4, 2, 0, 7]}
    explanation = explained(text, data, language=language, backend="python")
    assert explanation.critical.value == explanation.robustness == 2
    (stretch,) = explanation.implicant
    assert (stretch.start, stretch.end, stretch.reads) == (2, 3, (Reading("x", 0, 3, True),))
    assert lines(explanation)[-1] == "  'median[0:2](x)' holds from 2 s to 3 s (2), reading x from 0 s to 3 s"


def test_a_comparison_over_a_window_is_read_as_a_whole():
    (stretch,) = explained("(always[0:2](x >= 1)) + x >= 2", {"x": [4, 3, 2, 0]}).implicant
    assert (stretch.start, stretch.end, stretch.reads) == (0, 0, (Reading("x", 0, 2, True),))


def test_both_back_ends_say_the_same():
    for time in ("discrete", "dense"):
        said = [
            str(explained(TEXT, {"time": range(5), **VIOLATED}, time=time, backend=b))
            for b in ("cpp", "python")
        ]
        assert said[0] == said[1]


@pytest.mark.parametrize(
    ("semantics", "robustness", "decides"),
    [
        ("standard", -2, "gnt >= 3"),
        ("output_robustness", -2, "gnt >= 3"),
        ("input_robustness", -3, "req >= 3"),
        ("boolean", -inf, "req >= 3"),
    ],
)
def test_the_robustness_is_that_of_the_semantics_and_the_verdict_the_same_under_each(
    semantics, robustness, decides
):
    spec = rtamt.parse(TEXT, roles={"req": "input", "gnt": "output"}, semantics=semantics)
    result = spec.evaluate(VIOLATED)
    explanation = result.explain()
    assert explanation.robustness == result.robustness == robustness
    assert explanation.critical.predicate == decides
    assert explanation.critical.polarity * explanation.critical.value == robustness
    standard = rtamt.parse(TEXT).evaluate(VIOLATED).explain()
    assert explanation.satisfied is False
    assert [(s.formula, s.start) for s in explanation.implicant] == [
        (s.formula, s.start) for s in standard.implicant
    ]


def test_a_formula_of_thousands_of_operators():
    terms = " and ".join(f"always[0:1](x >= {-k})" for k in range(1100))
    explanation = explained(terms, {"x": [1, 2, 3]})
    assert explanation.formula.startswith("always[0:1](x >= 0) and always[0:1](x >= -1) and ")
    assert explanation.formula.endswith("… (abbreviated: 5499 operators, variables and numbers)")
    assert explanation.critical.predicate == "x >= 0"
    assert len(explanation.implicant) == 1100


def test_a_long_recording_of_many_pulses_is_explained_by_what_each_of_them_needs():
    req, gnt = np.zeros(20_000), np.zeros(20_000)
    req[50::100] = gnt[53::100] = 5
    gnt[54::100] = gnt[30::100] = 5  # no request needs these
    implicant = explained("always(req >= 3 -> eventually[0:5](gnt >= 3))", {"req": req, "gnt": gnt}).implicant
    assert sum(s.predicate == "req >= 3" for s in implicant) == 201
    assert sum(s.predicate == "gnt >= 3" for s in implicant) == 200


def test_stretches_that_nothing_can_stand_in_for_are_not_tried_one_by_one():
    req, gnt = np.zeros(20_000), np.zeros(20_000)
    for k in range(4):
        req[50 + k :: 100] = 5
    gnt[53::100] = 5
    text = "always(req >= 3 -> (req >= 3 until gnt >= 3))"
    implicant = explained(text, {"req": req, "gnt": gnt}).implicant
    assert [(s.predicate, s.holds, s.start, s.end) for s in implicant[:3]] == [
        ("req >= 3", False, 0, 49),
        ("req >= 3", True, 50, 52),
        ("req >= 3", False, 54, 149),
    ]
    assert sum(s.predicate == "gnt >= 3" for s in implicant) == 200
    assert len(implicant) == 601


def test_a_predicate_with_and_without_negation_is_two():
    explanation = explained("x >= 3 or not (x >= 3)", {"x": [1]})
    assert [(s.predicate, s.holds) for s in explanation.implicant] == [("x >= 3", False)]


def test_stamps_that_count_from_1970_are_told_to_the_millisecond():
    times = [1700000000.123, 1700000000.124, 1700000000.125]
    explanation = explained("always(x >= 3)", {"time": times, "x": [5, 1, 4]}, period="1ms")
    assert lines(explanation)[0] == "violated, robustness -2: always(x >= 3)"
    assert lines(explanation)[-1] == "  'x >= 3' fails at 2023-11-14 22:13:20.124 (+0.001 s) (-2)"


@pytest.mark.parametrize(
    "text",
    [
        "always[0:2](always x > 0)",
        "always[1:inf](x > 0) unless[1:2] x > 9",
        "not eventually[0:2] not always x > 0",
    ],
)
def test_a_violation_seen_through_two_windows_was_told_to_rest_on_no_predicate(text):
    result = rtamt.parse(text, time="dense").evaluate({"x": ([0.0, 6.0, 7.0], [1, -1, 1])})
    assert lines(result.explain())[3:] == (
        "sufficient cause, independent of all other samples:",
        "  'x > 0' fails from 6 s until 7 s (-1)",
    )


@pytest.mark.parametrize(
    "text", ["not eventually(y > 0 since[1:3] x > 9)", "always not(y > 0 since[1:3] x > 9)"]
)
def test_what_lasts_for_ever_was_told_to_end_a_tick_before_the_end_of_time(text):
    result = rtamt.parse(text, time="dense").evaluate({"y": ([0.0, 6.0], [1, -1]), "x": ([0.0], [0])})
    (stretch,) = result.explain().implicant
    assert (stretch.predicate, stretch.holds, stretch.start, stretch.end) == ("x > 9", False, 0.0, None)


@pytest.mark.parametrize(
    ("text", "at", "when"),
    [
        ("always[0:1](x >= 3)", 1.5, "fails from 2 s to 2.5 s (-2)"),
        ("x >= 3", 1.5, "holds at 1.5 s (2)"),
        ("historically(x >= 3)", 2.5, "fails from 2 s to 2.5 s (-2)"),
        ("always[0:1](x >= 3)", 3.9, "fails from 3.9 s until 4 s (-2)"),
    ],
)
def test_an_instant_between_samples_is_not_told_a_nanosecond_too_late(text, at, when):
    result = rtamt.parse(text, time="dense").evaluate({"x": ([0, 2, 4], [5, 1, 6])})
    assert lines(result.explain(at=at))[-1] == f"  'x >= 3' {when}"
