"""The outcome of a requirement on a recording, as reports show it."""

from __future__ import annotations

import time as clock
from decimal import Decimal
from fractions import Fraction
from functools import reduce
from math import inf
from typing import TYPE_CHECKING, Any

from rtamt.cli.command import short, stamp_text
from rtamt.cli.parser import ERROR, OK, VIOLATED, complain
from rtamt.language.operators import STL
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.lazy.modules import np
from rtamt.readers.sql import shown
from rtamt.signals.datetimes import nanoseconds_of
from rtamt.signals.epoch import is_epoch, moment_text

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from rtamt.language.document import Requirement as Written
    from rtamt.results import Result
    from rtamt.signals.episodes import Episodes
    from rtamt.signals.outcomes import Interval
    from rtamt.specification import Specification


#: Of a verdict, the exit code.
CODES = {"satisfied": OK, "violated": VIOLATED, "unchecked": OK, "error": ERROR}


@dataclass(frozen=True, slots=True)
class Requirement:
    """A specification, its file or text on the command line, and its name in reports.

    ``rows``: where there are several requirements in it, each alone.
    """

    spec: Specification
    given: str
    label: str
    rows: tuple[Requirement, ...] = ()

    @property
    def written(self) -> Written:
        """The name, description and severity of a single requirement in the specification."""
        return self.spec.document.requirements[0]


@dataclass(frozen=True, slots=True)
class Outcome:
    """The outcome of one requirement on one recording, or the reason why there is none.

    ``first_violation``: seconds (a decimal where a double cannot hold them), or a date; None where there is
    none. ``moment``: the same as text: seconds, or a date with the seconds since the start of the recording.
    ``period``: None in dense time.
    ``notes``: shown with the verdict (:attr:`Trace.remarks`).
    ``decided_at``: when its verdict was decided, where nothing later was read; the robustness is then known to lie
    within ``bounds``, and NaN where these differ.
    ``episodes``: of violation; None where they are not known. ``episodes_text``: the same as part of a sentence.
    ``explanation``: of a violation, if requested and if the whole recording was read.
    ``seconds``: how long it took. ``result`` stays in the process that made it.
    """

    requirement: str
    trace: str
    verdict: str  # satisfied, violated, unchecked or error
    robustness: float = float("nan")
    first_violation: float | str | Decimal | None = None
    moment: str = ""
    samples: int = 0
    period: Fraction | None = None
    error: str = ""
    #: Why it was not checked: what the recording lacks.
    unchecked: str = ""
    notes: tuple[str, ...] = ()
    decided_at: float | str | Decimal | None = None
    bounds: Interval | None = None
    episodes: Episodes | None = None
    episodes_text: str = ""
    explanation: str = ""
    seconds: float = 0.0
    result: Result | None = None

    @property
    def result_known(self) -> bool:
        """Whether it was evaluated."""
        return not self.error and not self.unchecked

    @property
    def robustness_text(self) -> str:
        """The robustness, or its bounds."""
        low, high = (self.robustness,) * 2 if self.bounds is None else (self.bounds.lower, self.bounds.upper)
        if low == high or self.bounds is None:
            return short(self.robustness)
        if low == -inf:
            return "unknown" if high == inf else f"<= {short(high)}"
        return f">= {short(low)}" if high == inf else f"{short(low)} to {short(high)}"


def failed(requirement: Requirement, trace: str, error: str, begin: float) -> Outcome:
    """Return the outcome of a requirement that could not be evaluated."""
    return Outcome(
        requirement.label, shown(trace), "error", error=error, seconds=clock.perf_counter() - begin
    )


def skipped(requirement: Requirement, trace: str, reason: str) -> Outcome:
    """Return the outcome of a requirement that a recording does not have the signals for."""
    return Outcome(requirement.label, shown(trace), "unchecked", unchecked=f"not checked: {reason}")


