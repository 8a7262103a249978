"""What RTAMT 0.4.10 and its users' reports got wrong in dense time, one test a symptom."""

from __future__ import annotations

import copy
from math import inf

import pytest

import rtamt


def specification(text, names="x y", unit="s"):
    spec = rtamt.StlDenseTimeSpecification()
    for name in names.split():
        spec.declare_var(name, "float")
    spec.unit = unit
    spec.spec = text
    spec.parse()
    return spec


def at(points, time):
    """Return the value of a signal that holds between its points."""
    return [value for begin, value in points if begin <= time][-1]


# ---- meaning -----------------------------------------------------------------------------------------


def test_issue_66_pastified_eventually_says_one_horizon_later_what_was_meant():
    spec = specification("out = eventually[2,2](x >= 0)", "x out")
    spec.pastify()
    told = []
    for time, x in ((0, 0), (1, 0), (2, 1), (4, 1), (5, 1)):
        told += spec.update(["x", [[time, x]]])
    # ρ at 0 is x at 2, which is 1, and so is ρ at 1: told at 2 and at 3.
    assert [at(told, time) for time in (2, 3, 4, 5)] == [1.0] * 4
    assert told[-1] == [5.0, 1.0]
    offline = specification("eventually[2,2](x >= 0)").evaluate(["x", [[0, 0], [2, 1], [5, 1]]])
    assert [at(offline, time) for time in (0, 1, 3)] == [1.0, 1.0, 1.0]


def test_issue_137_a_reset_monitor_answers_like_a_new_one():
    again = [["x", [[0, -8], [1, 0], [4, 2]]], ["y", [[0, 0], [2, 5], [4, -5]]]]
    for text in ("once[1,3] x", "historically x", "x since[0,2] y", "(x + y) since y"):
        spec = specification(text)
        spec.update(["x", [[0, 9], [7, -4]]], ["y", [[3, 1], [9, -1]]])
        spec.reset()
        assert spec.update(*again) == specification(text).update(*again)


def test_issue_170_samples_of_one_variable_at_a_time_are_no_reason_for_silence():
    spec = specification("((historically[0,5] x==1) and y) implies (eventually[0, 1] x==0)")
    spec.pastify()
    assert [point[0] for point in spec.update(["x", [(0.0, 1)]], ["y", [(0.0, -1)]])] == [0.0]
    assert spec.update(["x", [(1.0, 1)]]) == []
    assert spec.update(["y", [(7.0, 1)]])[-1][0] == 1.0
    assert spec.update(["x", [(10.0, 0)]])[-1][0] == 7.0
    told = spec.update(["y", [(11.0, 1)]])
    assert told[-1][0] == 10.0
    # x is 1 until 10 and y is true from 7 on: the premise holds (by 0), the promise misses by 1.
    assert at(told, 8.5) == 0.0
    assert specification("(historically[0,5] x==1) and y").evaluate(
        ["x", [(0, 1), (10, 0)]], ["y", [(0, -1), (7, 1), (11, 1)]]
    ) == [[0.0, -1.0], [7.0, 0.0], [10.0, -1.0], [11.0, -1.0]]


def test_issue_210_a_step_that_ends_the_left_side_when_the_right_begins_satisfies_until():
    spec = specification("(h < 0.5) until[0,1] (h >= 0.5)", "h")
    assert at(spec.evaluate(["h", [[0.0, 0.0], [0.5, 1.0]]]), 0.0) == 0.5


@pytest.mark.parametrize("text", ["x until y", "x since y", "x until[0,2] y", "x since[0,2] y"])
def test_the_left_side_is_not_required_where_the_right_holds(text):
    robustness = specification(text).evaluate(["x", [[0, -1], [4, -1]]], ["y", [[0, 3], [4, 3]]])
    assert robustness == [[0.0, 3.0], [4.0, 3.0]]


def test_units_are_not_inverted():
    points = ["x", [[0, 5], [1, 1], [2, 5], [3, 5]]]
    expected = [[0.0, 2.0], [0.5, -2.0], [2.0, 2.0], [3.0, 2.0]]
    assert specification("always[0:500ms](x >= 3)").evaluate(points) == expected
    assert specification("always[0:500000us](x >= 3)").evaluate(points) == expected
    in_ms = ["x", [[time * 1000, x] for time, x in points[1]]]
    for text in ("always[0:500](x >= 3)", "always[0:0.5s](x >= 3)"):
        assert specification(text, unit="ms").evaluate(in_ms) == [[t * 1000, v] for t, v in expected]


def test_a_window_of_a_tenth_is_not_missed_by_a_hair():
    # 0.1 + 0.2 is not 0.3 in doubles; an answer exactly 200 ms later is in time.
    spec = specification("x -> eventually[0,0.2] y")
    x, y = [[0, -1], [0.1, 1], [0.15, -1], [1, -1]], [[0, -1], [0.3, 1], [1, 1]]
    assert at(spec.evaluate(["x", x], ["y", y]), 0.1) == 1.0
    assert min(value for _, value in spec.evaluate(["x", x], ["y", y])) == 1.0


