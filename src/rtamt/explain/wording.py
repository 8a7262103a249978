"""An explanation in words."""

from __future__ import annotations

from math import isinf
from typing import TYPE_CHECKING

from rtamt.language.formula import Var, postorder
from rtamt.language.printing.printer import to_text
from rtamt.language.printing.writing import PAGE

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from rtamt.explain.explanation import CriticalPoint, Stretch
    from rtamt.language.formula import Formula

_NO_PREDICATE = {
    "start": "no predicate decides the robustness: a window before the start of the trace is empty",
    "end": "no predicate decides the robustness: a window after the end of the trace is empty",
    "constant": "no predicate decides the robustness: a constant of the formula does",
}
#: Before the causes.
CAUSE = "sufficient cause, independent of all other samples:"
_NO_CAUSE = "the verdict depends on no predicate"
#: Intervals of a signal that are printed of those that a predicate reads.
_READ = 3


def predicate_text(predicate: Formula, text: str | None) -> str:
    """Return a predicate as it was written in ``text``, if it was on one line, else as it is printed."""
    span = predicate.span
    if text is not None and span is not None and not _of_members(predicate, text):
        written = text[span.start : span.end]
        # A comparison with one member of a set, `mode in {AUTO, RTL}`, is not written as a text of its own.
        whole = written.count("{") == written.count("}")
        if written and whole and "\n" not in written and "/*" not in written and len(written) <= PAGE:
            return written
    return to_text(predicate, limit=PAGE)


def _of_members(predicate: Formula, text: str) -> bool:
    """Return whether a predicate reads fields of members, which the text calls by the variable of a quantifier."""
    signals = (node for node in postorder(predicate) if isinstance(node, Var) and node.span is not None)
    return any(node.name not in text[node.span.start : node.span.end] for node in signals if node.span)


def summary(
    formula: str,
    verdict: str,
    robustness: float,
    when: str | None,
    first_violation: str | None,
    critical: tuple[CriticalPoint, str, str],
    *,
    caused: bool,
) -> tuple[str, ...]:
    """Return the lines of an explanation before the causes.

    ``critical``: the critical point, its time and the samples that its value comes from, in words.
    ``when``: the explained instant, None where it is the first of the trace. ``caused``: whether causes follow.
    """
    at = "" if when is None else f" at {when}"
    lines = [f"{verdict}{at}, robustness {_short(robustness)}: {formula}"]
    if first_violation is not None:
        lines.append(f"first violation at {first_violation}")
    return (*lines, _decision(*critical), CAUSE if caused else _NO_CAUSE)


def cause(stretch: Stretch, when: str, reads: str) -> str:
    """Return the line about one interval of the implicant; ``reads``: the samples it reads, if they are others."""
    values = stretch.recorded or _short(stretch.lowest)
    if not stretch.recorded and stretch.highest != stretch.lowest:
        values += f" to {_short(stretch.highest)}"
    sentence = f"'{stretch.predicate}' {'holds' if stretch.holds else 'fails'} {when} ({values})"
    return f"{sentence}, reading {reads}" if reads else sentence


def reading(signals: Iterable[tuple[str, Sequence[str]]]) -> str:
    """Return in words when signals are read: ``x from 1 s to 3 s, y at 2 s and at 4 s``."""
    parts = []
    for name, times in signals:
        more = [f"{len(times) - _READ} more times"] if len(times) > _READ + 1 else times[_READ:]
        *rest, last = (*times[:_READ], *more)
        parts.append(f"{name} {', '.join(rest)} and {last}" if rest else f"{name} {last}")
    return ", ".join(parts) or "no sample"


def _decision(point: CriticalPoint, when: str, source: str) -> str:
    if point.predicate is None:
        return _NO_PREDICATE[point.decided_by]
    value = f"is {_short(point.value)}"
    if point.recorded:
        value = f"{'holds' if point.value > 0 else 'fails'} ({point.recorded})"
    sentence = f"critical point at {when}: '{point.predicate}' {value}"
    if point.decided_by == "constant":
        return f"{sentence}, a constant"
    if source:
        sentence += f", reading {source}"
    if point.lowest == point.highest:
        return f"{sentence}; others give the same robustness"
    return f"{sentence}; the robustness follows it{_reach(point)}"


def _reach(point: CriticalPoint) -> str:
    """Return how far the robustness follows the critical value: nothing where it does whatever the value."""
    down = "" if isinf(point.lowest) else f" to {_short(point.lowest)}"
    up = "" if isinf(point.highest) else f" to {_short(point.highest)}"
    if point.value == point.highest:
        return f" down{down}, not up"
    if point.value == point.lowest:
        return f" up{up}, not down"
    if down and up:
        return f" from {_short(point.lowest)}{up}"
    return f" down{down}" if down else f" up{up}" if up else ""


def _short(value: float) -> str:
    return f"{value + 0.0:.6g}"
