"""Where the numbers are in a message of a bag: its columns, and the value of each."""

from __future__ import annotations

from itertools import zip_longest
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lazy.modules import np
from rtamt.signals.arrays import is_number

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

#: The longest array whose elements become columns; longer ones are images and point clouds.
ELEMENTS = 1000
#: The most numbers in the elements of an array that become columns; more are those of grids.
NUMBERS = 10_000
#: Scans have a column for the nearest obstacle: the least valid range, inf if there is none, and -inf where a ray hit
#: something that is too close to measure (REP 117).
SCAN, NEAREST = "sensor_msgs/msg/LaserScan", "ranges.min"

#: The steps from a message to a number in it.
Steps = tuple["str | int", ...]


@dataclass(frozen=True, slots=True)
class Shape:
    """What messages have at one place: a number, fields, or elements of an array; of some messages in any of them.

    ``short``, ``long``: whether a message has an array here that is short enough for columns, or one that is longer.
    ``count``: how many numbers there are.
    """

    is_number: bool = False
    fields: Mapping[str, Shape] = field(default_factory=dict)
    elements: list[Shape] = field(default_factory=list)
    short: bool = False
    long: bool = False
    count: int = 0

    def numbers(self, before: Steps = ()) -> Iterator[Steps]:
        """Yield the way to every number, in the order of the definition of the message."""
        if self.is_number:
            yield before
        for name, inside in self.fields.items():
            yield from inside.numbers((*before, name))
        if not self.long:
            for index, inside in enumerate(self.elements):
                yield from inside.numbers((*before, index))

    def left_out(self, before: Steps = ()) -> Iterator[Steps]:
        """Yield the way to every array that has columns in some messages, and is too long for them in others."""
        if self.short and self.long:
            yield before
        for name, inside in self.fields.items():
            yield from inside.left_out((*before, name))
        for index, inside in enumerate(self.elements):
            yield from inside.left_out((*before, index))


_NOTHING, _NUMBER = Shape(), Shape(is_number=True, count=1)


def shape_of(message: Any) -> Shape:
    """Return where the numbers of a message are."""
    if is_number(message):
        return _NUMBER
    names = getattr(message, "__dataclass_fields__", None)
    if names is not None:
        return _message({name: shape_of(getattr(message, name)) for name in names})
    if not isinstance(message, (np.ndarray, list)):
        return _NOTHING
    if len(message) > ELEMENTS:
        return _array([], short=False, long=True)
    return _array([shape_of(item) for item in message], short=True, long=False)


def union(a: Shape, b: Shape) -> Shape:
    """Return where the numbers of some messages are, from where they are in two parts of them."""
    if a is b or b is _NOTHING or a == b:
        return a
    if a is _NOTHING:
        return b
    if a.fields:
        return _message({name: union(inside, b.fields[name]) for name, inside in a.fields.items()})
    elements = [union(*pair) for pair in zip_longest(a.elements, b.elements, fillvalue=_NOTHING)]
    return _array(elements, short=a.short or b.short, long=a.long or b.long)


def _message(fields: dict[str, Shape]) -> Shape:
    return Shape(fields=fields, count=sum(each.count for each in fields.values()))


def _array(elements: list[Shape], *, short: bool, long: bool) -> Shape:
    """Return the shape of an array, of which messages have ``short`` and ``long`` ones."""
    count = sum(each.count for each in elements)
    if count > NUMBERS:  # in one message, or in all together
        return Shape(short=short and long, long=True)
    return Shape(elements=elements, short=short, long=long, count=count)


def has_arrays(kind: str, definitions: Mapping[str, Any], typesys: Any) -> bool:
    """Return whether messages of a type have arrays without a fixed length, which may differ between messages.

    ``definitions``: of each type, as rosbags has them. ``typesys``: its module.
    """
    node = typesys.base.Nodetype

    def varies(part: tuple[Any, Any]) -> bool:
        what, content = part
        if what == node.NAME:
            return has_arrays(content, definitions, typesys)
        return what == node.SEQUENCE or (what == node.ARRAY and varies(content[0]))

    return any(varies(part) for _, part in definitions[kind][1])


# ---- values --------------------------------------------------------------------------------------


def holder(path: Steps) -> Steps:
    """Return the way to the message that holds what is at the end of a way."""
    fields = [k for k, step in enumerate(path) if isinstance(step, str)]
    return path[: fields[-1]] if fields else ()


def text_of(path: Steps) -> str:
    """Return the end of the name of a column, such as ``.ranges[3]``."""
    return "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in path)


def value_at(message: Any, path: Steps) -> Any:
    """Return a number in a message; None where its array is shorter."""
    for step in path:
        if step == NEAREST:
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


def header_time(message: Any) -> int:
    """Return the time in a message's header in nanoseconds, 0 where there is none."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    return 0 if stamp is None else int(stamp.sec) * 10**9 + int(stamp.nanosec)
