"""Core formulas to the graph that gives verdicts and bounds before the horizon (``graph.py``).

A formula of unbounded future has no node where its value is requested at the start of the trace alone: there it
is put together from items (``core/early/bounds_at_start.hpp``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.compiler.graph import ITEMS, LATTICE, Graph, Item, interval_in_steps, over
from rtamt.compiler.program import NO_OPERAND
from rtamt.language.formula import Apply, Const, Formula, Var, children, postorder
from rtamt.language.operators import Pointwise, Until, Window
from rtamt.rewrite.check import reads_unbounded_future
from rtamt.rewrite.early import connects
from rtamt.rewrite.horizon import horizons
from rtamt.signals.discrete import Discrete

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from rtamt.signals.time_domain_interface import TimeDomain


def compile_graph(
    formulas: Sequence[Formula],
    period: Fraction,
    inputs: tuple[str, ...],
    domain: type[TimeDomain] = Discrete,
    *,
    start: bool = False,
    apart: bool = False,
) -> Graph:
    """Compile core formulas (see ``desugar``); bounds are whole numbers of periods.

    ``start``: also what the first formula needs for its value at the start of the trace alone; it is then no
    output if its future is unbounded. ``apart``: each predicate is a node of its own. Raises :class:`UsageError` for
    custom operators.
    """
    graph = Graph(period, inputs, domain)
    for position, formula in enumerate(formulas):
        graph.depths.update(horizons(formula, period))
        if apart:
            graph.apart |= _above_predicates(formula)
        _lower(graph, formula, only_start=start and position == 0)
        if start and position == 0:
            _at_start(graph, formula, {}, negated=False)
            if graph.depths[id(formula)] is None:
                graph.outputs.append(NO_OPERAND)
                continue
        graph.outputs.append(graph.ref(formula))
    return graph


def compile_starts(
    formulas: Sequence[Formula], period: Fraction, inputs: tuple[str, ...]
) -> tuple[Graph, tuple[int, ...]]:
    """Compile core formulas whose values are requested only at the start of the trace.

    Returns the graph, and of each formula how many items there are up to its own, which is the last of these.
    """
    graph = Graph(period, inputs)
    ends = []
    for formula in formulas:
        graph.depths.update(horizons(formula, period))
        _lower(graph, formula, only_start=True)
        _at_start(graph, formula, {}, negated=False)
        ends.append(len(graph.items))
    return graph, tuple(ends)


def _lower(graph: Graph, formula: Formula, *, only_start: bool) -> None:
    """Add the nodes of a formula, operands first; without those that its value at the start does not need."""
    for node in postorder(formula):
        if node not in graph.local:
            graph.local[node] = isinstance(node, Const | Var) or (
                isinstance(node, Apply)
                and isinstance(node.op.kernel, Pointwise)
                and all(graph.local[arg] for arg in node.args)
            )
    above = _above(graph, formula) if only_start else set()
    for node in postorder(formula):
        if isinstance(node, Apply) and not graph.is_atom(node) and id(node) not in above:
            graph.ref(node)


def _above_predicates(formula: Formula) -> set[Formula]:
    """Return the parts of a formula that only take minima, maxima and negations of predicates, or of such parts."""
    parts, found = {formula}, set()
    for node in reversed(postorder(formula)):
        if node in parts and connects(node):
            found.add(node)
            parts.update(children(node))
    return found


# ---- the start of the trace ------------------------------------------------------------------------------


def _splits(graph: Graph, formula: Formula) -> bool:
    """Return whether a part of unbounded future is put together from its value at the start and nothing else."""
    return (
        isinstance(formula, Apply)
        and graph.depths[id(formula)] is None
        and (
            (isinstance(formula.op.kernel, Pointwise) and formula.op.kernel.opcode in ("neg", *LATTICE))
            or (isinstance(formula.op.kernel, Window | Until) and reads_unbounded_future(formula))
        )
    )


def _above(graph: Graph, formula: Formula) -> set[int]:
    """Return the identities of the parts whose value is requested only at the start."""
    found: set[int] = set()
    stack = [formula]
    while stack:
        node = stack.pop()
        if id(node) in found or not _splits(graph, node):
            continue
        found.add(id(node))
        assert isinstance(node, Apply)
        if isinstance(node.op.kernel, Pointwise):
            stack.extend(node.args)
    return found


def _at_start(graph: Graph, formula: Formula, placed: dict[tuple[int, bool], int], *, negated: bool) -> int:
    """Add the items of a formula's value at the start once, and return the place of the last one."""
    key = id(formula), negated
    if key not in placed:
        placed[key] = _placed_at_start(graph, formula, placed, negated=negated)
    return placed[key]


def _placed_at_start(
    graph: Graph, formula: Formula, placed: dict[tuple[int, bool], int], *, negated: bool
) -> int:

    def add(kind: str, a: int, b: int = NO_OPERAND, c: int = NO_OPERAND, tick: int = 0) -> int:
        graph.items.append(Item(ITEMS.index(kind), negated, a, b, c, tick))
        graph.starts.append(formula)
        return len(graph.items) - 1

    if not _splits(graph, formula):
        return add("value", graph.ref(formula))
    assert isinstance(formula, Apply)
    kernel = formula.op.kernel
    if isinstance(kernel, Pointwise):
        if kernel.opcode == "neg":
            return _at_start(graph, formula.args[0], placed, negated=not negated)
        operands = [_at_start(graph, arg, placed, negated=False) for arg in formula.args]
        return add(LATTICE[kernel.opcode], *operands)
    args = [graph.ref(arg) for arg in formula.args]
    begin, _ = interval_in_steps(graph, formula)
    if isinstance(kernel, Window):
        return add("all" if kernel.reduce == "min" else "some", args[0], tick=begin)
    hold, goal = args
    reached = ITEMS.index("until"), False, graph.recursion(formula), hold, goal, begin
    if begin == 0:
        return add("until", *reached[2:5])
    graph.items.append(Item(*reached))
    before = over(graph, "least", hold, 0, graph.time.last_before(begin))
    graph.items.append(Item(ITEMS.index("value"), False, before))
    graph.starts += [None, None]
    return add("both", len(graph.items) - 2, len(graph.items) - 1)
