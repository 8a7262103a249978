"""Early sessions of discrete time in both back ends: samples one period apart."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.engine.discrete.early_python_backend import PythonEarlyMonitor
from rtamt.engine.early import EarlyDefinition, EarlyProgram, EarlyQuery, Group
from rtamt.engine.native import core
from rtamt.signals.coding import codes_of
from rtamt.signals.outcomes import Causation, Change, Interval, Verdict

if TYPE_CHECKING:
    from rtamt.signals.discrete import Discrete


def program_of(query: EarlyQuery, domain: Discrete) -> EarlyProgram:
    """Return the session of the compiled core."""
    group = _group_of(query, domain)
    assert domain.period is not None
    return EarlyProgram(
        query.formulas,
        [group],
        _places_of(query),
        core().EarlyMonitor,
        group.graph.nodes,
        group.outputs,
        group.graph.items,
        query.ranges,
        list(query.inputs),
        query.ignored,
        codes_of(query.types),
        float(domain.period),
        domain.tolerance,
        query.late,
        Verdict if query.verdicts else None,
        query.replays,
        None if group.causes is None else (*group.causes, Causation),
        (Change, Interval),
    )


def definition_of(query: EarlyQuery, domain: Discrete) -> EarlyDefinition:
    """Return the session of the definition."""
    group = _group_of(query, domain)
    return EarlyDefinition(
        [group],
        _places_of(query),
        PythonEarlyMonitor,
        query.formulas,
        query.hidden,
        query.ranges,
        query.inputs,
        domain.period,
        domain.tolerance,
        query.late,
        Verdict if query.verdicts else None,
        [max(0, group.graph.horizon(output)) for output in group.outputs],
        query.causes,
    )


def _group_of(query: EarlyQuery, domain: Discrete) -> Group:
    return Group.of(
        query.formulas,
        query.inputs,
        domain,
        start=query.start,
        hidden=query.hidden,
        causes=query.causes,
    )


def _places_of(query: EarlyQuery) -> list[list[tuple[int, int]]]:
    return [[(0, output)] for output in query.outputs]
