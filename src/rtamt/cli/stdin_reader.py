"""Lines of text to samples: JSON objects, or CSV with a header row; the first line tells which."""

from __future__ import annotations

import csv
import json
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.errors import TraceError
from rtamt.language.units import UNITS, exact
from rtamt.readers.csv import (
    TIME_NAMES,
    Header,
    check_width,
    find,
    find_time,
    numbers,
    read_header,
    time_unit,
)
from rtamt.readers.csv_cells import DATE, EXAMPLE, Cells
from rtamt.signals.arrays import missing_variable
from rtamt.signals.ticks import FARTHEST

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

#: What messages call the input.
STDIN = "stdin"

#: The time (None if there are no stamps) and the values.
Sample = tuple[Any, dict[str, float]]

_INFINITIES = ("inf", "-inf")


class Samples:
    """Reads one sample from each line: its time stamp (None if there are none) and the values wanted.

    A stamp is seconds; ``dense``: or nanoseconds (integers of numpy) where the unit is less than a
    second, or a date, and a sample may hold some of the values only. ``unit``: of stamps that are
    numbers, by default what a CSV header says, else seconds.
    """

    def __init__(
        self,
        names: Sequence[str],
        time_name: str | None = None,
        *,
        dense: bool = False,
        unit: str | None = None,
    ) -> None:
        self._names = tuple(names)
        self._time_name = time_name
        self._dense = dense
        self._unit = unit
        self._read: Callable[[str, int], Sample] | None = None

    def read(self, line: bytes, number: int) -> Sample | None:
        """Return the sample in line ``number`` (from 1); None for an empty line, a comment, the CSV header.

        Raises :class:`TraceError`, with the line number; the next line can be read all the same.
        """
        try:
            text = line.decode("utf-8-sig" if self._read is None else "utf-8").strip("\r\n")
        except UnicodeDecodeError:
            raise _error(number, "not UTF-8 text") from None
        if not text.strip() or text.startswith("#"):
            return None
        if self._read is not None:
            return self._read(text, number)
        if text.lstrip().startswith("{"):
            reader = JsonSamples(self._names, self._time_name, self._dense, self._unit)
            sample = reader.read(text, number)
            self._read = reader.read
            return sample
        self._read = CsvSamples(self._names, self._time_name, self._dense, self._unit, text, number).read
        return None


class JsonSamples:
    """Samples as JSON objects; the first one tells where the time stamp is."""

    def __init__(self, names: tuple[str, ...], time_name: str | None, dense: bool, unit: str | None) -> None:
        self._names = names
        self._dense = dense
        self._time_name = time_name
        self._unit = unit or "s"

    def read(self, text: str, number: int) -> Sample:
        """Return the sample in one line."""
        try:
            data = json.loads(text)
        except json.JSONDecodeError as error:
            raise _error(number, f"not JSON: {error.msg} at column {error.colno}") from None
        except (ValueError, RecursionError):
            raise _error(number, "not JSON to read: a number is too long, or nesting too deep") from None
        if not isinstance(data, dict):
            raise _error(number, f'expected a JSON object, such as {{"time": 0, "x": 1}}, got {_shown(data)}')
        if self._time_name is None:
            lowered = {key.lower(): key for key in reversed(data)}
            self._time_name = next((lowered[name] for name in TIME_NAMES if name in lowered), "")
        time = self._time(data, self._time_name, number) if self._time_name else None
        names = [name for name in self._names if not self._dense or _has(data, name)]
        return time, {name: _number(data, name, number) for name in names}

    def _time(self, data: dict[str, Any], name: str, number: int) -> Any:
        value = data.get(name)
        if isinstance(value, str):
            return _stamp(value, self._unit, self._dense, name, number)
        seconds = _number(data, name, number)
        text = str(int(value)) if isinstance(value, int) else repr(seconds)  # an integer to its last digit
        return _stamp(text, self._unit, self._dense, name, number)


