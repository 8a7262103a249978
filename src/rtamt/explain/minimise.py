"""Minimisation of a sufficient cause: intervals are removed as long as the verdict is forced without them.

A set of intervals forces the verdict if the formula has it when each predicate has its truth on its
intervals and, everywhere else, the truth that contradicts the verdict, at each of its places.
Operators being monotone, no other values there can be worse. The engine decides this on the formula
with two variables for a predicate (``Structure.polar``) that are +inf or -inf.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from rtamt.explain.signals import truths
from rtamt.lazy_dataclasses import dataclass
from rtamt.lazy_numpy import np
from rtamt.rewrite.structure import literal, reaches
from rtamt.signals.instants import NONE, Cells, StepFunction, two_valued

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.engine import TimeAxis
    from rtamt.explain.propagate import Demands
    from rtamt.rewrite.structure import Place, Structure


@dataclass(frozen=True, slots=True)
class Interval:
    """The cells [start, end) of a predicate, at places of one sign."""

    start: int
    end: int
    name: str
    sign: int


class Forcing:
    """Finds where the verdict is lost if the predicates are known only on some intervals."""

    def __init__(
        self, structure: Structure, demands: Demands, axis: TimeAxis, fixed: Mapping[str, StepFunction]
    ) -> None:
        self._structure = structure
        self._demands = demands
        self._axis = axis
        self._end = axis.end
        self._fixed = fixed
        self._literals = [
            (leaf.name, sign) for leaf in structure.leaves.values() if not leaf.fixed for sign in (1, -1)
        ]
        self._choices = [(place, surely) for place, surely in demands.choices if len(surely)]
        formulas = [structure.polar[place] for place, _ in self._choices]
        self._run = axis.runner(formulas) if formulas else None
        found = reaches(structure.order, axis.period)
        nodes = [node for (node, _), _ in self._choices]
        #: How many cells behind and ahead a choice can look.
        self.behind = max((found[node][0] for node in nodes), default=0)
        self.ahead = max((found[node][1] for node in nodes), default=0)

    def _signals(self, intervals: Iterable[Interval]) -> dict[str, StepFunction]:
        """Return replacements for the predicates: unchanged on the intervals, worst case elsewhere."""
        known: dict[tuple[str, int], list[tuple[int, int]]] = {}
        for interval in intervals:
            known.setdefault((interval.name, interval.sign), []).append((interval.start, interval.end))
        signals = dict(self._fixed)
        for name, sign in self._literals:
            good = inf if self._demands.truth(sign) else -inf
            cells = Cells.of(known.get((name, sign), ()))
            signals[literal(name, sign)] = two_valued(cells, good, -good, self._end)
        return signals

    def support(self, intervals: Iterable[Interval]) -> dict[Place, Cells]:
        """Return where each place has its required truth, by the intervals alone."""
        polar = self._structure.polar
        order = tuple(dict.fromkeys(polar.values()))
        holds = truths(order, self._axis, self._signals(intervals))
        whole = Cells.of([(0, self._end)])
        return {
            (node, sign): holds[formula] if self._demands.truth(sign) else whole - holds[formula]
            for (node, sign), formula in polar.items()
        }

    def failures(self, intervals: Iterable[Interval]) -> Cells:
        """Return the cells at which something falls that the verdict cannot do without."""
        if self._run is None:
            return NONE
        signals = self._signals(intervals)
        failed = NONE
        for ((_, sign), surely), steps in zip(self._choices, self._run(signals), strict=True):
            holds = Cells.where(steps.changes, (steps.values > 0) == self._demands.truth(sign), self._end)
            failed = failed | (surely - holds)
        return failed


def intervals_of(demands: Demands) -> list[Interval]:
    """Return the required truth of the predicates as intervals, which force the verdict."""
    return [
        Interval(start, end, name, sign)
        for (name, sign), asked in demands.leaves.items()
        for start, end in asked.cells
    ]


def minimal(intervals: Sequence[Interval], needs: Demands, forcing: Forcing) -> list[Interval]:
    """Return those of ``intervals`` that are left when as many as possible are taken away.

    Taken away on trial, where it is not plain from ``needs`` that they cannot be, are first large groups
    of neighbours, then smaller ones. Groups so far apart that nothing looks at two of them are tried in
    one run.
    """
    kept: list[Interval] = []
    open_: list[Interval] = []
    for interval, plain in zip(intervals, _which_needed(intervals, needs), strict=True):
        (kept if plain else open_).append(interval)
    open_.sort(key=lambda interval: (interval.start, interval.end))
    size = 1 << max(len(open_) - 1, 0).bit_length()
    groups = [open_] if open_ else []
    while groups:
        groups = _needed_groups(groups, kept, forcing)
        if size == 1:
            break
        size //= 2
        groups = [group[i : i + size] for group in groups for i in range(0, len(group), size)]
    return kept + [interval for group in groups for interval in group]


def _which_needed(intervals: Sequence[Interval], needs: Demands) -> NDArray[np.bool_]:
    """Return for each interval whether it intersects ``needs``."""
    plain = np.zeros(len(intervals), bool)
    starts, ends = (
        np.array([getattr(each, name) for each in intervals], np.int64) for name in ("start", "end")
    )
    of: dict[tuple[str, int], list[int]] = {}
    for number, interval in enumerate(intervals):
        of.setdefault((interval.name, interval.sign), []).append(number)
    for literal_, numbers in of.items():
        if (asked := needs.leaves.get(literal_)) is not None:
            plain[numbers] = asked.cells.intersects(starts[numbers], ends[numbers])
    return plain


def _needed_groups(
    groups: Sequence[list[Interval]], kept: Sequence[Interval], forcing: Forcing
) -> list[list[Interval]]:
    """Return the groups that cannot be taken away, each tried when those before it have been decided."""
    zones = {
        id(group): (
            min(interval.start for interval in group) - forcing.ahead,
            max(interval.end for interval in group) + forcing.behind,
        )
        for group in groups
    }
    waiting = sorted(groups, key=lambda group: zones[id(group)][1])
    staying = {id(group): group for group in groups}
    while waiting:
        trial: list[list[Interval]] = []
        later: list[list[Interval]] = []
        for group in waiting:
            apart = not trial or zones[id(group)][0] >= zones[id(trial[-1])][1]
            (trial if apart else later).append(group)
        for group in trial:
            del staying[id(group)]
        rest = [interval for group in (*staying.values(),) for interval in group]
        failed = forcing.failures([*kept, *rest])
        for group in trial:
            if len(failed & Cells.of([zones[id(group)]])):
                staying[id(group)] = group
        waiting = later
    return [group for group in groups if id(group) in staying]
