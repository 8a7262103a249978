"""Convert the caller's times to int64 ticks, in which dense time is counted, and back.

======================================================  ==================  ==========================
type of the time                                        kind                type of the result
======================================================  ==================  ==========================
a number, of seconds                                    ``"seconds"``       float64
an integer, of the unit in ``time_unit=``               ``"whole"``         int64 where whole, else float64
any other number, of the unit in ``time_unit=``         ``"numbers"``       float64
a datetime, ``numpy.datetime64``, ``pandas.Timestamp``  ``"datetimes"``     datetime64
the same with a time zone                               ``"zoned"``         datetime64, in UTC
a timedelta, ``numpy.timedelta64``                      ``"timedeltas"``    timedelta64
a number of RTAMT's classes, in their unit              ``"units"``         int where whole, else float
======================================================  ==================  ==========================

Numbers are seconds in any container: lists, arrays, frames, integers or not. They are multiplied once on input and
divided once on output, both correctly rounded: a double with no more digits than a tick is returned
unchanged, and so is every other double that is the nearest to its own tick.
"""

from __future__ import annotations

from fractions import Fraction
from numbers import Rational
from types import MappingProxyType

from rtamt.errors import TraceError, shown
from rtamt.language.units.durations import NANOSECOND, UNITS, check_unit, decimal, format_duration
from rtamt.language.units.moments import show_date
from rtamt.lazy.dataclasses import dataclass, field, replace
from rtamt.lazy.modules import dt, np
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals import arrays
from rtamt.signals.counting import (
    DOUBLES,
    FARTHEST,
    IMPLAUSIBLE,
    NEAR,
    all_integers,
    counted,
    integers,
    quotients,
    refuse_implausible,
    rescaled,
    times_of,
)
from rtamt.signals.datetimes import counts_of, has_length, nanoseconds_of, no_length

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from rtamt.signals.arrays import FloatArray

    TickArray = NDArray[np.int64]

#: The kind of a ``timedelta64`` without a fixed length in :func:`kinds_of`.
NO_LENGTH = "no length"

#: The names of the kinds in messages.
KINDS = MappingProxyType(
    {
        "seconds": "seconds",
        "datetimes": "datetimes",
        "zoned": "datetimes with a time zone",
        "timedeltas": "timedeltas",
        **dict.fromkeys(("whole", "numbers", "units"), "numbers"),
    }
)

_OF_DTYPE = {"M": "datetimes", "m": "timedeltas"}
#: The kinds whose times are numbers in a given unit.
_IN_UNITS = ("whole", "numbers", "units")


