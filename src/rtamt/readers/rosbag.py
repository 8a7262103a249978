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
from rtamt.language.value_types import Enumeration
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.readers.formats import BAG, MCAP, METADATA
from rtamt.readers.mcap import refuse_encodings, salvage
from rtamt.readers.message_definitions import require_one_definition
from rtamt.readers.source import Field, Source, Table, printable, reason
from rtamt.signals.arrays import is_number
from rtamt.signals.recoding import Recoding

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rtamt.readers.source import Raw

#: The longest array whose elements become columns; longer ones are images and point clouds.
_ELEMENTS = 1000
#: Scans have a column for the nearest obstacle: the least valid range, inf if there is none, and -inf where a ray hit
#: something that is too close to measure (REP 117).
_SCAN, _NEAREST = "sensor_msgs/msg/LaserScan", "ranges.min"
#: Messages that are read at a time where a bag is read in chunks.
_MESSAGES = 4096
#: Messages among which a stamp soon after 0 shows that a topic starts at 0, and that stamps were not left at 0.
_FIRST_STAMPS = 100
#: How far the timestamp of a message may be from its recording, in nanoseconds, if both are from the same clock.
_SAME_CLOCK = 60 * 10**9

#: The steps from a message to a number in it.
Steps = tuple["str | int", ...]


def open_bag(path: str, recover: bool = False) -> Source:
    """Open a bag. ``recover``: read a damaged MCAP file as far as possible.

    A column is called ``/topic.field.path``, elements of arrays ``/topic.ranges[0]``: what the first
    message of the topic holds. A laser scan also has the column ``/topic.ranges.min``, its least valid range: -inf if
    something is too close to measure, inf if no range is valid. The time of a message is the stamp in its header, in
    nanoseconds; where there is none, or it was left at 0, the time at which it was recorded. Stamps of another clock
    than that of the recording, such as simulated time, are replaced by the times of recording if topics with the clock
    of the recording are read, too; a note reports this.
    """
    with ExitStack() as stack:
        reader, losses = stack.enter_context(open_reader(path, recover))
        # A damaged database may hold anything where a name was.
        ordered = sorted(reader.connections, key=lambda connection: str(connection.topic))
        topics = [
            _topic(reader, topic, list(group)) for topic, group in groupby(ordered, lambda c: str(c.topic))
        ]
        found = [topic for topic in topics if topic is not None]

        def in_one_pass(wanted: Sequence[tuple[int, Sequence[Field]]]) -> Iterator[list[list[Raw]]]:
            return _together(reader, [(found[place], fields) for place, fields in wanted])

        def align(places: Sequence[int]) -> None:
            _align([found[place] for place in places])

        tables = tuple(topic.table for topic in found)
        close = stack.pop_all().close
        return Source(path, tables, losses=losses, close=close, in_one_pass=in_one_pass, align=align)


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
        with open(path, "rb"):
            pass
    return Path(path)


@dataclass(slots=True, eq=False)
class _Topic:
    """A topic: its table, and where the numbers of its columns are in a message.

    ``from_zero``: whether a stamp of 0 is a time, the start of a simulation. ``behind``: nanoseconds from the stamp in
    the header of its first message to its recording, 0 without a stamp. ``arrays``: the arrays of messages in its first
    message, and their lengths. ``by_recording``: a note on why stamps in
    headers are ignored; empty if they are used.
    """

    table: Table
    connections: list[Any]
    steps: dict[str, Steps]
    from_zero: bool
    behind: int
    arrays: dict[Steps, int]
    by_recording: str = ""

    @property
    def name(self) -> str:
        return str(self.connections[0].topic)

    def time_of(self, message: Any, recorded: int) -> int:
        """Return the time of a message that was recorded at an instant, in nanoseconds."""
        stamp = recorded if self.by_recording else _header_time(message)
        return stamp if stamp or self.from_zero else recorded


