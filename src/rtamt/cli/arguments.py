"""Specifications and recordings on the command line."""

from __future__ import annotations

import os
from collections import Counter
from typing import TYPE_CHECKING

from rtamt.cli.command import PACK, CommandError, read_specifications
from rtamt.cli.outcome import Requirement, applicable, nothing_checked
from rtamt.cli.parser import complain
from rtamt.cli.reading_options import (
    completed_for,
    is_read_alike,
    names_of,
    reading_of,
    require_time_base,
)
from rtamt.cli.runner import evaluate
from rtamt.errors import StlError
from rtamt.language.units.durations import positive_period
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.tuples import NamedTuple
from rtamt.readers.formats import is_bag
from rtamt.readers.read import opened
from rtamt.readers.sql import shown
from rtamt.specification_loader import packs

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Mapping, Sequence

    from rtamt.cli.reading_options import Reading
    from rtamt.language.document import Requirement as Written
    from rtamt.results import Result
    from rtamt.specification import Specification


def variables_of(requirements: list[Requirement]) -> set[str]:
    """Return the variables that any of the requirements reads."""
    return {name for requirement in requirements for name in requirement.spec.input_names}


def requirements_and_traces(args: Namespace, command: str) -> tuple[list[Requirement], list[str]]:
    """Return the specifications and the traces; arguments after SPEC that end in ``.stl`` are specifications, too.

    A requirement is named by its ID (after ``require``) if that is unique.
    """
    given, traces = _split(args)
    specs = prepared_specs(args, given)
    if not traces:
        raise CommandError(
            f"there is no trace to {command}: name a file, or --sql URL; see 'rtamt {command} --help'"
        )
    require_time_base(args, specs, traces)
    names = Counter(spec.name for spec in specs)
    called = [
        spec.name if spec.name and names[spec.name] == 1 else text
        for spec, text in zip(specs, given, strict=True)
    ]
    ids = Counter(known.name for spec in specs for known in spec.document.requirements if known.explicit)
    taken = ids + Counter(called)
    return [_rows(*each, taken) for each in zip(specs, given, called, strict=True)], traces


def specification_and_traces(args: Namespace, command: str) -> tuple[Specification, list[str]]:
    """Return the one specification that a command takes, and the traces."""
    given, traces = requirements_and_traces(args, command)
    if len(given) > 1:
        raise CommandError(f"'rtamt {command}' takes one specification; leave out '{given[1].given}'")
    return given[0].spec, traces


def prepared_specs(args: Namespace, given: Sequence[str]) -> list[Specification]:
    """Read specifications, with the recorded names and the sampling of the command line."""
    return [
        _resample(_rename(spec, names_of(args.name)), args)
        for spec in read_specifications(args, args.time, given)
    ]


def _rename(spec: Specification, names: Mapping[str, str]) -> Specification:
    """Return a specification whose variables have the recorded names of the command line, which replace its own."""
    for name, column in names.items():
        known = spec.recorded.get(name, column)
        if known != column:
            complain(f"--name {name}={column} replaces '{known}', the recorded name in the specification")
    return replace(spec, columns=names) if names else spec


def _resample(spec: Specification, args: Namespace) -> Specification:
    """Return a specification with the sampling of the command line in place of its own."""
    rule = spec.domain.sampling(spec.sampling)
    if args.resample is not None:
        period = positive_period(args.resample)
        if rule is not None and (period != rule.period or not rule.hold):
            complain(f"--resample {args.resample} replaces '{rule}' in the specification")
        domain = spec.domain
        # Inferred from the new timestamps, the period would be only as precise as doubles since 1970 are.
        if args.period is None and (rule is not None or (domain.sampled and spec.period is None)):
            domain = spec._domain_for(period=period)
        if rule is None and domain is spec.domain:
            return spec
        spec = replace(spec, domain=domain, period=domain.period, sampling=None)
        spec._check_bounds()
        return spec
    if rule is None:
        return spec
    if args.how not in (None, "hold") and rule.hold:
        complain(f"--how {args.how} replaces 'hold' of '{rule}' in the specification")
    if args.hold_for is not None and rule.hold:
        limit = positive_period(args.hold_for, "longest time for which a value is held")
        if rule.limit not in {None, limit}:
            complain(f"--hold-for {args.hold_for} replaces the limit of '{rule}' in the specification")
        return replace(spec, sampling=replace(rule, limit=limit))
    return spec


def _rows(spec: Specification, text: str, label: str, taken: Counter[str]) -> Requirement:
    """Return a specification with a row for each of its requirements; ``taken``: labels and how often each is used."""

    def label_of(known: Written) -> str:
        if known.explicit:
            return known.name if taken[known.name] == 1 else f"{label}: {known.name}"
        return label if len(several) == 1 else f"{label}: {known.name}"

    several = spec.document.requirements
    if len(several) == 1:
        return Requirement(spec, text, label_of(several[0]))
    alone = zip(spec.requirements.values(), several, strict=True)
    return Requirement(
        spec, text, label, tuple(Requirement(one, text, label_of(known)) for one, known in alone)
    )


