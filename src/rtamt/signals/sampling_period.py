"""Timestamps one sampling period apart: the checks of order and distance."""

from __future__ import annotations

from abc import ABC, abstractmethod
from decimal import Decimal

from rtamt.errors import TraceError, UsageError, shown
from rtamt.language.units.durations import NANOSECOND, UNITS, format_duration
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals.arrays import TIME, is_number

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from numpy.typing import NDArray

    from rtamt.signals.arrays import FloatArray, Timestamps

#: How far, as a fraction of the period, the gap between two samples may be from the period.
TOLERANCE = 0.1


class DeferredTimes(ABC):
    """Timestamps in seconds that become an array on first use; the array cannot be written."""

    __slots__ = ("_array", "_count")

    _array: FloatArray | None
    _count: int

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, index: Any) -> Any:
        return self.array[index]

    @property
    def array(self) -> FloatArray:
        """The timestamps."""
        if self._array is None:
            times = self._made()
            times.flags.writeable = False
            self._array = times
        return self._array

    @abstractmethod
    def _made(self) -> FloatArray:
        """Return the timestamps in an array of its own, which is then made read-only."""


class RegularTimes(DeferredTimes):
    """Timestamps one period apart from 0 s on.

    >>> from fractions import Fraction
    >>> RegularTimes(3, Fraction(1, 2)).array
    array([0. , 0.5, 1. ])
    """

    __slots__ = ("_period",)

    def __init__(self, count: int, period: Fraction) -> None:
        self._count = count
        self._period = period
        self._array = None

    def _made(self) -> FloatArray:
        times = np.arange(self._count, dtype=np.float64)
        if self._period != 1:
            times *= float(self._period)
        return times


class StoredTimes(DeferredTimes):
    """Timestamps that are the last row of a recording: of a bytearray, or a list of arrays."""

    __slots__ = ("_rows",)

    def __init__(self, count: int, rows: Any) -> None:
        self._count = count
        self._rows = rows
        self._array = None

    def __reduce__(self) -> tuple[Any, ...]:
        return StoredTimes, (self._count, [self.array])

    def forget_columns(self) -> None:
        """Keep nothing of the recording but its last row, where rows are arrays of their own."""
        if self._rows.__class__ is list:
            self._rows = self._rows[-1:]

    def _made(self) -> FloatArray:
        rows = self._rows
        if rows.__class__ is list:
            array: FloatArray = rows[-1].view()
            return array
        return np.frombuffer(rows, np.float64)[-self._count :]


