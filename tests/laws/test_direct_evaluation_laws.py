"""Recordings that one call reads and evaluates give what the general way gives, to the bit, or the same error."""

from __future__ import annotations

import pickle
import threading
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import polars as pl
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.signals.signal import Signal
from tests.laws.test_recording_laws import bits, columns, outcome, stamps
from tests.support.strategies import formulas

if TYPE_CHECKING:
    from collections.abc import Callable

FORMULAS = [
    "x + y >= 0",
    "always[0:3](x + y >= 0)",
    "always(x >= 0)",
    "eventually[2:inf](x >= y) and once(y > 1)",
    "always(x >= 0 -> (y >= 0 until x <= 1))",
    "sqrt(x) >= y",
]


@st.composite
def recordings(draw: st.DrawFn) -> dict[str, Any]:
    """Draw a recording, most of them with the period of the others."""
    n = draw(st.integers(1, 12))
    data = {name: draw(columns(n, odd=draw(st.integers(0, 4)) == 0)) for name in ("x", "y")}
    shape = draw(st.sampled_from(["none", "same", "same", "any"]))
    if shape == "same":
        data["time"] = draw(st.sampled_from([0.0, 1.7e9, -3.0])) + np.arange(n) * 0.5
    elif shape == "any":
        data["time"] = draw(stamps(n))
    return data


def facts(result: rtamt.Result) -> tuple[Any, ...]:
    """Return all that a result is made of."""
    trace = result.trace
    lower, upper = result.intervals.lower, result.intervals.upper
    return (
        *(bits(values) for values in (lower, upper, result.signal.times, trace.timestamps)),
        result.signal.times.flags.writeable,
        {name: bits(values) for name, values in trace.columns.items()},
        (trace.step, trace.inferred, len(trace), dict(trace.units)),
        (result.robustness, outcome(lambda: result.satisfied), repr(result), result.semantics),
    )


@settings(max_examples=200)
@given(
    st.sampled_from(FORMULAS) | formulas(unbounded_future=True).map(str),
    st.lists(recordings(), min_size=2, max_size=6),
    st.sampled_from([None, "500ms"]),
)
def test_a_specification_evaluates_one_recording_after_another_as_a_new_one(
    text: str, data: list[dict[str, Any]], period: str | None
) -> None:
    def evaluated(spec: rtamt.Specification, one: Any) -> Any:
        return outcome(lambda: facts(spec.evaluate(one)))

    spec = outcome(lambda: rtamt.parse(text, period=period))
    assume(not isinstance(spec, str))  # a bound that is no multiple of the period
    for one in data:
        assert evaluated(spec, one) == evaluated(rtamt.parse(text, period=period), MappingProxyType(one))


@settings(max_examples=300)
@given(formulas(unbounded_future=True).map(str), recordings())
def test_a_requirement_is_satisfied_if_it_is_never_violated(text: str, data: dict[str, Any]) -> None:
    result = outcome(lambda: rtamt.parse(text).evaluate(data))
    assume(not isinstance(result, str) and not result.trace.bounds)
    assert outcome(lambda: result.satisfied) == outcome(lambda: rtamt.first_violation(result) is None)


def evaluate_twice(text: str, data: Any, time: str = "discrete") -> rtamt.Result:
    """Return the result of the second evaluation, which is direct."""
    spec = rtamt.parse(text, time=time)
    spec.evaluate(data)
    direct = spec.__dict__["_direct"]
    assert direct[0](data if isinstance(data, dict) else direct[1](data, spec.input_names)) is not None
    return spec.evaluate(data)


@pytest.mark.parametrize("text", FORMULAS)
@pytest.mark.parametrize("n", [100, 50_000])
def test_plain_recordings_are_evaluated_directly(text: str, n: int) -> None:
    data = {"time": 3.0 + np.arange(n) * 0.1, "x": np.linspace(0, 2, n), "y": np.linspace(1, 0, n)}
    assert facts(evaluate_twice(text, data)) == facts(rtamt.parse(text).evaluate(data))


