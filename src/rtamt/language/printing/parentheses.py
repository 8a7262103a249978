"""Which operands need parentheses in a text, and which names need quotes."""

from __future__ import annotations

from math import copysign

from rtamt.language.formula import Apply, Const, Formula, Parameter, Var
from rtamt.language.operators import Fixity, Language, Operator
from rtamt.language.parsing.grammar import ELSE, INFINITY, THEN, is_infix, is_predicate, passes_on
from rtamt.language.parsing.lexer import NAME, TOPIC, is_word, quoted
from rtamt.language.unwritten import PRESENT, TRUTH, WHERE_PRESENT
from rtamt.language.value_types import Enumeration
from rtamt.lazy.typing import TYPE_CHECKING, TypeGuard

if TYPE_CHECKING:
    from rtamt.language.printing.writing import Piece


def written_operand(formula: Formula) -> Formula:
    """Return the operand as written: a Boolean itself, not its truth; a number, not the guard around it."""
    while isinstance(formula, Apply) and formula.op in (TRUTH, WHERE_PRESENT, PRESENT):
        formula = formula.args[-1]
    return formula


def truth_of(node: Apply) -> Piece:
    """Return the written form of the truth of a Boolean; for a parameter, its value as a formula."""
    (operand,) = node.args
    return ("true" if operand.value else "false") if isinstance(operand, Parameter) else operand


def is_member(formula: Formula) -> TypeGuard[Const]:
    """Return whether a formula is a member of an enumeration, which is written as its name."""
    if isinstance(formula, Parameter):
        return isinstance(formula.type, Enumeration) and formula.type.member(formula.value) is not None
    return isinstance(formula, Const) and isinstance(formula.type, Enumeration) and formula.name is not None


def member_name(member: Const) -> str:
    """Return the name under which a member is written; of a parameter the member that is its value."""
    if isinstance(member, Parameter):
        assert isinstance(member.type, Enumeration)
        return f"{member.type.name}.{member.type.member(member.value)}"
    return str(member.name)


def _is_negative(formula: Formula) -> bool:
    return isinstance(formula, Const) and not is_member(formula) and copysign(1.0, formula.value) < 0


def is_choice(formula: Formula) -> bool:
    """Return whether a formula is ``if ... then ... else ...`` or a quantifier: what follows would belong to it."""
    formula = written_operand(formula)
    return isinstance(formula, Apply) and formula.op.fixity in (Fixity.CONDITIONAL, Fixity.QUANTIFIER)


def needs_group(operand: Formula, op: Operator) -> bool:
    """Return whether the operand of a prefix operator needs parentheses (also a number after a minus)."""
    operand = written_operand(operand)
    if isinstance(operand, Apply):
        return operand.op.fixity not in (Fixity.FUNCTION, Fixity.ATOM)
    return isinstance(operand, Const) and (_is_negative(operand) or not passes_on(op))


def falls_apart(child: Formula, op: Operator, side: Fixity, minus: Operator | None) -> bool:
    """Return whether an infix operator's operand needs parentheses, on the side to which ``side`` chains."""
    child = written_operand(child)
    if _is_negative(child):
        return minus is None or minus.power <= op.power
    if not isinstance(child, Apply) or child.op.fixity in (Fixity.FUNCTION, Fixity.ATOM):
        return False
    if is_choice(child) or (is_predicate(child.op) and is_predicate(op)):
        return True
    chain = child.op.power == op.power and child.op.fixity is op.fixity is side
    return child.op.power <= op.power and not chain


def reads_on(child: Formula, op: Operator, language: Language, *, left: bool = False) -> bool:
    """Return whether a variable such as ``G`` or ``S`` would be read as the operator of that spelling.

    This happens where a symbol may follow that can also begin an operand: ``G - 3`` is always(-3).
    """
    name = _leaf_name(child)
    if name is None or name_text(name, language) != name:
        return False
    prefix, infix = language.opening(name), language.infix(name)
    if infix is None and (prefix is None or prefix.fixity is not Fixity.PREFIX):
        # A topic after a word could also be a division.
        return TOPIC.fullmatch(name) is not None and is_word(op.spellings[0])
    if op.fixity is Fixity.PREFIX and infix is not None:
        return True
    if left:
        return language.opening(op.spellings[0]) is not None
    return any(
        other.power <= op.power and any(map(language.opening, other.spellings))
        for other in language
        if is_infix(other)
    )


def hides_choice(condition: Formula, language: Language) -> bool:
    """Return whether ``if`` before this condition could be a variable: ``if - x > G then`` may end in always(then)."""
    first = last = written_operand(condition)
    while isinstance(first, Apply) and is_infix(first.op):
        first = written_operand(first.args[0])
    while isinstance(last, Apply) and (is_infix(last.op) or last.op.fixity is Fixity.PREFIX):
        last = written_operand(last.args[-1])
    begin, end = _leaf_name(first), _leaf_name(last)
    signed = _is_negative(first) if not isinstance(first, Apply) else first.op.spellings[0] == "-"
    if end is None or not (signed or (begin is not None and language.infix(begin) is not None)):
        return False
    opening = language.opening(end)
    return language.infix(end) is not None or (opening is not None and opening.fixity is Fixity.PREFIX)


def _leaf_name(formula: Formula) -> str | None:
    """Return the name of a variable, or of a member of an enumeration; None for all else."""
    formula = written_operand(formula)
    if isinstance(formula, Var):
        return formula.name
    return member_name(formula) if is_member(formula) else None


def name_text(name: str, language: Language) -> str:
    """Return a variable's name, in double quotes if it would not be read as a name."""
    if NAME.fullmatch(name) is None and TOPIC.fullmatch(name) is None:
        return quoted(name)
    opening, infix = language.opening(name), language.infix(name)
    spelled_out = (
        name == INFINITY
        or (opening is not None and opening.fixity is Fixity.ATOM)
        or (opening is not None and opening.fixity is Fixity.PREFIX and len(name) > 2)
        or (infix is not None and len(name) > 1)
        or (opening is not None and opening.fixity is Fixity.CONDITIONAL)
        or name in (THEN, ELSE)
    )
    return quoted(name) if spelled_out else name
