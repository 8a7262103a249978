"""PX4 flight logs (ULog), with pyulog: a table for each instance of each topic."""

from __future__ import annotations

from contextlib import redirect_stdout
from io import StringIO
from os import fstat
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError
from rtamt.readers.source import Field, Source, Table, damage, library

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import BinaryIO

    from rtamt.readers.source import Raw

#: The timestamp field of every topic: microseconds since the autopilot's start.
_TIMESTAMP = "timestamp"


#: Bytes of the header of a message: its size and its type.
_HEADER = 3
#: Bytes of a message at most.
_LONGEST = _HEADER + 2**16 - 1
#: Bytes of the end of a file that are examined at a time.
_BLOCK = 2**20
#: How many times the size of a file is read of it at most.
_AGAIN = 16
#: Fields of all topics together, each element of an array one: a hundred times what an autopilot logs.
_MOST_FIELDS = 2**20


def open_ulog(path: str) -> Source:
    """Open a flight log.

    A field is called ``topic.field``, that of further instances ``topic[1].field``, elements of arrays
    ``topic.field[0]``. ``topic[0].field`` is an alias of ``topic.field``, so that a group has all instances. Names
    with brackets need another one to be used in formulas, ``names=``, or double quotes.
    """
    core = library("pyulog.core", "PX4 flight logs")
    # pyulog prints what is damaged, where the robustness of a command line goes.
    said = StringIO()
    with open(path, "rb") as opened, redirect_stdout(said):
        file = _Watched(opened)
        log = _make_reader(core, path)(file)
    losses = _damage_note(log, said.getvalue(), file)
    topics = sorted(log.data_list, key=lambda topic: (topic.name, topic.multi_id))
    if losses and not topics:
        raise TraceError(f"'{path}' cannot be read as PX4 ULog: {losses[0]}, and no sample comes before that")
    for topic in topics:
        if _TIMESTAMP not in topic.data:
            raise TraceError(
                f"'{path}' cannot be read as PX4 ULog: the topic '{topic.name}' has no field '{_TIMESTAMP}'"
            )
    return Source(path, tuple(map(_table, topics)), losses=(*_dropouts(log), *losses))


def _make_reader(core: Any, path: str) -> Any:
    """Return pyulog's reader, which does not spell out formats of nested arrays without end."""
    left = _MOST_FIELDS

    class Topic(core.ULog._MessageAddLogged):  # type: ignore[misc] # imported at run time
        def _parse_nested_type(self, prefix_str: str, type_name: str, message_formats: Any) -> None:
            nonlocal left
            before = len(self.field_data)
            super()._parse_nested_type(prefix_str, type_name, message_formats)
            left -= 1 + (len(self.field_data) - before)
            if left < 0:
                raise TraceError(
                    f"'{path}' cannot be read as PX4 ULog: its topics have more than {_MOST_FIELDS:,} fields, elements "
                    f"of arrays included; the file is damaged: copy or export it again"
                )

    class Log(core.ULog):  # type: ignore[misc] # imported at run time
        _MessageAddLogged = Topic

    return Log


class _Watched:
    """A file that notes whether it ends in the middle of a message, and that is not read for ever.

    Where it finds damage, pyulog goes back and reads on one byte later: for ever if that is near the end. Of zeros at
    the end, which a logger without power leaves by the MB, it reads those that may belong to a message.
    """

    def __init__(self, file: BinaryIO) -> None:
        self.cut = False
        self._file = file
        size = fstat(file.fileno()).st_size
        self._end = min(size, _end_without_zeros(file, size) + _LONGEST)
        self._left = _AGAIN * self._end + 2**20
        self.seek, self.tell, self.close = file.seek, file.tell, file.close

    def read(self, size: int) -> bytes:
        data = self._file.read(min(size, max(0, self._end - self._file.tell())))
        # At the end of an intact file, pyulog reads three bytes of a further header and finds none.
        self.cut |= len(data) < size and (len(data) > 0 or size != _HEADER)
        self._left -= size
        if self._left < 0:
            raise TraceError(f"'{self._file.name}' cannot be read as PX4 ULog: too much of it is damaged")
        return data


def _end_without_zeros(file: BinaryIO, size: int) -> int:
    """Return where the zeros at the end of a file begin; the file is at its beginning afterwards."""
    end = size
    while end > 0:
        begin = max(0, end - _BLOCK)
        file.seek(begin)
        kept = len(file.read(end - begin).rstrip(b"\0"))
        if kept:
            end = begin + kept
            break
        end = begin
    file.seek(0)
    return end


def _table(topic: Any) -> Table:
    prefix = topic.name if topic.multi_id == 0 else f"{topic.name}[{topic.multi_id}]"
    names = {f"{prefix}.{field}": field for field in topic.data}
    time_field = Field(f"{prefix}.{_TIMESTAMP}", f"{prefix}.{_TIMESTAMP}", "us", "number")
    fields = [
        Field(name, name, "", "number", alias="" if topic.multi_id else f"{topic.name}[0].{field}")
        for name, field in names.items()
        if name != time_field.column
    ]

    def load(wanted: Sequence[Field]) -> list[Raw]:
        return [topic.data[names[field.column]] for field in wanted]

    return Table((time_field, *fields), load, time_field=time_field, has_unit=True)


def _dropouts(log: Any) -> tuple[str, ...]:
    if not log.dropouts:
        return ()
    lost = sum(dropout.duration for dropout in log.dropouts) / 1000  # durations are in milliseconds
    if len(log.dropouts) == 1:
        return (f"a dropout of the logger, {lost:g} s: nothing was recorded in it",)
    return (f"{len(log.dropouts)} dropouts of the logger, {lost:g} s in all: nothing was recorded in them",)


def _damage_note(log: Any, said: str, file: _Watched) -> tuple[str, ...]:
    until = f"up to {log.last_timestamp / 1e6:.9g} s"
    complaints = said.splitlines() or ["messages were skipped"] * log.file_corruption
    if file.cut and not complaints:
        return (f"the file ends in the middle of a message: read {until}",)
    return damage(complaints, f"{until}, ")
