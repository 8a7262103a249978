"""``rtamt check SPEC BAG -o out.mcap``: the bag again, with topics of robustness and verdicts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.cli.command import CommandError
from rtamt.cli.parser import complain
from rtamt.cli.reading_options import choice_for, completed_for
from rtamt.cli.runner import evaluate
from rtamt.errors import UsageError
from rtamt.language.distinct import distinct
from rtamt.lazy.dataclasses import replace
from rtamt.readers.bag_topic import STAMP
from rtamt.readers.formats import is_bag
from rtamt.readers.member_columns import choice_of_members
from rtamt.readers.read import opened
from rtamt.readers.selection import select
from rtamt.ros.bags import Finding, write_mcap
from rtamt.ros.binding import bind, topic_of
from rtamt.violations import signals_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from rtamt.cli.outcome import Requirement
    from rtamt.cli.reading_options import Reading
    from rtamt.results import Result
    from rtamt.specification import Specification

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
        rows = [row for row in requirement.rows or (requirement,) if row.label in results]
        topics = _topics([row.written.name for row in rows]) if requirement.rows else {}
        for row in rows:
            topic = topics.get(row.written.name, TOPIC)
            read = topics_read(row.spec, trace, reading)
            yield _finding(row.label, topic, results[row.label], read)
        return
    for output in outputs:
        alone = replace(requirement, spec=output.specification, rows=())
        (outcome,) = evaluate([alone], trace, reading)
        if outcome.unchecked:
            continue
        if outcome.result is None:
            raise CommandError(outcome.error)
        read = topics_read(output.specification, trace, reading)
        yield _finding(output.name, output.topic, outcome.result, read)


def _topics(names: Sequence[str]) -> dict[str, str]:
    """Return the topic of each requirement; note those that do not have that of their name."""
    topics = distinct(names, topic_of)
    owners = {topic: name for name, topic in topics.items()}
    for name, topic in topics.items():
        usual = topic_of(name)
        if topic != usual:
            complain(
                f"note: '{name}' is written to /{topic}, because /{usual} is the topic of '{owners[usual]}'"
            )
    return topics


def _finding(name: str, topic: str, result: Result, read: tuple[str, ...]) -> Finding:
    _, truth = signals_of(result)
    return Finding(name, topic, result.signal, truth, read)


def topics_read(spec: Specification, trace: str, reading: Reading) -> tuple[str, ...]:
    """Return the topics whose timestamps are the times of a requirement over a bag; none with ``--time-column``."""
    if reading.time is not None:
        return ()
    with opened(trace, recover=reading.recover) as opening:
        source = completed_for(opening, [spec])
        if spec.groups:
            choice = choice_of_members(spec, source, lambda over: choice_for([over], trace, reading))
        else:
            choice = choice_for([spec], trace, reading)
        clocks = [
            selection.table.time_field for selection in select(source.completed(choice.recorded), choice)
        ]
    return tuple(clock.column.removesuffix(STAMP) for clock in clocks if clock is not None)
