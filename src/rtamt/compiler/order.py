"""The order in which lowering visits the operands of an operator and emits what it is expanded into."""

from __future__ import annotations

from functools import cache

from rtamt.compiler.program import CODES
from rtamt.language.formula import Apply
from rtamt.language.operators import Pointwise, Sort, builtin
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING
from rtamt.rewrite.recipes import recipe_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.language.formula import Formula
    from rtamt.language.records import Operator
    from rtamt.rewrite.recipes import Step


class Group(NamedTuple):
    """Operands of an operator, and the steps of its recipe that are emitted once these are found.

    Each step has the code of a pointwise operator, None for other nodes; the node; and the places of its operands.
    """

    reads: tuple[int, ...]
    steps: tuple[tuple[int | None, Formula, tuple[int, ...]], ...]


class Order(NamedTuple):
    """How an operator is lowered.

    ``alone``: the code and operands of its one instruction, if it is pointwise or expanded into such an operator.
    ``groups``: those of an operator that is expanded into several. One without either reads its operands from left to
    right.
    """

    alone: tuple[int, int, int | None] | None
    groups: tuple[Group, ...]


def order_of(op: Operator) -> Order:
    """Return how an operator is lowered; one that is expanded has a recipe.

    >>> from rtamt.language.operators import STL
    >>> order_of(STL["le"]).alone, len(order_of(STL["implies"]).groups)
    ((8, 1, 0), 2)
    """
    return _builtin_order(op) if builtin(op.name) is op else _order(op)


def is_derived(op: Operator) -> bool:
    """Return whether an operator is expanded before it has instructions."""
    return op.kernel is None and op.expansion is not None


def is_lowerable(op: Operator) -> bool:
    """Return whether an operator of a text needs no expansion before lowering."""
    if op.definition is None or Sort.CONDITION in op.operands:
        return False
    return not is_derived(op) or recipe_of(op) is not None


def _order(op: Operator) -> Order:
    recipe = recipe_of(op) if is_derived(op) else None
    if recipe is None:
        own = tuple(range(len(op.operands))) if not op.optional else ()
        return Order(_alone(op, own), ())
    (node, places, _), *others = recipe
    alone = _alone(node.op, places) if isinstance(node, Apply) and not others else None
    return Order(alone, () if alone is not None else _groups(recipe))


_builtin_order = cache(_order)


def _alone(op: Operator, places: Sequence[int]) -> tuple[int, int, int | None] | None:
    if not isinstance(op.kernel, Pointwise) or not 1 <= len(places) <= 2:
        return None
    first, *second = places
    return CODES[op.kernel.opcode], first, second[0] if second else None


def _groups(recipe: Sequence[Step]) -> tuple[Group, ...]:
    groups: list[Group] = []
    for node, places, reads in recipe:
        kernel = node.op.kernel if isinstance(node, Apply) else None
        step = CODES[kernel.opcode] if isinstance(kernel, Pointwise) else None, node, places
        if reads or not groups:
            groups.append(Group(reads, (step,)))
        else:
            before = groups.pop()
            groups.append(Group(before.reads, (*before.steps, step)))
    return tuple(groups)
