"""Semantics other than robustness, as a lowering of predicates: everything else stays as it is.

The Boolean semantics replaces each predicate by its truth, +inf or -inf; min and max then compute
Boolean satisfaction, for every operator, in every engine.
"""

from __future__ import annotations

from dataclasses import replace

from rtamt.language.formula import Apply, Const, Formula, fold
from rtamt.language.operators import Sort, holds


def boolean(formula: Formula) -> Formula:
    """Return the formula whose robustness is +inf where ``formula`` holds and -inf where it does not.

    ``>`` and ``>=`` differ at equality; a number used as a formula holds where it is positive.

    >>> from rtamt.language.parser import parse_formula
    >>> str(boolean(parse_formula("always(x >= 3)")))
    'always holds_ge(x, 3)'
    """

    def lower(node: Formula, below: tuple[tuple[Formula, Formula], ...]) -> tuple[Formula, Formula]:
        """Return the node read as a number, and read as a formula."""
        if isinstance(node, Const) and abs(node.value) == float("inf"):
            return node, node
        if not isinstance(node, Apply) or node.op.result is Sort.NUMBER:
            return node, replace(holds(node), span=node.span)  # type: ignore[type-var]
        if node.op.truth is not None:
            return node, replace(node.op.truth(*node.args, None), span=node.span)  # type: ignore[type-var]
        args = tuple(
            as_formula if sort is Sort.FORMULA else as_number
            for sort, (as_number, as_formula) in zip(node.op.operands, below, strict=True)
        )
        return node, replace(node, args=args)

    return fold(formula, lower)[1]
