"""Rules that the parser and the printer share: chaining, signs and the maximum nesting depth."""

from __future__ import annotations

from rtamt.language.formula import Apply, Const
from rtamt.language.operators import Fixity, Sort
from rtamt.language.value_types import BOOLEAN, LITERALS
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rtamt.language.formula import Formula
    from rtamt.language.operators import Language, Operator

#: The maximum nesting depth of a text. Chains such as ``a and b and c`` are flat.
MAX_DEPTH = 200

#: The spelling of infinity, unless a variable has this name.
INFINITY = "inf"

#: The words between the operands of ``if``.
THEN, ELSE = "then", "else"


def is_infix(op: Operator) -> bool:
    """Return whether an operator is written between its operands.

    >>> from rtamt.language.operators import STL
    >>> is_infix(STL["until"]), is_infix(STL["not"])
    (True, False)
    """
    return op.fixity is Fixity.LEFT or op.fixity is Fixity.RIGHT


def is_predicate(op: Operator) -> bool:
    """Return whether an infix operator turns numbers into a formula; only comparisons chain.

    >>> from rtamt.language.operators import STL
    >>> is_predicate(STL["ge"]), is_predicate(STL["add"]), is_predicate(STL["and"])
    (True, False, False)
    """
    return op.result is Sort.FORMULA and Sort.NUMBER in op.operands and is_infix(op)


def chains(first: Operator, second: Operator) -> bool:
    """Return whether two comparisons in a row have one direction: ``1 <= x < 3`` is ``1 <= x and x < 3``.

    >>> from rtamt.language.operators import STL
    >>> chains(STL["le"], STL["lt"]), chains(STL["le"], STL["gt"])
    (True, False)
    """
    spellings = {first.spellings[0], second.spellings[0]}
    return spellings <= {"<", "<="} or spellings <= {">", ">="}


def is_chain(node: Apply) -> bool:
    """Return whether a conjunction was written as a chain of comparisons, which share what is between them.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> is_chain(parse_formula("1 < x < 3")), is_chain(parse_formula("1 < x and x < 3"))
    (True, False)
    """
    if node.op.name != "and":
        return False
    left, right = node.args
    while isinstance(left, Apply) and left.op is node.op:
        left = left.args[1]
    if not (isinstance(left, Apply) and isinstance(right, Apply)):
        return False
    if not (is_predicate(left.op) and is_predicate(right.op)) or left.span is None or right.span is None:
        return False
    return left.args[1] is right.args[0] and left.span.start < right.span.start < left.span.end


def is_number(formula: Formula) -> bool:
    """Return whether a formula is a number by itself: a variable, a constant or arithmetic."""
    return not isinstance(formula, Apply) or formula.op.result is Sort.NUMBER


def is_literal(formula: Formula) -> bool:
    """Return whether a constant was written as true or false."""
    return isinstance(formula, Const) and formula.type is BOOLEAN and formula.name in LITERALS


def passes_on(op: Operator) -> bool:
    """Return whether a weaker prefix operator may follow this one: ``not always x`` is legal, ``-always x`` is not.

    >>> from rtamt.language.operators import STL
    >>> passes_on(STL["not"]), passes_on(STL["neg"])
    (True, False)
    """
    return op.fixity is Fixity.PREFIX and op.operands[0] is Sort.FORMULA


def sign(language: Language) -> Operator | None:
    """Return the operator that, before a number, is the number's sign."""
    op = language.opening("-")
    return op if op is not None and op.fixity is Fixity.PREFIX else None
