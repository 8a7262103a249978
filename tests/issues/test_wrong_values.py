"""Formulas that had a wrong value, none, or could not be evaluated."""

from __future__ import annotations

import numpy as np
import pytest

import rtamt

BACKENDS = ["cpp", "python"]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("text", "x", "values"),
    [
        ("9 precedes[2:3] x", [5, 1], [5, 5]),
        ("9 precedes[3:5] x", [5, 1, 0], [5, 5, 5]),
        ("-3 precedes[1:2] (next x)", [1, -1, 1, 2, 2, 0, 2], [-1, -1, -3, -3, -3, -3, -3]),
        ("false precedes[1:1] (next x)", [4, -1], [-1, -np.inf]),
    ],
)
def test_precedes_over_short_traces_and_constants(
    text: str, x: list[float], values: list[float], backend: str
) -> None:
    np.testing.assert_array_equal(rtamt.parse(text, backend=backend).evaluate({"x": x}).signal.values, values)


@pytest.mark.parametrize("backend", BACKENDS)
def test_an_answer_before_the_horizon_where_an_operand_does_not_matter(backend: str) -> None:
    monitor = rtamt.parse("(always[0:2] x) until[0:0] 3", backend=backend).monitor()
    assert [monitor.step(0.0) for _ in range(3)] == [None, None, 3.0]


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_dense_sub_formula_does_not_see_what_lies_before_the_recording_begins(backend):
    # y begins at 2 s, and so does the recording: the formula never reads the 9 that x is at 0 s.
    spec = rtamt.parse("once(x >= 1) or y >= 1", backend=backend)
    data = {"x": ([0, 1, 5], [9, 1, 2]), "y": ([2, 8], [-9, -9])}
    result = spec.evaluate(data, time="dense")
    for signal in (result.signal, result["once(x >= 1)"]):
        assert (signal.times.tolist(), signal.values.tolist()) == ([2, 5, 8], [0, 1, 1])
    assert result["eventually(x >= 1)"].times.tolist() == [2, 8]


def test_a_declared_variable_that_is_not_read_may_be_given() -> None:
    spec = rtamt.parse("input float x; input float y; once x")
    monitor = spec.monitor()
    assert monitor.update(0, x=1, y=2) == 1
    np.testing.assert_array_equal(monitor.update_many({"x": [0.0], "y": [1.0]}).values, [1.0])
    assert spec.evaluate({"x": [1.0], "y": [2.0]}).robustness == 1


def test_a_window_after_a_comparison_was_refused_though_it_can_be_read_in_one_way_only() -> None:
    spec = rtamt.StlDiscreteTimeSpecification()
    spec.declare_const("d", "float", "2")
    spec.declare_const("c", "float", "5.5")
    spec.spec = "a + b >= once[0, d s] c"
    spec.parse()
    assert spec.update(0, [("a", 1), ("b", 2)]) == -2.5


@pytest.mark.parametrize("name", ["StlDenseTimeSpecification", "StlDenseTimeOfflineSpecification"])
def test_a_sampling_period_set_for_dense_time_was_an_attribute_error(name: str) -> None:
    spec = getattr(rtamt, name)()
    spec.set_sampling_period(1, "s", 0.1)
    spec.spec = "always((dist <= 0.5) implies (vel == 0.0))"
    spec.parse()
    assert spec.evaluate(["dist", [[0, 0], [1, 0.25]]], ["vel", [[0, 0], [1, 0.25]]]) == [
        [0, -0.25],
        [1, -0.25],
    ]
    with pytest.raises(rtamt.RTAMTException, match="fraction of the period"):
        spec.set_sampling_period(1, "s", 1.5)
