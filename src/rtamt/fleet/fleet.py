"""An array of monitors of one specification, by key: vehicles, machines, sessions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, UsageError, choices, shown
from rtamt.fleet.fleet_bytes import unpacked
from rtamt.fleet.gaps import GAPS
from rtamt.fleet.keys import capacity_of, keys_of
from rtamt.fleet.late_data import InOrder, Reordered
from rtamt.fleet.suite import Suite
from rtamt.language.units.durations import duration
from rtamt.language.value_types import Enumeration
from rtamt.signals.arrays import is_mapping
from rtamt.specification import Specification
from rtamt.usage_guard import UsageGuard, exclusive
from rtamt.verdicts.modes import DELAYED, mode_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.engine import OnlineMonitor
    from rtamt.fleet.fleet_bytes import FleetState
    from rtamt.fleet.gaps import Gaps
    from rtamt.fleet.per_key import MonitorPerKey
    from rtamt.language.units.durations import Duration
    from rtamt.signals.binding import Binding


class Fleet:
    """Monitors one specification, or many, for many keys, such as vehicles.

    ``spec``: a specification or, for a column of values for each requirement, a :class:`Suite` of specifications with
    the same sampling period. A suite that does not select the robustness reports +inf where a requirement holds, and
    -inf where it does not. ``capacity``: the largest number of keys; memory is used only for those that have come.
    ``lateness``: how late a sample may arrive, in seconds or as text such as ``"2s"``: samples of a key then come in
    any order and wait until one has come that is newer by the lateness. Without it, they come in the order of their
    times. ``gaps``: what a gap between two samples of a key does that is not the period: ``"reject"`` the batch,
    ``"restart"`` the trace of the key with the sample after the gap, or ``"hold"`` the last value where whole
    periods are missing. ``settings``: those of ``Specification.monitor``.

    Each key has the results of its own ``spec.monitor(**settings)``, bit for bit. Delayed verdicts in discrete time run
    as records of the compiled core, a fixed number of bytes each. In dense time and in the other verdict modes, the
    fleet has a monitor for each key: it costs more, and has no snapshots, suites and ``gaps``. ``lateness`` is then a
    setting of ``verdict="interval"``, whose bounds late samples narrow.

    >>> import rtamt
    >>> spec = rtamt.parse("always[0:1](x >= 3)")
    >>> fleet = rtamt.Fleet(spec, capacity=100_000)
    >>> _ = fleet.update_many(["car-1", "car-2"], [0.0, 7.0], {"x": [5.0, 4.0]})
    >>> update = fleet.update_many(["car-2", "car-1"], [8.0, 1.0], {"x": [2.0, 9.0]})
    >>> update.values, update.known, update.times
    (array([-1.,  2.]), array([ True,  True]), array([7., 0.]))
    """

    def __init__(
        self,
        spec: Specification | Suite,
        capacity: int,
        *,
        lateness: Duration | None = None,
        gaps: str = "reject",
        **settings: Any,
    ) -> None:
        if gaps not in GAPS:
            raise UsageError(f"gaps is {shown(gaps)}{choices(gaps, GAPS, 'policies')}")
        self._open(spec, capacity_of(capacity), lateness, GAPS[gaps], settings)

    def _open(
        self,
        spec: Specification | Suite,
        capacity: int,
        lateness: Duration | None,
        gaps: Gaps,
        settings: Mapping[str, Any],
        state: FleetState | None = None,
    ) -> None:
        mode = mode_of(settings.get("verdict", DELAYED), {})
        if lateness is not None and "lateness" in mode.settings:
            settings, lateness = {**settings, "lateness": lateness}, None
        monitor, specs, self.requirements = _monitor_of(spec, settings)
        records = monitor.records(
            capacity,
            restart=gaps.restart,
            state=None if state is None else state.records,
            identities={name: identity for each in specs for name, identity in _identities(each).items()},
            watched=bool(self.requirements),
        )
        self._usage = UsageGuard()
        self._binding: Binding = monitor._binding
        self._gaps = gaps
        #: Whether a batch may lack variables: whether it may is for the monitors of the keys.
        self._partial = records is None
        self._samples: InOrder | MonitorPerKey
        if records is None:
            self._samples = _monitors(monitor, self.requirements, capacity, lateness, gaps, settings, state)
            return
        late = None if lateness is None else float(duration(lateness))
        waiting = None if state is None else state.waiting
        ordered = late is None and not gaps.filled and waiting is None
        self._samples = (
            InOrder(records, self.requirements)
            if ordered
            else Reordered(records, self.requirements, late, gaps, waiting)
        )

    @exclusive
    def update_many(self, keys: Any, times: Any, columns: Mapping[str, Any]) -> Any:
        """Take a batch of samples: the key and the time of each, and a column of values for each variable.

        ``keys``: integers, texts or bytes, in any order; without ``lateness``, samples of one key are in the order of
        their times. New keys start a trace. Returns what the batch made known: a :class:`FleetUpdate`, for dense time
        a :class:`FleetPoints`, and for the verdict modes a :class:`FleetVerdicts`, :class:`FleetBounds` or
        :class:`FleetCausation`. Outside of delayed verdicts in discrete time, values are what ``update`` of the monitor
        takes, such as None or bounds, and a masked value of an array leaves its variable out of the sample.

        Raises :class:`TraceError` for wrong data and :class:`EvaluationError` where an operation has no value, with the
        key and the index in the batch; no key has changed then.
        """
        given = keys_of(keys)
        if not is_mapping(columns):
            raise TraceError(f"expected a mapping from variable to values, got {type(columns).__name__}")
        found = self._binding.applied(dict(columns), partial=self._partial)
        return self._samples.take(given, times, found)

    @exclusive
    def watermark(self, time: Any) -> Any:
        """Declare that no sample before a time will arrive, of any key: what waits up to it is released.

        ``time``: in seconds, or a date. Earlier samples are late from now on. Returns an update with an empty batch:
        see ``released``.

        With ``verdict="interval"``, and with ``verdict="causation"`` in dense time, it is ``watermark`` of the monitor
        of each key that there is, and the update has a row for each key.

        >>> import rtamt
        >>> fleet = rtamt.Fleet(rtamt.parse("x >= 3"), capacity=10, lateness="2s")
        >>> fleet.update_many([7, 7], [1, 0], {"x": [5, 4]}).known
        array([False, False])
        >>> fleet.watermark(1).released
        Released(keys=array([7, 7]), times=array([0., 1.]), values=array([1., 2.]), requirements=array([0, 0]))
        """
        return self._samples.watermark(time, keys_of)

    @exclusive
    def advance(self, now: Any) -> Any:
        """Set the current time: no sample will arrive that is older than the lateness. As :meth:`watermark`.

        For streams with keys that fall silent, whose own samples release nothing.
        """
        return self._samples.advance(now, keys_of)

    @property
    def late(self) -> int:
        """How many samples were late since the start; they are part of the state."""
        return self._samples.late

    @property
    def waiting(self) -> int:
        """How many samples wait for earlier ones."""
        return self._samples.waiting

    @property
    def capacity(self) -> int:
        """The largest number of keys."""
        return self._samples.capacity

    @property
    def memory(self) -> int:
        """The size of the state in bytes, of the keys that there are."""
        return self._samples.memory

    def __len__(self) -> int:
        return len(self._samples)

    @exclusive
    def __contains__(self, key: object) -> bool:
        try:
            given = keys_of([key])
        except TraceError:
            return False
        return self._samples.contains(given)

    @exclusive
    def monitor(self, key: Any) -> OnlineMonitor:
        """Return a copy of the monitor of a key, for bounds at other instants, explanations and what is watched.

        For fleets that have a monitor for each key: in dense time, and in all verdict modes but ``"delayed"``. Raises
        :class:`UsageError` for a key that is not there.

        >>> import rtamt
        >>> fleet = rtamt.Fleet(rtamt.parse("once[0:1](x >= 3)"), capacity=10, verdict="interval")
        >>> _ = fleet.update_many([7, 7], [0, 1], {"x": [5, 4]})
        >>> fleet.monitor(7).interval(1)
        Interval(lower=2.0, upper=2.0)
        """
        found = self._samples.monitor(keys_of([key]))
        if found is None:
            raise UsageError(f"the fleet has no key {shown(key)}")
        return found

    @exclusive
    def keys(self) -> list[Any]:
        """Return all keys, in no particular order."""
        return self._samples.keys()

    @exclusive
    def drop(self, keys: Any) -> None:
        """Forget keys: their next sample starts a new trace. Raises :class:`UsageError` for a key that is not there.

        >>> import rtamt
        >>> fleet = rtamt.Fleet(rtamt.parse("x >= 3"), capacity=10)
        >>> _ = fleet.update_many([1, 2], [0, 0], {"x": [5, 4]})
        >>> fleet.drop([1])
        >>> len(fleet), 1 in fleet, fleet.keys()
        (1, False, [2])
        """
        given = keys_of(keys)
        missing = self._samples.drop(given)
        if missing is not None:
            raise UsageError(
                f"the fleet has no key {given[missing].item()!r} (index {missing}); no key was dropped"
            )

    @exclusive
    def _discard(self, key: Any, time: float) -> bool:
        """Forget a sample that waits; return whether there was one. The watermark of the key stays."""
        return isinstance(self._samples, Reordered) and self._samples.discard(keys_of([key]), time)

    @exclusive
    def expire(self, *, before: float) -> int:
        """Forget the keys whose last sample is before a time in seconds; return how many.

        >>> import rtamt
        >>> fleet = rtamt.Fleet(rtamt.parse("x >= 3"), capacity=10)
        >>> _ = fleet.update_many([1, 2], [0, 60], {"x": [5, 4]})
        >>> fleet.expire(before=30), fleet.keys()
        (1, [2])
        """
        return self._samples.expire(before, keys_of)

    @exclusive
    def snapshot(self) -> bytes:
        """Return the state of all keys, in the format of [the state of a fleet](fleet-state.md).

        Raises :class:`UsageError` where the fleet has a monitor for each key, whose state has no such format.

        >>> import rtamt
        >>> spec = rtamt.parse("once(x >= 3)")
        >>> fleet = rtamt.Fleet(spec, capacity=10)
        >>> _ = fleet.update_many([1], [0], {"x": [5]})
        >>> rtamt.Fleet.restore(spec, fleet.snapshot()).update_many([1], [1], {"x": [0]}).values
        array([2.])
        """
        return self._samples.snapshot(self._gaps)

    @classmethod
    def restore(
        cls,
        spec: Specification | Suite,
        state: bytes,
        *,
        capacity: int | None = None,
        lateness: Duration | None = None,
        gaps: str | None = None,
        **settings: Any,
    ) -> Fleet:
        """Return a fleet in a state that :meth:`snapshot` returned, perhaps of another specification.

        Parts of the formula that are the same go on where they were. For those that are new, or that read what is
        new, no value is known until all samples that it depends on have come: ``FleetUpdate.warming``. ``capacity``,
        ``lateness`` and ``gaps``: by default those of the fleet of the snapshot. Raises :class:`UsageError` for bytes
        that are not a state.
        """
        if not isinstance(state, bytes):
            raise UsageError(f"expected the bytes that snapshot() returns, got {shown(state)}")
        if gaps is not None and gaps not in GAPS:
            raise UsageError(f"gaps is {shown(gaps)}{choices(gaps, GAPS, 'policies')}")
        stored = unpacked(state)
        made = cls.__new__(cls)
        made._open(
            spec,
            0 if capacity is None else capacity_of(capacity),
            stored.lateness if lateness is None else lateness,
            stored.gaps if gaps is None else GAPS[gaps],
            settings,
            stored,
        )
        return made


def _monitor_of(
    spec: Any, settings: Mapping[str, Any]
) -> tuple[OnlineMonitor, tuple[Specification, ...], tuple[str, ...]]:
    """Return a monitor, the specifications that it is of, and the names of requirements that it watches."""
    if isinstance(spec, Suite):
        if "verdict" in settings:
            raise UsageError(
                "a fleet of a suite has delayed verdicts; for verdict=, make a fleet of each specification"
            )
        if settings:
            raise UsageError(
                f"{next(iter(settings))}= is a setting of the suite: write Suite(specs, {next(iter(settings))}=...)"
            )
        monitor, specs = spec.monitor()
        return monitor, specs, tuple(each.name for each in spec.requirements)
    if not isinstance(spec, Specification):
        raise UsageError(
            f"expected a specification, got {shown(spec)}; write rtamt.parse(...) or rtamt.load(...)"
        )
    spec.require_no_groups("a fleet")
    return spec.monitor(**settings), (spec,), ()


def _monitors(
    monitor: OnlineMonitor,
    requirements: tuple[str, ...],
    capacity: int,
    lateness: Duration | None,
    gaps: Gaps,
    settings: Mapping[str, Any],
    state: FleetState | None,
) -> MonitorPerKey:
    """Return a monitor for each key; raise :class:`UsageError` where there can be none."""
    from rtamt.fleet.collectors import collector_of  # with all verdict modes, which records do not need
    from rtamt.fleet.per_key import MonitorPerKey, no_state

    if requirements:
        raise UsageError(
            "a fleet of a suite monitors the delayed robustness in discrete time, without custom operators; make a "
            "fleet of each specification"
        )
    if state is not None:
        raise no_state(collector_of(monitor).what)
    return MonitorPerKey(monitor, capacity, lateness=lateness, gaps=gaps, unit=settings.get("time_unit"))


def _identities(spec: Specification) -> dict[str, str]:
    """Return what stands for the names of variables in a state, where a declaration decides what a number means.

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
