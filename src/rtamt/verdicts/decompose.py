"""Split the value of a formula at the first instant into windows that begin there, joined pointwise.

``always φ`` at the first instant is the smallest value of φ from there on: a running minimum, whatever
the length of the trace. So a formula whose only unbounded windows are at its top can be checked in
constant memory, and the instant at which φ fails is where the requirement is first violated.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from rtamt.errors import BoundError
from rtamt.language.formula import Apply, Formula, Var, children, fold, postorder
from rtamt.language.operators import Pointwise, Sort, Tense, Window
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.lazy.tuples import NamedTuple
from rtamt.rewrite.check import has_future, unbounded_future

if TYPE_CHECKING:
    from collections.abc import Iterator


@dataclass(frozen=True, slots=True)
class Leaf:
    """The ``reduce`` (min or max) of a formula over [begin, end] seconds from the first instant; end None: for ever.

    Without ``reduce``, its value at the first instant.
    """

    formula: Formula
    reduce: str | None = None
    begin: Fraction = Fraction(0)
    end: Fraction | None = Fraction(0)


@dataclass(frozen=True, slots=True)
class Anchored:
    """A formula at the first instant: ``skeleton`` is pointwise over the variables #0, #1, … for its leaves."""

    skeleton: Formula
    leaves: tuple[Leaf, ...]

    def conjuncts(self) -> Iterator[Formula]:
        """Yield the parts of the skeleton that must all hold."""
        return conjuncts(self.skeleton)

    def leaf(self, part: Formula) -> Leaf | None:
        """Return the leaf that a part of the skeleton is, if it is one."""
        return self.leaves[int(part.name[1:])] if isinstance(part, Var) else None


def conjuncts(formula: Formula) -> Iterator[Formula]:
    """Yield the parts of a formula that must all hold, each once.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> list(conjuncts(parse_formula("x and (y or z)")))
    [<formula x>, <formula y or z>]
    """
    stack, seen = [formula], set[int]()
    while stack:
        node = stack.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        if isinstance(node, Apply) and node.op.kernel == Pointwise("min"):
            stack.extend(reversed(node.args))
        else:
            yield node


def anchor(formula: Formula) -> Anchored:
    """Take a formula apart at the first instant.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> anchored = anchor(parse_formula("always(x >= 3) and (y >= 1 -> eventually[2:5] z)"))
    >>> print(anchored.skeleton)
    "#0" and ("#1" -> "#2")
    >>> [(str(leaf.formula), leaf.reduce) for leaf in anchored.leaves]
    [('x >= 3', 'min'), ('y >= 1', None), ('z', 'max')]
    """
    leaves: dict[Leaf, int] = {}

    def leaf(found: Leaf) -> Formula:
        return Var(f"#{leaves.setdefault(found, len(leaves))}")

    facts: dict[int, _Facts] = {}
    fold(formula, lambda node, below: facts.setdefault(id(node), _facts(node, below)))
    # From the top down, as far as there are connectives; whatever else is reached is a leaf.
    reached: set[int] = set()
    stack = [formula]
    while stack:
        node = stack.pop()
        if id(node) not in reached:
            reached.add(id(node))
            if facts[id(node)].joins:
                stack.extend(children(node))
    parts: dict[int, Formula] = {}
    for node in postorder(formula):
        if id(node) not in reached:
            continue
        if facts[id(node)].joins:
            parts[id(node)] = replace(node, args=tuple([parts[id(arg)] for arg in children(node)]))  # type: ignore[type-var] # an Apply
        elif facts[id(node)].looks_ahead:
            parts[id(node)] = leaf(_ahead(node))
        else:
            parts[id(node)] = leaf(Leaf(node)) if facts[id(node)].reads else node
    return Anchored(parts[id(formula)], tuple(leaves))


class _Facts(NamedTuple):
    """Properties of a sub-formula: it reads a variable or other instants, looks ahead, and that through a connective.

    What reads neither is a constant, which needs no recording.
    """

    reads: bool
    looks_ahead: bool
    joins: bool


def _facts(node: Formula, below: tuple[_Facts, ...]) -> _Facts:
    if not isinstance(node, Apply):
        return _Facts(isinstance(node, Var), False, False)
    below_ahead = any(each.looks_ahead for each in below)
    looks_ahead = (
        below_ahead or node.op.tense is Tense.FUTURE or (node.op.definition is None and has_future(node))
    )
    joins = looks_ahead and node.op.tense is Tense.NONE and set(node.op.operands) == {Sort.FORMULA}
    reads = node.op.tense is not Tense.NONE or any(each.reads for each in below)
    return _Facts(reads, looks_ahead, joins)


def _ahead(node: Formula) -> Leaf:
    """Return the leaf that a formula is which looks ahead: a window of the future is its running extremum."""
    assert isinstance(node, Apply)
    kernel = node.op.kernel
    if not isinstance(kernel, Window) or node.op.tense is not Tense.FUTURE:
        return Leaf(node)
    if node.interval is None:
        return Leaf(node.args[0], kernel.reduce, end=None)
    return Leaf(node.args[0], kernel.reduce, node.interval.begin, node.interval.end)


def check_in_chunks(anchored: Anchored, text: str | None = None) -> None:
    """Raise :class:`BoundError` where a formula cannot be checked in chunks: below the top, future must be bounded."""
    for leaf in anchored.leaves:
        node = unbounded_future(leaf.formula)
        if node is not None:
            at_top = leaf.reduce is None and node is leaf.formula
            where = "needs the whole future" if at_top else "stands below another operator"
            raise BoundError(
                f"'{node.op.name}' without an upper bound {where} here, so that the recording cannot be "
                f"checked in chunks; give it a bound, such as {node.op.name}[0:10], or read the recording whole",
                text,
                node.span,
            )
