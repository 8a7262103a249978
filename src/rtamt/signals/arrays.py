"""Convert the caller's data (lists, arrays, frames, objects with fields) to float64 arrays."""

from __future__ import annotations

import sys
from abc import ABC, abstractmethod
from collections.abc import Mapping
from functools import reduce
from math import isinf, isnan
from numbers import Real

from rtamt.errors import TraceError, UsageError, shown, with_article
from rtamt.language.units.durations import UNITS, check_unit, in_seconds
from rtamt.lazy.modules import dt, np
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals.coding import NO_TYPES, encoded, require_truths
from rtamt.signals.time_columns import check_frame, check_mapping, is_labelled

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Sequence

    from numpy.typing import NDArray

    from rtamt.language.value_types import ValueType
    from rtamt.signals.coding import Types
    from rtamt.signals.sampling_period import RegularTimes

    FloatArray = NDArray[np.float64]

#: The problem of a finite number that no double is near.
TOO_LARGE = "beyond the range of a double (1.8e308): use a larger unit"

#: The key under which a trace holds its timestamps.
TIME = "time"


class WithTimeBases(ABC):
    """Data with its own time bases: see ``trace.py``."""

    __slots__ = ()

    @property
    @abstractmethod
    def start(self) -> Any:
        """The earliest time of any signal; None without timestamps."""

    @property
    @abstractmethod
    def units(self) -> Mapping[str, str]:
        """The units of the signals whose source provides them."""

    @abstractmethod
    def on_one_time_base(self, names: Collection[str]) -> Mapping[str, Any]:
        """Return n values for each name, and ``"time"`` in seconds if there are timestamps."""

    @abstractmethod
    def require_own_clock(self, names: Iterable[str]) -> None:
        """Raise :class:`TraceError` where signals that are not among these changed the times of all these."""

    @abstractmethod
    def require_period(self, names: Collection[str]) -> None:
        """Raise :class:`TraceError` where nothing but an assumed period gives the times of samples."""

    @abstractmethod
    def on_own_time_bases(self, names: Collection[str]) -> Mapping[str, tuple[Any, Any]]:
        """Return times and values for each name."""


class Timestamps(NamedTuple):
    """Timestamps in seconds, and in the caller's format: the same seconds, another unit, dates or durations."""

    seconds: FloatArray
    original: NDArray[Any]


def is_moment(time: Any) -> bool:
    """Return whether a time is a date or a duration, and not a number."""
    return isinstance(time, (dt.datetime, dt.timedelta, np.datetime64, np.timedelta64))


def are_dates(times: NDArray[Any] | None) -> bool:
    """Return whether times in the caller's format, None for seconds, are dates."""
    return times is not None and times.dtype.kind == "M"


def plain(time: Any) -> Any:
    """Convert a numpy number to a Python number; dates are kept, since Python may lack the precision."""
    return time if isinstance(time, np.datetime64 | np.timedelta64) else time.item()


def units_of(data: Any) -> Mapping[str, str]:
    """Return the units of the variables, as far as the data provides them."""
    return data.units if isinstance(data, WithTimeBases) else {}


def columns_of(
    data: Any,
    names: Sequence[str],
    unit: str | None = None,
    types: Types = NO_TYPES,
    *,
    first: int = 0,
    copy: bool = True,
    regular: bool = True,
) -> tuple[Timestamps | None, dict[str, FloatArray], int]:
    """Return the timestamps (None if there are none), a column for each name, and their common length.

    ``types``: of the variables that may be given by the names of members. ``first``, ``copy``: see :func:`array`.
    ``regular``: whether the period of samples without timestamps is known.
    """
    require_no_unit(data, unit)
    if data.__class__ is not dict and isinstance(data, WithTimeBases):
        if not regular:
            data.require_period(names)
        data = data.on_one_time_base(names)
    keys = _keys(data)
    if not is_mapping(data):
        check_frame(data, TIME, names)
    elif TIME not in keys:
        check_mapping(data, TIME, names, regular=regular)
    if not regular:
        from rtamt.signals.assumed_period import require_times  # monitors have a period

        require_times(data, names)
    columns = {name: _column(data, keys, name, types.get(name), first, copy=copy) for name in names}
    times = timestamps(data[TIME], unit, first, copy=copy) if TIME in keys else None
    return times, columns, _common_length(columns, times, data, keys)


