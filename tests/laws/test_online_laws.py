"""Online monitors of both time domains: what is watched beside the result, copies, and the quick way in."""

from __future__ import annotations

import copy
import pickle
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.engine import Watched
from rtamt.engine.dense.monitor import DenseMonitor
from rtamt.engine.discrete.monitor import Monitor
from rtamt.errors import EvaluationError
from rtamt.language.contents import variables
from rtamt.language.formula import Formula, postorder
from rtamt.reference import dense_robustness as dense_reference
from rtamt.reference import discrete_robustness as reference
from rtamt.signals.dense import Dense
from tests.support.strategies import chunkings, dense_chunkings, dense_traces, formulas, traces

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.signals.signal import Signal

ONE = Fraction(1)
NAMES = ("x", "y")
BACKENDS = st.sampled_from(["cpp", "python"])


def parts_of(data: st.DataObject, formula: Formula) -> list[Watched]:
    """Draw some sub-formulas to watch, and a formula that is none, over the same variables."""
    parts = data.draw(st.lists(st.sampled_from(list(postorder(formula))), max_size=3))
    other = data.draw(formulas(max_depth=2, variables=variables(formula)))
    return [Watched(str(i), part, None) for i, part in enumerate([*parts, other])]


def signals_of(monitor: Monitor | DenseMonitor, watch: list[Watched], result: Signal) -> list[Any]:
    return [result, *(monitor[watched.name] for watched in watch)]


def chunk_of(monitor: Monitor, columns: dict[str, Any], begin: int, size: int) -> dict[str, Any]:
    chunk = {name: columns[name][begin : begin + size] for name in monitor.input_names}
    return chunk | {"time": np.arange(begin, begin + size) * 1.0}


@settings(max_examples=40)
@given(st.data(), traces(), BACKENDS)
def test_what_is_watched_is_what_an_offline_evaluation_says(
    data: st.DataObject, columns: dict[str, Any], backend: str
) -> None:
    formula = data.draw(formulas(max_depth=3))
    watch = parts_of(data, formula)
    n = len(columns["x"])
    every = [formula, *(watched.formula for watched in watch)]
    try:
        expected = [reference.evaluate(part, columns, n, ONE) for part in every]
    except EvaluationError:
        assume(False)
    monitor = Monitor(formula, backend=backend, watch=watch)
    told: list[list[tuple[float, float]]] = [[] for _ in every]
    at = 0
    for size in data.draw(chunkings(n)):
        if size == 1:
            sample = {name: columns[name][at] for name in monitor.input_names}
            values = signals_of(monitor, watch, monitor.update(float(at), **sample))
            for output, value in enumerate(values):
                if value is not None:
                    told[output].append((float(len(told[output])), value))
        else:
            signal = monitor.update_many(chunk_of(monitor, columns, at, size))
            for output, known in enumerate(signals_of(monitor, watch, signal)):
                told[output].extend(zip(known.times.tolist(), known.values.tolist(), strict=True))
        at += size
        for output, lag in zip(told, monitor._lags, strict=True):
            assert len(output) == max(0, at - lag), "each is known at its own horizon"
    for output, known in enumerate(signals_of(monitor, watch, monitor.finish())):
        told[output].extend(zip(known.times.tolist(), known.values.tolist(), strict=True))
    for values, right in zip(told, expected, strict=True):
        assert [time for time, _ in values] == list(range(n))
        np.testing.assert_array_equal([value for _, value in values], right)


def stepped(times: Any, values: Any) -> list[tuple[int, float]]:
    """Return a step function as its changes alone."""
    changes: list[tuple[int, float]] = []
    for time, value in zip(times, values, strict=True):
        if not changes or changes[-1][1] != value:
            changes.append((int(time), float(value)))
    return changes


def seconds(update: dict[str, Any], names: tuple[str, ...]) -> dict[str, Any]:
    return {name: (np.array(update[name][0], float), update[name][1]) for name in update if name in names}


@settings(max_examples=40)
@given(st.data(), BACKENDS)
def test_in_dense_time_too_what_is_watched_is_what_an_offline_evaluation_says(
    data: st.DataObject, backend: str
) -> None:
    formula = data.draw(formulas(max_depth=3, discrete=False))
    names = variables(formula)
    assume(names)
    parts = data.draw(st.lists(st.sampled_from(list(postorder(formula))), min_size=1, max_size=3))
    watch = [Watched(str(i), part, None) for i, part in enumerate(parts)]
    trace = {name: column for name, column in data.draw(dense_traces(NAMES)).items() if name in names}
    every = [formula, *parts]
    whole = {name: (np.array(times), values) for name, (times, values) in trace.items()}
    monitor = DenseMonitor(formula, Dense(ONE), backend=backend, watch=watch)
    told: list[list[tuple[float, float]]] = [[] for _ in every]

    def points_of(result: Signal) -> None:
        for output, known in enumerate(signals_of(monitor, watch, result)):
            told[output].extend(zip(known.times.tolist(), known.values.tolist(), strict=True))

    try:
        # A part without variables lives as long as they do.
        expected = [dense_reference.evaluate(part, whole, ONE) for part in every]
        for update in data.draw(dense_chunkings(trace)):
            points_of(monitor.update_many(seconds(update, names)))
        points_of(monitor.finish())
    except EvaluationError:
        assume(False)
    for values, right in zip(told, expected, strict=True):
        instants = [time for time, _ in values]
        assert instants == sorted(set(instants)), "no instant is told twice"
        assert stepped(*zip(*values, strict=True)) == stepped(right.times, right.values)


