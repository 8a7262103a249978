"""Give a name another spelling everywhere, without a change of meaning."""

from __future__ import annotations

import os
from bisect import bisect_right
from itertools import islice, pairwise
from typing import TYPE_CHECKING

from rtamt.errors import StlError, UsageError
from rtamt.language.formula import Span
from rtamt.language.operators import STL
from rtamt.language.parsing.declarations import TYPES
from rtamt.language.parsing.lexer import NAME, is_quoted, quoted, tokenize
from rtamt.language.parsing.requirements import ID
from rtamt.language.words import DECLARING, QUANTIFYING
from rtamt.lint.found import Edit
from rtamt.lsp.imported import place_of
from rtamt.lsp.meaning import Renamed, meaning

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rtamt.language.parsing.lexer import Tokens
    from rtamt.lsp.document import Analysis
    from rtamt.lsp.symbols import Symbol

#: Names that are one word, and what they name.
_ONE_WORD = {
    "template": "a template",
    "argument": "a parameter of a template",
    "member": "a member of a group",
    "group": "a group",
    "enumeration": "an enumeration",
}
_RESERVED = frozenset((*DECLARING, *QUANTIFYING, *TYPES, "then", "else", "inf", "in", "nan"))
_HAS_AN_ERROR = "the text has an error; correct it before a name is changed"
#: The files of a folder that are searched for imports of the one that is changed.
_MOST_FILES, _MOST_BYTES = 500, 2**20


def renameable_at(analysis: Analysis, offset: int, path: str | None = None) -> tuple[Span, Symbol]:
    """Return the name at an offset that can be renamed. Raises :class:`UsageError` if there is none."""
    found = analysis.outline.at(offset)
    if found is None:
        name = next(
            (known for known, spans in analysis.outline.free.items() for span in spans
             if span.start <= offset <= span.end),
            None,
        )  # fmt: skip
        if name is None:
            raise UsageError("there is no name here that can be renamed")
        elsewhere = place_of(analysis, name)
        if elsewhere is not None:
            raise UsageError(f"'{name}' is defined in '{elsewhere.called}'; rename it there")
        if analysis.document is None:
            raise UsageError(_HAS_AN_ERROR)
        declared = name if NAME.fullmatch(name) else quoted(name)
        raise UsageError(
            f"'{name}' is not declared, so that it is the name of a recorded signal; declare it, such as "
            f"float {declared}, to give it another name"
        )
    span, symbol = found
    if symbol.kind == "class":
        raise UsageError(f"'{symbol.name}' is a class of messages, whose name is that of its module")
    document = analysis.document
    if document is None:
        raise UsageError(_HAS_AN_ERROR)
    classes = {each.name for each in document.imports}
    if any(each.name == symbol.name and each.type in classes for each in document.declarations):
        raise UsageError(f"'{symbol.name}' is a message, whose fields are recorded under this name")
    importer = None if path is None or symbol.kind in ("member", "requirement") else _importer_of(path)
    if importer is not None:
        raise UsageError(
            f"'{importer}' imports this file, where '{symbol.name}' may be used; rename it in both by hand"
        )
    return span, symbol


def rename(analysis: Analysis, offset: int, new: str, path: str | None = None) -> list[Edit]:
    """Return the edits that give the name at an offset another spelling.

    ``path``: that of the file, to find those that import it. A variable or a field still reads its column: where
    it has no recorded name, it gets the old one. Raises :class:`UsageError` for names that are taken or reserved.

    >>> from rtamt.lsp.document import Analysis
    >>> text = "const float most = 3; always(x < most)"
    >>> [(edit.span.start, edit.new) for edit in rename(Analysis(text), 14, "limit")]
    [(12, 'limit'), (33, 'limit')]
    """
    _span, symbol = renameable_at(analysis, offset, path)
    new = new.strip()
    if new == symbol.name:
        return []
    _check_new(analysis, symbol, new)
    tokens = tokenize(analysis.text, STL)
    edits = [
        _edit_of_name(analysis.text, tokens, span, symbol, new) for span in analysis.outline.uses_of(symbol)
    ]
    end = analysis.outline.ends.get(symbol)
    if end is not None:
        edits.append(Edit(Span(end, end), f" = {quoted(symbol.name)}"))
    _check_meaning(analysis, symbol, new, _apply_edits(analysis.text, edits))
    return sorted(edits)


