"""Early sessions of dense time in both back ends: requirements, each with its own trace."""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING

from rtamt.engine.dense.early_python_backend import PythonDenseEarlyMonitor
from rtamt.engine.early import EarlyDefinition, EarlyProgram, EarlyQuery, Group
from rtamt.engine.native import core
from rtamt.language.contents import own_variables
from rtamt.language.operators import STL
from rtamt.lazy.tuples import NamedTuple
from rtamt.rewrite.presence import channel_of
from rtamt.signals.coding import codes_of
from rtamt.signals.outcomes import Causation

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.language.formula import Formula
    from rtamt.signals.dense import Dense

    Names = tuple[str, ...]


def program_of(query: EarlyQuery, domain: Dense) -> EarlyProgram:
    """Return the session of the compiled core."""
    parts = _parts_of(query, domain)
    groups = [
        (
            graph.nodes,
            outputs,
            graph.items,
            [query.inputs.index(name) for name in trace],
            None if causes is None else (*causes, Causation),
        )
        for (graph, outputs, causes, _), trace in zip(parts.groups, parts.traces, strict=True)
    ]
    return EarlyProgram(
        query.formulas,
        parts.groups,
        parts.places,
        core().DenseEarlyMonitor,
        groups,
        parts.required,
        parts.places,
        query.ranges,
        list(query.inputs),
        query.ignored,
        codes_of(query.types),
        query.late,
        query.verdicts,
        query.replays,
    )


def definition_of(query: EarlyQuery, domain: Dense) -> EarlyDefinition:
    """Return the session of the definition."""
    parts = _parts_of(query, domain)
    required = [(each, _trace_of(each, query)) for each in query.requirements]
    watched = [[(each, _trace_of_watched(each, query))] for each in query.formulas[1:]]
    return EarlyDefinition(
        parts.groups,
        parts.places,
        PythonDenseEarlyMonitor,
        [required, *watched],
        query.hidden,
        query.ranges,
        query.inputs,
        domain.resolution,
        query.late,
        query.verdicts,
        query.causes,
    )


class _Parts(NamedTuple):
    """Groups of formulas, the trace of each, how many are of requirements, and where each output is."""

    groups: list[Group]
    traces: list[Names]
    required: int
    places: list[list[tuple[int, int]]]


def _parts_of(query: EarlyQuery, domain: Dense) -> _Parts:
    """Formulas whose traces start at different instants are in different groups."""
    wanted: dict[Names, list[Formula]] = {}
    for each in query.requirements:
        wanted.setdefault(_trace_of(each, query), []).append(each)

    def group(formulas: Sequence[Formula], trace: Names, *, start: bool, hidden: int) -> Group:
        # Variables become known at different instants, and with them the predicates that read them.
        causes = query.causes
        return Group.of(formulas, trace, domain, start=start, hidden=hidden, causes=causes, apart=causes)

    if len(wanted) == 1:
        only = group(query.formulas, query.inputs, start=query.start, hidden=query.hidden)
        return _Parts([only], [query.inputs], 1, [[(0, output)] for output in query.outputs])
    required = len(wanted)
    formulas = [[reduce(STL["and"], parts)] for parts in wanted.values()]
    traces = list(wanted)
    places = [] if query.hidden else [[(number, 0) for number in range(required)]]
    for watched in query.formulas[1:]:
        trace = _trace_of_watched(watched, query)
        if trace not in traces:
            traces.append(trace)
            formulas.append([])
        number = traces.index(trace)
        places.append([(number, len(formulas[number]) - _count_hidden(query, number, required))])
        formulas[number].append(watched)
    groups = [
        group(
            each,
            trace,
            start=query.start and number < required,
            hidden=_count_hidden(query, number, required),
        )
        for number, (each, trace) in enumerate(zip(formulas, traces, strict=True))
    ]
    return _Parts(groups, traces, required, places)


def _count_hidden(query: EarlyQuery, group: int, required: int) -> int:
    """Return the number of formulas of a group that are not reported at every instant."""
    return query.hidden if group < required else 0


def _trace_of(formula: Formula, query: EarlyQuery) -> Names:
    """Return the variables that form the trace of a requirement, in order: also those whose presence alone it reads."""
    own = own_variables(formula, query.inputs)
    return tuple(name for name in query.inputs if name in own or channel_of(name) in own)


def _trace_of_watched(formula: Formula, query: EarlyQuery) -> Names:
    """Return the same of a formula that is watched: all variables, unless it is a requirement."""
    return _trace_of(formula, query) if formula in query.requirements else query.inputs
