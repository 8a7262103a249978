"""Arithmetic with integers as in C, whose quotients are rounded towards 0, as formulas over numbers."""

from __future__ import annotations

from rtamt.language.formula import Const, Formula
from rtamt.language.operators import STL
from rtamt.lazy.dataclasses import replace


def remainder(a: Formula, b: Formula) -> Formula:
    """Return the remainder of integers, which has the sign of ``a``.

    >>> from rtamt.language.formula import Var
    >>> print(remainder(Var("x"), Const(-3.0)))
    sign(x) * mod(abs(x), 3)
    """
    return _signed(STL["mod"](_magnitude(a), _magnitude(b)), a)


def quotient(a: Formula, b: Formula) -> Formula:
    """Return the quotient of integers.

    >>> from rtamt.language.formula import Var
    >>> print(quotient(Var("x"), Const(-3.0)))
    sign(x) * -floor(abs(x) / 3)
    """
    return _signed(STL["floor"](STL["div"](_magnitude(a), _magnitude(b))), a, b)


def _signed(magnitude: Formula, *factors: Formula) -> Formula:
    """Return a number of at least 0 with the sign of a product."""
    for factor in reversed(factors):
        if not isinstance(factor, Const):
            magnitude = STL["mul"](STL["sign"](factor), magnitude)
        elif factor.value < 0:
            magnitude = STL["neg"](magnitude)
    return magnitude


def _magnitude(number: Formula) -> Formula:
    return replace(number, value=abs(number.value)) if isinstance(number, Const) else STL["abs"](number)