# ---- chunks ------------------------------------------------------------------------------------------


def test_the_segment_that_begins_at_the_end_of_a_chunk_is_not_lost():
    # The paper's listing 2: the grant at 5 is the last sample of its chunk; RTAMT says -3 at 8.
    spec = specification("H[0,10]((O[5,5](req>=3))->(O[0,5](gnt>=3)))", "req gnt")
    spec.update(["req", [[0.0, 0.0], [2.0, 6.0]]], ["gnt", [[0.0, 0.0], [5.0, 6.0]]])
    told = spec.update(["req", [[4.0, 0.0], [10.0, 0.0]]], ["gnt", [[8.0, 0.0], [10.0, 0.0]]])
    assert told == [[5.0, 3.0], [10.0, 3.0]]


@pytest.mark.parametrize(
    "text",
    ["once[1,2](x)", "historically[0,3](x)", "x since[1,2] y", "once[2,2](x) and y", "x until[0,2] y"],
)
def test_one_sample_at_a_time_says_the_same_as_all_at_once(text):
    x = [[0, 1], [1, -2], [2, 5], [4, 3], [5, -1], [9, 2]]
    y = [[0, 2], [1.5, -4], [2, 6], [4.5, 1], [7, -3], [9, 0]]
    whole, single = specification(text), specification(text)
    whole.pastify()
    single.pastify()
    expected = whole.update(["x", x], ["y", y])
    told = []
    for a, b in zip(x, y, strict=True):
        told += single.update(["x", [a]]) + single.update(["y", [b]])
    assert [at(told, i / 4) for i in range(37)] == [at(expected, i / 4) for i in range(37)]
    assert told[-1] == expected[-1]


def test_equal_subformulas_share_one_state_and_are_not_stepped_twice():
    x = [[t, t + 1.0] for t in range(5)]
    expected = [[0.0, -inf], [2.0, 1.0], [3.0, 2.0], [4.0, 3.0]]
    for text in ("O[2,2](x>0)", "O[2,2](x>0) or O[2,2](x>0)", "late = O[2,2](x>0); late and late"):
        assert specification(text).update(["x", x]) == expected


# ---- pastification -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "horizon"),
    [
        ("x until[0,2] y", 2),
        ("x until[1,2] y", 2),
        ("always[0,1](x until[0,2] y)", 3),
        ("historically[0,2](x) and eventually[0,1](y)", 1),
        ("once(always[0,2](x))", 2),
        ("y since (always[0,1](x))", 1),
        ("(x >= 2) -> eventually[0:500ms](y)", 0.5),
    ],
)
def test_pastified_formulas_do_not_raise_and_say_the_same_one_horizon_later(text, horizon):
    x = ["x", [[0, 1], [1, -2], [2, 5], [4, 3], [5, -1], [9, 2], [12, 2]]]
    y = ["y", [[0, 2], [1.5, -4], [2, 6], [4.5, 1], [7, -3], [9, 0], [12, 0]]]
    spec = specification(text)
    offline = spec.evaluate(x, y)
    spec.pastify()
    online = spec.update(x, y)
    instants = [i / 4 for i in range(int(4 * (12 - horizon)) + 1)]
    assert [at(online, t + horizon) for t in instants] == [at(offline, t) for t in instants]


def test_outputs_before_the_horizon_come_from_what_there_is_and_begin_at_0():
    spec = specification("always[0,2](x)")
    spec.pastify()
    assert spec.update(["x", [[0, 1], [1, -2], [5, 5]]]) == [[0.0, 1.0], [1.0, -2.0], [5.0, -2.0]]


# ---- data --------------------------------------------------------------------------------------------


def test_evaluate_and_update_do_not_change_the_callers_lists():
    data = [["x", [[0, 1], [2, 3]]], ["y", [[0, 4], [1, 5]]]]
    before = copy.deepcopy(data)
    spec = specification("once[1,2](x since[1,2] y)")
    spec.evaluate(*data)
    spec.update(*data)
    assert data == before


def test_evaluating_twice_gives_the_same_answer_twice():
    spec = specification("always[1,2](x until[1,2] y)")
    data = [["x", [[0, 1], [2, 3], [6, 0]]], ["y", [[0, 4], [1, 5], [6, 1]]]]
    assert spec.evaluate(*data) == spec.evaluate(*data)


@pytest.mark.parametrize(
    ("dataset", "message"),
    [
        ([["x", [[0, 1]]]], "the data has no 'y'; signals: x"),
        ([["x", [[0, 1]]], ["y", []]], "'y' has no samples: give at least one"),
    ],
)
def test_missing_signals_are_no_key_or_index_error(dataset, message):
    with pytest.raises(rtamt.RTAMTException) as info:
        specification("x until y").evaluate(*dataset)
    assert str(info.value) == f"RTAMT Exception: {message}"
