"""The conditions of a monitor, in terms of ROS diagnostics, and its notices."""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING

from rtamt.lazy.dataclasses import dataclass

if TYPE_CHECKING:
    from rtamt.ros.group import Group


class Level(IntEnum):
    """The levels of ``diagnostic_msgs/DiagnosticStatus``."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


@dataclass(frozen=True, slots=True)
class Condition:
    """The condition of one output: a row of ``/diagnostics``. ``values`` are shown next to the message."""

    name: str
    level: Level
    message: str
    values: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class Notice:
    """An event, which is reported once."""

    level: Level
    message: str


def begins_anew(group: Group) -> str:
    """Return the beginning of a message: the outputs of a group restart."""
    first, *others = (f"'{standing.output.name}'" for standing in group.standings)
    if not others:
        return f"{first} begins anew, its"
    return f"{first} and {others[0] if len(others) == 1 else f'{len(others)} others'} begin anew, their"


def seconds_text(nanoseconds: int) -> str:
    """Return nanoseconds as seconds for a message."""
    return f"{nanoseconds / 1e9:.6g} s"