@dataclass(frozen=True, slots=True)
class TimeScale:
    """The caller's time format, and the length of a tick.

    ``tick``: seconds. ``kind``: a row of the module's table. ``unit``: seconds in one of the caller's
    numbers, for the kinds that are numbers.
    """

    tick: Fraction
    kind: str
    unit: Fraction = UNITS["s"]
    #: ``tick / unit`` as integers: fractions are too slow for online results.
    _ratio: tuple[int, int] = field(init=False, repr=False, compare=False)
    #: The divisor from ticks to the caller's times; None for other formats.
    rate: int | None = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        numerator, denominator = (self.tick / self.unit).as_integer_ratio()
        object.__setattr__(self, "_ratio", (numerator, denominator))
        divided = self.kind in ("seconds", "numbers") and numerator == 1
        object.__setattr__(self, "rate", denominator if divided else None)

    @staticmethod
    def of(tick: Fraction, times: Iterable[Any], unit: str | None = None) -> TimeScale:
        """Return the time scale of sequences of times; ``unit``: the given unit of numbers."""
        if unit is None:
            return TimeScale(tick, next((kind_of(some) for some in times if len(some)), "seconds"))
        return TimeScale(
            tick, "whole" if all(map(all_integers, times)) else "numbers", UNITS[check_unit(unit)]
        )

    @staticmethod
    def in_ticks(tick: Fraction) -> TimeScale:
        """Return the scale of times that are ticks."""
        return TimeScale(tick, "whole", tick)

    def widened(self, times: Iterable[Any]) -> TimeScale:
        """Return the scale extended to these times: after non-integer numbers, results are no longer integers."""
        if self.kind == "whole" and not all(map(all_integers, times)):
            return replace(self, kind="numbers")
        return self

    @property
    def ticks_in_1(self) -> int | None:
        """The ticks in one unit of the caller, if representable as a factor in double precision, else None."""
        numerator, denominator = self._ratio
        quick = self.kind in ("seconds", "numbers", "whole") and numerator == 1 and denominator < DOUBLES
        return denominator if quick else None

    def ticks(self, times: Any, name: str, first: int = 0) -> TickArray:
        """Return times as ticks, rounded to the nearest; raise :class:`TraceError` if that cannot be.

        ``times``: as :func:`sequence_of` returns them. Integers are exact. ``first`` is the index of
        ``times[0]`` in the recording of ``name``, for messages.
        """
        if times.__class__ is list and len(times) == 1 and times[0].__class__ is int:
            tick = self._whole_tick(times[0])
            if tick is not None:
                return np.array([tick], np.int64)
        try:
            plain = times.__class__ is np.ndarray and times.dtype == np.float64
            if plain and self.kind == "seconds" and self.unit == 1:
                found = self._plain(times)
                if found is not None:
                    return found
            self._require_kind(times, name, first)
            if self.kind == "seconds" or self.kind in _IN_UNITS:
                return self._of_numbers(times, name, first)
            return self._of_dates(times, name, first)
        except OverflowError:
            raise self.too_far(name) from None

    def _whole_tick(self, number: int) -> int | None:
        """Return the tick of an integer that is near 0 and a whole number of ticks; None where it is another one."""
        factor = self.ticks_in_1
        if factor is None or abs(number) >= IMPLAUSIBLE or abs(number * factor) >= NEAR:
            return None
        return number * factor

    def _plain(self, numbers: FloatArray) -> TickArray | None:
        """Return the ticks of seconds that do not decrease and are near 0; None where there are others."""
        if max(self.tick.as_integer_ratio()) >= DOUBLES:
            return None
        rate, whole = float(self.tick.denominator), float(self.tick.numerator)
        bound = min(NEAR * whole / rate, IMPLAUSIBLE)
        # In order, all are as near as the first and the last; NaN is in no order.
        if not len(numbers) or not -bound < numbers[0] <= numbers[-1] < bound:
            return None
        if not np.logical_and.reduce(numbers[1:] >= numbers[:-1]):
            return None
        scaled: FloatArray = np.rint(numbers * rate / whole)
        return scaled.astype(np.int64)

    def _require_kind(self, times: Any, name: str, first: int) -> None:
        kinds = kinds_of(times)
        if NO_LENGTH in kinds:
            raise no_length(name, first + kinds[NO_LENGTH])
        if self.kind in _IN_UNITS:
            if set(kinds) - {"seconds"}:
                raise self._not_numbers(times, name, first)
            return
        if self.kind == "zoned" and isinstance(times, np.ndarray) and times.dtype.kind == "M":
            return  # as returned by times(): in UTC
        if len(kinds) > 1:
            (a, i), (b, j) = list(kinds.items())[:2]
            raise TraceError(
                f"'{name}' has times in {KINDS[a]} at sample {first + i} and in {KINDS[b]} at sample "
                f"{first + j}: use one of them for all",
                variable=name,
                index=first + j,
            )
        for kind in kinds:
            if self.kind != kind:
                raise TraceError(
                    f"'{name}' has times in {KINDS[kind]}, but others in {KINDS[self.kind]}: "
                    f"use one of them for all",
                    variable=name,
                )

    def _of_numbers(self, times: Any, name: str, first: int) -> TickArray:
        ratio = self.unit / self.tick
        if not _are_numbers(times):
            raise self._not_numbers(times, name, first)
        if self.kind == "seconds":
            refuse_implausible(times, name, first)
        exact = _exact(times)
        if exact.all():
            return rescaled(integers(times), ratio)
        with np.errstate(over="ignore"):  # a longdouble may be beyond every double
            numbers = np.asarray(times).astype(np.float64)
        finite = np.isfinite(numbers)
        if not finite.all():
            i = int((~finite).argmax())
            raise not_finite(name, first + i, times[i])
        ticks = counted(numbers, ratio)
        if exact.any():  # an integer is exact, whatever the other values are
            ticks[exact] = rescaled(
                integers([t for t, is_exact in zip(times, exact.tolist(), strict=True) if is_exact]), ratio
            )
        return ticks

    def _of_dates(self, times: Any, name: str, first: int) -> TickArray:
        dtypes = {getattr(time, "dtype", None) for time in times} if isinstance(times, list) else set()
        if isinstance(times, list) and (len(dtypes) != 1 or None in dtypes):
            # Each by itself: numpy would round, or wrap, what it brings to one unit.
            moments = [nanoseconds_of(time) for time in times]
            missing = [i for i, moment in enumerate(moments) if moment is None]
            if missing:
                raise not_finite(name, first + missing[0], times[missing[0]])
            return rescaled(np.array(moments, dtype=object), NANOSECOND / self.tick)
        dated = np.asarray(times)
        if dated.dtype.kind == "O":
            return self._of_dates(list(times), name, first)
        absent = np.isnat(dated)
        if absent.any():
            i = int(absent.argmax())
            raise not_finite(name, first + i, dated[i])
        numbers, length = counts_of(dated)
        return rescaled(numbers, length / self.tick)

    def _not_numbers(self, times: Any, name: str, first: int) -> TraceError:
        i, time = next((i, time) for i, time in enumerate(times) if not arrays.is_number(time))
        expected = "a number" if self.kind == "units" else f"a number of {self._unit_name}"
        if self.kind == "seconds":
            expected += " or a datetime"
        return TraceError(
            f"{times_of(name)} is {shown(time)} at sample {first + i}, expected {expected}",
            variable=name,
            index=first + i,
        )

    @property
    def _unit_name(self) -> str:
        unit = next((name for name, size in UNITS.items() if size == self.unit), "s")
        return "seconds" if unit == "s" else unit

    def too_far(self, name: str) -> TraceError:
        """Return the error for a time that ticks cannot hold."""
        return TraceError(
            f"'{name}' has a time too far from 0 for ticks of {format_duration(self.tick)}: "
            f"subtract a start time, or choose a coarser resolution",
            variable=name,
        )

    def times(self, ticks: TickArray) -> NDArray[Any]:
        """Convert ticks to the caller's time format, with the type given in the module's table."""
        if self.kind in ("seconds", "numbers"):
            return self._doubles(ticks)
        if self.kind == "whole":
            return self._whole(ticks)
        if self.kind == "units":
            return np.array([self._in_units(tick) for tick in ticks.tolist()], dtype=object)
        farthest = int(np.abs(ticks).max(initial=0)) * self.tick
        fits = [unit for unit, size in UNITS.items() if farthest / size < FARTHEST]
        unit = fits[-1]  # the finest that holds them
        dtype = f"{'m' if self.kind == 'timedeltas' else 'M'}8[{unit}]"
        return rescaled(ticks, self.tick / UNITS[unit]).astype(dtype)

    def _whole(self, ticks: TickArray) -> NDArray[Any]:
        """Return ticks as integers, unless there are instants between two of them."""
        numerator, denominator = self._ratio
        if self.tick < self.unit and (ticks % denominator).any():
            return self._doubles(ticks)
        try:
            return rescaled(ticks, Fraction(numerator, denominator), 2**63)
        except OverflowError:
            return self._doubles(ticks)

    def _doubles(self, ticks: TickArray) -> FloatArray:
        """Return the nearest doubles; where these are instants before the ticks, the next ones.

        Far from 0 doubles are further apart than ticks. A value that begins a tick after a sample then begins at the
        next double: a run that holds at a time of a sample, and one that begins behind it, have different times.
        """
        times = quotients(ticks, *self._ratio)
        if not len(ticks) or max(abs(int(ticks.min())), abs(int(ticks.max()))) < NEAR:
            return times
        numerator, denominator = self._ratio
        limit = FARTHEST - 2**12  # doubles next to others may be too far
        doubtful = (-limit < ticks) & (ticks < limit)
        if numerator == 1 and denominator % 1000 == 0:  # what prints with three digits less is its own tick
            doubtful &= ticks % 1000 != 0
        places = np.flatnonzero(doubtful)
        if len(places):
            before = places[counted(times[places], self.unit / self.tick) < ticks[places]]
            times[before] = np.nextafter(times[before], np.inf)
        return times

    def _in_units(self, tick: int) -> int | float:
        time = tick * self.tick / self.unit
        return int(time) if time.denominator == 1 else float(time)

    def time(self, tick: int) -> Any:
        """Convert one tick to the caller's time format: a Python number, or a numpy date or duration."""
        times = self.times(np.array([tick], dtype=np.int64))
        return times[0] if times.dtype.kind in "mM" else times.tolist()[0]

    def show(self, tick: int) -> str:
        """Return a tick for a message."""
        time = self.time(tick)
        if self.kind in ("datetimes", "zoned"):
            return show_date(time)
        unit = next((name for name, size in UNITS.items() if size == self.unit), "s")
        # To the last tick: timestamps since 1970 differ in their last digits.
        return f"{decimal(tick * self.tick / self.unit) or f'{float(time):.12g}'} {unit}"


