"""Every sentence of the paper's API about wrong data, in full."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

import rtamt
from tests.errors.rtamt_classes import Sensor, fresh, message_of, provide

NAN = float("nan")


@pytest.fixture(autouse=True)
def messages(monkeypatch):
    provide(monkeypatch)


OFFLINE = {
    "no mapping": (
        [[0, 1]],
        "expected a mapping from variable to values, such as {'time': [...], 'x': [...]}, got list",
    ),
    "no time": ({"x": [1]}, "the data has no 'time'; signals: x"),
    "no variable": (
        {"time": [0], "xs": [1]},
        "the data has no 'x'; did you mean 'xs'? (signals: xs)",
    ),
    "lengths": (
        {"time": [0, 1], "x": [1]},
        "'time' has 2 and 'x' has 1 samples: give one value of each at every sample",
    ),
    "empty": ({"time": [], "x": []}, "the trace is empty: give at least one sample"),
    "NaN": (
        {"time": [0, 0.5], "x": [1, NAN]},
        "'x' is NaN at sample 1, time 0.5 s: fill the gap or leave the sample out",
    ),
    "text": ({"time": [0, 1], "x": [1, "a"]}, "'x' is 'a' at sample 1, expected a number"),
    "time": (
        {"time": [0, 2, 1], "x": [1, 1, 1]},
        "time does not increase at sample 2: 1 s comes after 2 s; sort the samples and drop repeated timestamps",
    ),
}


@pytest.mark.parametrize("case", OFFLINE)
def test_wrong_data_offline(case):
    data, message = OFFLINE[case]
    spec = fresh("x >= 1")
    assert message_of(lambda: spec.evaluate(data)) == message


def test_an_object_without_the_field_offline():
    spec = fresh("sensor.value")
    data = {"time": [0, 1], "sensor": [Sensor(), SimpleNamespace(speed=1.0)]}
    assert message_of(lambda: spec.evaluate(data)) == (
        "'sensor' has no field 'value' at sample 1: it is a SimpleNamespace"
    )


NO_PAIRS = "expected pairs of a name and a value, such as [('x', 1.0)], got "
ONLINE = {
    "no pairs": (1, 5, NO_PAIRS + "5"),
    "names only": (1, ["x"], NO_PAIRS + "['x']"),
    "unknown name": (
        1,
        [("xx", 1.0)],
        "the formula has no variable 'xx'; did you mean 'x'? (variables: x)",
    ),
    "NaN": (1, [("x", NAN)], "'x' is NaN at sample 1, time 1 s: fill the gap or leave the sample out"),
    "text": (1, [("x", "a")], "'x' is 'a' at sample 1, expected a number"),
    "None": (1, [("x", None)], "'x' is None at sample 1, expected a number"),
    "time": (
        -1,
        [("x", 1.0)],
        "time does not increase at sample 1: -1 s comes after 0 s; sort the samples and drop repeated timestamps",
    ),
    "no time": (None, [("x", 1.0)], "time is None at sample 1, expected a number of seconds"),
    "infinite time": (
        float("inf"),
        [("x", 1.0)],
        "time is inf at sample 1: give a finite number of seconds",
    ),
    "no value": (
        2,
        [("x", 0.0)],
        "'0 / x' has no value at sample 1, time 2 s: it is 0/0, inf - inf, 0 * inf, "
        "or a function outside its domain; change the formula or the data so that this cannot happen",
    ),
}


@pytest.mark.parametrize("case", ONLINE)
def test_wrong_data_online(case):
    time, pairs, message = ONLINE[case]
    spec = fresh("once(0 / x >= 0)")
    spec.update(0, [("x", 1.0)])
    assert message_of(lambda: spec.update(time, pairs)) == message


def test_the_first_update_needs_every_variable():
    spec = fresh("x + y")
    assert message_of(lambda: spec.update(0, [("x", 1.0)])) == (
        "'y' has no value yet at sample 0: give every variable in the first update; "
        "later ones may leave it out"
    )
    assert spec.update(0, [("x", 1.0), ("y", 1.0)]) == 2.0


def test_an_object_without_the_field_online():
    spec = fresh("sensor.value")
    assert message_of(lambda: spec.update(0, [("sensor", 3.0)])) == (
        "'sensor' has no field 'value' at sample 0: it is a float"
    )


def test_times_in_messages_are_seconds_whatever_the_unit():
    spec = fresh("x")
    spec.unit = "ms"
    spec.update(0, [("x", 1.0)])
    assert message_of(lambda: spec.update(1500, [("x", NAN)])) == (
        "'x' is NaN at sample 1, time 1.5 s: fill the gap or leave the sample out"
    )
    assert message_of(lambda: spec.evaluate({"time": [0, 1500], "x": [1, NAN]})) == (
        "'x' is NaN at sample 1, time 1.5 s: fill the gap or leave the sample out"
    )


def test_values_that_do_not_exist():
    spec = fresh("once(x >= 1)")
    spec.update(0, [("x", 3), ("y", 1)])
    assert message_of(lambda: spec.get_value("y")) == (
        "the specification does not read 'y', so that its values are not kept"
    )
    assert message_of(lambda: spec.get_value("x >= 2")) == (
        "'x >= 2' is no part of the specification once((x)>=(1.0))"
    )
    assert message_of(lambda: spec.get_value("xx"), rtamt.STLParseException) == (
        "'xx' is not declared; did you mean 'x'?\n  line 1, column 1:\n    xx\n    ^^"
    )


def test_the_original_error_is_the_cause():
    with pytest.raises(rtamt.RTAMTException) as info:
        fresh("once[5:2] x")
    assert isinstance(info.value.__cause__, rtamt.BoundError)
