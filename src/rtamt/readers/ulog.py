"""PX4 flight logs (ULog), with pyulog: a table for each instance of each topic."""

from __future__ import annotations

import struct
from contextlib import redirect_stdout
from io import StringIO
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError
from rtamt.readers.source import Field, Source, Table, library, opening

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.readers.source import Raw

#: The field of every topic that says when it was logged: microseconds since the autopilot's start.
_CLOCK = "timestamp"


def open_ulog(path: str) -> Source:
    """Open a flight log.

    A field is called ``topic.field``, that of further instances ``topic[1].field``, elements of arrays
    ``topic.field[0]``. Names with brackets need another one to be used in formulas: ``names=``.
    """
    core = library("pyulog.core", "PX4 flight logs")
    exceptions = library("pyulog.exceptions", "PX4 flight logs")
    # What is no ULog fails in ways of its own: a struct is cut, a text cannot be decoded.
    broken = (exceptions.ULogException, struct.error, ValueError, KeyError, IndexError, TypeError)
    # It prints what is damaged, where the robustness of a command line goes.
    said = StringIO()
    with opening(path, "a PX4 flight log", *broken), open(path, "rb") as file, redirect_stdout(said):
        log = core.ULog(file)
    topics = sorted(log.data_list, key=lambda topic: (topic.name, topic.multi_id))
    for topic in topics:
        if _CLOCK not in topic.data:
            raise TraceError(
                f"'{path}' cannot be read as a PX4 flight log: the topic '{topic.name}' has no field '{_CLOCK}'"
            )
    return Source(path, tuple(map(_table, topics)), notes=(*_dropouts(log), *_damage(said.getvalue())))


def _table(topic: Any) -> Table:
    prefix = topic.name if topic.multi_id == 0 else f"{topic.name}[{topic.multi_id}]"
    names = {f"{prefix}.{field}": field for field in topic.data}
    clock = Field(f"{prefix}.{_CLOCK}", f"{prefix}.{_CLOCK}", "us", "number")
    fields = [Field(name, name, "", "number") for name in names if name != clock.column]

    def load(wanted: Sequence[Field]) -> list[Raw]:
        return [topic.data[names[field.column]] for field in wanted]

    return Table((clock, *fields), load, clock=clock)


def _dropouts(log: Any) -> tuple[str, ...]:
    if not log.dropouts:
        return ()
    lost = sum(dropout.duration for dropout in log.dropouts) / 1000  # durations are in milliseconds
    return (f"{len(log.dropouts)} dropouts of the logger, {lost:g} s in all: nothing was recorded in them",)


def _damage(said: str) -> tuple[str, ...]:
    lines = list(dict.fromkeys(line.strip() for line in said.splitlines() if line.strip()))
    if not lines:
        return ()
    more = f" (and {len(lines) - 1} more)" if len(lines) > 1 else ""
    return (f"pyulog says: {lines[0]}{more}",)
