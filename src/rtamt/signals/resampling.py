"""Signals at other instants: those of a regular grid, or those of other signals."""

from __future__ import annotations

from fractions import Fraction
from math import ceil, floor

from rtamt.errors import TraceError, UsageError, choices
from rtamt.language.units.durations import duration, format_duration
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals.listing import show_time
from rtamt.signals.sampling_period import merged

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.signals.arrays import FloatArray

    Times = NDArray[Any]

#: Ways of filling in what lies between two samples.
HOW = ("hold", "linear")

#: How many units in the last place a time may be off: 3 * 0.1 s lies behind 0.3 s. Less than half a nanosecond is
#: always rounding, since clocks count nanoseconds.
ROUNDINGS, LEAST = 4, 4e-10

#: How many instants are made at once: 2 GiB for the values of a signal.
MOST_INSTANTS = 2**28


def grid_of(timed: Sequence[Times], period: str | float | Fraction, how: str) -> Times:
    """Return instants ``period`` apart, from the first at which all signals have a value; see ``Trace.resample``."""
    if how not in HOW:
        raise UsageError(f"cannot resample by '{how}'{choices(how, HOW, 'methods')}")
    step = duration(period)
    if step <= 0:
        raise UsageError(f"the sampling period is {period!r}; it must be positive")
    start = max(exact_time(times[0]) for times in timed)
    last = (max if how == "hold" else min)(exact_time(times[-1]) for times in timed)
    if last < start:
        raise TraceError("the signals have no instant in common")
    count = floor((last - start + _nearness(last, step, timed[0].dtype)) / step) + 1
    return _grid(start, step, count, timed[0].dtype)


def resampled(
    name: str,
    times: Times,
    values: FloatArray,
    grid: Times,
    how: str,
    hold_for: Fraction | None = None,
    step: Fraction | None = None,
) -> tuple[FloatArray, list[str]]:
    """Return the values of a signal at the instants of a grid, and a note on samples that they leave out.

    ``hold_for``: raise :class:`TraceError` if the last value is older (seconds). ``step``: the distance of the
    instants, if they are apart by a period: a time that differs from one by the rounding of a double is that instant.
    """
    until = grid + _rounding(grid, step) if step is not None and grid.dtype.kind == "f" else grid
    places = np.searchsorted(times, until, side="right") - 1
    if how == "hold" and hold_for is not None:
        _check_ages(name, times[places], grid, hold_for)
    if how == "hold":
        return values[places], _skipped_note(name, places, len(times))
    # Differences first: timestamps of 10^18 ns do not fit into a double, their differences do.
    found = np.interp(_plain(grid - times[0]), _plain(times - times[0]), values)
    between = times[places] != grid
    both = np.concatenate((places, np.minimum(places[between] + 1, len(times) - 1)))
    return found, _skipped_note(name, both, len(times))


class Sampler:
    """Takes signals in chunks, each with its own samples, and gives their values at the instants of a grid.

    The grid is that of :func:`grid_of`; an instant is reported once every signal has a sample there, or later.
    ``hold_for``: as for :func:`resampled`. ``stepped``: the signals that are held whatever ``how``.
    """

    def __init__(
        self,
        names: Sequence[str],
        period: str | float | Fraction,
        how: str,
        hold_for: Fraction | None = None,
        stepped: Collection[str] = (),
    ) -> None:
        self._stepped = stepped
        self._step, self._how, self._hold_for = duration(period), how, hold_for
        self._pending: dict[str, tuple[Times, FloatArray]] = {}
        self._names = names
        self._start: Fraction | None = None
        self._count = 0

    def take(
        self, chunk: Mapping[str, tuple[Times, FloatArray]]
    ) -> tuple[Times, dict[str, FloatArray]] | None:
        """Return the new instants of a chunk with the values of all signals; None if there are none.

        The first time these are two instants at least, from which the period can be inferred.
        """
        timed = self._add(chunk)
        if not timed:
            return None
        last = min(exact_time(times[-1]) for times in timed)
        return self._up_to(last, 1 if self._count else 2)

    def take_at(
        self, now: Any, chunk: Mapping[str, tuple[Times, FloatArray]]
    ) -> tuple[Times, dict[str, FloatArray]] | None:
        """Return the instants before ``now`` and their values, when no earlier sample can arrive.

        Raises :class:`TraceError` if a value is too old; instants up to ``now`` are then left out.
        """
        return self._up_to(exact_time(now), 1, closed=False) if self._add(chunk) else None

    def finish(self) -> tuple[Times, dict[str, FloatArray]] | None:
        """Return the rest, up to the last sample of any signal; the last values hold."""
        timed = self._add({})
        return self._up_to(max(exact_time(times[-1]) for times in timed), 1) if timed else None

    def _add(self, chunk: Mapping[str, tuple[Times, FloatArray]]) -> list[Times]:
        """Take samples; return the times of all signals that are still needed, none if a signal has no sample yet."""
        for name, (times, values) in chunk.items():
            before = self._pending.get(name)
            self._pending[name] = (
                (times, values)
                if before is None
                else (np.concatenate((before[0], times)), np.concatenate((before[1], values)))
            )
        if not all(name in self._pending and len(self._pending[name][0]) for name in self._names):
            return []
        timed = [times for times, _ in self._pending.values()]
        if self._start is None:
            self._start = max(exact_time(times[0]) for times in timed)
        return timed

    def _up_to(
        self, end: Fraction, least: int, *, closed: bool = True
    ) -> tuple[Times, dict[str, FloatArray]] | None:
        """Return the instants up to ``end`` and the values there; None if there are fewer than ``least``."""
        assert self._start is not None
        dtype = next(iter(self._pending.values()))[0].dtype
        steps, near = (end - self._start) / self._step, _nearness(end, self._step, dtype) / self._step
        until = max(self._count, floor(steps + near) + 1 if closed else ceil(steps - near))
        count, first = until - self._count, self._count
        if count < least:
            return None
        self._count = until
        grid = _grid(self._start + first * self._step, self._step, count, dtype)
        found = {}
        for name, (times, values) in self._pending.items():
            how = "hold" if name in self._stepped else self._how
            found[name], _ = resampled(name, times, values, grid, how, self._hold_for, self._step)
            place = int(np.searchsorted(times, grid[-1], side="right")) - 1
            self._pending[name] = times[place:], values[place:]
        return grid, found


