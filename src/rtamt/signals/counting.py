"""Convert numbers to ticks and back, with products and quotients that are correctly rounded."""

from __future__ import annotations

import sys
from fractions import Fraction
from numbers import Integral

from rtamt.errors import TraceError, shown
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals.arrays import TIME

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]
    TickArray = NDArray[np.int64]

#: Timestamps keep this distance from the ends of int64, so that bounds can be added to them.
FARTHEST = 2**62

#: Up to here a product and a quotient of doubles are within half a tick of the truth; `near` in the core.
NEAR = 2**50

#: Up to here every integer is a double.
DOUBLES = 2**53

#: More than the error of a quotient of integers below 1.
_DOUBT = 2.0**-53


#: Numbers from here on are implausible as seconds (the year 5138), and the smallest plausible time since 1970
#: in another unit: the year 1973 in it.
IMPLAUSIBLE = 10**11
_LARGEST = sys.float_info.max
_SINCE_1970 = (("ns", 10**17), ("us", 10**14), ("ms", IMPLAUSIBLE))


def all_integers(times: Any) -> bool:
    """Return whether all times are integers, of Python or numpy."""
    if isinstance(times, np.ndarray) and times.dtype.kind != "O":
        return times.dtype.kind in "iu" or not len(times)
    return all(isinstance(time, Integral) for time in times)


def refuse_implausible(times: Any, name: str, first: int = 0, source: str = "") -> None:
    """Raise :class:`TraceError` at a number that is too large for seconds."""
    if isinstance(times, np.ndarray) and times.dtype.kind != "O":
        if times.dtype.kind not in "iuf" or not len(times):
            return
        if times.dtype in (np.float16, np.float32):  # which overflow in the comparison
            times = times.astype(np.float64)
        # NaN and infinities are reported elsewhere.
        if times.min() > -IMPLAUSIBLE and times.max() < IMPLAUSIBLE:
            return
    for i, time in enumerate(times):
        if is_implausible(time):
            raise implausible(name, first + i, time, source)


def is_implausible(time: Any) -> bool:
    """Return whether a time is a finite number that is too large for seconds.

    >>> is_implausible(1_700_000_000), is_implausible(1_700_000_000_123), is_implausible(1.7e12)
    (False, True, True)
    """
    plain = isinstance(time, int | float | np.integer | np.floating) and not isinstance(time, np.timedelta64)
    if isinstance(time, np.float16 | np.float32):
        time = float(time)
    elif isinstance(time, np.signedinteger) and plain:  # of which the least has no absolute value
        time = int(time)
    return plain and bool(IMPLAUSIBLE <= abs(time) <= _LARGEST)


def implausible(name: str, index: int, time: Any, source: str = "") -> TraceError:
    """Return the error for such a number where seconds are expected; ``source``: where it was read."""
    number = (
        float(time)
        if isinstance(time, np.floating)
        else time.item()
        if isinstance(time, np.generic)
        else time
    )
    unit = next(unit for unit, least in _SINCE_1970 if abs(number) >= least)
    remedy = (
        f"if it counts {unit} since 1970, say time_unit='{unit}', or on the command line --time-unit {unit}"
    )
    if abs(number) >= 2**64:
        remedy = "subtract a start time"
    return TraceError(
        f"{times_of(name)}{f' of {source}' if source else ''} is {shown(number)} at sample {index}, "
        f"too large for seconds: {remedy}",
        variable=name,
        index=index,
    )


def times_of(name: str) -> str:
    """Return the subject of a sentence about the timestamps of a signal.

    >>> times_of("x"), times_of("time")
    ("the time of 'x'", 'time')
    """
    return TIME if name == TIME else f"the time of '{name}'"


def integers(times: Any) -> NDArray[Any]:
    """Return integers and fractions as an array of int64 if that can be, else of fractions.

    Raises :class:`OverflowError` for integers beyond int64.
    """
    if isinstance(times, np.ndarray) and times.dtype.kind in "iu":
        if times.dtype.kind == "u" and len(times) and int(times.max()) >= 2**63:
            raise OverflowError
        return times.astype(np.int64)
    if all(isinstance(time, Integral) for time in times):
        return np.array(list(map(int, times)), dtype=np.int64)
    return np.array([Fraction(int(time.numerator), int(time.denominator)) for time in times], dtype=object)


