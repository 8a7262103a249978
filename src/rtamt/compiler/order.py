"""The order in which lowering visits the operands of an operator and emits what it is expanded into."""

from __future__ import annotations

from functools import cache

from rtamt.compiler.program import CODES
from rtamt.language.formula import Apply
from rtamt.language.operators import Pointwise, Sort, builtin
from rtamt.lazy.typing import TYPE_CHECKING
from rtamt.rewrite.recipes import recipe_of

if TYPE_CHECKING:
    from typing import TypeAlias

    from rtamt.language.formula import Formula
    from rtamt.language.records import Operator

    #: What is emitted over the last values: the code of a pointwise operator, None for others; the number of values;
    #: the node, None for the operator that is lowered; and whether its own value is the result.
    Step: TypeAlias = tuple[int | None, int, Formula | None, bool]
    #: The code of an instruction over two operands, and the places of these.
    Pair: TypeAlias = tuple[int, int, int]


def order_of(op: Operator) -> tuple[int | Step, ...] | None:
    """Return how an operator is lowered, in postfix notation, last first: places of operands, and steps over these.

    One that is expanded has a recipe. None for one with optional operands, which are read from left to right.

    >>> from rtamt.language.operators import STL
    >>> order_of(STL["le"])
    ((8, 2, None, True), 0, 1)
    >>> [each if isinstance(each, int) else each[1] for each in order_of(STL["implies"])]
    [2, 1, 1, 0]
    """
    return _builtin_order(op) if builtin(op.name) is op else _order(op)


def pair_of(op: Operator) -> Pair | None:
    """Return how an operator that is one instruction over two operands is lowered; None for any other.

    >>> from rtamt.language.operators import STL
    >>> pair_of(STL["le"]), pair_of(STL["implies"])
    ((8, 1, 0), None)
    """
    match order_of(op):
        case ((int() as code, _, _, _), int() as last, int() as first):
            return code, first, last
        case _:
            return None


def is_derived(op: Operator) -> bool:
    """Return whether an operator is expanded before it has instructions."""
    return op.kernel is None and op.expansion is not None


def is_lowerable(op: Operator) -> bool:
    """Return whether an operator of a text needs no expansion before lowering."""
    if op.definition is None or Sort.CONDITION in op.operands:
        return False
    return not is_derived(op) or recipe_of(op) is not None


def _order(op: Operator) -> tuple[int | Step, ...] | None:
    recipe = recipe_of(op) if is_derived(op) else None
    if recipe is None:
        if op.optional:
            return None
        places = range(len(op.operands))
        return (_code(op, len(places)), len(places), None, True), *reversed(places)
    # A step that two others read occurs twice: it has the same instructions.
    found: list[int | Step] = []
    stack = [len(op.operands) + len(recipe) - 1]
    while stack:
        place = stack.pop()
        if place < len(op.operands):
            found.append(place)
            continue
        node, below, _ = recipe[place - len(op.operands)]
        code = _code(node.op, len(below)) if isinstance(node, Apply) else None
        found.append((code, len(below), node if code is None else None, not found))
        stack += below
    return tuple(found)


_builtin_order = cache(_order)


class Orders(dict["Operator", "tuple[Pair | None, tuple[int | Step, ...] | None]"]):
    """How the operators of some formulas are lowered, found on first use: :func:`pair_of` and :func:`order_of`."""

    def __missing__(self, op: Operator) -> tuple[Pair | None, tuple[int | Step, ...] | None]:
        found = self[op] = pair_of(op), order_of(op)
        return found


def _code(op: Operator, operands: int) -> int | None:
    return CODES[op.kernel.opcode] if isinstance(op.kernel, Pointwise) and 1 <= operands <= 2 else None
