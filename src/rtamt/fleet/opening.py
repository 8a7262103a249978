"""The state that a fleet keeps for its keys: records of the compiled core, or monitors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, no_specification
from rtamt.fleet.fleet_snapshot import MONITORS, REQUIREMENTS
from rtamt.fleet.late_data import InOrder, Reordered
from rtamt.fleet.suite import Suite
from rtamt.language.units.durations import duration
from rtamt.language.value_types import Enumeration
from rtamt.lazy.tuples import NamedTuple
from rtamt.settings import EVALUATION_SETTINGS
from rtamt.signals.binding import Binding
from rtamt.specification import Specification
from rtamt.verdicts.modes import DELAYED, mode_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.engine import OnlineMonitor
    from rtamt.fleet.fleet_snapshot import FleetState
    from rtamt.fleet.gaps import Gaps
    from rtamt.fleet.per_key import MonitorPerKey
    from rtamt.fleet.suite_per_key import SuitePerKey
    from rtamt.language.units.durations import Duration

#: What readers of a suite decide, and not a fleet of it.
_OF_SUITES = frozenset({"tolerance", *EVALUATION_SETTINGS})


class Opened(NamedTuple):
    """The receiver of samples; ``partial``: whether a batch may lack variables, since monitors decide about that."""

    samples: InOrder | MonitorPerKey | SuitePerKey
    binding: Binding
    partial: bool
    requirements: tuple[str, ...]


def open_fleet(
    spec: Any,
    capacity: int,
    lateness: Duration | None,
    gaps: Gaps,
    settings: Mapping[str, Any],
    state: FleetState | None,
) -> Opened:
    """Open a new fleet, or one in a state; raise :class:`UsageError` for what cannot be monitored."""
    mode = mode_of(settings.get("verdict", DELAYED), {})
    if lateness is not None and "lateness" in mode.settings:
        settings, lateness = {**settings, "lateness": lateness}, None
    if isinstance(spec, Suite):
        _refuse_settings(settings)
        if mode.name != DELAYED or all(way.domain.own_time_bases for way in spec.ways):
            return _suite_of_monitors(spec, capacity, lateness, gaps, settings, state)
        monitor, specs = spec.monitor()
        requirements = tuple(each.name for each in spec.requirements)
    elif isinstance(spec, Specification):
        spec.require_no_groups("a fleet")
        monitor, specs, requirements = spec.monitor(**settings), (spec,), ()
    else:
        raise no_specification(spec)
    identities = {name: identity for each in specs for name, identity in _identities(each).items()}
    records = monitor.records(
        capacity,
        restart=gaps.restart,
        state=None if state is None or _has_monitors(state) else state.records,
        identities=identities,
        watched=bool(requirements),
    )
    if records is not None:
        if state is not None and _has_monitors(state):
            raise _other_kind("a record for each key")
        late = None if lateness is None else float(duration(lateness))
        waiting = None if state is None else state.waiting
        ordered = late is None and not gaps.filled and waiting is None
        samples = (
            InOrder(records, requirements)
            if ordered
            else Reordered(records, requirements, late, gaps, waiting)
        )
        return Opened(samples, monitor._binding, False, requirements)
    if requirements:
        raise UsageError(
            "a fleet of a suite has delayed verdicts in discrete time without custom operators and time_unit=, or "
            "dense time, or another verdict mode; make a fleet of each specification"
        )
    if state is not None and not state.records.startswith(MONITORS):
        raise _other_kind("a monitor for each key")
    part = _part(spec, monitor, capacity, lateness, gaps, settings, None if state is None else state.records)
    return Opened(part, monitor._binding, True, ())


def _has_monitors(state: FleetState) -> bool:
    return state.records.startswith((MONITORS, REQUIREMENTS))


def _other_kind(here: str) -> UsageError:
    return UsageError(
        f"the state is not of a fleet that has {here}, as this one has: restore it with the specification and the "
        f"settings, such as time= and verdict=, of the fleet that made it"
    )


def _refuse_settings(settings: Mapping[str, Any]) -> None:
    for name in settings:
        if name in _OF_SUITES:
            raise UsageError(f"{name}= is a setting of the suite: write Suite(specs, {name}=...)")


def _suite_of_monitors(
    suite: Suite,
    capacity: int,
    lateness: Duration | None,
    gaps: Gaps,
    settings: Mapping[str, Any],
    state: FleetState | None,
) -> Opened:
    from rtamt.fleet.suite_per_key import SuitePerKey, states_of  # with all verdict modes

    monitors = suite.monitors(settings)
    if state is not None and not state.records.startswith(REQUIREMENTS):
        raise _other_kind("a monitor for each key and requirement")
    states, late = states_of(None if state is None else state.records, tuple(monitors))
    settings = {**settings, "time_unit": suite.ways[0].unit}
    parts = {
        name: _part(spec, monitor, capacity, lateness, gaps, settings, states[name])
        for name, (spec, monitor) in monitors.items()
    }
    return Opened(SuitePerKey(parts, late), Binding(()), True, tuple(parts))


def _part(
    spec: Specification,
    monitor: OnlineMonitor,
    capacity: int,
    lateness: Duration | None,
    gaps: Gaps,
    settings: Mapping[str, Any],
    state: bytes | None,
) -> MonitorPerKey:
    """Return a monitor for each key; raise :class:`UsageError` if there can be none."""
    from rtamt.fleet.per_key import MonitorPerKey  # with all verdict modes, which records do not need

    return MonitorPerKey(
        monitor,
        capacity,
        lateness=lateness,
        gaps=gaps,
        unit=settings.get("time_unit"),
        identities=_identities(spec),
        state=state,
    )


def _identities(spec: Specification) -> dict[str, str]:
    """Return the identities of variables in a state: their names, and declarations that give numbers a meaning.

    With another unit, another recorded name or other codes of members, what is remembered is of another signal.
    """
    found: dict[str, str] = {}
    for each in spec.document.declarations:
        parts = [each.unit, *each.columns]
        kind = spec.document.types.get(each.name)
        if isinstance(kind, Enumeration):
            parts += [f"{member}={code}" for member, code in kind.members]
        if each.kind == "var" and any(parts):
            found[each.name] = "\0".join((each.name, *parts))
    return found
