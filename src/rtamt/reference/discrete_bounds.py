"""The definition of bounds in discrete time: formula and partial knowledge of a trace to [L, U] at every sample.

The bounds of a predicate come from interval arithmetic. Above the predicates negation swaps and negates the
bounds, and everything else applies its definition to the lower and to the upper bounds (RoSI: J. Deshmukh
et al., "Robust online monitoring of signal temporal logic", 2017). Windows are not cut at the newest sample: the
trace goes on, with samples of which only the declared range is known. Once it is finished they are cut.

It shares nothing with the engines but the formula, and trusts its caller as ``discrete.py`` does.
"""

from __future__ import annotations

from fractions import Fraction
from math import inf, isnan, nan
from typing import TYPE_CHECKING, TypeAlias

from rtamt.errors import SpecificationError
from rtamt.language.definitions.enclosures import Enclosure, extended
from rtamt.language.formula import Apply, Const, Formula, Var, fold
from rtamt.language.operators import Ahead, Pointwise, Rank, Shift, Since, Sum, Tense, Until, Window
from rtamt.language.undefined_value import UndefinedAtSampleError
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lazy.modules import np
from rtamt.reference.cores import core_of, inside_predicates
from rtamt.reference.definition_adapter import arguments_of, window_in_steps
from rtamt.rewrite.desugar import written

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

Range: TypeAlias = tuple[float, float]

#: What is known of a number of which nothing is known.
ANYTHING: Range = (-inf, inf)


@dataclass(frozen=True, slots=True)
class Knowledge:
    """The known part of a trace: bounds of every variable at each of the ``n`` samples so far.

    ``ranges`` are the declared ones, which hold for all later samples; without one, a variable may be
    anything. ``finished``: no more samples will arrive. ``closed``: how many samples, from the first on,
    are as well known as they will ever be; by default all n. ``reached``: how many samples the trace has, if the
    others are supposed; by default all n.
    """

    columns: Mapping[str, Enclosure]
    n: int
    ranges: Mapping[str, Range] = field(default_factory=dict)
    finished: bool = False
    closed: int | None = None
    reached: int | None = None

    def until(self, n: int) -> Knowledge:
        """Return the knowledge after the first ``n`` samples."""
        columns = {name: Enclosure(x.lower[:n], x.upper[:n]) for name, x in self.columns.items()}
        return Knowledge(columns, n, self.ranges)


def bounds(
    formula: Formula,
    known: Knowledge,
    period: Fraction,
    start: float = 0.0,
    *,
    earlier: Sequence[Enclosure] = (),
    parts: list[Enclosure] | None = None,
) -> Enclosure:
    """Return [L, U] of a formula at sample 0, 1, …: the last entry is that of all later samples.

    Of a finished trace there are n entries. ``period`` and ``start``, the time of sample 0, are seconds. ``parts``
    receives the bounds of all parts; ``earlier`` are those of less knowledge, which hold where an operation that has
    no value yet is no error.

    Raises :class:`EvaluationError` if an operation has no value whatever the trace is that agrees
    with what is known, at a sample after which nothing more becomes known; and
    :class:`SpecificationError` at an operator that has no interval extension.

    >>> from fractions import Fraction
    >>> import numpy as np
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> soon = parse_formula("eventually[0:2](x >= 3)")
    >>> x = np.array([4.0, 1.0])
    >>> bounds(soon, Knowledge({"x": Enclosure(x, x)}, 2, {"x": (0.0, 5.0)}), Fraction(1))
    Enclosure(lower=array([ 1., -2., -3.]), upper=array([2., 2., 2.]))
    """
    core, ahead = core_of(formula, period)
    own: list[Enclosure] = [] if parts is None else parts
    inside: set[int] | None = None  # once an operation has no value
    closed = known.n if known.closed is None else known.closed
    reached = known.n if known.reached is None else known.reached

    def step(node: Formula, below: tuple[Enclosure, ...]) -> Enclosure:
        nonlocal inside
        value = _apply(node, below, known, period)
        wrong = np.isnan(value.lower) | np.isnan(value.upper)
        if np.count_nonzero(wrong):
            depth = ahead[id(node)]
            final = known.n if known.finished else 0 if depth is None else closed - depth
            # Known exactly, or not better later.
            certain = _exact(node, below, len(wrong)) & (np.arange(len(wrong)) < reached)
            certain[: max(0, final)] = True
            if (wrong & certain).any():
                i = int((wrong & certain).argmax())
                culprit = written(node, [formula])
                raise UndefinedAtSampleError(culprit, i, start + float(i * period))
            value = Enclosure(np.where(wrong, -inf, value.lower), np.where(wrong, inf, value.upper))
            if inside is None and earlier:
                inside = inside_predicates(core)
        if inside is not None and id(node) not in inside:
            value = _narrower(value, earlier[len(own)])
        own.append(value)
        return value

    with np.errstate(all="ignore"):
        return _merged(fold(core, step), known)