class CsvSamples:
    """Samples as rows of CSV under a header row."""

    def __init__(
        self,
        names: tuple[str, ...],
        time_name: str | None,
        dense: bool,
        unit: str | None,
        text: str,
        number: int,
    ) -> None:
        self._dense = dense
        self._header, _ = read_header(iter([text]), STDIN, number - 1)
        known = {cell.lower() for cell in self._header.names}
        if names and known.isdisjoint({*TIME_NAMES, *(name.lower() for name in names)}):
            shown = text if len(text) <= 60 else f"{text[:60]}..."
            raise _error(
                number,
                f'expected a JSON object, such as {{"time": 0, "x": 1}}, or a row of CSV column names, '
                f"got '{shown}'",
            )
        self._columns = [find(self._header, name) for name in names]
        time = find_time(self._header, time_name)
        self._time = time
        self._unit = unit or ("s" if time is None else time_unit(self._header, time))

    def read(self, text: str, number: int) -> Sample:
        """Return the sample in one line."""
        header: Header = self._header
        try:
            row = next(csv.reader([text], delimiter=header.delimiter, skipinitialspace=True))
        except csv.Error as error:
            raise header.error(number, str(error)) from None
        check_width(row, header, number)
        given = [c for c in self._columns if not self._dense or row[c.position].strip()]
        values = dict(zip((c.name for c in given), numbers(row, header, number, given), strict=True))
        if self._time is None:
            return None, values
        text, name = row[self._time.position].strip(), header.names[self._time.position]
        if DATE.fullmatch(text) is None:
            numbers(row, header, number, [self._time])  # says what is wrong
        return _stamp(text, self._unit, self._dense, name, number), values


def _stamp(text: str, unit: str, dense: bool, name: str, number: int) -> Any:
    """Return a number or a date as a time."""
    if DATE.fullmatch(text) is not None:
        cells = Cells(Header(STDIN, (name,), ",", 0), name)
        cells.extend([text], [number])
        moment = cells.values()[0]
        return moment if dense else float(moment.astype(np.int64) / 1e9)
    try:
        value = float(text)
        if not dense or unit == "s" or not isfinite(value):
            # A division by a whole number rounds once; a product with 0.001 would round twice.
            return value / float(1 / UNITS[unit])
        nanoseconds = round(exact(text) * UNITS[unit] * 10**9)
    except ValueError:
        problem = f"expected a number, or a date such as {EXAMPLE}"
        raise _error(number, f"'{name}' is {_shown(text)}, {problem}") from None
    if abs(nanoseconds) >= FARTHEST:
        raise _error(number, f"'{name}' is {text} {unit}, too far from 0: subtract a start time")
    return np.int64(nanoseconds)


def _number(data: dict[str, Any], name: str, number: int) -> float:
    try:
        value = _member(data, name)
    except KeyError:
        raise _error(number, str(missing_variable(name, list(data))), name) from None
    if isinstance(value, (bool, int, float)):
        try:
            return float(value)
        except OverflowError:
            raise _error(number, f"'{name}' is {_shown(value)}, beyond the range of a double", name) from None
    if value in _INFINITIES:
        return float(value)
    raise _error(number, f"'{name}' is {_shown(value)}, expected a number", name)


def _has(data: dict[str, Any], name: str) -> bool:
    try:
        return _member(data, name) is not None
    except KeyError:
        return False


def _member(data: dict[str, Any], name: str) -> Any:
    """Return what is called ``name``: a key, or fields of nested objects (``req.value``)."""
    if name in data:
        return data[name]
    value: Any = data
    for part in name.split("."):
        if not isinstance(value, dict):
            raise KeyError(name)
        value = value[part]
    return value


def _shown(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= 40 else f"{text[:40]}..."


def _error(number: int, problem: str, variable: str | None = None) -> TraceError:
    return TraceError(f"{STDIN}, line {number}: {problem}", variable=variable)
