"""Arithmetic and comparisons at one instant: IEEE double, with NaN and infinities where Python would raise."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

inf, nan = math.inf, math.nan


def _divided(x: float, y: float) -> float:
    if y != 0:
        return x / y
    return nan if x == 0 or math.isnan(x) else math.copysign(inf, x) * math.copysign(1.0, y)


def _ln(x: float) -> float:
    return nan if x < 0 else -inf if x == 0 else math.log(x)


def _exp(x: float) -> float:
    return inf if x > 709.8 else math.exp(x)


def _power(x: float, y: float) -> float:
    odd = math.isfinite(y) and math.fmod(y, 2.0) in (1.0, -1.0)
    if x == 0 and y < 0:
        return math.copysign(inf, x) if odd else inf
    if x < 0 and math.isfinite(x) and math.isfinite(y) and y != math.trunc(y):
        return nan
    try:
        return float(x**y)
    except OverflowError:
        return -inf if x < 0 and odd else inf


def _angle(function: Callable[[float], float]) -> Callable[[float], float]:
    return lambda x: nan if math.isinf(x) else function(x)


def _arc(function: Callable[[float], float]) -> Callable[[float], float]:
    return lambda x: function(x) if -1 <= x <= 1 else nan


def _hyperbolic(function: Callable[[float], float], sign: float) -> Callable[[float], float]:
    def of(x: float) -> float:
        try:
            return function(x)
        except OverflowError:
            return math.copysign(inf, x) if sign < 0 else inf

    return of


def _rounded(function: Callable[[float], float]) -> Callable[[float], float]:
    return lambda x: x if math.isinf(x) else float(function(x))


def _half_away(x: float) -> float:
    lower = math.floor(abs(x))
    return math.copysign(lower + (abs(x) - lower >= 0.5), x)


def _mod(x: float, y: float) -> float:
    return nan if y == 0 or math.isinf(x) else x % y


def _clip(x: float, lo: float, hi: float) -> float:
    return nan if lo > hi else min(max(x, lo), hi)


def _wrap(x: float, lo: float, hi: float) -> float:
    if lo <= x < hi:
        return x
    if lo >= hi or math.isinf(x):
        return nan
    around = lo + _mod(x - lo, hi - lo)
    return lo if around >= hi else around


NUMBERS: dict[str, Callable[..., float]] = {
    "abs": abs,
    "sqrt": lambda x: nan if x < 0 else math.sqrt(x),
    "exp": _exp,
    "ln": _ln,
    "log": lambda x, base: _divided(_ln(x), _ln(base)),
    "pow": _power,
    "min": min,
    "max": max,
    "sin": _angle(math.sin),
    "cos": _angle(math.cos),
    "tan": _angle(math.tan),
    "asin": _arc(math.asin),
    "acos": _arc(math.acos),
    "atan": math.atan,
    "atan2": lambda y, x: math.atan2(y + 0.0, x + 0.0),
    "hypot": math.hypot,
    "sinh": _hyperbolic(math.sinh, -1),
    "cosh": _hyperbolic(math.cosh, 1),
    "tanh": math.tanh,
    "degrees": math.degrees,
    "radians": math.radians,
    "floor": _rounded(math.floor),
    "ceil": _rounded(math.ceil),
    "round": _rounded(_half_away),
    "sign": lambda x: float((x > 0) - (x < 0)),
    "mod": _mod,
    "clip": _clip,
    "wrap": _wrap,
    "neg": lambda x: -x,
    "mul": lambda x, y: x * y,
    "div": _divided,
    "add": lambda x, y: x + y,
    "sub": lambda x, y: x - y,
}

# Of each comparison its robustness and its truth.
COMPARISONS: dict[str, tuple[Callable[..., float], Callable[..., bool]]] = {
    "ge": (lambda x, y: x - y, lambda x, y: x >= y),
    "gt": (lambda x, y: x - y, lambda x, y: x > y),
    "le": (lambda x, y: y - x, lambda x, y: x <= y),
    "lt": (lambda x, y: y - x, lambda x, y: x < y),
    "eq": (lambda x, y: -abs(x - y), lambda x, y: x == y),
    "ne": (lambda x, y: abs(x - y), lambda x, y: x != y),
    # Where no sample is missing.
    "valid": (lambda _x: math.inf, lambda _x: True),
}
