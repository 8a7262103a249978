"""A trace as text: its signals topic by topic, their units and extents, and what was noted about them."""

from __future__ import annotations

from fractions import Fraction
from itertools import groupby

from rtamt.language.units.moments import show_date
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals.datetimes import nanoseconds_of
from rtamt.signals.epoch import date_text, is_epoch, moment_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rtamt.signals.trace import Channel, Trace


def listing(trace: Trace) -> str:
    """Return the text of ``print(trace)``."""
    lines = [heading(trace), *(f"  {note}" for note in notes(trace))]
    rows = [row for topic, channels in topics(trace) for row in _rows(topic, channels)]
    width = max((len(label) for label, _ in rows), default=0)
    return "\n".join(lines + [f"  {label:<{width}}  {rest}".rstrip() for label, rest in rows])


def html(trace: Trace) -> str:
    """Return the representation in Jupyter: the notes, and a table of the signals, topic by topic."""
    from html import escape

    lines = [f"<p>{escape(line)}</p>" for line in (heading(trace), *notes(trace))]
    rows = [
        f"<tr><td>{escape(name)}</td><td>{escape(channel.unit)}</td><td>{escape(extent(channel))}</td></tr>"
        for name in trace.names
        for channel in [trace.channel(name)]
    ]
    return "".join(
        [*lines, "<table><tr><th>signal</th><th>unit</th><th>samples</th></tr>", *rows, "</table>"]
    )


def heading(trace: Trace) -> str:
    """Return where a trace is from, how many signals it has, and from when to when."""
    count = len(trace.names)
    span = "" if trace.start is None else f", {show_time(trace.start)} to {show_time(trace.end)}"
    return f"Trace of {trace.source}: {count} signal{'s' * (count != 1)}{span}"


def notes(trace: Trace) -> list[str]:
    """Return the notes on what was inferred or left out, and on the clock: its date at time 0, or its absence."""
    found = [] if trace.origin is None else [f"time 0 is {trace.origin} UTC"]
    if trace.names and all(trace.channel(name).times is None for name in trace.names):
        found.append("no column holds timestamps: samples are one period apart")
    return [*found, *trace.notes]


def topics(trace: Trace) -> Iterator[tuple[str, dict[str, Channel]]]:
    """Yield the topics of a log with their signals; the topic of ``gps.lat`` is gps, and "" that of a single signal."""
    for topic, names in groupby(trace.names, lambda name: name.partition(".")[0]):
        channels = {name: trace.channel(name) for name in names}
        yield (topic if len(channels) > 1 else ""), channels


def _rows(topic: str, channels: Mapping[str, Channel]) -> Iterator[tuple[str, str]]:
    """Yield the label of each signal and its extent; an extent that all signals share stands with the topic."""
    extents = {extent(channel) for channel in channels.values()}
    shared = bool(topic) and len(extents) == 1
    if topic:
        yield topic, f"{len(channels)} signals" + (f", each {extents.pop()}" if shared else "")
    for name, channel in channels.items():
        unit = f" [{channel.unit}]" if channel.unit else ""
        source = f"({channel.column})" if channel.column not in ("", name, f"{name}{unit}") else ""
        label = f"  {name}{unit}" if topic else f"{name}{unit}"
        yield label, "  ".join(filter(None, ("" if shared else extent(channel), source)))


def extent(channel: Channel) -> str:
    """Return the number of samples of a signal, and its extent in time."""
    count = len(channel.values)
    text = f"{count:,} sample{'s' * (count != 1)}"
    if channel.times is None or not count:
        return text
    return f"{text}, {show_time(channel.times[0])} to {show_time(channel.times[-1])}"


def show_time(time: Any, start: Any = None) -> str:
    """Return one time as text: seconds, nanoseconds or a date, with ``start`` and the seconds since then.

    >>> show_time(np.float64(2.5)), show_time(np.timedelta64(7, "ns"))
    ('2.5 s', '7 ns')
    >>> begin = np.timedelta64(1_700_000_000_000_000_000, "ns")
    >>> show_time(begin), show_time(begin + np.timedelta64(2, "s"), begin)
    ('2023-11-14 22:13:20', '2023-11-14 22:13:22 (+2 s)')
    """
    since, begin = _since_1970(time), _since_1970(start)
    if since is not None and begin is not None:
        return moment_text(since, begin)
    if isinstance(time, np.datetime64):
        return show_date(time)
    if since is not None:
        return date_text(since)
    return f"{time.astype(np.int64)} ns" if isinstance(time, np.timedelta64) else f"{time:.12g} s"


def _since_1970(time: Any) -> Fraction | None:
    """Return the seconds of a time that counts from 1970, and None of another one."""
    if time is None:
        return None
    if not isinstance(time, np.datetime64 | np.timedelta64):
        return Fraction(repr(float(time))) if is_epoch(float(time)) else None
    seconds = Fraction(nanoseconds_of(time) or 0, 10**9)
    return seconds if isinstance(time, np.datetime64) or is_epoch(seconds) else None
