"""Every requirement over every recording: on all cores, each recording read once."""

from __future__ import annotations

import os
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from itertools import islice
from math import inf
from multiprocessing import get_context
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.batch import evaluate_requirements
from rtamt.cli.command import NO_STAMPS, short, stamp_text
from rtamt.cli.reading_options import choice_for, how_to_mend, is_resampled, on_clock, read_for
from rtamt.errors import BoundError, StlError, TraceError
from rtamt.readers.assemble import chunks_of
from rtamt.readers.read import opened
from rtamt.readers.sql import is_url, shown
from rtamt.results import first_violation
from rtamt.signals.datetimes import nanoseconds_of
from rtamt.signals.epoch import is_epoch, moment_text
from rtamt.verdicts.early_check import EarlyCheck, holds_at_end
from rtamt.verdicts.streaming import check_stream, check_streamable

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rtamt.cli.reading_options import Reading
    from rtamt.language.document import Requirement as Written
    from rtamt.results import Result
    from rtamt.signals.outcomes import Interval
    from rtamt.signals.trace import Trace
    from rtamt.specification import Specification
    from rtamt.verdicts.chunks import StreamResult

#: Bytes of a file from which on it is read in chunks, where format and formula allow it.
LARGE = 256 * 2**20
#: Bytes of all files together from which on starting a process for each core pays.
_WORTH_PROCESSES = 16 * 2**20
_UNREAD = "later samples are not checked"


