"""``rtamt check SPEC BAG -o out.mcap``: the bag again, with topics of robustness and verdicts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.cli.command import CommandError
from rtamt.cli.runner import evaluate
from rtamt.errors import UsageError
from rtamt.lazy.dataclasses import replace
from rtamt.readers.formats import is_bag
from rtamt.ros.bags import Finding, write_mcap
from rtamt.ros.binding import bind, topic_of
from rtamt.violations import signals_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rtamt.cli.outcome import Requirement
    from rtamt.cli.reading_options import Reading
    from rtamt.results import Result

#: The topic of a requirement that names none.
TOPIC = "rtamt/robustness"


def write_bag(
    requirement: Requirement, trace: str, reading: Reading, results: Mapping[str, Result], path: str
) -> None:
    """Write a recording with the results of a check; ``results``: one per requirement, by its label."""
    if not is_bag(trace):
        raise CommandError(
            f"'{trace}' is no bag, so that there are no topics to write to '{path}'; write .csv"
        )
    write_mcap(trace, path, _findings(requirement, trace, reading, results), reading.recover)


def _findings(
    requirement: Requirement, trace: str, reading: Reading, results: Mapping[str, Result]
) -> Iterator[Finding]:
    """Yield the result of every assertion that a node would publish, else of every requirement."""
    try:
        outputs = bind(requirement.spec).outputs
    except UsageError:  # it was not written for nodes: a formula over columns
        for row in requirement.rows or (requirement,):
            if row.label in results:
                topic = topic_of(row.written.name) if requirement.rows else TOPIC
                yield _finding(row.label, topic, results[row.label])
        return
    for output in outputs:
        alone = replace(requirement, spec=output.specification, rows=())
        (outcome,) = evaluate([alone], trace, reading)
        if outcome.unchecked:
            continue
        if outcome.result is None:
            raise CommandError(outcome.error)
        yield _finding(output.name, output.topic, outcome.result)


def _finding(name: str, topic: str, result: Result) -> Finding:
    _, truth = signals_of(result)
    return Finding(name, topic, result.signal, truth)
