"""ROS bags, with rosbags: ROS 1, ROS 2 (sqlite3 and MCAP), a table for each topic."""

from __future__ import annotations

import os
from contextlib import ExitStack, contextmanager
from itertools import groupby, islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError
from rtamt.extras import library
from rtamt.readers.bag_topic import SAME_CLOCK, STAMP, Rows, Topic, use_one_clock
from rtamt.readers.formats import BAG, MCAP, METADATA
from rtamt.readers.mcap import refuse_encodings, salvage
from rtamt.readers.message_definitions import require_one_definition
from rtamt.readers.message_fields import NEAREST, SCAN, has_arrays, header_time, shape_of, union
from rtamt.readers.source import Field, Source, Table, damaged, printable, reason

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from rtamt.readers.message_fields import Shape, Steps
    from rtamt.readers.source import Raw

#: Messages that are read at a time where a bag is read in chunks.
_MESSAGES = 4096
#: Bytes within which the first line of a bag of ROS 1 ends.
_FIRST_LINE = 64
#: Messages among which the first stamp that is not 0 shows the clock of a topic, and one soon after 0 that it starts
#: at 0, so that stamps were not left at 0.
_FIRST_STAMPS = 100


def open_bag(path: str, recover: bool = False) -> Source:
    """Open a bag. ``recover``: read a damaged MCAP file as far as possible.

    A column is called ``/topic.field.path``, elements of arrays ``/topic.ranges[0]``: what any message of the topic
    holds. Arrays of more than 1000 elements, such as images, have no columns. A laser scan also has the column
    ``/topic.ranges.min``, its least valid range: -inf if something is too close to measure, inf if no range is valid.
    The time of a message is the stamp in its header, in nanoseconds; where there is none, or it was left at 0, the time
    at which it was recorded. Stamps of another clock than that of the recording, such as simulated time, are replaced
    by the times of recording if topics with the clock of the recording are read, too; a note reports this.
    """
    with ExitStack() as stack:
        reader, losses = stack.enter_context(open_reader(path, recover))
        # A damaged database may hold anything where a name was.
        ordered = sorted(reader.connections, key=lambda connection: str(connection.topic))
        topics = [
            _topic(reader, topic, list(group)) for topic, group in groupby(ordered, lambda c: str(c.topic))
        ]
        found = [topic for topic in topics if topic is not None]

        def complete(names: Collection[str] | None) -> tuple[Table, ...]:
            _complete(reader, [topic for topic in found if topic.may_have_more(names)])
            return tuple(topic.table for topic in found)

        def in_one_pass(wanted: Sequence[tuple[int, Sequence[Field]]]) -> Iterator[list[list[Raw]]]:
            return _together(reader, [(found[place], fields) for place, fields in wanted])

        def align(places: Sequence[int]) -> frozenset[int]:
            use_one_clock([found[place] for place in places])
            return frozenset(place for place in places if found[place].by_recording)

        tables = tuple(topic.table for topic in found)
        close = stack.pop_all().close
        return Source(
            path,
            tables,
            losses=losses,
            close=close,
            in_one_pass=in_one_pass,
            align=align,
            complete=complete,
        )


@contextmanager
def open_reader(path: str, recover: bool = False) -> Iterator[tuple[Any, tuple[str, ...]]]:
    """Open any bag; yield its reader, and what was lost. Raise :class:`TraceError` if it is not a bag."""
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
            except TraceError as error:
                try:
                    reader = _reader(copy)  # all messages are complete, but their index is damaged
                except TraceError:
                    raise error from None  # which names the file, and not its copy
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
        try:
            require_one_definition(path, reader.connections, typesys)
        except BaseException:
            reader.close()
            raise
    return reader


def messages(reader: Any, connections: Sequence[Any] = ()) -> Iterator[tuple[Any, int, bytes]]:
    """Yield connections, times of recording and messages as bytes; raise :class:`TraceError` if a bag is damaged."""
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
    """Return a path; raise the error of ``open`` if the file does not exist."""
    if os.path.isdir(path):
        if not os.path.isfile(os.path.join(path, METADATA)):
            raise TraceError(
                f"'{path}' is a folder without {METADATA}, so that it is no bag of ROS 2; name a file"
            )
    else:
        with open(path, "rb") as file:
            # Its library reads the first line, however long that is.
            if path.lower().endswith(".bag") and b"\n" not in file.read(_FIRST_LINE):
                raise damaged(path, BAG.name, "the file does not begin with a line such as #ROSBAG V2.0")
    return Path(path)


