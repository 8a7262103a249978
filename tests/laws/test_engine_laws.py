"""The engine gives what the definition says: offline, online in any chunks, and after a failed update."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rtamt.engine import reference, signals
from rtamt.engine.compile import compile_program
from rtamt.engine.evaluate import Evaluator
from rtamt.engine.monitor import Monitor
from rtamt.errors import EvaluationError
from rtamt.language.formula import Formula, variables
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.interface import boolean
from tests.oracle.boolean import satisfied
from tests.strategies import chunkings, formulas, traces

ONE = Fraction(1)
PERIODS = st.sampled_from([Fraction(1), Fraction(1, 10), Fraction(3)])


def by_definition(formula: Formula, columns: dict[str, Any], period: Fraction = ONE) -> np.ndarray | None:
    """Return the definition's values, or None where it says that there are none."""
    n = len(next(iter(columns.values())))
    try:
        return reference.evaluate(formula, columns, n, period)
    except EvaluationError:
        return None


def by_engine(formula: Formula, columns: dict[str, Any], period: Fraction = ONE) -> np.ndarray | None:
    used = {name: columns[name] for name in columns}
    trace = signals.trace(used, tuple(used), period)
    try:
        return Evaluator((desugar(formula),), period)(trace)[0]
    except EvaluationError:
        return None


def online(monitor: Monitor, columns: dict[str, Any], sizes: list[int]) -> np.ndarray:
    used = {name: columns[name] for name in monitor.input_names}
    known, at = [], 0
    for size in sizes:
        chunk = {name: column[at : at + size] for name, column in used.items()}
        chunk["time"] = np.arange(at, at + size) * float(monitor.period)
        known.append(monitor.update_many(chunk).values)
        at += size
    known.append(monitor.finish().values)
    return np.concatenate(known)


@given(formulas(unbounded_future=True), traces(infinite=True))
def test_offline_engine_is_the_definition(formula: Formula, columns: dict[str, Any]) -> None:
    expected, got = by_definition(formula, columns), by_engine(formula, columns)
    np.testing.assert_array_equal(got, expected)


@given(st.data(), PERIODS)
def test_the_period_only_scales_bounds(data: st.DataObject, period: Fraction) -> None:
    formula = data.draw(formulas(period=period, unbounded_future=True))
    columns = data.draw(traces())
    np.testing.assert_array_equal(
        by_engine(formula, columns, period), by_definition(formula, columns, period)
    )


@given(st.data(), st.sampled_from(["cpp", "python"]))
def test_online_and_finish_is_offline_in_any_chunks(data: st.DataObject, backend: str) -> None:
    formula, columns = data.draw(formulas()), data.draw(traces(infinite=True))
    n = len(columns["x"])
    expected = by_definition(formula, columns)
    assume(expected is not None)
    monitor = Monitor(formula, backend=backend)
    for _ in range(2):  # a reset monitor is a new one
        got = online(monitor, columns, data.draw(chunkings(n)))
        np.testing.assert_array_equal(got, expected)
        monitor.reset()


@given(formulas(), traces(), st.sampled_from(["cpp", "python"]))
def test_a_value_is_given_exactly_when_its_horizon_is_reached(
    formula: Formula, columns: dict[str, Any], backend: str
) -> None:
    expected = by_definition(formula, columns)
    assume(expected is not None)
    assert expected is not None
    depth = horizon(formula)
    assert depth is not None
    monitor = Monitor(formula, backend=backend)
    names = monitor.input_names
    for i in range(len(columns["x"])):
        got = monitor.update(float(i), **{name: columns[name][i] for name in names})
        wanted = None if i < depth else expected[i - int(depth)]
        assert got == wanted
    np.testing.assert_array_equal(monitor.finish().values, expected[max(0, len(expected) - int(depth)) :])


@given(st.data(), st.sampled_from(["cpp", "python"]))
def test_a_failed_update_leaves_the_monitor_as_it_was(data: st.DataObject, backend: str) -> None:
    formula, columns = data.draw(formulas()), data.draw(traces(min_size=2))
    n = len(columns["x"])
    expected = by_definition(formula, columns)
    assume(expected is not None)
    monitor = Monitor(formula, backend=backend)
    names = monitor.input_names
    assume(names)
    known = []
    for i in range(n):
        # Before each good sample, chunks that go wrong somewhere: extreme values make inf - inf and 0/0.
        sizes = data.draw(st.lists(st.integers(1, 3), max_size=2))
        for size in sizes:
            extreme = st.lists(st.sampled_from([-np.inf, np.inf, 0.0, -1e300]), min_size=size, max_size=size)
            bad: dict[str, Any] = {name: data.draw(extreme) for name in names}
            bad["time"] = [float(i + k) for k in range(size)]
            alone = Monitor(formula, backend=backend)
            before = {name: columns[name][:i] for name in names}
            before["time"] = np.arange(float(i))
            alone.update_many(before)
            try:
                alone.update_many(bad)
            except EvaluationError:
                with pytest.raises(EvaluationError):
                    monitor.update_many(bad)
        value = monitor.update(float(i), **{name: columns[name][i] for name in names})
        if value is not None:
            known.append(value)
    known.extend(monitor.finish().values)
    np.testing.assert_array_equal(known, expected)


@given(formulas())
def test_equal_sub_formulas_are_one_instruction(formula: Formula) -> None:
    try:
        program = compile_program((desugar(formula),), ONE)
    except EvaluationError:
        assume(False)
    assert len(set(program.instructions)) == len(program.instructions)
    twice = compile_program((desugar(formula), desugar(formula)), ONE)
    assert twice.instructions == program.instructions
    assert twice.outputs == program.outputs * 2


@given(formulas(unbounded_future=True), traces())
def test_the_boolean_lowering_is_boolean_satisfaction(formula: Formula, columns: dict[str, Any]) -> None:
    assume(by_definition(formula, columns) is not None)
    lowered = by_engine(boolean(formula), columns)
    assume(lowered is not None)
    n = len(columns["x"])
    truth = satisfied(formula, columns, n, ONE)
    np.testing.assert_array_equal(lowered, np.where(truth, np.inf, -np.inf))


@given(formulas(), traces())
def test_evaluation_changes_nothing_of_the_callers(formula: Formula, columns: dict[str, Any]) -> None:
    before = {name: column.copy() for name, column in columns.items()}
    by_engine(formula, columns)
    assume(variables(formula))
    for name, column in columns.items():
        np.testing.assert_array_equal(column, before[name])
