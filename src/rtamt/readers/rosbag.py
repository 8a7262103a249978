"""ROS bags, with rosbags: ROS 1, ROS 2 (sqlite3 and MCAP), a table for each topic."""

from __future__ import annotations

import os
from contextlib import ExitStack, contextmanager
from itertools import groupby
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.errors import TraceError
from rtamt.extras import library
from rtamt.language.value_types import Enumeration
from rtamt.readers.formats import BAG, MCAP, METADATA
from rtamt.readers.mcap import refuse_encodings, salvage
from rtamt.readers.source import Field, Source, Table, printable, reason
from rtamt.signals.arrays import is_number
from rtamt.signals.recoding import Recoding

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rtamt.readers.source import Raw

#: Elements of an array that become columns of their own; longer ones are images and clouds of points.
_ELEMENTS = 1000

#: The steps from a message to a number in it.
Steps = tuple["str | int", ...]


def open_bag(path: str, recover: bool = False) -> Source:
    """Open a bag. ``recover``: read a damaged MCAP file as far as possible.

    A column is called ``/topic.field.path``, elements of arrays ``/topic.ranges[0]``: what the first
    message of the topic holds. The time of a message is the stamp in its header, in nanoseconds; where
    there is none, or it was left at 0, the time at which it was recorded.
    """
    with ExitStack() as stack:
        reader, losses = stack.enter_context(open_reader(path, recover))
        # A damaged database may hold anything where a name was.
        ordered = sorted(reader.connections, key=lambda connection: str(connection.topic))
        tables = [
            _table(reader, topic, list(group)) for topic, group in groupby(ordered, lambda c: str(c.topic))
        ]
        found = tuple(table for table in tables if table is not None)
        return Source(path, found, losses=losses, close=stack.pop_all().close)


@contextmanager
def open_reader(path: str, recover: bool = False) -> Iterator[tuple[Any, tuple[str, ...]]]:
    """Open any bag; yield its reader, and what is lost of it. Raise :class:`TraceError` where it is none."""
    with ExitStack() as stack:
        losses: tuple[str, ...] = ()
        if recover and path.lower().endswith(MCAP):
            folder = stack.enter_context(TemporaryDirectory(prefix="rtamt-"))
            copy = os.path.join(folder, os.path.basename(path))
            with BAG.guard(path):
                lost = salvage(path, copy)
            losses = (lost,) if lost else ()
            try:
                reader = _reader(copy if lost else path)
            except TraceError:
                reader = _reader(copy)  # every message is there, but their index is damaged
        else:
            reader = _reader(path)
        stack.callback(reader.close)
        yield reader, losses


def _reader(path: str) -> Any:
    highlevel = library("rosbags.highlevel", "reading ROS bags", "ros")
    typesys = library("rosbags.typesys", "reading ROS bags", "ros")
    # ROS 2's sqlite3 files came without definitions of their messages until 2023.
    known = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    with BAG.guard(path):
        if path.lower().endswith(MCAP):
            refuse_encodings(path)
        reader = highlevel.AnyReader([_existing(path)], default_typestore=known)
        reader.open()
    return reader


def messages(reader: Any, connections: Sequence[Any] = ()) -> Iterator[tuple[Any, int, bytes]]:
    """Yield connections, times of recording and messages as bytes; raise :class:`TraceError` where a bag is damaged."""
    path = str(reader.paths[0])
    asked = {connection.topic for connection in connections}
    with BAG.guard(path):
        for message in reader.messages(connections=connections):
            topic = message[0].topic
            if asked and topic not in asked:  # the index is wrong
                raise TraceError(
                    f"'{path}' cannot be read as ROS bag: a message on {printable(str(topic))} is listed under "
                    f"another topic; the file is damaged: copy or export it again"
                )
            yield message


def _existing(path: str) -> Path:
    """Return a path; raise what ``open`` raises where there is no such file."""
    if os.path.isdir(path):
        if not os.path.isfile(os.path.join(path, METADATA)):
            raise TraceError(
                f"'{path}' is a folder without {METADATA}, so that it is no bag of ROS 2; name a file"
            )
    else:
        with open(path, "rb"):
            pass
    return Path(path)


