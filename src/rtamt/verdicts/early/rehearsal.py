"""The first samples of a trace whose start is not known yet, taken by a back end of their own."""

from __future__ import annotations

from bisect import bisect_right
from typing import Any


class Rehearsal:
    """The first samples in the order of their times, and a back end that has taken them in any order.

    ``events`` and ``snapshots``: what their corrections are replayed on.
    """

    def __init__(self, backend: Any) -> None:
        self.backend = backend
        self.events: list[Any] = []
        self.snapshots: tuple[Any, ...] = ()
        self.times: list[float] = []
        self._places: list[int] = []

    def add(self, time: float, place: int) -> None:
        """Note a sample that was taken."""
        after = bisect_right(self.times, time)
        self.times.insert(after, time)
        self._places.insert(after, place)

    def fits(self, time: float, period: float, tolerance: float) -> bool:
        """Return whether a sample and those after it have the places that they have when all come in order."""
        after = bisect_right(self.times, time)
        if after == 0:
            return False

        def following(then: float, place: int, time: float) -> int | None:
            steps = round((time - then) / period)
            return None if abs(time - then - steps * period) > tolerance * period else place + steps

        place = following(self.times[after - 1], self._places[after - 1], time)
        if place is None or self.backend.place(time) != place:
            return False
        return after == len(self.times) or following(time, place, self.times[after]) == self._places[after]
