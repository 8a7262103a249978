"""Mend what rules found: ``rtamt lint --fix``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.errors import StlError
from rtamt.language.parsing.lexer import comments
from rtamt.language.substitution import substituted
from rtamt.lazy.tuples import NamedTuple
from rtamt.lint.report import findings

if TYPE_CHECKING:
    from collections.abc import Callable, Collection
    from fractions import Fraction

    from rtamt.language.document import Document
    from rtamt.language.formula import Formula
    from rtamt.language.operators import Language
    from rtamt.lint.found import Fix, LintWarning


class FixedText(NamedTuple):
    """A text after its fixes, what it means, and the codes of the findings that were fixed, one for each fix."""

    text: str
    document: Document
    codes: tuple[str, ...]


def with_fixes(
    document: Document,
    parse: Callable[[str], Document],
    language: Language,
    *,
    period: Fraction | None = None,
    ignored: Collection[str] = (),
) -> FixedText:
    """Fix every finding of a text that has a fix, except those with an ``ignored`` code.

    ``parse``: reads a text as ``document`` was read. The formulas of the new text are those of the old one with
    the parts replaced that the fixes replace; where they are not, or where a comment would be lost, the finding is left
    alone. Nothing else of the text changes.

    >>> from rtamt.language.operators import STL
    >>> from rtamt.language.parsing.specfile import parse_document
    >>> with_fixes(parse_document("always(not not (x > 3)) // twice"), parse_document, STL).text
    'always((x > 3)) // twice'
    """
    codes: list[str] = []
    left_alone: set[tuple[str, str]] = set()
    while True:
        for found in findings(document, language, period):
            if found.fix is None or found.code in ignored or _key(found) in left_alone:
                continue
            new = applied(document, found.fix, parse, language)
            if new is not None:
                document = new
                codes.append(found.code)
                break
            left_alone.add(_key(found))
        else:
            return FixedText(document.text, document, tuple(codes))


def _key(found: LintWarning) -> tuple[str, str]:
    assert found.span is not None
    return found.code, found.text[found.span.start :]


def applied(
    document: Document, fix: Fix, parse: Callable[[str], Document], language: Language
) -> Document | None:
    """Return the document after a fix; None if the text would lose a comment or mean something else."""
    text = document.text
    inside = comments(text, language) if "/" in text else []
    for edit in sorted(fix.edits, reverse=True):
        start, end = edit.span
        if any(start < comment.end and comment.start < end for comment in inside):
            return None
        text = text[:start] + edit.new + text[end:]
    try:
        found = parse(text)
    except StlError:
        return None
    return found if _formulas(found) == list(substituted(_formulas(document), fix.old, fix.new)) else None


def _formulas(document: Document) -> list[Formula]:
    return [
        *(assertion.formula for assertion in document.assertions),
        *document.definitions.values(),
        *(requirement.formula for requirement in document.requirements),
    ]
