"""Formulas, traces and chunkings for property tests, generated from the table of operators."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
from hypothesis import strategies as st

from rtamt.language.formula import Apply, Const, Formula, Interval, Var
from rtamt.language.operators import STL, Bounds, Language, Operator, Sort, Tense

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from hypothesis.strategies import DrawFn, SearchStrategy
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

# Every combination of these values of the variables is one sample of the trace on which arithmetic is tried.
_PROBE = (-2.0, 0.0, 1.0, 3.0)


@dataclass(frozen=True)
class _Drawn:
    """A formula, how it can be read, its values on the probe, and how many operators deep it is."""

    formula: Formula
    sort: Sort
    probe: Array
    depth: int = 0


@st.composite
def formulas(
    draw: DrawFn,
    max_depth: int = 4,
    variables: Sequence[str] = ("x", "y"),
    *,
    past: bool = True,
    future: bool = True,
    unbounded_past: bool = True,
    unbounded_future: bool = False,
    arithmetic: bool = True,
    discrete: bool = True,
    infinite: bool = True,
    language: Language = STL,
    period: Fraction = Fraction(1),
    select: Callable[[Operator], bool] = lambda _op: True,
) -> Formula:
    """Draw a formula at most ``max_depth`` operators deep, sub-formulas sometimes repeated.

    ``past``, ``future``, ``discrete`` (operators that mean one sample away) and ``select`` say which
    operators of ``language`` take part. Without ``arithmetic``, operands read as numbers are variables
    and numbers only, and no number is infinite unless the trace is. ``infinite`` lets infinite numbers
    stand where formulas may. Bounds are whole multiples of ``period``.

    Arithmetic that has no value on a few small numbers (the root of -2, 0/0) is drawn again with
    harmless operands, most of the time: the laws that use this must still expect EvaluationError.
    """
    operators = [
        op
        for op in language
        if select(op)
        and (past or op.tense is not Tense.PAST)
        and (future or op.tense is not Tense.FUTURE)
        and (discrete or not op.discrete_only)
        and (arithmetic or op.result is Sort.FORMULA)
    ]
    by_sort = {sort: [op for op in operators if op.result is sort] for sort in Sort}
    samples = np.array(list(itertools.product(_PROBE, repeat=len(variables))))
    n = len(samples)
    columns = {name: samples[:, k].copy() for k, name in enumerate(variables)}
    pool: list[_Drawn] = []

    def chance(one_in: int) -> bool:
        return draw(st.integers(0, one_in - 1)) == one_in - 1

    def number(*, anywhere: bool) -> _Drawn:
        doubled = draw(st.integers(-6, 6)) if anywhere else draw(st.sampled_from((1, 2, 4, 6)))
        return _Drawn(Const(doubled / 2), Sort.NUMBER, np.full(n, doubled / 2))

    def leaf(sort: Sort) -> _Drawn:
        if sort is Sort.FORMULA and infinite and chance(12):
            value = draw(st.sampled_from((np.inf, -np.inf)))
            return _Drawn(Const(value), sort, np.full(n, value))
        if variables and not chance(4):
            name = draw(st.sampled_from(list(variables)))
            return _Drawn(Var(name), Sort.NUMBER, columns[name])
        return number(anywhere=True)

    def interval(op: Operator) -> Interval | None:
        unbounded = unbounded_past if op.tense is Tense.PAST else unbounded_future
        if op.bounds is Bounds.NONE or (op.bounds is Bounds.OPTIONAL and unbounded and chance(5)):
            return None
        begin = draw(st.integers(0, 3))
        if op.bounds is Bounds.OPTIONAL and unbounded and chance(6):
            return Interval(begin * period, None)
        return Interval(begin * period, (begin + draw(st.integers(0, 3))) * period)

    def apply(op: Operator, operands: Sequence[_Drawn], window: Interval | None) -> _Drawn:
        bounds: tuple[int | None, ...] = ()
        if op.bounds is not Bounds.NONE:
            end = None if window is None or window.end is None else int(window.end / period)
            bounds = (0 if window is None else int(window.begin / period), end)
        with np.errstate(all="ignore"):
            probe = op.definition(*([o.probe for o in operands] or [n]), *bounds)
        depth = 1 + max((o.depth for o in operands), default=0)
        return _Drawn(Apply(op, tuple(o.formula for o in operands), window), op.result, probe, depth)

    def draw_one(depth: int, sort: Sort) -> _Drawn:
        reusable = [d for d in pool if d.depth <= depth and (d.sort is sort or sort is Sort.FORMULA)]
        if reusable and chance(4):
            return draw(st.sampled_from(reusable))
        # Seldom a number where a formula is expected or the reverse: both are legal.
        odd = arithmetic and chance(8)
        candidates = by_sort[sort] if not odd else operators
        if depth == 0 or not candidates or chance(10):
            return leaf(sort)
        op = draw(st.sampled_from(candidates))
        operands = [draw_one(depth - 1, operand) for operand in op.operands]
        window = interval(op)
        drawn = apply(op, operands, window)
        for kept in reversed(range(len(operands))):
            if not np.isnan(drawn.probe).any() or chance(20):
                break
            operands[kept:] = [number(anywhere=False) for _ in operands[kept:]]
            drawn = apply(op, operands, window)
        if np.isnan(drawn.probe).any():
            # What is built on it has no value to be tried on: begin again from something that has.
            return drawn if chance(20) else leaf(sort)
        pool.append(drawn)
        return drawn

    return draw_one(max_depth, Sort.FORMULA).formula


@st.composite
def traces(
    draw: DrawFn,
    variables: Sequence[str] = ("x", "y"),
    min_size: int = 1,
    max_size: int = 30,
    *,
    infinite: bool = False,
) -> dict[str, Array]:
    """Draw columns of equal length: few distinct small values each, so that ties and repeats occur."""
    n = draw(st.integers(min_size, max_size))
    values = st.integers(-8, 8).map(lambda k: k / 2)
    if infinite:
        values = st.one_of(values, values, values, st.sampled_from((np.inf, -np.inf)))
    columns = {}
    for name in variables:
        palette = draw(st.lists(values, min_size=1, max_size=6, unique=True))
        columns[name] = np.array(draw(st.lists(st.sampled_from(palette), min_size=n, max_size=n)), float)
    return columns


def chunkings(n: int) -> SearchStrategy[list[int]]:
    """Return a strategy of sizes, some of them 0, that add up to ``n``."""
    cuts = st.lists(st.integers(0, n), max_size=max(2, n))
    return cuts.map(lambda c: [b - a for a, b in itertools.pairwise([0, *sorted(c), n])])