@settings(max_examples=40)
@given(st.data(), traces(min_size=2), BACKENDS)
def test_a_copy_goes_on_as_the_original_would_whatever_that_does(
    data: st.DataObject, columns: dict[str, Any], backend: str
) -> None:
    formula = data.draw(formulas(max_depth=3))
    watch = parts_of(data, formula)
    n = len(columns["x"])
    seen = data.draw(st.integers(0, n))
    try:
        alone = Monitor(formula, backend=backend, watch=watch)
        alone.update_many(chunk_of(alone, columns, 0, seen))
        monitor = Monitor(formula, backend=backend, watch=watch)
        monitor.update_many(chunk_of(monitor, columns, 0, seen))
        twins = [copy.copy(monitor), copy.deepcopy(monitor)]
        monitor.finish()
        expected = [alone.update_many(chunk_of(alone, columns, seen, n - seen)), alone.finish()]
    except EvaluationError:
        assume(False)
    for twin in twins:
        got = [twin.update_many(chunk_of(twin, columns, seen, n - seen)), twin.finish()]
        for a, b in zip(got, expected, strict=True):
            np.testing.assert_array_equal(a.times, b.times)
            np.testing.assert_array_equal(a.values, b.values)
        for watched in watch:
            np.testing.assert_array_equal(twin[watched.name].values, alone[watched.name].values)


@settings(max_examples=40)
@given(st.data(), BACKENDS)
def test_in_dense_time_too_a_copy_goes_on_as_the_original_would(data: st.DataObject, backend: str) -> None:
    formula = data.draw(formulas(max_depth=3, discrete=False))
    names = variables(formula)
    assume(names)
    trace = {name: column for name, column in data.draw(dense_traces(NAMES)).items() if name in names}
    updates = data.draw(dense_chunkings(trace))
    seen = data.draw(st.integers(0, len(updates)))
    monitor = DenseMonitor(formula, Dense(ONE), backend=backend)
    alone = DenseMonitor(formula, Dense(ONE), backend=backend)
    try:
        for update in updates[:seen]:
            monitor.update_many(seconds(update, names))
            alone.update_many(seconds(update, names))
        twin = copy.copy(monitor)
        monitor.update_many({name: ([100.0], [7.0]) for name in names})
        expected = [alone.update_many(seconds(update, names)) for update in updates[seen:]]
        expected.append(alone.finish())
    except EvaluationError:
        assume(False)
    got = [twin.update_many(seconds(update, names)) for update in updates[seen:]]
    got.append(twin.finish())
    for a, b in zip(got, expected, strict=True):
        np.testing.assert_array_equal(a.times, b.times)
        np.testing.assert_array_equal(a.values, b.values)


def outcome(update: Callable[[], Signal]) -> tuple[list[Any], list[float]] | str:
    """Return what an update tells, or its complaint."""
    try:
        signal = update()
    except EvaluationError as error:
        return str(error)
    assert len(signal) == len(signal.times) == len(signal.values)
    return signal.times.tolist(), signal.values.tolist()


@pytest.mark.parametrize("kind", ["seconds", "ns"])
@settings(max_examples=40)
@given(data=st.data())
def test_one_instant_at_a_time_is_a_chunk_of_one(kind: str, data: st.DataObject) -> None:
    """The quick way of the core, and the long way through arrays, tell the same."""
    formula = data.draw(formulas(max_depth=3, discrete=False))
    names = variables(formula)
    assume(names)
    resolution = ONE if kind == "seconds" else Fraction(1, 10**9)
    unit = "ns" if kind == "ns" else None
    quick, long = (DenseMonitor(formula, Dense(resolution), unit=unit) for _ in range(2))
    time = 0
    for _ in range(data.draw(st.integers(1, 12))):
        time += data.draw(st.sampled_from([1, 1, 2, 5]))
        values = {
            name: data.draw(st.sampled_from([-1.0, 0.0, 2.0]))
            for name in data.draw(st.lists(st.sampled_from(names), unique=True, max_size=2))
        }
        stamp = data.draw(st.sampled_from([time, np.int64(time) if kind == "ns" else float(time)]))
        timestamps = np.array([time]) if kind == "ns" else [float(time)]
        chunk = {name: (timestamps, [value]) for name, value in values.items()}
        expected = outcome(partial(long.update_many, chunk))
        assert outcome(partial(quick.update, stamp, **values)) == expected
        assert quick.samples == long.samples


@settings(max_examples=40)
@given(formulas(max_depth=3, discrete=False))
def test_a_monitor_comes_back_from_a_pickle_with_its_state(formula: Formula) -> None:
    assume(variables(formula))
    for backend in ("cpp", "python"):
        for time in ("discrete", "dense"):
            spec = rtamt.parse(str(formula), backend=backend, time=time)
            monitor: Any = spec.monitor()
            samples = [
                {name: float(i * k % 5) for name in spec.input_names} for i, k in enumerate((3, 1, 4, 2))
            ]
            try:
                for i, sample in enumerate(samples[:2]):
                    monitor.update(i, **sample)
                twin = pickle.loads(pickle.dumps(monitor))
                for i, sample in enumerate(samples[2:], 2):
                    assert repr(monitor.update(i, **sample)) == repr(twin.update(i, **sample))
                assert repr(monitor.finish()) == repr(twin.finish())
            except EvaluationError:
                continue
