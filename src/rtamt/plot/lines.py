"""Lines to draw: values over positions, and the stretches on which something fails."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from rtamt.lazy.dataclasses import dataclass, field, replace
from rtamt.lazy.modules import np
from rtamt.signals.sampling_period import merged

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from rtamt.signals.arrays import FloatArray

#: A half-open stretch of positions.
Range = tuple[float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """Values at positions, which increase; in dense time each holds until the next.

    ``names``: of values, such as the members of an enumeration.
    """

    name: str
    positions: FloatArray
    values: FloatArray
    unit: str = ""
    names: Mapping[float, str] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def label(self) -> str:
        """The name, with the unit if it is known."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    def at(self, position: float) -> float:
        """Return the value at a position, or before it."""
        i = int(np.searchsorted(self.positions, position, side="right")) - 1
        return float(self.values[max(i, 0)])

    def between(self, start: float, end: float, *, dense: bool) -> Line:
        """Return the part of the line from ``start`` to ``end``; in dense time the value before then holds there.

        >>> line = Line("x", np.array([0.0, 2.0, 4.0]), np.array([1.0, 5.0, 3.0]))
        >>> line.between(1, 3, dense=True).positions.tolist(), line.between(1, 3, dense=False).positions.tolist()
        ([1.0, 2.0], [2.0])
        """
        first, last = (int(i) for i in np.searchsorted(self.positions, (start, end), side="left"))
        last += int(last < len(self.positions) and self.positions[last] == end)
        positions, values = self.positions[first:last], self.values[first:last]
        if dense and first > 0 and (first == last or positions[0] > start):
            positions, values = np.append(start, positions), np.append(self.values[first - 1], values)
        return replace(self, positions=positions, values=values)

    def decimated(self, columns: int) -> Line:
        """Return the visible points of a line if there is room for some columns of points.

        Of the points in each column the first, the lowest, the highest and the last are kept, so that no
        peak is lost.

        >>> line = Line("x", np.arange(1000.0), np.where(np.arange(1000) == 501, 9.0, 0.0))
        >>> small = line.decimated(10)
        >>> len(small.positions) <= 40, float(small.values.max())
        (True, 9.0)
        """
        n = len(self.positions)
        if n <= 4 * columns:
            return self
        starts = self.columns(columns)
        stops = np.r_[starts[1:], n]
        sizes = np.diff(starts, append=n)
        lowest = self._first(
            self.values == np.repeat(np.minimum.reduceat(self.values, starts), sizes), starts
        )
        highest = self._first(
            self.values == np.repeat(np.maximum.reduceat(self.values, starts), sizes), starts
        )
        kept = merged([starts, stops - 1, lowest, highest])
        return replace(self, positions=self.positions[kept], values=self.values[kept])

    def columns(self, count: int) -> NDArray[np.int64]:
        """Return the index of the first point in each of ``count`` equal parts of the time that has points."""
        edges = np.linspace(self.positions[0], self.positions[-1], count + 1)[:-1]
        return merged([np.searchsorted(self.positions, edges)])

    @staticmethod
    def _first(wanted: NDArray[np.bool_], starts: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the first selected index in each column; every column has one."""
        where = np.flatnonzero(wanted)
        found: NDArray[np.int64] = where[np.searchsorted(where, starts)]
        return found


def ranges(line: Line, wanted: NDArray[np.bool_], *, dense: bool, end: float) -> tuple[Range, ...]:
    """Return the intervals in which ``wanted`` is true of a line's points.

    In dense time a point's value holds until the next one; in discrete time a sample is drawn as wide as
    the way to its neighbours, half of it on each side.
    """
    padded = np.r_[False, wanted, False].astype(np.int8)
    firsts = np.flatnonzero(np.diff(padded) == 1)
    lasts = np.flatnonzero(np.diff(padded) == -1) - 1
    if dense:
        stops = np.r_[line.positions[1:], max(end, line.positions[-1])]
        return tuple(zip(line.positions[firsts].tolist(), stops[lasts].tolist(), strict=True))
    between = (line.positions[1:] + line.positions[:-1]) / 2
    half = (line.positions[-1] - line.positions[0]) / (2 * (len(line.positions) - 1)) if len(between) else 0.5
    edges = np.r_[line.positions[0] - half, between, line.positions[-1] + half]
    return tuple(zip(edges[firsts].tolist(), edges[lasts + 1].tolist(), strict=True))