def kind_of(times: Any) -> str:
    """Return the kind of the first of some times, ``"seconds"`` if there are none."""
    return next(iter(kinds_of(times)), "seconds")


def kinds_of(times: Any) -> dict[str, int]:
    """Return the kinds of times, each with the index of its first; values that are not times count as numbers."""
    if not isinstance(times, list | tuple) and isinstance(times, np.ndarray) and times.dtype.kind != "O":
        kind = _OF_DTYPE.get(times.dtype.kind, "seconds")
        if kind == "timedeltas" and not has_length(times):
            kind = NO_LENGTH
        return {kind: 0} if len(times) else {}
    found: dict[str, int] = {}
    plain = (float, int)
    for i, time in enumerate(times):
        kind = "seconds" if time.__class__ in plain else _kind_of_one(time)
        if kind not in found:
            found[kind] = i
    return found


def _kind_of_one(time: Any) -> str:
    if isinstance(time, np.timedelta64):
        return "timedeltas" if has_length(time) or np.isnat(time) else NO_LENGTH
    if isinstance(time, dt.timedelta):
        return "timedeltas"
    if isinstance(time, dt.datetime):
        return "datetimes" if time.tzinfo is None else "zoned"
    return "datetimes" if isinstance(time, np.datetime64) else "seconds"


