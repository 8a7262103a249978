"""Equal parts of formulas become one node, so that what walks formulas node by node visits them once."""

from __future__ import annotations

from math import copysign
from typing import TYPE_CHECKING, Any

from rtamt.language.formula import Apply, Const, Formula, Var, postorder
from rtamt.rewrite.truth import rebuilt

if TYPE_CHECKING:
    from collections.abc import Hashable, Sequence

    from rtamt.language.formula import Interval


def merged(formulas: Sequence[Formula]) -> tuple[Formula, ...]:
    """Return equal formulas, in which equal parts are one node: the first of them, with its position in the text.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> formula = parse_formula("always(x > 3) and eventually(x > 3)")
    >>> (one,) = merged([formula])
    >>> one == formula, one.args[0].args[0] is one.args[1].args[0]
    (True, True)
    """
    known: dict[Any, Formula] = {}
    found: dict[int, Formula] = {}
    for node in postorder(*formulas):
        if isinstance(node, Apply):
            args = tuple([found[id(arg)] for arg in node.args])
            interval = node.interval
            key = (node.op, None if interval is None else _of_interval(interval), *map(id, args))
            same = known.get(key)
            if same is None:
                same = known[key] = rebuilt(node, args)
        else:
            same = known.setdefault(_of_leaf(node), node)
        found[id(node)] = same
    return tuple([found[id(formula)] for formula in formulas])


def _of_interval(interval: Interval) -> Hashable:
    """Return the same for equal intervals; to hash and compare these takes five times as long."""
    end = interval.end
    return (
        interval.begin.as_integer_ratio(),
        None if end is None else end.as_integer_ratio(),
        interval.begin_open,
        interval.end_open,
        interval.share,
    )


def _of_leaf(leaf: Formula) -> Hashable:
    """Return the same for leaves of the same meaning: zeros have signs, and parameters names."""
    kind = leaf.__class__
    if kind is Var:
        return leaf.name, id(leaf.type)  # type: ignore[attr-defined] # a Var
    if isinstance(leaf, Const):
        return kind, leaf.value, copysign(1.0, leaf.value), leaf.name, id(leaf.type)
    return id(leaf)
