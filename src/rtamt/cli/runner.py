"""Every requirement over every recording: on all cores, each recording read once."""

from __future__ import annotations

import os
import time
from itertools import islice
from typing import TYPE_CHECKING

from rtamt.batch import evaluate_requirements
from rtamt.cli.chunks import Chunks
from rtamt.cli.outcome import (
    Outcome,
    applicable,
    episodes_of,
    failed,
    moment_of,
    plain_time,
    skipped,
    together,
)
from rtamt.cli.reading_options import (
    choice_for,
    completed_for,
    has_own_time_bases,
    how_to_mend,
    is_resampled,
    notes_on,
    on_time_base,
    read_for,
    with_stamps,
)
from rtamt.errors import BoundError, StlError
from rtamt.lazy.dataclasses import replace
from rtamt.readers.assemble import chunks_of, trace_of
from rtamt.readers.read import opened
from rtamt.readers.sql import is_url, shown
from rtamt.signals.episodes import Episodes
from rtamt.violations import first_violation

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rtamt.cli.outcome import Requirement
    from rtamt.cli.reading_options import Reading
    from rtamt.readers.source import Source
    from rtamt.results import Result
    from rtamt.signals.trace import Trace
    from rtamt.verdicts.chunks import StreamResult

#: Bytes of a file from which on it is read in chunks, where format and formula allow it.
LARGE = 256 * 2**20
#: Bytes from which on it is read in chunks where the outcome is that of the whole recording.
MODERATE = 16 * 2**20
#: Bytes of all files together from which on starting a process for each core pays.
_WORTH_PROCESSES = 16 * 2**20


def outcomes(
    requirements: Sequence[Requirement],
    traces: Sequence[str],
    reading: Reading,
    jobs: int | None = None,
) -> Iterator[Outcome]:
    """Yield the outcome of every requirement on every recording, recording by recording, in order.

    ``jobs``: processes; by default one for each core, where there is enough to do.
    """
    count = min(jobs or _processes(traces), len(traces))
    if count <= 1 or reading.whole:
        for trace in traces:
            for outcome in evaluate(requirements, trace, reading):
                yield _explain(outcome) if reading.explained else outcome
        return
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    # Reading a text file is Python's work, which threads could not share. Processes start afresh, so
    # that nothing of this one (locks, threads of libraries) is copied into them.
    with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as pool:
        work = [pool.submit(_picklable, requirements, trace, reading) for trace in traces]
        try:
            for future in work:
                yield from future.result()
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _picklable(requirements: Sequence[Requirement], trace: str, reading: Reading) -> list[Outcome]:
    """Return outcomes without what cannot leave a process."""
    found = evaluate(requirements, trace, reading)
    return [replace(_explain(outcome) if reading.explained else outcome, result=None) for outcome in found]


def _explain(outcome: Outcome) -> Outcome:
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
    each = [row for requirement in requirements for row in requirement.rows or (requirement,)]
    if any(row.spec.groups for row in each):  # its own
        plain = [row for row in each if not row.spec.groups]
        several = [evaluate(plain, trace, reading)] if plain else []
        several += [_over_members(row, trace, reading) for row in each if row.spec.groups]
        known = {outcome.requirement: outcome for found in several for outcome in found}
        return [known[row.label] for row in each]
    if not any(requirement.spec.optional for requirement in requirements):
        return _check_requirements(requirements, trace, reading)
    try:
        with opened(trace, reading.sheet, reading.query, reading.recover) as source:
            specs = [requirement.spec for requirement in requirements]
            signals = completed_for(source, specs).signals
            kept, unchecked = applicable(requirements, signals, trace)
            # A source that is read in chunks is opened quickly; any other is not opened a second time.
            whole = None if source.in_chunks or not kept else _read_together(source, kept, trace, reading)
        rest = None
        if whole is not None:
            rest = [o for requirement in kept for o in _check(requirement, trace, whole, reading)]
    except StlError:  # the check reports what is wrong
        kept, unchecked, rest = list(requirements), [], None
    found = _check_requirements(kept, trace, reading) if rest is None else rest
    of = together(found, unchecked)
    return [of[row.label] for requirement in requirements for row in requirement.rows or (requirement,)]