def _table(reader: Any, topic: str, connections: list[Any]) -> Table | None:
    """Return the table of a topic; None where it has no message."""
    kinds = {connection.msgtype for connection in connections}
    first = next(messages(reader, connections), None)
    if first is None:
        return None
    if len(kinds) > 1:
        raise TraceError(f"the topic {topic} carries several types of messages: {', '.join(sorted(kinds))}")
    connection, _, raw = first
    steps = {f"{topic}{_text(path)}": path for path in _numbers(_message(reader, connection, raw))}
    clock = Field(f"{topic} stamp", f"{topic} stamp", "ns", "number")
    losses: list[str] = []

    def load(wanted: Sequence[Field]) -> list[Raw]:
        paths = [steps[field.column] for field in wanted if field != clock]
        stamps: list[int] = []
        rows: list[list[Any]] = []
        recodings: dict[int, Recoding] = {}
        others = 0
        for known, recorded, data in messages(reader, connections):
            message = _message(reader, known, data)
            stamp = _stamp(message) or recorded
            if stamps and stamp <= stamps[-1]:
                if stamp == stamps[-1]:  # a signal has one value at an instant: the first
                    others += [_at(message, path) for path in paths] != rows[-1]
                    continue
                raise TraceError(
                    f"the stamps on {topic} go back by {(stamps[-1] - stamp) / 1e9:.9g} s at message {len(stamps)}: "
                    f"was simulated time set back? Cut the bag there"
                )
            stamps.append(stamp)
            rows.append([_at(message, path) for path in paths])
            if len(rows) == 1:
                enumerated = [(k, f) for k, f in enumerate(f for f in wanted if f != clock) if f.type]
                recodings = {
                    k: Recoding(_at(message, _holder(steps[f.column])), f.type)
                    for k, f in enumerated
                    if isinstance(f.type, Enumeration)
                }
        losses[:] = [] if not others else [_repeated(topic, others)]
        for k, recoding in recodings.items():
            for row in rows:
                row[k] = None if row[k] is None else recoding(float(row[k]))
        return _columns(wanted, clock, stamps, rows)

    fields = [Field(column, column, "", "number") for column in steps]
    return Table((clock, *fields), load, clock=clock, losses=losses)


def _repeated(topic: str, count: int) -> str:
    some = "1 message" if count == 1 else f"{count} messages"
    it, its = ("it is", "has") if count == 1 else ("they are", "have")
    return (
        f"{some} on {printable(topic)} {its} the stamp of the message before and another value; {it} left out"
    )


def _columns(wanted: Sequence[Field], clock: Field, stamps: list[int], rows: list[list[Any]]) -> list[Raw]:
    values = iter(zip(*rows, strict=True))
    found: list[Raw] = []
    for field in wanted:
        if field == clock:
            found.append(np.array(stamps, dtype=np.int64))
            continue
        column = next(values)
        missing = [value is None for value in column]
        numbers = np.array([0.0 if value is None else float(value) for value in column])
        found.append(np.ma.masked_array(numbers, missing) if any(missing) else numbers)
    return found


# ---- messages ------------------------------------------------------------------------------------


def _message(reader: Any, connection: Any, raw: Any) -> Any:
    """Return a message of a bag; raise :class:`TraceError` where it is none of its type."""
    try:
        return reader.deserialize(raw, connection.msgtype)
    except Exception as error:  # code that rosbags makes of the definition: whatever goes wrong first
        path = reader.paths[0]
        # Only the folder says that each message is compressed.
        part = path.is_file() and (path.parent / METADATA).is_file()
        hint = f"; the file is a part of a bag: give its folder, '{path.parent}'" if part else ""
        raise TraceError(
            f"a message on {printable(str(connection.topic))} cannot be read as "
            f"{printable(str(connection.msgtype))}: {reason(error)}{hint}"
        ) from error


def _numbers(message: Any, before: Steps = ()) -> Iterator[Steps]:
    """Yield the way to every number in a message."""
    if is_number(message):
        yield before
    elif hasattr(message, "__dataclass_fields__"):
        for name in message.__dataclass_fields__:
            yield from _numbers(getattr(message, name), (*before, name))
    elif isinstance(message, (np.ndarray, list)) and len(message) <= _ELEMENTS:
        for index, item in enumerate(message):
            yield from _numbers(item, (*before, index))


def _holder(path: Steps) -> Steps:
    """Return the way to the message that holds what is at the end of a way."""
    fields = [k for k, step in enumerate(path) if isinstance(step, str)]
    return path[: fields[-1]] if fields else ()


def _text(path: Steps) -> str:
    return "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in path)


def _at(message: Any, path: Steps) -> Any:
    """Return a number in a message; None where its array is shorter."""
    for step in path:
        if isinstance(step, int):
            if step >= len(message):
                return None
            message = message[step]
        else:
            message = getattr(message, step)
    return message


def _stamp(message: Any) -> int:
    """Return the time in a message's header in nanoseconds, 0 where there is none."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    return 0 if stamp is None else int(stamp.sec) * 10**9 + int(stamp.nanosec)
