"""Lines of JSON objects to samples."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from rtamt.cli.json_lines import (
    flat,
    format_value,
    has_key,
    has_value,
    known_of,
    line_error,
    number_of,
    object_in,
    stamp_in,
    value_in,
)
from rtamt.cli.rounded import Rounded, may_be_rounded
from rtamt.signals.arrays import TIME

if TYPE_CHECKING:
    from rtamt.cli.inexact import Inexact
    from rtamt.cli.json_lines import Known
    from rtamt.cli.stream_members import StreamMembers
    from rtamt.cli.stream_times import Sample, StreamTimestamps
    from rtamt.readers.selection import Choice
    from rtamt.signals.coding import Types


class JsonSamples:
    """Samples as JSON objects; the first one determines the key of the timestamp."""

    def __init__(
        self,
        names: tuple[str, ...],
        timestamps: StreamTimestamps,
        dense: bool,
        choice: Choice,
        rounded: Rounded,
        types: Types,
        members: StreamMembers | None = None,
        *,
        inexact: Inexact,
    ) -> None:
        self._names = names
        self._rounded = rounded
        self._types = types
        self._members = members
        self._timestamps = timestamps
        self._dense = dense
        self._inexact = inexact
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
            filled = any(has_value(data, each) for each in self._choice.others[name])
            present = has_value if filled or has_value(data, self._choice.names.get(name, name)) else has_key
            columns[name] = self._choice.column_of(name, partial(present, data))
        if self._dense:
            names = [name for name in names if has_value(data, columns[name])]
        elif self._inexact.late:
            names = [name for name in names if has_key(data, columns[name])]
        values: dict[str, Any] = {name: self._known(data, name, number) for name in names}
        if self._members is not None:
            found = self._members.in_object(data, number)
            if timestamps is not None:
                found.pop(timestamps.field.column, None)
            values = found | values
        for name, value in values.items():
            given: Any = None if value is None else value_in(data, columns.get(name, name), number)
            ends = zip(value, given, strict=True) if isinstance(value, tuple) else [(value, given)]
            for end, written in ends:
                if may_be_rounded(end):
                    self._rounded.add(name, written, number)
        timestamp = None if timestamps is None else stamp_in(data, timestamps.field.column, number)
        return self._timestamps.sample(timestamp, values, number)

    def _known(self, data: dict[str, Any], name: str, number: int) -> Known:
        """Return what is known of a variable, a number where the monitor takes exact samples only."""
        column, type_ = self._columns[name], self._types.get(name)
        value = value_in(data, column, number, name)
        if self._inexact.taken:
            return known_of(value, column, number, type_)
        self._timestamps.require(column, value, number, self._inexact.missing)
        if isinstance(value, list) and len(value) == 2 and self._inexact.bounds:
            problem = f"expected a number; {self._inexact.bounds}"
            raise line_error(number, f"'{column}' is {format_value(value)}, {problem}", column)
        return number_of(value, column, number, type_)
