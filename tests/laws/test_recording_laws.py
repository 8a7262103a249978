"""Data that the core reads in one call give what the general conversion gives, to the bit, or the same error."""

from __future__ import annotations

from fractions import Fraction
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import polars as pl
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.engine import native
from rtamt.engine.discrete import ENGINE
from rtamt.errors import StlError
from rtamt.language.contents import variables
from rtamt.signals.arrays import Timestamps
from rtamt.signals.discrete import Discrete
from rtamt.signals.inferred_period import infer_period
from rtamt.signals.sampling_period import has_period
from tests.support.strategies import chunkings, formulas, traces

if TYPE_CHECKING:
    from collections.abc import Callable

KINDS = ["f8", "f4", "f2", "i8", "i4", "i2", "i1", "u8", "u4", "u1", "?", ">f8", ">i4", "O", "longdouble"]
PLAIN = st.floats(-100, 100, width=32) | st.integers(-5, 5).map(float)
ODD = st.sampled_from(
    [float("nan"), float("inf"), -0.0, 1e300, 2**53 + 1, 2**64, True, None, "5", np.float64(2)]
)


@st.composite
def columns(draw: st.DrawFn, n: int, *, odd: bool = True) -> Any:
    """Draw n values in one of many containers, nearly all of them plain numbers."""
    values: list[Any] = draw(st.lists(PLAIN, min_size=n, max_size=n))
    if odd and n and draw(st.integers(0, 9)) == 0:
        values[draw(st.integers(0, n - 1))] = draw(ODD)
    container = draw(st.sampled_from(["list", "tuple", "array", "array", "strided", "reversed", "column"]))
    if container == "list":
        return values
    if container == "tuple":
        return tuple(values)
    try:
        with np.errstate(all="ignore"):
            array = np.array(np.array(values, float), draw(st.sampled_from(KINDS)))
    except (TypeError, ValueError):
        return values
    if container == "strided":
        array = np.repeat(array, 3)[::3]
    if container == "reversed":
        array = array[::-1].copy()[::-1]
    if container == "column":
        array = np.stack([array, array], axis=1)[:, 0]
    array.flags.writeable = draw(st.booleans())
    return array


@st.composite
def stamps(draw: st.DrawFn, n: int, start: float = 0.0) -> Any:
    """Draw n timestamps, most of them one period apart."""
    period = draw(st.sampled_from([1.0, 0.1, 0.01, 1 / 3, 0.020833, 3.0]))
    times = start + np.arange(n) * period
    if n and draw(st.integers(0, 3)) == 0:
        at, by = draw(st.integers(0, n - 1)), draw(st.sampled_from([0.05, 0.2, -1.5, np.nan, np.inf, 1e12]))
        times[at] += by * period
    if draw(st.booleans()):
        times = times + draw(st.sampled_from([1.7e9, -50.0, 0.3]))
    if draw(st.integers(0, 4)) == 0 and np.isfinite(times).all():
        times = times.astype(draw(st.sampled_from(["i8", "f4", "M8[ms]", "m8[s]"])))
    return times.tolist() if times.dtype.kind == "f" and draw(st.booleans()) else times


@st.composite
def recordings(draw: st.DrawFn) -> dict[str, Any]:
    n = draw(st.integers(0, 12))
    data = {name: draw(columns(n)) for name in ("x", "y")}
    if draw(st.integers(0, 9)) == 0:
        data["y"] = draw(columns(n + 1))
    if draw(st.integers(0, 9)) == 0:
        del data["x"]
    if draw(st.booleans()):
        data["time"] = draw(stamps(n))
    return data


def outcome(call: Callable[[], Any]) -> Any:
    """Return what a call returns, or its error message."""
    try:
        return call()
    except StlError as error:
        return str(error)


def bits(values: Any) -> tuple[Any, ...]:
    array = np.asarray(values)
    return array.dtype.str, array.tobytes()