def _topic(reader: Any, topic: str, connections: list[Any]) -> _Topic | None:
    """Return a topic; None where it has no message."""
    kinds = {connection.msgtype for connection in connections}
    first = next(messages(reader, connections), None)
    if first is None:
        return None
    if len(kinds) > 1:
        raise TraceError(f"the topic {topic} carries several types of messages: {', '.join(sorted(kinds))}")
    connection, recorded, raw = first
    message = _message(reader, connection, raw)
    steps = {f"{topic}{_text(path)}": path for path in _numbers(message)}
    stamp = _header_time(message)
    from_zero = stamp == 0 and _starts_at_0(reader, connections)
    if connection.msgtype == _SCAN:
        steps[f"{topic}.{_NEAREST}"] = (_NEAREST, topic)
    time_field = Field(f"{topic} stamp", f"{topic} stamp", "ns", "number")
    made: list[_Topic] = []

    def load(wanted: Sequence[Field]) -> list[Raw]:
        rows, found = _Rows(made[0], wanted), 0
        for known, recorded, data in messages(reader, connections):
            found += 1
            rows.take(recorded, _message(reader, known, data))
        columns = rows.columns()
        counted = sum(known.msgcount for known in connections)
        if found < counted:  # a damaged index, or a part of the bag that was changed
            lost = f"{counted - found:,} of the {counted:,} messages on {printable(topic)}"
            table.losses.append(f"{lost} that the bag counts are not in it")
        return columns

    fields = [Field(column, column, "", "number") for column in steps]
    table = Table((time_field, *fields), load, time_field=time_field, has_unit=True)
    behind = recorded - stamp if stamp or from_zero else 0
    made.append(_Topic(table, connections, steps, from_zero, behind, dict(_arrays(message))))
    return made[0]


def _starts_at_0(reader: Any, connections: Sequence[Any]) -> bool:
    first = islice(messages(reader, connections), _FIRST_STAMPS)
    return any(0 < _header_time(_message(reader, known, data)) <= _SAME_CLOCK for known, _, data in first)


def _align(topics: Sequence[_Topic]) -> None:
    """Use the times of recording on topics whose stamps are from another clock than those of the other topics."""
    same = [topic for topic in topics if abs(topic.behind) <= _SAME_CLOCK]
    for topic in topics:
        topic.by_recording = ""
        if same and abs(topic.behind) > _SAME_CLOCK:
            side = "behind" if topic.behind > 0 else "ahead of"
            topic.by_recording = (
                f"the stamps in the headers on {printable(topic.name)} are {abs(topic.behind) / 1e9:.6g} s {side} the "
                f"clock of the recording, which is that of {printable(same[0].name)}: its messages have the times of "
                f"their recording"
            )


class _Rows:
    """Selected fields of the messages of a topic, in the order of their timestamps."""

    def __init__(self, topic: _Topic, wanted: Sequence[Field]) -> None:
        self._topic, self._wanted = topic, wanted
        self._paths = [topic.steps[field.column] for field in wanted if field != topic.table.time_field]
        self._timestamps: list[int] = []
        self._rows: list[list[Any]] = []
        self._recodings: dict[int, Recoding] = {}
        #: Arrays of messages on the way to a column: their lengths in the first message of the topic, and the longest.
        self._lengths = {way: (count, count) for way, count in topic.arrays.items() if self._reads(way)}
        self._last: tuple[int, list[Any]] | None = None
        self._count = self._others = 0

    def _reads(self, way: Steps) -> bool:
        return any(path[: len(way)] == way for path in self._paths)

    def take(self, recorded: int, message: Any) -> None:
        """Add a message; of several with the same timestamp the first."""
        stamp = self._topic.time_of(message, recorded)
        row = [_at(message, path) for path in self._paths]
        if self._last is not None and stamp <= self._last[0]:
            if stamp == self._last[0]:  # a signal has one value at an instant: the first
                self._others += row != self._last[1]
                return
            raise TraceError(
                f"the timestamps on {self._topic.name} go back by {(self._last[0] - stamp) / 1e9:.9g} s at message "
                f"{self._count}: was simulated time set back? Cut the bag there"
            )
        if not self._count:
            self._recodings = self._recodings_of(message)
        for way, (first, longest) in self._lengths.items():
            elements = _at(message, way)
            self._lengths[way] = first, max(longest, 0 if elements is None else len(elements))
        self._count += 1
        self._last = stamp, row
        self._timestamps.append(stamp)
        self._rows.append(row)

    def _recodings_of(self, message: Any) -> dict[int, Recoding]:
        """Return the readers of enumeration members, by the place of their column."""
        fields = [field for field in self._wanted if field != self._topic.table.time_field]
        return {
            place: Recoding(_at(message, _holder(self._topic.steps[field.column])), field.type)
            for place, field in enumerate(fields)
            if isinstance(field.type, Enumeration)
        }

    def columns(self) -> list[Raw]:
        """Return the messages since the last call."""
        table = self._topic.table
        repeated = _repeated_note(self._topic.name, self._others) if self._others else ""
        longer = [
            _longer_note(f"{self._topic.name}{_text(way)}", first, longest)
            for way, (first, longest) in self._lengths.items()
            if longest > first
        ]
        table.losses[:] = [note for note in (self._topic.by_recording, repeated, *longer) if note]
        assert table.time_field is not None
        rows = [list(row) for row in self._rows] if self._recodings else self._rows
        for place, recoding in self._recodings.items():
            for row in rows:
                row[place] = None if row[place] is None else recoding(float(row[place]))
        found = _columns(self._wanted, table.time_field, self._timestamps, rows)
        self._timestamps, self._rows = [], []
        return found


