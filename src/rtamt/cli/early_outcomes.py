"""Outcomes of requirements on a recording that is read no further than the verdicts need."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from rtamt.cli.chunks import Chunks
from rtamt.cli.outcome import Outcome, moment_of, plain_time
from rtamt.cli.reading_options import (
    choice_for,
    is_read_alike,
    is_resampled,
    notes_on,
    oldest_held,
    on_time_base,
)
from rtamt.errors import StlError
from rtamt.readers.assemble import chunks_of, trace_of
from rtamt.readers.read import opened
from rtamt.readers.sql import shown
from rtamt.signals.arrays import TIME
from rtamt.signals.resampling import Sampler
from rtamt.verdicts.early.check import holds_at_end, in_parts

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from fractions import Fraction

    from rtamt.cli.outcome import Requirement
    from rtamt.cli.reading_options import Reading
    from rtamt.signals.trace import Trace
    from rtamt.specification import Specification
    from rtamt.verdicts.early.check import EarlyCheck

_UNREAD = "later samples are not checked"


def early_outcomes(requirement: Requirement, trace: str, reading: Reading) -> list[Outcome] | None:
    """Check no further than the verdicts need; None where they need the whole recording."""
    begin = time.perf_counter()
    rows = requirement.rows or (requirement,)
    specs = [row.spec for row in rows]
    make = requirement.spec.domain.part("early_check")
    if make is None or not all(map(holds_at_end, specs)):
        return None
    resampled = is_resampled(requirement.spec, trace, reading)
    period = reading.resample or requirement.spec.period
    as_it_comes = not resampled or not (
        period is None or not requirement.spec.domain.sampled or TIME in requirement.spec.input_names
    )
    if resampled and requirement.rows:
        return _each(rows, trace, reading)
    spec = requirement.spec
    try:
        check: EarlyCheck = make(specs)
        with opened(trace, reading.sheet, reading.query, reading.recover) as source:
            if not is_read_alike(source, specs, trace, reading):
                return _each(rows, trace, reading)
            if as_it_comes and source.in_chunks:
                chunks = Chunks(spec, chunks_of(source, choice_for([spec], trace, reading)))
                taken = _sample(chunks, specs[0], period, reading) if resampled else chunks
            else:
                whole = spec.binding.applied(trace_of(source, choice_for([spec], trace, reading)))
                parts = in_parts(on_time_base(whole, spec, trace, reading))
                taken = chunks = Chunks(spec, parts, bound=True)
            if not any(map(check.take, taken)):
                return None
    except StlError:  # the check of the whole recording reports what is wrong
        return None
    assert check.decided is not None
    assert chunks.last is not None
    notes = notes_on(chunks.last, spec, reading)
    seconds = (time.perf_counter() - begin) / len(rows)
    return [
        Outcome(
            row.label,
            shown(trace),
            "satisfied" if part.satisfied else "violated",
            part.bounds.lower if part.bounds.lower == part.bounds.upper else float("nan"),
            plain_time(part.first_violation),
            moment_of(part.first_violation, part.start),
            part.samples,
            part.period,
            notes=(
                *notes,
                f"{_stop(row, rows)} at {moment_of(part.decided_at, part.start)}, {_UNREAD}",
            ),
            decided_at=plain_time(part.decided_at),
            bounds=part.bounds,
            seconds=seconds,
        )
        for row, part in zip(rows, check.decided, strict=True)
    ]


def _each(rows: Sequence[Requirement], trace: str, reading: Reading) -> list[Outcome] | None:
    """Check each requirement alone; None where one needs the whole recording."""
    found = [early_outcomes(row, trace, reading) for row in rows]
    return None if None in found else [o for each in found if each is not None for o in each]


def _sample(
    chunks: Iterable[Trace], spec: Specification, period: str | Fraction | None, reading: Reading
) -> Iterator[Mapping[str, Any]]:
    """Yield chunks on their own time base: the values of all signals every ``period``."""
    assert period is not None
    sampler = Sampler(spec.input_names, period, reading.how, oldest_held(spec, reading), spec.types)
    for chunk in chunks:
        channels = {name: chunk.channel(name) for name in chunk}
        known = sampler.take(
            {name: (c.times, c.values) for name, c in channels.items() if c.times is not None}
        )
        if known is not None:
            yield {TIME: known[0], **known[1]}


def _stop(row: Requirement, rows: Sequence[Requirement]) -> str:
    return "decided" if len(rows) == 1 else f"{row.label} is decided"
