"""An array of monitors of one specification, by key: vehicles, machines, sessions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Generic, Literal, overload

from rtamt.errors import UsageError, choices, shown
from rtamt.fleet.fleet_keys import FleetKeys
from rtamt.fleet.fleet_snapshot import unpacked
from rtamt.fleet.gaps import GAPS
from rtamt.fleet.keys import capacity_of, columns_of, keys_of
from rtamt.fleet.late_data import Reordered, moment_of
from rtamt.fleet.opening import open_fleet
from rtamt.usage_guard import UsageGuard, exclusive

if TYPE_CHECKING:
    from collections.abc import Mapping

    from typing_extensions import TypeVar

    from rtamt.fleet.fleet_snapshot import FleetState
    from rtamt.fleet.gaps import Gaps
    from rtamt.fleet.reports import FleetBounds, FleetCausation, FleetPoints, FleetVerdicts, SuiteUpdate
    from rtamt.fleet.suite import Suite
    from rtamt.fleet.updates import FleetUpdate
    from rtamt.language.units.durations import Duration
    from rtamt.signals.dense import Dense
    from rtamt.signals.discrete import Discrete
    from rtamt.specification import Specification

    Update = TypeVar("Update", default=FleetUpdate)
else:
    from typing import TypeVar

    Update = TypeVar("Update")


class Fleet(FleetKeys, Generic[Update]):
    """Monitors one specification, or many, for many keys, such as vehicles.

    ``spec``: a specification or, for a column of values for each requirement, a :class:`Suite` of specifications with
    the same sampling period. A suite that does not select the robustness reports +inf where a requirement holds, and
    -inf where it does not. ``capacity``: the largest number of keys; memory is used only for those that have come.
    ``lateness``: how late a sample may arrive, in seconds or as text such as ``"2s"``: samples of a key then arrive in
    any order and wait until one has come that is newer by the lateness. Without it, they come in the order of their
    times. ``gaps``: what a gap between two samples of a key does that is not the period: ``"reject"`` the batch,
    ``"restart"`` the trace of the key with the sample after the gap, or ``"hold"`` the last value where whole
    periods are missing. ``settings``: those of ``Specification.monitor``.

    Each key has the results of its own ``spec.monitor(**settings)``, bit for bit. Delayed verdicts in discrete time run
    as records of the compiled core, a fixed number of bytes each. In dense time and in the other verdict modes, the
    fleet has a monitor for each key, and of a suite for each requirement: it costs more, and has no ``gaps``.
    ``lateness`` is then a setting of ``verdict="interval"``, whose bounds late samples narrow.

    Type checkers know the class of updates from ``verdict=`` and ``time=`` in the call. For a suite of dense time,
    annotate the fleet: ``fleet: rtamt.Fleet[rtamt.SuiteUpdate[rtamt.FleetPoints]] = rtamt.Fleet(suite, 1000)``.

    >>> import rtamt
    >>> spec = rtamt.parse("always[0:1](x >= 3)")
    >>> fleet = rtamt.Fleet(spec, capacity=100_000)
    >>> _ = fleet.update_many(["car-1", "car-2"], [0.0, 7.0], {"x": [5.0, 4.0]})
    >>> update = fleet.update_many(["car-2", "car-1"], [8.0, 1.0], {"x": [2.0, 9.0]})
    >>> update.values, update.known, update.times
    (array([-1.,  2.]), array([ True,  True]), array([7., 0.]))
    """

    @overload
    def __init__(
        self: Fleet[FleetUpdate],
        spec: Specification | Suite,
        capacity: int,
        *,
        time: Literal["discrete"] | Discrete | None = None,
        verdict: Literal["delayed"] = "delayed",
        **settings: Any,
    ) -> None: ...

    @overload
    def __init__(
        self: Fleet[FleetPoints],
        spec: Specification,
        capacity: int,
        *,
        time: Literal["dense"] | Dense,
        verdict: Literal["delayed"] = "delayed",
        **settings: Any,
    ) -> None: ...

    @overload
    def __init__(
        self: Fleet[FleetVerdicts],
        spec: Specification,
        capacity: int,
        *,
        verdict: Literal["eager"],
        **settings: Any,
    ) -> None: ...

    @overload
    def __init__(
        self: Fleet[FleetBounds],
        spec: Specification,
        capacity: int,
        *,
        verdict: Literal["interval"],
        **settings: Any,
    ) -> None: ...

    @overload
    def __init__(
        self: Fleet[FleetCausation],
        spec: Specification,
        capacity: int,
        *,
        verdict: Literal["causation"],
        **settings: Any,
    ) -> None: ...

    @overload
    def __init__(
        self: Fleet[SuiteUpdate[FleetVerdicts]],
        spec: Suite,
        capacity: int,
        *,
        verdict: Literal["eager"],
        **settings: Any,
    ) -> None: ...

    @overload
    def __init__(
        self: Fleet[SuiteUpdate[FleetBounds]],
        spec: Suite,
        capacity: int,
        *,
        verdict: Literal["interval"],
        **settings: Any,
    ) -> None: ...

    @overload
    def __init__(
        self: Fleet[SuiteUpdate[FleetCausation]],
        spec: Suite,
        capacity: int,
        *,
        verdict: Literal["causation"],
        **settings: Any,
    ) -> None: ...

    def __init__(
        self,
        spec: Specification | Suite,
        capacity: int,
        *,
        lateness: Duration | None = None,
        gaps: str = "reject",
        **settings: Any,
    ) -> None:
        if gaps not in tuple(GAPS):  # also what has no hash
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
        self._usage = UsageGuard()
        self._gaps = gaps
        self._samples, self._binding, self._partial, self.requirements = open_fleet(
            spec, capacity, lateness, gaps, settings, state
        )

    @exclusive
    def update_many(self, keys: Any, times: Any, columns: Mapping[str, Any]) -> Update:
        """Take a batch of samples: the key and the time of each, and a column of values for each variable.

        ``keys``: integers, texts or bytes, in any order; without ``lateness``, samples of one key are in the order of
        their times. New keys start a trace. Returns what the batch made known: a :class:`FleetUpdate`, for dense time
        a :class:`FleetPoints`, and for the verdict modes a :class:`FleetVerdicts`, :class:`FleetBounds` or
        :class:`FleetCausation`. Outside of delayed verdicts in discrete time, values are what ``update`` of the monitor
        takes, such as None or bounds, and a masked value of an array leaves its variable out of the sample. There, a
        fleet of a suite returns a :class:`SuiteUpdate` of these.

        Raises :class:`TraceError` for wrong data and :class:`EvaluationError` where an operation has no value, with the
        key and the index in the batch; no key has changed then.
        """
        given = keys_of(keys)
        found = self._binding.applied(columns_of(columns), partial=self._partial)
        return self._samples.take(given, times, found)  # type: ignore[return-value] # of this mode

    @exclusive
    def watermark(self, time: Any) -> Update:
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
        return self._samples.watermark(time, keys_of)  # type: ignore[return-value] # of this mode

    @exclusive
    def advance(self, now: Any) -> Update:
        """Set the current time: no sample will arrive that is older than the lateness. As :meth:`watermark`.

        For streams with keys that fall silent, whose own samples release nothing.
        """
        return self._samples.advance(now, keys_of)  # type: ignore[return-value] # of this mode

    def __reduce__(self) -> Any:
        raise UsageError(
            "a fleet can be neither copied nor pickled: take fleet.snapshot(), and make another fleet of it with "
            "rtamt.Fleet.restore(spec, state)"
        )

    @exclusive
    def release(self, keys: Any) -> Update:
        """Release all samples that wait of some keys: no earlier ones will come, such as at the end of a trip.

        Samples that are not after those are late from now on. Returns an update with an empty batch, see
        ``FleetUpdate.released``. Raises :class:`UsageError` for a key that is not there.

        >>> import rtamt
        >>> fleet = rtamt.Fleet(rtamt.parse("x >= 3"), capacity=10, lateness="2s")
        >>> _ = fleet.update_many([7, 7, 8], [1, 0, 0], {"x": [5, 4, 2]})
        >>> fleet.release([7]).released.values, fleet.waiting
        (array([1., 2.]), 1)
        """
        return self._samples.release_keys(keys_of(keys), keys_of)  # type: ignore[return-value] # of this mode

    @exclusive
    def discard(self, key: Any, time: Any) -> bool:
        """Forget the sample of a key and a time that waits for earlier ones; return whether there was one.

        ``time``: in seconds, or a date.

        For samples that turn out to have no value when they are released, see :class:`WaitedError`. The watermark of
        the key stays, so that another sample of that time may arrive until it is late. What the sample leaves is a gap.

        >>> import rtamt
        >>> fleet = rtamt.Fleet(rtamt.parse("sqrt(x) >= 3"), capacity=10, lateness="1s", gaps="restart")
        >>> _ = fleet.update_many([7, 7], [0, 1], {"x": [25, -4]})
        >>> try:
        ...     fleet.update_many([7], [2], {"x": [16]})
        ... except rtamt.WaitedError as error:
        ...     fleet.discard(error.key, error.time)
        True
        >>> fleet.update_many([7, 7], [2, 3], {"x": [16, 9]}).values
        array([1., 0.])
        """
        given, moment = keys_of([key]), moment_of(time, "time")
        return isinstance(self._samples, Reordered) and self._samples.discard(given, moment)

    @exclusive
    def compile(self) -> bytes:
        """Return the program of this fleet, for ``rtamt_fleet_create`` and ``rtamt_fleet_restore`` of the C API.

        Fleets in C take the same samples, report the same, and read the same snapshots. ``capacity``, and in discrete
        time with delayed verdicts the tolerance, ``gaps`` and ``lateness``, are arguments of the functions in C.
        Raises :class:`UsageError` for settings that are for Python alone.

        >>> import rtamt
        >>> fleet = rtamt.Fleet(rtamt.parse("once[0:1](x >= 3)"), capacity=10, verdict="eager")
        >>> fleet.compile()[:8]
        b'RTAMTMON'
        """
        return self._samples.program()

    @exclusive
    def snapshot(self) -> bytes:
        """Return the state of all keys, in the format of [the state of a fleet](fleet-state.md).

        Raises :class:`UsageError` for ``backend="python"``, whose state has no such format.

        >>> import rtamt
        >>> spec = rtamt.parse("once(x >= 3)")
        >>> fleet = rtamt.Fleet(spec, capacity=10)
        >>> _ = fleet.update_many([1], [0], {"x": [5]})
        >>> rtamt.Fleet.restore(spec, fleet.snapshot()).update_many([1], [1], {"x": [0]}).values
        array([2.])
        """
        return self._samples.snapshot(self._gaps)

    @overload
    @classmethod
    def restore(
        cls,
        spec: Specification | Suite,
        state: bytes,
        *,
        time: Literal["discrete"] | Discrete | None = None,
        verdict: Literal["delayed"] = "delayed",
        **settings: Any,
    ) -> Fleet[FleetUpdate]: ...

    @overload
    @classmethod
    def restore(
        cls,
        spec: Specification,
        state: bytes,
        *,
        time: Literal["dense"] | Dense,
        verdict: Literal["delayed"] = "delayed",
        **settings: Any,
    ) -> Fleet[FleetPoints]: ...

    @overload
    @classmethod
    def restore(
        cls, spec: Specification, state: bytes, *, verdict: Literal["eager"], **settings: Any
    ) -> Fleet[FleetVerdicts]: ...

    @overload
    @classmethod
    def restore(
        cls, spec: Specification, state: bytes, *, verdict: Literal["interval"], **settings: Any
    ) -> Fleet[FleetBounds]: ...

    @overload
    @classmethod
    def restore(
        cls, spec: Specification, state: bytes, *, verdict: Literal["causation"], **settings: Any
    ) -> Fleet[FleetCausation]: ...

    @overload
    @classmethod
    def restore(
        cls, spec: Suite, state: bytes, *, verdict: Literal["eager"], **settings: Any
    ) -> Fleet[SuiteUpdate[FleetVerdicts]]: ...

    @overload
    @classmethod
    def restore(
        cls, spec: Suite, state: bytes, *, verdict: Literal["interval"], **settings: Any
    ) -> Fleet[SuiteUpdate[FleetBounds]]: ...

    @overload
    @classmethod
    def restore(
        cls, spec: Suite, state: bytes, *, verdict: Literal["causation"], **settings: Any
    ) -> Fleet[SuiteUpdate[FleetCausation]]: ...

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
    ) -> Fleet[Any]:
        """Return a fleet in a state that :meth:`snapshot` returned, perhaps of another specification.

        Parts of the formula that are the same go on where they were. For those that are new, or that read what is
        new, no value is known until all samples that it depends on have come: ``FleetUpdate.warming``. ``capacity``,
        ``lateness`` and ``gaps``: by default those of the fleet of the snapshot. Raises :class:`UsageError` for bytes
        that are not a state.

        Where keys have monitors, the specification and all settings must be those of the fleet of the snapshot.
        """
        if not isinstance(state, bytes):
            raise UsageError(f"expected the bytes that snapshot() returns, got {shown(state)}")
        if gaps is not None and gaps not in tuple(GAPS):
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
