"""The choice of instants of an operand that support a share of its window, for many windows at once."""

from __future__ import annotations

from bisect import bisect_right
from collections import deque
from itertools import accumulate
from typing import TYPE_CHECKING

from rtamt.engine.native import built_core
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.signals.instants import Cells

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rtamt.signals.instants import Ints


#: Cells that windows may span for the core, which needs a byte for each.
_MOST_CELLS = 2**28


def windows_with(found: Cells, before: int, after: int, need: int) -> Cells:
    """Return the cells k such that [k + before, k + after] has ``need`` cells of ``found`` or more.

    From k to k + 1 their number stays, rises by one or falls by one: so until an interval enters, leaves or ends there.

    >>> windows_with(Cells.of([(3, 5), (7, 9)]), 0, 3, 2)
    Cells.of([(1, 8)])
    """
    edges = np.column_stack((found.starts, found.ends)).ravel()
    entering = np.tile([1, -1], len(found))
    points = np.concatenate((edges - (after + 1), edges - before))
    order = np.argsort(points, kind="stable")
    points = points[order]
    slopes = np.cumsum(np.concatenate((entering, -entering))[order])[:-1]
    counts = np.concatenate((np.zeros(1, np.int64), np.cumsum(slopes * np.diff(points))))[:-1]
    missing = need - counts
    starts, ends = points[:-1], points[1:]
    starts = np.where(slopes > 0, starts + np.maximum(missing, 0), starts)
    ends = np.where(slopes < 0, np.minimum(ends, points[:-1] - missing + 1), ends)
    enough = (missing <= 0) | (slopes > 0)
    return Cells.union(starts[enough], ends[enough])


def sharing(asked: Cells, found: Cells, before: int, after: int, need: int) -> Cells:
    """Return as few cells of ``found`` as possible: each k of ``asked`` has ``need`` in [k + before, k + after].

    From left to right, each time those furthest to the right that are not taken yet: later windows use them, too.
    No cell can be left out, because no smaller set exists. Cost: proportional to the number of cells in the core, to
    that of intervals where it is not built or the windows are too long for it.
    """
    core = built_core()
    if core is None or not len(asked) or int(asked.ends[-1]) + after - before >= _MOST_CELLS:
        return _Sweep(found, before, after, need).over(asked)
    rows = (np.stack((cells.starts, cells.ends), axis=1) for cells in (asked, found))
    return Cells.of(core.fewest_cells(*rows, before, after, need))


@dataclass(frozen=True, slots=True)
class TickWindow:
    """The window of one instant in dense time: cells from ``first`` to ``last``, those two being one tick together.

    ``both``: whether that tick counts where both cells do, or where one of them does. ``need``: how many ticks must.
    """

    first: int
    last: int
    need: int
    both: bool

    def weights(self, starts: Ints, ends: Ints) -> tuple[Ints, Ints]:
        """Return how many cells of intervals are in the window without its last cell, and without its first."""
        return tuple(
            np.maximum(np.minimum(ends, last + 1) - np.maximum(starts, first), 0)
            for first, last in ((self.first, self.last - 1), (self.first + 1, self.last))
        )

    def enough(self, one: Ints, other: Ints) -> NDArray[np.bool_]:
        """Return whether the counts without the last and without the first cell are sufficient."""
        return (np.minimum if self.both else np.maximum)(one, other) >= self.need

    def fewest(self, found: Cells, end: int) -> Cells:
        """Return as few intervals of ``found`` before ``end`` as possible that suffice, besides those before cell 0."""
        inside = found.within(0, end)
        weights = self.weights(inside.starts, inside.ends)
        outside = found - inside
        spare = [mine.sum() for mine in self.weights(outside.starts, outside.ends)]
        order = np.argsort(-(weights[0] + weights[1]), kind="stable")
        totals = (np.cumsum(mine[order]) + more for mine, more in zip(weights, spare, strict=True))
        missing = ~self.enough(*totals)
        chosen = order[: int(missing.sum()) + 1]
        return Cells.union(inside.starts[chosen], inside.ends[chosen])

    def needed(self, found: Cells) -> Cells:
        """Return a cell of each interval of ``found`` without which there are too few."""
        weights = self.weights(found.starts, found.ends)
        left = (mine.sum() - mine for mine in weights)
        needed = ~self.enough(*left)
        return Cells(found.starts[needed], found.starts[needed] + 1)