def applicable(
    requirements: Sequence[Requirement], signals: Collection[str], trace: str
) -> tuple[list[Requirement], list[Outcome]]:
    """Return the requirements that a recording has the signals for, and outcomes of the others."""
    kept: list[Requirement] = []
    unchecked: list[Outcome] = []
    for requirement in requirements:
        rows = requirement.rows or (requirement,)
        reasons = [row.spec.unchecked(signals) for row in rows]
        if not any(reasons):
            kept.append(requirement)
            continue
        rest = [
            known.formula for known in requirement.spec.document.requirements if known.name not in reasons[0]
        ]
        if not requirement.rows and rest:  # their conjunction is evaluated over the available signals
            kept.append(replace(requirement, spec=requirement.spec.with_formula(reduce(STL["and"], rest))))
        for row, reason in zip(rows, reasons, strict=True):
            if reason:
                names = "" if len(row.spec.document.requirements) == 1 else f"{', '.join(reason)}: "
                unchecked.append(skipped(row, trace, names + "; ".join(dict.fromkeys(reason.values()))))
            else:
                kept.append(row)
    return kept, unchecked


def together(found: Sequence[Outcome], unchecked: Sequence[Outcome]) -> dict[str, Outcome]:
    """Return the outcomes by requirement; those checked in part also have the unchecked rest."""
    of = {outcome.requirement: outcome for outcome in unchecked}
    for outcome in found:
        lacking = of.get(outcome.requirement)
        of[outcome.requirement] = (
            outcome if lacking is None else replace(outcome, unchecked=lacking.unchecked)
        )
    return of


def nothing_checked(recording: str) -> str:
    """Return the error for a recording on which no requirement can be checked."""
    return f"{recording}: nothing was checked: every requirement reads signals that the recording lacks"


def exit_code(outcomes: Sequence[Outcome]) -> int:
    """Return the exit code of a check: the gravest verdict, and an error where nothing of a recording was checked."""
    checked = {outcome.trace for outcome in outcomes if not outcome.unchecked}
    for trace in dict.fromkeys(outcome.trace for outcome in outcomes):
        if trace not in checked:
            complain(nothing_checked(trace))
    unchecked = any(outcome.trace not in checked for outcome in outcomes)
    return max(ERROR if unchecked else OK, *(CODES[outcome.verdict] for outcome in outcomes))


def count_verdicts(verdicts: Sequence[str]) -> str:
    """Return the number of each verdict as text."""
    return ", ".join(f"{verdicts.count(verdict)} {verdict}" for verdict in CODES if verdict in verdicts)


def moment_of(time: Any, start: Any) -> str:
    """Return a time as text: of a recording that counts from 1970 the date and the seconds since its start."""
    if time is None:
        return ""
    dated = isinstance(time, np.datetime64)
    begin = _seconds(start)
    if (dated and isinstance(start, np.datetime64)) or (not dated and is_epoch(begin)):
        return moment_text(_seconds(time), begin)
    return f"{str(plain_time(time)).removesuffix('.0')} s"


def episodes_of(found: Episodes | None, start: Any) -> dict[str, Any]:
    """Return episodes of violation as members of an outcome."""
    if found is None:
        return {}
    text, worst = "", found.worst
    if worst is not None:
        many = (
            f"{found.count} episodes of violation, the worst"
            if found.count > 1
            else "one episode of violation,"
        )
        begin, end, at = (moment_of(time, start) for time in (worst.begin, worst.end, worst.at))
        where = f"at {begin}" if begin == end else f"from {begin} to {end}"
        then = "" if begin == end else f" at {at}"
        text = f"{many} {where}: robustness {short(worst.worst)}{then}"
    return {"episodes": found.with_times(plain_time), "episodes_text": text}


def _seconds(time: Any) -> Fraction:
    """Return a time in seconds, exactly; dates count from 1970."""
    if isinstance(time, np.datetime64 | np.timedelta64):
        return Fraction(nanoseconds_of(time) or 0, 10**9)
    return Fraction(str(time))


def plain_time(time: Any) -> float | str | Decimal | None:
    """Return a time for reports: a date where the recording has dates, else seconds, with all their digits."""
    if time is None:
        return None
    if isinstance(time, np.datetime64):
        return str(time)
    return Decimal(stamp_text(time)) if isinstance(time, np.timedelta64) else float(time)
