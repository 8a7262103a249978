"""The values of the sub-formulas that an explanation looks at, and where they hold."""

from __future__ import annotations

from functools import cached_property
from math import inf
from typing import TYPE_CHECKING

from rtamt.explain.bands import band_around
from rtamt.explain.shares import windows_with
from rtamt.language.formula import Apply, Const, Formula, Var, children, folds
from rtamt.language.records import Rank, Tense
from rtamt.language.shares import rank_of
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.modules import np
from rtamt.rewrite.check import reads_unbounded_future
from rtamt.rewrite.structure import CHOOSING, NEGATION, NEVER, opcode, window_of
from rtamt.signals.instants import NONE, Cells, StepFunction, two_valued

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from rtamt.engine import TimeAxis
    from rtamt.explain.bands import Band
    from rtamt.rewrite.structure import Place, Structure


#: Values in a band are evaluated first where they change that many times less often.
_WORTH = 3


class Signals:
    """The sub-formulas of a structure over given signals of its leaves.

    One run of the engine, when one is first requested, gives those that read other instants and what they read; the
    others are a minimum, maximum or negation at one instant, found where they are requested. So is a share of a leaf.
    ``value``: one of them; those in a band around it cost less.
    """

    def __init__(
        self,
        structure: Structure,
        axis: TimeAxis,
        leaves: Mapping[str, StepFunction],
        value: float | None = None,
    ) -> None:
        self._axis = axis
        self._leaves = leaves
        self._steps: dict[Formula, StepFunction] = {}
        self._value = value
        self._in_band: dict[str, StepFunction] = {}
        self._within: dict[Formula, StepFunction] = {}
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

    @cached_property
    def band(self) -> Band | None:
        """The band around the value of which this was made; None where values in it cost not much less."""
        band = None if self._value is None else band_around(self._value, self._leaves.values())
        if band is None:
            return None
        self._in_band = {name: band.of(steps) for name, steps in self._leaves.items()}
        left, every = (
            sum(len(steps.changes) for steps in each.values()) for each in (self._in_band, self._leaves)
        )
        return band if left * _WORTH <= every else None

    def of(self, node: Formula, value: float | None = None) -> StepFunction:
        """Return the values of a leaf, of a sub-formula that reads other instants, or of what one reads.

        Where one is given, it alone need be exact, and others on their side of it.
        """
        if node not in self._steps:
            if value is not None and self.band is not None and self.band.contains(value):
                return self._inexact(node)
            self._steps.update(evaluated(tuple(self._asked), self._axis, self._leaves))
        return self._steps[node]

    def _inexact(self, node: Formula) -> StepFunction:
        """Return values of which those in the band are exact."""
        if node in self._steps:
            return self._steps[node]
        if not self._within:
            self._within = evaluated(tuple(self._asked), self._axis, self._in_band)
        return self._within[node]

    def largest(self, node: Formula, sign: int, begin: int, end: int) -> int:
        """Return the first cell in [begin, end) at which a value is, times a sign, the largest."""
        if self.band is not None:
            changes, values = self._inexact(node).between(begin, end)
            first = int((sign * values).argmax())
            if self.band.contains(float(values[first])):
                return int(changes[first])
        changes, values = self.of(node).between(begin, end)
        return int(changes[(sign * values).argmax()])

    def beyond(self, edge: float, toward: float, value: float, place: Place) -> StepFunction:
        """Return the values at a place in the band, with another value, up to sign, from an edge to -inf or +inf."""
        node, sign = place
        steps = self._inexact(node)
        there = sign * steps.values >= edge if toward > 0 else sign * steps.values <= edge
        return StepFunction(steps.changes, np.where(there, sign * value, steps.values), steps.end)

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
                value = inf if self.band is None else self._inexact(top).at(cell)
                exact = self.band is not None and self.band.contains(value)
                known[top] = value if exact else self.of(top).at(cell)
            else:
                missing = [arg for arg in children(top) if arg not in known]
                stack.extend(missing)
                if not missing:
                    known[top] = _choose(opcode(top), [known[arg] for arg in children(top)])
        return known[node]


