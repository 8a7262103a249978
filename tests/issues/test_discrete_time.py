"""What RTAMT 0.4.10 and its users' reports got wrong in discrete time, one test a symptom."""

from __future__ import annotations

import copy
from math import inf

import pytest

import rtamt


def specification(text, names="x y", *sub_specs, period=(1, "s", 0.1), unit="s"):
    spec = rtamt.StlDiscreteTimeSpecification()
    for name in names.split():
        spec.declare_var(name, "float")
    for sub_spec in sub_specs:
        spec.add_sub_spec(sub_spec)
    spec.unit = unit
    spec.set_sampling_period(*period)
    spec.spec = text
    spec.parse()
    return spec


def online(spec, xs, ys=None, step=1.0):
    ys = ys or [0.0] * len(xs)
    return [spec.update(i * step, [("x", x), ("y", y)]) for i, (x, y) in enumerate(zip(xs, ys, strict=True))]


def offline(spec, xs, ys=None, step=1.0):
    data = {"time": [i * step for i in range(len(xs))], "x": xs, "y": ys or [0.0] * len(xs)}
    return [value for _, value in spec.evaluate(data)]


# ---- state -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("O[2,2](x>0) or O[2,2](x>0)", [-inf, -inf, 1.0, 2.0, 3.0]),
        ("(prev(x)) + (prev(x)) >= 0", [inf, 2.0, 4.0, 6.0, 8.0]),
        ("(x since[1,1] y) and (x since[1,1] y)", [-inf, 0.0, 0.0, 0.0, 0.0]),
    ],
)
def test_equal_subformulas_share_one_state_and_are_not_stepped_twice(text, expected):
    assert online(specification(text), [1.0, 2.0, 3.0, 4.0, 5.0]) == expected


@pytest.mark.parametrize(
    "stateful", ["once[2,2](x > 0)", "prev(x)", "historically[1,2](x)", "x since[1,2] y"]
)
def test_a_stateful_subspecification_used_online_keeps_its_delay(stateful):
    xs, ys = [1.0, -2.0, 3.0, -4.0, 5.0, 6.0], [3.0, 1.0, -1.0, 2.0, 2.0, -3.0]
    whole = online(specification(f"({stateful}) or y"), xs, ys)
    assert online(specification("late or y", "x y late", f"late = {stateful};"), xs, ys) == whole


def test_issue_164_subspecifications_change_no_result():
    xs, ys = [0.0, 6.0, 0.0, 0.0, 0.0, 6.0], [0.0, 0.0, 0.0, 6.0, 0.0, 0.0]
    whole = specification("always((x >= 3) implies (eventually[0:2](y >= 3)))")
    parts = specification(
        "always(premise implies response);",
        "x y premise response",
        "premise = (x >= 3);",
        "response = (eventually[0:2](y >= 3));",
    )
    unused = specification("always((x >= 3) implies (eventually[0:2](y >= 3)))", "x y", "unused = once(x);")
    expected = offline(whole, xs, ys)
    assert offline(parts, xs, ys) == offline(unused, xs, ys) == expected
    assert expected[-1] == -3.0


def test_issue_85_evaluating_twice_gives_the_same_answer_twice():
    spec = specification("!( (eventually[2,3](x) ) )")
    expected = [-0.1, -0.1, inf, inf]
    assert [offline(spec, [-5.0, -4.0, -0.3, 0.1]) for _ in range(2)] == [expected, expected]


def test_a_reset_monitor_answers_like_a_new_one():
    for text in ("once[1,3] x", "historically x", "prev x", "x since (y > 0)", "rise(x)"):
        spec = specification(text)
        online(spec, [9.0, -4.0, 3.0], [1.0, -1.0, 1.0])
        spec.reset()
        spec.reset()
        again = online(spec, [-8.0, 0.0, 2.0], [0.0, 5.0, -5.0])
        assert again == online(specification(text), [-8.0, 0.0, 2.0], [0.0, 5.0, -5.0])


# ---- pastification -----------------------------------------------------------------------------------


def late(text, delay, xs, ys):
    """Return what the pastified monitor says from the horizon on, and what offline says up to there."""
    spec = specification(text)
    expected = offline(spec, xs, ys)[: len(xs) - delay]
    spec.pastify()
    return online(spec, xs, ys)[delay:], expected


