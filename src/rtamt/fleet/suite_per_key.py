"""A monitor for each key and each requirement of a suite: dense time, and the verdict modes without records."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import StlError, UsageError, choices, placed, shown
from rtamt.fleet.monitors_snapshot import packed_requirements, unpacked_requirements
from rtamt.fleet.reports import SuiteUpdate
from rtamt.lazy.modules import np
from rtamt.signals.data_errors import unknown_variable

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.engine import OnlineMonitor
    from rtamt.fleet.gaps import Gaps
    from rtamt.fleet.per_key import MonitorPerKey, Prepared


class SuitePerKey:
    """The monitors of several requirements over the same keys: all of them take a batch, or none.

    ``parts``: those of each requirement; ``state``: see :func:`parts_of`.
    """

    #: No sample waits: a monitor takes each at once.
    waiting = 0

    def __init__(self, parts: Mapping[str, MonitorPerKey], late: int) -> None:
        self._parts = dict(parts)
        #: How many samples were late for one requirement or more.
        self.late = late

    # ---- samples ---------------------------------------------------------------------------------

    def take(self, keys: NDArray[Any], times: Any, columns: Mapping[str, Any]) -> SuiteUpdate[Any]:
        """Take a batch; return what it made known. Raises for wrong data, and nothing has changed."""
        own = {name: part.own(columns) for name, part in self._parts.items()}
        read = {column for _, names in own.values() for column in names}
        for column in columns:
            if column not in read:
                known = [name for part in self._parts.values() for name in part.input_names]
                raise unknown_variable(column, tuple(dict.fromkeys(known)))
        return self._each(lambda name, part: part.prepared(keys, times, own[name][0]))

    def _each(self, prepare: Callable[[str, MonitorPerKey], Prepared]) -> SuiteUpdate[Any]:
        name, prepared = "", {}
        try:
            for name, part in self._parts.items():
                prepared[name] = prepare(name, part)
        except StlError as error:
            raise placed(error, f"requirement '{name}'") from None
        late = set[int]()
        for name, each in prepared.items():
            self._parts[name].accept(each)
            if each.late:
                late.update(np.flatnonzero(each.update.late).tolist())
        self.late += len(late)
        return SuiteUpdate({name: each.update for name, each in prepared.items()})

    def watermark(self, time: Any, arrays: Callable[[Sequence[Any]], NDArray[Any]]) -> SuiteUpdate[Any]:
        """See :class:`~rtamt.fleet.per_key.MonitorPerKey`."""
        return self._each(lambda _, part: part.marked("watermark", time, arrays))

    def advance(self, now: Any, arrays: Callable[[Sequence[Any]], NDArray[Any]]) -> SuiteUpdate[Any]:
        """See :class:`~rtamt.fleet.per_key.MonitorPerKey`."""
        return self._each(lambda _, part: part.marked("advance", now, arrays))

    def release_keys(self, keys: NDArray[Any], arrays: Callable[[Sequence[Any]], NDArray[Any]]) -> Any:
        """Raise :class:`UsageError`: no sample waits."""
        return self._first.release_keys(keys, arrays)

    # ---- keys ------------------------------------------------------------------------------------

    @property
    def _first(self) -> MonitorPerKey:
        """The monitors of one requirement: all have the same keys."""
        return next(iter(self._parts.values()))

    @property
    def capacity(self) -> int:
        """The largest number of keys."""
        return self._first.capacity

    @property
    def memory(self) -> int:
        """Bytes of state, without the objects of Python around it."""
        return sum(part.memory for part in self._parts.values())

    def __len__(self) -> int:
        return len(self._first)

    def monitor(self, key: NDArray[Any], requirement: str | None) -> OnlineMonitor | None:
        """Return a copy of the monitor of a requirement, of the key of an array of one; None if it is not there."""
        if requirement is None:
            raise UsageError(
                f"the fleet has a monitor for each requirement: name one of {', '.join(self._parts)}, such as "
                f"monitor(key, requirement='{next(iter(self._parts))}')"
            )
        if requirement not in self._parts:
            raise UsageError(
                f"the fleet has no requirement {shown(requirement)}"
                f"{choices(requirement, tuple(self._parts), 'requirements')}"
            )
        return self._parts[requirement].monitor(key, None)

    def contains(self, key: NDArray[Any]) -> bool:
        """Return whether the key in an array of one element exists."""
        return self._first.contains(key)

    def keys(self) -> list[Any]:
        """Return all keys."""
        return self._first.keys()

    def drop(self, keys: NDArray[Any]) -> int | None:
        """Forget keys; return the index of the first that is not there, and forget none then."""
        missing = [part.drop(keys) for part in self._parts.values()]
        return missing[0]

    def expire(self, before: float, arrays: Callable[[Sequence[Any]], NDArray[Any]]) -> int:
        """Forget the keys whose newest sample is before a time in seconds; return how many."""
        stale = set(self.keys()).intersection(*(part.stale(before) for part in self._parts.values()))
        self.drop(arrays(list(stale)))
        return len(stale)

    def program(self) -> bytes:
        """Raise :class:`UsageError`: there is one for each requirement."""
        raise UsageError(
            "fleets of the C API that have a monitor for each key have one requirement; compile a fleet of each"
        )

    def snapshot(self, gaps: Gaps) -> bytes:
        """Return the state of all keys."""
        return packed_requirements(
            {name: part.snapshot(gaps) for name, part in self._parts.items()}, self.late
        )


def states_of(state: bytes | None, names: Sequence[str]) -> tuple[dict[str, bytes | None], int]:
    """Return the state of each requirement, and how many samples were late; raise :class:`UsageError` for others."""
    if state is None:
        return dict.fromkeys(names), 0
    found, late = unpacked_requirements(state)
    for name in names:
        if name not in found:
            raise UsageError(
                f"the state has no requirement {shown(name)}{choices(name, tuple(found), 'requirements')}; where keys "
                f"have monitors, a state continues with the same requirements"
            )
    return {name: found[name] for name in names}, late
