"""The graph that gives verdicts and bounds before the horizon (``core/early/graph.hpp``), and its nodes.

Nodes compute in absolute time and no operand is delayed. Parts that read inputs at one instant alone become
one node, an atom. Bounded until is a window over ψ, a window over φ and the recursion of untimed until; since
likewise. Negation is no node: a reference to a node is twice its index, plus one where it is negated.
"""

from __future__ import annotations

import zlib
from copy import copy
from typing import TYPE_CHECKING

from rtamt.compiler.lower import seconds_per_step
from rtamt.compiler.program import NO_OPERAND, OPCODES
from rtamt.compiler.time_graph import SampledGraphs, graphs_of
from rtamt.errors import UsageError
from rtamt.language.formula import Apply, Const, Formula, Parameter, Var, postorder
from rtamt.language.operators import Ahead, Pointwise, Rank, Shift, Since, Sum, Tense, Until, Window
from rtamt.lazy.dataclasses import dataclass, field, fields, replace
from rtamt.lazy.tuples import NamedTuple
from rtamt.signals.discrete import Discrete

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from rtamt.signals.time_domain_interface import TimeDomain

#: In the order of the core's enumerations.
KINDS = (
    "atom", "map", "both", "either", "least", "greatest", "until", "since", "since_dense", "held",
    "sum",
    "rank_least", "rank_greatest",
    "pulses",
)  # fmt: skip
ITEMS = ("value", "all", "some", "until", "both", "either")

#: Beyond every step, as the core has it.
FOREVER = (2**63 - 1) // 4
#: Before every step.
NEVER = -FOREVER

LATTICE = {"min": "both", "max": "either"}


class Step(NamedTuple):
    """One operation of an atom: the place of an opcode, operands (earlier steps, or an input), a constant."""

    opcode: int
    a: int = NO_OPERAND
    b: int = NO_OPERAND
    x: float = 0.0


class Node(NamedTuple):
    """A node: operands are references, ``low`` and ``high`` a window around the instant, in steps."""

    kind: int
    a: int = NO_OPERAND
    b: int = NO_OPERAND
    low: int = 0
    high: int = 0
    horizon: int = 0
    steps: tuple[Step, ...] = ()


class Item(NamedTuple):
    """A part of a formula's value at the start of the trace (``core/early/bounds_at_start.hpp``)."""

    kind: int
    negated: bool
    a: int
    b: int = NO_OPERAND
    c: int = NO_OPERAND
    tick: int = 0


#: The longest window of a sum in samples: its bounds in the future may be a different number at each of them.
LONGEST_SUM = 10**7

#: What a graph is for; the rest is what it contains.
_FIXED = ("period", "inputs", "domain")


