"""The state of one monitor of a fleet as bytes of a portable format (docs/reference/fleet-state.md).

``REMEMBERED`` is the only list of the state that monitors keep outside their back ends.
"""

from __future__ import annotations

from copy import copy
from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rtamt.engine.backend import CompiledSession
from rtamt.engine.dense.groups import GroupSession
from rtamt.engine.early import EarlyProgram
from rtamt.errors import UsageError
from rtamt.fleet.collectors import collector_of
from rtamt.fleet.fields import (
    ARRAY,
    DATA,
    INTEGER,
    KIND,
    MOMENT,
    NATURAL,
    NUMBER,
    REAL,
    TEXT,
    VALUE,
    Field,
    Source,
    checked,
    damaged,
    fixed,
    interval,
    many,
    mapping,
    optional,
    row,
)
from rtamt.language.printing.printer import to_text
from rtamt.language.units.durations import UNITS
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.modules import np
from rtamt.signals.episodes import Episode
from rtamt.signals.outcomes import Change
from rtamt.signals.ticks import TimeScale

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

#: Bounds, and a number of an input.
_BOUNDS = checked(row(NUMBER, NUMBER), lambda found: found[0] <= found[1])
_TRUTH = Field(
    lambda out, value: KIND.put(out, int(value)),
    lambda source: bool(checked(KIND, lambda kind: kind <= 1).get(source)),
)


# ---- state of monitors -----------------------------------------------------------------------------


def _scale(monitor: Any) -> Field:
    """Return the field of the time scale of dense time: its kind; ticks and units are those of the monitor."""
    unit = monitor._unit
    tick = monitor._tick if hasattr(monitor, "_tick") else monitor._step
    kinds = ("seconds", "datetimes", "zoned", "timedeltas") if unit is None else ("whole", "numbers")
    kind = checked(TEXT, lambda found: found in kinds)

    def get(source: Source) -> TimeScale:
        return TimeScale(tick, kind.get(source), UNITS["s" if unit is None else unit])

    return optional(Field(lambda out, scale: kind.put(out, scale.kind), get))


def _times(monitor: Any) -> Field:
    """Return the field of the caller's times of delayed verdicts."""
    fresh = monitor._times

    def get(source: Source) -> Any:
        original = optional(ARRAY).get(source)
        if original is not None:
            kinds = "mM" if fresh.unit is None else "if"
            if not 0 < len(original) <= fresh.count + 1 or original.dtype.kind not in kinds:
                raise damaged("it has other times than its monitors")
        return replace(fresh, original=original)

    return Field(lambda out, times: optional(ARRAY).put(out, times.original), get)


def _clock(monitor: Any) -> Field:
    """Return the field of the caller's times of verdicts before the horizon."""
    fresh = monitor._clock
    times, seconds, originals = optional(ARRAY), many(REAL, list), many(ARRAY, list)

    def put(out: bytearray, clock: Any) -> None:
        times.put(out, clock._times.original)
        seconds.put(out, clock._seconds)
        originals.put(out, clock._originals)
        NATURAL.put(out, clock._limit)

    def get(source: Source) -> Any:
        clock = fresh.copied()
        last = times.get(source)
        clock._seconds, clock._originals = seconds.get(source), originals.get(source)
        clock._limit = NATURAL.get(source)
        given = [*clock._originals, *([] if last is None else [last])]
        alike = len({each.dtype.kind for each in given}) <= 1 and all(len(each) == 1 for each in given)
        increase = all(map(isfinite, clock._seconds)) and clock._seconds == sorted(set(clock._seconds))
        if not alike or not increase or len(clock._seconds) != len(clock._originals):
            raise damaged("its times are not in order")
        clock._times = replace(clock._times, original=last)
        return clock

    return Field(put, get)


_EPISODE_PARTS = row(MOMENT, MOMENT, NUMBER, MOMENT)
_EPISODE = Field(
    lambda out, each: _EPISODE_PARTS.put(out, (each.begin, each.end, each.worst, each.at)),
    lambda source: Episode(*_EPISODE_PARTS.get(source)),
)


def _episodes(monitor: Any) -> Field:
    """Return the field of the runs of violation of each formula."""
    if monitor._episodes is None:
        return fixed(None)
    fresh = monitor._episodes[0]
    parts = row(many(_EPISODE, list), NATURAL, optional(_EPISODE), optional(_EPISODE))

    def get(source: Source) -> Any:
        tracker = fresh.copied()
        tracker._ended, tracker._count, tracker._worst, tracker._open = parts.get(source)
        return tracker

    def put(out: bytearray, each: Any) -> None:
        parts.put(out, (each._ended, each._count, each._worst, each._open))

    trackers = row(*[Field(put, get)] * len(monitor._episodes))
    return Field(trackers.put, lambda source: list(trackers.get(source)))


