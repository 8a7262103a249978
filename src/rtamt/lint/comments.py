"""Comments that silence findings: ``// lint: ignore[RT105, RT401]``.

A comment behind a formula silences the findings of its line, one alone on its line those of the next line that is no
comment. Nothing else of a text depends on a comment.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from rtamt.language.formula import Span
from rtamt.language.parsing.lexer import LINE_END, comments
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.patterns import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtamt.language.operators import Language

#: What a text contains that may have such a comment: most have none.
MARK = "lint:"
_IGNORE = lazy_pattern(r"lint:\s*ignore\[([^\]]*)\]")


@dataclass(frozen=True, slots=True)
class Silenced:
    """A code in a comment, its position, and the stretch of text in which it silences findings."""

    code: str
    span: Span
    where: Span


def silenced(text: str, language: Language) -> Iterator[Silenced]:
    """Yield the codes that comments of a text silence."""
    if MARK not in text:
        return
    found = list(comments(text, language))
    for comment in found:
        match = _IGNORE.search(text, comment.start, comment.end)
        if match is None:
            continue
        where = _where(text, comment, found)
        for code in re.finditer(r"[^\s,]+", match[1]):
            start = match.start(1) + code.start()
            yield Silenced(code[0], Span(start, start + len(code[0])), where)


def _where(text: str, comment: Span, every: list[Span]) -> Span:
    """Return the line of a comment; of one that is alone on its line, the next one with more than comments."""
    ends = [match.end() for match in LINE_END.finditer(text)]
    starts = [0, *ends]
    lines = [Span(start, end) for start, end in zip(starts, [*ends, len(text)], strict=True)]
    at = max(k for k, line in enumerate(lines) if line.start <= comment.start)
    while at + 1 < len(lines) and _is_blank(text, lines[at], every):
        at += 1
    return lines[at]


def _is_blank(text: str, line: Span, comments: list[Span]) -> bool:
    """Return whether a line has nothing but comments."""
    left, at = "", line.start
    for comment in comments:
        if comment.end > line.start and comment.start < line.end:
            left += text[at : max(at, comment.start)]
            at = max(at, comment.end)
    return not (left + text[at : line.end]).strip()
