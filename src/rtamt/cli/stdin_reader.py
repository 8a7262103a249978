"""Lines of text to samples: JSON objects, or CSV with a header row; the first line decides."""

from __future__ import annotations

import csv
from collections import Counter
from functools import partial
from typing import TYPE_CHECKING, Any

from rtamt.cli.json_lines import (
    STDIN,
    code_of,
    flat,
    has_value,
    line_error,
    number_in,
    object_in,
    stamp_in,
    value_in,
)
from rtamt.cli.rounded import Rounded, may_be_rounded
from rtamt.errors import TraceError
from rtamt.language.value_types import Enumeration
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.modules import np
from rtamt.readers.assemble import Choice, select, timestamps_of
from rtamt.readers.csv import (
    Column,
    Header,
    check_width,
    is_boolean,
    is_comment,
    is_number,
    numbers,
    read_header,
    separator,
    truth,
)
from rtamt.readers.csv_cells import Cells
from rtamt.readers.dates import is_date
from rtamt.readers.first_column import FirstColumn, possible_field
from rtamt.readers.frames import field_of
from rtamt.readers.source import Source, Table
from rtamt.readers.timestamps import CHOICES
from rtamt.signals.arrays import TIME
from rtamt.signals.binding import Binding
from rtamt.signals.coding import NO_TYPES
from rtamt.signals.data_errors import missing_sample
from rtamt.signals.time_columns import is_stamps, may_be_stamps, split_unit
from rtamt.signals.trace import in_seconds
from rtamt.signals.unit_conversion import conversion_of

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Sequence

    from rtamt.cli.stream_members import StreamMembers
    from rtamt.readers.assemble import Selection
    from rtamt.readers.source import Field, Raw
    from rtamt.readers.timestamps import TimestampColumn
    from rtamt.signals.coding import Types

#: The time (None if there are no timestamps) and the values: numbers, or None where a member has no sample.
Sample = tuple[Any, dict[str, Any]]


class Samples:
    """Reads one sample from each line: its timestamp (None if there are none) and the selected values.

    A timestamp is seconds; ``dense``: or what else a file of the same columns is read as, and a sample may
    hold some of the values only. ``time_name``: the column of timestamps, "" for none, by default the one
    that :func:`rtamt.read` would take. ``unit``: of timestamps that are numbers. ``binding``: under which names the
    variables are recorded, and in which units they are declared. ``skip_nan``: whether a value may be NaN. ``members``:
    finds the members of groups, which may be absent.
    """

    def __init__(
        self,
        names: Sequence[str],
        time_name: str | None = None,
        *,
        dense: bool = False,
        unit: str | None = None,
        binding: Binding | None = None,
        types: Types = NO_TYPES,
        skip_nan: bool = False,
        members: StreamMembers | None = None,
    ) -> None:
        self._types = types
        self.members = members
        self._skip_nan = skip_nan
        self._names = tuple(names)
        self._binding = Binding(self._names) if binding is None else binding
        units = {} if unit is None else {TIME: unit}
        self._choice = Choice(
            time=time_name, names=dict(self._binding.columns), units=units, others=dict(self._binding.others)
        )
        self._recorded = {
            *self._choice.names.values(),
            *(c for more in self._choice.others.values() for c in more),
        }
        self._dense = dense
        self._read: Callable[[str, int], Sample] | None = None
        self._rows: CsvSamples | None = None
        #: The units that the header of CSV gives.
        self.units: dict[str, str] = {}
        #: What became of other units, and of integers that no double holds, a sentence each.
        self.conversions: list[str] = []
        self._rounded = Rounded(self.conversions)

    def read(self, line: bytes, number: int) -> Sample | None:
        """Return the sample in line ``number`` (from 1); None for an empty line, a comment, the CSV header.

        Raises :class:`TraceError`, with the line number; the next line can be read all the same.
        """
        try:
            text = line.decode("utf-8-sig" if self._read is None else "utf-8").strip("\r\n")
        except UnicodeDecodeError:
            raise line_error(number, "not UTF-8 text") from None
        if not text.strip() or (
            text.startswith("#") and (self._rows is None or self._rows.is_comment(text, number))
        ):
            return None
        if number == 1 and separator(text) is not None:
            return None
        try:
            if self._read is not None:
                return self._read(text, number)
            timestamps = _Timestamps(self._names, self._choice, self._dense)
            if text.lstrip().startswith("{"):
                reader = JsonSamples(
                    self._names,
                    timestamps,
                    self._dense,
                    self._choice,
                    self._rounded,
                    self._types,
                    self.members,
                )
                sample = reader.read(text, number)
                self._read = reader.read
                return sample
            rows = CsvSamples(
                self._names,
                timestamps,
                self._dense,
                text,
                number,
                self._recorded,
                self._rounded,
                self._types,
                skip_nan=self._skip_nan,
                members=self.members,
            )
            self.units = rows.units
            self._rows = rows
            self._read = self._convert(rows)
        except TraceError as error:
            if str(error).startswith(STDIN):
                raise
            raise line_error(number, str(error).replace(f" of {STDIN}", "", 1), error.variable) from None
        return None

    @property
    def possible_times(self) -> str | None:
        """The name of a first column of CSV that may hold the timestamps, as in a file of the lines so far."""
        return None if self._rows is None else self._rows.possible_times

    def _convert(self, rows: CsvSamples) -> Callable[[str, int], Sample]:
        """Return the reader of rows, which converts values to their declared units."""
        found = {}
        for name, declared in {**rows.declared, **dict(self._binding.units)}.items():
            recorded = rows.units.get(name, "")
            conversion = conversion_of(name, recorded, declared) if recorded else None
            self.units[name] = declared
            if conversion is not None:
                found[name] = conversion
                self.conversions.append(f"{name} was converted from {recorded} to {declared}")
        if not found:
            return rows.read

        def read(text: str, number: int) -> Sample:
            time, values = rows.read(text, number)
            for name, conversion in found.items():
                if values.get(name) is not None:
                    values[name] = float(conversion(values[name]))
            return time, values

        return read