def require_no_unit(data: Any, unit: str | None) -> None:
    """Raise :class:`UsageError` if a time unit is given for data that has its own."""
    if unit is not None:
        check_unit(unit)
        if isinstance(data, WithTimeBases):
            raise UsageError(
                "a trace that was read knows its unit of time: give time_unit= to rtamt.read, "
                "not to what takes the trace"
            )


def is_mapping(data: Any) -> bool:
    """Return whether data is a mapping; dicts are checked first, because the general check takes a microsecond.

    A dataset of xarray is none: as a mapping it lacks its coordinates, such as the timestamps.
    """
    return data.__class__ is dict or (isinstance(data, Mapping) and not is_labelled(data))


def array(values: Any, name: str, first: int = 0, *, copy: bool = True) -> FloatArray:
    """Return ``values`` as a contiguous one-dimensional float64 array.

    ``first`` is the index of ``values[0]`` in the recording, for messages. ``copy``: whether the result may not share
    memory with ``values``: sub-formulas are evaluated on demand, even if the caller has changed the data since.
    """
    if values.__class__ is np.ndarray and values.dtype == np.float64 and values.ndim == 1:
        # The common case, for which the checks below would cost more than the evaluation.
        return np.array(values, dtype=np.float64) if copy else np.ascontiguousarray(values, dtype=np.float64)
    try:
        if values.__class__ is not np.ndarray:
            from rtamt.signals.gaps import reads_as_nan  # most values are arrays

            if reads_as_nan(values):
                raise _not_numbers(values, name, first)
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


def is_masked(values: Any) -> bool:
    """Return whether values are an array of numpy with a mask; ``numpy.ma``, which takes 20 ms, is not loaded for it.

    >>> is_masked(np.zeros(1)), is_masked(np.ma.zeros(1))
    (False, True)
    """
    loaded: Any = sys.modules.get("numpy.ma")  # whoever has such an array has loaded it
    return loaded is not None and isinstance(values, loaded.MaskedArray)


def as_array(values: Any) -> NDArray[Any]:
    """Return values as a numpy array, with dtype object if numpy has no common type or would convert them."""
    if isinstance(values, (list, tuple)) and any(
        isinstance(value, np.datetime64 | np.timedelta64) for value in values
    ):
        return np.fromiter(
            values, dtype=object, count=len(values)
        )  # avoid a common unit, in which years may overflow
    try:
        return np.asarray(values)
    except (TypeError, ValueError):
        raise
    except Exception:  # noqa: BLE001 - a library's own: polars has integers of 128 bits
        return np.fromiter(values, dtype=object, count=len(values))


def is_number(value: Any) -> bool:
    """Return whether a value is a real number that a double can hold: Python's, numpy's, or any other."""
    return number_of(value) is not None


def number_of(value: Any) -> float | None:
    """Return a real number as a double; None for anything else or if it is too large."""
    if value.__class__ is float:
        return value
    known = isinstance(value, float | int)  # without loading numpy
    if not known and (isinstance(value, np.timedelta64) or not isinstance(value, (Real, np.bool_))):
        return None  # timedelta64 is a subclass of numpy's integers
    try:
        number = float(value)
    except (OverflowError, TypeError):
        return None
    # A longdouble beyond every double is finite itself.
    return None if isinf(number) and value not in (number, -number) else number


def number_expected(value: Any, of: str = "") -> str:
    """Return the problem of a value for which :func:`number_of` has no double; ``of``: what numbers are expected.

    >>> number_expected("1"), number_expected(10**400)
    ('expected a number', 'beyond the range of a double (1.8e308): use a larger unit')
    """
    if isinstance(value, np.timedelta64) or not isinstance(value, Real):
        return f"expected a number{of}"
    return TOO_LARGE


def is_truth(value: Any) -> bool:
    """Return whether a value is a Boolean of Python or numpy."""
    return isinstance(value, bool) or (not isinstance(value, float | int) and isinstance(value, np.bool_))


