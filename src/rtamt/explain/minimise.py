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
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.rewrite.structure import literal, reaches
from rtamt.signals.instants import NONE, Cells, StepFunction, two_valued

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.engine import TimeAxis
    from rtamt.explain.propagate import Demands
    from rtamt.rewrite.structure import Place, Structure
    from rtamt.signals.instants import Ints


@dataclass(frozen=True, slots=True)
class Interval:
    """The cells [start, end) of a predicate, at places of one sign."""

    start: int
    end: int
    name: str
    sign: int


@dataclass(frozen=True, slots=True, eq=False)
class Intervals:
    """Intervals of predicates as arrays; ``of``: the index of each one's predicate and sign in ``literals``."""

    starts: Ints
    ends: Ints
    of: Ints
    literals: Sequence[tuple[str, int]]

    @classmethod
    def asked_in(cls, demands: Demands) -> Intervals:
        """Return the required truth of the predicates, which forces the verdict; those of a predicate in order."""
        found = [asked.cells for asked in demands.leaves.values()]
        if not found:
            return cls(NONE.starts, NONE.ends, NONE.starts, ())
        return cls(
            np.concatenate([cells.starts for cells in found]),
            np.concatenate([cells.ends for cells in found]),
            np.repeat(np.arange(len(found)), [len(cells) for cells in found]),
            tuple(demands.leaves),
        )

    def __len__(self) -> int:
        return len(self.starts)

    def __getitem__(self, number: int) -> Interval:
        return Interval(int(self.starts[number]), int(self.ends[number]), *self.literals[self.of[number]])

    def take(self, numbers: Ints) -> Intervals:
        """Return some of the intervals."""
        return Intervals(self.starts[numbers], self.ends[numbers], self.of[numbers], self.literals)

    def numbers(self) -> Iterator[tuple[tuple[str, int], Ints]]:
        """Yield each predicate and sign with the indices of its intervals, in their order."""
        order = np.argsort(self.of, kind="stable")
        edges = np.searchsorted(self.of[order], np.arange(len(self.literals) + 1)).tolist()
        for literal_, begin, end in zip(self.literals, edges, edges[1:], strict=False):
            if begin < end:
                yield literal_, order[begin:end]


