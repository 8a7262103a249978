"""Shares of windows with fewer cells than an explanation began with: where one fails, and what none can spare."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.lazy.modules import np
from rtamt.signals.instants import Cells

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rtamt.signals.instants import Ints


class ShareWindows:
    """Windows [k + before, k + after] for all k of ``asked``, each of which must have ``need`` cells of an operand.

    ``both``: in dense time the cells at both ends of a window make up one, which counts where both do, or where one
    does; None in discrete time.

    The number of cells between the ends, as a function of k, changes by one at most from k to k + 1. It is smallest
    where a cell is about to enter, or where the last of an interval has left: there alone it is counted. Cost of a
    count: a binary search.
    """

    def __init__(self, asked: Cells, before: int, after: int, need: int, both: bool | None) -> None:
        self._asked = asked
        self._need = need
        self._both = both
        self._before = before
        # Without the cell at one of the ends, at k + 1 without that at the other.
        self._stop = after + 1 if both is None else after
        self._counted = asked if both is None else asked.widened(0, 1)

    def lows(self, found: Cells) -> Ints:
        """Return, in order, where windows have the fewest cells of ``found``, or of some of its intervals."""
        ends = self._counted.starts, self._counted.ends - 1
        points = np.concatenate((found.starts - self._stop, found.ends - self._before, *ends))
        points.sort(kind="stable")
        return points[self._counted.intersects(points, points + 1)]

    def counts(self, found: Cells, points: Ints) -> Ints:
        """Return how many cells of ``found`` there are in windows."""
        return found.before(points + self._stop) - found.before(points + self._before)

    def tight(self, found: Cells) -> Cells:
        """Return those of ``asked`` around which windows have no more cells of ``found`` than they need.

        From one low to the next, windows do not have fewer cells than there.
        """
        points = self.lows(found)
        low = np.flatnonzero(self.counts(found, points) <= self._need)
        before, after = points[np.maximum(low - 1, 0)], points[np.minimum(low + 1, len(points) - 1)]
        return self._asked & Cells.union(before - (self._both is not None), after + 1)

    def failing(self, found: Cells, points: Ints) -> Cells:
        """Return cells, next to some of the points, whose windows have too few cells of ``found``."""
        low = points[self.counts(found, points) < self._need]
        if self._both is None:
            return Cells.union(low, low + 1)
        either = np.concatenate((low - 1, low))
        if not self._both:  # it fails where both counts are too small
            counts = np.maximum(self.counts(found, either), self.counts(found, either + 1))
            either = either[counts < self._need]
        either = either[self._asked.intersects(either, either + 1)]
        return Cells.union(either, either + 1)

    def cannot_spare(
        self, points: Ints, counts: Ints, starts: Ints, ends: Ints, weights: Ints
    ) -> NDArray[np.bool_]:
        """Return of cells in [start, end) that weigh as much whether a window that has them all cannot spare them.

        ``counts``: at points. What cannot be spared is perhaps not found.
        """
        alone = int(self._both is False)  # at k - 1 or k + 1 there can be one more
        first = np.searchsorted(points, ends - self._stop + alone, side="left")
        stop = np.searchsorted(points, starts - self._before - alone, side="right")
        found = np.zeros(len(starts), bool)
        some = np.flatnonzero(first < stop)
        found[some] = smallest(counts, first[some], stop[some]) + alone - weights[some] < self._need
        return found


def smallest(values: Ints, first: Ints, stop: Ints) -> Ints:
    """Return the smallest of the values from each ``first`` up to ``stop``, of which there is at least one.

    >>> smallest(np.array([3, 1, 4, 1, 5]), np.array([0, 2, 4]), np.array([1, 5, 5])).tolist()
    [3, 1, 5]
    """
    found = np.empty_like(values, shape=len(first))
    lengths = stop - first
    size, table = 1, values  # of as many values from each place on
    while len(left := np.flatnonzero(lengths >= size)):
        now = left[lengths[left] < 2 * size]
        found[now] = np.minimum(table[first[now]], table[stop[now] - size])
        table, size = np.minimum(table[:-size], table[size:]), 2 * size
    return found
