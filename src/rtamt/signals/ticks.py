"""Dense time is counted in int64 ticks; here is how a caller's times become ticks, and ticks times again.

====================================================  ==================  =========================
what a time is                                        kind                what comes back
====================================================  ==================  =========================
a number of Python, a float of numpy                  ``"seconds"``       float64
an integer of numpy: alone, in a list, in an array    ``"nanoseconds"``   int64
a datetime, ``numpy.datetime64``, ``pandas.Timestamp``  ``"datetimes"``   datetime64
the same with a time zone                             ``"zoned"``         datetime64, in UTC
a timedelta, ``numpy.timedelta64``                    ``"timedeltas"``    timedelta64
a number in a unit that was agreed on before          ``"units"``         int where whole, else float
====================================================  ==================  =========================
"""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime, timedelta
from fractions import Fraction
from numbers import Integral, Rational
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.errors import TraceError, shown
from rtamt.language.units import UNITS, decimal, format_duration
from rtamt.signals import arrays
from rtamt.signals.datetimes import nanoseconds_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rtamt.signals.arrays import FloatArray

    TickArray = NDArray[np.int64]

#: One tick, unless the caller chooses another: a nanosecond.
NANOSECOND = UNITS["ns"]

#: Stamps stay this far from the ends of int64, so that bounds can be added to them.
FARTHEST = 2**62

#: Up to here a product of doubles is within half a tick of the truth.
NEAR = 2**51

#: How messages call the kinds.
KINDS = MappingProxyType(
    {
        "seconds": "seconds",
        "nanoseconds": "nanoseconds (integers of numpy)",
        "datetimes": "datetimes",
        "zoned": "datetimes with a time zone",
        "timedeltas": "timedeltas",
        "units": "numbers",
    }
)

_OF_DTYPE = {"i": "nanoseconds", "u": "nanoseconds", "M": "datetimes", "m": "timedeltas"}


