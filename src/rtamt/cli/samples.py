"""Lines of text to samples: JSON objects, or CSV with a header row; the first line tells which."""

from __future__ import annotations

import csv
import json
from typing import TYPE_CHECKING, Any

from rtamt.engine.signals import missing_variable
from rtamt.errors import TraceError
from rtamt.readers.csv import TIME_NAMES, Column, Header, find, find_time, numbers, read_header, time_divisor

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

#: What messages call the input.
STDIN = "stdin"

Sample = tuple["float | None", dict[str, float]]

_INFINITIES = ("inf", "-inf")


class Samples:
    """Reads one sample from each line: its time stamp (None if there are none) and the values wanted.

    ``partial``: a JSON object may hold some of the values only, as in dense time.
    """

    def __init__(self, names: Sequence[str], time_name: str | None = None, *, partial: bool = False) -> None:
        self._partial = partial
        self._names = tuple(names)
        self._time_name = time_name
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
            reader = JsonSamples(self._names, self._time_name, self._partial)
            sample = reader.read(text, number)
            self._read = reader.read
            return sample
        self._read = CsvSamples(self._names, self._time_name, text, number).read
        return None


class JsonSamples:
    """Samples as JSON objects; the first one tells where the time stamp is."""

    def __init__(self, names: tuple[str, ...], time_name: str | None, partial: bool) -> None:
        self._names = names
        self._partial = partial
        self._time_name = time_name

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
        time = _number(data, self._time_name, number) if self._time_name else None
        names = [name for name in self._names if not self._partial or _has(data, name)]
        return time, {name: _number(data, name, number) for name in names}


class CsvSamples:
    """Samples as rows of CSV under a header row."""

    def __init__(self, names: tuple[str, ...], time_name: str | None, text: str, number: int) -> None:
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
        self._time: list[Column] = [] if time is None else [time]
        self._divisor = 1.0 if time is None else time_divisor(self._header, time)

    def read(self, text: str, number: int) -> Sample:
        """Return the sample in one line."""
        header: Header = self._header
        try:
            row = next(csv.reader([text], delimiter=header.delimiter, skipinitialspace=True))
        except csv.Error as error:
            raise header.error(number, str(error)) from None
        values = numbers(row, header, number, self._columns)
        stamp = numbers(row, header, number, self._time)
        time = stamp[0] / self._divisor if stamp else None
        return time, {column.name: value for column, value in zip(self._columns, values, strict=True)}


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
        _member(data, name)
    except KeyError:
        return False
    return True


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
