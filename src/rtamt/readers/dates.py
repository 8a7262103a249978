"""Dates of recordings, as texts or as objects: the one place in which they become numpy's."""

from __future__ import annotations

from datetime import date, datetime, timedelta
from typing import TYPE_CHECKING, Any

from rtamt.lazy.modules import np
from rtamt.lazy.patterns import lazy_pattern
from rtamt.signals.datetimes import has_length, nanoseconds_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.readers.source import Raw

#: What messages show.
EXAMPLE = "2026-05-01T12:00:00.5"

#: ISO 8601: a date, perhaps a time, perhaps a time zone.
_DATE = lazy_pattern(
    r"(?P<date>[0-9]{4}-[0-9]{2}-[0-9]{2})"
    r"(?:[T ](?P<time>[0-9]{2}:[0-9]{2}(?::[0-9]{2}(?:\.[0-9]{1,9})?)?)(?P<zone>Z|[+-][0-9]{2}(?::?[0-9]{2})?)?)?"
)
#: Years that nanoseconds since 1970 can hold.
_YEARS = range(1678, 2262)
#: Nanoseconds since 1970 that such years hold.
_FARTHEST = 2**63 - 1
#: Minutes by which the clocks of a zone may differ from UTC: less than a day, as in Python.
_DAY = 24 * 60


class DateError(ValueError):
    """A value in a column of dates is not a date; ``index`` is its position, the message the reason."""

    def __init__(self, index: int, problem: str) -> None:
        super().__init__(problem)
        self.index = index


def is_date(value: Any) -> bool:
    """Return whether a value is a date, the text of one, or a time since a start.

    >>> is_date("2026-05-01T12:00Z"), is_date(12.5), is_date("12.5")
    (True, False, False)
    """
    if isinstance(value, str):
        return _DATE.fullmatch(value.strip()) is not None
    return isinstance(value, (date, timedelta, np.datetime64, np.timedelta64))


def date_in(text: str) -> np.datetime64 | None:
    """Parse a date, in UTC if it has a time zone; None if the text is not a date.

    >>> date_in("2026-05-01T12:00:00.5+02:00"), date_in("12.5")
    (np.datetime64('2026-05-01T10:00:00.500000000'), None)
    """
    if not is_date(text):
        return None
    try:
        found: np.datetime64 = Dates().take([text])[0]
    except DateError:
        return None
    return found


class Dates:
    """The dates of one column, a few at a time: all with a time zone, or all without."""

    def __init__(self) -> None:
        self._zoned: bool | None = None
        self._kind = ""

    def take(self, values: Sequence[Any]) -> Raw:
        """Return dates as datetime64[ns], in UTC, times since a start as timedelta64[ns]; None is NaT.

        Raises :class:`DateError` at the first value that is neither, or not like those before.
        """
        texts = [(i, value.strip()) for i, value in enumerate(values) if isinstance(value, str)]
        found = np.full(len(values), np.iinfo(np.int64).min, np.int64)  # NaT
        if texts:
            self._be("M", texts[0][0])
            found[[i for i, _ in texts]] = self._of_texts(texts).astype(np.int64)
        if len(texts) < len(values):
            for i, value in enumerate(values):
                if value is not None and not isinstance(value, str):
                    found[i] = self._of_object(i, value)
        return found.view(f"{self._kind or 'M'}8[ns]")

    def _of_texts(self, texts: Sequence[tuple[int, str]]) -> Raw:
        timestamps, offsets = [], []
        for i, text in texts:
            match = _DATE.fullmatch(text)
            if match is None:
                raise DateError(i, f"expected a date such as {EXAMPLE}, like those before")
            zone = match["zone"]
            self._zone(i, zone is not None)
            timestamps.append(f"{match['date']}T{match['time'] or '00:00'}")
            offsets.append(_offset(i, zone))
            if int(text[:4]) not in _YEARS:
                raise DateError(i, "a year that nanoseconds since 1970 cannot reach")
        try:
            moments: Raw = np.array(timestamps, dtype="M8[ns]") - np.array(offsets, dtype="m8[m]")
        except ValueError:
            i = next(i for (i, _), timestamp in zip(texts, timestamps, strict=True) if _is_no_date(timestamp))
            raise DateError(i, "which is no date of the calendar") from None
        return moments

    def _of_object(self, i: int, value: Any) -> int:
        if not is_date(value):
            raise DateError(i, f"expected a date such as {EXAMPLE}, like those before")
        since = isinstance(value, (timedelta, np.timedelta64))
        self._be("m" if since else "M", i)
        if isinstance(value, date) and not isinstance(value, datetime):
            value = datetime(value.year, value.month, value.day)
        if isinstance(value, np.timedelta64) and not has_length(value):
            raise DateError(i, "a timedelta64 without a unit of fixed length: give it one, such as 'ms'")
        nanoseconds = nanoseconds_of(value)
        if nanoseconds is None:
            return int(np.iinfo(np.int64).min)
        if not since:
            self._zone(i, getattr(value, "tzinfo", None) is not None)
        if abs(nanoseconds) > _FARTHEST:
            raise DateError(i, "a time that nanoseconds since 1970 cannot reach")
        return nanoseconds

    def _be(self, kind: str, i: int) -> None:
        self._kind = self._kind or kind
        if self._kind != kind:
            now, before = ("date", "time since a start") if kind == "M" else ("time since a start", "date")
            raise DateError(i, f"a {now}, and those before are each a {before}; use one way for all")

    def _zone(self, i: int, zoned: bool) -> None:
        if self._zoned is None:
            self._zoned = zoned
        if self._zoned != zoned:
            has = "a time zone, and those before have" if zoned else "no time zone, and those before have"
            raise DateError(i, f"with {has} {'none' if zoned else 'one'}; use one way for all")


def _offset(i: int, zone: str | None) -> int:
    """Return by how many minutes the clocks of a zone are ahead of UTC."""
    if zone in (None, "Z"):
        return 0
    assert zone is not None
    hours, minutes = int(zone[1:3]), int(zone[3:].lstrip(":") or 0)
    if hours * 60 + minutes >= _DAY or minutes >= 60:
        raise DateError(i, f"whose time zone {zone} is none: give less than 24:00")
    return -(hours * 60 + minutes) if zone[0] == "-" else hours * 60 + minutes


def _is_no_date(timestamp: str) -> bool:
    try:
        np.datetime64(timestamp, "ns")
    except ValueError:
        return True
    return False
