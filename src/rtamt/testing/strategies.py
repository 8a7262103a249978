"""Hypothesis strategies: formulas from the operator table, traces and chunkings in both time domains."""

from __future__ import annotations

import itertools
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from hypothesis import strategies as st

from rtamt.errors import EvaluationError
from rtamt.language.formula import Apply, Const, Formula, Interval, Var
from rtamt.language.operators import STL, Bounds, Language, Operator, Sort, Tense
from rtamt.language.parsing.grammar import is_number
from rtamt.language.shares import Share, ShareKind, rank_arguments
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.lazy.modules import np
from rtamt.reference import discrete_robustness as reference

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from hypothesis.strategies import DrawFn, SearchStrategy
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    # For each variable, its times in ticks and its values.
    DenseTrace = dict[str, tuple[NDArray[np.int64], Array]]

# Every combination of these values is one sample of the trace that probes arithmetic.
_PROBE = (-2.0, 0.0, 1.0, 3.0)

# Samples: halves, and both zeros.
_NUMBERS = st.integers(-9, 8).map(lambda k: -0.0 if k == -9 else k / 2)


@dataclass(frozen=True)
class _Drawn:
    """A formula, its sort, its values on the probe, and its depth in operators."""

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

    ``past``, ``future``, ``discrete`` (operators that read the neighbouring sample) and ``select`` choose the
    operators of ``language``. Without ``arithmetic``, numeric operands are variables
    and literals only, and no number is infinite unless the trace is. ``infinite`` also allows infinite numbers
    in the place of formulas. Bounds are integer multiples of ``period``.

    Arithmetic that is undefined for a few small numbers (the root of -2, 0/0) is usually drawn again with
    harmless operands; laws must still expect EvaluationError.
    """
    operators = [
        op
        for op in language
        if select(op)
        and not op.presence  # on complete data it is true
        and (past or op.tense is not Tense.PAST)
        and (
            unbounded_past
            or op.tense is not Tense.PAST
            or op.bounds is not Bounds.NONE
            or op.reach is not None
        )
        and (future or op.tense is not Tense.FUTURE)
        and (discrete or not op.discrete_only)
        and (arithmetic or op.result is Sort.FORMULA)
    ]
    by_sort = {sort: [op for op in operators if op.result is sort] for sort in Sort}
    by_sort[Sort.CONDITION] = by_sort[Sort.FORMULA]
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
        if sort is not Sort.NUMBER and infinite and chance(12):
            value = draw(st.sampled_from((np.inf, -np.inf)))
            return _Drawn(Const(value), Sort.FORMULA, np.full(n, value))
        if variables and not chance(4):
            name = draw(st.sampled_from(list(variables)))
            return _Drawn(Var(name), Sort.NUMBER, columns[name])
        return number(anywhere=True)

    def interval(op: Operator) -> Interval | None:
        unbounded = unbounded_past if op.tense is Tense.PAST else unbounded_future
        return draw(_intervals(op, period, unbounded, discrete))

    def apply(op: Operator, operands: Sequence[_Drawn], window: Interval | None) -> _Drawn:
        bounds: tuple[float | None, ...] = ()
        if op.bounds is not Bounds.NONE:
            end = None if window is None or window.end is None else int(window.end / period)
            rank = rank_arguments(window, period, continuous=not discrete)
            bounds = (0 if window is None else int(window.begin / period), end, *rank)
        with np.errstate(all="ignore"):
            values: list[Any] = [o.probe for o in operands] or [n]
            probe = _meaning(op, window)(*values, *bounds)
        depth = 1 + max((o.depth for o in operands), default=0)
        return _Drawn(Apply(op, tuple(o.formula for o in operands), window), op.result, probe, depth)

    def draw_one(depth: int, sort: Sort, *, strict: bool = False) -> _Drawn:
        reusable = [d for d in pool if d.depth <= depth and (d.sort is sort or sort is not Sort.NUMBER)]
        if reusable and chance(4):
            return draw(st.sampled_from(reusable))
        # Sometimes a number where a formula is expected, or the reverse: both are legal but for strict functions.
        odd = arithmetic and not strict and chance(8)
        candidates = by_sort[sort] if not odd else operators
        if depth == 1:  # a condition is at least a comparison
            candidates = [op for op in candidates if Sort.CONDITION not in op.operands]
        if depth == 0 or not candidates or chance(10):
            return leaf(sort)
        op = draw(st.sampled_from(candidates))
        optional = draw(st.integers(0, op.optional)) if op.optional else 0
        sorts = op.operands[: len(op.operands) - optional]
        operands = [draw_operand(depth - 1, operand, strict=op.strict) for operand in sorts]
        window = interval(op)
        drawn = apply(op, operands, window)
        for kept in reversed(range(len(operands))):
            if not np.isnan(drawn.probe).any() or chance(20):
                break
            operands[kept:] = [_fit_sort(number(anywhere=False), operand) for operand in sorts[kept:]]
            drawn = apply(op, operands, window)
        if np.isnan(drawn.probe).any():
            # A formula on top of it would have no value to probe: start again from one that has.
            return drawn if chance(20) else leaf(sort)
        pool.append(drawn)
        return drawn

    def draw_operand(depth: int, sort: Sort, *, strict: bool) -> _Drawn:
        drawn = _fit_sort(draw_one(depth, sort, strict=strict), sort)
        # A number as deep as this has no room for the comparison that makes it a condition.
        return drawn if drawn.depth <= depth else _fit_sort(leaf(sort), sort)

    return draw_one(max_depth, Sort.FORMULA).formula


def _fit_sort(drawn: _Drawn, sort: Sort) -> _Drawn:
    """Return an operand of this sort: a condition is no number."""
    if sort is not Sort.CONDITION or not is_number(drawn.formula):
        return drawn
    return _Drawn(STL["gt"](drawn.formula, Const(0.0)), Sort.FORMULA, drawn.probe, drawn.depth + 1)


@st.composite
def _intervals(
    draw: DrawFn, op: Operator, period: Fraction, unbounded: bool, discrete: bool
) -> Interval | None:
    """Draw the interval of an operator; None if it takes none, or sometimes if it may be left out."""

    def chance(one_in: int) -> bool:
        return draw(st.integers(0, one_in - 1)) == one_in - 1

    if op.one_tick and not discrete:
        return Interval(period, period, implied=True)
    if op.bounds is Bounds.NONE or (op.bounds is Bounds.OPTIONAL and unbounded and chance(5)):
        return None
    begin = draw(st.integers(int(op.positive), 3))
    if op.bounds is Bounds.DURATION:
        return Interval(begin * period, begin * period)
    if op.bounds is Bounds.OPTIONAL and unbounded and chance(6):
        return Interval(begin * period, None)
    width = draw(st.integers(0 if discrete or not op.share else 1, 3))
    window = Interval(begin * period, (begin + width) * period)
    return replace(window, share=draw(_shares(width + discrete, period, discrete))) if op.share else window


@st.composite
def _shares(draw: DrawFn, nominal: int, period: Fraction, discrete: bool) -> Share:
    """Draw a share of a window of ``steps`` steps."""
    if draw(st.booleans()):
        return Share(Fraction(draw(st.sampled_from((1, 30, 50, 75, 100)))), ShareKind.PERCENT)
    count = Fraction(draw(st.integers(1, nominal)))
    if discrete and draw(st.booleans()):
        return Share(count, ShareKind.SAMPLES)
    return Share(count * period, ShareKind.DURATION)


def _meaning(op: Operator, window: Interval | None) -> Callable[..., Array]:
    """Return an operator's definition, or one derived from its expansion."""
    if op.definition is not None:
        return op.definition

    def expanded(*operands: Any) -> Array:
        n = operands[0] if not op.operands else len(operands[0])
        columns = {str(k): x for k, x in enumerate(operands) if isinstance(x, np.ndarray)}
        formula = Apply(op, tuple(Var(name) for name in columns), window)
        try:
            return reference.evaluate(formula, columns, n, Fraction(1))
        except EvaluationError:
            return np.full(n, np.nan)

    return expanded


