"""Core formulas in which equal parts are one node, so that what walks them node by node visits each part once."""

from __future__ import annotations

from math import copysign

from rtamt.language.formula import Apply, Const, Formula, Var, postorder
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.rewrite.desugar import expand, spelled_out_each
from rtamt.rewrite.recipes import recipe_of
from rtamt.rewrite.truth import rebuilt

if TYPE_CHECKING:
    from collections.abc import Hashable, Sequence

    from rtamt.language.formula import Interval
    from rtamt.language.records import Operator
    from rtamt.rewrite.recipes import Step


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
        self._recipes: dict[Operator, tuple[Step, ...] | None] = {}

    def leaf(self, node: Formula) -> Formula:
        """Return the node for a variable or a constant."""
        return self.known.setdefault(_of_leaf(node), node)

    def expanded(self, node: Apply, args: tuple[Formula, ...]) -> Formula:
        """Return the node for the expansion of an operator whose operands are ``args``."""
        op = node.op
        try:
            recipe = self._recipes[op]
        except KeyError:
            recipe = self._recipes[op] = recipe_of(op)
        if recipe is None or node.interval is not None:
            return self._merged(expand(node, args), {id(arg): arg for arg in args})
        known, span = self.known, node.span
        parts = [*args]
        for core, places, _ in recipe:
            if not isinstance(core, Apply):
                parts.append(self.leaf(core))
                continue
            operands = tuple([parts[place] for place in places])
            key = (core.op, None, *map(id, operands))
            same = known.get(key)
            if same is None:
                same = known[key] = Apply(core.op, operands, None, span)
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