def timestamps(values: Any, unit: str | None = None, first: int = 0, *, copy: bool = True) -> Timestamps:
    """Return timestamps in seconds and as given; numbers are in ``unit`` or seconds, dates count from 1970.

    ``first``, ``copy``: see :func:`array`. Raises :class:`TraceError` for anything but times; missing times (NaN, NaT)
    become NaN seconds.
    """
    from rtamt.signals.counting import all_integers, integers, quotients, refuse_implausible

    try:
        raw = values if is_masked(values) else as_array(values)
    except (TypeError, ValueError):  # lists of different lengths, for numpy
        raise _not_numbers(values, TIME, first) from None
    if raw.dtype.kind == "O" and any(map(is_moment, raw.flat)):
        from rtamt.signals.datetimes import moments

        raw = moments(raw, first)
    if raw.dtype.kind in "mM":
        if unit is not None:
            raise TraceError(
                f"'{TIME}' is {raw.flat[0]} at sample {first}, expected a number of {unit}, which is what "
                f"time_unit= says",
                variable=TIME,
                index=first,
            )
        from rtamt.signals.datetimes import in_nanoseconds

        original = in_nanoseconds(
            np.where(np.ma.getmaskarray(raw), np.array("NaT", raw.dtype), np.asarray(raw)), TIME, first=first
        )
        seconds = quotients(original.view(np.int64), 1, 10**9)
        seconds[np.isnat(original)] = np.nan
        return Timestamps(seconds, original)
    if is_masked(values) and values.mask.any():
        values = raw = np.ma.filled(values.astype(np.float64), np.nan)  # a masked time is a missing one
    numbers = array(values, TIME, first, copy=copy)
    if unit is None:
        refuse_implausible(raw, TIME, first)
        return Timestamps(numbers, numbers)
    size = UNITS[unit]
    if not raw.size or (raw.dtype.kind in "iuO" and all_integers(raw)):
        try:
            whole = integers(raw)
        except OverflowError:
            raise TraceError(f"'{TIME}' has an integer that 64 bits cannot hold", variable=TIME) from None
        return Timestamps(quotients(whole, *size.as_integer_ratio()), whole)
    return Timestamps(in_seconds(numbers, size), numbers)


def check_numbers(
    name: str,
    column: FloatArray,
    times: FloatArray | RegularTimes,
    first: int = 0,
    type_: ValueType | None = None,
    *,
    dated: bool = False,
) -> None:
    """Raise :class:`TraceError` at the first NaN, of a Boolean also at a number that is neither 1 nor 0.

    ``first`` is the index of ``column[0]`` in the recording. ``dated``: whether the caller's times are dates.
    """
    if len(column) and isnan(np.minimum.reduce(column)):  # NaN propagates
        from rtamt.signals.data_errors import nan_error

        i = int(np.isnan(column).argmax())
        raise nan_error(name, first + i, float(times[i]), dated=dated)
    if type_ is not None:
        from rtamt.language.units.moments import time_text

        def where(i: int) -> str:
            return f"sample {first + i}, time {time_text(float(times[i]), dated=dated)}"

        require_truths(name, type_, column, where, first)


def field(value: Any, path: Sequence[str]) -> Any:
    """Follow a path of fields into an object."""
    return reduce(getattr, path, value)


def _keys(data: Any) -> list[str]:
    if is_mapping(data):
        return list(data)
    if not is_frame(data):
        from rtamt.signals.data_errors import not_a_mapping

        raise not_a_mapping(data, "values, such as {'time': [...], 'x': [...]}")
    return list(data.columns)


def is_frame(data: Any) -> bool:
    """Return whether data has columns by name, as frames of pandas and polars have; the columns of Arrow are arrays.

    A lazy frame has none yet. A frame has its columns as attributes, too, a class has not.
    """
    kind = type(data)
    return not hasattr(kind, "column_names") and not hasattr(kind, "collect") and hasattr(data, "columns")


def _column(
    data: Any, keys: Sequence[str], name: str, type_: ValueType | None, first: int, *, copy: bool
) -> FloatArray:
    if name in keys:
        return array(encoded(data[name], name, type_, first), name, first, copy=copy)
    head, *path = name.split(".")
    if path and head in keys:
        values = [field_of(value, head, path, i) for i, value in enumerate(data[head], first)]
        return array(encoded(values, name, type_, first), name, first)
    from rtamt.signals.data_errors import missing_variable

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
    columns: Mapping[str, FloatArray], times: Timestamps | None, data: Any, keys: Sequence[str]
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
    from rtamt.signals.gaps import elements_of

    try:
        items = enumerate(elements_of(values), first)
    except TypeError:
        return TraceError(f"'{name}' is {shown(values)}, expected a sequence of numbers", variable=name)
    for i, value in items:
        if not is_number(value):
            return TraceError(
                f"'{name}' is {shown(value)} at sample {i}, {number_expected(value)}", variable=name, index=i
            )
    return TraceError(f"'{name}' cannot be read as a sequence of numbers", variable=name)