@pytest.mark.parametrize("library", [pd, pl])
def test_plain_frames_are_evaluated_directly(library: Any) -> None:
    data = {"time": np.arange(9) * 0.1, "x": np.arange(9), "y": np.ones(9)}
    assert facts(evaluate_twice(FORMULAS[1], library.DataFrame(data))) == facts(
        rtamt.parse(FORMULAS[1]).evaluate(data)
    )


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_the_signal_of_a_result_is_one_object_with_the_times_of_the_trace(time: str) -> None:
    data = {"time": np.arange(9) * 0.5, "x": np.linspace(0, 2, 9)}
    result = evaluate_twice("once[0:1](x >= 1)", data, time=time)
    assert result.signal is result.signal
    assert type(result.signal) is Signal
    if time == "discrete":
        assert np.shares_memory(result.signal.times, result.trace.times)
        with pytest.raises(ValueError, match="read-only"):
            result.trace.times[0] = 1.0


def test_a_signal_keeps_no_columns_of_a_long_recording() -> None:
    n = 50_000
    signal = evaluate_twice("x >= y", {"time": np.arange(float(n)), "x": np.ones(n), "y": np.zeros(n)}).signal
    kept, seen = [signal._times._rows], []
    while kept:
        one = kept.pop()
        kept += one if isinstance(one, list) else []
        seen += [one] if isinstance(one, np.ndarray) else []
    assert [array[-1] for array in seen] == [n - 1]


def test_a_copied_signal_has_its_own_times_alone() -> None:
    data = {"time": np.arange(50.0)} | {name: np.ones(50) for name in "uvwxyz"}
    result = evaluate_twice("u + v + w + x + y + z >= 0", data)
    pickled = pickle.dumps(result.signal)
    assert len(pickled) < 3 * result.signal.times.nbytes
    copied = pickle.loads(pickled)
    assert copied.times.tolist() == list(range(50))
    assert not copied.times.flags.writeable


@pytest.mark.parametrize("n", [10, 50_000])
def test_a_result_keeps_its_values_when_the_data_change(n: int) -> None:
    data = {"time": np.arange(float(n)), "x": np.arange(float(n))}
    spec = rtamt.parse("always[0:2](x >= 1)")
    spec.evaluate(data)
    results = [spec.evaluate(data) for _ in range(2)]
    data["x"][:] = -9.0
    data["time"][:] = 0.0
    results[0].signal.values[:] = 7.0
    assert results[1].robustness == -1.0
    assert results[1].signal.times[-1] == n - 1
    assert results[0].trace.columns["x"][-1] == results[1]["x"].values[-1] == n - 1
    assert results[1].satisfied is False


def test_units_and_semantics_belong_to_a_result_that_is_found_directly() -> None:
    spec = rtamt.parse("input float x [m]; x >= 1", semantics="boolean")
    data = {"x": np.array([3.0, 0.0])}
    spec.evaluate(data)
    result = spec.evaluate(data)
    assert (dict(result.trace.units), result.semantics) == ({"x": "m"}, "boolean")


def test_a_result_that_is_found_directly_is_pickled() -> None:
    result = evaluate_twice(FORMULAS[2], {"x": np.arange(4.0), "time": np.arange(4) * 0.25})
    assert facts(pickle.loads(pickle.dumps(result))) == facts(result)


def test_threads_share_a_specification_that_evaluates_directly() -> None:
    spec = rtamt.parse("always[0:50](x >= 0)")
    data = [{"x": np.random.default_rng(i).normal(size=5000)} for i in range(8)]
    expected = [facts(rtamt.parse(str(spec)).evaluate(one)) for one in data]
    found: dict[int, Any] = {}

    def run(i: int) -> Callable[[], None]:
        return lambda: found.__setitem__(i, [facts(spec.evaluate(data[i])) for _ in range(20)])

    spec.evaluate(data[0])
    threads = [threading.Thread(target=run(i)) for i in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == {i: [each] * 20 for i, each in enumerate(expected)}