@dataclass(frozen=True, slots=True)
class Requirement:
    """A specification, the file or text that it was given as, and what reports call it.

    ``rows``: where there are several requirements in it, each alone.
    """

    spec: Specification
    given: str
    label: str
    rows: tuple[Requirement, ...] = ()

    @property
    def written(self) -> Written:
        """A single requirement as it stands in the specification: its name, its description, its severity."""
        return self.spec.document.requirements[0]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of one requirement over one recording, or the sentence that says why nothing did.

    ``first_violation``: seconds (a decimal where a double cannot hold them), or a date; None where there is
    none. ``moment``: the same as text: seconds, or a date with the seconds since the start of the recording.
    ``period``: None in dense time.
    ``notes``: what the verdict has to do without (:attr:`Trace.losses`).
    ``decided_at``: when its verdict was decided, where nothing later was read; the robustness is then known to lie
    within ``bounds``, and NaN where these differ.
    ``explanation``: why it is violated, where that was asked for and the whole recording was read.
    ``seconds``: how long it took. ``result`` stays in the process that made it.
    """

    requirement: str
    trace: str
    verdict: str  # satisfied, violated or error
    robustness: float = float("nan")
    first_violation: float | str | Decimal | None = None
    moment: str = ""
    samples: int = 0
    period: Fraction | None = None
    error: str = ""
    notes: tuple[str, ...] = ()
    decided_at: float | str | Decimal | None = None
    bounds: Interval | None = None
    explanation: str = ""
    seconds: float = 0.0
    result: Result | None = None

    @property
    def robustness_text(self) -> str:
        """The robustness, or what is known of it."""
        low, high = (self.robustness,) * 2 if self.bounds is None else (self.bounds.lower, self.bounds.upper)
        if low == high or self.bounds is None:
            return short(self.robustness)
        if low == -inf:
            return "unknown" if high == inf else f"<= {short(high)}"
        return f">= {short(low)}" if high == inf else f"{short(low)} to {short(high)}"


def outcomes(
    requirements: Sequence[Requirement],
    traces: Sequence[str],
    reading: Reading,
    jobs: int | None = None,
    *,
    explain: bool = False,
) -> Iterator[Outcome]:
    """Yield what comes of every requirement over every recording, recording by recording, in order.

    ``jobs``: processes; by default one for each core, where there is enough to do. ``explain``: violations.
    """
    count = min(jobs or _processes(traces), len(traces))
    if count <= 1 or reading.whole:
        for trace in traces:
            for outcome in evaluate(requirements, trace, reading):
                yield _explained(outcome) if explain else outcome
        return
    # Reading a text file is Python's work, which threads could not share. Processes start afresh, so
    # that nothing of this one (locks, threads of libraries) is copied into them.
    with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as pool:
        work = [pool.submit(_apart, requirements, trace, reading, explain) for trace in traces]
        try:
            for future in work:
                yield from future.result()
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _apart(requirements: Sequence[Requirement], trace: str, reading: Reading, explain: bool) -> list[Outcome]:
    """Return outcomes without what cannot leave a process."""
    found = evaluate(requirements, trace, reading)
    return [replace(_explained(outcome) if explain else outcome, result=None) for outcome in found]


def _explained(outcome: Outcome) -> Outcome:
    """Return an outcome with the reason of a violation, if it can be explained."""
    if outcome.result is None or outcome.verdict != "violated":
        return outcome
    try:
        return replace(outcome, explanation=str(outcome.result.explain()))
    except StlError as error:
        return replace(outcome, notes=(*outcome.notes, str(error)))


def _processes(traces: Sequence[str]) -> int:
    sizes = (os.path.getsize(trace) for trace in traces if os.path.isfile(trace))
    return (os.cpu_count() or 1) if sum(sizes) >= _WORTH_PROCESSES else 1


# ---- one recording -------------------------------------------------------------------------------


def evaluate(requirements: Sequence[Requirement], trace: str, reading: Reading) -> list[Outcome]:
    """Check requirements over one recording, which is read once if that goes well; an outcome for each row."""
    early = {
        requirement.label: _early(requirement, trace, reading) if reading.early else None
        for requirement in requirements
    }
    rest = [requirement for requirement in requirements if early[requirement.label] is None]
    late = iter(_all_of(rest, trace, reading))
    return [
        outcome
        for requirement in requirements
        for outcome in early[requirement.label] or islice(late, len(requirement.rows) or 1)
    ]


def _all_of(requirements: Sequence[Requirement], trace: str, reading: Reading) -> list[Outcome]:
    """Check requirements over one whole recording."""
    if not requirements:
        return []
    if _is_large(trace, reading):
        return [o for requirement in requirements for o in _in_chunks(requirement, trace, reading)]
    whole: Trace | None
    try:
        whole = read_for([requirement.spec for requirement in requirements], trace, reading)
    except StlError:  # each reads what it needs, and says what is wrong with that
        whole = None
    return [o for requirement in requirements for o in _check(requirement, trace, whole, reading)]


def _early(requirement: Requirement, trace: str, reading: Reading) -> list[Outcome] | None:
    """Check no further than the verdicts need; None where they need the whole recording."""
    begin = time.perf_counter()
    rows = requirement.rows or (requirement,)
    specs = [row.spec for row in rows]
    if requirement.spec.domain.continuous or is_resampled(requirement.spec, trace, reading):
        return None
    if not all(map(holds_at_end, specs)):
        return None
    check = EarlyCheck(specs)
    try:
        with opened(trace, reading.sheet, reading.query, reading.recover) as source:
            if len(source.tables) > 1 or source.tables[0].chunks is None:
                return None
            chunks = _Chunks(chunks_of(source, choice_for([requirement.spec], trace, reading)))
            if not any(map(check.take, chunks)):
                return None
    except StlError:  # the check of the whole recording reports what is wrong
        return None
    assert check.decided is not None
    seconds = (time.perf_counter() - begin) / len(rows)
    return [
        Outcome(
            row.label,
            shown(trace),
            "satisfied" if part.satisfied else "violated",
            part.bounds.lower if part.bounds.lower == part.bounds.upper else float("nan"),
            _told(part.first_violation),
            _moment(part.first_violation, chunks.start),
            part.samples,
            part.period,
            notes=(
                *chunks.losses,
                f"{_stop(row, rows)} at {_moment(part.decided_at, chunks.start)}, {_UNREAD}",
            ),
            decided_at=_told(part.decided_at),
            bounds=part.bounds,
            seconds=seconds,
        )
        for row, part in zip(rows, check.decided, strict=True)
    ]


def _stop(row: Requirement, rows: Sequence[Requirement]) -> str:
    return "decided" if len(rows) == 1 else f"{row.label} is decided"


def _is_large(trace: str, reading: Reading) -> bool:
    if reading.whole or reading.resample is not None:
        return False
    return is_url(trace) or (os.path.isfile(trace) and os.path.getsize(trace) >= LARGE)


def _in_chunks(requirement: Requirement, trace: str, reading: Reading) -> list[Outcome]:
    """Check in chunks if format and formula allow it, else read the recording whole."""
    begin = time.perf_counter()
    chunks: _Chunks | None = None
    found: StreamResult | None = None
    try:
        check_streamable(requirement.spec)
        with opened(trace, reading.sheet, reading.query, reading.recover) as source:
            if all(table.chunks is not None for table in source.tables) and len(source.tables) == 1:
                chunks = _Chunks(chunks_of(source, choice_for([requirement.spec], trace, reading)))
                found = check_stream(requirement.spec, chunks)
    except BoundError:
        pass  # the formula needs the whole recording at once
    except StlError as error:
        if requirement.rows:
            return [o for row in requirement.rows for o in _in_chunks(row, trace, reading)]
        # Whatever reads says where; whatever computes does not know.
        place = "" if shown(trace) in str(error) else f"{shown(trace)}: "
        mend = "" if chunks is None else how_to_mend(error, chunks.last, chunks.before(error))
        return [_failed(requirement, trace, f"{place}{error}{mend}", begin)]
    if chunks is None or found is None:
        return _check(requirement, trace, None, reading)
    rows = requirement.rows or (requirement,)
    seconds = (time.perf_counter() - begin) / len(rows)
    return [
        Outcome(
            row.label,
            shown(trace),
            "satisfied" if part.satisfied else "violated",
            part.robustness,
            _told(part.first_violation),
            _moment(part.first_violation, chunks.start),
            part.samples,
            part.period,
            notes=chunks.losses,
            seconds=seconds,
        )
        for row, part in zip(rows, found.requirements.values(), strict=True)
    ]


def _check(requirement: Requirement, trace: str, data: Trace | None, reading: Reading) -> list[Outcome]:
    """Check over a recording that is in memory, or read what the requirement needs of it.

    Several requirements share one evaluation; where there is none, each is checked alone, and so it is where each
    has samples of its own.
    """
    if requirement.rows and is_resampled(requirement.spec, trace, reading):
        return [o for row in requirement.rows for o in _check(row, trace, data, reading)]
    begin = time.perf_counter()
    spec, whole = requirement.spec, data
    try:
        place = ""
        whole = whole or read_for([spec], trace, reading)
        place = f"{shown(trace)}: "
        if spec.domain.continuous and any(whole.channel(name).times is None for name in whole):
            raise TraceError(NO_STAMPS)
        whole = on_clock(whole, spec, trace, reading)
        alone = len(spec.requirements) == 1
        parts = (
            evaluate_requirements(spec, whole).values()
            if requirement.rows or alone
            else [spec.evaluate(whole)]
        )
    except StlError as error:
        if requirement.rows:
            return [o for row in requirement.rows for o in _check(row, trace, data, reading)]
        return [_failed(requirement, trace, f"{place}{error}{how_to_mend(error, whole)}", begin)]
    found = []
    for row, part in zip(requirement.rows or (requirement,), parts, strict=True):
        found.append(_outcome(row, trace, part, whole, begin))
        begin = time.perf_counter()
    return found


def _outcome(requirement: Requirement, trace: str, result: Result, data: Trace, begin: float) -> Outcome:
    """Return what an evaluation of ``data`` says of one requirement."""
    try:
        satisfied, violated = result.satisfied, first_violation(result)
    except StlError as error:
        return _failed(requirement, trace, f"{shown(trace)}: {error}", begin)
    recording = result.trace
    return Outcome(
        requirement.label,
        shown(trace),
        "satisfied" if satisfied else "violated",
        result.robustness,
        _told(violated),
        _moment(violated, recording.origin),
        recording.samples,
        recording.domain.period,
        notes=data.losses,
        seconds=time.perf_counter() - begin,
        result=result,
    )


def _failed(requirement: Requirement, trace: str, error: str, begin: float) -> Outcome:
    return Outcome(requirement.label, shown(trace), "error", error=error, seconds=time.perf_counter() - begin)


def _moment(time: Any, start: Any) -> str:
    """Return a time as text: of a recording that counts from 1970 the date and the seconds since its start."""
    if time is None:
        return ""
    dated = isinstance(time, np.datetime64)
    begin = _seconds(start)
    if (dated and isinstance(start, np.datetime64)) or (not dated and is_epoch(begin)):
        return moment_text(_seconds(time), begin)
    return f"{str(_told(time)).removesuffix('.0')} s"


def _seconds(time: Any) -> Fraction:
    """Return a time in seconds, exactly; dates count from 1970."""
    if isinstance(time, np.datetime64 | np.timedelta64):
        return Fraction(nanoseconds_of(time) or 0, 10**9)
    return Fraction(str(time))


def _told(moment: Any) -> float | str | Decimal | None:
    """Return a time for reports: a date where the recording has dates, else seconds, with all their digits."""
    if moment is None:
        return None
    if isinstance(moment, np.datetime64):
        return str(moment)
    return Decimal(stamp_text(moment)) if isinstance(moment, np.timedelta64) else float(moment)


class _Chunks:
    """Chunks, and what has to be known of them: whether their stamps are dates, how many samples there were."""

    def __init__(self, chunks: Iterator[Trace]) -> None:
        self._chunks = chunks
        self._counts: Counter[str] = Counter()
        self.last: Trace | None = None
        #: The first time of all.
        self.start: Any = 0.0
        #: What the last chunk says, which is about all before it, too.
        self.losses: tuple[str, ...] = ()

    def __iter__(self) -> Iterator[Trace]:
        for chunk in self._chunks:
            if self.last is None:
                self.start = chunk.start if chunk.start is not None else 0.0
            else:
                self._counts.update({name: len(self.last[name].values) for name in self.last})
            self.last = chunk
            self.losses = chunk.losses
            yield chunk

    def before(self, error: StlError) -> int:
        """Return how many samples the variable that an error is about had before the last chunk."""
        return self._counts[str(getattr(error, "variable", None))]
