"""The nodes of a graph that are parts of the formula, for causation (``core/early/causation.hpp``).

The nodes of bounded until and since, which take several in the graph, are one part here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.compiler.graph import ITEMS, LATTICE, interval_in_steps
from rtamt.compiler.program import NO_OPERAND
from rtamt.language.formula import Apply, Formula, children
from rtamt.language.operators import Pointwise, Shift, Since, Tense, Until, Window
from rtamt.lazy.tuples import NamedTuple
from rtamt.rewrite.early import connects

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.compiler.graph import Graph

#: In the order of the core's enumeration.
KINDS = ("atom", "span", "both", "either", "least", "greatest", "until", "since")


class Cause(NamedTuple):
    """A part: its reference in the graph, its operands, of which references are twice the index as in the graph."""

    kind: int
    ref: int
    a: int = NO_OPERAND
    b: int = NO_OPERAND
    low: int = 0
    high: int = 0
    #: Of ``precedes``: by how much it is read from earlier.
    shift: int = 0
    #: Of until and since: the recursion in the graph.
    core: int = NO_OPERAND


class Start(NamedTuple):
    """The operands of an item at the start: of ``value``, ``all`` and ``some`` a part, of ``until`` both operands."""

    a: int = NO_OPERAND
    b: int = NO_OPERAND
    before: int = NO_OPERAND
    rest: int = NO_OPERAND


class Causes(NamedTuple):
    """The parts of formulas, the references of the formulas, and the nodes read at the start of the trace."""

    parts: list[Cause]
    outputs: list[int]
    starts: list[Start]


def compile_causes(graph: Graph, formulas: Sequence[Formula]) -> Causes:
    """Return the parts of core formulas that a graph was compiled from, and of its items."""
    parts: list[Cause] = []
    refs: dict[Formula, int] = {}

    def add(formula: Formula) -> int:
        above = [formula]
        while above:  # operands first, predicates as a whole
            node = above[-1]
            missing = [each for each in _operands(graph, node) if each not in refs]
            above.extend(missing)
            if not missing:
                above.pop()
                if node not in refs:
                    refs[node] = _part(graph, parts, refs, node)
        return refs[formula]

    outputs = [add(formula) for formula in formulas]
    starts: list[Start] = []
    for place, item in enumerate(graph.items):
        formula = graph.starts[place]
        pair = ITEMS[item.kind] in ("both", "either")
        if formula is None or (pair and not _recursive(formula)):
            starts.append(Start())
        elif ITEMS[item.kind] == "value":
            starts.append(Start(add(formula)))
        else:
            assert isinstance(formula, Apply)
            operands = [add(operand) for operand in formula.args]
            # Of a pair the items before are those of hold at first, and of the rest.
            starts.append(Start(*operands, *((place - 1, place - 2) if pair else ())))
    return Causes(parts, outputs, starts)


def _recursive(formula: Formula) -> bool:
    return isinstance(formula, Apply) and isinstance(formula.op.kernel, Since | Until)


def _operands(graph: Graph, formula: Formula) -> tuple[Formula, ...]:
    """Return the parts that a part is made of, none of a predicate."""
    return () if graph.is_atom(formula) or not connects(formula) else children(formula)


def _part(graph: Graph, parts: list[Cause], refs: dict[Formula, int], formula: Formula) -> int:
    """Add a part whose operands have been added; return its reference."""
    if not _operands(graph, formula):
        kind = "atom" if graph.is_atom(formula) else "span"
        return _add(parts, Cause(KINDS.index(kind), graph.ref(formula)))
    assert isinstance(formula, Apply)
    kernel = formula.op.kernel
    args = [refs[operand] for operand in formula.args]
    past = formula.op.tense is Tense.PAST
    if isinstance(kernel, Pointwise):
        if kernel.opcode == "neg":
            return args[0] ^ 1
        return _add(parts, Cause(KINDS.index(LATTICE[kernel.opcode]), graph.ref(formula), *args))
    if isinstance(kernel, Shift):
        step = -1 if past else 1
        kind = "least" if kernel.fill > 0 else "greatest"
        return _add(parts, Cause(KINDS.index(kind), graph.ref(formula), args[0], low=step, high=step))
    begin, end = interval_in_steps(graph, formula)
    if isinstance(kernel, Window):
        kind = "least" if kernel.reduce == "min" else "greatest"
        low, high = (-end, -begin) if past else (begin, end)
        return _add(parts, Cause(KINDS.index(kind), graph.ref(formula), args[0], low=low, high=high))
    kind = "since" if isinstance(kernel, Since) else "until"
    shift = end if past and kind == "until" else 0
    core = graph.recursion(formula)
    return _add(
        parts, Cause(KINDS.index(kind), graph.ref(formula), args[0], args[1], begin, end, shift, core)
    )


def _add(parts: list[Cause], part: Cause) -> int:
    parts.append(part)
    return 2 * (len(parts) - 1)
