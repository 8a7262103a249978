"""Minimisation of a sufficient cause: intervals are removed as long as the verdict is forced without them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.explain.intervals import Groups
from rtamt.lazy.modules import np
from rtamt.rewrite.structure import NEVER

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from rtamt.explain.forcing import Forcing
    from rtamt.explain.intervals import Intervals
    from rtamt.explain.propagate import Demands
    from rtamt.signals.instants import Ints


def minimal(intervals: Intervals, needs: Demands, forcing: Forcing) -> Intervals:
    """Return those of ``intervals`` that are left when as many as possible are taken away.

    Taken away on trial, where it is not plain from ``needs`` that they cannot be, are first large groups
    of neighbours, then smaller ones. Groups so far apart that nothing of bounded reach looks at two of them are tried
    in one run; groups that clearly cannot be taken away are not tried.
    """
    plain = _which_needed(intervals, needs)
    kept, open_ = np.flatnonzero(plain), np.flatnonzero(~plain)
    open_ = open_[np.lexsort((intervals.ends[open_], intervals.starts[open_]))]
    trials = _Trials(kept, open_, intervals, forcing)
    size = 1 << max(len(open_) - 1, 0).bit_length()
    whole = groups = Groups(np.zeros(1, np.int64), np.array([len(open_)])) if len(open_) else Groups.none()
    stuck = trials.stuck(whole, size)
    while len(groups):
        groups = trials.needed(groups, stuck[size][groups.first // size])
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


class _Trials:
    """Trials without groups of the intervals that are ``open_``: sorted by their starts."""

    def __init__(self, kept: Ints, open_: Ints, intervals: Intervals, forcing: Forcing) -> None:
        self._kept = kept
        self._open = open_
        self._intervals = intervals
        self._candidates = intervals.take(open_)
        self._forcing = forcing
        self._begun = -1  # with how many open intervals

    def _with(self, members: Ints) -> Intervals:
        return self._intervals.take(np.concatenate((self._kept, self._open[members])))

    def _begin(self, members: Ints) -> bool:
        """Prepare trials with these open intervals; return whether there were more of them before."""
        fewer = len(members) != self._begun
        if fewer:
            self._forcing.begin(self._with(members))
            self._begun = len(members)
        return fewer

    def stuck(self, whole: Groups, size: int) -> dict[int, NDArray[np.bool_]]:
        """Return for each size of groups, up to that of the whole, which ones clearly cannot be taken away."""
        found: dict[int, NDArray[np.bool_]] = {}
        self._begin(whole.members())
        below = np.zeros(0, bool)
        for exponent in range(size.bit_length()):
            groups = whole.split(1 << exponent)
            below = self._forcing.stuck(self._candidates, groups) | _either(below, len(groups))
            found[1 << exponent] = below
        return found

    def needed(self, groups: Groups, stuck: NDArray[np.bool_]) -> Groups:
        """Return the groups that cannot be taken away, each tried when those before it have been decided."""
        if stuck.all():
            return groups
        members, group_of = groups.members(), groups.group_of()
        if self._begin(members):
            stuck = stuck | self._forcing.stuck(self._candidates, groups)
        starts = self._candidates.starts[groups.first]  # in a group the first one starts first
        begins = starts - self._forcing.ahead
        ends = groups.largest(self._candidates.ends) + self._forcing.behind
        staying = np.ones(len(groups), bool)
        for apart in _far_apart(begins, ends):
            trial = apart[~stuck[apart]]
            if len(trial):
                staying[trial] = False
                left = self._with(members[staying[group_of]])
                failed = self._forcing.failures(left, begins[trial], ends[trial])
                staying[trial] = failed.intersects(begins[trial], ends[trial])
                self._settle(trial[~staying[trial]], staying, members, group_of)
        return groups.take(staying)

    def _settle(self, taken: Ints, staying: NDArray[np.bool_], members: Ints, group_of: Ints) -> None:
        """Put back those of the groups that were taken away without which a choice of unbounded reach falls.

        These are few: where taking all away does no harm, one run decides about them.
        """
        if not len(taken) or not self._forcing.fails(self._with(members[staying[group_of]])):
            return
        staying[taken] = True
        if len(taken) > 1:
            half = len(taken) // 2
            for part in taken[:half], taken[half:]:
                staying[part] = False
                self._settle(part, staying, members, group_of)


def _either(flags: NDArray[np.bool_], count: int) -> NDArray[np.bool_]:
    """Return whether any of each two neighbours is true, for ``count`` of these pairs."""
    padded = np.zeros(2 * count, bool)
    padded[: len(flags)] = flags
    return padded[::2] | padded[1::2]


def _far_apart(begins: Ints, ends: Ints) -> Iterator[Ints]:
    """Yield the indices of intervals [begin, end) in sets that are apart, each as large as those before it permit."""
    firsts, lasts = begins.tolist(), ends.tolist()
    waiting: list[int] = np.argsort(ends, kind="stable").tolist()
    while waiting:
        apart: list[int] = []
        later: list[int] = []
        last = -4 * NEVER
        for number in waiting:
            if firsts[number] >= last:
                apart.append(number)
                last = lasts[number]
            else:
                later.append(number)
        yield np.array(apart)
        waiting = later
