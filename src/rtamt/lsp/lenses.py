"""Lines above requirements: the verdict on a recording, and its robustness."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.lazy.tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.language.formula import Span
    from rtamt.lsp.document import Analysis

#: The longest reason in a title.
_LONGEST = 120
_SIGNS = {"satisfied": "✓", "violated": "✗", "unchecked": "–", "error": "!"}


class Lens(NamedTuple):
    """A line above a requirement: where, its title, and its command."""

    span: Span
    title: str
    command: str


def lenses(analysis: Analysis, recording: str | None, answer: Mapping[str, Any] | None) -> list[Lens]:
    """Return a line for each requirement.

    ``recording``: its name, None where none is chosen. ``answer``: what the other process found for this text.

    >>> from rtamt.lsp.document import Analysis
    >>> row = {"name": "R1", "verdict": "satisfied", "robustness": "2.0"}
    >>> lenses(Analysis("require R1: x > 3"), "drive.csv", {"rows": [row]})[0].title
    '✓ satisfied, robustness 2 (drive.csv)'
    """
    document = analysis.document
    if document is None or analysis.library:
        return []
    found = []
    rows = {} if answer is None else {row["name"]: row for row in answer.get("rows", ())}
    for requirement in document.requirements:
        if requirement.span is None:
            continue
        if recording is None:
            lens = Lens(requirement.span, "choose a recording", "rtamt.chooseRecording")
        elif requirement.name in rows:
            title = f"{_verdict_title(rows[requirement.name])} ({recording})"
            lens = Lens(requirement.span, title, "rtamt.check")
        elif answer is not None:
            reason = f"{_SIGNS['error']} {_short(str(answer.get('error', '')))} ({recording})"
            lens = Lens(requirement.span, reason, "rtamt.check")
        else:
            lens = Lens(requirement.span, f"check against {recording}", "rtamt.check")
        found.append(lens)
    return found


def _verdict_title(row: Mapping[str, Any]) -> str:
    verdict = row["verdict"]
    more = (
        f", robustness {float(row['robustness']):.6g}"
        if "robustness" in row
        else f": {_short(row['reason'])}"
    )
    return f"{_SIGNS[verdict]} {verdict}{more}"


def _short(reason: str) -> str:
    return reason if len(reason) <= _LONGEST else f"{reason[:_LONGEST]}…"
