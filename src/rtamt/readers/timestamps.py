"""The column of timestamps: its name, its unit, and its values as times.

Shared by files, frames, queries, chunks and streams. What does not follow from the name of the
column follows from its first timestamp, which every one of them has.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, shown
from rtamt.language.units.durations import NANOSECOND, UNITS, in_seconds
from rtamt.lazy.modules import np
from rtamt.readers.dates import EXAMPLE, DateError, Dates, is_date
from rtamt.readers.numbers import double_of, is_whole, problem_of
from rtamt.signals.arrays import is_masked
from rtamt.signals.counting import refuse_implausible
from rtamt.signals.datetimes import in_nanoseconds
from rtamt.signals.time_columns import is_stamps, may_be_stamps, unit_called, unit_of

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import NDArray

    from rtamt.readers.source import Field, Raw

#: What messages offer where the column of timestamps is not clear.
CHOICES = "choose one with time=, or on the command line --time-column ('' for none)"

#: Nanoseconds that a double of seconds holds exactly enough to be rounded back.
_EXACT = 2**50


def guess_field(fields: Sequence[Field], source: str, wanted: Collection[str]) -> Field | None:
    """Return the field of timestamps by its name, else the one with dates in it; None if there is none.

    What a formula reads (``wanted``) is no candidate while there are others. Raises
    :class:`TraceError` that lists the candidates where there are several, or where there is none
    but columns that are called in a similar way or look like timestamps.
    """
    found = [field for field in fields if is_stamps(field.name)]
    if not found:
        found = [field for field in fields if field.kind == "time"]
        others = [
            field for field in fields if field.kind != "time" and (field.axis or may_be_stamps(field.name))
        ]
        others = [field for field in others if not _is_wanted(field, wanted)]
        if others:
            raise _unclear([*found, *others], source)
    free = [field for field in found if not _is_wanted(field, wanted)] or found
    if len(free) > 1:
        raise _unclear(free, source)
    return free[0] if free else None


def is_axis(numbers: Sequence[float]) -> bool:
    """Return whether the first numbers of a column without a name increase and do not count the rows.

    Such is the index of a frame that pandas has written.

    >>> is_axis([0.0, 0.5]), is_axis([0, 1, 2]), is_axis([2, 1])
    (True, False, False)
    """
    steps = {after - before for before, after in pairwise(numbers)}
    return bool(steps) and min(steps) > 0 and steps != {1.0}


def _is_wanted(field: Field, wanted: Collection[str]) -> bool:
    return field.name in wanted or field.column in wanted


def _unclear(candidates: Sequence[Field], source: str) -> TraceError:
    listing = ", ".join(f"'{field.column}'" if field.column else "one without a name" for field in candidates)
    has = "several columns that" if len(candidates) > 1 else "a column that"
    choices = CHOICES if all(field.column for field in candidates) else f"name it, or {CHOICES}"
    return TraceError(f"{source} has {has} may hold the timestamps: {listing}; {choices}")


class TimestampColumn:
    """The conversion of a column of timestamps to times, a few at a time: the first one decides for all.

    ``said``: the unit given by the caller. ``notes``: the inferences.
    """

    def __init__(self, field: Field, said: str | None, guessed: bool, source: str) -> None:
        self.field = field
        self._source = source
        self._said = said
        why = "by its name" if is_stamps(field.name) else "the one column of dates"
        self.notes = [f"time is '{field.column}', {why}"] if guessed else []
        #: Of numbers; None where neither the caller nor the column names one.
        self._unit = self._find_unit(said)
        #: Whether numbers become timedelta64 of nanoseconds, and not float64 seconds; None before the first.
        self._exact: bool | None = None
        #: Reads objects that are dates, once the first of them was one.
        self._dates: Dates | None = None

    def _find_unit(self, said: str | None) -> str | None:
        text = said if said is not None else self.field.unit
        if not text:
            unit = unit_of(self.field.name)
            if unit is not None and not is_stamps(self.field.name):
                self.notes.append(f"'{self.field.column}' is in {unit}, by its name")
            return unit
        unit = unit_called(text)
        if unit is None:
            raise TraceError(
                f"the unit of the time column '{self.field.column}' of {self._source} is '{text}', "
                f"which is none of {', '.join(UNITS)}"
            )
        return unit

    def times(self, raw: Raw, before: int = 0, *, copy: bool = True) -> NDArray[Any]:
        """Return the next timestamps as times: float64 seconds, timedelta64[ns] or datetime64[ns].

        ``before``: how many timestamps there were before. ``copy``: whether seconds may not share memory with ``raw``.
        Raises :class:`TraceError` at one that is missing or is no time.
        """
        raw = self._plain(raw, before)
        if raw.dtype.kind in "mM":
            if self._said is not None:
                what = "dates" if raw.dtype.kind == "M" else "durations"
                raise TraceError(
                    f"the times of {self._source} are {what}, which have a unit: leave out time_unit=, on the "
                    f"command line --time-unit"
                )
            raw = in_nanoseconds(raw, self.field.column, self._source)
        if raw.dtype.kind == "M":
            return raw
        if raw.dtype.kind == "m":
            raw, unit = raw.view(np.int64), "ns"
        else:
            unit = self._unit_of(raw, before)
        size = UNITS[unit]
        if self._exact is None and len(raw):
            integers = raw.dtype.kind in "iuO"
            farthest = max(abs(int(raw.min())), abs(int(raw.max()))) if integers else 0
            self._exact = unit != "s" and farthest * size * 10**9 >= _EXACT
        if not self._exact:
            seconds = raw.astype(np.float64, copy=copy)
            return seconds if unit == "s" else in_seconds(seconds, size)
        from rtamt.signals.ticks import TimeScale

        named = f"'{self.field.column}'"
        try:
            ticks = TimeScale(NANOSECOND, "units", size).ticks(raw, self.field.column)
        except TraceError as error:
            raise TraceError(str(error).replace(named, f"{named} of {self._source}", 1)) from None
        return ticks.view("m8[ns]")

    def _unit_of(self, raw: Raw, before: int) -> str:
        """Return the unit of numbers, seconds where nothing names it."""
        if self._unit is None:
            refuse_implausible(raw, self.field.column, before, self._source)
        return self._unit or "s"

    # ---- cell contents ---------------------------------------------------------------------------

    def _plain(self, raw: Raw, before: int) -> Raw:
        """Return timestamps as numbers or dates of numpy, none of which is missing."""
        if self._dates is not None or raw.dtype.kind in "OUS":
            raw = self._of_objects(_objects(raw), before)
        missing = _missing(raw)
        if missing is not None and missing.any():
            raise TraceError(
                f"the time column '{self.field.column}' of {self._source} is empty at sample "
                f"{before + int(missing.argmax())}"
            )
        if raw.dtype.kind not in "fiubmMO" and len(raw):
            raise self._no_time(raw[0], before, "expected a number")
        given = raw
        if raw.dtype.kind == "f" and raw.dtype.itemsize > 8:
            with np.errstate(over="ignore"):  # what is beyond every double is no finite time
                raw = raw.astype(np.float64)
        if raw.dtype.kind == "f" and not np.isfinite(raw).all():
            row = int(np.argmin(np.isfinite(raw)))
            if np.isfinite(given[row]):
                raise self._no_time(given[row], before + row, problem_of(given[row]))
            raise self._no_time(float(raw[row]), before + row, "expected a finite number")
        return np.ma.getdata(raw) if is_masked(raw) else raw

    def _of_objects(self, values: list[Any], before: int) -> Raw:
        first = next((value for value in values if value is not None), None)
        if self._dates is None and is_date(first) and self._exact is None:
            self._dates = Dates()
        if self._dates is not None:
            try:
                return self._dates.take(values)
            except DateError as error:
                raise self._no_time(values[error.index], before + error.index, str(error)) from None
        for i, value in enumerate(values):
            if value is not None and double_of(value) is None:
                or_date = "" if self._exact is not None else f", or a date such as {EXAMPLE}"
                raise self._no_time(value, before + i, problem_of(value, or_date))
        return numbers_in(values)

    def _no_time(self, value: Any, row: int, problem: str) -> TraceError:
        return TraceError(
            f"the time column '{self.field.column}' of {self._source} is {shown(value)} at sample {row}, {problem}"
        )


def _objects(raw: Raw) -> list[Any]:
    """Return an array as a list, with None for missing values."""
    values = list(np.ma.getdata(raw).astype(object))
    if is_masked(raw):
        missing = np.ma.getmaskarray(raw).tolist()
        return [None if absent else value for value, absent in zip(values, missing, strict=True)]
    return values


def _missing(raw: Raw) -> NDArray[np.bool_] | None:
    """Return which timestamps are missing, None if none can be."""
    if raw.dtype.kind in "mM":
        return np.isnat(raw)
    return np.ma.getmaskarray(raw) if is_masked(raw) else None


def numbers_in(values: Sequence[Any]) -> Raw:
    """Return numbers as int64 where all are integers, as integers of Python where int64 is too small, else as float64.

    None is masked. Decimals without a fraction are integers: a double does not hold nanoseconds since 1970.
    """
    whole = all(value is None or is_whole(value) for value in values)
    as_number = int if whole else double_of
    plain = [0 if value is None else as_number(value) for value in values]
    try:
        numbers = np.array(plain, dtype=np.int64 if whole else np.float64)
    except OverflowError:
        numbers = np.array(plain, dtype=object)
    missing = np.array([value is None for value in values], dtype=bool)
    return np.ma.masked_array(numbers, missing) if missing.any() else numbers
