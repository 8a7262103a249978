"""Interval extensions of the pointwise operators: bounds of the result from bounds of the operands.

An :class:`Enclosure` holds a lower and an upper bound at each of n samples. An extension encloses every value
of the definition for operands within their bounds. Where all operands are known exactly
(:attr:`Enclosure.exact`), :func:`extended` uses the definition itself; the rules below cover the rest. Operations that
IEEE 754 rounds correctly are monotone, so that their bounds are values at corners, in ordinary rounding.
A function of the C library may be off by an unknown bit or two, so its bounds are widened by four units in
the last place. Some corners are undefined although nearby operands have values: inf - inf is then the infinite
end, and 0 * inf and inf / inf are 0. Operands outside the domain of a function are clipped; if nothing
remains, both bounds are NaN.

Operators that take minima and maxima over time need no extension: they are monotone, and their definitions
apply to the lower and to the upper bounds.

>>> import numpy as np
>>> from rtamt.language.definitions.enclosures import Enclosure, mul
>>> x = Enclosure(np.array([-1.0, 2.0]), np.array([3.0, 2.0]))
>>> mul(x, x)
Enclosure(lower=array([-3.,  4.]), upper=array([9., 4.]))
"""

from __future__ import annotations

import math

from rtamt.language.definitions import pointwise as p
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    Array: TypeAlias = NDArray[np.float64]

inf, nan = math.inf, math.nan


class Enclosure(NamedTuple):
    """Bounds of a number or a robustness at each of n samples: two arrays of shape (n,)."""

    lower: Array
    upper: Array

    @property
    def exact(self) -> NDArray[np.bool_]:
        """Where the value is known: both bounds are the same number."""
        same: NDArray[np.bool_] = self.lower == self.upper
        return same


def extended(
    definition: Callable[..., Array], extension: Callable[..., Enclosure], operands: Sequence[Enclosure]
) -> Enclosure:
    """Apply an operator to bounds; where all operands are known exactly, the result is its value."""
    exact = operands[0].exact
    for operand in operands[1:]:
        exact = exact & operand.exact
    known = np.count_nonzero(exact)
    if not known:
        return Enclosure(*extension(*operands))
    point = definition(*(x.lower for x in operands))
    if known == len(exact):
        return Enclosure(point, point)
    lower, upper = extension(*operands)
    return Enclosure(np.where(exact, point, lower), np.where(exact, point, upper))


def each(function: Callable[..., tuple[float, float]], *operands: Enclosure) -> Enclosure:
    """Apply a function of (lower, upper) pairs of floats at every sample."""
    pairs = [list(zip(x.lower.tolist(), x.upper.tolist(), strict=True)) for x in operands]
    found = [function(*sample) for sample in zip(*pairs, strict=True)]
    return Enclosure(np.array([low for low, _ in found], float), np.array([high for _, high in found], float))


def _otherwise(values: Array, instead: float) -> Array:
    """Return values with NaN replaced by ``instead``."""
    return np.where(np.isnan(values), instead, values)


def widened(low: float, high: float) -> tuple[float, float]:
    """Return bounds four units in the last place wider."""
    for _ in range(4):
        low, high = math.nextafter(low, -inf), math.nextafter(high, inf)
    return low, high


def _not_negative(low: float, high: float) -> tuple[float, float]:
    return (0.0 if low < 0.0 else low), high


def hull(ends: list[float]) -> tuple[float, float]:
    """Return the least and the greatest of some numbers; among equal ones (0.0, -0.0) the first and the last."""
    low = high = ends[0]
    for end in ends[1:]:
        low = end if end < low else low
        high = high if end < high else end
    return low, high


