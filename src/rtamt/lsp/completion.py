"""Completions at a position: declared names, keywords, patterns, and columns of a recording."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from rtamt.language.formula import Span
from rtamt.language.operators import STL
from rtamt.language.parsing.declarations import TYPES
from rtamt.language.parsing.grammar import ELSE, THEN
from rtamt.language.parsing.lexer import NAME, is_word, quoted
from rtamt.language.words import DECLARED_BY, QUANTIFYING, kind_of, meaning_of
from rtamt.lazy.patterns import lazy_pattern
from rtamt.lazy.tuples import NamedTuple
from rtamt.lint.found import Edit
from rtamt.patterns import patterns

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rtamt.lsp.document import Analysis

#: The characters of a declaration that are shown.
_LONGEST = 500

_WORD = lazy_pattern(r'[\w.$/]*$|"(?:[^"\r\n]|"")*$')


class Item(NamedTuple):
    """A completion: its label, its kind, its edit, a short and a long description.

    ``more``: further edits, such as an import.
    """

    label: str
    kind: str
    edit: Edit
    detail: str = ""
    text: str = ""
    more: tuple[Edit, ...] = ()


def completions(analysis: Analysis, offset: int, columns: Sequence[str] = ()) -> list[Item]:
    """Return the completions at an offset, the likeliest first; clients filter them by prefix.

    >>> from rtamt.lsp.document import Analysis
    >>> found = completions(Analysis("input float speed; always(sp"), 28, ["engine speed"])
    >>> [each.edit.new for each in found if each.kind in ("variable", "column")]
    ['speed', '"engine speed"']
    """
    if analysis.in_comment(offset):
        return []
    inside = next((span for span in analysis.outline.texts if span.start < offset < span.end), None)
    if inside is not None:
        kind = analysis.outline.texts[inside]
        return (
            [Item(each, "column", Edit(inside, quoted(each))) for each in columns] if kind == "column" else []
        )
    match = _WORD.search(analysis.text, analysis.text.rfind("\n", 0, offset) + 1, offset)
    word = Span(match.start() if match else offset, offset)
    found: dict[str, Item] = {}
    for item in (
        *_declared_names(analysis, word),
        *_columns(analysis, word, columns),
        *_imported_names(analysis, word),
        *_words(word),
        *_patterns(analysis, word),
    ):
        found.setdefault(item.label, item)
    return sorted(found.values(), key=lambda item: item.kind == "keyword")


def _declared_names(analysis: Analysis, word: Span) -> Iterator[Item]:
    for symbol in analysis.outline.symbols:
        if symbol.kind == "requirement" or symbol.span.start <= word.start <= symbol.span.end:
            continue
        if not symbol.scope.start <= word.start <= symbol.scope.end:
            continue
        end = min(symbol.whole.end, symbol.whole.start + _LONGEST)
        declared = " ".join(analysis.text[symbol.whole.start : end].split())
        name = symbol.name if NAME.fullmatch(symbol.name) or "/" in symbol.name else quoted(symbol.name)
        yield Item(symbol.name, symbol.kind, Edit(word, name), symbol.kind, f"```stl\n{declared}\n```")


def _imported_names(analysis: Analysis, word: Span) -> Iterator[Item]:
    document = analysis.document
    if document is None:
        return
    for name, template in document.templates.items():
        yield Item(name, "template", Edit(word, name), template.signature, _sentence_of(name))
    for name in document.definitions:
        yield Item(name, "formula", Edit(word, name), "formula")


def _sentence_of(name: str) -> str:
    return patterns()[name].sentence if name in patterns() else ""


def _columns(analysis: Analysis, word: Span, columns: Sequence[str]) -> Iterator[Item]:
    """Yield the columns of a recording; where variables are declared, with a declaration."""
    variables = [each for each in analysis.outline.symbols if each.kind == "variable"]
    taken = {each.name for each in analysis.outline.symbols}
    if analysis.document is not None:
        taken |= {*analysis.document.definitions, *analysis.document.templates}
    for column in columns:
        if column in taken:
            continue
        name = column if NAME.fullmatch(column) else quoted(column)
        more: tuple[Edit, ...] = ()
        if variables and variables[-1].whole.end < word.start:
            more = (_declaration(analysis, variables[-1].whole.end, name),)
        yield Item(column, "column", Edit(word, name), "a column of the recording", more=more)


def _declaration(analysis: Analysis, end: int, name: str) -> Edit:
    """Return the edit that declares a column behind a declaration: on a line of its own, unless more follows there."""
    end += analysis.text[end : end + 1] == ";"
    line_end = analysis.lines.end(end)
    rest = analysis.text[end:line_end].strip()
    if not rest or any(end <= each.start and each.end >= line_end for each in analysis.comments):
        return Edit(Span(line_end, line_end), f"\nfloat {name}")
    return Edit(Span(end, end), f" float {name};")


def _patterns(analysis: Analysis, word: Span) -> Iterator[Item]:
    """Yield the patterns of the library, with the import where it is missing."""
    document = analysis.document
    files = set() if document is None else {path for _file, path in document.imported}
    begin = _behind_header(analysis)
    for pattern in patterns().values():
        missing = f'import "{pattern.file}"' not in analysis.text and pattern.file not in files
        more = (
            (Edit(Span(begin, begin), f'import "{pattern.file}"\n'),)
            if missing and begin <= word.start
            else ()
        )
        yield Item(
            pattern.name, "template", Edit(word, pattern.name), pattern.signature, pattern.sentence, more
        )


def _behind_header(analysis: Analysis) -> int:
    """Return where an import can be inserted: before the first token, or on the line after the header."""
    starts, text = analysis.lines.starts, analysis.text
    comments = analysis.comments
    at = 0
    for line, start in enumerate(starts):
        end = starts[line + 1] if line + 1 < len(starts) else len(text)
        blank = not text[start:end].strip()
        if text[start:end].lstrip().startswith("specification "):
            return end
        if not blank and not any(each.start <= start < each.end for each in comments):
            return start
        at = end
    return at


@cache
def _vocabulary() -> tuple[tuple[str, str, str, str], ...]:
    found = {word: (word, "keyword", doc, "") for word, doc in DECLARED_BY.items()}
    found |= {word: (word, "keyword", "a type of variables", "") for word in TYPES}
    found |= {word: (word, "keyword", "a part of a choice", "") for word in (THEN, ELSE)}
    for word in QUANTIFYING:
        found[word] = (word, "keyword", "over the members of a group", "")
    for operator in STL:
        for spelling in operator.spellings:
            if is_word(spelling):
                kind = "function" if kind_of(operator) == "function" else "operator"
                found.setdefault(spelling, (spelling, kind, meaning_of(operator), operator.example))
    return tuple(found[word] for word in sorted(found))


def _words(word: Span) -> Iterator[Item]:
    for text, kind, doc, example in _vocabulary():
        shown = f"{doc}\n\n```stl\n{example}\n```" if example else doc
        yield Item(text, kind, Edit(word, text), example, shown)