@dataclass(frozen=True, slots=True, eq=False)
class Groups:
    """Groups of neighbours in a sequence: of each the first element, and the one after the last.

    >>> Groups(np.array([0, 5]), np.array([4, 7])).split(2).members().tolist()
    [0, 1, 2, 3, 5, 6]
    """

    first: Ints
    stop: Ints

    @classmethod
    def none(cls) -> Groups:
        """Return no groups."""
        return cls(NONE.starts, NONE.ends)

    def __len__(self) -> int:
        return len(self.first)

    def take(self, which: NDArray[np.bool_]) -> Groups:
        """Return some of the groups."""
        return Groups(self.first[which], self.stop[which])

    def group_of(self) -> Ints:
        """Return the number of the group of each of :meth:`members`."""
        return np.repeat(np.arange(len(self)), self.stop - self.first)

    def members(self) -> Ints:
        """Return the elements of all groups in their order."""
        sizes = self.stop - self.first
        before = np.cumsum(sizes) - sizes
        found: Ints = np.arange(int(sizes.sum())) + np.repeat(self.first - before, sizes)
        return found

    def largest(self, values: Ints) -> Ints:
        """Return the largest value in each group; ``values``: of the sequence."""
        edges = np.column_stack((self.first, self.stop)).ravel()
        found: Ints = np.maximum.reduceat(np.append(values, 0), edges)[::2]
        return found

    def split(self, size: int) -> Groups:
        """Return groups of at most ``size`` elements."""
        parts = -(-(self.stop - self.first) // size)
        number = np.arange(int(parts.sum())) - np.repeat(np.cumsum(parts) - parts, parts)
        first = np.repeat(self.first, parts) + number * size
        return Groups(first, np.minimum(first + size, np.repeat(self.stop, parts)))


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

    def _signals(self, intervals: Intervals) -> dict[str, StepFunction]:
        """Return replacements for the predicates: unchanged on the intervals, worst case elsewhere."""
        known = {
            literal_: Cells.union(intervals.starts[numbers], intervals.ends[numbers])
            for literal_, numbers in intervals.numbers()
        }
        signals = dict(self._fixed)
        for name, sign in self._literals:
            good = inf if self._demands.truth(sign) else -inf
            cells = known.get((name, sign), NONE)
            signals[literal(name, sign)] = two_valued(cells, good, -good, self._end)
        return signals

    def support(self, intervals: Intervals) -> dict[Place, Cells]:
        """Return where each place has its required truth, by the intervals alone."""
        polar = self._structure.polar
        order = tuple(dict.fromkeys(polar.values()))
        holds = truths(order, self._axis, self._signals(intervals))
        whole = Cells.of([(0, self._end)])
        return {
            (node, sign): holds[formula] if self._demands.truth(sign) else whole - holds[formula]
            for (node, sign), formula in polar.items()
        }

    def failures(self, intervals: Intervals) -> Cells:
        """Return the cells at which something falls that the verdict cannot do without."""
        if self._run is None:
            return NONE
        signals = self._signals(intervals)
        failed = NONE
        for ((_, sign), surely), steps in zip(self._choices, self._run(signals), strict=True):
            holds = Cells.where(steps.changes, (steps.values > 0) == self._demands.truth(sign), self._end)
            failed = failed | (surely - holds)
        return failed


def minimal(intervals: Intervals, needs: Demands, forcing: Forcing) -> Intervals:
    """Return those of ``intervals`` that are left when as many as possible are taken away.

    Taken away on trial, where it is not plain from ``needs`` that they cannot be, are first large groups
    of neighbours, then smaller ones. Groups so far apart that nothing looks at two of them are tried in
    one run.
    """
    plain = _which_needed(intervals, needs)
    kept, open_ = np.flatnonzero(plain), np.flatnonzero(~plain)
    open_ = open_[np.lexsort((intervals.ends[open_], intervals.starts[open_]))]
    size = 1 << max(len(open_) - 1, 0).bit_length()
    groups = Groups(np.zeros(1, np.int64), np.array([len(open_)])) if len(open_) else Groups.none()
    while len(groups):
        groups = _needed_groups(groups, kept, open_, intervals, forcing)
        if size == 1:
            break
        size //= 2
        groups = groups.split(size)
    return intervals.take(np.concatenate((kept, open_[groups.members()])))


def _which_needed(intervals: Intervals, needs: Demands) -> NDArray[np.bool_]:
    """Return for each interval whether it intersects ``needs``."""
    plain = np.zeros(len(intervals), bool)
    for literal_, numbers in intervals.numbers():
        if (asked := needs.leaves.get(literal_)) is not None:
            plain[numbers] = asked.cells.intersects(intervals.starts[numbers], intervals.ends[numbers])
    return plain


def _needed_groups(groups: Groups, kept: Ints, open_: Ints, intervals: Intervals, forcing: Forcing) -> Groups:
    """Return the groups that cannot be taken away, each tried when those before it have been decided."""
    begins = intervals.starts[open_][groups.first] - forcing.ahead  # in a group the first one starts first
    ends = groups.largest(intervals.ends[open_]) + forcing.behind
    zones = list(zip(begins.tolist(), ends.tolist(), strict=True))
    members, group_of = groups.members(), groups.group_of()
    staying = np.ones(len(groups), bool)
    waiting = np.argsort(ends, kind="stable").tolist()
    while waiting:
        trial: list[int] = []
        later: list[int] = []
        for number in waiting:
            apart = not trial or zones[number][0] >= zones[trial[-1]][1]
            (trial if apart else later).append(number)
        staying[trial] = False
        left = open_[members[staying[group_of]]]
        failed = forcing.failures(intervals.take(np.concatenate((kept, left))))
        staying[trial] = failed.intersects(begins[trial], ends[trial])
        waiting = later
    return groups.take(staying)
