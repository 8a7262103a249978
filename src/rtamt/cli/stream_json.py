"""Lines of JSON objects to samples."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from rtamt.cli.json_lines import flat, has_value, number_in, object_in, stamp_in, value_in
from rtamt.cli.rounded import Rounded, may_be_rounded
from rtamt.signals.arrays import TIME

if TYPE_CHECKING:
    from rtamt.cli.stream_members import StreamMembers
    from rtamt.cli.stream_times import Sample, StreamTimestamps
    from rtamt.readers.assemble import Choice
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