def rescaled(numbers: NDArray[Any], ratio: Fraction, limit: int = FARTHEST) -> TickArray:
    """Return whole numbers times a ratio, rounded to the nearest (ties to even), without a double in between.

    Raises :class:`OverflowError` from ``limit`` on.
    """
    if not len(numbers):
        return np.empty(0, np.int64)
    largest = max(abs(int(numbers.min())), abs(int(numbers.max())))
    if largest * ratio >= limit:
        raise OverflowError
    if numbers.dtype == np.object_ or largest * ratio.numerator >= FARTHEST:
        if ratio == 1 and numbers.dtype != np.object_:
            return numbers.astype(np.int64)
        return np.array([round(Fraction(number) * ratio) for number in numbers.tolist()], dtype=np.int64)
    if ratio.denominator == 1:
        return np.array(numbers * ratio.numerator, dtype=np.int64)
    whole, rest = np.divmod(numbers * ratio.numerator, ratio.denominator)
    twice = 2 * rest
    up = (twice > ratio.denominator) | ((twice == ratio.denominator) & (whole % 2 == 1))
    return np.array(whole + up, dtype=np.int64)


def quotients(numbers: TickArray, numerator: int, denominator: int) -> FloatArray:
    """Return integers times a ratio, each rounded once, to the nearest double.

    >>> quotients(np.array([300_000_000, 1_700_000_000_009_000_000]), 1, 10**9).tolist()
    [0.3, 1700000000.009]
    """
    if not len(numbers):
        return np.empty(0)
    largest = max(abs(int(numbers.min())), abs(int(numbers.max()))) * numerator
    if largest <= DOUBLES and denominator <= DOUBLES:
        return (numbers if numerator == 1 else numbers * numerator) / denominator
    if largest >= 2**63 or denominator > DOUBLES or largest // denominator >= DOUBLES:
        return np.array([number * numerator / denominator for number in numbers.tolist()])
    # Of the whole part and the rest, both exact, the sum rounds once; the quotient of the rest has an error of
    # its own, which matters next to the middle between two doubles: there the integers are divided.
    whole, rest = np.divmod(numbers * numerator, denominator)
    high, low = whole.astype(np.float64), rest / denominator
    total: FloatArray = high + low
    lost = np.abs(low - (total - high))
    half = np.spacing(np.abs(total)) / 2
    in_doubt = (np.abs(lost - half) <= _DOUBT) | (
        np.abs(lost - half / 2) <= _DOUBT
    )  # below 2^n they are closer
    for i in np.flatnonzero(in_doubt).tolist():
        total[i] = int(numbers[i]) * numerator / denominator
    return total


def counted(numbers: FloatArray, ratio: Fraction) -> TickArray:
    """Return finite doubles times a ratio, rounded to the nearest; far from 0 as :func:`tick_of` does."""
    numerator, denominator = ratio.as_integer_ratio()
    with np.errstate(over="ignore"):
        scaled = np.rint(numbers * float(numerator) / float(denominator))
    if np.abs(scaled).max(initial=0) >= FARTHEST:
        raise OverflowError
    ticks: TickArray = scaled.astype(np.int64)
    far = np.abs(scaled) >= NEAR
    if max(numerator, denominator) >= DOUBLES:
        far[:] = True
    if not far.any():
        return ticks
    if denominator != 1 or numerator >= DOUBLES:
        ticks[far] = [round(Fraction(repr(number)) * ratio) for number in numbers[far].tolist()]
        return ticks
    whole = np.trunc(numbers)
    rest = numbers - whole
    exact = np.rint(rest * numerator).astype(np.int64)
    for grid in reversed(_grids(numerator)):
        steps = np.rint(rest * grid)
        exact = np.where(whole + steps / grid == numbers, steps.astype(np.int64) * (numerator // grid), exact)
    ticks[far] = (whole.astype(np.int64) * numerator + exact)[far]
    return ticks


def tick_of(number: float, rate: int) -> int:
    """Return a number times the ticks in 1, far from 0: the tick of the shortest decimal that prints it.

    There doubles are further apart than ticks. So that 1700000000.1 is one tenth after a whole second,
    and not 99 999 905 ns, which would miss every bound of 100 ms by a hair.
    """
    whole = int(number)
    rest = number - whole
    for grid in _grids(rate):
        steps = round(rest * grid)
        if whole + steps / grid == number:
            return whole * rate + steps * (rate // grid)
    return whole * rate + round(rest * rate)


def _grids(rate: int) -> tuple[int, ...]:
    # Adjacent doubles may be 1 024 ticks apart, so three digits are uncertain.
    return (rate // 1000, rate // 100, rate // 10) if rate % 1000 == 0 else ()
