"""Columns of text to columns of numbers or dates, as exact as they are written; an empty cell is a missing value."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from rtamt.readers.csv import Header, number

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.errors import TraceError
    from rtamt.readers.source import Raw

#: What messages show.
EXAMPLE = "2026-05-01T12:00:00.5"

#: ISO 8601: a date, perhaps a time, perhaps a time zone.
DATE = re.compile(
    r"(?P<date>\d{4}-\d\d-\d\d)(?:[T ](?P<time>\d\d:\d\d(?::\d\d(?:\.\d{1,9})?)?)(?P<zone>Z|[+-]\d\d:?\d\d)?)?"
)
#: Years that nanoseconds since 1970 can hold.
_YEARS = range(1678, 2262)
#: From here on a double may not be the integer that was written.
LARGEST = 2.0**53


def date_in(text: str) -> np.datetime64 | None:
    """Return the date that a text is, in UTC where it names a time zone; None where it is none.

    >>> date_in("2026-05-01T12:00:00.5+02:00"), date_in("12.5")
    (np.datetime64('2026-05-01T10:00:00.500000000'), None)
    """
    match = DATE.fullmatch(text.strip())
    if match is None or int(match["date"][:4]) not in _YEARS or _is_no_date(_stamp(match)):
        return None
    return np.datetime64(_stamp(match), "ns") - _offset(match["zone"])


def _stamp(match: re.Match[str]) -> str:
    return f"{match['date']}T{match['time'] or '00:00'}"


def _offset(zone: str | None) -> np.timedelta64:
    """Return by how much the clocks of a zone are ahead of UTC."""
    if zone in (None, "Z"):
        return np.timedelta64(0, "m")
    assert zone is not None
    minutes = int(zone[1:3]) * 60 + int(zone[-2:])
    return np.timedelta64(-minutes if zone[0] == "-" else minutes, "m")


class Cells:
    """One column of a file, which grows by blocks of rows.

    What its first cell is, a number or a date, all others must be.
    """

    def __init__(
        self, header: Header, name: str, dated: bool | None = None, *, skip_nan: bool = False
    ) -> None:
        self._skip_nan = skip_nan
        self._header = header
        self._name = name
        self._dated = dated  # None: not known before the first cell that is not empty
        self._zoned: bool | None = None
        self._whole = True  # whether all numbers are integers that an int64 holds
        self._parts: list[Raw] = []
        self._missing: list[Raw] = []

    def extend(self, texts: Sequence[str], lines: Sequence[int]) -> None:
        """Add cells, each with its line in the file; raise :class:`TraceError` at one that is neither."""
        texts = [text.strip() for text in texts]
        missing = np.array([not text for text in texts], dtype=bool)
        given = [(text, line) for text, line in zip(texts, lines, strict=True) if text]
        if self._dated is None and given:
            self._dated = DATE.fullmatch(given[0][0]) is not None
        values = self._dates(given) if self._dated else self._numbers(given)
        if missing.any():
            part = np.zeros(len(texts), values.dtype)
            part[~missing] = values
            values = part
        self._parts.append(values)
        self._missing.append(missing)

    def values(self) -> Raw:
        """Return all cells: int64 where all are integers, else float64, or datetime64[ns]; masked where empty."""
        parts = self._parts
        if not self._dated:
            parts = [part.astype(np.int64 if self._whole else np.float64) for part in parts]
        result = np.concatenate(parts) if parts else np.empty(0)
        missing = np.concatenate(self._missing) if parts else np.empty(0, dtype=bool)
        return np.ma.masked_array(result, missing) if missing.any() else result

    def take(self) -> Raw:
        """Return all cells since the last call, and forget them."""
        values = self.values()
        self._parts, self._missing = [], []
        return values

    def _numbers(self, given: Sequence[tuple[str, int]]) -> Raw:
        texts = [text for text, _ in given]
        together = "".join(texts)
        try:
            values = np.array(texts, dtype=np.float64)
            plain = self._skip_nan or not np.isnan(values).any()
        except ValueError:
            plain = False
        if not plain or "_" in together or not together.isascii():
            values = np.array([self._number(text, line) for text, line in given])
        if self._whole and len(values):
            largest = float(np.abs(values).max())
            if largest >= LARGEST:
                exact = _integers(texts)
                self._whole = exact is not None
                return values if exact is None else exact
            self._whole = bool((values == np.rint(values)).all())
        return values

    def _number(self, text: str, line: int) -> float:
        value = number(text, self._name, self._header, line, nan=True)
        if np.isnan(value) and not self._skip_nan:
            raise self._header.error(
                line,
                f"'{self._name}' is NaN: fill the gap, or leave such samples out with skip_nan=, "
                f"on the command line --skip-nan",
                self._name,
            )
        return value

    def _dates(self, given: Sequence[tuple[str, int]]) -> Raw:
        stamps, offsets = [], []
        for text, line in given:
            match = DATE.fullmatch(text)
            if match is None:
                raise self._error(line, text, f"expected a date such as {EXAMPLE}, like those before")
            zone = match["zone"]
            if self._zoned is None:
                self._zoned = zone is not None
            if self._zoned != (zone is not None):
                has = "a time zone, and those before have" if zone else "no time zone, and those before have"
                raise self._error(line, text, f"with {has} {'none' if zone else 'one'}; use one way for all")
            stamps.append(_stamp(match))
            offsets.append(_offset(zone))
            if int(text[:4]) not in _YEARS:
                raise self._error(line, text, "a year that nanoseconds since 1970 cannot reach")
        try:
            times: Raw = np.array(stamps, dtype="M8[ns]") - np.array(offsets, dtype="m8[m]")
        except ValueError:
            pairs = zip(stamps, given, strict=True)
            text, line = next(cell for stamp, cell in pairs if _is_no_date(stamp))
            raise self._error(line, text, "which is no date of the calendar") from None
        return times

    def _error(self, line: int, text: str, problem: str) -> TraceError:
        return self._header.error(line, f"'{self._name}' is '{text}', {problem}", self._name)


def _integers(texts: Sequence[str]) -> Raw | None:
    try:
        return np.array([int(text) for text in texts], dtype=np.int64)
    except (ValueError, OverflowError):
        return None


def _is_no_date(stamp: str) -> bool:
    try:
        np.datetime64(stamp, "ns")
    except ValueError:
        return True
    return False