@dataclass
class Graph:
    """The graph of several formulas, ``outputs`` being references; ``origins`` names the formula of each step."""

    period: Fraction
    inputs: tuple[str, ...]
    domain: type[TimeDomain] = Discrete
    nodes: list[Node] = field(default_factory=list)
    outputs: list[int] = field(default_factory=list)
    items: list[Item] = field(default_factory=list)
    #: What each item is the value of; None for a part that is no formula.
    starts: list[Formula | None] = field(default_factory=list)
    origins: list[Formula] = field(default_factory=list)
    #: By node, and by its parameters, which differ even if their values are equal.
    _index: dict[tuple[Node, tuple[tuple[int, str], ...]], int] = field(default_factory=dict)
    _refs: dict[Formula, int] = field(default_factory=dict)
    local: dict[Formula, bool] = field(default_factory=dict)
    #: Local parts that are nodes above others nevertheless.
    apart: set[Formula] = field(default_factory=set)
    depths: dict[int, Fraction | None] = field(default_factory=dict)

    @property
    def time(self) -> type[SampledGraphs]:
        """The decisions of the graph that depend on its time domain."""
        return graphs_of(self.domain)

    def ref(self, formula: Formula) -> int:
        """Return the reference of a part of a compiled formula, other than one that has items instead."""
        return _ref(self, formula)

    def is_atom(self, formula: Formula) -> bool:
        """Return whether a part is one node that reads inputs at one instant alone."""
        return self.local[formula] and formula not in self.apart

    def recursion(self, formula: Apply) -> int:
        """Return the reference of an until or since without its bounds."""
        hold, goal = (_ref(self, arg) for arg in formula.args)
        return (
            _since_core(self, hold, goal)
            if isinstance(formula.op.kernel, Since)
            else _recursion(self, hold, goal)
        )

    def horizon(self, ref: int) -> int:
        """Return the number of steps after an instant until the value of a reference is final."""
        return self.nodes[ref // 2].horizon

    def copied(self) -> Graph:
        """Return the same graph, to which more can be added."""
        own = {each.name: copy(getattr(self, each.name)) for each in fields(self) if each.name not in _FIXED}
        return replace(self, **own)

    def with_parameters(self, values: Mapping[str, float]) -> Graph:
        """Return the graph with values of parameters; ``ref`` and ``origins`` have others."""
        if not values:
            return self
        origins, nodes = iter(self.origins), []
        for node in self.nodes:
            steps = [
                step._replace(x=values[origin.name]) if isinstance(origin, Parameter) else step
                for step, origin in zip(node.steps, origins, strict=False)
            ]
            nodes.append(node._replace(steps=tuple(steps)))
        return replace(self, nodes=nodes)

    def fingerprint(self) -> bytes:
        """Return the identity of this graph, which differs from those of others."""
        return zlib.crc32(repr((self.nodes, self.outputs, self.items)).encode()).to_bytes(4, "little")


def _ref(graph: Graph, formula: Formula) -> int:
    """Return the reference of a formula whose operands have one, or need none."""
    found = graph._refs.get(formula)
    if found is None:
        found = graph._refs[formula] = _node(graph, formula)
    return found


def _node(graph: Graph, formula: Formula) -> int:
    if graph.is_atom(formula):
        return _atom(graph, formula)
    assert isinstance(formula, Apply)
    kernel = formula.op.kernel
    args = [_ref(graph, arg) for arg in formula.args]
    if isinstance(kernel, Pointwise):
        return _pointwise(graph, formula, kernel, args)
    if isinstance(kernel, Window):
        return _window(graph, formula, kernel, args[0])
    if isinstance(kernel, Sum):
        return _sum(graph, formula, args[0])
    if isinstance(kernel, Rank):
        return _rank(graph, formula, args[0])
    if isinstance(kernel, Shift):
        step = -1 if formula.op.tense is Tense.PAST else 1
        return over(graph, "least" if kernel.fill > 0 else "greatest", args[0], step, step)
    if isinstance(kernel, Ahead):
        distance, _ = interval_in_steps(graph, formula)
        return over(graph, graph.time.ahead, args[0], distance, distance)
    if isinstance(kernel, Since):
        return _since(graph, formula, *args)
    if isinstance(kernel, Until):
        return _until(graph, formula, *args)
    raise UsageError(
        f"the operator '{formula.op.name}' has no bounds before its value is known; "
        f"give it an expansion into other operators, or monitor it with verdict='delayed'"
    )


def _add(graph: Graph, node: Node, origins: Sequence[Formula] = ()) -> int:
    """Return the reference of a node, which is added unless there is an equal one."""
    key = node, tuple((i, each.name) for i, each in enumerate(origins) if isinstance(each, Parameter))
    found = graph._index.get(key)
    if found is None:
        found = graph._index[key] = len(graph.nodes)
        graph.nodes.append(node)
        graph.origins.extend(origins)
    return 2 * found


def _atom(graph: Graph, formula: Formula) -> int:
    places: dict[Formula, int] = {}
    steps: list[Step] = []
    origins: list[Formula] = []
    for node in postorder(formula):
        if node in places:
            continue
        if isinstance(node, Const):
            step = Step(OPCODES.index("const"), x=node.value)
        elif isinstance(node, Var):
            step = Step(OPCODES.index("input"), graph.inputs.index(node.name))
        else:
            assert isinstance(node, Apply)
            assert isinstance(node.op.kernel, Pointwise)
            step = Step(OPCODES.index(node.op.kernel.opcode), *(places[arg] for arg in node.args))
        places[node] = len(steps)
        steps.append(step)
        origins.append(node)
    return _add(graph, Node(KINDS.index("atom"), steps=tuple(steps)), origins)


def _pointwise(graph: Graph, formula: Apply, kernel: Pointwise, args: list[int]) -> int:
    if kernel.opcode == "neg":
        return args[0] ^ 1
    a, b = (*args, NO_OPERAND)[:2]
    if kernel.opcode in LATTICE:
        return _pair(graph, LATTICE[kernel.opcode], a, b)
    depth = max(graph.horizon(ref) for ref in args)
    steps = (Step(OPCODES.index(kernel.opcode)),)
    return _add(graph, Node(KINDS.index("map"), a, b, horizon=depth, steps=steps), (formula,))


def _pair(graph: Graph, kind: str, a: int, b: int, horizon: int | None = None) -> int:
    if horizon is None:
        horizon = max(graph.horizon(a), graph.horizon(b))
    return _add(graph, Node(KINDS.index(kind), a, b, horizon=horizon))


def over(graph: Graph, kind: str, operand: int, low: int, high: int) -> int:
    """Return a window [t + low, t + high] over an operand."""
    if low == high == 0:
        return operand
    depth = graph.horizon(operand)
    # Of the past too not less than its operand's: a trace that ends cuts windows as far as that.
    horizon = FOREVER if FOREVER in (depth, high) else depth + max(0, high)
    return _add(graph, Node(KINDS.index(kind), operand, low=low, high=high, horizon=horizon))


def interval_in_steps(graph: Graph, formula: Apply) -> tuple[int, int]:
    """Return the interval of an operator in steps; no interval is [0, inf)."""
    if formula.interval is None:
        return 0, FOREVER
    begin, end = formula.interval.begin, formula.interval.end
    return int(begin / graph.period), FOREVER if end is None else int(end / graph.period)


def _window(graph: Graph, formula: Apply, kernel: Window, operand: int) -> int:
    begin, end = interval_in_steps(graph, formula)
    kind = "least" if kernel.reduce == "min" else "greatest"
    if formula.op.tense is Tense.PAST:
        return over(graph, kind, operand, -end, -begin)
    return over(graph, kind, operand, begin, end)


def _sum(graph: Graph, formula: Apply, operand: int) -> int:
    begin, end = interval_in_steps(graph, formula)
    depth = graph.horizon(operand)
    value = operand
    if (begin or end) and graph.time.pulses:
        value = over(graph, "pulses", operand, -end, -begin)
    elif begin or end:
        if end < FOREVER and end - begin >= LONGEST_SUM:
            raise UsageError(
                f"a window has {end - begin + 1:,} samples; before its value is known, a sum, count, mean, integral or "
                f"duration reads at most {LONGEST_SUM:,}: shorten the window, lengthen the period or "
                f"monitor with verdict='delayed'"
            )
        steps = (Step(OPCODES.index("slide_sum" if end < FOREVER else "run_sum")),)
        value = _add(
            graph,
            Node(KINDS.index("sum"), operand, low=-end, high=-begin, horizon=depth, steps=steps),
            (formula,),
        )
    for opcode, factor in seconds_per_step(graph.period) if formula.op.timed else ():
        factors = (Step(OPCODES.index("const"), x=factor),)
        number = _add(graph, Node(KINDS.index("atom"), steps=factors), (formula,))
        steps = (Step(OPCODES.index(opcode)),)
        value = _add(graph, Node(KINDS.index("map"), value, number, horizon=depth, steps=steps), (formula,))
    return value


def _rank(graph: Graph, formula: Apply, operand: int) -> int:
    """Return the k-th largest value of a window; the least of those of its partial windows."""
    begin, end = interval_in_steps(graph, formula)
    k, outside = graph.time.rank(formula.interval, graph.period)
    order = end - begin + graph.time.point - k + 1 if outside > 0 else k
    kind = KINDS.index("rank_least" if outside > 0 else "rank_greatest")
    steps = (Step(OPCODES.index("const"), x=float(order)),)
    low, high = (-end, -begin) if formula.op.tense is Tense.PAST else (begin, end)

    def window(first: int, last: int) -> int:
        depth = graph.horizon(operand)
        horizon = FOREVER if depth == FOREVER else depth + max(0, high)
        node = Node(kind, operand, low=first, high=last, horizon=horizon, steps=steps)
        return _add(graph, node, (formula,))

    first, *others = (window(*each) for each in graph.time.rank_windows(low, high))
    for other in others:
        first = _pair(graph, "both", first, other)
    return first


def _since(graph: Graph, formula: Apply, hold: int, goal: int) -> int:
    """φ since[a, b] ψ is once[a, b] ψ, φ on (t - a, t], and (φ since ψ) a ago."""
    begin, end = interval_in_steps(graph, formula)
    core = _since_core(graph, hold, goal)
    if graph.time.goal_apart and begin == 0:
        core = _pair(graph, "either", core, goal)
    value = over(graph, "greatest", core, -begin, -begin)
    if end < FOREVER:
        value = _pair(graph, "both", value, over(graph, "greatest", goal, -end, -begin))
    if begin:
        value = _pair(graph, "both", value, over(graph, "least", hold, 1 - begin, 0))
    return value


def _since_core(graph: Graph, hold: int, goal: int) -> int:
    horizon = max(graph.horizon(hold), graph.horizon(goal))
    return _add(graph, Node(KINDS.index(graph.time.since), hold, goal, horizon=horizon))


def _recursion(graph: Graph, hold: int, goal: int) -> int:
    return _add(graph, Node(KINDS.index("until"), hold, goal, horizon=FOREVER))


def _until(graph: Graph, formula: Apply, hold: int, goal: int) -> int:
    """φ until[a, b] ψ is eventually[a, b] ψ, φ on [t, t + a), and (φ until ψ) from t + a on."""
    begin, end = interval_in_steps(graph, formula)
    past = formula.op.tense is Tense.PAST
    core = _recursion(graph, hold, goal)
    origin = -end if past else 0  # where it is read from
    first = begin + origin
    if past and first:  # before the start there is nothing, so that it is read from there
        value = _add(graph, Node(KINDS.index("held"), core, low=first, high=first, horizon=FOREVER))
    else:
        value = over(graph, "greatest", core, first, first)
    depths = graph.horizon(hold), graph.horizon(goal)
    horizon = FOREVER if FOREVER in (*depths, end) else max(depths) + max(0, end + origin)
    if begin:
        before = over(graph, "least", hold, origin, origin + graph.time.last_before(begin))
        value = _pair(graph, "both", value, before, horizon if end == FOREVER else FOREVER)
    if end < FOREVER:
        reached = over(graph, "greatest", goal, first, end + origin)
        value = _pair(graph, "both", value, reached, horizon)
    return value
