"""The paper's online API in discrete time: pairs, objects with fields, failed updates."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

import rtamt
from tests.unit.compat.messages import Inner, Message, declared, with_messages


def test_a_variable_left_out_keeps_its_value():
    spec = declared("x + y")
    assert spec.update(0, [("x", 1), ("y", 2)]) == 3.0
    assert spec.update(1, [("x", 10)]) == 12.0
    assert spec.update(2, []) == 12.0


def test_a_declared_variable_that_is_not_read_may_be_given():
    spec = declared("x >= 1")
    assert spec.update(0, [("y", "anything"), ("x", 3)]) == 2.0


@pytest.mark.parametrize(
    "pairs",
    [
        [("x", 3.0), ("y", 1.0)],
        [["x", 3], ["y", True]],
        (("x", np.float32(3)), ("y", np.int64(1))),
        {"x": 3.0, "y": 1.0}.items(),
        zip("xy", [Fraction(3), 1.0], strict=True),
    ],
)
def test_pairs_may_come_in_any_form(pairs):
    result = declared("x - y").update(0, pairs)
    assert (result, type(result)) == (2.0, float)


def test_every_update_gives_a_number_after_pastify():
    spec = declared("always[0,2](x)")
    spec.pastify()
    assert [spec.update(t, [("x", x)]) for t, x in enumerate([5, 4, 6, 7])] == [5.0, 4.0, 4.0, 4.0]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("ahead[1](x) + 2 > 0", [3.0, 7.0, 4.0]),
        ("ahead[1](x) + y > 0", [11.0, 15.0, 22.0]),
        ("ahead[1](x) * 2 > 3", [-1.0, 7.0, 1.0]),
    ],
)
def test_arithmetic_on_a_number_ahead_can_be_updated_after_pastify(text, expected):
    spec = declared(text)
    spec.pastify()
    samples = [(1, 10), (5, 20), (2, 30)]
    assert [spec.update(t, [("x", x), ("y", y)]) for t, (x, y) in enumerate(samples)] == expected


def test_online_violations_are_counted_from_reset_to_reset():
    spec = declared("x")
    for time in (0, 1, 3):
        spec.update(time, [("x", 1)])
    assert spec.sampling_violation_counter == 1
    spec.reset()
    assert spec.sampling_violation_counter == 0


def test_the_interpreter_has_the_counters_of_the_specification():
    spec = declared("x")
    spec.set_sampling_period(10, "ms", 0.1)
    spec.unit = "ms"
    interpreter = spec.online_interpreter

    def counters():
        return (
            interpreter.update_counter,
            interpreter.previous_time,
            interpreter.sampling_violation_counter,
        )

    assert counters() == (0, 0.0, 0)
    for time in (5, 15, 35):
        spec.update(time, [("x", 1)])
    assert counters() == (3, 35.0, 1)
    assert interpreter.get_sampling_frequency() == 100.0
    spec.reset()
    assert counters() == (0, 0.0, 0)
    spec.update(0, [("x", 1)])
    assert counters() == (1, 0.0, 0)
    with pytest.raises(AttributeError):
        interpreter.updateVisitor = None


@pytest.mark.parametrize(
    ("time", "pairs", "message"),
    [
        (
            2,
            [("x", float("nan"))],
            "'x' is NaN at sample 2, time 2 s: fill the gap or leave the sample out",
        ),
        (2, [("x", "text")], "'x' is 'text' at sample 2, expected a number"),
        (2, [("z", 1.0)], "the formula has no variable 'z'; variables: x, y"),
        (
            0,
            [("x", 50.0)],
            "time does not increase at sample 2: 0 s comes after 1 s; sort the samples and drop repeated timestamps",
        ),
        (
            2,
            [("x", 0.0), ("y", 0.0)],
            "'x / y' has no value at sample 2, time 2 s: it is 0/0, inf - inf, 0 * inf, "
            "or a function outside its domain; change the formula or the data so that this cannot happen",
        ),
    ],
    ids=["NaN", "text", "unknown name", "time goes back", "0/0"],
)
def test_an_update_that_fails_leaves_the_monitor_as_it_was(time, pairs, message):
    spec = declared("once(x / y >= 1)")
    assert spec.update(0, [("x", 4), ("y", 2)]) == 1.0
    assert spec.update(1, [("x", 1)]) == 1.0
    with pytest.raises(rtamt.RTAMTException) as info:
        spec.update(time, pairs)
    assert str(info.value) == f"RTAMT Exception: {message}"
    assert (spec.get_value("x"), spec.get_value("y"), spec.get_value("out")) == (1.0, 2.0, 1.0)
    assert spec.sampling_violation_counter == 0
    assert spec.update(2, []) == 1.0
    assert spec.update(3, [("x", 8)]) == 3.0


def test_a_result_with_a_field_is_written_into_the_declared_object():
    spec = with_messages("rob.value = once(req.value >= 3)")
    declared_object = spec.get_value("rob")
    given = Message(5.0)
    assert spec.update(0, [("req", given)]) is declared_object
    assert declared_object.value == 2.0
    assert spec.get_value("req") is given
    assert spec.get_value("req.value") == 5.0
    assert spec.get_value("rob.value") == 2.0
    with pytest.raises(rtamt.RTAMTException) as info:
        spec.update(1, [("req", Message(float("nan")))])
    assert str(info.value) == (
        "RTAMT Exception: 'req.value' is NaN at sample 1, time 1 s: fill the gap or leave the sample out"
    )
    assert declared_object.value == 2.0


def test_a_result_may_be_a_field_of_a_field():
    spec = with_messages("rob.inner.level = req.value")
    assert spec.update(0, [("req", Message(5.0))]).inner == Inner(5.0)


def test_objects_are_read_again_at_each_update():
    spec = with_messages("req.value")
    assert spec.update(0, []) == 0.0
    spec.get_value("req").value = 4.0
    assert spec.update(1, []) == 4.0
    spec.var_object_dict["req"] = Message(7.0)
    assert spec.update(2, []) == 7.0


def test_numbers_can_be_assigned_to_var_object_dict_between_updates():
    spec = declared("low = x <= 3; x + y", "x y low")
    assert spec.update(0, [("x", 1.0), ("y", 2.0)]) == 3.0
    assert spec.update(1, [("x", 2.0)]) == 4.0
    values = spec.var_object_dict
    assert values == {"x": 2.0, "y": 2.0, "low": 1.0, "out": 4.0}
    values["x"] = 10.0
    assert spec.get_value("x") == 10.0
    assert spec.update(2, [("y", 0.5)]) == 10.5
    assert (values["out"], values["low"], spec.get_value("low")) == (10.5, -7.0, -7.0)
    values["x"] = float("nan")
    with pytest.raises(rtamt.RTAMTException) as info:
        spec.update(3, [])
    assert str(info.value) == (
        "RTAMT Exception: 'x' is NaN at sample 3, time 3 s: fill the gap or leave the sample out"
    )
    values["x"] = 1.0
    assert spec.update(3, []) == 1.5
