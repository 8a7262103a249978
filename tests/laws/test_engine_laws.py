"""The engine gives what the definition says: offline, online in any chunks, and after a failed update."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.compiler.plan import compile_program
from rtamt.engine.discrete.evaluate import Evaluator
from rtamt.engine.discrete.monitor import Monitor
from rtamt.errors import EvaluationError
from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Formula, Var, fold
from rtamt.language.operators import STL, Bounds, Pointwise, Sort, Tense
from rtamt.language.parsing.grammar import is_number
from rtamt.language.shares import rank_arguments
from rtamt.reference import discrete_robustness as reference
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.semantics import boolean
from rtamt.rewrite.truth import with_truths
from rtamt.signals.discrete import record_discrete
from tests.oracle.boolean import satisfied
from tests.support.strategies import chunkings, formulas, traces

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
    trace = record_discrete(used, tuple(used), period)
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


@given(formulas(), traces(infinite=True), st.sampled_from(["cpp", "python"]))
def test_step_after_step_is_the_definition(formula: Formula, columns: dict[str, Any], backend: str) -> None:
    expected = by_definition(formula, columns)
    assume(expected is not None)
    monitor = Monitor(formula, backend=backend)
    known = [
        monitor.step(*(columns[name][i] for name in monitor.input_names)) for i in range(len(columns["x"]))
    ]
    told = [value for value in known if value is not None]
    assert known == [None] * (len(known) - len(told)) + told
    np.testing.assert_array_equal([*told, *monitor.finish().values], expected)


@given(formulas(unbounded_future=True), traces(infinite=True))
def test_the_sign_of_the_engines_robustness_is_a_verdict(formula: Formula, columns: dict[str, Any]) -> None:
    robustness = by_engine(formula, columns)
    assume(robustness is not None)
    assert robustness is not None
    truth = np.array(satisfied(formula, columns, len(columns["x"]), ONE))
    assert truth[robustness > 0].all()
    assert not truth[robustness < 0].any()


def negation(formula: Formula) -> Formula:
    """Return ``not formula``, the negation moved inwards by the duals as far as they go."""

    def negated(node: Formula, below: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply) or node.op.dual is None:
            return STL["not"](node)
        operands = (
            inside if sort is Sort.FORMULA else operand
            for sort, operand, inside in zip(node.op.operands, node.args, below, strict=True)
        )
        return STL[node.op.dual](*operands, interval=node.interval)

    return fold(formula, negated)


@given(formulas(unbounded_future=True), traces(infinite=True))
def test_negation_is_the_dual_of_a_whole_formula(formula: Formula, columns: dict[str, Any]) -> None:
    expected = by_engine(STL["not"](formula), columns)
    assume(expected is not None)
    np.testing.assert_array_equal(by_engine(negation(formula), columns), expected)


@pytest.mark.parametrize("evaluate", [by_engine, by_definition])
@given(formula=formulas(unbounded_future=True), columns=traces(infinite=True))
def test_the_boolean_lowering_is_boolean_satisfaction(
    evaluate: Any, formula: Formula, columns: dict[str, Any]
) -> None:
    assume(by_definition(formula, columns) is not None)
    lowered = evaluate(boolean(formula), columns)
    truth = satisfied(formula, columns, len(columns["x"]), ONE)
    np.testing.assert_array_equal(lowered, np.where(truth, np.inf, -np.inf))


@given(formulas(unbounded_future=True), traces(infinite=True), st.sampled_from(["cpp", "python"]))
def test_the_verdict_of_a_result_is_boolean_satisfaction(
    formula: Formula, columns: dict[str, Any], backend: str
) -> None:
    robustness = by_definition(formula, columns)
    assume(robustness is not None)
    assert robustness is not None
    n = len(columns["x"])
    data = {name: columns[name] for name in variables(formula)}
    result = rtamt.parse(str(formula), backend=backend).evaluate({"time": np.arange(n), **data})
    np.testing.assert_array_equal(result.signal.values, robustness)
    assert result.satisfied is satisfied(formula, columns, n, ONE)[0]


#: They read a window, and have no value where it holds both infinities.
SUMS = {"sum", "mean", "integral"}
#: They read two samples.
DIFFERENCES = {"diff", "rate"}


def places_without_value(formula: Formula, columns: dict[str, Any]) -> list[tuple[str, int]]:
    """Return each sub-formula and sample without a value where the operands have one, in order of the formula."""
    places: list[tuple[str, int]] = []

    def step(node: Formula, below: tuple[np.ndarray, ...]) -> np.ndarray:
        n = len(columns["x"])
        if not isinstance(node, Apply):
            return columns[node.name] if isinstance(node, Var) else np.full(n, node.value)
        begin, end = (
            (Fraction(0), None) if node.interval is None else (node.interval.begin, node.interval.end)
        )
        window = () if node.op.bounds is Bounds.NONE else (int(begin), None if end is None else int(end))
        window = (*window, *rank_arguments(node.interval, Fraction(1), continuous=False))
        value = node.op.definition(*(below or (n,)), *window)
        new = np.zeros(n, bool)  # others choose among values, and make none
        if node.op.tense is Tense.NONE:
            new = np.isnan(value) & ~np.any([np.isnan(operand) for operand in below], axis=0)
        elif node.op.name in DIFFERENCES:
            new = np.isnan(value) & ~np.isnan(below).any()
        elif node.op.name in SUMS:
            new = np.isnan(
                node.op.definition(np.nan_to_num(below[0], posinf=np.inf, neginf=-np.inf), *window)
            )
        places.extend((str(node), int(i)) for i in np.flatnonzero(new))
        return value

    with np.errstate(all="ignore"):
        fold(with_truths(formula), step)
    return places


@st.composite
def fragile(draw: st.DrawFn) -> Formula:
    """Draw a formula with an operation in it that may have no value, on operands that do not spare it."""
    partial = [op for op in STL if isinstance(op.kernel, Pointwise) and op.kernel.partial]
    op = draw(st.sampled_from(partial))
    below = formulas(max_depth=2)
    operand = below.map(lambda each: each if is_number(each) else Var("x")) if op.strict else below
    return STL["or"](draw(below), STL["once"](op(*(draw(operand) for _ in op.operands))))


@settings(suppress_health_check=[HealthCheck.filter_too_much])
@given(fragile(), traces(infinite=True))
def test_both_back_ends_name_a_sub_formula_and_a_sample_that_have_no_value(
    formula: Formula, columns: dict[str, Any]
) -> None:
    assume(by_definition(formula, columns) is None)
    data = {name: columns[name] for name in variables(formula)}
    data["time"] = 10.0 + np.arange(len(columns["x"]))
    told = {}
    for backend in ("python", "cpp"):
        with pytest.raises(EvaluationError) as info:
            rtamt.parse(str(formula), backend=backend).evaluate(data)
        said = re.match(r"'(.*)' has no value at sample (\d+), time (\d+) s", str(info.value))
        assert said is not None, info.value
        name, sample, time = said.groups()
        assert float(time) == 10 + int(sample)
        told[backend] = (name, int(sample))
    places = places_without_value(formula, columns)
    assert told["python"] == places[0]
    # The engine names what an operator was expanded into, x - y for x >= y; of several places any one.
    assert told["cpp"] in places + places_without_value(desugar(formula), columns)


@given(formulas(), traces())
def test_evaluation_changes_nothing_of_the_callers(formula: Formula, columns: dict[str, Any]) -> None:
    before = {name: column.copy() for name, column in columns.items()}
    by_engine(formula, columns)
    assume(variables(formula))
    for name, column in columns.items():
        np.testing.assert_array_equal(column, before[name])
