"""The times of early monitors as the caller gives them: seconds, numbers of another unit, dates or durations."""

from __future__ import annotations

from bisect import bisect_right
from fractions import Fraction
from itertools import takewhile
from math import inf
from typing import TYPE_CHECKING, Any

from rtamt.language.units.moments import time_text
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.signals import arrays
from rtamt.signals.caller_times import CallerTimes

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

#: The number of kept times above which those that can no longer be requested are dropped.
_FEW = 64


class Timestamp(NamedTuple):
    """A time in seconds, and as the caller gave it: an array of one, None where that is the same."""

    seconds: float
    original: NDArray[Any] | None = None

    def __str__(self) -> str:
        return time_text(self.seconds, dated=arrays.are_dates(self.original))


class CallerClock:
    """Converts times to seconds for the back end, and those that it reports back.

    ``unit``: of times that are numbers, None for seconds. Only samples that are not a whole number of periods after
    one that is kept need memory. The caller of a copied monitor copies its clock, with :meth:`copied`.
    """

    def __init__(self, unit: str | None, period: Fraction) -> None:
        self._times = CallerTimes(unit, period, 0)
        self._period = period
        self._seconds: list[float] = []
        self._originals: list[NDArray[Any]] = []
        self._limit = _FEW

    @property
    def plain(self) -> bool:
        """Whether all times are numbers of seconds."""
        return self._times.plain

    @property
    def dated(self) -> bool:
        """Whether the times so far are dates."""
        return arrays.are_dates(self._times.original)

    def text(self, seconds: float) -> str:
        """Return a time in seconds, in the form of those so far, for a message."""
        return time_text(seconds, dated=self.dated)

    def copied(self) -> CallerClock:
        """Return a clock that is independent of this one."""
        copy = CallerClock(self._times.unit, self._period)
        copy._times = self._times
        copy._seconds, copy._originals = list(self._seconds), list(self._originals)
        copy._limit = self._limit
        return copy

    def read(self, time: Any, samples: int) -> Timestamp | None:
        """Return a time, None for a number of seconds; ``samples``: the number of earlier ones.

        Raises :class:`TraceError` for what is no time, or of another form than the times before.
        """
        if self.plain and (samples or not arrays.is_moment(time)):
            return None
        timestamps = self._times.read([time], samples)
        return Timestamp(float(timestamps.seconds[0]), timestamps.original)

    def take(self, stamp: Timestamp, *, begun: bool, later: Iterable[float] = ()) -> None:
        """Remember the time of a sample, the first one of its instant.

        ``begun``: whether it is known where the trace starts; until then every time is kept. ``later``: the instants
        from the next to the newest one, which keep their times.
        """
        assert stamp.original is not None
        self._times = self._times.extended(stamp.original)
        place = bisect_right(self._seconds, stamp.seconds)
        if begun and self._continues(stamp, place):
            return
        if place and self._seconds[place - 1] == stamp.seconds:  # of an instant that had no sample, perhaps
            self._originals[place - 1] = stamp.original
            return
        until = self._seconds[place] if place < len(self._seconds) else inf
        kept = [(stamp.seconds, stamp.original)]
        for each in takewhile(lambda seconds: seconds < until, later):
            original = np.array([self.time(each)])
            if original.dtype.kind == stamp.original.dtype.kind:
                kept.append((each, original))
        self._seconds[place:place] = [seconds for seconds, _ in kept]
        self._originals[place:place] = [original for _, original in kept]

    def _continues(self, stamp: Timestamp, place: int) -> bool:
        """Return whether a time follows from the one that is kept before it, in both forms."""
        if not place:
            return False
        earlier = self._seconds[place - 1]
        steps = round((stamp.seconds - earlier) / float(self._period))
        if stamp.original is None or earlier + steps * float(self._period) != stamp.seconds:
            return False
        return bool(self._after(self._originals[place - 1], steps) == stamp.original[0])

    def extend(self, stamp: Timestamp) -> None:
        """Note the form of a time that is not kept."""
        assert stamp.original is not None
        self._times = self._times.extended(stamp.original)

    def forget(self, earliest: float) -> None:
        """Forget times that are not needed for any time from ``earliest`` on."""
        first = bisect_right(self._seconds, earliest) - 1
        if first > 0:
            del self._seconds[:first], self._originals[:first]
        self._limit = max(_FEW, 2 * len(self._seconds))

    @property
    def full(self) -> bool:
        """Whether :meth:`forget` should be called."""
        return len(self._seconds) > self._limit

    def time(self, seconds: float) -> Any:
        """Return the time of a sample, or of one that is missing, as the caller would give it."""
        if not self._seconds:
            return seconds
        place = max(0, bisect_right(self._seconds, seconds) - 1)
        steps = round((seconds - self._seconds[place]) / float(self._period))
        return self._after(self._originals[place], steps)

    def _after(self, original: NDArray[Any], steps: int) -> Any:
        """Return a time some periods after one that is kept."""
        value = original[0]
        if steps == 0:
            return value if value.dtype.kind in "mM" else arrays.plain(value)
        span = steps * self._times.period_in_unit(value.dtype)
        if value.dtype.kind in "mM":
            return value + np.timedelta64(round(span), "ns")
        later = Fraction(arrays.plain(value)) + span
        return int(later) if value.dtype.kind == "i" and later.denominator == 1 else float(later)
