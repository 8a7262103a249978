"""Whatever the caller has (lists, arrays, frames, objects with fields) to float64 arrays: once, at the edge."""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from fractions import Fraction
from functools import reduce
from math import isinf, isnan
from numbers import Real
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rtamt.errors import TraceError, UsageError, did_you_mean, shown, with_article
from rtamt.language.units import UNITS, check_unit, decimal, format_duration
from rtamt.signals.counting import all_integers, integers, quotients, refuse_implausible
from rtamt.signals.datetimes import has_length, in_nanoseconds, nanoseconds_of, no_length, out_of_reach
from rtamt.signals.stamps import check_frame

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

#: The key under which a trace holds its time stamps.
TIME = "time"

#: How far, as a fraction of the period, the gap between two samples may be from the period.
TOLERANCE = 0.1


_MOMENTS = (datetime, timedelta, np.datetime64, np.timedelta64)


class Clocked(ABC):
    """Data that knows its clocks: see ``trace.py``."""

    __slots__ = ()

    @property
    @abstractmethod
    def start(self) -> Any:
        """The earliest time of any signal; None without time stamps."""

    @property
    @abstractmethod
    def units(self) -> Mapping[str, str]:
        """The units of the signals whose source tells them."""

    @abstractmethod
    def on_one_clock(self, names: Collection[str]) -> Mapping[str, Any]:
        """Return n values for each name, and ``"time"`` in seconds where there are stamps."""

    @abstractmethod
    def on_own_clocks(self, names: Collection[str]) -> Mapping[str, tuple[Any, Any]]:
        """Return times and values for each name."""


class Signal:
    """Values over time: ``times`` and ``values``, arrays of the same length.

    Times come as the caller gave them: float64 seconds, numbers in the unit of ``time_unit=``, datetime64 or
    timedelta64. In dense time there is a point for every change and one at the end.
    The times of a discrete recording are shared by its signals and cannot be written.

    >>> import rtamt
    >>> signal = rtamt.parse("x >= 3").evaluate({"time": [0, 1, 2], "x": [5, 1, 4]}).signal
    >>> len(signal), signal.times[signal.values < 0]
    (3, array([1.]))
    """

    __slots__ = ("_times", "_values")

    def __init__(self, times: NDArray[Any], values: FloatArray) -> None:
        self._times = times
        self._values = values

    @property
    def times(self) -> NDArray[Any]:
        """When: seconds, or what else the caller tells time in."""
        return self._times

    @property
    def values(self) -> FloatArray:
        """What: one value for each time."""
        return self._values

    def points(self) -> list[tuple[Any, float]]:
        """Return (time, value) pairs of Python's own numbers: the cheapest way to read what an update told.

        >>> import rtamt
        >>> monitor = rtamt.parse("historically[0:1](x >= 3)").monitor(time="dense")
        >>> monitor.update(0.5, x=5.0).points()
        [(0.5, 2.0)]
        """
        times = self.times.tolist() if self.times.dtype.kind in "fi" else self.times  # dates stay numpy's
        return list(zip(times, self.values.tolist(), strict=True))

    def __len__(self) -> int:
        return len(self.times)

    def __repr__(self) -> str:
        return f"Signal(times={self.times!r}, values={self.values!r})"


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """A finished recording in discrete time: one column of ``len(times)`` samples for each variable."""

    #: Seconds; of dates, since 1970.
    times: FloatArray
    columns: Mapping[str, FloatArray]
    period: Fraction
    #: Whether the period was taken from the time stamps.
    inferred: bool = False
    #: The time stamps as the caller tells time; None where that is in seconds.
    told: NDArray[Any] | None = None
    #: Of time stamps that are numbers of something other than seconds.
    unit: str | None = None
    #: The units of the variables whose source tells them.
    units: Mapping[str, str] = dataclasses.field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.times)

    @property
    def stamps(self) -> NDArray[Any]:
        """The time stamps as the caller tells time."""
        return self.times if self.told is None else self.told

    @property
    def dated(self) -> bool:
        """Whether the time stamps are dates."""
        return self.stamps.dtype.kind == "M"

    def stamp(self, sample: int) -> Any:
        """Return a time stamp: a number of Python, or a date or duration of numpy."""
        return plain(self.stamps[sample])

    def show(self, sample: int) -> str:
        """Return a time stamp for a sentence."""
        stamp = self.stamp(sample)
        if isinstance(stamp, np.datetime64):
            return str(stamp.astype("M8[ms]")) if stamp == stamp.astype("M8[ms]") else str(stamp)
        if isinstance(stamp, np.timedelta64):
            return f"{decimal(int(stamp.astype(np.int64)) * UNITS['ns'])} s"
        return f"{stamp:.15g} s" if self.unit is None else f"{stamp} {self.unit}"


