"""How many samples several signals in dense time have together: the instants at which at least one has a sample."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.lazy.modules import np
from rtamt.signals.sampling_period import merged

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from rtamt.signals.dense_arrays import Samples
    from rtamt.signals.ticks import TickArray


class SampleCount:
    """The number of instants at which at least one of some variables has a sample, chunk by chunk.

    The samples of each variable are in order, but one variable may be chunks behind another: the instants at which a
    variable may still have a sample are kept.

    >>> count = SampleCount(["x", "y"])
    >>> count.take({"x": (np.array([0, 1, 2]), np.zeros(3)), "y": (np.array([2]), np.zeros(1))})
    >>> count.take({"y": (np.array([3, 4]), np.zeros(2))})
    >>> count.take({"x": (np.array([4]), np.zeros(1))})
    >>> count.total
    5
    """

    def __init__(self, names: Iterable[str]) -> None:
        self._last: dict[str, int | None] = dict.fromkeys(names)
        #: Instants that are counted, after the earliest last sample: in order, each part after the one before.
        self._counted: list[TickArray] = []
        self.total = 0

    def take(self, samples: Mapping[str, Samples]) -> None:
        """Take the next samples of any variables; others than those of this count are skipped."""
        given = {name: samples[name][0] for name in self._last if name in samples and len(samples[name][0])}
        if not given:
            return
        ticks = _union(list(given.values()))
        if self._counted and ticks[0] <= self._counted[-1][-1]:
            known = sum(map(len, self._counted))
            self._counted = [merged([*self._counted, ticks])]
            self.total += len(self._counted[0]) - known
        else:
            self._counted.append(ticks)
            self.total += len(ticks)
        self._last.update({name: int(own[-1]) for name, own in given.items()})
        self._forget()

    def _forget(self) -> None:
        """Forget the instants up to which all variables are known."""
        ends = [last for last in self._last.values() if last is not None]
        if len(ends) == len(self._last):
            later = [part[int(part.searchsorted(min(ends), "right")) :] for part in self._counted]
            self._counted = [part for part in later if len(part)]


def _union(several: list[TickArray]) -> TickArray:
    """Return all instants of arrays in order; columns of one table mostly have the same."""
    first, *others = several
    different = [each for each in others if not np.array_equal(each, first)]
    return merged([first, *different]) if different else first
