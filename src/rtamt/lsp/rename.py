"""Give a name another spelling everywhere, without a change of meaning."""

from __future__ import annotations

import os
from itertools import islice, pairwise
from typing import TYPE_CHECKING

from rtamt.errors import StlError, UsageError
from rtamt.language.formula import Apply, Const, Span, Var, postorder
from rtamt.language.operators import STL
from rtamt.language.parsing.declarations import TYPES
from rtamt.language.parsing.lexer import NAME, quoted, tokenize
from rtamt.language.words import DECLARING, QUANTIFYING
from rtamt.lint.found import Edit
from rtamt.lsp.imported import place_of
from rtamt.lsp.symbols import is_local

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from rtamt.language.document import Declaration, Document
    from rtamt.language.formula import Formula
    from rtamt.lsp.document import Analysis
    from rtamt.lsp.symbols import Symbol

#: What can be renamed.
_RENAMED = ("variable", "constant", "parameter", "formula", "template", "argument")
_RESERVED = frozenset((*DECLARING, *QUANTIFYING, *TYPES, "then", "else", "inf", "in", "nan"))
#: The files of a folder that are searched for imports of the one that is changed.
_MOST_FILES, _MOST_BYTES = 500, 2**20


def renamed_at(analysis: Analysis, offset: int, path: str | None = None) -> tuple[Span, Symbol]:
    """Return the name at an offset that can be renamed. Raises :class:`UsageError` where there is none."""
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
        raise UsageError(
            f"'{name}' is not declared, so that it is the name of a recorded signal; declare it, such as "
            f"float {name}, to give it another name"
        )
    span, symbol = found
    if symbol.kind not in _RENAMED:
        raise UsageError(
            f"'{symbol.name}' is a {symbol.kind}; only variables, constants, parameters, named formulas and "
            f"templates can be renamed"
        )
    if analysis.errors:
        raise UsageError("the text has an error; correct it before a name is changed")
    importer = None if path is None or is_local(symbol) else _importer_of(path)
    if importer is not None:
        raise UsageError(
            f"'{importer}' imports this file, where '{symbol.name}' may be used; rename it in both by hand"
        )
    return span, symbol


def rename(analysis: Analysis, offset: int, new: str, path: str | None = None) -> list[Edit]:
    """Return the edits that give the name at an offset another spelling.

    ``path``: that of the file, to find those that import it. A variable goes on reading its column: where it has no
    recorded name, it gets the old one. Raises :class:`UsageError` for names that are taken or reserved.

    >>> from rtamt.lsp.document import Analysis
    >>> text = "const float most = 3; always(x < most)"
    >>> [(edit.span.start, edit.new) for edit in rename(Analysis(text), 14, "limit")]
    [(12, 'limit'), (33, 'limit')]
    """
    _span, symbol = renamed_at(analysis, offset, path)
    new = new.strip()
    if new == symbol.name:
        return []
    _check_new(analysis, symbol, new)
    plain = NAME.fullmatch(new) is not None
    written = new if plain else quoted(new)
    edits = [Edit(span, written) for span in analysis.outline.uses_of(symbol)]
    end = analysis.outline.ends.get(symbol)
    if end is not None:
        edits.append(Edit(Span(end, end), f" = {quoted(symbol.name)}"))
    _check_meaning(analysis, symbol, new, _edited(analysis.text, edits))
    return sorted(edits)


def _check_new(analysis: Analysis, symbol: Symbol, new: str) -> None:
    """Raise :class:`UsageError` unless a name is free and can be one."""
    if not new or not new.isprintable():
        raise UsageError("a name is one line of visible characters")
    if STL.opening(new) is not None or STL.infix(new) is not None or new in _RESERVED:
        raise UsageError(f"'{new}' is a word of the language; choose another name")
    if symbol.kind in ("template", "argument") and ("." in new or NAME.fullmatch(new) is None):
        what = "a parameter of a template" if symbol.kind == "argument" else "a template"
        raise UsageError(f"the name of {what} is one word of letters, digits and '_', got '{new}'")
    document = analysis.document
    assert document is not None
    taken = {
        *(each.name for each in analysis.outline.symbols),
        *analysis.outline.free,
        *document.definitions,
        *document.templates,
        *document.constants,
        *document.tables,
        *document.enumerations,
    }
    heads = {name.partition(".")[0] for name in taken}
    if new in taken or new in heads or new.partition(".")[0] in taken - {symbol.name}:
        raise UsageError(f"'{new}' is a name of this text already; choose another name")


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
    if _shape(before, symbol.name, new) != _shape(after, new, new):
        raise UsageError(f"'{symbol.name}' cannot become '{new}': the text would have another meaning")


def _shape(document: Document, old: str, new: str) -> object:
    """Return what a document means, with one name for another."""

    def called(name: str | None) -> str | None:
        if name == old:
            return new
        # A field of a message.
        return f"{new}{name[len(old) :]}" if name is not None and name.startswith(f"{old}.") else name

    formulas = [
        *(each.formula for each in document.assertions),
        *(each.formula for each in document.requirements),
    ]
    declared = [
        (called(each.name), each.type, each.kind, each.role, each.value, each.unit, _columns(each),
         each.optional, each.range, each.rate)
        for each in document.declarations
    ]  # fmt: skip
    names = (
        [called(each.name) for each in document.assertions],
        [called(each.name) for each in document.requirements],
        [called(each) for each in document.templates],
        sorted((called(each) or "", topic) for each, topic in document.topics.items()),
    )
    return declared, names, _nodes(formulas, called)


def _columns(declared: Declaration) -> tuple[str, ...]:
    """Return the names under which a variable is recorded."""
    return declared.columns or (declared.name,) if declared.kind == "var" else ()


def _nodes(formulas: Iterable[Formula], called: Callable[[str | None], str | None]) -> list[object]:
    """Return the nodes of formulas, operands first, each with the numbers of its operands."""
    numbers: dict[int, int] = {}
    found: list[object] = []
    for node in postorder(*formulas):
        numbers[id(node)] = len(numbers)
        if isinstance(node, Apply):
            below = tuple(numbers[id(each)] for each in node.args)
            constants = () if node.interval is None else tuple(map(called, node.interval.constants))
            found.append((node.op.name, node.interval, constants, below))
        elif isinstance(node, Const):
            found.append((repr(node.value), called(node.name)))
        else:
            assert isinstance(node, Var)
            found.append((called(node.name), str(node.type)))
    return found


def _edited(text: str, edits: Iterable[Edit]) -> str:
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
