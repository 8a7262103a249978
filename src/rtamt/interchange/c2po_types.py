"""The types of C2PO's expressions: equality of Booleans and arithmetic with integers are operators of their own.

R2U2 stores the result of every operation with ints as an int, also of constants: ``7 / 2`` is 3. C2PO rejects
operations with operands of several types. A number without a fraction is accepted here beside floats, too.
"""

from __future__ import annotations

import math
from enum import Enum
from typing import TYPE_CHECKING, TypeAlias

from rtamt.interchange.c_integers import quotient
from rtamt.interchange.dialect import InexpressibleError
from rtamt.language.formula import Apply, Const, Formula, Var, fold
from rtamt.language.operators import STL, Sort
from rtamt.language.unwritten import TRUTH
from rtamt.language.value_types import BOOLEAN
from rtamt.lazy.dataclasses import dataclass

if TYPE_CHECKING:
    from collections.abc import Collection


class _Kind(Enum):
    BOOL = "bool"
    INT = "int"
    FLOAT = "float"
    NUMERAL = "numeral"  # int, and float beside another one
    MEMBER = "member"  # of an enumeration


_Typed: TypeAlias = tuple[Formula, _Kind]


@dataclass(frozen=True, slots=True, repr=False)
class _Numeral(Const):
    """A number that was written without a decimal point."""


def with_numerals(formula: Formula, text: str) -> Formula:
    """Return a parsed formula in which numbers are ints or floats, as the text has them.

    The numbers of definitions, which come from other texts, have been treated with these.
    """

    def marked(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if isinstance(node, Apply):
            return node.op(*args, interval=node.interval)
        if type(node) is not Const or node.type is not None or node.span is None:
            return node
        whole = "." not in text[node.span.start : node.span.end]
        return _Numeral(node.value) if whole else Const(node.value)

    return fold(formula, marked)


def resolved(formula: Formula, integers: Collection[str]) -> Formula:
    """Return a formula with the meaning that the types of its operands give to its operators.

    Args:
        formula: as :func:`with_numerals` returns it, with the definitions that it uses.
        integers: the names of the variables that are ints.

    Raises:
        InexpressibleError: C2PO rejects the types of some operands, or the value of a constant.
    """

    def step(node: Formula, args: tuple[_Typed, ...]) -> _Typed:
        if isinstance(node, Apply):
            return _applied(node, args)
        if not isinstance(node, Var | Const):
            return node, _Kind.FLOAT
        if node.type is not None:
            return node, _Kind.BOOL if node.type is BOOLEAN else _Kind.MEMBER
        if isinstance(node, Var):
            return node, _Kind.INT if node.name in integers else _Kind.FLOAT
        return Const(node.value), _Kind.NUMERAL if isinstance(node, _Numeral) else _Kind.FLOAT

    return fold(formula, step)[0]


def _applied(node: Apply, typed: tuple[_Typed, ...]) -> _Typed:
    op, args, kinds = node.op, tuple(each for each, _ in typed), tuple(kind for _, kind in typed)
    plain = op(*args, interval=node.interval)
    if op is TRUTH or Sort.NUMBER not in op.operands:
        return plain, _Kind.BOOL
    if op.result is not Sort.NUMBER and set(kinds) == {_Kind.BOOL}:
        return _of_booleans(node, args), _Kind.BOOL
    if op.keeps and len(set(kinds)) == 1:
        return plain, kinds[0]
    kind = _common(node, kinds)
    if op.result is not Sort.NUMBER:
        return plain, _Kind.BOOL
    if kind is _Kind.FLOAT:
        return plain, kind
    return _of_integers(node, args, plain), kind


def _common(node: Apply, kinds: tuple[_Kind, ...]) -> _Kind:
    """Return the type that all operands have; raise where there is none."""
    if _Kind.BOOL in kinds:
        k = kinds.index(_Kind.BOOL)
        raise InexpressibleError(f"'{node.args[k]}' is a bool, and a number is needed in '{node}'")
    if _Kind.INT in kinds and _Kind.FLOAT in kinds:
        whole, other = kinds.index(_Kind.INT), kinds.index(_Kind.FLOAT)
        raise InexpressibleError(
            f"'{node.args[whole]}' is an int and '{_float(node.args[other])}' is a float in '{node}', "
            f"and C2PO has no operators for both"
        )
    return next((kind for kind in kinds if kind is not _Kind.NUMERAL), _Kind.NUMERAL)


def _float(operand: Formula) -> str:
    return str(operand.value if isinstance(operand, Const) else operand)


def _of_booleans(node: Apply, args: tuple[Formula, ...]) -> Formula:
    """Return a comparison of Booleans."""
    if not node.op.equates:
        raise InexpressibleError(f"'{node.args[0]}' is a bool, and a number is needed in '{node}'")
    return STL["iff" if node.op.name == "eq" else "xor"](*map(_condition, args))


def _condition(operand: Formula) -> Formula:
    return TRUTH(operand) if isinstance(operand, Var | Const) else operand


def _of_integers(node: Apply, args: tuple[Formula, ...], plain: Formula) -> Formula:
    """Return an operation with ints, whose result is one."""
    name = node.op.name
    if name in ("div", "mod") and isinstance(args[1], Const) and args[1].value == 0:
        raise InexpressibleError(f"'{node}' divides by zero")
    if name == "div":
        return _divided(*args)
    if name == "sqrt":
        return STL["floor"](plain)
    if name == "pow":
        exponent = args[1].args[0] if isinstance(args[1], Apply) and args[1].op is STL["neg"] else args[1]
        if not isinstance(exponent, Const):
            raise InexpressibleError(f"the exponent in '{node}' is not constant, as C2PO needs it for ints")
        if exponent is not args[1] or exponent.value < 0:
            raise InexpressibleError(
                f"the exponent in '{node}' is negative, which C2PO does not have for ints"
            )
    return plain


def _divided(a: Formula, b: Formula) -> Formula:
    if isinstance(a, Const) and isinstance(b, Const):
        return Const(float(math.trunc(a.value / b.value)))
    return quotient(a, b)
