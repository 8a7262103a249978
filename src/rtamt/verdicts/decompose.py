"""What a formula's value at the first instant is made of: windows that begin there, joined pointwise.

``always φ`` at the first instant is the smallest value of φ from there on: a running minimum, whatever
the length of the trace. So a formula whose only unbounded windows are at its top can be checked in
constant memory, and the instant at which φ fails is where the requirement is first violated.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from rtamt.errors import BoundError
from rtamt.language.formula import Apply, Formula, Var, variables
from rtamt.language.operators import Pointwise, Sort, Tense, Window
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
        stack = [self.skeleton]
        while stack:
            node = stack.pop()
            if isinstance(node, Apply) and node.op.kernel == Pointwise("min"):
                stack.extend(reversed(node.args))
            else:
                yield node

    def leaf(self, part: Formula) -> Leaf | None:
        """Return the leaf that a part of the skeleton is, if it is one."""
        return self.leaves[int(part.name[1:])] if isinstance(part, Var) else None


def anchor(formula: Formula) -> Anchored:
    """Take a formula apart at the first instant.

    >>> from rtamt.language.parser import parse_formula
    >>> anchored = anchor(parse_formula("always(x >= 3) and (y >= 1 -> eventually[2:5] z)"))
    >>> print(anchored.skeleton)
    "#0" and ("#1" -> "#2")
    >>> [(str(leaf.formula), leaf.reduce) for leaf in anchored.leaves]
    [('x >= 3', 'min'), ('y >= 1', None), ('z', 'max')]
    """
    leaves: dict[Leaf, int] = {}

    def leaf(found: Leaf) -> Formula:
        return Var(f"#{leaves.setdefault(found, len(leaves))}")

    def visit(node: Formula) -> Formula:
        if not isinstance(node, Apply) or not has_future(node):
            return leaf(Leaf(node)) if variables(node) else node
        kernel = node.op.kernel
        if isinstance(kernel, Window) and node.op.tense is Tense.FUTURE:
            begin = node.interval.begin if node.interval is not None else Fraction(0)
            end = node.interval.end if node.interval is not None else None
            return leaf(Leaf(node.args[0], kernel.reduce, begin, end))
        if node.op.tense is not Tense.NONE or set(node.op.operands) != {Sort.FORMULA}:
            return leaf(Leaf(node))
        # Only connectives are above a window that is reached here: no deeper than they are nested.
        return replace(node, args=tuple(visit(arg) for arg in node.args))

    skeleton = visit(formula)
    return Anchored(skeleton, tuple(leaves))


def check_in_chunks(anchored: Anchored, text: str | None = None) -> None:
    """Raise :class:`BoundError` where a formula cannot be checked in chunks: below the top, future must be bounded."""
    for leaf in anchored.leaves:
        node = unbounded_future(leaf.formula)
        if node is not None:
            raise BoundError(
                f"'{node.op.name}' without an upper bound stands below another operator here, so that the "
                f"recording cannot be checked in chunks; give it a bound, such as {node.op.name}[0:10], "
                f"or read the recording whole",
                text,
                node.span,
            )