def _narrower(x: Enclosure, y: Enclosure) -> Enclosure:
    """Return the bounds that two bounds of the same numbers imply."""
    n = _longest((x, y))
    (x_lower, x_upper), (y_lower, y_upper) = _padded(x, n), _padded(y, n)
    return Enclosure(np.maximum(x_lower, y_lower), np.minimum(x_upper, y_upper))


def _exact(node: Formula, below: tuple[Enclosure, ...], n: int) -> NDArray[np.bool_]:
    """Return at which of n samples operands are numbers; those of sums are wherever they have no value."""
    if not isinstance(node, Apply) or node.op.extension is None:
        return np.ones(n, np.bool_)
    operands = [_padded(x, n) for x in below]
    exact: NDArray[np.bool_] = np.all([x.lower[:n] == x.upper[:n] for x in operands], axis=0)
    return exact


def _merged(value: Enclosure, known: Knowledge) -> Enclosure:
    """Return bounds without repeated entries at the end, except those of samples that have arrived."""
    if known.finished:
        return value
    n = len(value.lower)
    while n > max(1, known.n) and all(ends[n - 1] == ends[n - 2] for ends in value):
        n -= 1
    return Enclosure(value.lower[:n], value.upper[:n])


def _apply(node: Formula, below: tuple[Enclosure, ...], known: Knowledge, period: Fraction) -> Enclosure:
    """Return one sub-formula's bounds from those of its operands."""
    if isinstance(node, Const):
        value = np.full(known.n if known.finished else 1, node.value)
        return Enclosure(value, value)
    if isinstance(node, Var):
        lower, upper = known.columns[node.name]
        if known.finished:
            return Enclosure(lower, upper)
        low, high = known.ranges.get(node.name, ANYTHING)
        return Enclosure(np.append(lower, low), np.append(upper, high))
    if not isinstance(node, Apply):
        raise TypeError(f"not a formula: {node!r}")
    if node.op.extension is not None:
        return pointwise(node, tuple(_padded(x, _longest(below)) for x in below))
    if isinstance(node.op.kernel, Sum):
        sums = summed(below[0], *window_in_steps(node, period), known)
        return _timed(sums, period) if node.op.timed else sums
    componentwise(node)
    window = arguments_of(node, *window_in_steps(node, period), period)
    if known.finished:
        return _by_bound(node, below, window)
    # Operands are constant after their last entry. So is the result: of an operator of the future from
    # there on, and of the past when the window has left everything that has arrived before.
    behind, ahead = _reach(node, window)
    n = _longest(below) + behind
    lower, upper = _by_bound(node, tuple(_padded(x, n + ahead) for x in below), window)
    return Enclosure(lower[:n], upper[:n])


