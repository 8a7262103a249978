"""The dense engine gives what the dense definition says: offline, online in any chunks, after failures."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rtamt.engine import Evaluators
from rtamt.engine.dense.monitor import DenseMonitor
from rtamt.errors import EvaluationError
from rtamt.language.contents import variables
from rtamt.reference import dense_robustness as dense_reference
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.horizon import horizon
from rtamt.signals.dense import Dense, DenseTrace, record_dense
from tests.support.strategies import dense_chunkings, dense_traces, formulas

if TYPE_CHECKING:
    from rtamt.language.formula import Formula

TICK = Fraction(1)
NAMES = ("x", "y")


def stepped(times: Any, values: Any) -> list[tuple[int, float]]:
    """Return a step function as its changes alone."""
    changes: list[tuple[int, float]] = []
    for time, value in zip(times, values, strict=True):
        if not changes or changes[-1][1] != value:
            changes.append((int(time), float(value)))
    return changes


def by_definition(formula: Formula, trace: dict[str, Any]) -> list[tuple[int, float]] | None:
    try:
        steps = dense_reference.evaluate(formula, trace, TICK)
    except EvaluationError:
        return None
    return stepped(steps.times, steps.values)


def recording(formula: Formula, trace: dict[str, Any]) -> DenseTrace:
    data = {name: (np.array(trace[name][0], dtype=np.int64), trace[name][1]) for name in variables(formula)}
    return record_dense(data, variables(formula), TICK)


def by_engine(formula: Formula, trace: dict[str, Any]) -> list[tuple[int, float]] | None:
    try:
        signal = Evaluators("cpp")((desugar(formula),), recording(formula, trace))[0]
    except EvaluationError:
        return None
    return stepped(signal.times, signal.values)


def read_by(formula: Formula, trace: dict[str, Any]) -> dict[str, Any]:
    return {name: trace[name] for name in variables(formula)}


@given(formulas(discrete=False, unbounded_future=True), dense_traces(NAMES, infinite=True))
def test_offline_engine_is_the_definition(formula: Formula, trace: dict[str, Any]) -> None:
    assume(variables(formula))
    trace = read_by(formula, trace)
    expected, got = by_definition(formula, trace), by_engine(formula, trace)
    # What has no value after the end, and is read by nothing, is no error in either; the engine
    # may notice less of it than the definition where the value does not matter.
    assume(expected is not None and got is not None)
    assert got == expected


@given(formulas(discrete=False, arithmetic=False, infinite=False), dense_traces(NAMES))
def test_without_arithmetic_everything_has_a_value(formula: Formula, trace: dict[str, Any]) -> None:
    assume(variables(formula))
    trace = read_by(formula, trace)
    assert by_engine(formula, trace) == by_definition(formula, trace) is not None


@pytest.mark.parametrize("backend", ["cpp", "python"])
@given(data=st.data())
def test_online_and_finish_is_offline_and_never_late(backend: str, data: st.DataObject) -> None:
    formula = data.draw(formulas(discrete=False))
    assume(variables(formula))
    trace = read_by(formula, data.draw(dense_traces(NAMES)))
    expected = by_definition(formula, trace)
    assume(expected is not None)
    depth = horizon(formula)
    assert depth is not None
    monitor = DenseMonitor(formula, Dense(TICK), backend=backend)
    for _ in range(2):  # a reset monitor is a new one
        told: list[tuple[int, float]] = []
        last: dict[str, int] = {}
        start = max(int(times[0]) for times, _ in trace.values())
        for update in data.draw(dense_chunkings(trace)):
            chunk = {
                name: (np.array(times, dtype=np.int64), values)
                for name, (times, values) in update.items()
                if name in trace
            }
            try:
                signal = monitor.update_many(chunk)
            except EvaluationError:
                assume(False)
            last.update({name: int(times[-1]) for name, (times, _) in update.items() if len(times)})
            told.extend(zip(signal.times.tolist(), signal.values.tolist(), strict=True))
            if set(last) == set(trace):
                until = min(last.values()) - int(depth)
                if until >= start:
                    assert told[-1][0] == until
        rest = monitor.finish()
        told.extend(zip(rest.times.tolist(), rest.values.tolist(), strict=True))
        instants = [time for time, _ in told]
        assert instants == sorted(set(instants)), "no instant is told twice"
        assert stepped(*zip(*told, strict=True)) == expected
        monitor.reset()


@given(st.data())
def test_a_failed_update_leaves_the_monitor_as_it_was(data: st.DataObject) -> None:
    formula = data.draw(formulas(discrete=False))
    assume(variables(formula))
    trace = read_by(formula, data.draw(dense_traces(NAMES)))
    expected = by_definition(formula, trace)
    assume(expected is not None)
    monitor = DenseMonitor(formula, Dense(TICK))
    told: list[tuple[int, float]] = []
    last: dict[str, int] = {}
    for update in data.draw(dense_chunkings(trace)):
        extreme = data.draw(st.sampled_from([0.0, -1.0, np.inf, -np.inf]))
        bad = {
            name: (
                np.array([last.get(name, -50) + 1, last.get(name, -50) + 9], np.int64),
                [extreme] * 2,
            )
            for name in trace
        }
        before = monitor.memory
        probe = DenseMonitor(formula, Dense(TICK))
        try:
            probe.update_many(bad)
        except EvaluationError:
            if not last:
                with pytest.raises(EvaluationError):
                    monitor.update_many(bad)
                assert monitor.memory >= before
        chunk = {name: (np.array(times, dtype=np.int64), values) for name, (times, values) in update.items()}
        try:
            signal = monitor.update_many({name: chunk[name] for name in chunk if name in trace})
        except EvaluationError:
            assume(False)
        last.update({name: int(times[-1]) for name, (times, _) in update.items() if len(times)})
        told.extend(zip(signal.times.tolist(), signal.values.tolist(), strict=True))
    rest = monitor.finish()
    told.extend(zip(rest.times.tolist(), rest.values.tolist(), strict=True))
    assert stepped(*zip(*told, strict=True)) == expected
