"""The conditions of a monitor, in terms of ROS diagnostics, and its notices."""

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
