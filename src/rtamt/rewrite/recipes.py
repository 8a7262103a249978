"""The expansions of built-in operators without an interval, found once: they are the same whatever the operands."""

from __future__ import annotations

from functools import cache

from rtamt.language.formula import Apply, Formula, Var, postorder
from rtamt.language.operators import Bounds, builtin
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING
from rtamt.rewrite.desugar import expand

if TYPE_CHECKING:
    from rtamt.language.records import Operator


class Step(NamedTuple):
    """One node of an expansion, a constant or a core operator.

    ``places``: those of its operands, among the operands of the expanded operator and the steps before, in this order.
    ``reads``: the operands of the expanded operator that come between the step before and this one in postorder.
    """

    node: Formula
    places: tuple[int, ...]
    reads: tuple[int, ...]


def recipe_of(op: Operator) -> tuple[Step, ...] | None:
    """Return the steps of an operator's expansion, the result last; None if it may depend on more than its arity.

    >>> from rtamt.language.operators import STL
    >>> for step in recipe_of(STL["implies"]):
    ...     print(step.node.op.name, step.places, step.reads)
    neg (0,) (0,)
    or (2, 1) (1,)
    """
    if op.bounds is not Bounds.NONE or op.optional or builtin(op.name) is not op:
        return None
    return _builtin_recipe(op)


@cache
def _builtin_recipe(op: Operator) -> tuple[Step, ...] | None:
    operands = tuple([Var(f"#{place}") for place in range(len(op.operands))])
    places = {id(operand): place for place, operand in enumerate(operands)}
    steps: list[Step] = []
    reads: list[int] = []
    for node in postorder(expand(Apply(op, operands), operands)):
        place = places.get(id(node))
        if place is not None:
            reads.append(place)
            continue
        if isinstance(node, Apply) and node.interval is not None:
            return None
        below = tuple([places[id(arg)] for arg in node.args]) if isinstance(node, Apply) else ()
        places[id(node)] = len(operands) + len(steps)
        steps.append(Step(node, below, tuple(reads)))
        reads = []
    unused = sum(len(step.reads) for step in steps) < len(operands)
    return tuple(steps) if steps and not unused else None
