"""Intervals of predicates, and groups of neighbours among them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.signals.instants import NONE, Cells

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from rtamt.explain.propagate import Demands
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

    def mask(self, literal: tuple[str, int]) -> NDArray[np.bool_]:
        """Return of each interval whether it is one of a predicate and sign."""
        found: NDArray[np.bool_] = self.of == (
            self.literals.index(literal) if literal in self.literals else -1
        )
        return found

    def cells(self, literal: tuple[str, int]) -> Cells:
        """Return the cells of a predicate and sign."""
        mine = self.mask(literal)
        return Cells.union(self.starts[mine], self.ends[mine])

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