class Stamps(NamedTuple):
    """Time stamps in seconds, and as the caller tells time: in the same seconds, in a unit, as dates or durations."""

    seconds: FloatArray
    told: NDArray[Any]


def plain(time: Any) -> Any:
    """Return a number of numpy as one of Python; a date stays, which Python may not have."""
    return time if isinstance(time, np.datetime64 | np.timedelta64) else time.item()


def trace(
    data: Any,
    names: Sequence[str],
    period: Fraction | None,
    known: Collection[str] = (),
    tolerance: float = TOLERANCE,
    unit: str | None = None,
) -> Recording:
    """Normalise a finished recording; the caller's data is never changed.

    ``data``: a mapping, or anything with columns (a pandas or polars frame), from variable to n
    numbers; ``"time"`` (n stamps, seconds or datetimes) is optional. ``names`` are the variables the
    formula reads, ``known`` others that may be there. Without a ``period`` (seconds) it is taken
    from the stamps. ``unit``: of stamps that are numbers, by default seconds. Raises :class:`TraceError`.
    """
    check_tolerance(tolerance)
    stamped, columns, n = columns_of(data, names, known, unit)
    if n == 0:
        raise TraceError("the trace is empty: give at least one sample")
    inferred, told = False, None
    if stamped is None:
        period = period or Fraction(1)
        times = np.arange(n, dtype=np.float64)
        if period != 1:
            times *= float(period)
    else:
        times = stamped.seconds
        told = None if stamped.told is times else stamped.told
        check_increasing(times)
        inferred = period is None
        period = period or infer_period(times)
        check_regular(times, period, tolerance)
    for name, column in columns.items():
        check_numbers(name, column, times)
    return Recording(times, columns, period, inferred, told, unit, units_of(data))


def units_of(data: Any) -> Mapping[str, str]:
    """Return the units of the variables, where the data tells them."""
    return data.units if isinstance(data, Clocked) else {}


def columns_of(
    data: Any, names: Sequence[str], known: Collection[str] = (), unit: str | None = None
) -> tuple[Stamps | None, dict[str, FloatArray], int]:
    """Return the time stamps (None if there are none), a column for each name, and their common length."""
    require_no_unit(data, unit)
    if data.__class__ is not dict and isinstance(data, Clocked):
        data = data.on_one_clock(names)
    keys = _keys(data)
    if is_mapping(data):
        refuse_unknown(keys, names, known)
    else:
        check_frame(data, TIME, names)
    columns = {name: _column(data, keys, name) for name in names}
    times = stamps(data[TIME], unit) if TIME in keys else None
    return times, columns, _common_length(columns, times, data, keys)


def require_no_unit(data: Any, unit: str | None) -> None:
    """Raise :class:`UsageError` where a unit of time is given for data that knows its own."""
    if unit is not None:
        check_unit(unit)
        if isinstance(data, Clocked):
            raise UsageError(
                "a trace that was read knows its unit of time: give time_unit= to rtamt.read, "
                "not to what takes the trace"
            )


def is_mapping(data: Any) -> bool:
    """Tell whether data is a mapping; a dict is one at once, others cost a microsecond to find out."""
    return data.__class__ is dict or isinstance(data, Mapping)


