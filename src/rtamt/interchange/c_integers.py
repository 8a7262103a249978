"""Arithmetic with integers as in C, whose quotients are rounded towards 0, as formulas over numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Const, Formula, Var, fold, postorder
from rtamt.language.operators import STL, Sort

if TYPE_CHECKING:
    from collections.abc import Collection


def remainder(a: Formula, b: Formula) -> Formula:
    """Return the remainder of integers, which has the sign of ``a``.

    >>> print(remainder(Var("x"), Const(-3.0)))
    sign(x) * mod(abs(x), 3)
    """
    return _signed(STL["mod"](_magnitude(a), _magnitude(b)), a)


def quotient(a: Formula, b: Formula) -> Formula:
    """Return the quotient of integers.

    >>> print(quotient(Var("x"), Const(-3.0)))
    sign(x) * -floor(abs(x) / 3)
    """
    return _signed(STL["floor"](STL["div"](_magnitude(a), _magnitude(b))), a, b)


def with_integers(formula: Formula, integers: Collection[str]) -> Formula:
    """Return a formula in which the quotients of integers are integers.

    ``integers``: the names of variables. A comparison is one of integers or of floats as a whole.
    """

    def divided(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply):
            return node
        return quotient(*args) if node.op is STL["div"] else node.op(*args, interval=node.interval)

    def compared(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply):
            return node
        if _is_comparison(node) and any(isinstance(e, Var) and e.name in integers for e in postorder(node)):
            args = tuple(fold(each, divided) for each in node.args)
        return node.op(*args, interval=node.interval)

    return fold(formula, compared)


def _is_comparison(node: Apply) -> bool:
    return node.op.result is not Sort.NUMBER and all(sort is Sort.NUMBER for sort in node.op.operands)


def _signed(magnitude: Formula, *factors: Formula) -> Formula:
    """Return a number of at least 0 with the sign of a product."""
    for factor in reversed(factors):
        if not isinstance(factor, Const):
            magnitude = STL["mul"](STL["sign"](factor), magnitude)
        elif factor.value < 0:
            magnitude = STL["neg"](magnitude)
    return magnitude


def _magnitude(number: Formula) -> Formula:
    return Const(abs(number.value)) if isinstance(number, Const) else STL["abs"](number)