def merged(times: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Return all timestamps of arrays that are in order, each once, in order.

    A stable sort merges such arrays in linear time; ``numpy.unique`` of a million integers takes seconds.

    >>> merged([np.array([0, 3, 4]), np.array([3, 3, 5])])
    array([0, 3, 4, 5])
    """
    joined = np.sort(np.concatenate(times), kind="stable")
    return joined[np.concatenate(([True], joined[1:] != joined[:-1]))[: len(joined)]]


def check_tolerance(tolerance: Any) -> None:
    """Raise :class:`UsageError` unless ``tolerance`` is a fraction of the period, 0 or more."""
    if not is_number(tolerance) or not tolerance >= 0:
        raise UsageError(f"the tolerance is {shown(tolerance)}; give a fraction of the period, 0 or more")


def elapsed(times: Timestamps, unit: str | None = None) -> FloatArray:
    """Return seconds since the first timestamp, of dates, durations and integers each rounded once.

    Seconds since 1970 are rounded to 0.2 µs, so that the gaps between them are not those of the timestamps. Times that
    are doubles already are returned as they are. ``unit``: of integers.

    >>> from rtamt.signals.arrays import timestamps
    >>> dates = np.datetime64("2023-11-14T22:13:20", "ns") + np.array([0, 20_833, 41_666])
    >>> elapsed(timestamps(dates)).tolist()
    [0.0, 2.0833e-05, 4.1666e-05]
    """
    from rtamt.signals.counting import quotients

    original = times.original
    if not len(original) or original.dtype.kind not in ("mMi" if unit else "mM"):
        return times.seconds
    numbers = original.view(np.int64)
    if int(numbers.max()) - int(numbers.min()) >= 2**63:  # also of a missing time
        return times.seconds
    size = NANOSECOND if original.dtype.kind in "mM" else UNITS[str(unit)]
    return quotients(numbers - numbers[0], *size.as_integer_ratio())


def precision(gap: float, times: FloatArray) -> float:
    """Return the precision of a gap between timestamps in doubles."""
    return max(1e-6 * gap, 2 * float(np.spacing(np.abs(times[[0, -1]]).max())))


def has_period(times: FloatArray, period: Fraction) -> bool:
    """Return whether more than half of the gaps are a period: so is then the median of chunks of which all are so.

    A gap for which :func:`~rtamt.signals.inferred_period.infer_period` has a decimal with fewer digits is not this
    period.

    >>> from fractions import Fraction
    >>> has_period(np.array([0, 1, 2, 2.5]), Fraction(1)), has_period(np.array([0, 1, 1.5]), Fraction(1))
    (True, False)
    """
    if len(times) < 2:
        return True
    gap, gaps = float(period), np.diff(times)
    blur = precision(gap, times)
    same = np.abs(gaps - gap) <= blur
    # With one digit less. All gaps with a shorter decimal lie on one side, so that the median is not among them.
    step = coarse_place(gap)
    same &= np.abs(gaps - np.round(gaps / step) * step) > 1.001 * blur
    return 2 * int(same.sum()) > len(gaps)


def coarse_place(gap: float) -> float:
    """Return the value of one unit in the last digit of a number, with one significant digit less.

    >>> coarse_place(0.25), coarse_place(20.0)
    (0.1, 100.0)
    """
    exponent = Decimal(repr(gap)).normalize().as_tuple().exponent
    assert isinstance(exponent, int)
    return float(10.0**exponent) * 10


def check_increasing(
    times: FloatArray,
    before: float | None = None,
    first: int = 0,
    *,
    dated: bool = False,
    exact: FloatArray | None = None,
) -> None:
    """Raise :class:`TraceError` unless times are finite and increase strictly, also from ``before`` on.

    ``first`` is the index of ``times[0]`` in the whole recording, and ``dated`` whether the caller's times are dates,
    for the message. ``exact``: the times as :func:`elapsed` returns them, if they are known.
    """
    finite = np.isfinite(times)
    if not finite.all():
        i = int((~finite).argmax())
        raise TraceError(
            f"time is {times[i]} at sample {first + i}: give a finite number of seconds",
            variable=TIME,
            index=first + i,
        )
    if before is not None and len(times) and times[0] <= before:
        raise not_increasing(first, float(times[0]), before, dated=dated)
    steps = np.diff(times if exact is None else exact)
    if (steps <= 0).any():
        i = int((steps <= 0).argmax()) + 1
        if before is None and len(steps) > 1 and not steps.any():
            raise never_set(float(times[0]), len(times))
        raise not_increasing(first + i, float(times[i]), float(times[i - 1]), dated=dated)


def never_set(time: float, count: int, name: str = TIME) -> TraceError:
    """Return the error for timestamps that are all equal."""
    return TraceError(
        f"all {count} timestamps of '{name}' are {time:.15g} s, so they were never set: choose another column of "
        f"timestamps (time=, --time-column), or none ('')",
        variable=name,
    )


def not_increasing(index: int, time: float, before: float, *, dated: bool = False) -> TraceError:
    """Return the error for a timestamp that is not later than its predecessor; ``dated``: whether both are dates."""
    from rtamt.language.units.moments import time_text

    now, then = time_text(time, dated=dated), time_text(before, dated=dated)
    return TraceError(
        f"time does not increase at sample {index}: {now} comes after {then}; "
        f"sort the samples and drop repeated timestamps",
        variable=TIME,
        index=index,
        time=time,
    )


def check_regular(
    times: FloatArray,
    period: Fraction,
    tolerance: float = TOLERANCE,
    before: float | None = None,
    first: int = 0,
    *,
    dated: bool = False,
    exact: FloatArray | None = None,
) -> None:
    """Raise :class:`TraceError` where the gap to the sample before is not one period (within tolerance).

    ``dated``, ``exact``: as for :func:`check_increasing`; exact times have none before.
    """
    whole = times if before is None else np.concatenate(([before], times))
    step = float(period)
    gaps = np.diff(whole if exact is None else exact)
    off = np.abs(gaps - step) > tolerance * step
    if off.any():
        i = int(off.argmax())
        index = first + i + (before is None)
        raise irregular(index, float(whole[i + 1]), float(gaps[i]), period, tolerance, dated=dated)


def irregular(
    index: int, time: float, gap: float, period: Fraction, tolerance: float, *, dated: bool = False
) -> TraceError:
    """Return the error for a sample that is not one period after the one before; ``dated``: whether times are dates."""
    from rtamt.language.units.moments import time_text

    return TraceError(
        f"sample {index} at {time_text(time, dated=dated)} is {gap:g} s after the one before, expected "
        f"{format_duration(period)} (within {tolerance:.0%}): give the right period, resample the trace, or use "
        f"dense time (time='dense', on the command line --time dense)",
        variable=TIME,
        index=index,
        time=time,
    )
