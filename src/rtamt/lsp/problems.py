"""Errors and findings with their positions, and the edits that mend them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from rtamt.errors import SpecificationError
from rtamt.language.formula import Span
from rtamt.language.operators import STL
from rtamt.language.parsing.lexer import NAME, quoted
from rtamt.lazy.patterns import lazy_pattern
from rtamt.lazy.tuples import NamedTuple
from rtamt.lint.fix import applied, with_fixes
from rtamt.lint.found import Edit
from rtamt.lint.rules import ALL
from rtamt.lsp.document import ENDING

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.errors import StlError
    from rtamt.language.document import Document
    from rtamt.lint.found import LintWarning, Rule
    from rtamt.lsp.document import Analysis

_SUGGESTED = lazy_pattern(r"did you mean '([^']+)'\?")

RULES: dict[str, Rule] = {rule.code: rule for rule in ALL}


class Problem(NamedTuple):
    """A problem of a text: its place, severity ("error", "warning" or "note"), code, and message."""

    span: Span
    severity: str
    code: str
    message: str


class Repair(NamedTuple):
    """The fix of a problem: its title for the user, the edits, the code of the finding."""

    title: str
    edits: tuple[Edit, ...]
    code: str


def problems(analysis: Analysis) -> list[Problem]:
    """Return the errors of a text, or its findings.

    >>> from rtamt.lsp.document import Analysis
    >>> problems(Analysis("always(x >= )"))[0][:3]
    (Span(start=12, end=13), 'error', '')
    """
    errors = [
        Problem(_inside(analysis, place_of(each)), "error", "", getattr(each, "message", str(each)))
        for each in analysis.errors
    ]
    return errors + [
        Problem(_inside(analysis, each.span), each.severity, each.code, each.message)
        for each in analysis.findings
    ]


def place_of(error: StlError) -> Span | None:
    """Return where an error is, if it is in the text."""
    return error.span if isinstance(error, SpecificationError) else None


def _inside(analysis: Analysis, span: Span | None) -> Span:
    """Return a span that is not empty, if the text is not: the first character for what has no place."""
    if span is None:
        return Span(0, min(1, len(analysis.text)))
    end = min(max(span.end, span.start + 1), len(analysis.text))
    return Span(max(min(span.start, end - 1), 0), end)


def repairs(analysis: Analysis, span: Span) -> list[Repair]:
    """Return the fixes of the problems that touch a span.

    >>> from rtamt.lsp.document import Analysis
    >>> print(repairs(Analysis("always(not not (x > 3))"), Span(8, 8))[0].title)
    Fix RT503: a double negation
    """
    if analysis.errors:
        return [each for error in analysis.errors for each in _suggestions(analysis, error, span)]
    found = []
    for each in analysis.findings:
        if not _touch(_inside(analysis, each.span), span):
            continue
        if each.fix is not None and _is_safe(analysis, each):
            found.append(Repair(f"Fix {each.code}: {RULES[each.code].about}", each.fix.edits, each.code))
        if (
            each.code in RULES
            and each.severity != "error"
            and (edit := _silencing(analysis, each)) is not None
        ):
            found.append(Repair(f"Ignore {each.code} on this line", (edit,), each.code))
    return found


def fix_all(analysis: Analysis) -> str | None:
    """Return the text without the findings that have a fix; None if there is none."""
    document = analysis.document
    if document is None or analysis.spec is None or not any(each.fix for each in analysis.findings):
        return None
    result = with_fixes(document, _reader(analysis), STL, period=analysis.spec.period)
    return result.text.removesuffix(ENDING if analysis.library else "") if result.codes else None


def _reader(analysis: Analysis) -> Callable[[str], Document]:
    """Return the parser of a new version of the document, whose text has an ending if it is a library."""
    ending = ENDING if analysis.library else ""
    return lambda text: analysis.read(text.removesuffix(ending))


def _is_safe(analysis: Analysis, found: LintWarning) -> bool:
    document = analysis.document
    assert document is not None
    assert found.fix is not None
    return applied(document, found.fix, _reader(analysis), STL) is not None


def _touch(one: Span, other: Span) -> bool:
    return one.start <= other.end and other.start <= one.end


def _suggestions(analysis: Analysis, error: StlError, span: Span) -> list[Repair]:
    """Return the name that an error message suggests as a replacement."""
    place = place_of(error)
    suggested = _SUGGESTED.search(str(error))
    if suggested is None or place is None or not _touch(place, span):
        return []
    written = analysis.text[place.start : place.end]
    if not re.fullmatch(r'[\w.$/]+|"[^"]*"', written):
        return []
    plain = written[0] != '"' and (NAME.fullmatch(suggested[1]) or "/" in suggested[1])
    new = suggested[1] if plain else quoted(suggested[1])
    return [Repair(f"Replace {written} by {new}", (Edit(place, new),), "")]


def _silencing(analysis: Analysis, found: LintWarning) -> Edit | None:
    """Return the edit that adds a comment to the line of a finding; None where there is a comment already."""
    lines, span = analysis.lines, _inside(analysis, found.span)
    line = lines.place(span.start).line
    end = lines.starts[line + 1] if line + 1 < len(lines.starts) else len(analysis.text)
    end = len(analysis.text[:end].rstrip("\r\n")) if end > lines.starts[line] else end
    if any(each.start < end and each.end > lines.starts[line] for each in analysis.comments):
        return None
    return Edit(Span(end, end), f" // lint: ignore[{found.code}]")
