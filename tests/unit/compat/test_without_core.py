"""Where the compiled core cannot be loaded, the paper's classes work on the definition."""

from __future__ import annotations

import sys
from types import ModuleType

import pytest

import rtamt
from tests.unit.compat.test_discrete import Message, declared


@pytest.fixture(autouse=True)
def no_core(monkeypatch):
    """Make the compiled core impossible to load."""
    monkeypatch.setitem(sys.modules, "rtamt.engine._core", None)
    monkeypatch.delattr("rtamt.engine._core", raising=False)


def test_the_definition_evaluates():
    spec = declared("low = x <= 3; always(low)")
    spec.set_sampling_period(10, "ms")
    spec.unit = "ms"
    assert spec.evaluate({"time": [0, 10, 30], "x": [1, 5, 2]}) == [[0.0, -2.0], [10.0, -2.0], [30.0, 1.0]]
    assert spec.sampling_violation_counter == 1
    assert spec.get_value("low") == spec.get_value("(x)<=(3.0)") == [2.0, -2.0, 1.0]


@pytest.mark.parametrize(
    "cls", [rtamt.StlDiscreteTimeSpecification, rtamt.StlDiscreteTimeOnlineSpecification]
)
def test_the_definition_watches(cls):
    spec = declared("always[0:1](x + y >= 3)", cls=cls)
    spec.set_sampling_period(500, "ms")
    spec.pastify()
    for _ in range(2):
        assert spec.update(7.0, [("x", 5), ("y", 1)]) == 3.0
        assert spec.update(7.5, [("x", 3)]) == 1.0
        assert spec.update(9.0, zip("xy", [4.0, 4.0], strict=True)) == 1.0
        assert spec.sampling_violation_counter == 1
        assert spec.get_value("x") == 4.0
        assert spec.get_value("x + y") == 8.0
        assert spec.get_value("x + y >= 3") == 5.0
        assert spec.get_value(spec.spec_print()) == 1.0
        spec.reset()
        assert spec.sampling_violation_counter == 0


def test_objects_are_read_and_written(monkeypatch):
    module = ModuleType("some_msgs")
    module.Message = Message
    monkeypatch.setitem(sys.modules, "some_msgs", module)
    spec = rtamt.StlDiscreteTimeSpecification()
    spec.import_module("some_msgs", "Message")
    spec.declare_var("req", "Message")
    spec.declare_var("rob", "Message")
    spec.spec = "rob.value = once(req.value >= 3)"
    spec.parse()
    assert spec.update(0, [("req", Message(5.0))]) is spec.get_value("rob")
    spec.var_object_dict["req"] = Message(9.0)
    assert spec.update(1, []).value == 6.0


def test_an_update_that_fails_leaves_the_monitor_as_it_was():
    spec = declared("once(x / y >= 1)")
    assert spec.update(0, [("x", 4), ("y", 2)]) == 1.0
    with pytest.raises(rtamt.RTAMTException) as info:
        spec.update(1, [("x", 0.0), ("y", 0.0)])
    assert str(info.value) == (
        "RTAMT Exception: 'x / y' has no value at sample 1, time 1 s: it is 0/0, inf - inf, 0 * inf, "
        "or a function outside its domain; "
        "change the formula or the data so that this cannot happen"
    )
    with pytest.raises(rtamt.RTAMTException) as info:
        spec.update(1, [("x", float("nan"))])
    assert str(info.value) == (
        "RTAMT Exception: 'x' is NaN at sample 1, time 1 s: fill the gap or leave the sample out"
    )
    assert spec.update(1, [("x", 8)]) == 3.0