def sequence_of(times: Any, name: str) -> Any:
    """Return times as an array or a list; raise :class:`TraceError` if they are no sequence."""
    is_array = hasattr(times, "__array__")
    if not hasattr(times, "__iter__") or (is_array and arrays.as_array(times).ndim != 1):
        raise TraceError(
            f"the times of '{name}' are {shown(times)}, expected a sequence of times", variable=name
        )
    # As a list, times of pandas keep their zones.
    zoned = getattr(getattr(times, "dtype", None), "tz", None) is not None
    if isinstance(times, np.ma.MaskedArray) and times.mask.any():  # a masked time is a missing one
        absent: Any = np.nan if times.dtype.kind in "fiub" else np.array("NaT", times.dtype)
        return np.where(np.ma.getmaskarray(times), absent, np.asarray(times))
    return arrays.as_array(times) if is_array and not zoned else list(times)


def _are_numbers(times: Any) -> bool:
    if isinstance(times, np.ndarray) and times.dtype.kind in "fiub":
        return True
    return set(map(type, times)) <= {float, int} or all(map(arrays.is_number, times))


def _exact(times: Any) -> NDArray[np.bool_]:
    """Return which of the times are integers or fractions."""
    if isinstance(times, np.ndarray) and times.dtype.kind != "O":
        return np.full(len(times), times.dtype.kind in "iu")
    types = set(map(type, times))
    if types <= {float} or types <= {int}:
        return np.full(len(times), types != {float})
    return np.array([isinstance(time, Rational) for time in times])


def not_finite(name: str, index: int, time: Any) -> TraceError:
    """Return the error for an invalid time."""
    return TraceError(
        f"{times_of(name)} is {time} at sample {index}: give a finite time", variable=name, index=index
    )
