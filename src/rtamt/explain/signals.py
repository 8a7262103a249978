"""The values of the sub-formulas that an explanation looks at, and where they hold."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Const, Formula, Var, children, folds
from rtamt.language.records import Rank, Tense
from rtamt.language.shares import rank_of
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.modules import np
from rtamt.rewrite.check import reads_unbounded_future
from rtamt.rewrite.structure import CHOOSING, NEGATION, NEVER, opcode, window_of
from rtamt.signals.instants import Cells, StepFunction, two_valued

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from rtamt.engine import TimeAxis
    from rtamt.rewrite.structure import Structure


class Signals:
    """The sub-formulas of a structure over given signals of its leaves.

    One run of the engine, when one is first requested, gives those that read other instants and what they read; the
    others are a minimum, maximum or negation at one instant, found where they are requested. So is a share of a leaf.
    """

    def __init__(self, structure: Structure, axis: TimeAxis, leaves: Mapping[str, StepFunction]) -> None:
        self._axis = axis
        self._leaves = leaves
        self._steps: dict[Formula, StepFunction] = {}
        self._at: tuple[int, dict[Formula, float]] = (-1, {})
        wanted: dict[Formula, None] = {}
        for node in structure.order:
            if isinstance(node, Apply) and opcode(node) is None:
                wanted.update(dict.fromkeys((*node.args, node)))
        self._asked = {node: None for node in wanted if isinstance(node, Apply)}
        for node in structure.order:
            if isinstance(node, Var):
                self._steps[node] = leaves[node.name]
            elif isinstance(node, Const):
                self._steps[node] = StepFunction(np.zeros(1, np.int64), np.array([node.value]), axis.end)

    def of(self, node: Formula) -> StepFunction:
        """Return the values of a leaf, of a sub-formula that reads other instants, or of what one reads."""
        if node not in self._steps:
            self._steps.update(evaluated(tuple(self._asked), self._axis, self._leaves))
        return self._steps[node]

    def __contains__(self, node: Formula) -> bool:
        return node in self._steps or node in self._asked

    def at(self, node: Formula, cell: int) -> float:
        """Return the value of any sub-formula at a cell."""
        if self._at[0] != cell:
            self._at = (cell, {})
        known = self._at[1]
        stack = [node]
        while stack:
            top = stack[-1]
            if top in known:
                stack.pop()
            elif isinstance(top, Apply) and isinstance(top.op.kernel, Rank) and top.args[0] in self._steps:
                known[top] = share_at(top, self._steps[top.args[0]], cell, self._axis.period)
            elif top in self:
                known[top] = self.of(top).at(cell)
            else:
                missing = [arg for arg in children(top) if arg not in known]
                stack.extend(missing)
                if not missing:
                    known[top] = _choose(opcode(top), [known[arg] for arg in children(top)])
        return known[node]


def share_at(node: Apply, operand: StepFunction, cell: int, period: Fraction) -> float:
    """Return the value of a share at a cell; ``operand``: the values of which it is one."""
    dense = operand.end >= NEVER
    k, outside = rank_of(node.interval, period, continuous=dense)
    first, last = window_of(node, period)
    begin, end = (cell - last, cell - first) if node.op.tense is Tense.PAST else (cell + first, cell + last)
    # In dense time the cells at both ends of a window make up one.
    windows = ((begin, end), (begin + 1, end + 1)) if dense else ((begin, end + 1),)
    return min(_largest(k, outside, operand, *window) for window in windows)


def _largest(k: int, outside: float, operand: StepFunction, begin: int, end: int) -> float:
    """Return the k-th largest value in [begin, end), those outside the trace being ``outside``."""
    first, stop = max(begin, 0), min(end, operand.end)
    inside = max(stop - first, 0)
    if outside > 0:
        k -= end - begin - inside
    if k <= 0 or k > inside:
        return inf if k <= 0 else -inf
    changes, values = operand.between(first, stop)
    order = np.argsort(-values, kind="stable")
    counts = np.cumsum(np.diff(changes, append=stop)[order])
    return float(values[order[np.searchsorted(counts, k)]])


def _choose(code: str | None, values: list[float]) -> float:
    if code == NEGATION:
        return -values[0]
    return min(values) if code == CHOOSING[0] else max(values)


def evaluated(
    formulas: Sequence[Formula], axis: TimeAxis, leaves: Mapping[str, StepFunction]
) -> dict[Formula, StepFunction]:
    """Return the values of core formulas.

    In dense time those of unbounded future read the values of the others, which the engine would compute once more.
    """

    def step(node: Formula, below: tuple[bool, ...]) -> bool:
        return any(below) or (isinstance(node, Apply) and reads_unbounded_future(node))

    later = dict(zip(formulas, folds(formulas, step), strict=True))
    first = [formula for formula in formulas if not later[formula]]
    rest = [formula for formula in formulas if later[formula]]
    if axis.end < NEVER or not first or not rest:
        return dict(zip(formulas, axis.runner(formulas)(leaves), strict=True)) if formulas else {}
    found = dict(zip(first, axis.runner(first)(leaves), strict=True))
    names = {formula: f"={number}" for number, formula in enumerate(first)}

    def over_known(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if node in names:
            return Var(names[node])
        return replace(node, args=args) if isinstance(node, Apply) else node

    run = axis.runner(folds(rest, over_known))
    signals = {**leaves, **{names[formula]: steps for formula, steps in found.items()}}
    return found | dict(zip(rest, run(signals), strict=True))


def near(steps: StepFunction, begin: int, end: int) -> StepFunction:
    """Return a function with the same values in [begin, end), and constant before and after."""
    if begin <= 0 and end > steps.changes[-1]:
        return steps
    begin, end = max(begin, 0), min(end, steps.end)
    changes, values = steps.between(begin, end)  # a copy of the changes
    changes[0] = 0
    return StepFunction(changes, values, steps.end)


def spliced(steps: StepFunction, other: StepFunction, begin: int, end: int) -> StepFunction:
    """Return a function that is another one in [begin, end), which is not empty."""
    begin, end = max(begin, 0), min(end, steps.end)
    first = int(np.searchsorted(steps.changes, begin, side="left"))
    pieces = [(steps.changes[:first], steps.values[:first]), other.between(begin, end)]
    if end < steps.end:
        pieces.append(steps.between(end, steps.end))
    changes, values = (np.concatenate(each) for each in zip(*pieces, strict=True))
    return StepFunction(changes, values, steps.end)


def clipped(steps: StepFunction, low: float, high: float) -> StepFunction:
    """Return a function with its values limited to [low, high]."""
    values = np.clip(steps.values, low, high)
    new = np.append(True, values[1:] != values[:-1])
    return StepFunction(steps.changes[new], values[new], steps.end)


def truths(
    order: Sequence[Formula], axis: TimeAxis, leaves: Mapping[str, StepFunction]
) -> dict[Formula, Cells]:
    """Return where each sub-formula holds, given signals of its leaves that are above 0 where they hold.

    ``order``: the distinct sub-formulas, operands first.
    """
    whole = Cells.of([(0, axis.end)])
    bold = {name: two_valued(steps.positive(), inf, -inf, steps.end) for name, steps in leaves.items()}
    asked = [node for node in order if isinstance(node, Apply) and opcode(node) is None]
    found = evaluated(asked, axis, bold)
    holds: dict[Formula, Cells] = {}
    for node in order:
        code = opcode(node)
        if isinstance(node, Var):
            holds[node] = leaves[node.name].positive()
        elif isinstance(node, Const):
            holds[node] = whole if node.value > 0 else Cells.of([])
        elif code is None:
            holds[node] = found[node].positive()
        else:
            below = [holds[arg] for arg in children(node)]
            if code == NEGATION:
                holds[node] = whole - below[0]
            else:
                holds[node] = below[0] & below[1] if code == CHOOSING[0] else below[0] | below[1]
    return holds