def _read_together(
    source: Source, requirements: Sequence[Requirement], trace: str, reading: Reading
) -> Trace | None:
    try:
        return trace_of(
            source, choice_for([requirement.spec for requirement in requirements], trace, reading)
        )
    except StlError:  # each reads what it needs, and reports what is wrong with that
        return None


def _over_members(requirement: Requirement, trace: str, reading: Reading) -> list[Outcome]:
    """Check one requirement over the members of groups that a recording has."""
    from rtamt.readers.member_columns import choice_of_members
    from rtamt.signals import members

    begin = time.perf_counter()
    spec = requirement.spec
    try:
        with opened(trace, reading.sheet, reading.query, reading.recover) as opening:
            source = completed_for(opening, [spec])
            kept, unchecked = applicable([requirement], source.signals, trace)
            if unchecked:
                found = [outcome for each in kept for outcome in evaluate([each], trace, reading)]
                return list(together(found, unchecked).values())
            choice = choice_of_members(spec, source, lambda over: choice_for([over], trace, reading))
            whole = spec.binding.applied(trace_of(source, choice))
        if not has_own_time_bases(spec, trace, reading):
            whole.require_all_samples(spec.input_names)
        bound = members.bound(whole, spec.groups, spec.input_names, own_time_bases=True, source=shown(trace))
        over = spec.over(bound.members)
    except StlError as error:
        return [failed(requirement, trace, str(error), begin)]
    return _check(replace(requirement, spec=over), trace, bound.data, reading)


def _early(requirement: Requirement, trace: str, reading: Reading) -> list[Outcome] | None:
    if not reading.early:
        return None
    from rtamt.cli.early_outcomes import early_outcomes

    return early_outcomes(requirement, trace, reading)


def _check_requirements(requirements: Sequence[Requirement], trace: str, reading: Reading) -> list[Outcome]:
    """Check requirements over one recording that has the signals for them."""
    early = {requirement.label: _early(requirement, trace, reading) for requirement in requirements}
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
    sampled_anew = any(is_resampled(requirement.spec, trace, reading) for requirement in requirements)
    if _has(LARGE, trace, reading) and not sampled_anew:
        return [o for requirement in requirements for o in _in_chunks(requirement, trace, reading)]
    if _has(MODERATE, trace, reading) and not sampled_anew and len(requirements) == 1:
        found = _as_whole(requirements[0], trace, reading)
        if found is not None:
            return found
    whole: Trace | None
    every = [row.spec for requirement in requirements for row in requirement.rows or (requirement,)]
    try:
        whole = read_for(every, trace, reading)
    except StlError:  # each reads what it needs, and reports what is wrong with that
        whole = None
    return [o for requirement in requirements for o in _check(requirement, trace, whole, reading)]


def _has(size: int, trace: str, reading: Reading) -> bool:
    """Return whether a recording may be read in chunks, and is large enough for that."""
    if reading.whole:
        return False
    return is_url(trace) or (os.path.isfile(trace) and os.path.getsize(trace) >= size)


def _in_chunks(requirement: Requirement, trace: str, reading: Reading) -> list[Outcome]:
    """Check in chunks if format and formula allow it, else read the recording whole."""
    begin = time.perf_counter()
    run = _ChunkedRun(requirement, trace, reading)
    try:
        found = run.result()
    except BoundError:  # the formula needs the whole recording at once
        found = None
    except StlError as error:
        if requirement.rows:
            return [o for row in requirement.rows for o in _in_chunks(row, trace, reading)]
        # Errors of readers name the place; errors of evaluations do not.
        place = "" if shown(trace) in str(error) else f"{shown(trace)}: "
        return [failed(requirement, trace, f"{place}{error}{run.remedy(error)}", begin)]
    return _check(requirement, trace, None, reading) if found is None else run.outcomes(found, begin)


def _as_whole(requirement: Requirement, trace: str, reading: Reading) -> list[Outcome] | None:
    """Check in chunks; None where the outcome may differ from that of the whole recording, which is then read."""
    from rtamt.verdicts.streaming import has_episodes

    if reading.explained or not has_episodes(requirement.spec):
        return None
    begin = time.perf_counter()
    run = _ChunkedRun(requirement, trace, reading)
    try:
        found = run.result()
    except StlError:  # found again in the whole recording, and reported as there
        return None
    return None if found is None or not found.steady else run.outcomes(found, begin)


