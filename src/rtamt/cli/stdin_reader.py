"""Lines of text to samples: JSON objects, or CSV with a header row; the first line decides."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.cli.inexact import Inexact
from rtamt.cli.json_lines import STDIN, line_error
from rtamt.cli.rounded import Rounded
from rtamt.cli.stream_csv import CsvSamples
from rtamt.cli.stream_json import JsonSamples
from rtamt.cli.stream_times import StreamTimestamps
from rtamt.errors import TraceError
from rtamt.readers.csv import separator
from rtamt.readers.selection import Choice
from rtamt.signals.arrays import TIME
from rtamt.signals.binding import Binding
from rtamt.signals.coding import NO_TYPES
from rtamt.signals.unit_conversion import conversion_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from rtamt.cli.stream_members import StreamMembers
    from rtamt.cli.stream_times import Sample
    from rtamt.signals.coding import Types


class Samples:
    """Reads one sample from each line: its timestamp (None if there are none) and the selected values.

    A timestamp is seconds; ``dense``: or what else a file of the same columns is read as, and a sample may
    hold some of the values only. ``time_name``: the column of timestamps, "" for none, by default the one
    that :func:`rtamt.read` would take. ``unit``: of timestamps that are numbers. ``binding``: under which names the
    variables are recorded, and in which units they are declared. ``skip_nan``: whether a value may be NaN. ``members``:
    finds the members of groups, which may be absent. ``inexact``: how missing samples and bounds are handled.
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
        inexact: Inexact | None = None,
    ) -> None:
        self._inexact = Inexact() if inexact is None else inexact
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

        Under a header of one column, an empty line is a missing sample, as in files.
        Raises :class:`TraceError`, with the line number; the next line can be read all the same.
        """
        try:
            text = line.decode("utf-8-sig" if self._read is None else "utf-8").strip("\r\n")
        except UnicodeDecodeError:
            raise line_error(number, "not UTF-8 text") from None
        if not text.strip():
            if self._rows is None or not self._rows.has_one_column:
                return None
            text = '""'
        if text.startswith("#") and (self._rows is None or self._rows.is_comment(text, number)):
            return None
        if number == 1 and separator(text) is not None:
            return None
        try:
            if self._read is not None:
                return self._read(text, number)
            timestamps = StreamTimestamps(self._names, self._choice, self._dense)
            if text.lstrip().startswith("{"):
                reader = JsonSamples(
                    self._names,
                    timestamps,
                    self._dense,
                    self._choice,
                    self._rounded,
                    self._types,
                    self.members,
                    inexact=self._inexact,
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
                inexact=self._inexact,
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


def lines_of(stream: Iterable[bytes]) -> Iterator[tuple[int, bytes]]:
    r"""Yield the lines of a stream as they arrive, with their numbers; they end with LF, CR LF or CR, as in files.

    An empty line arrives with the next line that is neither empty nor a comment, since it may be a missing sample:
    without such a line, it is at the end, and is left out.

    >>> list(lines_of([b"x\n", b"1\n", b"\n", b"# note\n", b"2\n", b"\n"]))
    [(1, b'x'), (2, b'1'), (4, b'# note'), (3, b''), (5, b'2')]
    """
    empty: list[range] = []  # their numbers: a stream that is idle may send any number of empty lines
    for number, line in enumerate((each for part in stream for each in part.splitlines()), 1):
        if not line.decode("utf-8", "replace").strip():
            begin = empty.pop().start if empty and empty[-1].stop == number else number
            empty.append(range(begin, number + 1))
            continue
        if not line.startswith(b"#"):
            yield from ((each, b"") for lines in empty for each in lines)
            empty.clear()
        yield number, line
