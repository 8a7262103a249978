"""Rows of CSV under a header row to samples."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING, Any

from rtamt.cli.json_lines import STDIN, code_of, line_error
from rtamt.cli.rounded import Rounded, may_be_rounded
from rtamt.language.value_types import Enumeration
from rtamt.lazy.modules import np
from rtamt.readers.csv import (
    Column,
    Header,
    check_width,
    is_boolean,
    is_comment,
    is_number,
    numbers,
    read_header,
    truth,
)
from rtamt.readers.first_column import FirstColumn, possible_field
from rtamt.readers.frames import field_of
from rtamt.signals.time_columns import is_stamps, may_be_stamps, split_unit

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from rtamt.cli.inexact import Inexact
    from rtamt.cli.stream_members import StreamMembers
    from rtamt.cli.stream_times import Sample, StreamTimestamps
    from rtamt.signals.coding import Types


class CsvSamples:
    """Samples as rows of CSV under a header row."""

    def __init__(
        self,
        names: tuple[str, ...],
        timestamps: StreamTimestamps,
        dense: bool,
        text: str,
        number: int,
        recorded: Collection[str],
        rounded: Rounded,
        types: Types,
        *,
        skip_nan: bool,
        members: StreamMembers | None = None,
        inexact: Inexact,
    ) -> None:
        self._dense = dense
        self._inexact = inexact
        self._rounded = rounded
        self._timestamps = timestamps
        self._header, _ = read_header(iter([text]), STDIN, number - 1)
        fields = {} if members is None else members.in_header(self._header.names)
        timestamps.add(fields)
        self._types = {name: each.values for name, each in fields.items() if each.values} | dict(types)
        #: The declared units of members.
        self.declared = {name: each.unit for name, each in fields.items() if each.unit}
        self._may_be_absent = fields.keys() - set(names)
        columns = [*self._header.names, *(split_unit(column)[0] for column in self._header.names)]
        known = {*names, *recorded, *fields}
        if names and not any(is_stamps(c) or may_be_stamps(c) or c in known for c in columns):
            shown = text if len(text) <= 60 else f"{text[:60]}..."
            raise line_error(
                number,
                f'expected a JSON object, such as {{"time": 0, "x": 1}}, or a row of CSV column names, '
                f"got '{shown}'",
            )
        selection = timestamps.select((column, None) for column in self._header.names)
        assert selection is not None
        self._columns = [
            Column(name, self._header.names.index(f.column), skip_nan) for name, f in selection.signals
        ]
        possible = None
        if timestamps.column is None and timestamps.guessed and all(c.position for c in self._columns):
            possible = possible_field([field_of(column, "") for column in self._header.names])
        self._first_column = None if possible is None else FirstColumn(possible)
        self.units = {name: field.unit for name, field in selection.signals if field.unit}
        self._boolean: dict[str, bool] = {}

    @property
    def has_one_column(self) -> bool:
        """Whether an empty line is the one cell of a row."""
        return len(self._header.names) == 1

    def is_comment(self, text: str, number: int) -> bool:
        """Return whether one line is a comment; raise :class:`TraceError` if it may be a sample as well."""
        return is_comment(self._cells(text, number), self._header, number)

    def _cells(self, text: str, number: int) -> list[str]:
        try:
            return next(csv.reader([text], delimiter=self._header.delimiter, skipinitialspace=True))
        except csv.Error as error:
            raise self._header.error(number, str(error)) from None

    def read(self, text: str, number: int) -> Sample:
        """Return the sample in one line."""
        header: Header = self._header
        row = self._cells(text, number)
        check_width(row, header, number)
        if self._first_column is not None:
            first = row[0].strip()
            value = float(first) if is_number(first) else first or None
            self._first_column.take(np.array([value], dtype=np.float64 if is_number(first) else object))
        if self._timestamps.column is None:
            self._timestamps.select(zip(header.names, (cell.strip() or None for cell in row), strict=True))
        empty = [c for c in self._columns if not row[c.position].strip()]
        may_lack = self._inexact.taken and not self._dense
        absent = [c for c in empty if may_lack or c.name in self._may_be_absent]
        given = [c for c in self._columns if c not in (empty if self._dense else absent)]
        for column in given:
            self._timestamps.require(column.name, row[column.position].strip(), number, self._inexact.missing)
        members = {c.name: self._member(c, row, number) for c in given if c.name in self._types}
        codes = {name: code for name, code in members.items() if code is not None}
        given = [c for c in given if c.name not in codes]
        truths = [c for c in given if self._is_boolean(c.name, row[c.position].strip())]
        given = [c for c in given if c not in truths]
        values: dict[str, Any] = dict.fromkeys(c.name for c in absent)
        read = numbers(row, header, number, given)
        for column, value in zip(given, read, strict=True):
            if may_be_rounded(value):
                self._rounded.add(column.name, row[column.position], number)
        values |= dict(zip((c.name for c in given), read, strict=True))
        values |= {c.name: float(truth(row[c.position].strip(), c.name, header, number)) for c in truths}
        values |= codes
        timestamps = self._timestamps.column
        timestamp = None if timestamps is None else row[header.names.index(timestamps.field.column)]
        return self._timestamps.sample(timestamp, values, number)

    @property
    def possible_times(self) -> str | None:
        """The name of the first column if it may hold the timestamps, as far as rows were read."""
        if self._first_column is None or self._timestamps.column is not None:
            return None
        return self._first_column.possible_times

    def _member(self, column: Column, row: Sequence[str], number: int) -> float | None:
        """Return the code of the member in a cell, None where a number is expected."""
        text = row[column.position].strip()
        type_ = self._types.get(column.name)
        if not isinstance(type_, Enumeration) or (is_number(text) and type_.code(text) is None):
            return None
        return code_of(text, column.name, type_, number)

    def _is_boolean(self, name: str, text: str) -> bool:
        """Return whether a column holds true and false, from its first cell, as in a file."""
        return self._boolean.setdefault(name, is_boolean(text))
