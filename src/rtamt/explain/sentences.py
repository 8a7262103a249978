"""An explanation in words."""

from __future__ import annotations

from math import isinf
from typing import TYPE_CHECKING

from rtamt.language.printer import PAGE, to_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.explain.report import CriticalPoint, Stretch
    from rtamt.language.formula import Formula

_NO_PREDICATE = {
    "start": "no predicate decides it: nothing was recorded before the start, where a window looks",
    "end": "no predicate decides it: nothing was recorded after the end, where a window looks",
    "constant": "no predicate decides it: a constant of the formula does",
}


def predicate_text(predicate: Formula, text: str | None) -> str:
    """Return a predicate as it was written in ``text``, if it was on one line, else as it is printed."""
    span = predicate.span
    if text is not None and span is not None:
        written = text[span.start : span.end]
        if written and "\n" not in written and "/*" not in written and len(written) <= PAGE:
            return written
    return to_text(predicate, limit=PAGE)


def sentences(
    formula: str,
    when: str,
    satisfied: bool,
    robustness: float,
    critical: tuple[CriticalPoint, str],
    stretches: Sequence[tuple[Stretch, str]],
) -> tuple[str, ...]:
    """Return the lines of an explanation; with the critical point and each stretch comes its time in words."""
    verdict = "satisfied" if satisfied else "violated"
    margin = f"by {_short(abs(robustness))}" if robustness else "with robustness 0"
    lines = [f"{verdict} {margin} at {when}: {formula}", _decision(*critical)]
    if not stretches:
        lines.append("the verdict rests on no predicate: whatever the signals do, it stands")
        return tuple(lines)
    lines.append(f"whatever the signals do elsewhere, it is {verdict} because")
    for stretch, time in stretches:
        truth = "held" if stretch.holds else "failed"
        values = _short(stretch.lowest)
        if stretch.highest != stretch.lowest:
            values += f" to {_short(stretch.highest)}"
        lines.append(f"  '{stretch.predicate}' {truth} {time} ({values})")
    return tuple(lines)


def _decision(point: CriticalPoint, when: str) -> str:
    if point.predicate is None:
        return f"{_NO_PREDICATE[point.decided_by]} (at {when})"
    told = f"'{point.predicate}' is {_short(point.value)} at {when}"
    if point.decided_by == "constant":
        return f"{told}: a constant"
    if point.lowest == point.highest:
        return f"{told}: something else gives the same robustness, and moving this one alone changes nothing"
    return f"{told}: the robustness follows it{_reach(point)}"


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