def lines_of(stream: Iterable[bytes]) -> Iterator[bytes]:
    """Yield the lines of a stream as they arrive; they end with LF, CR LF or CR, as in files."""
    for line in stream:
        yield from line.splitlines()


class _Timestamps:
    """The position of the timestamps among the columns of a stream, as in a file with the same columns.

    Columns are looked at until the timestamps are found: what a column holds may show in a later line.
    """

    def __init__(self, names: Sequence[str], choice: Choice, dense: bool) -> None:
        self._names = names
        self._choice = choice
        self._dense = dense
        self._kinds: dict[str, str] = {}
        #: How many columns have a name: several are an error where one is read, as in a file.
        self._counts: Counter[str] = Counter()
        #: Whether the column without a name looks like timestamps.
        self._axis = False
        self._samples = 0
        self._cells: Cells | None = None
        self.column: TimestampColumn | None = None

    @property
    def guessed(self) -> bool:
        """Whether no choice of the caller decides which column holds the timestamps."""
        return self._choice.time is None

    def add(self, names: Iterable[str]) -> None:
        """Take further columns for signals."""
        self._names = tuple(dict.fromkeys((*self._names, *names)))

    def require(self, name: str, value: object, number: int) -> None:
        """Raise :class:`TraceError` where a sample of discrete time, in line ``number``, has no value."""
        if value is None or value == "":
            raise line_error(number, str(missing_sample(name, self._samples, None)), name)

    def select(self, columns: Iterable[tuple[str, Any]], *, all_named: bool = True) -> Selection | None:
        """Look for the timestamps among columns and what they hold, None where that is not known yet.

        ``all_named``: whether every variable of the formula must be among them.
        """
        if self.column is not None or (self._choice.time == "" and self._kinds):
            return None
        found = False
        columns = list(columns)
        if not self._kinds:
            self._counts.update(column for column, _ in columns)
        for column, value in columns:
            self._axis |= not column and _is_measured(value)
            if not self._kinds.get(column):
                found |= value is not None or column not in self._kinds
                self._kinds[column] = "" if value is None else "time" if is_date(value) else "number"
        return self._select(all_named) if found else None

    def _select(self, all_named: bool) -> Selection:
        fields = tuple(
            replace(field_of(column, kind), axis=not column and self._axis)
            for column, kind in self._kinds.items()
            for _ in range(max(self._counts[column], 1))
        )
        source = Source(STDIN, (Table(fields, _load),))
        known = {name for field in fields for name in (field.name, field.column)}
        columns = {name: self._choice.column_of(name, known.__contains__) for name in self._names}
        names = tuple(name for name in self._names if all_named or columns[name] in known)
        time = self._choice.time
        if time is None and not any(self._kinds.values()) and not any(is_stamps(f.name) for f in fields):
            time = ""  # the columns' names do not decide, and there is no row yet
        read = {name: columns[name] for name in names}
        choice = Choice(time=time, columns=names, names=read)
        (selection,) = select(source, choice)
        self.column = timestamps_of(source, selection, replace(choice, units=self._choice.units))
        if self.column is not None and self._samples:
            column = self.column.field.column
            self.column = None
            del self._kinds[column]
            raise TraceError(
                f"'{column}' may hold the timestamps, but is empty before: give every sample its time, or {CHOICES}"
            )
        return selection

    def sample(self, timestamp: str | None, values: dict[str, float], number: int) -> Sample:
        """Return a sample with its timestamp, a text in line ``number``; None where there are no timestamps."""
        time = None
        if timestamp is None and not self._samples and self._choice.units:
            raise line_error(number, "there is no timestamp: name its column, or leave out --time-unit")
        if timestamp is not None:
            assert self.column is not None
            if self._cells is None:
                column = self.column.field.column
                self._cells = Cells(Header(STDIN, (column,), ",", 0), column)
            self._cells.extend([timestamp], [number])
            times = self.column.times(self._cells.take(), self._samples)
            time = times[0] if times.dtype.kind != "f" else float(times[0])
            if TIME in self._names:  # a formula may read the time
                values[TIME] = float(in_seconds(times)[0])
        self._samples += 1
        return time, values


