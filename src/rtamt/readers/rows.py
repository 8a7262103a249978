"""Rows of Python objects (of a sheet, of a query) to columns."""

from __future__ import annotations

from collections import Counter
from contextlib import suppress
from decimal import Decimal
from itertools import chain, islice
from typing import TYPE_CHECKING, Any

from rtamt.lazy.dataclasses import replace
from rtamt.lazy.modules import np
from rtamt.readers.dates import is_date
from rtamt.readers.frames import field_of
from rtamt.readers.numbers import double_of
from rtamt.readers.source import CHUNK, Field, Table
from rtamt.readers.timestamps import is_axis
from rtamt.signals.arrays import is_number

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from rtamt.readers.source import Raw

#: Rows that are examined to distinguish numbers, dates and texts.
_SAMPLE = 100


def table_of_rows(columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> Table:
    """Return a table that is read once, whole or in chunks.

    ``columns``: "" for one to be left out, but for the first one if it may hold the timestamps.
    """
    counts = Counter(columns)
    rows = iter(rows)
    first = list(islice(rows, _SAMPLE))
    rows = chain(first, rows)
    # A name that two columns share keeps both in the list, so that asking for it is an error.
    fields = [field_of(c, _kind([row[i] for row in first])) for i, c in enumerate(columns) if c]
    places = {column: i for i, column in enumerate(columns) if counts[column] == 1}
    if columns and not columns[0]:
        values = [row[0] for row in first]
        kind = _kind(values)
        numbers = [number for number in map(double_of, values) if number is not None]
        axis = kind == "number" and len(numbers) == len(values) and is_axis(numbers)
        if axis or kind == "time":
            fields.insert(0, replace(field_of("", kind), axis=axis))
            places[""] = 0

    def chunks(wanted: Sequence[Field]) -> Iterator[list[Raw]]:
        while block := list(islice(rows, CHUNK)):
            yield [_column([row[places[field.column]] for row in block]) for field in wanted]

    def load(wanted: Sequence[Field]) -> list[Raw]:
        whole = list(rows)
        return [_column([row[places[field.column]] for row in whole]) for field in wanted]

    return Table(tuple(fields), load, chunks)


def _kind(values: Sequence[Any]) -> str:
    """Return the kind of a column from its first values; "" where they do not determine it."""
    given = [value for value in values if value is not None]
    if not given:
        return ""
    if all(isinstance(value, Decimal) or is_number(value) for value in given):
        return "number"
    if is_date(given[0]):
        return "time"
    return "text" if all(isinstance(value, str) for value in given) else ""


def _column(values: list[Any]) -> Raw:
    """Return plain numbers as numbers, anything else as objects."""
    if all(type(value) is float for value in values):
        return np.array(values, dtype=np.float64)
    if all(type(value) is int for value in values):
        with suppress(OverflowError):
            return np.array(values, dtype=np.int64)
    result = np.empty(len(values), dtype=object)
    result[:] = values
    return result