@dataclass(frozen=True, slots=True)
class TimeScale:
    """How the caller tells time, and how long a tick is.

    ``tick``: seconds. ``kind``: a row of the module's table. ``unit``: seconds in one of the caller's
    numbers, for the kinds that are numbers of Python.
    """

    tick: Fraction
    kind: str
    unit: Fraction = UNITS["s"]
    #: ``tick / unit`` as two doubles: an online answer must not wait for fractions.
    _ratio: tuple[float, float] = field(init=False, repr=False, compare=False)
    #: By what ticks are divided to be the caller's times; None where they are told in another way.
    rate: float | None = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        numerator, denominator = (self.tick / self.unit).as_integer_ratio()
        object.__setattr__(self, "_ratio", (float(numerator), float(denominator)))
        divided = self.kind == "seconds" and numerator == 1
        object.__setattr__(self, "rate", float(denominator) if divided else None)

    def ticks(self, times: Any, name: str, first: int = 0) -> TickArray:
        """Return times as ticks, rounded to the nearest; raise :class:`TraceError` where that cannot be.

        ``times``: as :func:`sequence_of` returns them. Integers are exact. ``first`` is the index of
        ``times[0]`` in the recording of ``name``, for messages.
        """
        try:
            plain = times.__class__ is np.ndarray and times.dtype == np.float64
            if plain and self.kind == "seconds" and self.unit == 1:
                found = self._plain(times)
                if found is not None:
                    return found
            self._require_kind(times, name, first)
            if self.kind in ("seconds", "units"):
                return self._of_numbers(times, name, first)
            if self.kind == "nanoseconds":
                return _rescaled(_integers(times), NANOSECOND / self.tick)
            return self._of_dates(times, name, first)
        except OverflowError:
            raise self.too_far(name) from None

    def _plain(self, numbers: FloatArray) -> TickArray | None:
        """Return the ticks of seconds that do not decrease and are near 0; None where there are others."""
        rate, whole = float(self.tick.denominator), float(self.tick.numerator)
        bound = NEAR * whole / rate
        # In order, all are as near as the first and the last; NaN is in no order.
        if not len(numbers) or not -bound < numbers[0] <= numbers[-1] < bound:
            return None
        if not np.logical_and.reduce(numbers[1:] >= numbers[:-1]):
            return None
        scaled: FloatArray = np.rint(numbers * rate / whole)
        return scaled.astype(np.int64)

    def _require_kind(self, times: Any, name: str, first: int) -> None:
        kinds = kinds_of(times)
        if self.kind == "units":
            kinds = {("seconds" if kind == "nanoseconds" else kind): i for kind, i in kinds.items()}
            if set(kinds) - {"seconds"}:
                raise self._not_numbers(times, name, first)
        if self.kind == "zoned" and isinstance(times, np.ndarray) and times.dtype.kind == "M":
            return  # as times() tells them: in UTC
        if len(kinds) > 1:
            (a, i), (b, j) = list(kinds.items())[:2]
            raise TraceError(
                f"'{name}' tells time in {KINDS[a]} at sample {first + i} and in {KINDS[b]} at sample "
                f"{first + j}: use one of them for all",
                variable=name,
                index=first + j,
            )
        for kind in kinds:
            if self.kind not in ("units", kind):
                raise TraceError(
                    f"'{name}' tells time in {KINDS[kind]}, but others in {KINDS[self.kind]}: "
                    f"use one of them for all",
                    variable=name,
                )

    def _of_numbers(self, times: Any, name: str, first: int) -> TickArray:
        ratio = self.unit / self.tick
        if not _are_numbers(times):
            raise self._not_numbers(times, name, first)
        exact = _exact(times)
        if exact.all():
            return _rescaled(_integers(times), ratio)
        numbers = np.asarray(times).astype(np.float64)
        finite = np.isfinite(numbers)
        if not finite.all():
            i = int((~finite).argmax())
            raise not_finite(name, first + i, float(numbers[i]))
        ticks = _counted(numbers, ratio)
        if exact.any():  # an integer is exact, whatever stands beside it
            ticks[exact] = _rescaled(
                _integers([t for t, is_exact in zip(times, exact.tolist(), strict=True) if is_exact]), ratio
            )
        return ticks

    def _of_dates(self, times: Any, name: str, first: int) -> TickArray:
        dated = np.asarray(times)
        if dated.dtype.kind not in "mM":
            moments = [nanoseconds_of(time) for time in times]
            missing = [i for i, moment in enumerate(moments) if moment is None]
            if missing:
                raise not_finite(name, first + missing[0], times[missing[0]])
            return _rescaled(np.array(moments, dtype=object), NANOSECOND / self.tick)
        absent = np.isnat(dated)
        if absent.any():
            i = int(absent.argmax())
            raise not_finite(name, first + i, dated[i])
        unit, count = np.datetime_data(dated.dtype)
        if unit not in UNITS:  # days and longer in seconds, which are exact; picoseconds and shorter in ns
            unit, count = ("ns" if unit in ("ps", "fs", "as") else "s"), 1
            dated = dated.astype(f"{dated.dtype.kind}8[{unit}]")
        return _rescaled(dated.astype(np.int64), UNITS[unit] * count / self.tick)

    def _not_numbers(self, times: Any, name: str, first: int) -> TraceError:
        i, time = next((i, time) for i, time in enumerate(times) if not arrays.is_number(time))
        expected = "a number" if self.kind == "units" else "a number of seconds or a datetime"
        return TraceError(
            f"the time of '{name}' is {shown(time)} at sample {first + i}, expected {expected}",
            variable=name,
            index=first + i,
        )

    def too_far(self, name: str) -> TraceError:
        """Return the error for a time that ticks cannot hold."""
        return TraceError(
            f"'{name}' has a time too far from 0 for ticks of {format_duration(self.tick)}: "
            f"subtract a start time, or choose a coarser resolution",
            variable=name,
        )

    def times(self, ticks: TickArray) -> NDArray[Any]:
        """Return ticks as the caller tells time, in the type that the module's table says."""
        if self.kind == "seconds":
            # One division by a whole number rounds once: 300 ms come back as 0.3.
            numerator, denominator = self._ratio
            return (ticks if numerator == 1 else ticks * numerator) / denominator
        if self.kind == "units":
            scaled = [tick * self.tick / self.unit for tick in ticks.tolist()]
            numbers = [int(t) if t.denominator == 1 else float(t) for t in scaled]
            return np.array(numbers, dtype=object)
        if self.kind == "nanoseconds":
            return _rescaled(ticks, self.tick / NANOSECOND)
        farthest = int(np.abs(ticks).max(initial=0)) * self.tick
        fits = [unit for unit, size in UNITS.items() if farthest / size < FARTHEST]
        unit = fits[-1]  # the finest that holds them
        dtype = f"{'m' if self.kind == 'timedeltas' else 'M'}8[{unit}]"
        return _rescaled(ticks, self.tick / UNITS[unit]).astype(dtype)

    def show(self, tick: int) -> str:
        """Return a tick for a message."""
        time = self.times(np.array([tick], dtype=np.int64))[0]
        if self.kind == "nanoseconds":
            return f"{time} ns"
        if self.kind in ("datetimes", "zoned"):
            return str(time)
        unit = next((name for name, size in UNITS.items() if size == self.unit), "s")
        # To the last tick: stamps that count from 1970 differ in their last digits.
        return f"{decimal(tick * self.tick / self.unit) or f'{float(time):.12g}'} {unit}"


def kind_of(times: Any) -> str:
    """Return the kind of the first of some times, ``"seconds"`` where there are none."""
    return next(iter(kinds_of(times)), "seconds")


def kinds_of(times: Any) -> dict[str, int]:
    """Return the kinds of times that there are, each with the index of its first; what is no time is a number."""
    if isinstance(times, np.ndarray) and times.dtype.kind != "O":
        return {_OF_DTYPE.get(times.dtype.kind, "seconds"): 0} if len(times) else {}
    found: dict[str, int] = {}
    plain = (float, int)
    for i, time in enumerate(times):
        kind = "seconds" if time.__class__ in plain else _kind_of_one(time)
        if kind not in found:
            found[kind] = i
    return found


