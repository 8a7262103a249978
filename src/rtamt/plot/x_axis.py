"""The times of a recording, as positions on an axis."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.signals.datetimes import nanoseconds_of
from rtamt.signals.epoch import is_epoch, moment_text

if TYPE_CHECKING:
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.time_domain_interface import DomainTrace

#: Timestamps that start later than this many seconds are counted from their start.
_FAR = 1e5


@dataclass(frozen=True, slots=True)
class XAxis:
    """Positions are seconds after ``origin``: a date, or a number of seconds (0, unless timestamps start far from it).

    Numbers of seconds that are a time since 1970 are a date.
    """

    origin: float | np.datetime64
    recording: DomainTrace

    @staticmethod
    def of(recording: DomainTrace) -> XAxis:
        """Return the x axis of a recording."""
        origin = recording.origin
        if isinstance(origin, np.datetime64):
            return XAxis(origin, recording)
        if is_epoch(origin):
            return XAxis(np.datetime64(round(origin * 10**9), "ns"), recording)
        return XAxis(0.0 if abs(origin) <= _FAR else float(origin), recording)

    def positions(self, times: Any) -> FloatArray:
        """Return times, of signals and explanations as positions."""
        return self.recording.seconds(times, elapsed=self._elapsed)

    def recorded(self, name: str) -> tuple[FloatArray, FloatArray]:
        """Return the positions and the values of a variable."""
        return self.recording.points(name, elapsed=self._elapsed)

    @property
    def _elapsed(self) -> bool:
        """Whether positions count from the first instant."""
        return bool(self.origin)

    def position(self, time: Any) -> float:
        """Return one time as a position."""
        return float(self.positions(np.asarray([time]))[0])

    def text(self, position: float) -> str:
        """Return a position as text: a date and the seconds since the start, or seconds.

        >>> XAxis(np.datetime64("2026-03-01T12:00:00.000000000"), None).text(2.5)
        '2026-03-01 12:00:02.5 (+2.5 s)'
        """
        if isinstance(self.origin, np.datetime64):
            start = Fraction(nanoseconds_of(self.origin) or 0, 10**9)
            # Positions are differences of numbers near 1e9, which doubles hold to less than a microsecond.
            return moment_text(start + Fraction(round(position * 1e6), 10**6), start)
        return f"{self.origin + position:.15g} s"

    @property
    def end(self) -> float:
        """The last instant that was recorded."""
        return self.recording.ends(elapsed=self._elapsed)[1]

    @property
    def start(self) -> float:
        """The first instant at which the formula is evaluated."""
        return self.recording.ends(elapsed=self._elapsed)[0]

    @property
    def label(self) -> str:
        """The label of the axis."""
        if isinstance(self.origin, np.datetime64):
            return "time"
        return f"seconds after {self.origin:.15g} s" if self.origin else "time [s]"


def visible(
    axis: XAxis, start: Any = None, end: Any = None, window: tuple[float, float] | None = None
) -> tuple[float, float]:
    """Return the positions from one time to another; by default those of ``window``, or else all.

    Raises :class:`UsageError` if there is nothing in between.
    """
    low, high = window or (axis.start, axis.end)
    low = low if start is None else axis.position(start)
    high = high if end is None else axis.position(end)
    if low > high or high < axis.start or low > axis.end:
        ends = f"{axis.text(axis.start)} to {axis.text(axis.end)}"
        raise UsageError(
            f"there is nothing to plot from {axis.text(low)} to {axis.text(high)}; the trace lasts from {ends}"
        )
    return max(low, axis.start), min(high, axis.end)