def has_share(order: Sequence[Formula]) -> bool:
    """Return whether one of some sub-formulas is a share of a window."""
    return any(isinstance(node, Apply) and isinstance(node.op.kernel, Rank) for node in order)


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
    formulas: Sequence[Formula],
    axis: TimeAxis,
    leaves: Mapping[str, StepFunction],
    known: Mapping[Formula, StepFunction] | None = None,
) -> dict[Formula, StepFunction]:
    """Return the values of core formulas; ``known``: those of some of their sub-formulas.

    In dense time those of unbounded future read the values of the others, which the engine would compute once more.
    """
    if not formulas:
        return {}

    def step(node: Formula, below: tuple[bool, ...]) -> bool:
        return any(below) or (isinstance(node, Apply) and reads_unbounded_future(node))

    later = dict(zip(formulas, folds(formulas, step), strict=True))
    first = [formula for formula in formulas if not later[formula]]
    rest = [formula for formula in formulas if later[formula]]
    if axis.end >= NEVER and first and rest:
        found = evaluated(first, axis, leaves, known)
        return found | evaluated(rest, axis, leaves, {**(known or {}), **found})
    names = {formula: f"={number}" for number, formula in enumerate(known or ())}

    def over_known(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if node in names:
            return Var(names[node])
        return replace(node, args=args) if isinstance(node, Apply) else node

    run = axis.runner(folds(formulas, over_known) if known else formulas)
    signals = {**leaves, **{names[formula]: steps for formula, steps in (known or {}).items()}}
    return dict(zip(formulas, run(signals), strict=True))


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

    ``order``: the distinct sub-formulas, operands first. A share is counted; the engine is asked for what else reads
    other instants: for what is below a share before what is above it.
    """
    whole = Cells.of([(0, axis.end)])
    true = {name: steps.positive() for name, steps in leaves.items()}
    bold = {name: two_valued(cells, inf, -inf, axis.end) for name, cells in true.items()}
    holds: dict[Formula, Cells] = {}
    shares: dict[Formula, StepFunction] = {}

    def pointwise(node: Formula) -> Cells:
        if isinstance(node, Var):
            return true[node.name]
        if isinstance(node, Const):
            return whole if node.value > 0 else NONE
        below = [holds[arg] for arg in children(node)]
        if opcode(node) == NEGATION:
            return whole - below[0]
        return below[0] & below[1] if opcode(node) == CHOOSING[0] else below[0] | below[1]

    for nodes in _by_shares_below(order):
        asked = []
        for node in nodes:
            if isinstance(node, Apply) and isinstance(node.op.kernel, Rank):
                holds[node] = share_truth(node, holds[node.args[0]], axis)
                shares[node] = two_valued(holds[node], inf, -inf, axis.end)
            elif isinstance(node, Apply) and opcode(node) is None:
                asked.append(node)
        found = evaluated(asked, axis, bold, shares)
        for node in nodes:
            if node not in holds:
                holds[node] = found[node].positive() if node in found else pointwise(node)
    return holds


def _by_shares_below(order: Sequence[Formula]) -> list[list[Formula]]:
    """Return sub-formulas by the number of shares on the way down to the leaves, themselves included."""
    depths: dict[Formula, int] = {}
    for node in order:
        own = isinstance(node, Apply) and isinstance(node.op.kernel, Rank)
        depths[node] = own + max((depths[arg] for arg in children(node)), default=0)
    return [
        [node for node in order if depths[node] == depth]
        for depth in range(max(depths.values(), default=0) + 1)
    ]


def share_truth(node: Apply, found: Cells, axis: TimeAxis) -> Cells:
    """Return where a share holds; ``found``: where its operand does."""
    dense = axis.end >= NEVER
    k, outside = rank_of(node.interval, axis.period, continuous=dense)
    first, last = window_of(node, axis.period)
    before, after = (-last, -first) if node.op.tense is Tense.PAST else (first, last)
    if dense and len(found) and found.ends[-1] >= axis.end:  # what lasts so long lasts for ever
        found = found | Cells.of([(axis.end, 4 * NEVER)])
    if outside > 0:
        found = found | Cells.of([(-2 * NEVER, 0)] if dense else [(-2 * NEVER, 0), (axis.end, 4 * NEVER)])
    if not dense:
        return windows_with(found, before, after, k).within(0, axis.end)
    # The cells at both ends of a window make up one, which counts where both do.
    enough = windows_with(found, before, after - 1, k)
    return Cells(enough.starts, enough.ends - 1).within(0, axis.end)
