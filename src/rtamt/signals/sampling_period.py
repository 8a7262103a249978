"""Timestamps one sampling period apart: the period inferred, and the checks of order and distance."""

from __future__ import annotations

from abc import ABC, abstractmethod
from decimal import Decimal
from fractions import Fraction

from rtamt.errors import TraceError, UsageError, shown
from rtamt.language.units.durations import NANOSECOND, UNITS, format_duration
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals.arrays import TIME, is_number

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from rtamt.signals.arrays import FloatArray, Timestamps

#: How far, as a fraction of the period, the gap between two samples may be from the period.
TOLERANCE = 0.1
#: Gaps, in seconds, that differ by less are the same numbers of nanoseconds.
_NO_DIFFERENCE = 5e-10
#: A period that differs from a gap by such a fraction is the gap, rounded.
_SAME = 1e-5
#: From this precision on, as a fraction of a gap, all timestamps together have a better one than their median gap.
_COARSE = 1e-4
#: A period of a lower precision, as a fraction of it, is not inferred.
_UNCERTAIN = 1e-2
#: Up to this precision, as a fraction of it, the mean gap of timestamps that were rounded to a unit is the period.
_ROUNDED = 1e-3


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


def infer_period(times: Timestamps, exact: FloatArray | None = None) -> Fraction:
    """Return the median gap, or the mean gap of rounded timestamps, as a short decimal; 1 s for a single sample.

    It is the shortest decimal within the precision of the gap. Timestamps that are rounded limit that: doubles since
    1970 to about 0.2 µs, floats of 32 bits at 1000 s to 61 µs, whole milliseconds to 1 ms. Where the precision is low,
    and the timestamps are regular but for their rounding, the mean gap is taken, which is more precise by their number.
    ``exact``: the times as :func:`elapsed` returns them. Their gaps are exact unless they were made of doubles, which
    shows in gaps that differ and yet add up to a period with fewer digits.

    Raises :class:`TraceError` where rounding leaves the period uncertain.
    """
    seconds = times.seconds
    if len(seconds) < 2:
        return Fraction(1)
    known = seconds if exact is None else exact
    gaps = np.diff(known)
    gap = _median(gaps)
    mean = _mean_of_rounded(known, gaps) if _differ(gaps, gap) else None
    if mean is not None:
        return mean
    coarse, blur = _rounded_period(times)
    if known is not seconds:
        differ = float(np.abs(gaps - gap).max())
        if differ <= _NO_DIFFERENCE:
            short = _shortest(gap, _precision(gap, seconds))
            return short if abs(float(short) - gap) <= _SAME * gap else _shortest(gap, _precision(gap, known))
        off = abs(float(coarse) * len(gaps) - float(known[-1]))
        if blur > _UNCERTAIN * coarse or off > _precision(gap, seconds) + 2 * differ:
            return _shortest(gap, _precision(gap, known))
    if blur > _UNCERTAIN * coarse:
        raise _uncertain(times, coarse)
    return coarse


def _differ(gaps: FloatArray, gap: float) -> bool:
    return bool((np.abs(gaps - gap) > 1e-6 * gap).any())


def _mean_of_rounded(times: FloatArray, gaps: FloatArray) -> Fraction | None:
    """Return the mean gap of timestamps that were rounded to a unit: whole milliseconds of 60 Hz are 16 or 17 ms apart.

    The gaps then have two lengths, one unit apart, or three after rounding twice, and the timestamps are near regular
    ones. None for others, and where the mean gap is not much more precise than a gap.
    """
    short, range_ = float(gaps.min()), float(gaps.max() - gaps.min())
    mean = float(times[-1] - times[0]) / len(gaps)
    blur = max(1e-6 * mean, 2 * range_ / len(gaps))
    noise = _precision(mean, times)
    if range_ <= noise or blur > _ROUNDED * mean:
        return None
    step = range_ / 2
    more = gaps - short
    if (np.abs(more - np.rint(more / step) * step) > noise).any():
        return None
    off = np.abs(times - times[0] - mean * np.arange(len(times))).max()
    return _shortest(mean, blur) if off <= range_ + noise else None


