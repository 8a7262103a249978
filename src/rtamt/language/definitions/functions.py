"""The meaning of the mathematical functions: one function on arrays per operator, as in ``pointwise.py``.

Angles are in radians, and the functions are those of C; where C returns NaN of numbers that are none (the sine of
infinity, the arc cosine of 2), so do these. Zero has no sign: ``atan2`` takes -0.0 as 0.0.

>>> import numpy as np
>>> from rtamt.language.definitions.functions import mod, wrap
>>> mod(np.array([-1.0, 7.0]), np.array([3.0, 3.0]))
array([2., 1.])
>>> wrap(np.array([190.0]), np.array([-180.0]), np.array([180.0]))
array([-170.])
"""

from __future__ import annotations

import math

from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Array: TypeAlias = NDArray[np.float64]

inf, nan = math.inf, math.nan


def _each(function: Callable[..., float], *operands: Array) -> Array:
    """Apply a function of floats at every sample; NaN where Python raises because C returns NaN."""

    def value(*numbers: float) -> float:
        try:
            return function(*numbers)
        except ValueError:
            return nan

    samples = zip(*(x.tolist() for x in operands), strict=True)
    return np.array([value(*numbers) for numbers in samples], float)


# ---- trigonometry -------------------------------------------------------------------------------


def sin(x: Array) -> Array:
    """``sin(x)``: the sine; NaN of ±inf."""
    return _each(math.sin, x)


def cos(x: Array) -> Array:
    """``cos(x)``: the cosine; NaN of ±inf."""
    return _each(math.cos, x)


def tan(x: Array) -> Array:
    """``tan(x)``: the tangent; NaN of ±inf."""
    return _each(math.tan, x)


def asin(x: Array) -> Array:
    """``asin(x)``: the arc sine in [-π/2, π/2]; NaN outside [-1, 1]."""
    return _each(math.asin, x)


def acos(x: Array) -> Array:
    """``acos(x)``: the arc cosine in [0, π]; NaN outside [-1, 1]."""
    return _each(math.acos, x)


def atan(x: Array) -> Array:
    """``atan(x)``: the arc tangent in [-π/2, π/2]."""
    return _each(math.atan, x)


def atan2(y: Array, x: Array) -> Array:
    """``atan2(y, x)``: the angle of the point (x, y) in (-π, π]; 0 for (0, 0)."""
    return _each(math.atan2, y + 0.0, x + 0.0)


def hypot(x: Array, y: Array) -> Array:
    """``hypot(x, y)``: the square root of x² + y², without overflow on the way."""
    with np.errstate(all="ignore"):
        return np.hypot(x, y)  # the one of C; Python's own differs in the last bit


def sinh(x: Array) -> Array:
    """``sinh(x)``: the hyperbolic sine; ±inf on overflow."""
    return _each(lambda v: math.copysign(inf, v) if abs(v) > 711 else math.sinh(v), x)


def cosh(x: Array) -> Array:
    """``cosh(x)``: the hyperbolic cosine; +inf on overflow."""
    return _each(lambda v: inf if abs(v) > 711 else math.cosh(v), x)


def tanh(x: Array) -> Array:
    """``tanh(x)``: the hyperbolic tangent."""
    return _each(math.tanh, x)


def degrees(x: Array) -> Array:
    """``degrees(x)``: radians as degrees, x · (180/π)."""
    with np.errstate(all="ignore"):
        return x * (180.0 / math.pi)


def radians(x: Array) -> Array:
    """``radians(x)``: degrees as radians, x · (π/180)."""
    with np.errstate(all="ignore"):
        return x * (math.pi / 180.0)


# ---- rounding and remainders --------------------------------------------------------------------


def floor(x: Array) -> Array:
    """``floor(x)``: the greatest whole number that is not above x."""
    return np.floor(x)


def ceil(x: Array) -> Array:
    """``ceil(x)``: the least whole number that is not below x."""
    return np.ceil(x)


def _round(x: float) -> float:
    whole = math.trunc(x) if math.isfinite(x) else x
    return whole + math.copysign(1.0, x) if abs(x - whole) >= 0.5 else float(whole)


def round_(x: Array) -> Array:
    """``round(x)``: the nearest whole number; of two, the one further from zero."""
    return np.array([v if math.isinf(v) else _round(v) for v in x.tolist()], float)


def sign(x: Array) -> Array:
    """``sign(x)``: -1, 0 or 1."""
    return (x > 0).astype(float) - (x < 0)


def mod(x: Array, y: Array) -> Array:
    """``mod(x, y)``: the remainder of x after whole multiples of y, with the sign of y; NaN for y = 0 or x = ±inf."""
    return _each(lambda a, b: nan if b == 0 or math.isinf(a) else a % b, x, y)


def at_least(x: Array, y: Array) -> Array:
    """``at_least(x, y)``: x where it is at least y, else NaN."""
    return np.where(x >= y, x, nan)


def clip(x: Array, lo: Array, hi: Array) -> Array:
    """``clip(x, lo, hi)``: the number of [lo, hi] next to x; NaN where lo > hi."""
    return np.minimum(np.maximum(x, lo), at_least(hi, lo))


def _wrap(x: float, lo: float, hi: float) -> float:
    if lo <= x < hi:
        return x
    if not lo < hi or math.isinf(x):
        return nan
    turned = lo + (x - lo) % (hi - lo)
    return lo if turned >= hi else turned


def wrap(x: Array, lo: Array, hi: Array) -> Array:
    """``wrap(x, lo, hi)``: x moved into [lo, hi) by whole multiples of hi - lo.

    NaN where lo ≥ hi, or where x outside the interval, or its distance from lo, is infinite.
    """
    return _each(_wrap, x, lo, hi)