def array(values: Any, name: str, first: int = 0) -> FloatArray:
    """Return ``values`` as a contiguous one-dimensional float64 array.

    ``first`` is the index of ``values[0]`` in the recording, for messages. Always a copy:
    sub-formulas are evaluated when they are asked for, whatever the caller has done to the data
    by then.
    """
    if values.__class__ is np.ndarray and values.dtype == np.float64 and values.ndim == 1:
        # The most usual, for which the rest would cost more than the evaluation.
        return np.array(values, dtype=np.float64)
    try:
        if isinstance(values, np.ma.MaskedArray) and values.mask.any():
            values = np.ma.filled(values.astype(np.float64), np.nan)  # a masked value is a missing one
        raw = as_array(values)
        # numpy would read the text "1.5" as a number and None as NaN; both are more likely mistakes.
        numeric = raw.dtype.kind in "fiub" or (raw.dtype.kind == "O" and all(map(is_number, raw.flat)))
        if raw.ndim == 0 or not numeric:
            raise _not_numbers(values, name, first)
        with np.errstate(over="ignore"):
            result = np.array(raw, dtype=np.float64, order="C")
    except (TypeError, ValueError):
        raise _not_numbers(values, name, first) from None
    if raw.ndim != 1:
        raise TraceError(
            f"'{name}' has {raw.ndim} dimensions, expected 1: give one number a sample", variable=name
        )
    if (
        raw.dtype.kind == "f"
        and raw.dtype.itemsize > 8
        and not np.array_equal(np.isinf(raw), np.isinf(result))
    ):
        raise _not_numbers(values, name, first)  # a longdouble beyond every double
    return result


def as_array(values: Any) -> NDArray[Any]:
    """Return values as an array of numpy, of objects where numpy has no type for them or would bring them to one."""
    if isinstance(values, (list, tuple)) and any(
        isinstance(value, np.datetime64 | np.timedelta64) for value in values
    ):
        return np.fromiter(values, dtype=object, count=len(values))  # to one unit, in which years may wrap
    try:
        return np.asarray(values)
    except (TypeError, ValueError):
        raise
    except Exception:  # noqa: BLE001 - a library's own: polars has integers of 128 bits
        return np.fromiter(values, dtype=object, count=len(values))


def is_number(value: Any) -> bool:
    """Tell whether a value is a real number that a double can hold: Python's, numpy's, or any other."""
    return number_of(value) is not None


def number_of(value: Any) -> float | None:
    """Return a real number as a double; None for what is none, or too large for one."""
    if value.__class__ is float:
        return value
    if isinstance(value, np.timedelta64) or not isinstance(value, (Real, np.bool_)):
        return None  # numpy derives its durations from its integers
    try:
        number = float(value)
    except (OverflowError, TypeError):
        return None
    # A longdouble beyond every double is finite itself.
    return None if isinf(number) and value not in (number, -number) else number


def stamps(values: Any, unit: str | None = None) -> Stamps:
    """Return time stamps in seconds and as they are told: numbers are seconds, or of ``unit``; dates count from 1970.

    Raises :class:`TraceError` for what is no time; a time that is none (NaN, NaT) is NaN seconds.
    """
    try:
        raw = values if isinstance(values, np.ma.MaskedArray) else as_array(values)
    except (TypeError, ValueError):  # lists of different lengths, for numpy
        raise _not_numbers(values, TIME, 0) from None
    if raw.dtype.kind == "O" and any(isinstance(value, _MOMENTS) for value in raw.flat):
        raw = _moments(raw)
    if raw.dtype.kind in "mM":
        if unit is not None:
            raise TraceError(
                f"'{TIME}' is {raw.flat[0]} at sample 0, expected a number of {unit}, which is what time_unit= says",
                variable=TIME,
                index=0,
            )
        told = in_nanoseconds(
            np.where(np.ma.getmaskarray(raw), np.array("NaT", raw.dtype), np.asarray(raw)), TIME
        )
        seconds = quotients(told.view(np.int64), 1, 10**9)
        seconds[np.isnat(told)] = np.nan
        return Stamps(seconds, told)
    numbers = array(values, TIME)
    if unit is None:
        refuse_implausible(raw, TIME)
        return Stamps(numbers, numbers)
    size = UNITS[unit]
    if not raw.size or (raw.dtype.kind in "iuO" and all_integers(raw)):
        try:
            whole = integers(raw)
        except OverflowError:
            raise TraceError(f"'{TIME}' has an integer that 64 bits cannot hold", variable=TIME) from None
        return Stamps(quotients(whole, *size.as_integer_ratio()), whole)
    return Stamps(numbers / float(1 / size), numbers)


