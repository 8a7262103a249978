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
from collections.abc import Collection, Iterator, Sequence
from functools import lru_cache
from itertools import accumulate, compress

from rtamt.errors import UsageError
from rtamt.language.formula import Span
from rtamt.language.units.durations import NUMBER
from rtamt.lazy.patterns import lazy_pattern
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, overload

if TYPE_CHECKING:
    from rtamt.language.operators import Language

#: Not an operator, but one token, so that ``gap => 5`` has its own message.
NO_ARROW = "=>"

PUNCTUATION = [*"( ) [ ] , : ; = @ %".split(), NO_ARROW]

_WORD = r"[^\W\d][\w$]*|\$[\w$]*"
_NAME = rf"(?:{_WORD})(?:\.(?:{_WORD}))*"
#: The ends of lines, and of `//` comments; `str.splitlines` knows more, such as U+2028 and form feeds.
LINE_END = lazy_pattern(r"\r\n|\n|\r")
_COMMENT = r"//[^\n\r]*|/\*[\s\S]*?\*/"
_QUOTED = r'"(?:[^"]|"")*"'

#: Most names and numbers, which are found in half the time.
_PLAIN = r"[A-Za-z][A-Za-z0-9_]*(?![\w.$])|[0-9]+(?![\w.])"

#: A name that needs no quotes: a word, or words joined by dots.
NAME = lazy_pattern(_NAME)
#: A topic such as ``/ns/req``, which is also a name where an operand can begin.
TOPIC = lazy_pattern(rf"(?:/{_NAME})+")
#: What a comment or quoted name begins with.
_OPENINGS = ("/*", '"')
#: What tokens other than symbols can begin with, apart from letters and digits.
_BEGINNINGS = frozenset('./"_$')
_DIGITS, _OTHER_LETTERS = frozenset("0123456789"), frozenset("_$")


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
        """The name without quotes."""
        return unquoted(self.text) if self.kind == "quoted" else self.text

    def __str__(self) -> str:
        return "the end of the text" if self.kind == "end" else f"'{self.text}'"


class Tokens(Sequence[Token]):
    """The tokens of a text, the last one of kind ``end``: columns, and a :class:`Token` where one is requested.

    Most tokens are read once, by their characters alone.
    """

    __slots__ = ("_kinds", "_made", "_symbols", "ends", "starts", "texts")

    def __init__(
        self, texts: list[str], starts: list[int], ends: list[int], symbols: Collection[str]
    ) -> None:
        self.texts = texts
        self.starts = starts
        self.ends = ends
        self._symbols = symbols
        self._made: list[Token | None] = [None] * len(texts)
        self._kinds: dict[str, str] = {}  # most tokens occur several times

    def __len__(self) -> int:
        return len(self.texts)

    @overload
    def __getitem__(self, at: int) -> Token: ...

    @overload
    def __getitem__(self, at: slice) -> list[Token]: ...

    def __getitem__(self, at: int | slice) -> Token | list[Token]:
        made = self._made[at]
        if type(made) is Token:
            return made
        if isinstance(at, slice):
            return [self[i] for i in range(*at.indices(len(self.texts)))]
        text = self.texts[at]
        kind = self._kinds.get(text)
        if kind is None:
            kind = self._kinds[text] = kind_of(text, self._symbols)
        token = self._made[at] = Token(kind, text, self.starts[at], self.ends[at])
        return token

    def between(self, first: int, last: int) -> Tokens:
        """Return the tokens from ``first`` to the one before ``last``, and an end."""
        end = self.ends[last - 1]
        texts, starts, ends = (column[first:last] for column in (self.texts, self.starts, self.ends))
        return Tokens([*texts, ""], [*starts, end], [*ends, end], self._symbols)


def is_word(spelling: str) -> bool:
    """Return whether an operator is spelled like a name, so that only its position distinguishes them.

    >>> is_word("until"), is_word("->")
    (True, False)
    """
    return NAME.fullmatch(spelling) is not None


def _begins_no_other(symbol: str, symbols: Collection[str]) -> bool:
    return not any(other.startswith(symbol) for other in symbols if other != symbol)


