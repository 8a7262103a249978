"""The first samples of a trace whose start is not known yet, taken by a back end of their own."""

from __future__ import annotations

from bisect import bisect_right
from typing import Any


class Rehearsal:
    """The first samples in the order of their times, and a back end that has taken them in any order.

    ``latest``: how many samples may come before the first one, unless each of them needs a new back end.
    ``events`` and ``snapshots``: what their corrections are replayed on.
    """

    def __init__(self, backend: Any, latest: int | None = None) -> None:
        self.backend = backend
        self.events: list[Any] = []
        self.snapshots: tuple[Any, ...] = ()
        self.times: list[float] = []
        self._places: list[int] = []
        self._begins_anywhere = latest is not None and backend.begin_at(latest)

    def add(self, time: float, place: int) -> None:
        """Note a sample that was taken."""
        after = bisect_right(self.times, time)
        self.times.insert(after, time)
        self._places.insert(after, place)

    def number(self, place: int, new: int) -> int:
        """Return the number, from the earliest sample on, of what the back end has at a place; ``new`` is added."""
        return place - min([new, *self._places[:1]])

    def fits(self, time: float, period: float, tolerance: float) -> bool:
        """Return whether a sample and those after it have the places that they have when all come in order."""
        after = bisect_right(self.times, time)

        def following(then: float, place: int, time: float) -> int | None:
            steps = round((time - then) / period)
            return None if abs(time - then - steps * period) > tolerance * period else place + steps

        place = self.backend.place(time)
        if place is None or place <= self.backend.closed:
            return False
        if after == 0:
            if not self._begins_anywhere:
                return False
        elif following(self.times[after - 1], self._places[after - 1], time) != place:
            return False
        return after == len(self.times) or following(time, place, self.times[after]) == self._places[after]
