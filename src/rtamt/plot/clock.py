"""The times of a recording, as positions on an axis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.signals.arrays import stamps
from rtamt.signals.discrete import DiscreteTrace

if TYPE_CHECKING:
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.dense import DenseTrace

#: Stamps that start later than this many seconds are told from their start on.
_FAR = 1e5


@dataclass(frozen=True, slots=True)
class Clock:
    """Positions are seconds after ``origin``: a date, or a number of seconds (0, unless stamps start far from it)."""

    origin: float | np.datetime64
    recording: DiscreteTrace | DenseTrace

    @staticmethod
    def of(recording: DiscreteTrace | DenseTrace) -> Clock:
        """Return the clock of a recording."""
        if isinstance(recording, DiscreteTrace):
            first = float(recording.times[0])
            if recording.dated:
                return Clock(recording.stamps[0], recording)
            return Clock(first if abs(first) > _FAR else 0.0, recording)
        start = recording.scale.times(np.array([recording.start], np.int64))[0]
        if isinstance(start, np.datetime64):
            return Clock(start, recording)
        seconds = float(recording.start * recording.scale.tick)
        return Clock(seconds if abs(seconds) > _FAR else 0.0, recording)

    def positions(self, times: Any) -> FloatArray:
        """Return times, as signals and explanations tell them, as positions."""
        recording = self.recording
        if isinstance(recording, DiscreteTrace):
            seconds = stamps(times, recording.unit).seconds
            return seconds - recording.times[0] if self.origin else seconds
        return self.ticked(recording.scale.ticks(times, "time"))

    def ticked(self, ticks: Any) -> FloatArray:
        """Return ticks of dense time as positions."""
        assert not isinstance(self.recording, DiscreteTrace)
        zero = self.recording.start if self.origin else 0
        tick = self.recording.scale.tick  # nearly always 1/n: one division rounds once
        seconds: FloatArray = (np.asarray(ticks, np.int64) - zero) * float(tick.numerator) / tick.denominator
        return seconds

    def position(self, time: Any) -> float:
        """Return one time as a position."""
        return float(self.positions(np.asarray([time]))[0])

    def told(self, position: float) -> str:
        """Return a position as text: a date, or seconds.

        >>> Clock(np.datetime64("2026-03-01T12:00:00.000000000"), None).told(2.5)
        '2026-03-01 12:00:02.5'
        """
        if isinstance(self.origin, np.datetime64):
            moment = str(self.origin + np.timedelta64(round(position * 1e9), "ns"))
            return moment.replace("T", " ").rstrip("0").rstrip(".") if "." in moment else moment
        return f"{self.origin + position:.15g} s"

    @property
    def end(self) -> float:
        """The last instant that was recorded."""
        if isinstance(self.recording, DiscreteTrace):
            return self.position(self.recording.times[-1])
        return float(self.ticked([self.recording.end])[0])

    @property
    def start(self) -> float:
        """The first instant at which the formula is evaluated."""
        if isinstance(self.recording, DiscreteTrace):
            return self.position(self.recording.times[0])
        return float(self.ticked([self.recording.start])[0])

    @property
    def label(self) -> str:
        """What stands at the axis."""
        if isinstance(self.origin, np.datetime64):
            return "time"
        return f"seconds after {self.origin:.15g} s" if self.origin else "time [s]"