XS = [1.0, -2.0, 5.0, 3.0, -1.0, 4.0, -6.0, 2.0, 7.0, -3.0]
YS = [-4.0, 2.0, 6.0, -1.0, 3.0, -5.0, 1.0, 8.0, -2.0, 5.0]


@pytest.mark.parametrize(
    ("text", "delay"),
    [
        ("historically[0,2](x) and eventually[0,1](y)", 1),
        ("historically[1,3](x) or next(y)", 1),
    ],
)
def test_pastify_does_not_drop_historically(text, delay):
    got, expected = late(text, delay, XS, YS)
    assert got == expected


@pytest.mark.parametrize(
    ("text", "delay"),
    [
        ("next(x) and y", 1),
        ("next(next(x)) or y", 2),
        ("next(eventually[0,2](x)) and next(y)", 3),
        ("s_next(x) or y", 1),
    ],
)
def test_pastify_does_not_forget_next(text, delay):
    got, expected = late(text, delay, XS, YS)
    assert got == expected


def test_pastify_does_not_forget_units():
    spec = specification("eventually[0:500ms](x >= 1) and y >= 0", period=(250, "ms", 0.1))
    expected = offline(spec, XS, YS, step=0.25)[:-2]
    spec.pastify()
    assert online(spec, XS, YS, step=0.25)[2:] == expected


@pytest.mark.parametrize(
    ("text", "delay"),
    [
        ("(x >= 2) and eventually[0,2](y)", 2),
        ("(x + y >= 2) -> eventually[0,2](y >= x)", 2),
        ("always[0,1]((x >= 2) -> eventually[0,2](y >= 1))", 3),
    ],
)
def test_pastify_does_not_shift_predicates_twice(text, delay):
    got, expected = late(text, delay, XS, YS)
    assert got == expected


@pytest.mark.parametrize(
    ("text", "delay"),
    [
        ("historically(eventually[0,2](x))", 2),
        ("once(always[0,2](x))", 2),
        ("prev(eventually[0,1](x))", 1),
        ("s_prev(eventually[0,1](x))", 1),
        ("y since (always[0,1](x))", 1),
        ("rise(eventually[0,1](x))", 1),
        ("once[0,2](x until[1,2] y)", 2),
    ],
)
def test_pastify_reads_nothing_from_before_the_horizon(text, delay):
    got, expected = late(text, delay, XS, YS)
    assert got == expected


def test_historically_over_eventually_is_not_stuck_at_what_came_before_the_horizon():
    spec = specification("historically(eventually[0,2] x)")
    spec.pastify()
    assert online(spec, [0.0, 0.0, 5.0, 5.0, 5.0, 5.0, 5.0])[2:] == [5.0] * 5


def test_issue_84_pastified_and_unpastified_evaluation_agree_one_horizon_apart():
    plain = specification("eventually[0.5s,1s](x >= 2)", period=(0.1, "s", 0.1))
    expected = offline(plain, [*XS, *XS], step=0.1)
    plain.pastify()
    assert offline(plain, [*XS, *XS], step=0.1)[10:] == expected[:10]


def test_a_conjunction_of_windows_of_different_length_is_known_when_the_longest_is():
    got, expected = late("(always[0,2](x > 0)) and (eventually[0,1](x > 0))", 2, XS, YS)
    assert got == expected
    assert -inf not in got


# ---- meaning -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "expected"),
    [("x >= -2", 3.0), ("-1 >= x", -2.0), ("x - -1 >= 0", 2.0), ("-x >= -3", 2.0), ("x * -2 <= -1", 1.0)],
)
def test_negative_literals_keep_their_sign(text, expected):
    assert offline(specification(text), [1.0]) == [expected]
    assert online(specification(text), [1.0]) == [expected]


def test_two_true_operands_of_iff_are_no_violation():
    assert offline(specification("x <-> y"), [100.0], [20.0]) == [20.0]
    assert offline(specification("x xor y"), [100.0], [20.0]) == [-20.0]


def test_until_does_not_ask_for_its_left_side_at_the_instant_of_the_right():
    assert offline(specification("x until y"), [-1.0, -1.0], [3.0, 3.0]) == [3.0, 3.0]


def test_bounds_of_another_unit_than_the_period_are_converted():
    xs = [0.0, 0.0, 7.0, 0.0, 0.0]
    seconds = specification("once[0.5:1](x)", period=(500, "ms", 0.1))
    millis = specification("once[500:1000](x)", period=(500, "ms", 0.1), unit="ms")
    written = specification("once[500ms:1s](x)", period=(0.5, "s", 0.1))
    expected = [-inf, 0.0, 0.0, 7.0, 7.0]
    assert online(seconds, xs, step=0.5) == expected
    assert online(millis, xs, step=500.0) == expected
    assert online(written, xs, step=0.5) == expected


