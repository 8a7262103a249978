"""The engine is the definition on traces longer than its block of samples, with windows that span blocks."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.engine.discrete.monitor import Monitor
from rtamt.errors import EvaluationError
from rtamt.language.formula import Apply, Formula, Interval, fold
from rtamt.language.operators import STL, Bounds
from rtamt.language.printing.printer import to_text
from rtamt.language.shares import Share, ShareKind
from tests.laws.test_engine_laws import by_definition, by_engine, online
from tests.support.strategies import formulas

BLOCK = 256
CHUNKS = (0, 1, 2, 100, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK, 700)


@st.composite
def long_traces(draw: st.DrawFn) -> dict[str, Any]:
    """Draw two columns of 200 to 1200 samples: the seed and the number of distinct values are drawn."""
    n = draw(st.integers(200, 1200))
    distinct = draw(st.sampled_from((2, 5, 1000)))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    return {name: rng.integers(-distinct, distinct + 1, n) / 2 for name in ("x", "y")}


@st.composite
def long_windows(draw: st.DrawFn, **options: Any) -> Formula:
    """Draw an operator with a window on small formulas, every bound up to 300 samples."""
    bounds = st.sampled_from((0, 1, 2, 60, BLOCK - 1, BLOCK, BLOCK + 1, 300))

    def widened(node: Formula, below: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply):
            return node
        interval = node.interval
        if interval is not None and node.op.bounds is Bounds.DURATION:
            length = Fraction(max(draw(bounds), int(node.op.positive)))
            interval = Interval(length, length)
        elif interval is not None:
            begin, end = sorted((draw(bounds), draw(bounds)))
            share = interval.share
            if share is not None:
                share = Share(Fraction(draw(st.integers(1, 100))), ShareKind.PERCENT)
            interval = Interval(Fraction(begin), None if interval.end is None else Fraction(end), share=share)
        return replace(node, args=below, interval=interval)

    op = draw(st.sampled_from([op for op in STL if op.bounds is not Bounds.NONE]))
    operands = (draw(formulas(max_depth=2, **options)) for _ in op.operands)
    share = Share(Fraction(50), ShareKind.PERCENT) if op.share else None
    return fold(op(*operands, interval=Interval(Fraction(0), Fraction(1), share=share)), widened)


@given(long_windows(unbounded_future=True), long_traces())
def test_offline_engine_is_the_definition_beyond_one_block(formula: Formula, columns: dict[str, Any]) -> None:
    expected = by_definition(formula, columns)
    assume(expected is not None)
    np.testing.assert_array_equal(by_engine(formula, columns), expected)


@given(long_windows(), long_traces(), st.lists(st.sampled_from(CHUNKS), max_size=8))
def test_online_in_chunks_beyond_one_block_is_the_definition(
    formula: Formula, columns: dict[str, Any], sizes: list[int]
) -> None:
    expected = by_definition(formula, columns)
    assume(expected is not None)
    n = len(columns["x"])
    ends = [*np.minimum(np.cumsum([0, *sizes]), n).tolist(), n]
    monitor = Monitor(formula)
    np.testing.assert_array_equal(online(monitor, columns, np.diff(ends).tolist()), expected)
    assert monitor.samples == n


@pytest.mark.parametrize("n", [BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK + 1])
@settings(max_examples=30)
@given(formula=long_windows(), seed=st.integers(0, 1000))
def test_traces_that_end_at_a_block(n: int, formula: Formula, seed: int) -> None:
    values = np.random.default_rng(seed).integers(-9, 10, (2, n)) / 2
    columns = {"x": values[0], "y": values[1]}
    expected = by_definition(formula, columns)
    assume(expected is not None)
    np.testing.assert_array_equal(by_engine(formula, columns), expected)
    np.testing.assert_array_equal(online(Monitor(formula), columns, [n]), expected)


@given(formulas(unbounded_future=True), long_traces(), st.sampled_from(("standard", "boolean")))
def test_bounds_at_the_start_of_a_long_trace_end_in_the_robustness(
    formula: Formula, columns: dict[str, Any], semantics: str
) -> None:
    spec = rtamt.parse(to_text(formula), period=1, semantics=semantics)
    names = spec.input_names
    assume(names)
    monitor = spec.monitor(verdict="interval", at="start")
    try:
        expected = spec.evaluate({name: columns[name] for name in names}).robustness
        for t, row in enumerate(zip(*(columns[name].tolist() for name in names), strict=True)):
            monitor.update(t, **dict(zip(names, row, strict=True)))
        monitor.finish()
    except EvaluationError:
        assume(False)
    assert monitor.interval() == rtamt.Interval(expected, expected)