def _edit_of_name(text: str, tokens: Tokens, span: Span, symbol: Symbol, new: str) -> Edit:
    """Return the edit that writes a name at a span: quoted if it needs quotes and is not quoted already."""
    pattern = ID if symbol.kind == "requirement" else NAME
    if pattern.fullmatch(new) and not _is_word(new):
        return Edit(span, new)
    at = bisect_right(tokens.starts, span.start, 0, len(tokens) - 1) - 1
    begin, end = tokens.starts[at], max(tokens.ends[at], span.end)
    if is_quoted(tokens.texts[at]) and begin < span.start:
        return Edit(span, quoted(new)[1:-1])
    return Edit(Span(begin, end), quoted(text[begin : span.start] + new + text[span.end : end]))


def _is_word(new: str) -> bool:
    """Return whether a name is a word of the language."""
    return STL.opening(new) is not None or STL.infix(new) is not None or new in _RESERVED


def _check_new(analysis: Analysis, symbol: Symbol, new: str) -> None:
    """Raise :class:`UsageError` unless a name is free and can be one."""
    if not new or not new.isprintable():
        raise UsageError("a name is one line of visible characters")
    if _is_word(new) and symbol.kind != "requirement":
        raise UsageError(f"'{new}' is a word of the language; choose another name")
    if symbol.kind in _ONE_WORD and ("." in new or NAME.fullmatch(new) is None):
        raise UsageError(
            f"the name of {_ONE_WORD[symbol.kind]} is one word of letters, digits and '_', got '{new}'"
        )
    taken = _names_in_use(analysis, symbol)
    heads = {name.partition(".")[0] for name in taken}
    if new in taken or new in heads or new.partition(".")[0] in taken - {symbol.name}:
        raise UsageError(f"'{new}' is a name of this text already; choose another name")


def _names_in_use(analysis: Analysis, symbol: Symbol) -> set[str]:
    """Return the names of a text that a symbol cannot have: of others of its kind, and what means something there."""
    siblings = {
        each.name for each in analysis.outline.symbols if (each.kind, each.of) == (symbol.kind, symbol.of)
    }
    if symbol.kind == "field":
        return siblings
    document = analysis.document
    assert document is not None
    return {
        *siblings,
        *(
            each.name
            for each in analysis.outline.symbols
            if each.kind != "field" and _meet(each.scope, symbol.scope)
        ),
        *analysis.outline.free,
        *document.definitions,
        *document.templates,
        *document.constants,
        *document.tables,
        *document.enumerations,
        *document.groups,
    }


def _meet(one: Span, other: Span) -> bool:
    return one.start < other.end and other.start < one.end


def _check_meaning(analysis: Analysis, symbol: Symbol, new: str, text: str) -> None:
    """Raise :class:`UsageError` unless a text means the same as before, apart from the name."""
    before = analysis.document
    assert before is not None
    try:
        after = analysis.read(text)
    except StlError as error:
        raise UsageError(
            f"'{symbol.name}' cannot become '{new}': {getattr(error, 'message', error)}"
        ) from None
    if meaning(before, Renamed(symbol, symbol.name)) != meaning(after, Renamed(symbol, new)):
        raise UsageError(f"'{symbol.name}' cannot become '{new}': the text would have another meaning")


def _apply_edits(text: str, edits: Iterable[Edit]) -> str:
    for edit in sorted(edits, reverse=True):
        text = text[: edit.span.start] + edit.new + text[edit.span.end :]
    return text


def _importer_of(path: str) -> str | None:
    """Return a file in the folder of a file, or above it, that imports the file."""
    folder, name = os.path.split(os.path.realpath(path))
    below = name
    for _ in range(3):
        if not os.path.isdir(folder):
            return None
        files = sorted(each for each in os.listdir(folder) if each.endswith(".stl"))
        for file in islice(files, _MOST_FILES):
            whole = os.path.join(folder, file)
            if whole != path and os.path.isfile(whole) and _imports(whole, below):
                return file
        folder, last = os.path.split(folder)
        below = f"{last}/{below}"
    return None


def _imports(path: str, name: str) -> bool:
    with open(path, encoding="utf-8", errors="replace") as file:
        texts = tokenize(file.read(_MOST_BYTES), STL).texts
    return any(word == "import" and after == quoted(name) for word, after in pairwise(texts))