@lru_cache(maxsize=32)  # keyed by text, so that no custom operator is kept alive
def _lexicon(spellings: str) -> tuple[re.Pattern[str], Collection[str]]:
    """Return the expression of one token, and the symbols."""
    symbols = {s for s in spellings.split() if not is_word(s)}.union(PUNCTUATION)
    # What most of a text consists of comes first: characters that are a symbol and begin no other token, plain names
    # and numbers, and symbols. Symbols that other tokens begin with follow these.
    single = {s for s in symbols if len(s) == 1 and s not in _BEGINNINGS and _begins_no_other(s, symbols)}
    late = {s for s in symbols if s[0] in _BEGINNINGS}
    first = "".join(map(re.escape, sorted(single)))
    # Every character that is not white space begins some alternative, so the expression never backtracks into a
    # comment. An opening without an end takes the rest: else further ones would each be searched to the end.
    rare = (_NAME, NUMBER, _COMMENT, _QUOTED, r'(?:/\*|")[\s\S]*', *_longest_first(late), r"\S")
    token = "|".join((f"[{first}]", _PLAIN, *_longest_first(symbols - single - late), *rare))
    return re.compile(f"(?=[^ ])({token})"), frozenset(symbols)


def _longest_first(symbols: Collection[str]) -> list[str]:
    """Return expressions of symbols in the order in which they are tried."""
    return [re.escape(symbol) for symbol in sorted(symbols, key=lambda s: (-len(s), s))]


def tokenize(text: str, language: Language) -> Tokens:
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
    pattern, symbols = _lexicon(language.spellings)
    pieces = pattern.split(text)  # space, token, space, token, ..., space
    places = list(accumulate(map(len, pieces)))
    texts, starts, ends = pieces[1::2], places[::2], places[1::2]
    if "/" in text:
        kept = [piece[0] != "/" or not _is_comment(piece) for piece in texts]
        texts, ends = list(compress(texts, kept)), list(compress(ends, kept))
        starts = [*compress(starts, kept), len(text)]
    if texts and _is_unclosed(texts[-1]):
        texts[-1] = "/*" if texts[-1][0] == "/" else '"'
        ends[-1] = starts[len(texts) - 1] + len(texts[-1])
    # The end is placed after the last token: a caret under a blank line would not help.
    starts[-1] = ends[-1] if ends else 0
    texts.append("")
    ends.append(starts[-1])
    return Tokens(texts, starts, ends, symbols)


def comments(text: str, language: Language) -> list[Span]:
    """Return where the comments of a text are.

    >>> from rtamt.language.operators import STL
    >>> comments('x >= "a//b" // high', STL)
    [Span(start=12, end=19)]
    """
    pattern, _ = _lexicon(language.spellings)
    return [Span(*match.span()) for match in pattern.finditer(text) if _is_comment(match[0])]


def _is_comment(piece: str) -> bool:
    return piece.startswith("//") or (piece.startswith("/*") and piece.endswith("*/") and len(piece) > 3)


def _is_unclosed(piece: str) -> bool:
    """Return whether a piece other than a comment begins a comment or quoted name that does not end."""
    return piece.startswith("/*") or (piece.startswith('"') and '"' not in piece[1:])


def places_of(text: str, texts: Sequence[str], first: int = 0) -> Iterator[int]:
    """Yield the indices of the tokens of this text, from the index ``first`` on."""
    for _ in range(texts[first:].count(text) if first else texts.count(text)):
        first = texts.index(text, first)
        yield first
        first += 1


def kind_of(text: str, symbols: Collection[str]) -> str:
    """Return the kind of a token from its characters; ``symbols``: those of the language."""
    if text in symbols:
        return "symbol"
    if text in ("", *_OPENINGS):
        return "unclosed" if text else "end"
    if is_name(text):
        return "name"
    if is_quoted(text):
        return "quoted"
    return "number" if is_numeral(text) else "unknown"


def is_name(text: str) -> bool:
    """Return whether a token is a name without quotes."""
    first = text[:1]
    # As in NAME, where \d are the decimal digits of all scripts.
    return (first.isalnum() and not first.isdecimal()) or first in _OTHER_LETTERS


def is_quoted(text: str) -> bool:
    """Return whether a token is a name in quotes."""
    return len(text) > 1 and text[0] == '"'


def is_numeral(text: str) -> bool:
    """Return whether a token is a number."""
    first = text[:1]
    return first in _DIGITS or (first == "." and text[1:2] in _DIGITS)


def quoted(name: str) -> str:
    """Return a name in double quotes; it may contain any characters.

    >>> print(quoted('the "fast" one'))
    "the ""fast"" one"
    """
    return '"' + name.replace('"', '""') + '"'


def unquoted(text: str) -> str:
    """Return the name of a token of kind ``quoted``."""
    return text[1:-1].replace('""', '"')
