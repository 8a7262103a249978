"""Signals of recordings that no requirement reads, for the charts of a page."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Any

from rtamt.html_report.scene_data import line_data
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.plot.lines import Line

if TYPE_CHECKING:
    from collections.abc import Collection

    from rtamt.html_report.store import Store
    from rtamt.plot.x_axis import XAxis
    from rtamt.signals.trace import Trace

#: Bytes of compressed samples of these signals in one page.
BUDGET = 16 * 2**20
#: The share of a recording's room that is kept for ranges of long lines.
_RANGES = 0.25


@dataclass(frozen=True, slots=True)
class Signals:
    """The lines of one recording as JSON can hold them, and how many the page has no room for."""

    trace: str
    lines: list[dict[str, Any]]
    ranges: int  # lines without all of their samples
    left_out: tuple[str, ...]

    @property
    def summary(self) -> str:
        """The signals that the page contains.

        >>> Signals("a.csv", [{}, {}], 1, ("z",)).summary
        '2 other signals can be added to charts (1 as ranges); without room in this page (16 MB): 1, such as z'
        """
        count = len(self.lines)
        plural = "" if count == 1 else "s"
        ranges = f" ({self.ranges} as ranges)" if self.ranges else ""
        text = f"{count} other signal{plural} can be added to charts{ranges}" if count else ""
        if not self.left_out:
            return text
        without = (
            f"without room in this page ({BUDGET >> 20} MB): {len(self.left_out)}, such as {self.left_out[0]}"
        )
        return f"{text}; {without}" if text else without


def signals_of(
    name: str, recording: Trace, known: Collection[str], x_axis: XAxis, store: Store, place: tuple[int, int]
) -> Signals:
    """Put the signals of a recording, except the ``known`` ones, into a page.

    ``place``: the number of the recording and how many there are: each has the same room. Samples fill three quarters
    of it, in the order of the recording; the rest is for ranges of the values in each part of the time.
    """
    lines: list[dict[str, Any]] = []
    left_out = []
    number, count = place
    kept = 1 - number / count
    ranges, enough = 0, kept + _RANGES / count
    for signal in recording:
        channel = recording.channel(signal)
        if signal in known or not len(channel.values):
            continue
        if not store.has_room(kept):
            left_out.append(signal)
            continue
        times: Any = channel.times
        if times is None:
            times = np.arange(len(channel.values)) * float(x_axis.recording.step)
        line = Line(signal, x_axis.positions(times), channel.values, channel.unit)
        data = line_data(line, store, enough)
        if "x" not in data:
            ranges, enough = ranges + 1, inf
        lines.append(data)
    return Signals(name, lines, ranges, tuple(left_out))
