"""Text to tokens, with one regular expression built from the operator table.

=========  ===================================================================
kind       text
=========  ===================================================================
number     ``3``, ``0.5``, ``.5``, ``1e-3``, ``1_000``
name       ``req``, ``req.value``, ``always``; the parser decides which are operators
quoted     ``"engine speed"``: always a name; ``""`` inside denotes a double quote
symbol     operators that are not words, longest first, and ``( ) [ ] , : ; = @ % =>``
unclosed   the opening of a comment or quoted name without an end
unknown    any other character
end        after the last token
=========  ===================================================================
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from rtamt.errors import UsageError
from rtamt.language.formula import Span
from rtamt.language.units.durations import NUMBER

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.language.operators import Language

#: Not an operator, but one token, so that ``gap => 5`` gets a message of its own.
NO_ARROW = "=>"

PUNCTUATION = [*"( ) [ ] , : ; = @ %".split(), NO_ARROW]

_WORD = r"[^\W\d][\w$]*|\$[\w$]*"
_NAME = rf"(?:{_WORD})(?:\.(?:{_WORD}))*"
_SKIP = r"\s*(?:(?://[^\n\r]*|/\*[\s\S]*?\*/)\s*)*"

#: A name that needs no quotes: a word, or words joined by dots.
NAME = re.compile(_NAME)
#: A topic such as ``/ns/req``, which is also a name where an operand can begin.
TOPIC = re.compile(rf"(?:/{_NAME})+")


class Token(NamedTuple):
    """A piece of the text: its kind, its characters, and their position."""

    kind: str
    text: str
    start: int
    end: int

    @property
    def span(self) -> Span:
        """The position of the characters in the text."""
        return Span(self.start, self.end)

    @property
    def name(self) -> str:
        """The name that it stands for, without quotes."""
        return unquoted(self.text) if self.kind == "quoted" else self.text

    def __str__(self) -> str:
        return "the end of the text" if self.kind == "end" else f"'{self.text}'"


def is_word(spelling: str) -> bool:
    """Return whether an operator is spelled like a name, so that only its position distinguishes them.

    >>> is_word("until"), is_word("->")
    (True, False)
    """
    return NAME.fullmatch(spelling) is not None


@lru_cache(maxsize=32)  # keyed by text, so that no custom operator is kept alive
def _pattern(spellings: tuple[str, ...]) -> re.Pattern[str]:
    symbols = {s for s in spellings if not is_word(s)}.union(PUNCTUATION)
    symbol = "|".join(re.escape(s) for s in sorted(symbols, key=lambda s: (-len(s), s)))
    # Some alternative always matches after the skipped part, so the expression never backtracks into a comment.
    return re.compile(
        rf"{_SKIP}(?:(?P<name>{_NAME})|(?P<number>{NUMBER})"
        rf'|(?P<quoted>"(?:[^"]|"")*")|(?P<unclosed>/\*|")'
        rf"|(?P<symbol>{symbol})|(?P<end>\Z)|(?P<unknown>[\s\S]))"
    )


def tokenize(text: str, language: Language) -> Sequence[Token]:
    r"""Split a text into tokens; the last one is of kind ``end``.

    A comment that begins with ``//`` ends at the end of its line: at ``\n``, ``\r\n`` or ``\r``, and at no other
    character. Text outside the language becomes a token of kind ``unknown`` or ``unclosed``, which
    the parser reports when it gets there. Raises :class:`UsageError` if ``text`` is not a string.

    >>> from rtamt.language.operators import STL
    >>> [token.text for token in tokenize("req.value >= 3 // high", STL)]
    ['req.value', '>=', '3', '']
    """
    if not isinstance(text, str):
        raise UsageError(f"a formula is text, got {type(text).__name__}")
    tokens: list[Token] = []
    new, add = tuple.__new__, tokens.append  # half the cost of calling Token
    for match in _pattern(language.spellings).finditer(text):
        kind, group = match.lastgroup, match.lastindex
        if kind is None or group is None or kind == "end":
            break
        start, end = match.span(group)
        add(new(Token, (kind, text[start:end], start, end)))
        if kind == "unclosed":
            break  # nothing can follow; further openings would each be searched to the end of the text
    # The end is placed after the last token: a caret under a blank line would not help.
    last = tokens[-1].end if tokens else 0
    tokens.append(Token("end", "", last, last))
    return tokens


def quoted(name: str) -> str:
    """Return a name in double quotes; it may contain any characters.

    >>> print(quoted('the "fast" one'))
    "the ""fast"" one"
    """
    return '"' + name.replace('"', '""') + '"'


def unquoted(text: str) -> str:
    """Return the name that a token of kind ``quoted`` stands for."""
    return text[1:-1].replace('""', '"')
