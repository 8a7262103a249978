"""The samples that an explanation reads are sufficient: whatever all others are, the verdict is the same.

Over formulas with numbers over time in their predicates, and judged by the oracles alone.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rtamt.errors import EvaluationError
from rtamt.explain.explain import explain
from rtamt.language.contents import variables
from rtamt.language.formula import Const, Formula, Interval, Var
from rtamt.language.operators import STL, Bounds, Sort
from rtamt.reference import discrete_robustness as reference
from rtamt.signals.dense import record_dense
from rtamt.signals.discrete import record_discrete
from tests.oracle import boolean
from tests.oracle.dense_grid import on_grid
from tests.support.strategies import dense_traces, formulas, traces

ONE = Fraction(1)
#: Numbers over time, what they choose from, and enough around them to be read in several ways.
OFTEN = {"if", "held", "delay", "ahead", "diff", "minimum", "maximum", "sum", "mean", "duration", "count"}
few = settings(max_examples=settings().max_examples // 2)


#: What reads numbers at one instant, or is undefined for none of them.
AROUND = {"sub", "neg", "min", "max", "abs"}
FORMULAS = {"ge", "lt", "ne", "not", "and", "or", "always", "once", "since", "until", "rise", "atleast"}


@st.composite
def numbers(draw: Any, depth: int, *, dense: bool) -> Formula:
    """Numbers over time, with conditions inside them."""
    if depth == 0 or draw(st.integers(0, 9)) == 0:
        return (
            Var(draw(st.sampled_from("xxyy")))
            if draw(st.integers(0, 7))
            else Const(draw(st.integers(-2, 3)) / 2)
        )
    names = sorted(name for name in OFTEN | AROUND if not (dense and STL[name].discrete_only))
    op = STL[draw(st.sampled_from(names))]
    optional = draw(st.integers(0, op.optional))
    args = []
    for sort in op.operands[: len(op.operands) - optional]:
        if sort is Sort.CONDITION:
            few_operators = {"discrete": not dense, "max_depth": 2, "infinite": False, "arithmetic": False}
            args.append(draw(formulas(**few_operators, select=lambda op: op.name in FORMULAS)))
        else:
            args.append(draw(numbers(depth - 1, dense=dense)))
    interval = None
    if op.bounds is Bounds.DURATION:
        interval = Interval(*[Fraction(draw(st.integers(0, 3)))] * 2)
    elif op.bounds is not Bounds.NONE and draw(st.integers(0, 3)):
        begin = Fraction(draw(st.integers(0, 2)))
        interval = Interval(begin, begin + draw(st.integers(0, 3)))
    return op(*args, interval=interval)


@st.composite
def requirements(draw: Any, *, dense: bool) -> Formula:
    def predicate() -> Formula:
        number = draw(numbers(draw(st.integers(1, 3)), dense=dense))
        return STL[draw(st.sampled_from(["ge", "gt", "lt", "eq"]))](
            number, Const(draw(st.integers(-2, 6)) / 2)
        )

    found = predicate()
    around = draw(st.sampled_from(["", "not", "always", "eventually", "historically", "and", "or"]))
    window = Interval(Fraction(0), Fraction(draw(st.integers(0, 3))))
    if around in {"and", "or"}:
        return STL[around](found, predicate())
    return STL[around](found, interval=None if around == "not" else window) if around else found


@st.composite
def explained(draw: Any, *, dense: bool) -> tuple[Formula, dict[str, Any], int, Any]:
    formula = draw(requirements(dense=dense))
    assume(variables(formula))
    try:
        if dense:
            found = draw(dense_traces(max_size=7))
            data = {name: found[name] for name in variables(formula)}
            start = max(int(times[0]) for times, _ in data.values())
            last = max(int(times[-1]) for times, _ in data.values())
            cell = draw(st.integers(0, last - start))
            told = {name: (times.astype(float), values) for name, (times, values) in data.items()}
            return (
                formula,
                data,
                cell,
                explain(formula, record_dense(told, tuple(told), ONE), at=float(start + cell)),
            )
        data = draw(traces(max_size=12))
        cell = draw(st.integers(0, len(data["x"]) - 1))
        return formula, data, cell, explain(formula, record_discrete(data, tuple(data), ONE), at=float(cell))
    except EvaluationError:
        assume(False)
        raise


def named(stretches: Any, name: str, places: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Which samples of a variable are read: those that hold their value on [places, ends) within a reading."""
    found = np.zeros(len(places), bool)
    for stretch in stretches:
        for reading in stretch.reads:
            if reading.signal == name:
                end = np.inf if reading.end is None else reading.end + (0.5 if reading.closed else 0.0)
                found |= (places < end) & (ends > reading.start)
    return found


@few
@given(data=st.data(), seed=st.integers(0, 2**32 - 1))
def test_samples_that_no_cause_reads_may_be_anything(data: Any, seed: int) -> None:
    formula, columns, cell, explanation = data.draw(explained(dense=False))
    n = len(columns["x"])
    random = np.random.default_rng(seed)
    places = np.arange(n)
    kept = {name: named(explanation.implicant, name, places, places + 0.5) for name in columns}
    for _ in range(4):
        wild = {name: random.integers(-9, 10, n) / 2 for name in columns}
        changed = {name: np.where(kept[name], columns[name], wild[name]) for name in columns}
        try:
            satisfied = boolean.satisfied(formula, changed, n, ONE)[cell]
            values = [reference.evaluate(s.formula, changed, n, ONE) for s in explanation.implicant]
        except EvaluationError:
            continue
        assert satisfied == explanation.satisfied
        for stretch, value in zip(explanation.implicant, values, strict=True):
            there = value[int(stretch.start) : int(stretch.end) + 1]
            assert there.min() >= stretch.lowest if stretch.holds else there.max() <= stretch.highest


@few
@given(data=st.data(), seed=st.integers(0, 2**32 - 1))
def test_segments_that_no_cause_reads_may_be_anything(data: Any, seed: int) -> None:
    formula, signals, cell, explanation = data.draw(explained(dense=True))
    random = np.random.default_rng(seed)
    for _ in range(3):
        changed = {}
        for name, (times, values) in signals.items():
            kept = named(explanation.implicant, name, times, np.append(times[1:], np.inf))
            wild = random.integers(-9, 10, len(values)) / 2
            changed[name] = (times, np.where(kept, values, wild))
        try:
            satisfied = on_grid(formula, changed, ONE, truth=True)[1][2 * cell]
        except EvaluationError:
            continue
        assert satisfied == explanation.satisfied


@few
@given(data=st.data())
def test_nothing_is_read_outside_the_trace_or_of_variables_that_the_predicate_does_not_have(
    data: Any,
) -> None:
    dense = data.draw(st.booleans())
    _, signals, _, explanation = data.draw(explained(dense=dense))
    for stretch in explanation.implicant:
        assert {reading.signal for reading in stretch.reads} <= set(variables(stretch.formula))
        for reading in stretch.reads:
            first = max(times[0] for times, _ in signals.values()) if dense else 0
            assert reading.start >= first
            assert dense or reading.end < len(signals["x"])


@pytest.mark.parametrize("name", sorted(OFTEN))
def test_operators_that_are_to_be_explained_are_numbers(name: str) -> None:
    assert STL[name].result is Sort.NUMBER
