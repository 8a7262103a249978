"""Codes that a recording has under other numbers: constants of messages, found by their names."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.signals.arrays import number_of

if TYPE_CHECKING:
    from rtamt.language.value_types import Enumeration


class Recoding:
    """Codes of members from the constants of a message that have their names (``uint8 AUTO=4``).

    ``holder``: the message that holds the value. Without any such constant codes stay what they are.
    """

    def __init__(self, holder: object, type_: Enumeration) -> None:
        found = [(number_of(getattr(holder, name, None)), code) for name, code in type_.members]
        self._codes = {number: float(code) for number, code in found if number is not None}
        self._own = {float(code) for _, code in type_.members}

    def __call__(self, value: float) -> float:
        """Return the code of the member whose constant has this value; another number if there is none."""
        if not self._codes:
            return value
        known = self._codes.get(value)
        if known is not None:
            return known
        return max(self._own) + 1 if value in self._own else value