def _corners(
    function: Callable[[Array, Array], Array], x: Enclosure, y: Enclosure, instead: float
) -> Enclosure:
    """Return the hull of a function at the four corners; a corner without a value counts as ``instead``."""
    ends = [_otherwise(function(a, b), instead).tolist() for a in x for b in y]
    found = [hull(list(sample)) for sample in zip(*ends, strict=True)]
    return Enclosure(np.array([low for low, _ in found], float), np.array([high for _, high in found], float))


def one(function: Callable[..., Array], *values: float) -> float:
    """Return a definition's value for single numbers."""
    return float(function(*(np.array([value]) for value in values))[0])


# ---- one operand --------------------------------------------------------------------------------


def neg(x: Enclosure) -> Enclosure:
    """``-x`` and ``not φ``: the bounds are swapped."""
    return Enclosure(-x.upper, -x.lower)


def abs_(x: Enclosure) -> Enclosure:
    """``|x|``: the lower bound is 0 where 0 lies between the bounds."""
    ends = np.abs(x.lower), np.abs(x.upper)
    across = (x.lower <= 0) & (x.upper >= 0)
    return Enclosure(np.where(across, 0.0, np.minimum(*ends)), np.maximum(*ends))


def sqrt(x: Enclosure) -> Enclosure:
    """``sqrt(x)``: of the nonnegative part."""
    lower = p.sqrt(np.where(x.lower < 0, 0.0, x.lower))
    return Enclosure(np.where(x.upper < 0, nan, lower), p.sqrt(x.upper))


def exp(x: Enclosure) -> Enclosure:
    """``exp(x)``: increasing, widened, never negative."""
    return each(lambda a: _not_negative(*widened(one(p.exp, a[0]), one(p.exp, a[1]))), x)


def _ln(a: tuple[float, float]) -> tuple[float, float]:
    if a[1] < 0:
        return nan, nan
    return widened(one(p.ln, max(a[0], 0.0)), one(p.ln, a[1]))


def ln(x: Enclosure) -> Enclosure:
    """``ln(x)``: of the nonnegative part; increasing, widened."""
    return each(_ln, x)


# ---- two operands -------------------------------------------------------------------------------


def add(x: Enclosure, y: Enclosure) -> Enclosure:
    """``x + y``: inf - inf is the infinite end."""
    lower, upper = p.add(x.lower, y.lower), p.add(x.upper, y.upper)
    return Enclosure(_otherwise(lower, -inf), _otherwise(upper, inf))


def sub(x: Enclosure, y: Enclosure) -> Enclosure:
    """``x - y``: inf - inf is the infinite end."""
    lower, upper = p.sub(x.lower, y.upper), p.sub(x.upper, y.lower)
    return Enclosure(_otherwise(lower, -inf), _otherwise(upper, inf))


def mul(x: Enclosure, y: Enclosure) -> Enclosure:
    """``x · y``: the hull of the corners, where 0 · inf is 0."""
    return _corners(p.mul, x, y, 0.0)


def div(x: Enclosure, y: Enclosure) -> Enclosure:
    """``x / y``: the hull of the corners; anything where the divisor may be 0."""
    corners = _corners(p.div, x, y, 0.0)
    zero = (y.lower <= 0) & (y.upper >= 0)
    return Enclosure(np.where(zero, -inf, corners.lower), np.where(zero, inf, corners.upper))


def log(x: Enclosure, base: Enclosure) -> Enclosure:
    """``log(x, base)``: the quotient of two logarithms, each exact where its operand is."""
    above, below = (
        Enclosure(
            *(
                np.where(operand.lower == operand.upper, p.ln(ends), wide)
                for ends, wide in zip(operand, ln(operand), strict=True)
            )
        )
        for operand in (x, base)
    )
    nothing = np.isnan(above.lower) | np.isnan(below.lower)
    quotient = div(above, below)
    return Enclosure(np.where(nothing, nan, quotient.lower), np.where(nothing, nan, quotient.upper))


