"""Core formulas in which equal parts are one node, so that what walks them node by node visits each part once."""

from __future__ import annotations

from functools import cache
from math import copysign

from rtamt.language.formula import Apply, Const, Formula, Var, postorder
from rtamt.language.operators import Bounds, builtin
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.rewrite.desugar import expand, spelled_out_each
from rtamt.rewrite.truth import rebuilt

if TYPE_CHECKING:
    from collections.abc import Hashable, Sequence

    from rtamt.language.formula import Interval
    from rtamt.language.records import Operator


class _Recipe(NamedTuple):
    """The expansion of an operator without an interval, whatever its operands.

    ``constants``: the numbers in it. ``steps``: each a core operator and the places of its operands, among those of the
    expanded operator, the constants and the steps before. The last of all these is the result.
    """

    constants: tuple[Formula, ...]
    steps: tuple[tuple[Operator, tuple[int, ...]], ...]


def merged(formulas: Sequence[Formula]) -> tuple[Formula, ...]:
    """Return formulas as ``desugar`` does, but with one node for equal parts: the first, with its position in the text.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> (one,) = merged([parse_formula("always(x > 3) and eventually(x > 3)")])
    >>> print(one, one.args[0].args[0] is one.args[1].args[0])
    always(x - 3) and eventually(x - 3) True
    """
    sources = spelled_out_each(formulas)
    nodes = _Nodes()
    found: dict[int, Formula] = {}
    for node in postorder(*sources):
        if isinstance(node, Apply):
            args = tuple([found[id(arg)] for arg in node.args])
            derived = node.op.kernel is None and node.op.expansion is not None
            found[id(node)] = nodes.expanded(node, args) if derived else nodes.applied(node, args)
        else:
            found[id(node)] = nodes.leaf(node)
    return tuple([found[id(source)] for source in sources])


class _Nodes:
    """The nodes of core formulas, each by what distinguishes it."""

    def __init__(self) -> None:
        self.known: dict[Any, Formula] = {}
        self._recipes: dict[Operator, _Recipe | None] = {}

    def leaf(self, node: Formula) -> Formula:
        """Return the node for a variable or a constant."""
        return self.known.setdefault(_of_leaf(node), node)

    def expanded(self, node: Apply, args: tuple[Formula, ...]) -> Formula:
        """Return the node for the expansion of an operator whose operands are ``args``."""
        op = node.op
        try:
            recipe = self._recipes[op]
        except KeyError:
            recipe = self._recipes[op] = _recipe(op)
        if recipe is None or node.interval is not None:
            return self._merged(expand(node, args), {id(arg): arg for arg in args})
        known, span = self.known, node.span
        parts = [*args, *map(self.leaf, recipe.constants)] if recipe.constants else [*args]
        for core, places in recipe.steps:
            operands = tuple([parts[place] for place in places])
            key = (core, None, *map(id, operands))
            same = known.get(key)
            if same is None:
                same = known[key] = Apply(core, operands, None, span)
            parts.append(same)
        return parts[-1]

    def applied(self, node: Apply, args: tuple[Formula, ...]) -> Formula:
        """Return the node for a core operator."""
        interval = node.interval
        key = (node.op, None if interval is None else _of_interval(interval), *map(id, args))
        same = self.known.get(key)
        if same is None:
            same = self.known[key] = rebuilt(node, args)
        return same

    def _merged(self, node: Formula, done: dict[int, Formula]) -> Formula:
        """Return the node for one of an expansion, which has few; ``done``: what is known, by the identity of nodes."""
        found = done.get(id(node))
        if found is None:
            if isinstance(node, Apply):
                found = self.applied(node, tuple([self._merged(arg, done) for arg in node.args]))
            else:
                found = self.leaf(node)
            done[id(node)] = found
        return found


def _recipe(op: Operator) -> _Recipe | None:
    """Return the recipe of an operator to be expanded; None if its expansion may depend on more than its arity."""
    if op.bounds is not Bounds.NONE or op.optional or builtin(op.name) is not op:
        return None
    return _builtin_recipe(op)


@cache
def _builtin_recipe(op: Operator) -> _Recipe | None:
    operands = tuple([Var(f"#{place}") for place in range(len(op.operands))])
    nodes = postorder(expand(Apply(op, operands), operands))
    places = {id(operand): place for place, operand in enumerate(operands)}
    rest = [node for node in nodes if id(node) not in places]
    constants = tuple([node for node in rest if not isinstance(node, Apply)])
    applied = [node for node in rest if isinstance(node, Apply)]
    unused = len(nodes) < len(operands) + len(rest)
    if not rest or unused or any(node.interval is not None for node in applied):
        return None
    places |= {id(node): place for place, node in enumerate((*constants, *applied), len(operands))}
    return _Recipe(
        constants, tuple([(node.op, tuple([places[id(arg)] for arg in node.args])) for node in applied])
    )


def _of_interval(interval: Interval) -> Hashable:
    """Return the same for equal intervals; to hash and compare these takes five times as long."""
    begin, end = interval.begin, interval.end
    ends = begin.as_integer_ratio(), None if end is None else end.as_integer_ratio()
    if interval.share is None and not interval.is_open:
        return ends
    return ends, interval.begin_open, interval.end_open, interval.share


def _of_leaf(leaf: Formula) -> Hashable:
    """Return the same for leaves of the same meaning: zeros have signs, and parameters names."""
    kind = leaf.__class__
    if kind is Var:
        name, type_ = leaf.name, leaf.type  # type: ignore[attr-defined] # of a Var
        return name if type_ is None else (name, id(type_))
    if isinstance(leaf, Const):
        if kind is Const and leaf.value and leaf.name is None and leaf.type is None:
            return leaf.value
        return kind, leaf.value, copysign(1.0, leaf.value), leaf.name, id(leaf.type)
    return (id(leaf),)