class _Sweep:
    """Windows of cells from left to right; ``free`` are the cells passed so far and not taken, as intervals."""

    def __init__(self, found: Cells, before: int, after: int, need: int) -> None:
        self._starts: list[int] = found.starts.tolist()
        self._ends: list[int] = found.ends.tolist()
        lengths = (end - start for start, end in zip(self._starts, self._ends, strict=True))
        self._total: list[int] = [0, *accumulate(lengths)]
        self._before, self._after, self._need = before, after, need
        self._free: deque[tuple[int, int]] = deque()
        self._left = 0  # free cells in the window
        self._seen = 0  # cells before the trace count, and are not to be taken
        self._next = 0  # the first interval that is not passed completely
        self._taken: list[tuple[int, int]] = []

    def over(self, asked: Cells) -> Cells:
        for begin, end in asked:
            k = max(begin, -self._after - 1)  # windows before the trace have what they need
            while k < end:
                self._see(k + self._after + 1)
                self._expire(k + self._before)
                inside = self._count(k + self._after + 1) - self._count(k + self._before)
                spare = inside - self._left - self._need
                if spare < 0:
                    self._take(-spare)
                    spare = 0
                k = self._after_next(k, spare, end)
        return Cells.of(self._taken)

    def _count(self, cell: int) -> int:
        """Return how many cells of ``found`` are before a cell."""
        run = bisect_right(self._starts, cell)
        return self._total[run] - (max(self._ends[run - 1] - cell, 0) if run else 0)

    def _see(self, stop: int) -> None:
        """Free the cells before ``stop`` that have not been passed."""
        while self._next < len(self._starts) and self._starts[self._next] < stop:
            begin, end = max(self._starts[self._next], self._seen), min(self._ends[self._next], stop)
            if begin < end:
                self._free.append((begin, end))
                self._left += end - begin
            if self._ends[self._next] > stop:
                break
            self._next += 1
        self._seen = max(self._seen, stop)

    def _expire(self, begin: int) -> None:
        """Forget the free cells before the window."""
        while self._free and self._free[0][0] < begin:
            start, end = self._free.popleft()
            self._left -= min(end, begin) - start
            if end > begin:
                self._free.appendleft((begin, end))

    def _take(self, count: int) -> None:
        """Take the free cells furthest to the right."""
        self._left -= count
        while count:
            start, end = self._free.pop()
            first = max(start, end - count)
            if start < first:
                self._free.append((start, first))
            self._taken.append((first, end))
            count -= end - first

    def _after_next(self, k: int, spare: int, end: int) -> int:
        """Return a later window, up to which every one has what it needs; it takes the cells for those it skips."""
        left = k + self._before
        stop = self._free[0][0] if self._free else None
        rank = self._count(left) + spare
        run = bisect_right(self._total, rank) - 1
        # The taken cell whose loss leaves too few.
        lost = self._starts[run] + rank - self._total[run] if run < len(self._starts) else None
        if stop is not None and (lost is None or lost >= stop):
            # Free cells come first: those before them are spare, and they themselves count for nothing.
            return max(k + 1, self._free[0][1] - self._before)
        if lost is None:
            return end
        k = lost + 1 - self._before
        if k >= end:
            return k
        # One more is needed for each taken cell that is lost from here on: a whole stretch of them at once.
        entering = k + self._after
        self._see(entering)
        stretch = min(self._ends[run], self._free[0][0] if self._free else self._ends[run]) - lost
        at = bisect_right(self._starts, entering) - 1
        if at >= 0 and entering < self._ends[at]:
            stretch = min(stretch, end - k, self._ends[at] - entering)
            self._taken.append((entering, entering + stretch))
            self._seen = entering + stretch
        else:
            later = self._starts[at + 1] - entering if at + 1 < len(self._starts) else stretch
            stretch = min(stretch, end - k, later, self._free[-1][1] - self._free[-1][0])
            self._take(stretch)
        return k + stretch - 1