def _power(a: tuple[float, float], n: float) -> tuple[float, float]:
    """x^n for one integer n, x not all positive: increasing, decreasing, or decreasing and then increasing."""
    low, high = a
    even = math.fmod(n, 2.0) == 0
    across = low < 0 <= high
    if not even and n < 0 and across:
        return -inf, inf  # a pole
    ends = one(p.pow_, low, n), one(p.pow_, high, n)
    lower, upper = widened(min(ends), max(ends))
    if not even:
        return lower, upper
    if across:
        lower, upper = (0.0, upper) if n > 0 else (lower, inf)
    return _not_negative(lower, upper)


def _pow(a: tuple[float, float], b: tuple[float, float]) -> tuple[float, float]:
    if b[0] == b[1] == 0:
        return 1.0, 1.0
    if a[0] < 0:
        if b[0] != b[1]:
            return -inf, inf  # integer exponents lie between other exponents
        if math.isinf(b[0]):
            return 0.0, inf
        if math.trunc(b[0]) == b[0]:
            return _power(a, b[0])
        if math.isinf(a[0]):
            return 0.0, inf  # -inf has every power
        if a[1] < 0:
            return nan, nan
        a = 0.0, a[1]
    if a[0] == 0 and b[0] < 0 and (b[0] != b[1] or b[0] % 2.0 == 1.0):
        return -inf, inf  # a pole: odd powers of -0.0 are -inf
    # x^y = exp(y ln x) is bilinear in y and ln x, so that its extrema are at corners.
    ends = [one(p.pow_, x, y) for x in a for y in b]
    low, high = hull([1.0 if math.isnan(end) else end for end in ends])
    return _not_negative(*widened(low, high))


def pow_(x: Enclosure, y: Enclosure) -> Enclosure:
    """``pow(x, y)``: the corners, widened; if the base may be negative, depending on the kind of exponent."""
    return each(_pow, x, y)


def and_(x: Enclosure, y: Enclosure) -> Enclosure:
    """``min(x, y)`` and ``φ and ψ``: bound by bound."""
    return Enclosure(p.and_(x.lower, y.lower), p.and_(x.upper, y.upper))


def or_(x: Enclosure, y: Enclosure) -> Enclosure:
    """``max(x, y)`` and ``φ or ψ``: bound by bound."""
    return Enclosure(p.or_(x.lower, y.lower), p.or_(x.upper, y.upper))


# ---- the truth of a comparison ------------------------------------------------------------------


def holds_gt(x: Enclosure, y: Enclosure) -> Enclosure:
    """+inf where x > y is certain (lower) or possible (upper), else -inf."""
    return Enclosure(p.holds_gt(x.lower, y.upper), p.holds_gt(x.upper, y.lower))


def holds_ge(x: Enclosure, y: Enclosure) -> Enclosure:
    """+inf where x ≥ y is certain (lower) or possible (upper), else -inf."""
    return Enclosure(p.holds_ge(x.lower, y.upper), p.holds_ge(x.upper, y.lower))


def holds_eq(x: Enclosure, y: Enclosure) -> Enclosure:
    """+inf where x = y is certain (both known and equal) or possible (common numbers), else -inf."""
    certain = (x.lower == x.upper) & (y.lower == y.upper) & (x.lower == y.lower)
    possible = (x.lower <= y.upper) & (y.lower <= x.upper)
    return Enclosure(np.where(certain, inf, -inf), np.where(possible, inf, -inf))


# ---- in which direction -------------------------------------------------------------------------


def of_product(x: float | None, y: float | None) -> tuple[int | None, ...]:
    """Return the monotonicity of a product in its factors; ``None`` stands for a factor that is not constant."""
    return _sign(y), _sign(x)


def of_quotient(_x: float | None, y: float | None) -> tuple[int | None, ...]:
    """Return the monotonicity of a quotient in dividend and divisor."""
    return (_sign(y) if y else None), None


def _sign(value: float | None) -> int:
    return 0 if not value else 1 if value > 0 else -1
