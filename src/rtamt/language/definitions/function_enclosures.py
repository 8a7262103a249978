"""Interval extensions of the mathematical functions (see ``enclosures.py``).

Functions of the C library that rise or fall between two points have their bounds there, widened by four units in
the last place. A wave has a crest or a trough between them wherever rounding leaves room for one.

>>> import numpy as np
>>> from rtamt.language.definitions.enclosures import Enclosure
>>> from rtamt.language.definitions.function_enclosures import cos, mod
>>> cos(Enclosure(np.array([-1.0]), np.array([4.0])))
Enclosure(lower=array([-1.]), upper=array([1.]))
>>> mod(Enclosure(np.array([4.0]), np.array([5.0])), Enclosure(np.array([3.0]), np.array([3.0])))
Enclosure(lower=array([1.]), upper=array([2.]))
"""

from __future__ import annotations

import math

from rtamt.language.definitions import functions as f
from rtamt.language.definitions.enclosures import Enclosure, each, hull, one, widened
from rtamt.lazy.typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    Function: TypeAlias = Callable[..., NDArray[np.float64]]

Bounds: TypeAlias = tuple[float, float]

inf, nan, pi = math.inf, math.nan, math.pi

_NOTHING = nan, nan


def _limited(bounds: Bounds, low: float, high: float) -> Bounds:
    return max(bounds[0], low), min(bounds[1], high)


def _finite(x: Bounds) -> bool:
    return math.isfinite(x[0]) and math.isfinite(x[1])


def _ends(function: Function, x: Bounds) -> Bounds:
    """Return the widened values at both ends, the smaller one first."""
    ends = one(function, x[0]), one(function, x[1])
    return widened(min(ends), max(ends))


def _reaches(x: Bounds, offset: float, period: float) -> bool:
    """Return whether a point offset + k · period lies within bounds; also where rounding may hide it."""
    first, last = (x[0] - offset) / period, (x[1] - offset) / period
    slack = 2.0**-48 * (1 + max(abs(first), abs(last)))
    return math.ceil(first - slack) <= last + slack


def _wave(function: Function, crest: float, trough: float) -> Callable[[Bounds], Bounds]:
    """Return the extension of a wave between -1 and 1 with its crests and troughs at these points."""

    def of(x: Bounds) -> Bounds:
        if not _finite(x):
            return -1.0, 1.0
        low, high = _limited(_ends(function, x), -1.0, 1.0)
        return (-1.0 if _reaches(x, trough, 2 * pi) else low), (1.0 if _reaches(x, crest, 2 * pi) else high)

    return of


def _absolute(x: Bounds) -> Bounds:
    ends = abs(x[0]), abs(x[1])
    return (0.0 if x[0] <= 0 <= x[1] else min(ends)), max(ends)


def sin(x: Enclosure) -> Enclosure:
    """``sin(x)``: 1 and -1 where a crest or a trough may lie between the bounds."""
    return each(_wave(f.sin, pi / 2, -pi / 2), x)


def cos(x: Enclosure) -> Enclosure:
    """``cos(x)``: 1 and -1 where a crest or a trough may lie between the bounds."""
    return each(_wave(f.cos, 0.0, pi), x)


def _tan(x: Bounds) -> Bounds:
    return _ends(f.tan, x) if _finite(x) and not _reaches(x, pi / 2, pi) else (-inf, inf)


def tan(x: Enclosure) -> Enclosure:
    """``tan(x)``: increasing between two poles; anything where a pole may lie between the bounds."""
    return each(_tan, x)


def _arc(function: Function) -> Callable[[Bounds], Bounds]:
    return lambda x: _NOTHING if x[1] < -1 or x[0] > 1 else _ends(function, _limited(x, -1.0, 1.0))


def asin(x: Enclosure) -> Enclosure:
    """``asin(x)``: of the part in [-1, 1]; increasing, widened."""
    return each(_arc(f.asin), x)


def acos(x: Enclosure) -> Enclosure:
    """``acos(x)``: of the part in [-1, 1]; decreasing, widened, never negative."""
    arc = _arc(f.acos)

    def of(x: Bounds) -> Bounds:
        low, high = arc(x)
        return (0.0 if low < 0.0 else low), high

    return each(of, x)


def atan(x: Enclosure) -> Enclosure:
    """``atan(x)``: increasing, widened."""
    return each(lambda x: _ends(f.atan, x), x)


def _atan2(y: Bounds, x: Bounds) -> Bounds:
    if x[0] < 0 and y[0] < 0 <= y[1]:
        return -pi, pi  # the angle jumps where the point crosses the negative axis
    return _limited(widened(*hull([one(f.atan2, b, a) for b in y for a in x])), -pi, pi)


def atan2(y: Enclosure, x: Enclosure) -> Enclosure:
    """``atan2(y, x)``: the corners, widened; any angle if the negative axis lies between the bounds."""
    return each(_atan2, y, x)


def _hypot(x: Bounds, y: Bounds) -> Bounds:
    (a, b), (c, d) = _absolute(x), _absolute(y)
    low, high = widened(one(f.hypot, a, c), one(f.hypot, b, d))
    return max(low, 0.0), high


def hypot(x: Enclosure, y: Enclosure) -> Enclosure:
    """``hypot(x, y)``: increasing in the absolute values, widened, never negative."""
    return each(_hypot, x, y)


def sinh(x: Enclosure) -> Enclosure:
    """``sinh(x)``: increasing, widened."""
    return each(lambda x: _ends(f.sinh, x), x)


def cosh(x: Enclosure) -> Enclosure:
    """``cosh(x)``: increasing in the absolute value, widened, at least 1."""
    return each(lambda x: _limited(_ends(f.cosh, _absolute(x)), 1.0, inf), x)


def tanh(x: Enclosure) -> Enclosure:
    """``tanh(x)``: increasing, widened, between -1 and 1."""
    return each(lambda x: _limited(_ends(f.tanh, x), -1.0, 1.0), x)


def rising(definition: Function, x: Enclosure) -> Enclosure:
    """``definition(x)``: nondecreasing, and computed without error or rounded correctly."""
    return Enclosure(definition(x.lower), definition(x.upper))


def _phase(x: float, m: float) -> float:
    """Return where x lies between two multiples of m > 0; negative numbers count from the multiple above."""
    rest = math.fmod(x, m)
    return -m if x < 0 and rest == 0 else rest


def _mod(x: Bounds, y: Bounds) -> Bounds:
    if y[1] < 0:
        low, high = _mod((-x[1], -x[0]), (-y[1], -y[0]))
        return -high, -low
    if not any(y) or (x[0] == x[1] and math.isinf(x[0])):
        return _NOTHING
    if y[0] <= 0:
        return min(y[0], 0.0), y[1]
    if x[0] >= 0 and x[1] < y[0]:
        return x
    m = y[0]
    near = m == y[1] and _finite(x) and (x[0] < 0) == (x[1] < 0) and x[1] - x[0] < m
    if near and _phase(x[0], m) <= _phase(x[1], m):
        return one(f.mod, x[0], m), one(f.mod, x[1], m)
    return 0.0, y[1]


def mod(x: Enclosure, y: Enclosure) -> Enclosure:
    """``mod(x, y)``: the values at the bounds if no multiple of y lies between them, else all between 0 and y."""
    return each(_mod, x, y)


def _at_least(x: Bounds, y: Bounds) -> Bounds:
    return _NOTHING if x[1] < y[0] else (max(x[0], y[0]), x[1])


def at_least(x: Enclosure, y: Enclosure) -> Enclosure:
    """``at_least(x, y)``: the part of x that is at least y."""
    return each(_at_least, x, y)
