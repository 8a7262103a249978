"""Signals that end long before the recording does, such as those of a sensor that failed: their last value is held."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.signals.trace import in_seconds

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.signals.trace import Channel

#: How many times the longest pause between two samples a signal may be silent at the end of a recording.
_PAUSES = 10
#: Signals with fewer samples, such as a map that is sent once, have no pauses to compare with.
_FEWEST = 3


@dataclass(slots=True)
class _Pace:
    """The samples of a table so far, in seconds: the last one, and the longest pause between two."""

    name: str
    count: int
    last: float
    longest: float


class Silences:
    """The ends of tables with separate timestamps, chunk by chunk."""

    def __init__(self) -> None:
        self._paces: dict[int, _Pace] = {}

    def take(self, table: int, channels: Mapping[str, Channel]) -> None:
        """Take the signals of a table, or of a chunk of it."""
        for name, channel in channels.items():
            if channel.times is not None and len(channel.times):
                seconds = in_seconds(channel.times)
                if not np.isfinite(seconds).all():
                    return  # evaluation rejects such times
                pace = self._paces.setdefault(table, _Pace(name, 0, float(seconds[0]), 0.0))
                pauses = np.diff(seconds, prepend=pace.last)
                pace.count, pace.last = pace.count + len(seconds), float(seconds[-1])
                pace.longest = max(pace.longest, float(pauses.max()))
                return

    def losses(self) -> list[str]:
        """Return a note for each table that ends long before the last one."""
        end = max((pace.last for pace in self._paces.values()), default=0.0)
        return [
            f"{pace.name} has no sample in the last {end - pace.last:.6g} s of the recording: its last value is held"
            for pace in self._paces.values()
            if pace.count >= _FEWEST and end - pace.last > _PAUSES * pace.longest
        ]
