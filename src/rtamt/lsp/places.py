"""Positions of editors: lines and characters from 0, in the units of an encoding, and offsets in the text."""

from __future__ import annotations

from bisect import bisect_right
from typing import TYPE_CHECKING

from rtamt.language.parsing.lexer import LINE_END
from rtamt.lazy.tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.language.formula import Span

#: How many units a character takes, by the encoding that client and server agree on.
_UNITS: dict[str, Callable[[str], int]] = {
    "utf-8": lambda character: len(character.encode("utf-8", "surrogatepass")),
    "utf-16": lambda character: 2 if ord(character) > 0xFFFF else 1,
    "utf-32": lambda _character: 1,
}


class Place(NamedTuple):
    """A position: its line and its character in the line."""

    line: int
    character: int


class Lines:
    r"""The lines of a text, to convert between offsets and positions.

    >>> Lines("a\n\U0001F600b").place(3), Lines("a\n\U0001F600b").offset(Place(1, 2))
    (Place(line=1, character=2), 3)
    """

    def __init__(self, text: str, encoding: str = "utf-16") -> None:
        self._text = text
        self._units = _UNITS[encoding]
        self._plain = encoding == "utf-32" or text.isascii()
        ends = list(LINE_END.finditer(text))
        self.starts = [0, *(end.end() for end in ends)]
        self._ends = [*(end.start() for end in ends), len(text)]

    def place(self, offset: int) -> Place:
        """Return the position of an offset."""
        line = bisect_right(self.starts, offset) - 1
        start = self.starts[line]
        if self._plain:
            return Place(line, offset - start)
        return Place(line, sum(map(self._units, self._text[start:offset])))

    def end(self, offset: int) -> int:
        """Return the end of the line of an offset."""
        return self._ends[bisect_right(self.starts, offset) - 1]

    def range(self, span: Span) -> tuple[Place, Place]:
        """Return the first position of a span, and the one after it."""
        return self.place(span.start), self.place(span.end)

    def offset(self, place: Place) -> int:
        """Return the offset of a position; beyond the end of a line or of the text, that end."""
        if place.line >= len(self.starts):
            return len(self._text)
        at, end = self.starts[place.line], self._ends[place.line]
        if self._plain:
            return min(at + place.character, end)
        left = place.character
        while at < end and left > 0:
            left -= self._units(self._text[at])
            at += 1
        return at

    def width(self, span: Span) -> int:
        """Return the length of a span in code units."""
        text = self._text[span.start : span.end]
        return len(text) if self._plain else sum(map(self._units, text))
