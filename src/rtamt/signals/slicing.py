"""Cut a channel to the times of a slice."""

from __future__ import annotations

from fractions import Fraction

from rtamt.errors import TraceError, UsageError, shown
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rtamt.signals.trace import Channel


def sliced(name: str, channel: Channel, times: slice) -> Channel:
    """Return the samples of a channel from one time to the other, both included."""
    if times.step is not None:
        raise UsageError(
            "a slice of a trace takes two times; put it on another time base with resample(period=...)"
        )
    if channel.times is None:
        raise TraceError(f"'{name}' has no timestamps, so that it has no times to slice", variable=name)
    low, high = (_bound(end, channel.times.dtype) for end in (times.start, times.stop))
    inside = _inside(channel.times, low, high)
    kept, values = channel.times[inside], channel.values[inside]
    table = None if channel.table is None else channel.table[_inside(channel.table, low, high)]
    if table is None or len(table) == len(kept):  # the gaps are outside
        return replace(channel, times=kept, values=values, first_gap=None, table=None)
    first_gap = int(np.isin(table, kept, assume_unique=True, invert=True).argmax())
    return replace(channel, times=kept, values=values, first_gap=first_gap, table=table)


def _inside(times: NDArray[Any], low: Any, high: Any) -> NDArray[np.bool_]:
    inside = np.ones(len(times), dtype=bool)
    inside &= True if low is None else times >= low
    inside &= True if high is None else times <= high
    return inside


def _bound(end: Any, dtype: np.dtype[Any]) -> Any:
    """Return an end of a slice as times of this type; None where it is open."""
    if end is None:
        return None
    try:
        if dtype.kind == "M":
            return np.datetime64(end, "ns")
        if dtype.kind == "m":
            return (
                end
                if isinstance(end, np.timedelta64)
                else np.timedelta64(round(Fraction(str(end)) * 10**9), "ns")
            )
        return float(end)
    except (TypeError, ValueError):
        kind = "a date such as '2026-05-01T12:00'" if dtype.kind == "M" else "a number of seconds"
        raise UsageError(f"{shown(end)} cannot begin or end a slice of this trace; give {kind}") from None
