"""The sampling period that timestamps show."""

from __future__ import annotations

from fractions import Fraction

from rtamt.errors import TraceError
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING
from rtamt.signals.arrays import TIME
from rtamt.signals.resolution import Period, mean_period, rounded_period, spacing_of
from rtamt.signals.sampling_period import precision

if TYPE_CHECKING:
    from rtamt.signals.arrays import FloatArray, Timestamps

#: Gaps, in seconds, that differ by less are the same numbers of nanoseconds.
_NO_DIFFERENCE = 5e-10
#: A period that differs from a gap by such a fraction is the gap, rounded.
_SAME = 1e-5
#: From this precision on, as a fraction of a gap, all timestamps together have a better one than their median gap.
_COARSE = 1e-4
#: A period of a lower precision, as a fraction of it, is not inferred.
_UNCERTAIN = 1e-2


def infer_period(times: Timestamps, exact: FloatArray | None = None) -> Fraction:
    """Return the median gap, or the mean gap of rounded timestamps, as a short decimal; 1 s for a single sample.

    It is the shortest decimal within the precision of the gap. Timestamps that are rounded limit that: doubles since
    1970 to about 0.2 µs, floats of 32 bits at 1000 s to 61 µs, whole milliseconds to 1 ms. Where the precision is low,
    and the timestamps are regular but for their rounding, the mean gap is taken, which is more precise by their number.
    ``exact``: the times as :func:`~rtamt.signals.sampling_period.elapsed` returns them. Their gaps are exact unless
    they were made of doubles, which shows in gaps that differ and yet add up to a period with fewer digits.

    Raises :class:`TraceError` where rounding leaves the period uncertain.
    """
    seconds = times.seconds
    if len(seconds) < 2:
        return Fraction(1)
    known = seconds if exact is None else exact
    gaps = np.diff(known)
    gap = _median(gaps)
    rounded = rounded_period(known, gaps) if _differ(gaps, gap) else None
    if rounded is not None:
        return _shortest(rounded)
    coarse = _coarse_period(times, known)
    found = _shortest(coarse)
    if known is not seconds:
        differ = float(np.abs(gaps - gap).max())
        if differ <= _NO_DIFFERENCE:
            short = _shortest(_near(gap, seconds))
            return short if abs(float(short) - gap) <= _SAME * gap else _shortest(_near(gap, known))
        off = abs(float(found) * len(gaps) - float(known[-1]))
        if coarse.blur > _UNCERTAIN * coarse.length or off > precision(gap, seconds) + 2 * differ:
            return _shortest(_near(gap, known))
    if coarse.blur > _UNCERTAIN * coarse.length:
        raise _uncertain(times, found)
    return found


def _differ(gaps: FloatArray, gap: float) -> bool:
    return bool((np.abs(gaps - gap) > 1e-6 * gap).any())


def _coarse_period(times: Timestamps, known: FloatArray) -> Period:
    """Return the period that timestamps in a format of low precision show."""
    seconds = times.seconds
    gaps = np.diff(seconds)
    gap = _median(gaps)
    spacing = spacing_of(times, differ=_differ(gaps, gap))
    blur = max(1e-6 * gap, 2 * spacing)
    # Integers made of doubles were rounded twice: to seconds, and in the product, whose spacing is as large.
    near = 1.5 * spacing if known is seconds else 3 * spacing
    mean = mean_period(known, near) if blur > _COARSE * gap else None
    return Period(gap, gap - blur, gap + blur) if mean is None else mean


def _uncertain(times: Timestamps, period: Fraction) -> TraceError:
    """Return the error for timestamps that are too coarse for their period."""
    spacing, last = spacing_of(times, differ=True), float(np.abs(times.seconds).max())
    return TraceError(
        f"the sampling period is about {float(period):.2g} s, but the timestamps resolve only {spacing:.2g} s at "
        f"{last:.15g} s: give the period (period=, --period), or timestamps of a higher precision",
        variable=TIME,
    )


def _shortest(period: Period) -> Fraction:
    """Return the shortest decimal within the precision of a period."""
    for digits in range(1, 17):
        short = float(f"{period.length:.{digits}g}")
        if period.least <= short <= period.most:
            return Fraction(repr(short))
    return Fraction(repr(period.length))


def _near(gap: float, times: FloatArray) -> Period:
    """Return a gap between timestamps in doubles with its precision."""
    blur = precision(gap, times)
    return Period(gap, gap - blur, gap + blur)


def _median(gaps: FloatArray) -> float:
    """Return the median; that of numpy loads ``numpy.ma``, which takes as long as a short recording."""
    high = len(gaps) // 2
    if len(gaps) % 2:
        return float(np.partition(gaps, high)[high])
    lower, upper = np.partition(gaps, (high - 1, high))[high - 1 : high + 1].tolist()
    return float(lower + upper) / 2
