"""The contents of formulas: operators, variables and constants, and the nodes with intervals."""

from __future__ import annotations

from collections import deque

from rtamt.language.formula import KEPT, Apply, Var, postorder, store_contents
from rtamt.language.value_types import Boolean, Enumeration
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from collections.abc import Sequence
    from weakref import ref

    from rtamt.language.formula import Formula
    from rtamt.language.operators import Operator
    from rtamt.language.value_types import ValueType


#: How many large formulas keep their contents: a monitor asks for those of one or two again and again.
_LARGE_KEPT = 4


class Contents(NamedTuple):
    """The contents of a formula in postorder: operators, variables and constants, nodes with intervals.

    ``timed_below``: the nodes with an interval but for the formula itself, which keeps its contents: with a cycle,
    every requirement would wait for the garbage collector. ``untimed``: the operators of nodes without an interval.
    ``names``: of the variables, each once, other than fields of members. ``typed``: the variables that are no plain
    numbers.
    """

    operators: frozenset[Operator]
    leaves: tuple[Formula, ...]
    timed_below: tuple[Apply, ...]
    untimed: frozenset[Operator]
    names: tuple[str, ...]
    typed: tuple[Var, ...]


def contents(formula: Formula) -> Contents:
    """Return the contents of a formula: most checks and analyses need only a part of its nodes.

    >>> from rtamt.language.operators import STL
    >>> x = Var("x")
    >>> contents(STL["not"](STL["and"](x, x))).leaves
    (<formula x>,)
    """
    if not isinstance(formula, Apply):
        return Contents(frozenset(), (formula,), (), frozenset(), *_variables_in((formula,)))
    try:
        kept = formula._contents
    except AttributeError:
        kept = None
    if isinstance(kept, LargeContents):
        kept = kept.found
    if kept is not None:
        return kept
    nodes = postorder(formula)
    leaves = [node for node in nodes if node.__class__ is not Apply]
    applied: list[Any] = [node for node in nodes if node.__class__ is Apply]
    timed = [node for node in applied if node.interval is not None]
    untimed = frozenset([node.op for node in applied if node.interval is None])
    operators = untimed.union([node.op for node in timed])
    if formula.interval is not None:
        timed.pop()
    found = Contents(operators, tuple(leaves), tuple(timed), untimed, *_variables_in(leaves))
    store_contents(formula, found if len(nodes) <= KEPT else LargeContents(found))
    return found


class LargeContents:
    """The contents of a large formula, until those of others have been found: one text may have many such formulas."""

    __slots__ = ("__weakref__", "found")

    #: The last ones; they end with their formulas.
    _last: ClassVar[deque[ref[LargeContents]]] = deque()

    def __init__(self, found: Contents) -> None:
        from weakref import ref  # most formulas are small

        self.found: Contents | None = found
        self._last.append(ref(self))
        if len(self._last) > _LARGE_KEPT:
            oldest = self._last.popleft()()
            if oldest is not None:
                oldest.found = None


def timed(formula: Formula) -> tuple[Apply, ...]:
    """Return the nodes of a formula that have an interval, in postorder.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> timed(parse_formula("always[0:1](once[0:2](x >= 3))"))
    (<formula once[0:2](x >= 3)>, <formula always[0:1](once[0:2](x >= 3))>)
    """
    below = contents(formula).timed_below
    return (*below, formula) if isinstance(formula, Apply) and formula.interval is not None else below


def _variables_in(leaves: Sequence[Formula]) -> tuple[tuple[str, ...], tuple[Var, ...]]:
    """Return the names of the variables, and those that are no plain numbers."""
    free: list[Any] = [node for node in leaves if node.__class__ is Var]  # no field of a member
    typed = [node for node in free if node.type is not None and isinstance(node.type, Boolean | Enumeration)]
    return tuple(dict.fromkeys([node.name for node in free])), tuple(typed)


def leaves_of(*formulas: Formula) -> tuple[Formula, ...]:
    """Return the variables and constants of formulas in order of appearance."""
    if len(formulas) == 1:
        return contents(formulas[0]).leaves
    return tuple([node for node in postorder(*formulas) if not isinstance(node, Apply)])


def operators_of(*formulas: Formula) -> frozenset[Operator]:
    """Return the operators of formulas: what depends on these alone is asked once for each."""
    if len(formulas) == 1:
        return contents(formulas[0]).operators
    return frozenset([node.op for node in postorder(*formulas) if isinstance(node, Apply)])


def types_of(*formulas: Formula) -> dict[str, ValueType]:
    """Return the types of the variables of formulas that are no plain numbers."""
    typed = contents(formulas[0]).typed if len(formulas) == 1 else _variables_in(leaves_of(*formulas))[1]
    found: dict[str, Any] = {node.name: node.type for node in typed}
    return found


def variables(*formulas: Formula) -> tuple[str, ...]:
    """Return the names of the variables of formulas, each once, in order of first appearance; no fields of members."""
    return contents(formulas[0]).names if len(formulas) == 1 else _variables_in(leaves_of(*formulas))[0]


def own_variables(formula: Formula, every: Sequence[str]) -> tuple[str, ...]:
    """Return the variables that form the trace of a formula; for a constant ``every`` variable."""
    return variables(formula) or tuple(every)
