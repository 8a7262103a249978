"""Instants as whole numbers: sets of them as intervals, and functions of them that change seldom.

A *cell* is a sample in discrete time and a tick in dense time, where a signal is constant from a tick
up to the next; cell 0 is where the recording starts. Both time domains are explained in cells.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.rewrite.structure import NEVER
from rtamt.signals.sampling_period import merged

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

    Ints: TypeAlias = NDArray[np.int64]
    Floats: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """A set of cells: half-open intervals [start, end), in order, none touching the next.

    >>> Cells.of([(0, 3), (5, 6)]) | Cells.of([(2, 5)])
    Cells.of([(0, 6)])
    >>> Cells.of([(2, 4)]).widened(-1, 2)
    Cells.of([(1, 6)])
    """

    starts: Ints
    ends: Ints

    @classmethod
    def of(cls, intervals: Iterable[tuple[int, int]]) -> Cells:
        """Return the union of intervals in any order, which may overlap or be empty."""
        pairs = np.array(list(intervals), np.int64).reshape(-1, 2)
        return cls.union(pairs[:, 0], pairs[:, 1])

    @classmethod
    def union(cls, starts: Ints, ends: Ints) -> Cells:
        """Return the union of intervals given by their starts and ends."""
        real = starts < ends
        starts, ends = starts[real], ends[real]
        if len(starts) > 1:
            order = np.argsort(starts, kind="stable")
            starts, ends = starts[order], np.maximum.accumulate(ends[order])
            apart = starts[1:] > ends[:-1]
            starts = starts[np.concatenate(([True], apart))]
            ends = ends[np.concatenate((apart, [True]))]
        return cls(starts, ends)

    @classmethod
    def where(cls, changes: Ints, holds: NDArray[np.bool_], end: int) -> Cells:
        """Return where a function of Booleans holds, which changes at ``changes``, up to ``end``."""
        stops = np.append(changes[1:], end)
        return cls.union(changes[holds], stops[holds])

    def __or__(self, other: Cells) -> Cells:
        return Cells.union(
            np.concatenate((self.starts, other.starts)), np.concatenate((self.ends, other.ends))
        )

    def __and__(self, other: Cells) -> Cells:
        # Of each pair that overlaps, the common part: for every interval here those of the other that meet it.
        first = np.searchsorted(other.ends, self.starts, side="right")
        last = np.searchsorted(other.starts, self.ends, side="left")
        count = np.maximum(last - first, 0)
        mine = np.repeat(np.arange(len(count)), count)
        theirs = np.arange(len(mine)) - np.repeat(np.cumsum(count) - count, count) + np.repeat(first, count)
        return Cells(
            np.maximum(self.starts[mine], other.starts[theirs]),
            np.minimum(self.ends[mine], other.ends[theirs]),
        )

    def __sub__(self, other: Cells) -> Cells:
        edges = (np.array([-2 * NEVER]), np.array([2 * NEVER]))
        outside = Cells(np.concatenate((edges[0], other.ends)), np.concatenate((other.starts, edges[1])))
        return self & outside

    def widened(self, before: int, after: int) -> Cells:
        """Return the cells k + i for k in the set and ``before`` ≤ i ≤ ``after``."""
        return Cells.union(self.starts + before, self.ends + after)

    def mirrored(self) -> Cells:
        """Return the cells -k for k in the set."""
        return Cells(1 - self.ends[::-1], 1 - self.starts[::-1])

    def within(self, begin: int, end: int) -> Cells:
        """Return the part in [begin, end)."""
        return Cells.union(np.maximum(self.starts, begin), np.minimum(self.ends, end))

    def before(self, points: Ints) -> Ints:
        """Return the number of cells before each point."""
        total = np.concatenate((np.zeros(1, np.int64), np.cumsum(self.ends - self.starts)))
        begun = np.searchsorted(self.starts, points, side="right")
        ends = np.concatenate((np.array([-4 * NEVER]), self.ends))
        return total[begun] - np.maximum(ends[begun] - points, 0)

    def __iter__(self) -> Iterator[tuple[int, int]]:
        return iter(zip(self.starts.tolist(), self.ends.tolist(), strict=True))

    def __len__(self) -> int:
        return len(self.starts)

    def __contains__(self, cell: int) -> bool:
        return self.meets(cell, cell + 1)

    def meets(self, begin: int, end: int) -> bool:
        """Return whether any cell is in [begin, end), which is not empty."""
        i = int(np.searchsorted(self.starts, end, side="left")) - 1
        return i >= 0 and begin < int(self.ends[i])

    def intersects(self, begins: Ints, ends: Ints) -> NDArray[np.bool_]:
        """Return, for each of several [begin, end), of which none is empty, whether any cell is in it."""
        last = np.searchsorted(self.starts, ends, side="left") - 1
        return begins < np.append(self.ends, -4 * NEVER)[last]  # of -1, the last: there is none

    @property
    def count(self) -> int:
        """The number of cells."""
        return int((self.ends - self.starts).sum())

    @property
    def lone(self) -> int | None:
        """The only cell, None if there are more or none."""
        return int(self.starts[0]) if len(self) == 1 and self.count == 1 else None

    def __repr__(self) -> str:
        return f"Cells.of({list(self)})"


#: No cells.
NONE = Cells(np.empty(0, np.int64), np.empty(0, np.int64))


@dataclass(frozen=True, slots=True, eq=False)
class StepFunction:
    """A function of cells that is constant from each of ``changes`` up to the next, and up to ``end``."""

    changes: Ints
    values: Floats
    end: int

    @classmethod
    def of_samples(cls, samples: Floats) -> StepFunction:
        """Return the function whose value at cell i is ``samples[i]``."""
        new = np.concatenate(([True], samples[1:] != samples[:-1]))
        return cls(np.flatnonzero(new), samples[new], len(samples))

    def at(self, cell: int) -> float:
        """Return the value at a cell."""
        return float(self.values[int(np.searchsorted(self.changes, cell, side="right")) - 1])

    def each(self, cells: Ints) -> Floats:
        """Return the values at several cells."""
        return self.values[np.searchsorted(self.changes, cells, side="right") - 1]

    def begins(self, cells: Ints) -> Ints:
        """Return, for each of several cells, where the stretch begins on which the value is the same."""
        return self.changes[np.searchsorted(self.changes, cells, side="right") - 1]

    def equal(self, other: StepFunction) -> Cells:
        """Return where both functions have the same value."""
        changes = merged((self.changes, other.changes))
        return Cells.where(changes, self.each(changes) == other.each(changes), self.end)

    def between(self, begin: int, end: int) -> tuple[Ints, Floats]:
        """Return the changes and values in [begin, end), which is not empty; the first change is ``begin``."""
        first = int(np.searchsorted(self.changes, begin, side="right")) - 1
        last = int(np.searchsorted(self.changes, end, side="left"))
        changes = self.changes[first:last].copy()
        changes[0] = begin
        return changes, self.values[first:last]

    def stretches(self, value: float) -> tuple[Ints, Ints]:
        """Return where the stretches begin and end on which the function has a value."""
        having = np.flatnonzero(self.values == value)
        return self.changes[having], np.append(self.changes, self.end)[having + 1]

    def mirrored(self, begin: int, end: int) -> StepFunction:
        """Return the part in [begin, end) as a function of -k."""
        changes, values = self.between(begin, end)
        stops = np.append(changes[1:], end)
        return StepFunction(1 - stops[::-1], values[::-1], 1 - begin)

    def around(self, cell: int) -> tuple[int, int]:
        """Return the stretch [start, end) around a cell on which the value is the same."""
        i = int(np.searchsorted(self.changes, cell, side="right"))
        return int(self.changes[i - 1]), int(self.changes[i]) if i < len(self.changes) else self.end

    def changed(self, cells: Cells, value: float) -> StepFunction:
        """Return the function with another value on some cells."""
        cells = cells.within(0, self.end)
        edges = np.concatenate((cells.starts, cells.ends[cells.ends < self.end]))
        new = np.setdiff1d(
            edges, self.changes[np.searchsorted(self.changes, edges).clip(max=len(self.changes) - 1)]
        )
        places = np.searchsorted(self.changes, new)
        changes = np.insert(self.changes, places, new)
        values = np.insert(self.values, places, self.each(new))
        for begin, end in zip(*np.searchsorted(changes, (cells.starts, cells.ends)), strict=True):
            values[begin:end] = value
        return StepFunction(changes, values, self.end)

    def positive(self) -> Cells:
        """Return where the value is above 0."""
        return Cells.where(self.changes, self.values > 0, self.end)


def two_valued(cells: Cells, inside: float, outside: float, end: int) -> StepFunction:
    """Return the function on [0, end) that is ``inside`` on the cells and ``outside`` elsewhere."""
    cells = cells.within(0, end)
    first = int(not len(cells) or cells.starts[0] > 0)  # whether it begins outside
    changes = np.zeros(2 * len(cells) + first, np.int64)
    changes[first::2], changes[first + 1 :: 2] = cells.starts, cells.ends
    values = np.full(len(changes), outside)
    values[first::2] = inside
    kept = changes < end
    return StepFunction(changes[kept], values[kept], end)
