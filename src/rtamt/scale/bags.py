"""Requirements on a bag: each reads its own topics, by their own clock, and has its own samples."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.errors import StlError
from rtamt.readers.assemble import trace_of
from rtamt.readers.selection import has_one_clock
from rtamt.scale.members import over_members
from rtamt.signals.sampling import sampled_messages

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable

    from rtamt.fleet.groups import Way
    from rtamt.fleet.suite import Suite
    from rtamt.fleet.verdict_table import VerdictTable
    from rtamt.readers.selection import Choice
    from rtamt.readers.source import Source
    from rtamt.signals.trace import Trace
    from rtamt.specification import Specification

    #: From the names in a recording, and the ways in which requirements read it, to what they read.
    ChoiceOf = Callable[[Collection[str], Iterable[Way]], Choice]


def table_of_bag(suite: Suite, source: Source, choice_of: ChoiceOf, recording: str) -> VerdictTable:
    """Return the rows of a bag: those that a check of each requirement alone has.

    Which other requirements are checked makes no difference to the clock of a requirement and to its samples: in
    discrete time the latest messages every period, as a node has them.
    """
    source = source.completed(suite.recorded)
    signals = source.signals
    shared = _read_together(suite, source, choice_of)

    def read(way: Way, spec: Specification | None) -> tuple[Specification | None, Trace]:
        if spec is not None and spec.groups:
            over, found = over_members(source, spec, lambda mine: choice_of(signals, [mine]), recording)
            return over, _samples(found, way)
        choice = choice_of(signals, [way])
        data = trace_of(source, choice) if shared is None else shared.select(choice.columns or shared.names)
        return None, _samples(data, way)

    return suite.evaluate_apart(signals, read, recording=recording)


def _read_together(suite: Suite, source: Source, choice_of: ChoiceOf) -> Trace | None:
    """Return what all requirements read; None where one of them reads it differently, or cannot read it."""
    if suite.reads_everything:
        return None
    choice, *alone = (
        choice_of(source.signals, ways) for ways in (suite.ways, *([way] for way in suite.each_way))
    )
    try:
        return trace_of(source, choice) if has_one_clock(source, choice, alone) else None
    except StlError:  # reported with the requirements that it concerns
        return None


def _samples(data: Trace, way: Way) -> Trace:
    """Return messages as samples of the time domain; a sampling rule is applied later."""
    return sampled_messages(data, way.domain.period) if way.domain.sampled and way.rule is None else data