def _evidence(monitor: Any) -> Field:
    """Return the field of the samples that may decide a verdict."""
    if monitor._evidence is None:
        return fixed(None)
    fresh = monitor._evidence
    name = checked(TEXT, lambda found: found in monitor._inputs)
    parts = row(many(row(NUMBER, MOMENT, mapping(name, VALUE)), list), mapping(name, NUMBER), NATURAL)

    def get(source: Source) -> Any:
        evidence = fresh.copied()
        evidence._samples, evidence._newest, evidence._limit = parts.get(source)
        return evidence

    return Field(lambda out, each: parts.put(out, (each._samples, each._newest, each._limit)), get)


def _input(monitor: Any) -> Field:
    return checked(INTEGER, lambda number: 0 <= number < len(monitor._inputs))


def _step(monitor: Any) -> Field:
    """Return the field of a time of the back end: a tick, or seconds."""
    return INTEGER if monitor._continuous else checked(REAL, isfinite)


def _events(monitor: Any) -> Field:
    known = checked(row(_input(monitor), NUMBER, NUMBER), lambda found: found[1] <= found[2])
    return many(row(_step(monitor), INTEGER, many(known)), list)


def _snapshots(monitor: Any) -> Field:
    def is_state(state: bytes) -> bool:
        try:
            monitor._session.open().restore(state)
        except ValueError:
            return False
        return True

    return many(row(INTEGER, NATURAL, checked(DATA, is_state)))


def _changes(monitor: Any) -> Field:  # noqa: ARG001 - the same for all
    parts = row(MOMENT, MOMENT, _BOUNDS, _TRUTH, _TRUTH)

    def get(source: Source) -> Change:
        begin, end, bounds, final, retracted = parts.get(source)
        return Change(begin, end, interval(*bounds), final, retracted)

    def put(out: bytearray, each: Change) -> None:
        bounds = each.interval.lower, each.interval.upper
        parts.put(out, (each.begin, each.end, bounds, each.final, each.retracted))

    return optional(many(Field(put, get)))


def _early(monitor: Any) -> Field:
    name = checked(TEXT, lambda found: found in monitor._inputs)
    return many(row(checked(REAL, isfinite), mapping(name, optional(_BOUNDS))), list)


def _evidence_state(monitor: Any) -> Field:
    output = checked(INTEGER, lambda number: number in monitor._outputs)
    return mapping(output, many(row(INTEGER, INTEGER, NUMBER, NUMBER)))


#: THE LIST of what monitors remember, by the name of the attribute. The trace of a key never ends.
REMEMBERED: Mapping[str, Callable[[Any], Field]] = MappingProxyType(
    {
        "_finished": lambda _: fixed(False),
        "_news": lambda _: Field(lambda out, value: None, lambda source: (0, [])),  # noqa: ARG005 - no bytes
        "_times": _times,
        "_scale": _scale,
        "_clock": _clock,
        "_episodes": _episodes,
        "_evidence": _evidence,
        "_early": _early,
        "_events": _events,
        "_snapshots": _snapshots,
        "_retracted": _changes,
        "_mark": lambda monitor: optional(_step(monitor)),
        "_filled": lambda _: NATURAL,
        "_noted": _evidence_state,
        "_moments": lambda _: many(row(NATURAL, checked(REAL, isfinite))),
        "_rest": lambda _: fixed(()),
        "_open_at_end": lambda _: fixed(()),
        "_at_end": lambda _: fixed(None),
        "_ended": lambda _: fixed(()),
    }
)


# ---- states ----------------------------------------------------------------------------------------

_SIGNAL = row(ARRAY, ARRAY)


def _signal(ticks: Any, values: Any) -> Any:
    if ticks.dtype != np.int64 or values.dtype != np.float64 or len(ticks) != len(values):
        raise damaged("it has a signal of other times and values")
    return ticks, values


def _back_end(session: Any) -> Field | None:
    """Return the field of the state of a back end; None where only its own code can read it."""
    if isinstance(session, CompiledSession | EarlyProgram):
        return DATA
    if isinstance(session, GroupSession) and all(
        isinstance(part.session, CompiledSession) for part in session._parts
    ):
        return _groups(session)
    return None