def _skipped_note(name: str, places: NDArray[np.intp], count: int) -> list[str]:
    """Return the note on samples that were skipped by resampling, after the first one used."""
    read = merged([places])
    left_out = count - int(read[0]) - len(read)
    if not left_out:
        return []
    return [
        f"resampling left out {left_out:,} of {count:,} sample{'s' * (count != 1)} of {name}, between those it took"
    ]


def _check_ages(name: str, times: Times, grid: Times, hold_for: Fraction) -> None:
    ages = _plain(grid - times) / (1e9 if grid.dtype.kind in "mM" else 1.0)
    near = float(hold_for) - 1e-6  # times of doubles are no more exact
    for i in np.flatnonzero(ages > near).tolist():
        if exact_time(grid[i]) - exact_time(times[i]) > hold_for:
            raise TraceError(
                f"'{name}' has no sample from {show_time(times[i])} to {show_time(grid[i])}, longer than the "
                f"{format_duration(hold_for)} for which a value is held: fill the gap, or hold it for longer",
                variable=name,
            )


def exact_time(time: Any) -> Fraction:
    """Return a time in seconds: a float means the shortest decimal that prints it."""
    if isinstance(time, np.datetime64 | np.timedelta64):
        return Fraction(int(time.astype(np.int64)), 10**9)
    return Fraction(repr(float(time)))


def _rounding(times: Any, step: Fraction) -> Any:
    """Return how far, in seconds, a time may lie from an instant of a grid of doubles and still be that instant.

    Never so far that it could be another instant.
    """
    near = np.maximum(ROUNDINGS * np.spacing(np.abs(times)), LEAST)
    return np.minimum(near, float(step) / 4)


def _nearness(time: Fraction, step: Fraction, dtype: np.dtype[Any]) -> Fraction:
    return Fraction(float(_rounding(float(time), step))) if dtype.kind == "f" else Fraction(0)


def _grid(start: Fraction, step: Fraction, count: int, dtype: np.dtype[Any]) -> Times:
    """Return ``count`` timestamps of kind ``dtype``, each correctly rounded; raise :class:`TraceError` at too many."""
    if count > MOST_INSTANTS:
        since, until = (_time_of(start + i * step, dtype) for i in (0, count - 1))
        raise TraceError(
            f"resampling every {format_duration(step)} from {show_time(since)} to {show_time(until)} makes {count:,} "
            f"samples, more than {MOST_INSTANTS:,}: divide the recording at its gaps, or choose a longer period"
        )
    if dtype.kind == "f":
        scale = step.denominator * start.denominator
        zero, gap = int(start * scale), int(step * scale)
        if max(abs(zero), abs(zero + gap * count), scale) < 2**53:
            return (zero + gap * np.arange(count)) / scale
        return np.array([float(start + i * step) for i in range(count)])
    first, each = start * 10**9, step * 10**9
    if each.denominator != 1:
        raise UsageError(
            f"the period {step} s is no whole number of nanoseconds, in which the timestamps are counted"
        )
    timestamps = int(first) + int(each) * np.arange(count, dtype=np.int64)
    return timestamps.astype(dtype)


def _time_of(instant: Fraction, dtype: np.dtype[Any]) -> Any:
    return float(instant) if dtype.kind == "f" else np.array(int(instant * 10**9)).astype(dtype)[()]


def _plain(gaps: Times) -> FloatArray:
    return (gaps.astype(np.int64) if gaps.dtype.kind == "m" else gaps).astype(np.float64)
