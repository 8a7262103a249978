"""The keys of a fleet, their number, and their monitors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, UsageError, shown
from rtamt.fleet.keys import keys_of
from rtamt.fleet.late_data import moment_of
from rtamt.usage_guard import UsageGuard, exclusive

if TYPE_CHECKING:
    from rtamt.engine import OnlineMonitor
    from rtamt.fleet.late_data import InOrder
    from rtamt.fleet.per_key import MonitorPerKey
    from rtamt.fleet.suite_per_key import SuitePerKey


class FleetKeys:
    """The part of a :class:`Fleet` that concerns its keys; batches and states are the other."""

    _usage: UsageGuard
    #: The samples of the keys, as records of the core or with a monitor for each.
    _samples: InOrder | MonitorPerKey | SuitePerKey

    @property
    def late(self) -> int:
        """The number of late samples since the start; it is part of the state."""
        return self._samples.late

    @property
    def waiting(self) -> int:
        """The number of samples that wait for earlier ones."""
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
    def monitor(self, key: Any, requirement: str | None = None) -> OnlineMonitor:
        """Return a copy of the monitor of a key, for bounds at other instants, explanations and what is watched.

        ``requirement``: the name of the one of a suite.

        For fleets that have a monitor for each key: in dense time, and in all verdict modes but ``"delayed"``. Raises
        :class:`UsageError` for a key that is not there.

        >>> import rtamt
        >>> fleet = rtamt.Fleet(rtamt.parse("once[0:1](x >= 3)"), capacity=10, verdict="interval")
        >>> _ = fleet.update_many([7, 7], [0, 1], {"x": [5, 4]})
        >>> fleet.monitor(7).interval(1)
        Interval(lower=2.0, upper=2.0)
        """
        found = self._samples.monitor(keys_of([key]), requirement)
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
    def expire(self, *, before: Any) -> int:
        """Forget the keys whose last sample is before a time, in seconds or a date; return how many.

        >>> import rtamt
        >>> fleet = rtamt.Fleet(rtamt.parse("x >= 3"), capacity=10)
        >>> _ = fleet.update_many([1, 2], [0, 60], {"x": [5, 4]})
        >>> fleet.expire(before=30), fleet.keys()
        (1, [2])
        """
        return self._samples.expire(moment_of(before, "before"), keys_of)
