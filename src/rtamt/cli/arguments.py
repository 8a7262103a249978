"""What the commands about many requirements and recordings are given."""

from __future__ import annotations

from argparse import Namespace
from dataclasses import replace
from typing import TYPE_CHECKING

from rtamt.cli.command import CommandError, read_specification
from rtamt.cli.reading_options import reading_of
from rtamt.cli.runner import Requirement, evaluate
from rtamt.errors import UsageError
from rtamt.ros.binding import bind

if TYPE_CHECKING:
    from rtamt.results import Result
    from rtamt.specification import Specification


def variables_of(requirements: list[Requirement]) -> set[str]:
    """Return what any of the requirements reads."""
    return {name for requirement in requirements for name in requirement.spec.input_names}


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


def judged(requirements: list[Requirement]) -> list[Requirement]:
    """Return a requirement for every assertion that a node would publish; other specifications as they are.

    The last assertion is judged in any case.
    """
    return [one for requirement in requirements for one in _published(requirement)]


def _published(requirement: Requirement) -> list[Requirement]:
    spec = requirement.spec
    try:
        specs = [output.specification for output in bind(spec).outputs]
    except UsageError:  # it was not written for nodes
        return [requirement]
    if len(specs[-1].document.assertions) < len(spec.document.assertions):
        specs.append(spec)
    if len(specs) == 1:
        return [requirement]
    return [
        replace(requirement, spec=one, label=f"{requirement.label}: {assertion_of(one)}") for one in specs
    ]


def assertion_of(spec: Specification) -> str:
    """Return the name of the assertion that is judged; "robustness" for one without."""
    return spec.document.assertions[-1].name or "robustness"


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
            f"there is no trace to {command}: name a file, or --sql URL; see 'rtamt {command} --help'"
        )
    return given, traces


def result_of_one(args: Namespace, command: str) -> tuple[str, Result]:
    """Evaluate one requirement over one recording; return what the recording is called, and the result."""
    requirements, traces = requirements_and_traces(args, command)
    if len(requirements) > 1 or len(traces) > 1:
        more = traces[1] if len(traces) > 1 else requirements[1].given
        raise CommandError(f"'rtamt {command}' takes one specification and one trace; leave out '{more}'")
    (requirement,), (trace,) = requirements, traces
    reading = reading_of(args, requirement.spec.input_names, whole=True)
    (outcome,) = evaluate([requirement], trace, reading)
    if outcome.result is None:
        raise CommandError(outcome.error)
    return outcome.trace, outcome.result