@st.composite
def traces(
    draw: DrawFn,
    variables: Sequence[str] = ("x", "y"),
    min_size: int = 1,
    max_size: int = 30,
    *,
    infinite: bool = False,
) -> dict[str, Array]:
    """Draw columns of equal length with few distinct small values, so that ties and repeats occur."""
    n = draw(st.integers(min_size, max_size))
    values = _NUMBERS
    if infinite:
        values = st.one_of(values, values, values, st.sampled_from((np.inf, -np.inf)))
    columns = {}
    for name in variables:
        palette = draw(st.lists(values, min_size=1, max_size=6, unique_by=repr))
        columns[name] = np.array(draw(st.lists(st.sampled_from(palette), min_size=n, max_size=n)), float)
    return columns


def chunkings(n: int) -> SearchStrategy[list[int]]:
    """Return a strategy of sizes, some of them 0, that add up to ``n``."""
    cuts = st.lists(st.integers(0, n), max_size=max(2, n))
    return cuts.map(lambda c: [b - a for a, b in itertools.pairwise([0, *sorted(c), n])])


@st.composite
def dense_traces(
    draw: DrawFn,
    variables: Sequence[str] = ("x", "y"),
    max_size: int = 12,
    *,
    infinite: bool = False,
    origin: int = 0,
) -> DenseTrace:
    """Draw one signal per variable, each with its own times, in ticks from ``origin`` on.

    Starts and ends differ, jumps coincide often, segments of one tick and repeated values occur, and
    some signals have a single sample or end before another one begins.
    """
    values = _NUMBERS
    if infinite:
        values = st.one_of(values, values, values, st.sampled_from((np.inf, -np.inf)))
    trace = {}
    for name in variables:
        n = draw(st.integers(1, max_size))
        steps = draw(st.lists(st.sampled_from((1, 1, 1, 2, 2, 3, 5)), min_size=n - 1, max_size=n - 1))
        times = np.cumsum([origin + draw(st.sampled_from((0, 0, 0, 1, 2, 5, 12))), *steps], dtype=np.int64)
        palette = draw(st.lists(values, min_size=1, max_size=5, unique_by=repr))
        column = draw(st.lists(st.sampled_from(palette), min_size=n, max_size=n))
        trace[name] = (times, np.array(column, float))
    return trace