def _moments(raw: NDArray[Any]) -> NDArray[Any]:
    """Return dates, or times since a start, in nanoseconds; without a time zone as they stand, as in dense time."""
    zones: dict[bool, int] = {}
    kinds: dict[str, int] = {}
    found = np.full(raw.size, np.iinfo(np.int64).min)  # NaT
    for i, value in enumerate(raw.flat):
        kind = "m" if isinstance(value, timedelta | np.timedelta64) else "M"
        kinds.setdefault(kind, i)
        if not isinstance(value, _MOMENTS) or len(kinds) > 1:
            raise TraceError(
                f"'{TIME}' is {shown(value)} at sample {i}, expected a {'datetime' if 'M' in kinds else 'timedelta'} "
                f"like the others",
                variable=TIME,
                index=i,
            )
        if isinstance(value, np.timedelta64) and not has_length(value):
            raise no_length(TIME, i)
        moment = nanoseconds_of(value)
        if moment is None:
            continue
        if abs(moment) >= 2**63:
            raise out_of_reach(TIME, i, value, kind)
        zones.setdefault(getattr(value, "tzinfo", None) is not None, i)
        found[i] = moment
    if len(zones) > 1:
        raise TraceError(
            f"'{TIME}' has a time zone at sample {zones[True]} and none at sample {zones[False]}: "
            f"use one way for all",
            variable=TIME,
            index=max(zones.values()),
        )
    return found.view(f"{next(iter(kinds))}8[ns]")


def check_numbers(name: str, column: FloatArray, times: FloatArray, first: int = 0) -> None:
    """Raise :class:`TraceError` at the first NaN; ``first`` is the index of ``column[0]`` in the recording."""
    if len(column) and isnan(np.minimum.reduce(column)):  # the least of numbers and a NaN is NaN
        i = int(np.isnan(column).argmax())
        raise nan_error(name, first + i, float(times[i]))


def nan_error(name: str, index: int, time: float) -> TraceError:
    """Return the error for a NaN in the data."""
    return TraceError(
        f"'{name}' is NaN at sample {index}, time {time:.15g} s: fill the gap or leave the sample out",
        variable=name,
        index=index,
        time=time,
    )


