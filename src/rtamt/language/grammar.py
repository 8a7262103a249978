"""What the parser and the printer must agree on: what chains, what a sign is, how deep is too deep."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.language.formula import Apply
from rtamt.language.operators import Fixity, Sort

if TYPE_CHECKING:
    from rtamt.language.formula import Formula
    from rtamt.language.operators import Language, Operator

#: How many formulas may stand inside one another in a text. Chains such as ``a and b and c`` are flat.
MAX_DEPTH = 200

#: The number that is larger than all others, where no variable has this name.
INFINITY = "inf"


def is_infix(op: Operator) -> bool:
    """Tell whether an operator stands between its operands.

    >>> from rtamt.language.operators import STL
    >>> is_infix(STL["until"]), is_infix(STL["not"])
    (True, False)
    """
    return op.fixity is Fixity.LEFT or op.fixity is Fixity.RIGHT


def is_predicate(op: Operator) -> bool:
    """Tell whether an infix operator makes a formula of numbers: such operators do not chain.

    >>> from rtamt.language.operators import STL
    >>> is_predicate(STL["ge"]), is_predicate(STL["add"]), is_predicate(STL["and"])
    (True, False, False)
    """
    return op.result is Sort.FORMULA and Sort.NUMBER in op.operands and is_infix(op)


def is_number(formula: Formula) -> bool:
    """Tell whether a formula is a number by itself: a variable, a constant or arithmetic."""
    return not isinstance(formula, Apply) or formula.op.result is Sort.NUMBER


def passes_on(op: Operator) -> bool:
    """Tell whether a weaker prefix operator may stand under this one: ``not always x``, never ``-always x``.

    >>> from rtamt.language.operators import STL
    >>> passes_on(STL["not"]), passes_on(STL["neg"])
    (True, False)
    """
    return op.fixity is Fixity.PREFIX and op.operands[0] is Sort.FORMULA


def sign(language: Language) -> Operator | None:
    """Return the operator that, before a number, is the number's sign."""
    op = language.opening("-")
    return op if op is not None and op.fixity is Fixity.PREFIX else None
