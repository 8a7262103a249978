"""Semantic tokens: what each word of a text is."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from rtamt.language.formula import Span
from rtamt.language.operators import STL
from rtamt.language.parsing.lexer import is_name, is_numeral, is_quoted, tokenize
from rtamt.language.units.durations import UNITS
from rtamt.language.words import functions, logical, symbols, temporal
from rtamt.lazy.tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtamt.lsp.document import Analysis
    from rtamt.lsp.symbols import Symbol

#: The types of tokens and their modifiers, in the order of the legend.
TYPES = (
    "comment", "keyword", "operator", "number", "string", "variable", "parameter", "function", "enum", "enumMember",
    "type", "property", "namespace", "macro",
)  # fmt: skip
MODIFIERS = ("declaration", "readonly", "defaultLibrary")

_OF_SYMBOL = {
    "variable": "variable", "constant": "variable", "parameter": "variable", "formula": "variable",
    "requirement": "macro", "template": "function", "argument": "parameter", "member": "parameter",
    "group": "namespace", "field": "property", "table": "function", "enumeration": "enum", "value": "enumMember",
    "class": "type",
}  # fmt: skip
_OF_WORD = {"keyword": "keyword", "type": "type", "unit": "type", "topic": "string", "class": "namespace",
            "argument": "parameter"}  # fmt: skip


class Colored(NamedTuple):
    """A stretch of one line, its type and its modifiers."""

    span: Span
    type: str
    modifiers: tuple[str, ...] = ()


def classify_words(analysis: Analysis) -> list[Colored]:
    """Return the role of each word of a text, in the order of the text.

    >>> from rtamt.lsp.document import Analysis
    >>> [each.type for each in classify_words(Analysis("always[0:5](x >= 3) // high"))]
    ['keyword', 'number', 'number', 'variable', 'operator', 'number', 'comment']
    """
    found = [*_of_tokens(analysis), *(Colored(span, "comment") for span in analysis.comments)]
    long = [each for each in found if each.type in ("comment", "string")]
    if long:  # only these may be on several lines
        found = [each for each in found if each.type not in ("comment", "string")]
        found += [piece for each in long for piece in _on_lines(analysis, each)]
    return sorted(found)


def _of_tokens(analysis: Analysis) -> Iterator[Colored]:
    outline = analysis.outline
    uses = {span.start: (span, symbol) for span, symbol in outline.uses.items()}
    tokens = tokenize(analysis.text, STL)
    behind = 0
    for at, (text, start, end) in enumerate(zip(tokens.texts[:-1], tokens.starts, tokens.ends, strict=False)):
        if start < behind:
            continue
        if start in uses:
            span, symbol = uses[start]
            behind = span.end
            yield Colored(span, _OF_SYMBOL[symbol.kind], _modifiers(symbol, span))
            if span.end < end:  # a field of a message, of a member
                yield Colored(Span(span.end + 1, end), "property")
            continue
        before = tokens.texts[at - 1] if at else ""
        type_ = _OF_WORD.get(outline.words.get(at, "")) or _type(text, before)
        if type_ is not None:
            yield Colored(Span(start, end), type_, ("defaultLibrary",) if type_ == "function" else ())


def _modifiers(symbol: Symbol, span: Span) -> tuple[str, ...]:
    found = ("declaration",) if span == symbol.span else ()
    return (*found, "readonly") if symbol.kind in ("constant", "value") else found


@cache
def _vocabulary() -> dict[str, str]:
    """Return the type of each word and symbol of the table of operators."""
    lists = {"keyword": [*temporal(), *logical()], "function": functions(), "operator": symbols()}
    return {word: type_ for type_, words in lists.items() for word in words}


def _type(text: str, before: str) -> str | None:
    if is_quoted(text):
        return "string"
    if is_numeral(text) or text == "inf":
        return "number"
    if text in UNITS and is_numeral(before):
        return "type"
    return _vocabulary().get(text) or ("variable" if is_name(text) else None)


def _on_lines(analysis: Analysis, token: Colored) -> Iterator[Colored]:
    """Yield the pieces of a token that are on one line each."""
    text, at = analysis.text, token.span.start
    for line in text[token.span.start : token.span.end].splitlines(keepends=True):
        end = at + len(line.rstrip("\r\n"))
        if end > at:
            yield token._replace(span=Span(at, end))
        at += len(line)