def _topic(reader: Any, topic: str, connections: list[Any]) -> Topic | None:
    """Return a topic; None where it has no message."""
    kinds = {connection.msgtype for connection in connections}
    first = next(messages(reader, connections), None)
    if first is None:
        return None
    if len(kinds) > 1:
        raise TraceError(f"the topic {topic} carries several types of messages: {', '.join(sorted(kinds))}")
    connection, recorded, raw = first
    message = _message(reader, connection, raw)
    behind, from_zero = clock_of(reader, connections, header_time(message), recorded)
    time_field = Field(f"{topic}{STAMP}", f"{topic}{STAMP}", "ns", "number")
    made: list[Topic] = []

    def load(wanted: Sequence[Field]) -> list[Raw]:
        rows, found = Rows(made[0], wanted), 0
        for known, recorded, data in messages(reader, connections):
            found += 1
            rows.take(recorded, _message(reader, known, data))
        columns = rows.columns()
        counted = sum(known.msgcount for known in connections)
        if found < counted:  # a damaged index, or a part of the bag that was changed
            lost = f"{counted - found:,} of the {counted:,} messages on {printable(topic)}"
            table.losses.append(f"{lost} that the bag counts are not in it")
        return columns

    table = Table((time_field,), load, time_field=time_field, has_unit=True)
    steps: dict[str, Steps] = {f"{topic}.{NEAREST}": (NEAREST, topic)} if connection.msgtype == SCAN else {}
    typesys = library("rosbags.typesys", "reading ROS bags", "ros")
    alike = not has_arrays(connection.msgtype, reader.typestore.fielddefs, typesys)
    made.append(Topic(table, connections, steps, alike, from_zero, behind))
    made[0].take(shape_of(message))
    return made[0]


def clock_of(reader: Any, connections: Sequence[Any], stamp: int, recorded: int) -> tuple[int, bool]:
    """Return how far the clock of a topic is behind that of the recording, and whether its stamps start at 0.

    ``stamp``, ``recorded``: of the first message, in nanoseconds. Without stamps, the clock is that of the recording.
    """
    if stamp:
        return recorded - stamp, False
    first = islice(messages(reader, connections), _FIRST_STAMPS)
    stamps = [(header_time(_message(reader, known, data)), at) for known, at, data in first]
    if any(0 < each <= SAME_CLOCK for each, _ in stamps):
        return recorded - stamp, True
    return next(((at - each, False) for each, at in stamps if each), (0, False))


def _complete(reader: Any, topics: Sequence[Topic]) -> None:
    """Find the columns of all messages of some topics, whose arrays may be longer than in the first message."""
    shapes: dict[str, Shape] = {}
    connections = [connection for topic in topics for connection in topic.connections]
    for known, _, data in messages(reader, connections) if connections else ():
        name, shape = str(known.topic), shape_of(_message(reader, known, data))
        shapes[name] = union(shapes[name], shape) if name in shapes else shape
    for topic in topics:
        topic.take(shapes[topic.name])
        topic.completed = True


def _together(reader: Any, wanted: Sequence[tuple[Topic, Sequence[Field]]]) -> Iterator[list[list[Raw]]]:
    """Yield the columns of some topics, some messages at a time, in the order in which these were recorded."""
    rows = {topic.name: Rows(topic, fields) for topic, fields in wanted}
    connections = [connection for topic, _ in wanted for connection in topic.connections]
    found = messages(reader, connections)
    while some := list(islice(found, _MESSAGES)):
        for known, recorded, data in some:
            rows[str(known.topic)].take(recorded, _message(reader, known, data))
        yield [each.columns() for each in rows.values()]


# ---- messages ------------------------------------------------------------------------------------


def _message(reader: Any, connection: Any, raw: Any) -> Any:
    """Return a message of a bag; raise :class:`TraceError` if it is malformed."""
    try:
        return reader.deserialize(raw, connection.msgtype)
    except Exception as error:  # code that rosbags makes of the definition: whatever goes wrong first
        path = reader.paths[0]
        # Only the metadata of the folder states that each message is compressed.
        part = path.is_file() and (path.parent / METADATA).is_file()
        hint = f"; the file is a part of a bag: give its folder, '{path.parent}'" if part else ""
        raise TraceError(
            f"a message on {printable(str(connection.topic))} cannot be read as "
            f"{printable(str(connection.msgtype))}: {reason(error)}{hint}"
        ) from error
