"""What is known before the whole trace is: bounds of a robustness, and verdicts with the sample that decided them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Interval:
    """Bounds of a number: the robustness of every trace that agrees with what is known of the signals.

    >>> from rtamt import Interval
    >>> Interval(-2.0, 3.0)
    Interval(lower=-2.0, upper=3.0)
    """

    lower: float
    upper: float


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether a formula holds at one sample of discrete time, and the earliest sample that decides it.

    Times are in the form in which the samples were given. ``decided_at`` may be earlier than ``time``.

    >>> from rtamt import Verdict
    >>> Verdict(0.0, False, 2.5)
    Verdict(time=0.0, satisfied=False, decided_at=2.5)
    """

    time: Any
    satisfied: bool
    decided_at: Any


@dataclass(frozen=True, slots=True)
class VerdictRun:
    """The verdict of dense time at every instant from ``begin`` up to, and without, ``end``.

    ``decided_at`` is the time of the earliest sample that decides all of the run. A sample decides the
    tick of its own time too, so that runs end one tick after the newest sample where later instants are open.

    >>> from rtamt import VerdictRun
    >>> VerdictRun(0.0, 2.5, satisfied=False, decided_at=2.5)
    VerdictRun(begin=0.0, end=2.5, satisfied=False, decided_at=2.5)
    """

    begin: Any
    end: Any
    satisfied: bool
    decided_at: Any