@settings(max_examples=300)
@given(recordings(), st.sampled_from([None, Fraction(1), Fraction(1, 10)]), st.sampled_from([0.1, 0.0, 0.5]))
def test_what_the_core_reads_is_what_the_general_conversion_reads(
    data: dict[str, Any], period: Fraction | None, tolerance: float
) -> None:
    domain = Discrete(period, tolerance)
    read = ENGINE.read(data, ("x", "y"), domain)
    if read is None:
        return
    expected = domain.record(data, ("x", "y"))
    assert (read.period, read.inferred, read.unit) == (expected.period, expected.inferred, expected.unit)
    assert bits(read.times) == bits(expected.times)
    assert read.original is expected.original is None
    for name in ("x", "y"):
        assert bits(read.columns[name]) == bits(expected.columns[name])
        assert not np.shares_memory(read.columns[name], np.asarray(data[name]))


@settings(max_examples=150)
@given(recordings(), st.sampled_from([pd, pl]), st.sampled_from(["x", "note", "stamp"]), st.booleans())
def test_a_frame_is_read_as_the_general_conversion_reads_it(
    data: dict[str, Any], library: Any, other: str, large: bool
) -> None:
    if large:
        data = {
            name: np.resize(np.asarray(values, float), 5000) for name, values in data.items() if len(values)
        }
    try:
        frame = library.DataFrame({other: [1.0] * len(next(iter(data.values()), [])), **data})
    except Exception:  # noqa: BLE001 - of the library: it has no such columns
        return
    domain = Discrete()
    read = outcome(lambda: ENGINE.read(frame, ("x", "y"), domain))
    if read is None:
        return
    expected = outcome(lambda: domain.record(frame, ("x", "y")))
    if isinstance(read, str):
        assert read == expected
        return
    assert (read.period, read.inferred) == (expected.period, expected.inferred)
    assert bits(read.times) == bits(expected.times)
    assert all(bits(read.columns[name]) == bits(expected.columns[name]) for name in ("x", "y"))


@pytest.mark.parametrize("library", [pd, pl])
@pytest.mark.parametrize("n", [5, 5000])
def test_the_core_reads_plain_frames(library: Any, n: int) -> None:
    frame = library.DataFrame(
        {"time": np.arange(n) * 0.1, "x": np.arange(n), "y": np.ones(n), "z": np.ones(n)}
    )
    assert ENGINE.read(frame, ("x", "y"), Discrete()) is not None


@given(st.data(), st.integers(1, 12))
def test_the_core_reads_all_plain_data(data: st.DataObject, n: int) -> None:
    kinds = st.sampled_from(["f8", "f4", "i8", "i4", "i2", "i1", "u8", "u4", "u1", "?"])
    values = data.draw(st.lists(st.integers(0, 1), min_size=n, max_size=n))
    plain = {"x": np.repeat(np.array(values, data.draw(kinds)), 2)[::2], "time": np.arange(n) * 0.1}
    assert ENGINE.read(plain, ("x",), Discrete()) is not None
    assert ENGINE.read({"x": values, "time": tuple(range(n))}, ("x",), Discrete()) is not None


@given(formulas(unbounded_future=True), recordings())
def test_a_dict_evaluates_as_any_other_mapping(formula: Any, data: dict[str, Any]) -> None:
    spec = rtamt.parse(str(formula))
    one, other = (
        outcome(lambda given=given: spec.evaluate(given)) for given in (data, MappingProxyType(data))
    )
    if isinstance(other, str):
        assert one == other
        return
    assert bits(one.intervals.lower) == bits(other.intervals.lower)
    assert bits(one.intervals.upper) == bits(other.intervals.upper)
    assert bits(one.signal.times) == bits(other.signal.times)
    assert outcome(lambda: one.satisfied) == outcome(lambda: other.satisfied)


@settings(max_examples=60)
@given(st.data(), formulas())
def test_a_formula_evaluates_trace_after_trace_as_alone(data: st.DataObject, formula: Any) -> None:
    spec = rtamt.parse(str(formula))
    for columns_ in data.draw(st.lists(traces(infinite=True), min_size=2, max_size=5)):
        alone = outcome(lambda c=columns_: rtamt.parse(str(formula)).evaluate(c).signal.values.tobytes())
        assert outcome(lambda c=columns_: spec.evaluate(c).signal.values.tobytes()) == alone


