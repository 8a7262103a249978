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


@pytest.mark.parametrize(
    "other",
    [["on"] * 9, np.arange(9) > 3, np.arange(9) * np.timedelta64(1, "s"), [None] * 9, [1, "a"] * 4 + [None]],
    ids=["texts", "truths", "durations", "nulls", "mixed"],
)
@pytest.mark.parametrize("place", ["first", "last"])
def test_frames_of_pandas_with_numbers_beside_other_values_are_evaluated_directly(
    other: Any, place: str
) -> None:
    plain = {"time": np.arange(9) * 0.1, "x": np.arange(9), "y": np.ones(9)}
    unread = {"z": pd.Series(other)}
    data = unread | plain if place == "first" else plain | unread
    assert facts(evaluate_twice(FORMULAS[1], pd.DataFrame(data))) == facts(
        rtamt.parse(FORMULAS[1]).evaluate(plain)
    )


FRAMES = {
    "numbers": {"x": [1.0, 2.0, 0.0], "y": [3.0, 1.0, 2.0]},
    "integers": {"x": [1, 2, 2**53 + 1], "y": np.array([3, 1, 2**64 - 1], np.uint64)},
    "single": {"x": np.array([0.1, 0.2, 0.3], np.float32), "y": np.array([1, 2, 3], np.int8)},
    "truths": {"x": [True, False, True], "y": [False, False, True]},
    "truths beside numbers": {"x": [True, False, True], "y": [3.0, 1.0, 2.0]},
    "nullable": {"x": pd.array([1, 2, 3], "Int64"), "y": pd.array([0.5, 1.5, 2.5], "Float64")},
    "null": {"x": pd.array([1, None, 3], "Int64"), "y": [3.0, 1.0, 2.0]},
    "nullable truths": {"x": pd.array([True, False, True], "boolean"), "y": [3.0, 1.0, 2.0]},
    "categories": {"x": pd.Categorical([1.0, 2.0, 1.0]), "y": [3.0, 1.0, 2.0]},
    "NaN": {"x": [1.0, float("nan"), 0.0], "y": [3.0, 1.0, 2.0]},
    "infinite": {"x": [1.0, float("inf"), 0.0], "y": [3.0, 1.0, 2.0]},
    "half": {"x": np.array([0.1, 0.2, 0.3], np.float16), "y": np.array([1, 2, 3], np.float16)},
    "complex": {"x": np.array([1j, 2, 3]), "y": np.array([1j, 2, 3])},
    "texts": {"x": ["1", "2", "3"], "y": ["1", "2", "3"]},
    "dates": {"x": np.arange(3) * np.timedelta64(1, "s"), "y": np.arange(3) * np.timedelta64(2, "s")},
    "big-endian": {"x": np.array([1.0, 2.0, 0.0], ">f8"), "y": np.array([3.0, 1.0, 2.0], ">f8")},
}


@pytest.mark.parametrize("number", [2, 4], ids=["regular", "irregular"])
@pytest.mark.parametrize("kind", FRAMES)
def test_frames_of_pandas_of_any_type_evaluate_as_their_columns_do(kind: str, number: int) -> None:
    data = {"time": np.array([0, 1, number], float), **FRAMES[kind]}
    frame = pd.DataFrame(data)
    wide = pd.concat([frame, frame[["x", "y"]].rename(columns={"x": "u", "y": "v"})], axis=1)
    split = pd.DataFrame({"time": data["time"]})
    for name, values in FRAMES[kind].items():
        split[name] = values  # a block of memory of its own
    spec = rtamt.parse(FORMULAS[1])
    spec.evaluate({"time": [0.0, 1.0, 2.0], "x": [1.0, 2.0, 3.0], "y": [0.0, 0.0, 0.0]})
    expected = outcome(lambda: facts(rtamt.parse(FORMULAS[1]).evaluate(MappingProxyType(columns_of(frame)))))
    for each in (frame, wide, split, frame.iloc[::-1].iloc[::-1], frame):
        copy = each.copy()
        assert outcome(lambda one=each: facts(spec.evaluate(one))) == expected
        pd.testing.assert_frame_equal(each, copy, check_dtype=False)  # copies have the native byte order


def columns_of(frame: pd.DataFrame) -> dict[str, Any]:
    """Return the columns of a frame as its library converts each by itself."""
    return {str(name): frame[name] for name in frame}


def test_frames_of_pandas_with_equal_columns_are_told_apart_by_their_values() -> None:
    plain = {"time": np.arange(9) * 0.1, "x": np.arange(9) * 1.0, "y": np.ones(9)}
    numbers = pd.DataFrame(plain)
    texts = pd.DataFrame({**plain, "y": ["a"] * 9})
    texts.columns = numbers.columns
    spec = rtamt.parse(FORMULAS[1])
    expected = facts(rtamt.parse(FORMULAS[1]).evaluate(plain))
    for _ in range(3):
        assert facts(spec.evaluate(numbers)) == expected
        with pytest.raises(rtamt.TraceError, match="'y'"):
            spec.evaluate(texts)


def test_a_column_of_pandas_called_like_a_method_of_polars_is_read_as_a_column() -> None:
    data = {"time": np.arange(9) * 0.1, "get_column": np.arange(9) * 1.0, "z": ["a"] * 9}
    result = evaluate_twice("once(get_column >= 2)", pd.DataFrame(data))
    assert result.robustness == -2.0


def test_frames_of_pandas_with_two_equal_names_or_levels_of_names_are_not_read_at_once() -> None:
    frame = pd.DataFrame({"time": np.arange(9) * 0.1, "x": np.arange(9) * 1.0, "y": np.ones(9)})
    spec = rtamt.parse("x >= 0")
    assert spec.evaluate(frame).robustness == 0.0
    assert spec.evaluate(frame).robustness == 0.0
    for names in (["time", "x", "x"], ["time", "time", "x"]):
        twice = frame.set_axis(names, axis=1)
        with pytest.raises(rtamt.TraceError):
            spec.evaluate(twice)
    levels = frame.set_axis(pd.MultiIndex.from_tuples([("time", ""), ("x", "a"), ("z", "a")]), axis=1)
    assert outcome(lambda: facts(spec.evaluate(levels))) == outcome(
        lambda: facts(rtamt.parse("x >= 0").evaluate(levels))
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
