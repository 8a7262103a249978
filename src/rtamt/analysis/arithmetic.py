"""Solver terms for the opcodes of the operator table: piecewise linear arithmetic.

The table defines what an operator computes by functions of arrays, from which no terms can be derived. Each opcode is
therefore listed here a second time, as a term or as nonlinear; a test compares this list with the table.
"""

from __future__ import annotations

import math
from fractions import Fraction
from types import MappingProxyType
from typing import TYPE_CHECKING, TypeAlias

from rtamt.analysis.values import NotLinear, Number, Value, Values

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    Encoding: TypeAlias = Callable[..., Value]

_HALF, _ZERO, _ONE = Fraction(1, 2), Fraction(0), Fraction(1)


def _constant(number: Fraction) -> Number:
    return Number(number, cases=((number, True),))


def _sub(of: Values, a: Value, b: Value) -> Value:
    return of.plus(a, of.minus(b))


def _abs(of: Values, a: Value) -> Value:
    return of.choose(of.reaches(a, _constant(_ZERO)), a, of.minus(a))


def _sign(of: Values, a: Value) -> Value:
    zero = _constant(_ZERO)
    below = of.choose(of.exceeds(zero, a), _constant(-_ONE), zero)
    return of.choose(of.exceeds(a, zero), _constant(_ONE), below)


def _ceil(of: Values, a: Value) -> Value:
    return of.minus(of.floor(of.minus(a)))


def _round(of: Values, a: Value) -> Value:
    half = _constant(_HALF)
    up = of.floor(of.plus(a, half))
    return of.choose(of.reaches(a, _constant(_ZERO)), up, of.minus(of.floor(of.plus(of.minus(a), half))))


def _mod(of: Values, a: Value, b: Value) -> Value:
    if not isinstance(b, Number) or len(b.cases) != 1 or b.cases[0][0] == 0:
        raise NotLinear("its divisor is not a constant")
    return _sub(of, a, of.times(b, of.floor(of.over(a, b))))


def _at_least(of: Values, a: Value, b: Value) -> Value:
    of.defined.append(of.reaches(a, b))
    return a


def _scale(factor: float) -> Encoding:
    return lambda of, a: of.times(_constant(Fraction(factor)), a)


ENCODED: Mapping[str, Encoding] = MappingProxyType(
    {
        "neg": lambda of, a: of.minus(a),
        "min": lambda of, a, b: of.least((a, b)),
        "max": lambda of, a, b: of.greatest((a, b)),
        "add": lambda of, a, b: of.plus(a, b),
        "sub": _sub,
        "mul": lambda of, a, b: of.times(a, b),
        "div": lambda of, a, b: of.over(a, b),
        "abs": _abs,
        "sign": _sign,
        "floor": lambda of, a: of.floor(a),
        "ceil": _ceil,
        "round": _round,
        "mod": _mod,
        "at_least": _at_least,
        "degrees": _scale(180 / math.pi),
        "radians": _scale(math.pi / 180),
        "holds_gt": lambda of, a, b: of.verdict(of.exceeds(a, b)),
        "holds_ge": lambda of, a, b: of.verdict(of.reaches(a, b)),
        "holds_eq": lambda of, a, b: of.verdict(of.equals(a, b)),
    }
)

#: The opcodes of functions that no linear arithmetic computes. Requirements with them are not covered.
NONLINEAR = frozenset(
    (
        "acos",
        "asin",
        "atan",
        "atan2",
        "cos",
        "cosh",
        "exp",
        "hypot",
        "ln",
        "log",
        "pow",
        "sin",
        "sinh",
        "sqrt",
        "tan",
        "tanh",
    )
)
