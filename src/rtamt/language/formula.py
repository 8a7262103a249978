"""Formulas: three immutable nodes, compared by what they mean and not by where they stood.

::

    Formula = Const(value) | Var(name) | Apply(op, args, interval)

A node's ``span`` says where in the text it stood, so that every later error can point there; it
takes no part in equality. Walk a formula with :func:`fold`, which uses no recursion: a conjunction
of ten thousand terms is a formula like any other.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import copysign
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from fractions import Fraction

    from rtamt.language.operators import Operator

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Span:
    """A half-open range of characters of the source text."""

    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Interval:
    """A closed interval ``[begin, end]`` of seconds, exact; ``end=None`` means unbounded.

    ``begin_unit``, ``end_unit`` and ``constants`` (the named ones) only remember how the bounds were
    written.
    """

    begin: Fraction
    end: Fraction | None
    begin_unit: str = field(default="", compare=False)
    end_unit: str = field(default="", compare=False)
    span: Span | None = field(default=None, compare=False, repr=False)
    constants: tuple[str, ...] = field(default=(), compare=False, repr=False)


class Formula:
    """Base of the three nodes; ``str(formula)`` is text that parses back to an equal formula."""

    __slots__ = ()

    span: Span | None

    def __repr__(self) -> str:
        return f"<formula {self}>"

    def __str__(self) -> str:
        from rtamt.language.printer import to_text

        return to_text(self)

    def latex(self) -> str:
        """Return the formula as LaTeX mathematics, without dollar signs."""
        from rtamt.language.printer import to_latex

        return to_latex(self)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Const(Formula):
    """A number (IEEE double; never NaN). 0.0 and -0.0 are different numbers: 1/x tells them apart.

    ``name`` only remembers that a named constant was written.
    """

    value: float
    span: Span | None = field(default=None, compare=False, repr=False)
    name: str | None = field(default=None, compare=False, repr=False)

    def __hash__(self) -> int:
        return hash((self.value, copysign(1.0, self.value)))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Const):
            return NotImplemented
        return self.value == other.value and copysign(1.0, self.value) == copysign(1.0, other.value)


@dataclass(frozen=True, slots=True, repr=False)
class Var(Formula):
    """A signal, by name; a field of a structured signal is part of the name (``req.value``)."""

    name: str
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Apply(Formula):
    """An operator applied to formulas, with an interval where the operator takes one."""

    op: Operator
    args: tuple[Formula, ...]
    interval: Interval | None = None
    span: Span | None = field(default=None, repr=False)
    _hash: int = field(init=False, repr=False, default=0)
    #: The nodes below, in postorder, once they were asked for: a formula is walked many times.
    _below: tuple[Formula, ...] | None = field(init=False, repr=False, default=None)

    def __post_init__(self) -> None:
        # Children carry their own hash, so that this is O(1) a node and needs no recursion.
        object.__setattr__(self, "_hash", hash((self.op, self.args, self.interval)))

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Apply):
            return NotImplemented
        pairs: list[tuple[Formula, Formula]] = [(self, other)]
        while pairs:
            a, b = pairs.pop()
            if a is b:
                continue
            if isinstance(a, Apply) and isinstance(b, Apply):
                if (
                    a._hash != b._hash
                    or a.op is not b.op
                    or a.interval != b.interval
                    or len(a.args) != len(b.args)
                ):
                    return False
                pairs.extend(zip(a.args, b.args, strict=True))
            elif a != b:
                return False
        return True


def children(formula: Formula) -> tuple[Formula, ...]:
    """Return the operands of a formula; numbers and variables have none."""
    return formula.args if isinstance(formula, Apply) else ()


def postorder(formula: Formula) -> Iterator[Formula]:
    """Yield every distinct node object below and including ``formula``, operands first."""
    if isinstance(formula, Apply):
        if formula._below is None:
            object.__setattr__(formula, "_below", _below(formula))
        yield from formula._below or ()
    yield formula


def _below(formula: Apply) -> tuple[Formula, ...]:
    """Return every distinct node object below a formula, operands first."""
    seen: set[int] = set()
    found: list[Formula] = []
    stack: list[tuple[Formula, bool]] = [(operand, False) for operand in reversed(formula.args)]
    while stack:
        node, ready = stack.pop()
        if ready:
            found.append(node)
        elif id(node) not in seen:
            seen.add(id(node))
            if isinstance(node, Apply):
                stack.append((node, True))
                stack.extend([(operand, False) for operand in reversed(node.args)])
            else:
                found.append(node)
    return tuple(found)


def fold(formula: Formula, step: Callable[[Formula, tuple[T, ...]], T]) -> T:
    """Compute a value bottom-up: ``step(node, values of its operands)``, once per node object.

    >>> from rtamt.language.formula import Var, fold
    >>> fold(Var("x"), lambda node, below: 1 + sum(below))
    1
    """
    values: dict[int, T] = {}
    for node in postorder(formula):
        below = tuple([values[id(operand)] for operand in node.args]) if isinstance(node, Apply) else ()
        values[id(node)] = step(node, below)
    return values[id(formula)]


def size(formula: Formula) -> int:
    """Return how many nodes the printed formula has: a shared sub-formula counts wherever it stands.

    >>> x = Var("x")
    >>> from rtamt.language.operators import STL
    >>> size(STL["and"](x, x))
    3
    """
    return fold(formula, lambda _node, below: 1 + sum(below))


def variables(formula: Formula) -> tuple[str, ...]:
    """Return the names of the variables, each once, in order of first appearance."""
    return tuple(dict.fromkeys(n.name for n in postorder(formula) if isinstance(n, Var)))