@settings(max_examples=150)
@given(st.data(), formulas())
def test_a_chunk_in_a_dict_is_taken_as_any_other_mapping(data: st.DataObject, formula: Any) -> None:
    spec = rtamt.parse(str(formula))
    names = variables(formula)
    watch = [formula] if names else []
    monitors = [spec.monitor(watch=watch) for _ in range(2)]
    start = 0.0
    for size in data.draw(chunkings(12)):
        chunk = {name: data.draw(columns(size)) for name in names}
        if data.draw(st.booleans()):
            chunk["time"] = data.draw(stamps(size, start))
        found = [
            outcome(lambda m=monitor, g=given: m.update_many(g))
            for monitor, given in zip(monitors, (chunk, MappingProxyType(chunk)), strict=True)
        ]
        assert monitors[0].samples == monitors[1].samples
        assert isinstance(found[0], str) == isinstance(found[1], str)
        if isinstance(found[0], str):
            assert found[0] == found[1]
            continue
        start += size
        signals = [[signal, *(m[each] for each in watch)] for m, signal in zip(monitors, found, strict=True)]
        for one, other in zip(*signals, strict=True):
            assert bits(one.times) == bits(other.times)
            assert bits(one.values) == bits(other.values)
    ends = [outcome(monitor.finish) for monitor in monitors]
    if isinstance(ends[0], str):
        assert ends[0] == ends[1]
    else:
        assert bits(ends[0].values) == bits(ends[1].values)
        assert bits(ends[0].times) == bits(ends[1].times)


@given(
    st.sampled_from([1.0, 0.1, 0.01, 1 / 3, 0.020833, 3.0, 0.25]),
    st.lists(st.sampled_from([0.0, 0.0, 1e-9, 1e-7, 1e-5, 0.01, -0.05]), min_size=1, max_size=9),
    st.sampled_from([0.0, 1.7e9, -50.0]),
)
@example(0.333333333, [0.0, 1e-9, 1e-9], 0.0)
def test_the_core_finds_a_period_where_the_definition_does(
    period: float, off: list[float], start: float
) -> None:
    times = start + np.cumsum([period * (1 + each) for each in off])
    for expected in {Fraction(repr(period)), infer_period(Timestamps(times, times))}:
        assert native.has_period(times, expected) == has_period(times, expected)


@given(
    st.sampled_from([0.1, 1e-3, 1 / 300, 1 / 1024, 20.833e-6, 1e-5, 4.8e-5]),
    st.sampled_from([0.0, 100.0, 1000.0, 1.7e9, -1.7e9]),
    st.integers(2, 60),
    st.sampled_from([0.0, 1e-7, 1e-3, 0.05]),
    st.sampled_from([float, np.float32]),
    st.integers(0, 9),
)
@example(1e-3, 1000.0, 5, 0.0, np.float32, 0)
def test_the_core_infers_the_period_of_the_definition(
    period: float, start: float, count: int, jitter: float, kind: type, seed: int
) -> None:
    off = np.random.default_rng(seed).uniform(-jitter, jitter, count)
    times = (start + period * (np.arange(count) + off)).astype(kind)
    data = {"time": times, "x": np.ones(count)}
    spec = rtamt.parse("x >= 0")
    found = [
        outcome(lambda given=given: spec.evaluate(given).trace) for given in (data, MappingProxyType(data))
    ]
    if isinstance(found[0], str):
        assert found[0] == found[1]
    else:
        assert found[0].period == found[1].period


@pytest.mark.parametrize(
    ("times", "x"),
    [
        ([2.0, 3.0], [np.nan, 1.0]),
        ([2.0, np.nan], [1.0, 1.0]),
        ([1.0, 2.0], [1.0, 1.0]),
        ([2.0, 2.0], [1.0, 1.0]),
        ([3.0, 4.0], [1.0, 1.0]),
        ([2.0, 3.5], [1.0, 1.0]),
    ],
)
def test_chunks_that_are_wrong_are_rejected_and_change_nothing(times: list[float], x: list[float]) -> None:
    messages = []
    for backend in ("cpp", "python"):
        monitor = rtamt.parse("x >= 0", backend=backend).monitor()
        monitor.update_many(pd.DataFrame({"time": [0.0, 1.0], "x": [1.0, 2.0]}))
        with pytest.raises(rtamt.TraceError) as caught:
            monitor.update_many(pd.DataFrame({"time": times, "x": x}))
        messages.append(str(caught.value))
        assert monitor.samples == 2
        assert monitor.update_many(pd.DataFrame({"time": [2.0], "x": [3.0]})).values.tolist() == [3.0]
    assert messages[0] == messages[1]