class _ChunkedRun:
    """A check of a requirement in chunks of a recording."""

    def __init__(self, requirement: Requirement, trace: str, reading: Reading) -> None:
        self._requirement = requirement
        self._trace = trace
        self._reading = reading
        self._chunks: Chunks | None = None

    def result(self) -> StreamResult | None:
        """Return the result of the check; None if the format has no chunks."""
        from rtamt.verdicts.streaming import check_stream, check_streamable

        spec, reading = self._requirement.spec, self._reading
        check_streamable(spec)
        if not spec.input_names:  # its instants are those of all columns
            return None
        with opened(self._trace, reading.sheet, reading.query, reading.recover) as source:
            if len(source.tables) != 1 or source.tables[0].chunks is None:
                return None
            parts = chunks_of(source, choice_for([spec], self._trace, reading))
            self._chunks = Chunks(spec, (with_stamps(part, spec) for part in parts))
            return check_stream(spec, self._chunks)

    def remedy(self, error: StlError) -> str:
        """Return a suffix for an error: see :func:`how_to_mend`."""
        chunks = self._chunks
        return "" if chunks is None else how_to_mend(error, chunks.last, chunks.before(error))

    def outcomes(self, found: StreamResult, begin: float) -> list[Outcome]:
        """Return the outcome of each row."""
        assert self._chunks is not None
        chunks, rows = self._chunks, self._requirement.rows or (self._requirement,)
        assert chunks.last is not None
        notes = notes_on(chunks.last, self._requirement.spec, self._reading)
        seconds = (time.perf_counter() - begin) / len(rows)
        return [
            Outcome(
                row.label,
                shown(self._trace),
                "satisfied" if part.satisfied else "violated",
                part.robustness,
                plain_time(part.first_violation),
                moment_of(part.first_violation, part.start),
                part.samples,
                part.period,
                notes=notes,
                **episodes_of(part.episodes, part.start),
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
    spec, recorded = requirement.spec, data
    whole = recorded
    try:
        place = ""
        rows = requirement.rows or (requirement,)
        whole = recorded = recorded or read_for([row.spec for row in rows], trace, reading)
        place = f"{shown(trace)}: "
        whole = on_time_base(spec.binding.applied(with_stamps(whole, spec)), spec, trace, reading)
        alone = len(spec.requirements) == 1
        parts = (
            evaluate_requirements(spec, whole).values()
            if requirement.rows or alone
            else [spec.evaluate(whole)]
        )
    except StlError as error:
        if requirement.rows:
            return [o for row in requirement.rows for o in _check(row, trace, data, reading)]
        lacking = {} if recorded is None else spec.unchecked(recorded)
        if lacking and len(spec.requirements) == 1:
            return [skipped(requirement, trace, *lacking.values())]
        return [failed(requirement, trace, f"{place}{error}{how_to_mend(error, whole)}", begin)]
    found = []
    for row, part in zip(requirement.rows or (requirement,), parts, strict=True):
        found.append(_outcome(row, trace, part, notes_on(whole, spec, reading), begin))
        begin = time.perf_counter()
    return found


def _outcome(
    requirement: Requirement, trace: str, result: Result, notes: tuple[str, ...], begin: float
) -> Outcome:
    """Return the outcome of one requirement."""
    try:
        satisfied, violated = result.satisfied, first_violation(result)
        # A plot shows several requirements together, and episodes are those of one.
        alone = len(result.specification.requirements) == 1
        episodes = Episodes.of(result.episodes()) if alone else None
    except StlError as error:
        return failed(requirement, trace, f"{shown(trace)}: {error}", begin)
    recording = result.trace
    return Outcome(
        requirement.label,
        shown(trace),
        "satisfied" if satisfied else "violated",
        result.robustness,
        plain_time(violated),
        moment_of(violated, recording.origin),
        recording.samples,
        recording.domain.period,
        notes=notes,
        **episodes_of(episodes, recording.origin),
        seconds=time.perf_counter() - begin,
        result=result,
    )