def _together(reader: Any, wanted: Sequence[tuple[_Topic, Sequence[Field]]]) -> Iterator[list[list[Raw]]]:
    """Yield the columns of some topics, some messages at a time, in the order in which these were recorded."""
    rows = {topic.name: _Rows(topic, fields) for topic, fields in wanted}
    connections = [connection for topic, _ in wanted for connection in topic.connections]
    found = messages(reader, connections)
    while some := list(islice(found, _MESSAGES)):
        for known, recorded, data in some:
            rows[str(known.topic)].take(recorded, _message(reader, known, data))
        yield [each.columns() for each in rows.values()]


def _longer_note(array: str, first: int, longest: int) -> str:
    return (
        f"{printable(array)} has up to {longest} elements, and {first} in the first message, which decides what is "
        f"read: the others are left out"
    )


def _repeated_note(topic: str, count: int) -> str:
    some = "1 message" if count == 1 else f"{count} messages"
    it, its = ("it is", "has") if count == 1 else ("they are", "have")
    return (
        f"{some} on {printable(topic)} {its} the stamp of the message before and another value; {it} left out"
    )


def _columns(
    wanted: Sequence[Field], time_field: Field, timestamps: list[int], rows: list[list[Any]]
) -> list[Raw]:
    values: Iterator[tuple[Any, ...]] = iter(zip(*rows, strict=True) if rows else [()] * len(wanted))
    found: list[Raw] = []
    for field in wanted:
        if field == time_field:
            found.append(np.array(timestamps, dtype=np.int64))
            continue
        column = next(values)
        missing = [value is None for value in column]
        numbers = _numbers_in([0 if value is None else value for value in column])
        found.append(np.ma.masked_array(numbers, missing) if any(missing) else numbers)
    return found


def _numbers_in(column: list[Any]) -> Raw:
    """Return numbers as an array: integers as integers, since doubles do not hold all of them."""
    if column and all(
        isinstance(value, int | np.integer) and not isinstance(value, bool) for value in column
    ):
        whole = [int(value) for value in column]
        if min(whole) >= -(2**63) and max(whole) < 2**63:
            return np.array(whole, np.int64)
        if min(whole) >= 0 and max(whole) < 2**64:
            return np.array(whole, np.uint64)
    return np.array([float(value) for value in column])


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


def _arrays(message: Any, before: Steps = ()) -> Iterator[tuple[Steps, int]]:
    """Yield the way to every array of messages in a message, and its length."""
    if hasattr(message, "__dataclass_fields__"):
        for name in message.__dataclass_fields__:
            yield from _arrays(getattr(message, name), (*before, name))
    elif isinstance(message, list) and 0 < len(message) <= _ELEMENTS:
        if hasattr(message[0], "__dataclass_fields__"):
            yield before, len(message)
        for index, item in enumerate(message):
            yield from _arrays(item, (*before, index))


def _holder(path: Steps) -> Steps:
    """Return the way to the message that holds what is at the end of a way."""
    fields = [k for k, step in enumerate(path) if isinstance(step, str)]
    return path[: fields[-1]] if fields else ()


def _text(path: Steps) -> str:
    return "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in path)


def _at(message: Any, path: Steps) -> Any:
    """Return a number in a message; None where its array is shorter."""
    for step in path:
        if step == _NEAREST:
            return _nearest(message, path[-1])
        if isinstance(step, int):
            if step >= len(message):
                return None
            message = message[step]
        else:
            message = getattr(message, step)
    return message


def _nearest(scan: Any, topic: str | int) -> Any:
    if not scan.range_min < scan.range_max:
        raise TraceError(
            f"a laser scan on {topic} has no valid range, because its range_min is {scan.range_min:g} and its "
            f"range_max {scan.range_max:g}: read single ranges, such as {topic}.ranges[0], or correct the driver"
        )
    ranges = np.asarray(scan.ranges)
    measured = (ranges >= scan.range_min) & (ranges <= scan.range_max)
    return ranges[measured | (ranges == -np.inf)].min(initial=np.inf)


def _header_time(message: Any) -> int:
    """Return the time in a message's header in nanoseconds, 0 where there is none."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    return 0 if stamp is None else int(stamp.sec) * 10**9 + int(stamp.nanosec)