def summed(x: Enclosure, a: int, b: int | None, known: Knowledge) -> Enclosure:
    """Return the bounds of ``sum[a,b](x)``: sums of bounds, in the order in which the samples are added.

    Where the trace continues as far as a whole window, the order is open: the hull of all orders is taken. A sum since
    the start is bounded there by 0 or not at all.
    """
    pairs = list(zip(x.lower.tolist(), x.upper.tolist(), strict=True))
    seen = len(pairs) if known.finished else known.n
    if not known.finished:
        pairs += [pairs[-1]] * (max(0, seen + 1 - len(pairs)) + (a if b is None else b) + 1)
    found = []
    for t in range(len(pairs)):
        begin, end = 0 if b is None else max(t - b, 0), t - a + 1
        if end <= begin:
            found.append((0.0, 0.0))
        elif b is None:
            total = _added(pairs[: min(end, seen)])
            rest = pairs[seen:] if end > seen else []
            low, high = total
            if not isnan(low):
                low = low if all(least >= 0 for least, _ in rest) else -inf
                high = high if all(most <= 0 for _, most in rest) else inf
            found.append((low, high))
        elif end > seen and end - begin == b - a + 1 and len(set(pairs[begin:end])) == 1:
            orders = [_in_order(pairs[begin:end], k) for k in range(end - begin)]
            found.append((min(low for low, _ in orders), max(high for _, high in orders)))
        else:
            found.append(_in_order(pairs[begin:end], max((end - 1) // (b - a + 1) * (b - a + 1) - begin, 0)))
    return Enclosure(*(np.array(ends, float) for ends in zip(*found, strict=True)))


def _in_order(pairs: list[Range], block: int) -> Range:
    """Add what is before ``block`` backwards, the rest forwards, and both."""
    ending, beginning = _added(pairs[:block][::-1]), _added(pairs[block:])
    return _plus(ending, beginning) if block else beginning


def _added(pairs: list[Range]) -> Range:
    total = 0.0, 0.0
    for pair in pairs:
        total = _plus(total, pair)
    return total


def _plus(x: Range, y: Range) -> Range:
    """Add two numbers between bounds; inf - inf is the infinite end, and NaN of two numbers that are known.

    What is added to a number of which nothing is known may be anything.
    """
    low, high = x[0] + y[0], x[1] + y[1]
    if ANYTHING in (x, y):
        return ANYTHING
    known = x[0] == x[1] and y[0] == y[1]
    if any(map(isnan, (*x, *y))) or (known and isnan(low)):
        return nan, nan
    return -inf if isnan(low) else low, inf if isnan(high) else high


def _timed(sums: Enclosure, period: Fraction) -> Enclosure:
    def seconds(each: NDArray[np.float64]) -> NDArray[np.float64]:
        if Fraction(float(period)) == period:
            return each * float(period)
        return each * float(period.numerator) / float(period.denominator)

    return Enclosure(seconds(sums.lower), seconds(sums.upper))


def pointwise(node: Apply, operands: tuple[Enclosure, ...]) -> Enclosure:
    """Return the bounds that an operator of one instant makes of those of its operands."""
    assert node.op.extension is not None
    assert node.op.definition is not None
    return extended(node.op.definition, node.op.extension, operands)


def componentwise(node: Apply) -> None:
    """Raise :class:`SpecificationError` unless an operator takes minima and maxima of its operands in time."""
    if not isinstance(node.op.kernel, Window | Rank | Shift | Ahead | Since | Until):
        # No operator of the table reaches this: pointwise ones have an extension or expand to such.
        assert not isinstance(node.op.kernel, Pointwise)
        raise SpecificationError(
            f"the operator '{node.op.name}' has no interval extension, which bounds need; "
            f"give its record one (extension=...), or an expansion"
        )


def _by_bound(node: Apply, operands: tuple[Enclosure, ...], window: tuple[int | None, ...]) -> Enclosure:
    definition: Callable[..., NDArray[np.float64]] | None = node.op.definition
    assert definition is not None
    return Enclosure(
        definition(*(x.lower for x in operands), *window), definition(*(x.upper for x in operands), *window)
    )


def _longest(operands: tuple[Enclosure, ...]) -> int:
    return max(len(x.lower) for x in operands)


def _padded(x: Enclosure, n: int) -> Enclosure:
    """Return bounds of n samples: the last entry is that of all later ones."""
    more = n - len(x.lower)
    if more <= 0:
        return x
    return Enclosure(*(np.concatenate((ends, np.full(more, ends[-1]))) for ends in x))


def _reach(node: Apply, window: tuple[int | None, ...]) -> tuple[int, int]:
    """Return for how many samples an operator of the past remembers, and how many one of the future reads ahead."""
    if window:
        begin, end = window[:2]
        assert begin is not None
        reach = begin + 1 if end is None else end + 1
    else:
        assert node.op.reach is not None
        reach = node.op.reach
    return (reach, 0) if node.op.tense is Tense.PAST else (0, reach)
