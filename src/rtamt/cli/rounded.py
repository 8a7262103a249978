"""The note on integers in a stream that no double holds."""

from __future__ import annotations

from typing import Any

from rtamt.readers.numbers import EXACT, is_rounded


def may_be_rounded(value: object) -> bool:
    """Return whether a number may have been read from an integer that no double holds.

    >>> may_be_rounded(2.0**53), may_be_rounded(3.0)
    (True, False)
    """
    return isinstance(value, float) and not -EXACT < value < EXACT


class Rounded:
    """The signals with such integers; the first one of each adds a sentence to ``notes``."""

    def __init__(self, notes: list[str]) -> None:
        self._notes = notes
        self._names: set[str] = set()

    def add(self, name: str, value: Any, line: int) -> None:
        """Note a value, of a JSON object or in a cell, of the line with this number, if it is such an integer."""
        if name in self._names:
            return
        text = str(value).strip()
        if text.lstrip("+-").isdecimal() and is_rounded(int(text)):
            self._names.add(name)
            self._notes.append(
                f"rounded to doubles: integers of {name} beyond 2^53, the first in line {line}"
            )
