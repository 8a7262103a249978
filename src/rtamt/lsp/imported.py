"""Names that other files define."""

from __future__ import annotations

import os
from functools import lru_cache
from typing import TYPE_CHECKING

from rtamt.language.parsing.imports import PACKAGED, called
from rtamt.lazy.tuples import NamedTuple
from rtamt.lsp.outline import outline

if TYPE_CHECKING:
    from rtamt.language.formula import Span
    from rtamt.lsp.document import Analysis
    from rtamt.lsp.symbols import Outline, Symbol

_IN_PACKAGE = "package:"
#: Outlines of imported files that are kept.
_KEPT = 64


class Elsewhere(NamedTuple):
    """A name that an imported file declares: the path of the file, its text, its name, and where the name is."""

    path: str
    text: str
    called: str
    symbol: Symbol

    @property
    def span(self) -> Span:
        """The position of the name."""
        return self.symbol.span

    @property
    def written(self) -> str:
        """The declaration."""
        end = self.text.find("\n", self.symbol.whole.end)
        return self.text[self.symbol.whole.start : end if end >= 0 else len(self.text)].strip()


def place_of(analysis: Analysis, name: str) -> Elsewhere | None:
    """Return where an imported file declares a name."""
    document = analysis.document
    if document is None:
        return None
    for file, text in dict(document.imported.values()).items():
        found = _outline(text).named(name) or _member(_outline(text), name)
        if found is not None and found.kind != "requirement":
            return Elsewhere(path_of(file), text, called(file), found)
    return None


def _member(outline: Outline, name: str) -> Symbol | None:
    """Return the member of an enumeration with a name."""
    return next((each for each in outline.symbols if each.kind == "value" and each.name == name), None)


def path_of(file: str) -> str:
    """Return the path of an imported file."""
    if file.startswith(_IN_PACKAGE):
        return os.path.join(PACKAGED, *file.removeprefix(_IN_PACKAGE).split("/"))
    return file


@lru_cache(maxsize=_KEPT)
def _outline(text: str) -> Outline:
    return outline(text)
