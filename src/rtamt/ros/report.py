"""What a monitor has to say besides numbers: its condition, in the words of ROS's diagnostics, and notices."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum


class Level(IntEnum):
    """The levels of ``diagnostic_msgs/DiagnosticStatus``."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


@dataclass(frozen=True, slots=True)
class Condition:
    """How one output is: a row of ``/diagnostics``. ``values`` are shown beside the message."""

    name: str
    level: Level
    message: str
    values: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class Notice:
    """Something that happened and is said once."""

    level: Level
    message: str
