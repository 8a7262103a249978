"""Which column holds the time stamps, in what unit, and what its values are as times."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import date, datetime, timedelta
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.errors import TraceError
from rtamt.language.units import UNITS
from rtamt.signals.datetimes import nanoseconds_of
from rtamt.signals.ticks import NANOSECOND, TimeScale

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from rtamt.readers.source import Field, Raw

#: What a column of time stamps is called, in any case, perhaps with a unit: ``Time [ms]``, ``time_ms``.
NAMES = ("time", "t", "timestamp", "stamp", "datetime")

#: How people write units of time.
SPELLINGS = {
    "s": "s sec secs second seconds",
    "ms": "ms msec millis millisecond milliseconds",
    "us": "us µs μs usec micros microsecond microseconds",
    "ns": "ns nsec nanos nanosecond nanoseconds",
}
_UNIT_OF = {spelling: unit for unit, spellings in SPELLINGS.items() for spelling in spellings.split()}
_STAMPS = re.compile(rf"(?P<name>{'|'.join(NAMES)})(?:[ _](?P<unit>{'|'.join(_UNIT_OF)}))?")

#: Integers at least this large count since 1970 in that unit: the year 1973 in it, 5138 in the next coarser one.
_SINCE_1970 = (("ns", 10**17), ("us", 10**14), ("ms", 10**11))

#: How numpy keeps a time that is none.
_NOT_A_TIME = np.iinfo(np.int64).min

#: Nanoseconds that a double of seconds holds exactly enough to be rounded back.
_EXACT = 2**50


@dataclass(frozen=True, slots=True)
class Clock:
    """How the stamps of a column become times; found once, the same for all chunks of a stream.

    ``unit``: of numbers, "" for dates. ``kind``: seconds, ns or datetime, as in the engine.
    """

    field: Field
    unit: str
    kind: str
    notes: tuple[str, ...] = ()


def looks_like_stamps(field: Field) -> bool:
    """Tell whether a column is called as columns of time stamps are."""
    return _STAMPS.fullmatch(field.name.lower()) is not None


def guess_field(fields: Sequence[Field], source: str, wanted: Sequence[str]) -> Field | None:
    """Return the field of time stamps by its name, else the one with dates in it; None if there is none.

    What a formula reads (``wanted``) is no candidate while there are others. Raises
    :class:`TraceError` that lists the candidates where there are several.
    """
    found = [field for field in fields if looks_like_stamps(field)]
    found = found or [field for field in fields if field.kind == "time"]
    free = [field for field in found if field.name not in wanted and field.column not in wanted] or found
    if len(free) > 1:
        listing = ", ".join(f"'{field.column}'" for field in free)
        raise TraceError(
            f"{source} has several columns that may hold the time stamps: {listing}; "
            f"choose one with time=, or on the command line --time-column"
        )
    return free[0] if free else None


def clock_of(field: Field, raw: Raw, unit: str | None, guessed: bool, source: str) -> Clock:
    """Return how ``raw``, the first stamps of a column, become times. ``unit``: what the caller says of it."""
    why = "by its name" if looks_like_stamps(field) else "the one column of dates"
    notes = [f"time is '{field.column}', {why}"] if guessed else []
    if raw.dtype.kind == "M":
        return Clock(field, "", "datetime", tuple(notes))
    raw, unit = (_nanoseconds(raw), "ns") if raw.dtype.kind == "m" else (raw, unit)
    if unit is not None:
        unit = _unit(unit, field, source)
    elif field.unit:
        unit = _unit(field.unit, field, source)
    else:
        match = _STAMPS.fullmatch(field.name.lower())
        unit = _UNIT_OF[match["unit"]] if match and match["unit"] else None
    integers = raw.dtype.kind in "iu"
    present = raw.compressed() if isinstance(raw, np.ma.MaskedArray) else raw
    farthest = max(abs(int(present.min())), abs(int(present.max()))) if integers and present.size else 0
    if unit is None:
        unit = next((u for u, least in _SINCE_1970 if farthest >= least), "s")
        if unit != "s":
            notes.append(f"its integers are taken as {unit} since 1970, by their size")
    exact = integers and unit != "s" and farthest * int(UNITS[unit] * 10**9) >= _EXACT
    return Clock(field, unit, "ns" if exact else "seconds", tuple(notes))


def _unit(text: str, field: Field, source: str) -> str:
    unit = _UNIT_OF.get(text.strip().lower()) or (text if text in UNITS else None)
    if unit is None:
        raise TraceError(
            f"the unit of the time column '{field.column}' of {source} is '{text}', which is none of {', '.join(UNITS)}"
        )
    return unit


def times_of(clock: Clock, raw: Raw, source: str) -> NDArray[Any]:
    """Return stamps as the clock's kind of times; raise :class:`TraceError` at one that is missing."""
    if np.ma.isMaskedArray(raw):
        missing = np.ma.getmaskarray(raw)
        if missing.any():
            raise _missing(clock, source, int(missing.argmax()))
        raw = raw.data
    if raw.dtype.kind in "mM" and np.isnat(raw).any():
        raise _missing(clock, source, int(np.isnat(raw).argmax()))
    if clock.kind == "datetime":
        return raw.astype("datetime64[ns]")
    raw = _nanoseconds(raw)
    size = UNITS[clock.unit]
    if clock.kind == "ns":
        named = f"'{clock.field.column}'"
        try:
            return TimeScale(NANOSECOND, "units", size).ticks(raw, clock.field.column)
        except TraceError as error:
            raise TraceError(str(error).replace(named, f"{named} of {source}", 1)) from None
    # A division by a whole number rounds once; a product with 0.001 would round twice.
    return raw.astype(np.float64) / float(1 / size)


def _nanoseconds(raw: Raw) -> Raw:
    return raw.astype("timedelta64[ns]").astype(np.int64) if raw.dtype.kind == "m" else raw


def _missing(clock: Clock, source: str, row: int) -> TraceError:
    return TraceError(f"the time column '{clock.field.column}' of {source} is empty at sample {row}")


def from_objects(values: Sequence[Any]) -> Raw | None:
    """Return dates, or texts of ISO dates, as datetime64[ns], and times since a start as timedelta64[ns]; else None.

    A date with a time zone is converted to UTC; one without is taken as it stands. None is missing.
    """
    found = np.full(len(values), _NOT_A_TIME, np.int64)
    kinds = set()
    for i, value in enumerate(values):
        if value is None:
            continue
        moment = _date_of(value)
        if moment is None:
            return None
        kinds.add("m" if isinstance(moment, timedelta) else "M")
        nanoseconds = nanoseconds_of(moment)
        found[i] = _NOT_A_TIME if nanoseconds is None else nanoseconds
    return None if len(kinds) > 1 else found.view(f"{kinds.pop() if kinds else 'M'}8[ns]")


def zones_of(values: Sequence[Any]) -> set[bool]:
    """Return whether dates have a time zone: one answer, or two where they are not alike."""
    moments = (_date_of(value) for value in values if value is not None)
    return {moment.tzinfo is not None for moment in moments if isinstance(moment, datetime)}


def _date_of(value: Any) -> datetime | timedelta | None:
    """Return a date, a text of one, or a time since a start; None for anything else."""
    if isinstance(value, str):
        try:
            # Python 3.10 reads no 'Z', and milliseconds with three or six digits only.
            return datetime.fromisoformat(value.replace("Z", "+00:00"))
        except ValueError:
            return None
    if isinstance(value, date) and not isinstance(value, datetime):
        return datetime(value.year, value.month, value.day)
    return value if isinstance(value, (datetime, timedelta)) else None
