"""The timestamps of a stream of lines: which column holds them, and their times."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from rtamt.cli.json_lines import STDIN, line_error
from rtamt.errors import TraceError
from rtamt.lazy.dataclasses import replace
from rtamt.readers.assemble import timestamps_of
from rtamt.readers.csv import Header, is_number
from rtamt.readers.csv_cells import Cells
from rtamt.readers.dates import is_date
from rtamt.readers.frames import field_of
from rtamt.readers.selection import Choice, select
from rtamt.readers.source import Source, Table
from rtamt.readers.timestamps import CHOICES
from rtamt.signals.arrays import TIME
from rtamt.signals.data_errors import STREAM_MENDS, missing_sample
from rtamt.signals.time_columns import is_stamps
from rtamt.signals.trace import in_seconds

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from rtamt.readers.selection import Selection
    from rtamt.readers.source import Field, Raw
    from rtamt.readers.timestamps import TimestampColumn

#: The time (None if there are no timestamps) and the values: numbers, bounds, or None where a sample is missing.
Sample = tuple[Any, dict[str, Any]]


class StreamTimestamps:
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

    def require(self, name: str, value: object, number: int, advice: str = "") -> None:
        """Raise :class:`TraceError` where a sample of discrete time, in line ``number``, has no value."""
        if value is None or value == "":
            problem = str(missing_sample(name, self._samples, None, STREAM_MENDS))
            raise line_error(number, f"{problem}; {advice}" if advice else problem, name)

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
