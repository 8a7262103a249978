"""What an explanation says: as data, and as sentences."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.signals.datetimes import nanoseconds_of

if TYPE_CHECKING:
    from rtamt.language.formula import Formula


@dataclass(frozen=True, slots=True)
class CriticalPoint:
    """The predicate and the instant whose value is, up to sign, the robustness.

    ``predicate`` is its text and ``formula`` the predicate itself; both are None where no predicate
    decides, and ``decided_by`` says what does: "predicate", "start" or "end" (of the recording: a
    window there is empty), or "constant". ``time``: as the caller tells time. ``value``: of the
    predicate there; the robustness is ``polarity`` (+1 or -1) times it. ``start`` and ``end``: in dense
    time the segment [start, end) around ``time`` with that value, else ``time`` itself.

    Were ``polarity`` times this one value r instead, at this place of the formula and all else as it
    is, the robustness would be r, cut to [``lowest``, ``highest``]: beyond these something else
    decides. So moving it across 0 makes the verdict fall where 0 lies between them, and does not
    where something else (the other operand of an ``or``, a later witness) holds as well.
    """

    predicate: str | None
    formula: Formula | None
    time: Any
    start: Any
    end: Any
    value: float
    polarity: int
    lowest: float
    highest: float
    decided_by: str = "predicate"


@dataclass(frozen=True, slots=True)
class Stretch:
    """A predicate and an interval on which it held, or failed, throughout; part of an implicant.

    ``start`` and ``end`` are times as the caller tells time, None for an end that never comes; ``end``
    belongs to the interval if ``closed``, as it always does in discrete time. ``lowest`` and
    ``highest``: of the predicate's robustness on the interval. The predicate's value on it depends on
    the signals from ``reads_from`` to ``reads_to``: more than the interval where operators in time stand
    inside a comparison, or where an operator has a definition only and is taken as a whole.
    """

    predicate: str
    formula: Formula
    holds: bool
    start: Any
    end: Any
    closed: bool
    lowest: float
    highest: float
    reads_from: Any
    reads_to: Any


@dataclass(frozen=True, slots=True)
class Explanation:
    """Why a formula is satisfied or violated at an instant: prints as sentences.

    ``critical`` tells why the robustness is what it is: if every predicate moves by less than
    its size the verdict stands. ``implicant`` tells why the verdict is what it is: the predicates
    on these intervals force it, whatever the signals do elsewhere, and none of them can be left out.
    """

    formula: str
    time: Any
    satisfied: bool
    robustness: float
    critical: CriticalPoint
    implicant: tuple[Stretch, ...]
    sentences: tuple[str, ...]

    def __str__(self) -> str:
        return "\n".join(self.sentences)

    def to_dict(self) -> dict[str, Any]:
        """Return the explanation as what JSON can hold.

        Formulas are text, infinities the strings "inf" and "-inf", dates ISO 8601.
        """
        point = self.critical
        return {
            "formula": self.formula,
            "time": _plain(self.time),
            "satisfied": self.satisfied,
            "robustness": _plain(self.robustness),
            "critical": {
                "predicate": point.predicate,
                "time": _plain(point.time),
                "start": _plain(point.start),
                "end": _plain(point.end),
                "value": _plain(point.value),
                "polarity": point.polarity,
                "lowest": _plain(point.lowest),
                "highest": _plain(point.highest),
                "decided_by": point.decided_by,
            },
            "implicant": [
                {
                    "predicate": stretch.predicate,
                    "holds": stretch.holds,
                    "start": _plain(stretch.start),
                    "end": _plain(stretch.end),
                    "closed": stretch.closed,
                    "lowest": _plain(stretch.lowest),
                    "highest": _plain(stretch.highest),
                    "reads_from": _plain(stretch.reads_from),
                    "reads_to": _plain(stretch.reads_to),
                }
                for stretch in self.implicant
            ],
        }


def _plain(value: Any) -> Any:
    if isinstance(value, np.datetime64):
        return str(value)
    if isinstance(value, np.timedelta64):
        return nanoseconds_of(value)
    return str(value) if isinstance(value, float) and not isfinite(value) else value