def _groups(session: GroupSession) -> Field:
    """Return the field of requirements with different variables, each with its own back end."""
    requirements, names, _ = session._made_of
    name = checked(TEXT, lambda found: found in names)
    signal = Field(_SIGNAL.put, row(ARRAY, ARRAY, make=_signal).get)

    def several(field: Field, number: int) -> Field:
        some = row(*[field] * number)
        return Field(some.put, lambda source: list(some.get(source)))

    fields = {
        "_counts": mapping(name, NATURAL),
        "_last": mapping(name, row(INTEGER, NUMBER)),
        "_values": several(NUMBER, requirements),
        "_pending": several(signal, requirements),
        "_until": optional(INTEGER),
        "_minimum": REAL,
        "_results": several(signal, 1 + len(session._places) - requirements),
    }
    parts, own = several(DATA, len(session._parts)), row(*fields.values())

    def put(out: bytearray, state: Any) -> None:
        of_parts, mine = state
        parts.put(out, of_parts)
        own.put(out, [mine[each] for each in fields])

    def get(source: Source) -> Any:
        of_parts = parts.get(source)
        mine = dict(zip(fields, own.get(source), strict=True))
        if mine["_counts"].keys() != set(names):
            raise damaged("it does not count the samples of every variable")
        return of_parts, mine

    return Field(put, get)


class MonitorStates:
    """Writes and reads the states of monitors like ``new``, which has taken no sample."""

    def __init__(self, new: Any, identities: Mapping[str, str]) -> None:
        back_end = _back_end(new._session)
        if back_end is None:
            raise UsageError(
                "the state of backend='python' has no portable format; take snapshots of fleets of backend='cpp'"
            )
        self._new = new
        self._back_end = back_end
        self._fields = {name: REMEMBERED[name](new) for name in type(new)._remembered}
        #: What the states depend on, by name.
        self.made_of = _dependencies(new, identities)
        #: The version of the state of the back end, which is at its beginning.
        self.version = int.from_bytes(_first(self._new._backend.state())[:4], "little")

    def put(self, monitor: Any) -> bytes:
        """Return the state of a monitor."""
        _, remembered, of_back_end = monitor._state()
        out = bytearray()
        for name, field in self._fields.items():
            field.put(out, remembered[name])
        self._back_end.put(out, of_back_end)
        return bytes(out)

    def get(self, state: bytes) -> Any:
        """Return a monitor in a state; raise :class:`UsageError` for other bytes."""
        source = Source(state)
        remembered = {name: field.get(source) for name, field in self._fields.items()}
        of_back_end = self._back_end.get(source)
        source.end()
        twin = copy(self._new)
        try:
            twin._resume((twin._session.fingerprint, remembered, of_back_end))
        except (UsageError, ValueError):
            raise damaged("it has no state of this program") from None
        return twin


def _first(state: Any) -> bytes:
    """Return the state of the first back end."""
    found: bytes = state if isinstance(state, bytes) else state[0][0]
    return found


#: Settings that a state depends on, by the name of the attribute.
_SETTINGS = {
    "_period": "the sampling period",
    "_step": "the sampling period or tick",
    "_tick": "the tick",
    "_tolerance": "the tolerance",
    "_unit": "time_unit",
    "_ranges": "ranges",
    "_late": "the lateness in periods or ticks",
    "_replays": "on_correction",
    "_hidden": "at",
    "_explained": "explain",
}


def _dependencies(monitor: Any, identities: Mapping[str, str]) -> dict[str, str]:
    """Return what the state of a monitor depends on, as texts by their names in messages."""
    formula, *watched = map(to_text, monitor._formulas)
    found = {
        "the verdict mode": collector_of(monitor).what,
        "the formula": formula,
        "watch": "; ".join(watched),
        "the variables": ", ".join(
            f"{identities.get(name, name)}: {getattr(monitor._types.get(name), 'name', 'float')}".replace(
                "\0", " "
            )
            for name in monitor.input_names
        ),
        "episodes": str(monitor._episodes is not None),
    }
    for name, what in _SETTINGS.items():
        setting = getattr(monitor, name, None)
        if callable(setting):  # the step of a monitor that has a period
            continue
        found[what] = repr(sorted(setting.items()) if isinstance(setting, dict) else setting)
    found["the program"] = monitor._session.fingerprint.hex()
    return found