def check_increasing(times: FloatArray, before: float | None = None, first: int = 0) -> None:
    """Raise :class:`TraceError` unless times are finite and increase strictly, also from ``before`` on.

    ``first`` is the index of ``times[0]`` in the whole recording, for the message.
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
        raise not_increasing(first, float(times[0]), before)
    steps = np.diff(times)
    if (steps <= 0).any():
        i = int((steps <= 0).argmax()) + 1
        raise not_increasing(first + i, float(times[i]), float(times[i - 1]))


def not_increasing(index: int, time: float, before: float) -> TraceError:
    """Return the error for a stamp that is not later than the one before."""
    return TraceError(
        f"time does not increase at sample {index}: {time:.15g} s comes after {before:.15g} s; "
        f"sort the samples and drop repeated stamps",
        variable=TIME,
        index=index,
        time=time,
    )


def infer_period(times: FloatArray) -> Fraction:
    """Return the median gap, as the shortest decimal that it cannot be told from; 1 s for one sample.

    Stamps that count from 1970 are doubles of some 0.2 µs precision, which the gaps inherit.
    """
    if len(times) < 2:
        return Fraction(1)
    gap = float(np.median(np.diff(times)))
    blur = max(1e-6 * gap, 2 * float(np.spacing(np.abs(times).max())))
    for digits in range(1, 17):
        short = float(f"{gap:.{digits}g}")
        if abs(short - gap) <= blur:
            return Fraction(repr(short))
    return Fraction(repr(gap))


def check_tolerance(tolerance: Any) -> None:
    """Raise :class:`UsageError` unless ``tolerance`` is a fraction of the period, 0 or more."""
    if not is_number(tolerance) or not tolerance >= 0:
        raise UsageError(f"the tolerance is {shown(tolerance)}; give a fraction of the period, 0 or more")


def check_regular(
    times: FloatArray,
    period: Fraction,
    tolerance: float = TOLERANCE,
    before: float | None = None,
    first: int = 0,
) -> None:
    """Raise :class:`TraceError` where the gap to the sample before is not one period (within tolerance)."""
    whole = times if before is None else np.concatenate(([before], times))
    step = float(period)
    off = np.abs(np.diff(whole) - step) > tolerance * step
    if off.any():
        i = int(off.argmax()) + 1
        index = first + i - (0 if before is None else 1)
        raise irregular(index, float(whole[i]), float(whole[i - 1]), period, tolerance)


def irregular(index: int, time: float, before: float, period: Fraction, tolerance: float) -> TraceError:
    """Return the error for a sample that is not one period after the one before."""
    return TraceError(
        f"sample {index} at {time:.15g} s is {time - before:g} s after the one before, expected "
        f"{format_duration(period)} (within {tolerance:.0%}): give the right period, or resample the trace",
        variable=TIME,
        index=index,
        time=time,
    )


def unknown_variable(name: str, names: Collection[str]) -> TraceError:
    """Return the error for a variable that the formula does not read."""
    reads = ", ".join(names) or "no variable"
    return TraceError(
        f"unknown variable '{name}' in the data; the formula reads {reads}{did_you_mean(name, names)}",
        variable=name,
    )


def missing_variable(name: str, keys: Collection[str]) -> TraceError:
    """Return the error for a variable that the formula reads and the data lacks."""
    has = ", ".join(str(key) for key in keys) or "nothing"
    return TraceError(f"the data has no '{name}'; it has {has}{did_you_mean(name, keys)}", variable=name)


def field(value: Any, path: Sequence[str]) -> Any:
    """Follow a path of fields into an object."""
    return reduce(getattr, path, value)


def _keys(data: Any) -> list[str]:
    if is_mapping(data):
        return list(data)
    columns = getattr(data, "columns", None)
    if columns is None:
        raise TraceError(
            f"expected a mapping from variable to values, such as {{'time': [...], 'x': [...]}}, "
            f"got {type(data).__name__}"
        )
    return list(columns)


def refuse_unknown(keys: Sequence[str], names: Sequence[str], known: Collection[str]) -> None:
    """Raise :class:`TraceError` at a key that is neither read, nor known, nor the time."""
    for key in keys:
        if key in names or key == TIME or key in known:
            continue
        if key not in {name.split(".")[0] for name in names}:
            raise unknown_variable(str(key), names)


def _column(data: Any, keys: Sequence[str], name: str) -> FloatArray:
    if name in keys:
        return array(data[name], name)
    head, *path = name.split(".")
    if path and head in keys:
        return array([field_of(value, head, path, i) for i, value in enumerate(data[head])], name)
    raise missing_variable(name, [key for key in keys if key != TIME])


def field_of(value: Any, head: str, path: Sequence[str], index: int) -> Any:
    """Follow a path of fields (``req.value``) into the object that a variable holds at a sample."""
    try:
        return field(value, path)
    except AttributeError:
        raise TraceError(
            f"'{head}' has no field '{'.'.join(path)}' at sample {index}: it is {with_article(type(value).__name__)}",
            variable=head,
            index=index,
        ) from None


def _common_length(
    columns: Mapping[str, FloatArray], times: Stamps | None, data: Any, keys: Sequence[str]
) -> int:
    lengths = {name: len(column) for name, column in columns.items()}
    if times is not None:
        lengths = {TIME: len(times.seconds), **lengths}
    if not lengths:  # a formula without variables still needs instants
        lengths = {key: len(data[key]) for key in keys}
    if len(set(lengths.values())) > 1:
        (a, n), (b, m) = next(
            ((a, n), (b, m)) for a, n in lengths.items() for b, m in lengths.items() if n != m
        )
        raise TraceError(f"'{a}' has {n} and '{b}' has {m} samples: give one value of each at every sample")
    return next(iter(lengths.values()), 0)


def _not_numbers(values: Any, name: str, first: int) -> TraceError:
    try:
        items = enumerate(values, first)
    except TypeError:
        return TraceError(f"'{name}' is {shown(values)}, expected a sequence of numbers", variable=name)
    for i, value in items:
        if not is_number(value):
            return TraceError(
                f"'{name}' is {shown(value)} at sample {i}, expected a number", variable=name, index=i
            )
    return TraceError(f"'{name}' cannot be read as a sequence of numbers", variable=name)