def each_requirement(given: list[Requirement]) -> list[Requirement]:
    """Return every requirement of every specification: each has its own row."""
    return [row for requirement in given for row in requirement.rows or (requirement,)]


def _split(args: Namespace) -> tuple[list[str], list[str]]:
    given, traces = [args.spec], list(args.traces)
    while traces and is_specification(traces[0]) and is_specification(given[-1]):
        given.append(traces.pop(0))
    if args.sql is not None:
        if traces:
            raise CommandError(f"--sql reads a database; leave out the trace '{traces[0]}', or --sql")
        return given, [args.sql]
    return given, traces


def is_specification(text: str) -> bool:
    """Return whether an argument is a specification file or a pack, by its name."""
    return (
        text.lower().endswith(".stl")
        or text.startswith(PACK)
        or (text in packs() and not os.path.exists(text))
    )


def specification_files(folder: str) -> list[str]:
    """Return the specification files in a folder and in the folders below it."""
    return sorted(
        os.path.join(place, name)
        for place, _, names in os.walk(folder)
        for name in names
        if name.lower().endswith(".stl")
    )


def specification_paths(given: Sequence[str]) -> list[str]:
    """Return specifications, with the files in a folder in its place."""
    found: list[str] = []
    for each in given:
        files = specification_files(each) if os.path.isdir(each) else [each]
        if not files:
            raise CommandError(f"the folder '{each}' has no specification files (.stl)")
        found += files
    return found


class Evaluated(NamedTuple):
    """One recording: its name, the result of each requirement, and the notes that belong to the verdicts."""

    trace: str
    results: dict[str, Result]
    notes: list[str]

    @property
    def listed_notes(self) -> str:
        """The notes, as ``rtamt check`` prints them; each is a line."""
        return "".join(f"\nnote: {self.trace}: {note}" for note in self.notes)


def result_of_one(args: Namespace, command: str) -> tuple[Evaluated, Result]:
    """Evaluate one specification over one recording as a whole; return what is known, and the result."""
    requirement, trace, reading = _one(args, command)
    if not share_clock(requirement, trace, reading):
        raise CommandError(
            f"{shown(trace)}: the requirements read topics with different clocks, so that they have no {command} in "
            f"common; 'rtamt report' plots each of them"
        )
    evaluated = _results([replace(requirement, rows=())], trace, reading)
    ((_, result),) = evaluated.results.items()
    return evaluated, result


def share_clock(requirement: Requirement, trace: str, reading: Reading) -> bool:
    """Return whether the requirements of a specification have times of one clock, as far as they can be checked."""
    if not is_bag(trace) or not requirement.rows:
        return True
    from rtamt.readers.member_columns import members_in  # few recordings are bags

    try:
        with opened(trace, recover=reading.recover) as opening:
            source = completed_for(opening, [row.spec for row in requirement.rows])
            kept, _ = applicable([requirement], source.signals, trace)
            specs = [row.spec for each in kept for row in each.rows or (each,)]
            bound = [spec.over(members_in(source, spec)) if spec.groups else spec for spec in specs]
            return not bound or is_read_alike(source, bound, trace, reading)
    except StlError:  # the evaluation reports what is wrong
        return True


def results_of_one(args: Namespace, command: str) -> Evaluated:
    """Evaluate each requirement of one specification over one recording."""
    requirement, trace, reading = _one(args, command)
    return _results([requirement], trace, reading)


def _one(args: Namespace, command: str) -> tuple[Requirement, str, Reading]:
    requirements, traces = requirements_and_traces(args, command)
    if len(requirements) > 1 or len(traces) > 1:
        more = traces[1] if len(traces) > 1 else requirements[1].given
        raise CommandError(f"'rtamt {command}' takes one specification and one trace; leave out '{more}'")
    (requirement,), (trace,) = requirements, traces
    return requirement, trace, reading_of(args, requirement.spec.input_names, whole=True)


def _results(requirements: list[Requirement], trace: str, reading: Reading) -> Evaluated:
    found: dict[str, Result] = {}
    notes: dict[str, None] = {}
    for row, outcome in zip(
        each_requirement(requirements), evaluate(requirements, trace, reading), strict=True
    ):
        if outcome.unchecked:
            complain(f"{row.label}, {outcome.trace}: {outcome.unchecked}")
        if outcome.result is not None:
            found[row.written.name] = outcome.result
            notes.update(dict.fromkeys(outcome.notes))
        elif outcome.error:
            raise CommandError(outcome.error)
    if not found:
        raise CommandError(nothing_checked(shown(trace)))
    return Evaluated(shown(trace), found, list(notes))
