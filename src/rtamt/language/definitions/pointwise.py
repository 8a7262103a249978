"""The meaning of every operator of one instant: one pure function per operator, the reference for every engine.

Arrays hold the values at instants as float64: samples in discrete time, the steps of signals in dense time.
Inputs contain no NaN; every function returns a new array of as many values. ``x`` stands for φ (or a number),
``y`` for ψ.

Arithmetic is IEEE double precision and yields inf or NaN where C does, without a warning; reporting NaN is
the task of the evaluator. Zero has no sign: -0.0 as a divisor or base acts like 0.0, so that equal operands
give equal results, and it does not matter which of two zeros a minimum returns. Functions of the
mathematical library are called one element at a time, because numpy's vectorised versions round
differently from the C library that the core calls.

>>> import numpy as np
>>> from rtamt.language.definitions.pointwise import implies
>>> implies(np.array([1.0, 3.0]), np.array([-2.0, 4.0]))
array([-1.,  4.])
"""

from __future__ import annotations

import math

from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Array: TypeAlias = NDArray[np.float64]

inf = math.inf

# ---- atoms --------------------------------------------------------------------------------------


def true(n: int) -> Array:
    """+inf everywhere."""
    return np.full(n, inf)


def false(n: int) -> Array:
    """-inf everywhere."""
    return np.full(n, -inf)


# ---- numbers ------------------------------------------------------------------------------------


def _each(function: Callable[..., float], *operands: Array) -> Array:
    """Apply a function of floats at every sample."""
    samples = zip(*(x.tolist() for x in operands), strict=True)
    return np.array([function(*values) for values in samples], float)


def _exp(x: float) -> float:
    try:
        return math.exp(x)
    except OverflowError:
        return inf


def _ln(x: float) -> float:
    if x > 0:
        return math.log(x)
    return -inf if x == 0 else math.nan


def _pow(x: float, y: float) -> float:
    x += 0.0
    try:
        return math.pow(x, y)
    except (OverflowError, ValueError) as error:
        # Python raises where C returns inf (at a pole or on overflow) or NaN (outside the domain).
        if x != 0 and isinstance(error, ValueError):
            return math.nan
        # (An infinite exponent arrives here only on Python 3.10, where pow(0, -inf) raises.)
        odd = math.isfinite(y) and math.fmod(y, 2.0) in (1.0, -1.0)
        return math.copysign(inf, x) if odd else inf


def abs_(x: Array) -> Array:
    """``|x|``."""
    return np.abs(x)


def sqrt(x: Array) -> Array:
    """``sqrt(x)``: the square root; NaN below zero."""
    with np.errstate(all="ignore"):
        return np.sqrt(x)


def exp(x: Array) -> Array:
    """``exp(x)``: e to the power of x; +inf on overflow."""
    return _each(_exp, x)


def ln(x: Array) -> Array:
    """``ln(x)``: the natural logarithm; -inf at zero and NaN below."""
    return _each(_ln, x)


def log(x: Array, base: Array) -> Array:
    """``log(x, base)``: ln(x) / ln(base)."""
    return div(ln(x), ln(base))


def pow_(x: Array, y: Array) -> Array:
    """``pow(x, y)``: x to the power of y, as in C."""
    return _each(_pow, x, y)


def neg(x: Array) -> Array:
    """-x: minus, and ``not φ``."""
    return -x


def add(x: Array, y: Array) -> Array:
    """``x + y``."""
    with np.errstate(all="ignore"):
        return x + y


def sub(x: Array, y: Array) -> Array:
    """``x - y``."""
    with np.errstate(all="ignore"):
        return x - y


def mul(x: Array, y: Array) -> Array:
    """``x · y``."""
    with np.errstate(all="ignore"):
        return x * y


def div(x: Array, y: Array) -> Array:
    """``x / y``: ±inf for a division by zero, NaN for 0/0."""
    with np.errstate(all="ignore"):
        return x / (y + 0.0)


def if_(truth: Array, x: Array, y: Array) -> Array:
    """``if φ then x else y``, by the truth of φ, +inf or -inf."""
    return np.where(truth > 0, x, y)


# ---- predicates ---------------------------------------------------------------------------------


def ge(x: Array, y: Array) -> Array:
    """``x >= y`` and ``x > y``: x - y."""
    return sub(x, y)


def le(x: Array, y: Array) -> Array:
    """``x <= y`` and ``x < y``: y - x."""
    return sub(y, x)


def eq(x: Array, y: Array) -> Array:
    """``x == y``: -|x - y|."""
    return -np.abs(sub(x, y))


def ne(x: Array, y: Array) -> Array:
    """``x != y``: |x - y|."""
    return np.abs(sub(x, y))


def true_where(x: Array) -> Array:
    """+inf where a Boolean is 1, -inf where it is 0."""
    return np.where(x > 0, inf, -inf)


def valid(x: Array) -> Array:
    """``valid(x)``: +inf, since x has all samples here; see ``rewrite/presence.py`` for missing ones."""
    return np.full(len(x), inf)


def holds_gt(x: Array, y: Array) -> Array:
    """+inf where x > y, else -inf."""
    return np.where(x > y, inf, -inf)


def holds_ge(x: Array, y: Array) -> Array:
    """+inf where x ≥ y, else -inf."""
    return np.where(x >= y, inf, -inf)


def holds_le(x: Array, y: Array) -> Array:
    """+inf where x ≤ y, else -inf."""
    return np.where(x <= y, inf, -inf)


def holds_lt(x: Array, y: Array) -> Array:
    """+inf where x < y, else -inf."""
    return np.where(x < y, inf, -inf)


def holds_eq(x: Array, y: Array) -> Array:
    """+inf where x = y, else -inf."""
    return np.where(x == y, inf, -inf)


def holds_ne(x: Array, y: Array) -> Array:
    """+inf where x ≠ y, else -inf."""
    return np.where(x != y, inf, -inf)


# ---- Boolean ------------------------------------------------------------------------------------


def and_(x: Array, y: Array) -> Array:
    """``φ and ψ``: min(φ, ψ)."""
    return np.minimum(x, y)


def or_(x: Array, y: Array) -> Array:
    """``φ or ψ``: max(φ, ψ)."""
    return np.maximum(x, y)


def implies(x: Array, y: Array) -> Array:
    """``φ -> ψ``: max(-φ, ψ)."""
    return np.maximum(-x, y)


def iff(x: Array, y: Array) -> Array:
    """``φ <-> ψ``: min(max(-φ, ψ), max(φ, -ψ))."""
    return np.minimum(np.maximum(-x, y), np.maximum(x, -y))


def xor(x: Array, y: Array) -> Array:
    """``φ xor ψ``: -min(max(-φ, ψ), max(φ, -ψ))."""
    return -np.minimum(np.maximum(-x, y), np.maximum(x, -y))