def _is_measured(value: Any) -> bool:
    """Return whether a cell holds a number with a point or an exponent, and not the number of a row."""
    return isinstance(value, str) and is_number(value) and not value.lstrip("+-").isdigit()


def _load(_: Sequence[Field]) -> list[Raw]:
    raise AssertionError("a stream is read line by line")


class JsonSamples:
    """Samples as JSON objects; the first one determines the key of the timestamp."""

    def __init__(
        self,
        names: tuple[str, ...],
        timestamps: _Timestamps,
        dense: bool,
        choice: Choice,
        rounded: Rounded,
        types: Types,
        members: StreamMembers | None = None,
    ) -> None:
        self._names = names
        self._rounded = rounded
        self._types = types
        self._members = members
        self._timestamps = timestamps
        self._dense = dense
        self._choice = choice
        self._columns = {name: choice.names.get(name, name) for name in names}

    def read(self, text: str, number: int) -> Sample:
        """Return the sample in one line."""
        data = object_in(text, number)
        if self._timestamps.column is None:
            self._timestamps.select(flat(data), all_named=False)
        timestamps = self._timestamps.column
        names = [name for name in self._names if timestamps is None or name != TIME]
        columns = self._columns
        for name in self._choice.others:
            columns[name] = self._choice.column_of(name, partial(has_value, data))
        names = [name for name in names if not self._dense or has_value(data, columns[name])]
        for name in names:
            self._timestamps.require(columns[name], value_in(data, columns[name], number, name), number)
        values = {name: number_in(data, columns[name], number, self._types.get(name)) for name in names}
        if self._members is not None:
            found = self._members.in_object(data, number)
            if timestamps is not None:
                found.pop(timestamps.field.column, None)
            values = found | values
        for name, value in values.items():
            if may_be_rounded(value):
                self._rounded.add(name, value_in(data, columns.get(name, name), number), number)
        timestamp = None if timestamps is None else stamp_in(data, timestamps.field.column, number)
        return self._timestamps.sample(timestamp, values, number)


class CsvSamples:
    """Samples as rows of CSV under a header row."""

    def __init__(
        self,
        names: tuple[str, ...],
        timestamps: _Timestamps,
        dense: bool,
        text: str,
        number: int,
        recorded: Collection[str],
        rounded: Rounded,
        types: Types,
        *,
        skip_nan: bool,
        members: StreamMembers | None = None,
    ) -> None:
        self._dense = dense
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
        absent = [c for c in empty if c.name in self._may_be_absent]
        given = [c for c in self._columns if c not in (empty if self._dense else absent)]
        for column in given:
            self._timestamps.require(column.name, row[column.position].strip(), number)
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


# ---- JSON ----------------------------------------------------------------------------------------
