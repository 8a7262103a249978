"""What the commands about many requirements and recordings are given."""

from __future__ import annotations

from argparse import Namespace
from typing import TYPE_CHECKING

from rtamt.cli.command import CommandError, names_of, read_specification
from rtamt.cli.matrix import Reading, Requirement

if TYPE_CHECKING:
    from collections.abc import Sequence


def requirements_and_traces(args: Namespace, command: str) -> tuple[list[Requirement], list[str]]:
    """Return the requirements and the traces; what ends in ``.stl`` after SPEC is a requirement, too."""
    given, traces = _split(args, command)
    specs = [read_specification(Namespace(**{**vars(args), "spec": text}), args.time) for text in given]
    names = [spec.name for spec in specs]
    requirements = [
        Requirement(spec, text, spec.name if spec.name and names.count(spec.name) == 1 else text)
        for spec, text in zip(specs, given, strict=True)
    ]
    return requirements, traces


def _split(args: Namespace, command: str) -> tuple[list[str], list[str]]:
    given, traces = [args.spec], list(args.traces)
    while traces and traces[0].lower().endswith(".stl") and given[-1].lower().endswith(".stl"):
        given.append(traces.pop(0))
    if args.sql is not None:
        if traces:
            raise CommandError(f"--sql reads a database; leave out the trace '{traces[0]}', or --sql")
        return given, [args.sql]
    if not traces:
        raise CommandError(
            f"there is no trace to check: name a file, or --sql URL; see 'rtamt {command} --help'"
        )
    return given, traces


def reading_of(args: Namespace, requirements: Sequence[Requirement], *, whole: bool) -> Reading:
    """Return how the traces are read; ``whole``: their results are wanted, so never in chunks."""
    names = names_of(args.name)
    read = {name for requirement in requirements for name in requirement.spec.input_names}
    for name in names:
        if name not in read:
            raise CommandError(f"--name {name}={names[name]}: no formula reads '{name}'")
    return Reading(
        args.time_column, names, args.time_unit, args.sheet, args.query, args.resample, args.how, whole=whole
    )