@st.composite
def dense_chunkings(draw: DrawFn, trace: DenseTrace) -> list[DenseTrace]:
    """Draw a split of a dense trace into updates, each with some samples of some variables.

    A variable may be absent from an update, present without samples, far ahead of the others or far
    behind; sometimes every update is one sample of one variable.
    """
    sizes = {name: len(times) for name, (times, _) in trace.items()}
    if draw(st.booleans()):
        order = draw(st.permutations([name for name, n in sizes.items() for _ in range(n)]))
        shares = [{name: 1} for name in order]
    else:
        m = draw(st.integers(1, 6))
        shares = [{} for _ in range(m)]
        for name, n in sizes.items():
            cuts = sorted(draw(st.lists(st.integers(0, n), min_size=m - 1, max_size=m - 1)))
            for share, (begin, end) in zip(shares, itertools.pairwise([0, *cuts, n]), strict=True):
                if end > begin or draw(st.booleans()):
                    share[name] = end - begin
    updates, begun = [], dict.fromkeys(sizes, 0)
    for share in shares:
        update: DenseTrace = {}
        for name, size in share.items():
            begin = begun[name]
            begun[name] += size
            times, values = trace[name]
            update[name] = times[begin : begin + size], values[begin : begin + size]
        updates.append(update)
    return updates
