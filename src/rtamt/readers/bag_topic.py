"""A topic of a bag: its columns, its clock, and its messages as rows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError
from rtamt.language.value_types import Enumeration
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.lazy.modules import np
from rtamt.readers.message_fields import (
    ELEMENTS,
    NEAREST,
    NUMBERS,
    Shape,
    Steps,
    header_time,
    holder,
    text_of,
    value_at,
)
from rtamt.readers.source import Field, Table, printable
from rtamt.signals.recoding import Recoding

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from rtamt.readers.source import Raw

#: What follows the name of a topic in the name of its column of timestamps.
STAMP = " stamp"
#: How far the timestamp of a message may be from its recording, in nanoseconds, if both are from the same clock.
SAME_CLOCK = 60 * 10**9


@dataclass(slots=True, eq=False)
class Topic:
    """A topic: its table, and where the numbers of its columns are in a message.

    ``steps``: to each column that is in the first message or, once it is ``completed``, in any. ``completed`` is set
    from the beginning where all messages have the same columns. ``from_zero``: whether a stamp of 0 is a time, the
    start of a simulation. ``behind``: nanoseconds from the stamp in the header of a message to its recording, 0 without
    a stamp. ``by_recording``: a note on why stamps in headers are ignored; empty if they are used. ``left_out``: a note
    on each array that has no columns because it is too long in some messages.
    """

    table: Table
    connections: list[Any]
    steps: dict[str, Steps]
    completed: bool
    from_zero: bool
    behind: int
    by_recording: str = ""
    left_out: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """The name of the topic."""
        return str(self.connections[0].topic)

    def time_of(self, message: Any, recorded: int) -> int:
        """Return the time of a message that was recorded at an instant, in nanoseconds."""
        stamp = recorded if self.by_recording else header_time(message)
        if stamp or self.from_zero:
            return stamp
        if is_foreign(self.behind):
            raise TraceError(
                f"a message on {printable(self.name)} has the timestamp 0, so that its time is unknown: the other "
                f"timestamps on this topic are not from the clock of the recording; leave the message out of the bag"
            )
        return recorded

    def may_have_more(self, names: Collection[str] | None) -> bool:
        """Return whether later messages may have columns of these names, or beginnings of names; None: any."""
        if self.completed or names is None:
            return not self.completed
        mine = f"{self.name}."
        return any(
            mine.startswith(name) or (name.startswith(mine) and name not in self.steps) for name in names
        )

    def take(self, shape: Shape) -> None:
        """Take the columns of a shape for those of the table."""
        more = {f"{self.name}{text_of(path)}": path for path in shape.numbers()}
        nearest = {column: path for column, path in self.steps.items() if path[0] == NEAREST}
        self.steps = {**more, **nearest}
        time_field = self.table.time_field
        assert time_field is not None
        fields = (Field(column, column, "", "number") for column in self.steps)
        self.table = replace(self.table, fields=(time_field, *fields))
        self.left_out = tuple(
            f"left out: {printable(self.name)}{text_of(path)}, which is too long in some messages: more than "
            f"{ELEMENTS} elements, or {NUMBERS} numbers"
            for path in shape.left_out()
        )


def is_foreign(behind: int) -> bool:
    """Return whether a clock that is so far behind that of the recording is another one, such as simulated time."""
    return abs(behind) > SAME_CLOCK


def use_one_clock(topics: Sequence[Topic]) -> None:
    """Use the times of recording on topics whose stamps are from another clock than those of the other topics."""
    same = [topic for topic in topics if not is_foreign(topic.behind)]
    for topic in topics:
        topic.by_recording = ""
        if same and is_foreign(topic.behind):
            side = "behind" if topic.behind > 0 else "ahead of"
            topic.by_recording = (
                f"{printable(topic.name)}: the timestamps in its headers are {abs(topic.behind) / 1e9:.6g} s {side} "
                f"the clock of the recording, which {printable(same[0].name)} uses; the times of recording are "
                f"used instead"
            )


# ---- rows ------------------------------------------------------------------------------------------


class Rows:
    """Selected fields of the messages of a topic, in the order of their timestamps."""

    def __init__(self, topic: Topic, wanted: Sequence[Field]) -> None:
        self._topic, self._wanted = topic, wanted
        fields = [field for field in wanted if field != topic.table.time_field]
        self._paths = [topic.steps[field.column] for field in fields]
        self._enumerations = {
            place: field.type for place, field in enumerate(fields) if isinstance(field.type, Enumeration)
        }
        self._timestamps: list[int] = []
        self._rows: list[list[Any]] = []
        self._recodings: dict[int, Recoding] = {}
        self._last: tuple[int, list[Any]] | None = None
        self._count = self._others = 0

    def take(self, recorded: int, message: Any) -> None:
        """Add a message; of several with the same timestamp the first."""
        stamp = self._topic.time_of(message, recorded)
        row = [value_at(message, path) for path in self._paths]
        if self._last is not None and stamp <= self._last[0]:
            if stamp == self._last[0]:  # a signal has one value at an instant: the first
                self._others += row != self._last[1]
                return
            raise TraceError(
                f"the timestamps on {self._topic.name} go back by {(self._last[0] - stamp) / 1e9:.9g} s at message "
                f"{self._count}: was simulated time set back? Cut the bag there"
            )
        self._count += 1
        self._last = stamp, row
        self._timestamps.append(stamp)
        self._rows.append(self._with_own_codes(row, message) if self._enumerations else row)

    def _with_own_codes(self, row: list[Any], message: Any) -> list[Any]:
        """Return a row with the codes of enumeration members as the specification has them."""
        row = list(row)
        for place, type_ in self._enumerations.items():
            if row[place] is None:
                continue
            if place not in self._recodings:
                self._recodings[place] = Recoding(value_at(message, holder(self._paths[place])), type_)
            row[place] = self._recodings[place](float(row[place]))
        return row

    def columns(self) -> list[Raw]:
        """Return the messages since the last call."""
        table = self._topic.table
        repeated = _repeated_note(self._topic.name, self._others) if self._others else ""
        table.losses[:] = [
            note for note in (self._topic.by_recording, repeated, *self._topic.left_out) if note
        ]
        assert table.time_field is not None
        found = _columns(self._wanted, table.time_field, self._timestamps, self._rows)
        self._timestamps, self._rows = [], []
        return found


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
