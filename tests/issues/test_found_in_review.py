"""Faults that reviews of our own engine found: each with the symptom in its name."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import numpy as np
import pytest

import rtamt
from rtamt.language.operators import STL

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


def test_masked_values_are_missing_values() -> None:
    x = np.ma.array([1.0, 2.0, 3.0], mask=[0, 1, 0])
    result = rtamt.parse("x >= 1").evaluate({"x": x})
    assert (result.intervals.lower.tolist(), result.intervals.upper.tolist()) == (
        [0, -np.inf, 2],
        [0, np.inf, 2],
    )
    with pytest.raises(rtamt.EvaluationError) as info:
        _ = rtamt.parse("always(x >= 1)").evaluate({"x": x}).robustness
    assert str(info.value) == (
        "the robustness at time 0 is only known to lie between -inf and 0, because samples are missing or "
        "uncertain; read result.interval or result.intervals"
    )


def test_a_stamp_that_is_not_a_time() -> None:
    with pytest.raises(rtamt.TraceError) as info:
        rtamt.parse("x >= 1").evaluate({"time": np.array(["NaT"], "M8[ns]"), "x": [1.0]})
    assert str(info.value) == "time is nan at sample 0: give a finite number of seconds"


def test_stamps_that_count_from_1970_give_the_period_they_were_made_with() -> None:
    times = 1.7e9 + 0.001 * np.arange(50)
    result = rtamt.parse("always[0:5ms] x").evaluate({"time": times, "x": np.ones(50)})
    assert result.robustness == 1
    timestamps = np.datetime64("2026-01-01T00:00:00", "ms") + np.arange(50)
    assert rtamt.parse("always[0:5ms] x").evaluate({"time": timestamps, "x": np.ones(50)}).robustness == 1


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_bound_that_no_machine_can_keep(backend: str) -> None:
    spec = rtamt.parse("once[0:1e30] x", backend=backend)
    message = (
        "1000000000000000000000000000000 s is 1e+30 periods of 1 s, more than can be counted; "
        "shorten the bound, leave it open with inf, or choose a longer period\n"
        "  line 1, column 5:\n"
        "    once[0:1e30] x\n"
        "        ^^^^^^^^"
    )
    for call in (spec.monitor, lambda: spec.evaluate({"x": [1.0]})):
        with pytest.raises(rtamt.BoundError) as info:
            call()
        assert str(info.value) == message


def test_more_memory_than_there_is() -> None:
    with pytest.raises(rtamt.UsageError) as info:
        rtamt.parse("once[0:1e13] x").monitor()
    assert str(info.value) == (
        "the monitor needs 7.45e+04 GiB of memory, which this machine does not give; "
        "shorten the longest bound or lengthen the period"
    )


@pytest.mark.parametrize("tolerance", [-1, float("nan"), "a"])
def test_a_tolerance_that_is_none(tolerance: Any) -> None:
    for backend in BACKENDS:
        with pytest.raises(rtamt.UsageError) as info:
            rtamt.parse("x", backend=backend).monitor(tolerance=tolerance)
        assert str(info.value) == f"the tolerance is {tolerance!r}; give a fraction of the period, 0 or more"


@pytest.mark.parametrize("value", [float("nan"), "a", None])
def test_a_constant_that_is_no_number(value: Any) -> None:
    with pytest.raises(rtamt.UsageError) as info:
        rtamt.parse("x >= c", constants={"c": value})
    assert str(info.value) == f"the constant 'c' is {value!r}; give a number"


def test_a_specification_can_be_copied_and_sent_to_another_process() -> None:
    spec = rtamt.parse("const float c = 2; low = x <= c; always[0:5] low and x >= d", constants={"d": 1})
    spec.evaluate({"x": [1, 2]})
    for again in (pickle.loads(pickle.dumps(spec)), copy.deepcopy(spec)):  # noqa: S301 - our own bytes
        assert again.formula == spec.formula
        assert again.evaluate({"x": [1, 2]}).robustness == 0
        assert hash(again) != 0


def test_ten_thousand_conjuncts_can_be_shown_and_copied() -> None:
    spec = rtamt.parse(" and ".join(["x >= 1"] * 10_000))
    assert len(repr(spec)) > 10_000
    assert pickle.loads(pickle.dumps(spec)).formula == spec.formula  # noqa: S301 - our own bytes


def test_a_declared_variable_that_is_not_read_may_be_given() -> None:
    spec = rtamt.parse("input float x; input float y; once x")
    monitor = spec.monitor()
    assert monitor.update(0, x=1, y=2) == 1
    np.testing.assert_array_equal(monitor.update_many({"x": [0.0], "y": [1.0]}).values, [1.0])
    assert spec.evaluate({"x": [1.0], "y": [2.0]}).robustness == 1


def test_signals_and_results_can_be_compared() -> None:
    result = rtamt.parse("x").evaluate({"x": [1.0, 2.0]})
    assert result.signal == result.signal
    assert result != rtamt.parse("x").evaluate({"x": [1.0, 2.0]})


def test_a_sub_formula_over_what_was_not_read() -> None:
    result = rtamt.parse("x").evaluate({"x": [1.0, 2.0]})
    with pytest.raises(rtamt.UsageError) as info:
        result["z >= 1"]
    assert str(info.value) == (
        "'z >= 1' reads 'z', which the formula does not; the recording was read for x only"
    )


def test_writing_into_a_result_changes_no_other() -> None:
    result = rtamt.parse("x").evaluate({"time": [0.0, 1.0], "x": [1.0, 2.0]})
    with pytest.raises(ValueError, match="read-only"):
        result.signal.times[:] = 99
    np.testing.assert_array_equal(result["x"].times, [0.0, 1.0])


@pytest.mark.parametrize("reads", [{}, {"guards": ()}])
def test_what_has_no_rule_for_pastification_is_refused(reads: dict[str, Any]) -> None:
    once, always = STL["once"], STL["always"]
    coming = type(always)(
        "coming", ("coming",), always.fixity, 75, always.operands, always.result, "doc", "coming x", "{0}",
        always.definition, always.tense, always.bounds, **reads,
    )  # fmt: skip
    behind = type(once)(
        "behind", ("behind",), once.fixity, 75, once.operands, once.result, "doc", "behind x", "{0}",
        once.definition, once.tense, once.bounds, **reads,
    )  # fmt: skip
    language = STL.extend(coming, behind)
    with pytest.raises(rtamt.SpecificationError) as info:
        rtamt.parse("coming[0:2] x", language=language).pastified()
    assert info.value.message == (
        "Cannot pastify 'coming': its record names no past twin; "
        "monitor the formula as it is, which needs no pastification"
    )
    with pytest.raises(rtamt.SpecificationError) as info:
        rtamt.parse("behind[0:2](next x)", language=language).pastified()
    assert info.value.message == (
        "Cannot pastify 'behind': its record names no guards; "
        "monitor the formula as it is, which needs no pastification"
    )


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_an_inner_name_in_a_message(time: str) -> None:
    data: Any = {"time": [0.0, 1.0], "x": [-1.0, -2.0]}
    with pytest.raises(rtamt.EvaluationError) as info:
        rtamt.parse("always(sqrt(eventually x) >= 0)").evaluate(data, time=time)
    where = "sample 0, time 0 s" if time == "discrete" else "time 0 s"
    assert str(info.value) == (
        f"'sqrt(eventually x)' has no value at {where}: it is 0/0, inf - inf, 0 * inf, "
        f"or a function outside its domain; change the formula or the data so that this cannot happen"
    )


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_dense_sub_formula_does_not_see_what_lies_before_the_recording_begins(backend):
    # y begins at 2 s, and so does the recording: the formula never reads the 9 that x is at 0 s.
    spec = rtamt.parse("once(x >= 1) or y >= 1", backend=backend)
    data = {"x": ([0, 1, 5], [9, 1, 2]), "y": ([2, 8], [-9, -9])}
    result = spec.evaluate(data, time="dense")
    for signal in (result.signal, result["once(x >= 1)"]):
        assert (signal.times.tolist(), signal.values.tolist()) == ([2, 5, 8], [0, 1, 1])
    assert result["eventually(x >= 1)"].times.tolist() == [2, 8]


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


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_both_back_ends_say_the_same_of_an_operation_that_has_no_value(time: str) -> None:
    """The core told of 'x - y', without the last digits of the time; the definition of 'x >= y'."""
    timestamps, values = [1.7e9, 1.7e9 + 1], [1.0, np.inf]
    data: Any = {"time": timestamps, "x": values, "y": values}
    if time == "dense":
        data = {"x": (timestamps, values), "y": (timestamps, values)}
    where = ("sample 1, " if time == "discrete" else "") + "time 1700000001 s"
    for backend in BACKENDS:
        with pytest.raises(rtamt.EvaluationError) as info:
            rtamt.parse("always(x >= y)", backend=backend, time=time).evaluate(data)
        assert str(info.value) == (
            f"'x >= y' has no value at {where}: it is 0/0, inf - inf, 0 * inf, "
            f"or a function outside its domain; change the formula or the data so that this cannot happen"
        )


@pytest.mark.parametrize(
    ("second", "value", "message"),
    [
        (0.0, 1.0, "time does not increase at sample 1: 1700000000.25 s comes after 1700000000.25 s; "),
        (0.5, 1.0, "sample 1 at 1700000000.75 s is 0.5 s after the one before, expected 1 s (within 10%): "),
        (1.0, np.nan, "'x' is NaN at sample 1, time 1700000001.25 s: "),
    ],
)
def test_stamps_that_count_from_1970_were_all_told_as_17e9(second: float, value: float, message: str) -> None:
    monitor = rtamt.parse("x >= 1").monitor()
    monitor.update(1700000000.25, x=1.0)
    with pytest.raises(rtamt.TraceError) as info:
        monitor.update(1700000000.25 + second, x=value)
    assert str(info.value).startswith(message)
