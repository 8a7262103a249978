"""Which statement begins at the current token, by words that no formula begins with."""

from __future__ import annotations

from rtamt.language.parsing.grammar import ELSE, THEN
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rtamt.language.parsing.names import NameParser


def begins_enumeration(parser: NameParser) -> bool:
    """Return whether an enumeration is declared here: ``enum``, a name and a brace, which no formula begins with."""
    if parser.texts[parser.index] != "enum":
        return False
    first, second, third = (*parser.tokens[parser.index : parser.index + 3], *[parser.tokens[-1]] * 2)[:3]
    return first.kind == "name" and first.text == "enum" and second.kind == "name" and third.text == "{"


def begins_group(parser: NameParser) -> bool:
    """Return whether a group is declared here: ``group``, a name, ``=`` and a text, which no formula begins with."""
    at = parser.index + (parser.texts[parser.index] in ("input", "output"))
    if parser.texts[at : at + 3 : 2] != ["group", "="]:
        return False
    return parser.tokens[at + 1].kind == "name" and parser.tokens[at + 3].kind == "quoted"


def begins_sampling(parser: NameParser) -> bool:
    """Return whether a sampling rule begins here: ``sample`` and a number, which no formula begins with."""
    if parser.texts[parser.index] != "sample":
        return False
    first, second = parser.token, parser.tokens[min(parser.index + 1, len(parser.tokens) - 1)]
    return first.kind == "name" and first.text == "sample" and second.kind == "number"


def begins_table(parser: NameParser) -> bool:
    """Return whether a table is declared here: ``table``, a name, ``=`` and a brace, which no formula begins with."""
    if parser.texts[parser.index] != "table":
        return False
    first, second, *rest = (*parser.tokens[parser.index : parser.index + 4], *[parser.tokens[-1]] * 3)[:4]
    named = first.kind == "name" and first.text == "table" and second.kind in ("name", "quoted")
    return named and [token.text for token in rest] == ["=", "{"]


def begins_template(parser: NameParser) -> bool:
    """Return whether a template is defined here: ``def``, a name and a parenthesis, which no formula begins with."""
    if parser.texts[parser.index] != "def":
        return False
    first, second, third = (*parser.tokens[parser.index : parser.index + 3], *[parser.tokens[-1]] * 2)[:3]
    word = second.text
    named = second.kind == "name" and word not in (THEN, ELSE) and parser.language.infix(word) is None
    return first.kind == "name" and first.text == "def" and named and third.text == "("