def _kind_of_one(time: Any) -> str:
    if isinstance(time, np.timedelta64 | timedelta):
        return "timedeltas"  # before integers: numpy derives its own from them
    if isinstance(time, np.integer):
        return "nanoseconds"
    if isinstance(time, datetime):
        return "datetimes" if time.tzinfo is None else "zoned"
    return "datetimes" if isinstance(time, np.datetime64) else "seconds"


def sequence_of(times: Any, name: str) -> Any:
    """Return times as an array or a list; raise :class:`TraceError` where they are no sequence."""
    is_array = hasattr(times, "__array__")
    if not hasattr(times, "__iter__") or (is_array and np.ndim(times) != 1):
        raise TraceError(
            f"the times of '{name}' are {shown(times)}, expected a sequence of times", variable=name
        )
    # As a list, times of pandas keep their zones.
    zoned = getattr(getattr(times, "dtype", None), "tz", None) is not None
    return np.asarray(times) if is_array and not zoned else list(times)


def all_integers(times: Any) -> bool:
    """Tell whether every one of some times is an integer, of Python or of numpy."""
    return all(isinstance(time, Integral) for time in times)


def _are_numbers(times: Any) -> bool:
    if isinstance(times, np.ndarray) and times.dtype.kind in "fiub":
        return True
    return set(map(type, times)) <= {float, int} or all(map(arrays.is_number, times))


def _exact(times: Any) -> NDArray[np.bool_]:
    """Tell which of the times are integers or fractions."""
    if isinstance(times, np.ndarray) and times.dtype.kind != "O":
        return np.full(len(times), times.dtype.kind in "iu")
    types = set(map(type, times))
    if types <= {float} or types <= {int}:
        return np.full(len(times), types != {float})
    return np.array([isinstance(time, Rational) for time in times])


def _integers(times: Any) -> NDArray[Any]:
    """Return integers and fractions as an array of int64 if that can be, else of objects."""
    if isinstance(times, np.ndarray) and times.dtype.kind == "i":
        return times.astype(np.int64)
    if set(map(type, times)) <= {int}:
        return np.array(times, dtype=np.int64)
    return np.array([Fraction(int(time.numerator), int(time.denominator)) for time in times], dtype=object)


def _rescaled(numbers: NDArray[Any], ratio: Fraction) -> TickArray:
    """Return whole numbers times a ratio, rounded to the nearest (ties to even), without a double in between.

    Raises :class:`OverflowError` beyond :data:`FARTHEST`.
    """
    if not len(numbers):
        return np.empty(0, np.int64)
    largest = max(abs(int(numbers.min())), abs(int(numbers.max())))
    if largest * ratio >= FARTHEST:
        raise OverflowError
    if numbers.dtype == np.object_ or largest * ratio.numerator >= FARTHEST:
        return np.array([round(Fraction(number) * ratio) for number in numbers.tolist()], dtype=np.int64)
    if ratio.denominator == 1:
        return np.array(numbers * ratio.numerator, dtype=np.int64)
    whole, rest = np.divmod(numbers * ratio.numerator, ratio.denominator)
    twice = 2 * rest
    up = (twice > ratio.denominator) | ((twice == ratio.denominator) & (whole % 2 == 1))
    return np.array(whole + up, dtype=np.int64)


def _counted(numbers: FloatArray, ratio: Fraction) -> TickArray:
    """Return finite doubles times a ratio, rounded to the nearest; far from 0 as :func:`tick_of` does."""
    with np.errstate(over="ignore"):
        scaled = np.rint(numbers * float(ratio.numerator) / float(ratio.denominator))
    far = np.abs(scaled) >= NEAR
    if not far.any():
        return scaled.astype(np.int64)
    if np.abs(scaled).max() >= FARTHEST:
        raise OverflowError
    ticks = scaled.astype(np.int64)
    if ratio.denominator != 1:
        return ticks
    rate = ratio.numerator
    whole = np.trunc(numbers)
    rest = numbers - whole
    exact = np.rint(rest * rate).astype(np.int64)
    for grid in reversed(_grids(rate)):
        steps = np.rint(rest * grid)
        exact = np.where(whole + steps / grid == numbers, steps.astype(np.int64) * (rate // grid), exact)
    ticks[far] = (whole.astype(np.int64) * rate + exact)[far]
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
    # Stamps may be as much as 1 024 ticks apart from the next double, so three digits are in doubt.
    return (rate // 1000, rate // 100, rate // 10) if rate % 1000 == 0 else ()


def date_of(seconds: float) -> np.datetime64:
    """Return seconds since 1970 as a date, to the last digit with which the number prints.

    >>> date_of(1767225600.1)
    np.datetime64('2026-01-01T00:00:00.100000000')
    """
    return np.datetime64(tick_of(seconds, 10**9), "ns")


def not_finite(name: str, index: int, time: Any) -> TraceError:
    """Return the error for a time that is none."""
    return TraceError(
        f"the time of '{name}' is {time} at sample {index}: give a finite time", variable=name, index=index
    )
