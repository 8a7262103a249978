"""Formulas with one part replaced by another."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Formula, folds

if TYPE_CHECKING:
    from collections.abc import Sequence


def substituted(formulas: Sequence[Formula], old: Formula, new: Formula) -> tuple[Formula, ...]:
    """Return formulas with the node ``old`` (this object, and no equal one) replaced; what has none of it is shared.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> formula = parse_formula("x > 1 and x > 1")
    >>> print(*substituted([formula], formula.args[1], parse_formula("y > 2")))
    x > 1 and y > 2
    """

    def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if node is old:
            return new
        if not isinstance(node, Apply) or all(a is b for a, b in zip(args, node.args, strict=True)):
            return node
        return Apply(node.op, args, node.interval, node.span)

    return folds(formulas, step)