def _rounded_period(times: Timestamps) -> tuple[Fraction, float]:
    """Return the period that rounded timestamps show, and its precision."""
    seconds = times.seconds
    gaps = np.diff(seconds)
    gap = _median(gaps)
    spacing = _spacing(times, _differ(gaps, gap))
    blur = max(1e-6 * gap, 2 * spacing)
    if blur > _COARSE * gap:
        mean = float(seconds[-1] - seconds[0]) / len(gaps)
        if np.abs(seconds - seconds[0] - mean * np.arange(len(seconds))).max() <= 1.5 * spacing:
            gap, blur = mean, max(1e-6 * mean, 2 * spacing / len(gaps))
    return _shortest(gap, blur), blur


def _spacing(times: Timestamps, differ: bool) -> float:
    """Return the distance between neighbouring numbers of the timestamps' format; ``differ``: whether the gaps do."""
    seconds = float(np.abs(times.seconds).max())
    numbers = times.original
    if differ and numbers.dtype.kind == "f" and _are_single(numbers):
        largest = float(np.abs(numbers).max())
        return float(np.spacing(np.float32(largest))) * (seconds / largest)
    return float(np.spacing(seconds))


def _are_single(numbers: NDArray[Any]) -> bool:
    """Return whether doubles were floats of 32 bits, which shows in their digits.

    Whole numbers are such floats as well, and other numbers with few digits; half of those that were rounded need the
    last bit.
    """
    with np.errstate(over="ignore"):
        single = numbers.astype(np.float32)
    if not np.array_equal(single, numbers) or np.array_equal(np.rint(numbers), numbers):
        return False
    return 8 * int(np.count_nonzero(single.view(np.int32) & 1)) >= len(single)


def _uncertain(times: Timestamps, period: Fraction) -> TraceError:
    """Return the error for timestamps that are too coarse for their period."""
    spacing, last = _spacing(times, differ=True), float(np.abs(times.seconds).max())
    return TraceError(
        f"the sampling period is about {float(period):.2g} s, but the timestamps resolve only {spacing:.2g} s at "
        f"{last:.15g} s: give the period (period=, --period), or timestamps of a higher precision",
        variable=TIME,
    )


def _shortest(gap: float, blur: float) -> Fraction:
    """Return the shortest decimal within the precision of a gap."""
    for digits in range(1, 17):
        short = float(f"{gap:.{digits}g}")
        if abs(short - gap) <= blur:
            return Fraction(repr(short))
    return Fraction(repr(gap))


def _median(gaps: FloatArray) -> float:
    """Return the median; that of numpy loads ``numpy.ma``, which takes as long as a short recording."""
    high = len(gaps) // 2
    if len(gaps) % 2:
        return float(np.partition(gaps, high)[high])
    lower, upper = np.partition(gaps, (high - 1, high))[high - 1 : high + 1].tolist()
    return float(lower + upper) / 2


def _precision(gap: float, times: FloatArray) -> float:
    """Return the precision of a gap between timestamps in doubles."""
    return max(1e-6 * gap, 2 * float(np.spacing(np.abs(times).max())))


def has_period(times: FloatArray, period: Fraction) -> bool:
    """Return whether more than half of the gaps are a period: so is then the median of chunks of which all are so.

    A gap for which :func:`infer_period` has a decimal with fewer digits is not this period.

    >>> has_period(np.array([0, 1, 2, 2.5]), Fraction(1)), has_period(np.array([0, 1, 1.5]), Fraction(1))
    (True, False)
    """
    if len(times) < 2:
        return True
    gap, gaps = float(period), np.diff(times)
    blur = _precision(gap, times)
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
        f"dense time (--time dense)",
        variable=TIME,
        index=index,
        time=time,
    )
