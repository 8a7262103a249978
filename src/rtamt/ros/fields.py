"""Read a number in a message by its path in a formula; read a message's timestamp."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, UsageError, choices, with_article
from rtamt.language.value_types import Enumeration
from rtamt.lazy.patterns import lazy_pattern
from rtamt.signals.arrays import is_number
from rtamt.signals.recoding import Recoding

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.language.value_types import ValueType

#: Fields of messages begin with a letter; names with a leading underscore are Python's own.
_STEP = lazy_pattern(r"([A-Za-z]\w*)((?:\[\d+\])*)")
_INDEX = lazy_pattern(r"\[(\d+)\]")

#: The path to a field: attribute names and array indices.
Path = tuple["str | int", ...]


def path_of(name: str) -> Path:
    """Return the path from a variable to a number, without the variable itself.

    Raises :class:`UsageError` for a name that is not a path.

    >>> path_of("scan.ranges[3]"), path_of("odom.pose.pose.position.x")
    (('ranges', 3), ('pose', 'pose', 'position', 'x'))
    """
    path: list[str | int] = []
    for step in name.split(".")[1:]:
        match = _STEP.fullmatch(step)
        if match is None:
            raise UsageError(f"'{name}' is no path of fields, such as pose.position.x or ranges[3]")
        path.append(match[1])
        path += [int(index) for index in _INDEX.findall(match[2])]
    return tuple(path)


def follow(message: Any, path: Path) -> Any:
    """Return the value at a path; raise AttributeError, IndexError or TypeError if there is none."""
    for step in path:
        message = message[step] if isinstance(step, int) else getattr(message, step)
    return message


def reader(name: str, type_: ValueType | None = None) -> Callable[[Any], float]:
    """Return a function that reads a number from a message.

    ``name``: as written in a formula, the variable first. ``type_``: that of the variable; members of an
    enumeration are found by the constants of the message that have their names. The function raises
    :class:`TraceError` if a message has no such number: array lengths differ from message to message.

    >>> from types import SimpleNamespace
    >>> reader("scan.ranges[1]")(SimpleNamespace(ranges=[0.5, 0.75]))
    0.75
    """
    path = path_of(name)
    recoding: Recoding | None = None

    def read(message: Any) -> float:
        try:
            value = follow(message, path)
        except IndexError:
            raise TraceError(f"a message has no '{name}': the array is shorter", variable=name) from None
        except (AttributeError, TypeError):
            raise TraceError(f"a message has no field '{name}'", variable=name) from None
        if not is_number(value):
            raise TraceError(f"'{name}' is {value!r} in a message, expected a number", variable=name)
        if not isinstance(type_, Enumeration):
            return float(value)
        nonlocal recoding
        if recoding is None:
            recoding = Recoding(holder_of(message, path), type_)
        return recoding(float(value))

    return read


def holder_of(message: Any, path: Path) -> Any:
    """Return the message that holds what is at the end of a path."""
    fields = [k for k, step in enumerate(path) if isinstance(step, str)]
    return follow(message, path[: fields[-1]]) if fields else message


def check_path(name: str, sample: Any, kind: str) -> None:
    """Raise :class:`UsageError` unless messages like ``sample`` may have a number called ``name``.

    ``kind``: the name of the message type. The elements of an empty array cannot be checked.
    """
    at, done = sample, name.split(".", maxsplit=1)[0]
    for step in path_of(name):
        if isinstance(step, int):
            if not hasattr(at, "__getitem__") or isinstance(at, str):
                raise UsageError(
                    f"'{done}' is no array, so that there is no '{name}' in {with_article(kind)}"
                )
            if step >= len(at):
                return
            at, done = at[step], f"{done}[{step}]"
        else:
            names = fields_of(at)
            if not hasattr(at, step):
                raise UsageError(
                    f"'{done}' has no field '{step}'{choices(step, names, 'fields')}"
                    if names
                    else f"'{done}' is a number and has no field '{step}'"
                )
            at, done = getattr(at, step), f"{done}.{step}"
    if not is_number(at):
        inside = fields_of(at)
        such = f"; name one of its fields, such as {done}.{inside[0]}" if inside else ""
        raise UsageError(f"'{name}' is no number but {with_article(type(at).__name__)}{such}")


def fields_of(message: Any) -> tuple[str, ...]:
    """Return the field names of a message of any origin (rospy, rclpy, a dataclass).

    >>> from dataclasses import make_dataclass
    >>> fields_of(make_dataclass("Point", ["x", "y"])(1, 2)), fields_of(3.5)
    (('x', 'y'), ())
    """
    if hasattr(message, "get_fields_and_field_types"):  # rclpy
        return tuple(message.get_fields_and_field_types())
    if hasattr(message, "__dataclass_fields__"):
        return tuple(message.__dataclass_fields__)
    slots = getattr(type(message), "__slots__", ())
    return tuple(slots) or tuple(getattr(message, "__dict__", ()))


def stamp_of(message: Any) -> int | None:
    """Return the timestamp in a message's header in nanoseconds; None if it has none, or it is 0.

    >>> from types import SimpleNamespace as Some
    >>> stamp_of(Some(header=Some(stamp=Some(sec=1, nanosec=5)))), stamp_of(Some(value=3))
    (1000000005, None)
    """
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    if stamp is None:
        return None
    if hasattr(stamp, "nanosec"):  # ROS 2
        total = int(stamp.sec) * 10**9 + int(stamp.nanosec)
    elif hasattr(stamp, "nsecs"):  # ROS 1
        total = int(stamp.secs) * 10**9 + int(stamp.nsecs)
    else:
        return None
    return total or None


def write(message: Any, path: Path, value: float) -> None:
    """Set the number at the end of a path."""
    *way, last = path
    target = follow(message, tuple(way))
    if isinstance(last, int):
        target[last] = value
    else:
        setattr(target, last, value)
