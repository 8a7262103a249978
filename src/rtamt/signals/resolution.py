"""The precision of timestamps, and the mean gap of those that were rounded.

Seconds since 1970 in doubles resolve 0.2 µs, floats of 32 bits 61 µs at 1000 s, and whole milliseconds 1 ms.
"""

from __future__ import annotations

from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals.sampling_period import precision

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rtamt.signals.arrays import FloatArray, Timestamps

#: Up to this precision, as a fraction of it, the mean gap of timestamps that were rounded to a unit is the period.
_ROUNDED = 1e-2


class Period(NamedTuple):
    """A sampling period in seconds, and between which numbers it lies."""

    length: float
    least: float
    most: float

    @property
    def blur(self) -> float:
        """How far the period may be from its length."""
        return max(self.most - self.length, self.length - self.least)


def spacing_of(times: Timestamps, *, differ: bool) -> float:
    """Return the distance between neighbouring numbers of the timestamps' format; ``differ``: whether the gaps do.

    That of dates and integers is the one of the doubles that they may have been made of.
    """
    seconds = float(np.abs(times.seconds[[0, -1]]).max())
    numbers = times.original
    if differ and numbers.dtype.kind == "f" and are_single(numbers):
        largest = float(np.abs(numbers[[0, -1]]).max())
        return float(np.spacing(np.float32(largest))) * (seconds / largest)
    return float(np.spacing(seconds))


def are_single(numbers: NDArray[Any]) -> bool:
    """Return whether doubles were floats of 32 bits, which shows in their digits.

    Whole numbers are such floats as well, and other numbers with few digits; half of those that were rounded need the
    last bit.
    """
    with np.errstate(over="ignore"):
        single = numbers.astype(np.float32)
    if not np.array_equal(single, numbers) or np.array_equal(np.rint(numbers), numbers):
        return False
    return 8 * int(np.count_nonzero(single.view(np.int32) & 1)) >= len(single)


def rounded_period(times: FloatArray, gaps: FloatArray) -> Period | None:
    """Return the period of timestamps that were rounded to a unit: whole milliseconds of 60 Hz are 16 or 17 ms apart.

    The gaps then have two lengths, one unit apart, or three after rounding twice, and the timestamps are near regular
    ones. None for others, and where the mean gap is not much more precise than a gap.
    """
    short, range_ = float(gaps.min()), float(gaps.max() - gaps.min())
    mean = float(times[-1] - times[0]) / len(gaps)
    noise = precision(mean, times)
    if range_ <= noise or 2 * range_ / len(gaps) > _ROUNDED * mean:
        return None
    step = range_ / 2
    more = gaps - short
    if (np.abs(more - np.rint(more / step) * step) > noise).any():
        return None
    return mean_period(times, range_ + noise)


def mean_period(times: FloatArray, near: float) -> Period | None:
    """Return the mean gap if all timestamps lie near those that follow the first in equal gaps; else None.

    They also do for the other periods between the limits, or these are one millionth away from the mean.
    """
    since, index = times[1:] - times[0], np.arange(1, len(times))
    mean = float(since[-1]) / len(since)
    least, most = float(((since - near) / index).max()), float(((since + near) / index).min())
    if not least <= mean <= most:
        return None
    return Period(mean, min(least, mean - 1e-6 * mean), max(most, mean + 1e-6 * mean))