def test_time_stamps_are_in_the_unit_of_the_specification():
    for unit, step in (("s", 0.5), ("ms", 500.0), ("us", 5e5)):
        spec = specification("x", unit=unit, period=(500, "ms", 0.1))
        online(spec, [1.0, 2.0, 3.0], step=step)
        assert spec.sampling_violation_counter == 0


# ---- data --------------------------------------------------------------------------------------------


def test_evaluate_does_not_change_the_callers_lists():
    data = {"time": [0, 1, 2, 3], "x": [1, 2, 3, 4], "y": [5, 6, 7, 8]}
    before = copy.deepcopy(data)
    spec = specification("always[1,2](x until[1,2] next(y)) -> x >= 2")
    spec.evaluate(data)
    spec.get_value("x").append(9)
    assert data == before
    assert [type(value) for value in data["x"]] == [int] * 4


def test_update_does_not_change_the_callers_pairs():
    pairs = [["x", 1], ["y", 2]]
    spec = specification("prev(x) and y")
    spec.update(0, pairs)
    assert pairs == [["x", 1], ["y", 2]]


def test_the_violation_counter_looks_at_every_gap_not_only_the_last():
    spec = specification("x")
    spec.evaluate({"time": [0, 1, 3, 4, 6.5, 7.5], "x": [1.0] * 6})
    assert spec.sampling_violation_counter == 2
    spec.reset()
    for time in (0, 1, 3, 4, 6.5, 7.5):
        spec.update(time, [("x", 1.0)])
    assert spec.sampling_violation_counter == 2


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"time": [0, 1]}, "the data has no 'x'; signals: none"),
        ({"x": [0, 1]}, "the data has no 'time'; signals: x"),
        (
            {"time": [0, 1], "xx": [1, 2]},
            "the data has no 'x'; did you mean 'xx'? (signals: xx)",
        ),
        (
            {"time": [0, 1], "x": [1]},
            "'time' has 2 and 'x' has 1 samples: give one value of each at every sample",
        ),
    ],
)
def test_missing_keys_and_unequal_lengths_are_no_key_or_index_error(data, message):
    with pytest.raises(rtamt.RTAMTException) as info:
        specification("x >= 1").evaluate(data)
    assert str(info.value) == f"RTAMT Exception: {message}"


def test_a_reversed_interval_is_no_type_error():
    with pytest.raises(rtamt.STLParseException) as info:
        specification("once[5:2] x")
    assert str(info.value) == (
        "RTAMT Exception: the interval [5:2] is reversed: it ends before it begins\n"
        "  line 1, column 5:\n"
        "    once[5:2] x\n"
        "        ^^^^^"
    )


def test_samples_out_of_order_are_an_error_and_change_nothing():
    spec = specification("once(x)")
    spec.update(0, [("x", 1.0)])
    with pytest.raises(rtamt.RTAMTException) as info:
        spec.update(-1, [("x", 100.0)])
    assert str(info.value) == (
        "RTAMT Exception: time does not increase at sample 1: -1 s comes after 0 s; "
        "sort the samples and drop repeated timestamps"
    )
    assert spec.update(1, [("x", 0.0)]) == 1.0


def test_issue_177_values_of_subformulas_are_there_offline_and_online():
    spec = specification("low = x <= 3; once[0,1](low and y >= 2)")
    offline(spec, [1.0, 4.0], [5.0, 6.0])
    assert spec.get_value("low") == spec.get_value("(x)<=(3.0)") == [2.0, -1.0]
    assert spec.get_value("((x)<=(3.0))and((y)>=(2.0))") == [2.0, -1.0]
    online(spec, [1.0, 4.0], [5.0, 6.0])
    assert spec.get_value("low") == spec.get_value("(x)<=(3.0)") == -1.0
    assert spec.get_value("out") == 2.0


def test_a_variable_called_like_an_operator_works():
    spec = specification("always(G >= 1 and s >= 0)", "G s")
    assert spec.evaluate({"time": [0, 1], "G": [3, 2], "s": [5, 0]}) == [[0.0, 0.0], [1.0, 0.0]]
