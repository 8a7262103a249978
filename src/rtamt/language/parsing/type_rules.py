"""Where Booleans and enumerations are allowed, and the results of operators on them.

Numbers and formulas have no type here (None): an operator takes one for the other, as its definition says.
"""

from __future__ import annotations

from functools import partial

from rtamt.language.formula import Apply, Const, Formula, Parameter, Var
from rtamt.language.operators import STL, Sort, Tense
from rtamt.language.parsing.grammar import is_literal, is_number
from rtamt.language.unwritten import TRUTH
from rtamt.language.value_types import BOOLEAN, LITERALS, UNKNOWN, Ambiguous, Enumeration
from rtamt.lazy.typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rtamt.language.operators import Operator
    from rtamt.language.value_types import PartType

    #: The text of an operand, by its number.
    Texts: TypeAlias = Callable[[int], str]
    #: How the text writes the member of an enumeration.
    MemberText: TypeAlias = Callable[[Enumeration, str], str]


class MistypedError(Exception):
    """An operand of the wrong type: the message, and the number of the operand (None: all of them)."""

    def __init__(self, message: str, operand: int | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.operand = operand


def type_of(formula: Formula) -> PartType:
    """Return the type of a formula; None for numbers and for what holds or does not.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> type_of(parse_formula("x + 1"))
    """
    if isinstance(formula, Var | Const):
        return formula.type
    if isinstance(formula, Apply) and not formula.op.keeps:
        return None
    leaves: list[PartType] = []
    stack, seen = [formula], set()
    while stack:  # what an operator keeps may be nested through thousands of definitions
        node = stack.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        if isinstance(node, Var | Const):
            leaves.append(node.type)
        else:
            assert isinstance(node, Apply)
            kept = [node.args[k] for k in node.op.keeps if k < len(node.args)]
            stack += kept
            leaves += [] if kept else [None]
    # All are of one enumeration, as `typed` makes sure; a Boolean beside a number is a number.
    if UNKNOWN in leaves:
        return UNKNOWN
    return leaves[0] if len(set(leaves)) == 1 else None


def as_literal(formula: Formula) -> Formula:
    """Return ``true`` and ``false`` as Booleans, for operators that keep the type of an operand; all else as it is."""
    if isinstance(formula, Apply) and formula.op.name in LITERALS:
        return Const(float(LITERALS[formula.op.name]), formula.span, formula.op.name, BOOLEAN)
    return formula


def as_formula(formula: Formula) -> Formula:
    """Return a Boolean as a formula: +inf where it is true, else -inf; anything else unchanged."""
    if type_of(formula) is not BOOLEAN:
        return formula
    if isinstance(formula, Const) and not isinstance(formula, Parameter):
        return STL["true" if formula.value else "false"]()
    return Apply(TRUTH, (formula,), None, formula.span)


def typed(
    op: Operator, args: Sequence[Formula], texts: Texts, member: MemberText
) -> tuple[Operator, tuple[Formula, ...]]:
    """Return the intended operator and operands; raise :class:`MistypedError` if a type is wrong.

    A Boolean in place of a formula is its truth. Members of enumerations are resolved by the type of the other
    operand, and compared by truth.
    """
    types = [type_of(operand) for operand in args]
    if not any(types) or UNKNOWN in types or op.presence:  # a template is checked where it is used
        return op, tuple(args)
    _refuse_literals(op, args, types, texts)
    enumerated = [k for k, each in enumerate(types) if isinstance(each, Enumeration | Ambiguous)]
    if not enumerated:
        if op.equates:
            _refuse_formulas(args, types, texts)
        return op, tuple(
            operand if sort is Sort.NUMBER else as_formula(operand)
            for sort, operand in zip(op.operands, args, strict=False)
        )
    for k in enumerated:
        if op.operands[k] is not Sort.NUMBER:
            raise MistypedError(no_formula(texts(k), types[k], member), k)
        if not op.equates and k not in op.keeps:
            raise MistypedError(
                f"'{texts(k)}' is of the {_type_name(types[k])}, which has neither arithmetic nor order; "
                f"compare it with == or !=, such as {_comparison(texts(k), types[k], member)}",
                k,
            )
    same_type = range(len(args)) if op.equates else [k for k in op.keeps if k < len(args)]
    one = _one_type([types[k] for k in same_type], [texts(k) for k in same_type], args, member)
    meant = [
        _resolve(operand, one) if k in same_type else as_formula_at(op, k, operand)
        for k, operand in enumerate(args)
    ]
    if op.equates:
        assert op.truth is not None
        compared = op.truth(*meant, None)
        assert isinstance(compared, Apply)
        return compared.op, compared.args
    return op, tuple(meant)


def as_formula_at(op: Operator, k: int, operand: Formula) -> Formula:
    """Return an operand as the operator reads it."""
    return operand if op.operands[k] is Sort.NUMBER else as_formula(operand)


def _one_type(
    types: Sequence[PartType], texts: Sequence[str], args: Sequence[Formula], member: MemberText
) -> Enumeration:
    """Return the enumeration that operands share."""
    known = [each for each in types if isinstance(each, Enumeration)]
    if not known:
        k = next(k for k, each in enumerate(types) if isinstance(each, Ambiguous))
        raise MistypedError(ambiguous(texts[k], types[k]))
    one = known[0]
    here = texts[types.index(one)]
    for k, each in enumerate(types):
        if each == one or (isinstance(each, Ambiguous) and one in each.choices):
            continue
        if each is None:
            if isinstance(args[types.index(one)], Const) and not isinstance(
                args[types.index(one)], Parameter
            ):
                raise MistypedError(
                    f"'{here}' is a member of {one.name}, and '{texts[k]}' is none of its values; "
                    f"declare the variable, such as input {one.name} {texts[k]}"
                )
            raise MistypedError(
                f"'{here}' is of the {_type_name(one)}, and '{texts[k]}' is none of its members; "
                f"write one of them: {one.listing(partial(member, one))}"
            )
        other = "a Boolean" if each is BOOLEAN else f"of the {_type_name(each)}"
        raise MistypedError(
            f"'{here}' is of the {_type_name(one)}, and '{texts[k]}' is {other}; compare values of one enumeration"
        )
    return one


def _resolve(operand: Formula, one: Enumeration) -> Formula:
    if isinstance(operand, Const) and isinstance(operand.type, Ambiguous):
        assert operand.name is not None
        code = one.code(operand.name)
        assert code is not None
        return Const(float(code), operand.span, operand.name, one)
    return operand


def _refuse_literals(op: Operator, args: Sequence[Formula], types: Sequence[PartType], texts: Texts) -> None:
    """Refuse ``delay(x, false)`` of a number, and ``delay(true)``: a literal is a Boolean beside one."""
    kept = [k for k in op.keeps if k < len(args)]
    if kept and all(is_literal(args[k]) for k in kept):
        raise MistypedError(takes_number(op, texts(kept[0])), kept[0])
    other = next((k for k in kept if types[k] is None), None)
    for k in kept:
        if is_literal(args[k]) and other is not None:
            raise MistypedError(
                f"'{texts(other)}' is a number, and '{texts(k)}' is true or false; write a number, such as 0",
                k,
            )


def _refuse_formulas(args: Sequence[Formula], types: Sequence[PartType], texts: Texts) -> None:
    """Refuse ``p == true``: it would compare 1 with the robustness of true."""
    for k, operand in enumerate(args):
        if types[k] is None and not is_number(operand):
            other = texts(types.index(BOOLEAN))
            raise MistypedError(
                f"'{texts(k)}' is a formula, and == compares numbers; write {other} <-> {texts(k)}, or {other} alone"
            )


def takes_number(op: Operator, written: str) -> str:
    """Return the message for a formula as an operand of an operator that takes a number."""
    how_long = "" if op.tense is Tense.NONE else f", or duration({written}) for how long it holds"
    return (
        f"'{op.spellings[0]}' takes a number, and '{written}' is a formula, true or false; "
        f"write a signal or arithmetic, such as (if {written} then 1 else 0){how_long}"
    )


def no_formula(text: str, type_: PartType, member: MemberText) -> str:
    """Return the message for a value of an enumeration in place of a formula."""
    return (
        f"'{text}' is of the {_type_name(type_)}, and a formula is expected here; "
        f"compare it, such as {_comparison(text, type_, member)}"
    )


def ambiguous(name: str, type_: PartType) -> str:
    """Return the message for a member's name that several enumerations have."""
    assert isinstance(type_, Ambiguous)
    names = [each.name for each in type_.choices]
    return f"'{name}' is a member of {' and of '.join(names)}; write {' or '.join(f'{each}.{name}' for each in names)}"


def _type_name(type_: PartType) -> str:
    if isinstance(type_, Ambiguous):
        return f"enumerations {' and '.join(each.name for each in type_.choices)}"
    assert isinstance(type_, Enumeration)
    return f"enumeration {type_.name}"


def _comparison(text: str, type_: PartType, member: MemberText) -> str:
    one = type_.choices[0] if isinstance(type_, Ambiguous) else type_
    assert isinstance(one, Enumeration)
    return f"{text} == {member(one, one.names[0])}"
