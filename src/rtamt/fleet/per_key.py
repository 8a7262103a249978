"""A monitor for each key: dense time, and the verdict modes for which the compiled core has no records."""

from __future__ import annotations

from copy import copy
from math import isnan, nan
from typing import TYPE_CHECKING, Any

from rtamt.engine.fleet_keys import full, place_of
from rtamt.errors import EvaluationError, TraceError, UsageError, shown
from rtamt.fleet.collectors import collector_of
from rtamt.fleet.monitor_state import MonitorStates
from rtamt.fleet.monitors_snapshot import Monitors, packed, require_same, unpacked
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.signals.arrays import TIME, timestamps
from rtamt.signals.data_errors import unknown_variable
from rtamt.verdicts.early.interval import LateSampleError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.engine import OnlineMonitor
    from rtamt.fleet.gaps import Gaps


class Prepared(NamedTuple):
    """A batch that has run on copies of monitors: its ``update``, and the rest to be kept if it is."""

    update: Any
    monitors: Mapping[Any, Any]
    newest: Mapping[Any, float]
    late: int


class MonitorPerKey:
    """Copies of one monitor by key. A batch runs on copies of the monitors of its keys, which then replace them.

    ``monitor``: one that has taken no sample. ``unit``: of times that are numbers. ``identities``: what stands for the
    names of variables in a state.
    """

    #: No sample waits: a monitor takes each at once.
    waiting = 0

    def __init__(
        self,
        monitor: OnlineMonitor,
        capacity: int,
        *,
        lateness: Any,
        gaps: Gaps,
        unit: str | None,
        identities: Mapping[str, str],
        state: bytes | None = None,
    ) -> None:
        self._collector = collector_of(monitor)
        if gaps.code:
            raise UsageError(
                f"gaps='{gaps.name}' needs delayed verdicts in discrete time, and this fleet has a monitor for each "
                f"key ({self._collector.what}): leave gaps= out"
            )
        if lateness is not None:
            raise UsageError(
                f"lateness= needs delayed verdicts in discrete time or verdict='interval', and this fleet has a "
                f"monitor for each key ({self._collector.what}): give the samples of a key in the order of their times"
            )
        self._new: Any = copy(monitor)  # raises an error where there are no copies
        self._unit, self.capacity = unit, capacity
        self._monitors: dict[Any, Any] = {}
        #: The time of the newest sample of each key, in seconds.
        self._newest: dict[Any, float] = {}
        #: How many samples were late.
        self.late = 0
        self._identities = identities
        if state is not None:
            self._restore(state)

    def take(self, keys: NDArray[Any], times: Any, columns: Mapping[str, Any]) -> Any:
        """Take a batch; return what it made known. Raises for wrong data, and nothing has changed."""
        prepared = self.prepared(keys, times, columns)
        self.accept(prepared)
        return prepared.update

    def prepared(self, keys: NDArray[Any], times: Any, columns: Mapping[str, Any]) -> Prepared:
        """Run a batch on copies; nothing has changed. Raises for wrong data."""
        self._check_names(columns)
        moments = _to_list(TIME, times)
        seconds = timestamps(times, self._unit).seconds.tolist()
        if len(keys) != len(seconds):
            raise TraceError(
                f"there are {len(keys)} keys and {len(seconds)} times: give one of each for every sample"
            )
        values = {name: _to_list(name, column) for name, column in columns.items()}
        for name, column in values.items():
            if len(column) != len(seconds):
                raise TraceError(
                    f"'{TIME}' has {len(seconds)} and '{name}' has {len(column)} samples: give one value of each at "
                    f"every sample",
                    variable=name,
                )
        given = keys.tolist()
        self._check_kind(given)
        return self._run(keys, given, moments, seconds, values)

    def _run(
        self,
        keys: NDArray[Any],
        given: Sequence[Any],
        moments: Sequence[Any],
        seconds: Sequence[float],
        values: Mapping[str, Sequence[Any]],
    ) -> Prepared:
        names = tuple(values)
        rows = zip(*values.values(), strict=True) if names else [()] * len(given)
        reports = self._collector()
        twins: dict[Any, Any] = {}
        newest: dict[Any, float] = {}
        room, late = self.capacity - len(self._monitors), 0
        for index, (key, moment, row) in enumerate(zip(given, moments, rows, strict=True)):
            twin = twins.get(key)
            if twin is None:
                old = self._monitors.get(key)
                if old is None:
                    if not room:
                        raise full(place_of(key, index), self.capacity)
                    room -= 1
                twin = twins[key] = copy(self._new if old is None else old)
            sample = {name: each for name, each in zip(names, row, strict=True) if each is not np.ma.masked}
            try:
                report = twin.update(moment, **sample)
            except LateSampleError:
                reports.leave_out(index, twin)
                late += 1
                continue
            except TraceError as error:
                raise TraceError(
                    f"{place_of(key, index)}: {error}",
                    variable=error.variable,
                    index=index,
                    time=seconds[index],
                ) from None
            except EvaluationError as error:
                raise EvaluationError(f"{place_of(key, index)}: {error}") from None
            reports.take(index, twin, report)
            newest[key] = max(seconds[index], newest.get(key, seconds[index]))
        return Prepared(reports.update(keys), twins, newest, late)

    def accept(self, prepared: Prepared) -> None:
        """Keep a batch that was prepared, with no other one since then."""
        self._monitors.update(prepared.monitors)
        for key, time in prepared.newest.items():
            self._newest[key] = max(time, self._newest.get(key, time))
        self.late += prepared.late

    @property
    def input_names(self) -> tuple[str, ...]:
        """The variables."""
        names: tuple[str, ...] = self._new.input_names
        return names

    def own(self, columns: Mapping[str, Any]) -> tuple[dict[str, Any], set[str]]:
        """Return the columns that are for these monitors, under the names of their variables, and which were read."""
        found = self._new._binding.applied(dict(columns), partial=True)
        own = {name: column for name, column in found.items() if self._knows(name)}
        return own, {name for name in columns if name in own or name not in found}

    def _knows(self, name: str) -> bool:
        """Return whether a column may have a name."""
        new = self._new
        return name in new._declared or any(name in (each, each.split(".")[0]) for each in new.input_names)

    def _check_names(self, columns: Mapping[str, Any]) -> None:
        for name in columns:
            if not self._knows(name):
                raise unknown_variable(name, self._new.input_names)

    def _check_kind(self, keys: Sequence[Any]) -> None:
        if keys and self._monitors and type(keys[0]) is not type(next(iter(self._monitors))):
            raise UsageError("the keys of a fleet are all integers, all texts, or all bytes")

    def watermark(self, time: Any, arrays: Callable[[Sequence[Any]], NDArray[Any]]) -> Any:
        """Declare that no sample at or before a time will arrive, of any key; return what each key reports then."""
        return self._keep(self.marked("watermark", time, arrays))

    def advance(self, now: Any, arrays: Callable[[Sequence[Any]], NDArray[Any]]) -> Any:
        """Set the current time of all keys; return what each key reports then."""
        return self._keep(self.marked("advance", now, arrays))

    def release_keys(self, keys: NDArray[Any], arrays: Callable[[Sequence[Any]], NDArray[Any]]) -> Any:  # noqa: ARG002 - nothing waits
        """Raise :class:`UsageError`: no sample waits."""
        raise UsageError(
            "no sample of this fleet waits, since each key has a monitor, which takes each sample at once"
        )

    def _keep(self, prepared: Prepared) -> Any:
        self.accept(prepared)
        return prepared.update

    def marked(self, method: str, time: Any, arrays: Callable[[Sequence[Any]], NDArray[Any]]) -> Prepared:
        """Set the watermark on copies of all monitors; nothing has changed."""
        if not hasattr(self._new, method):
            raise UsageError(
                f"the monitors of this fleet ({self._collector.what}) have no {method}(); choose verdict='interval'"
            )
        reports = self._collector()
        twins = {key: copy(monitor) for key, monitor in self._monitors.items()}
        for index, twin in enumerate(twins.values()):
            reports.take(index, twin, getattr(twin, method)(time))
        return Prepared(reports.update(arrays(list(twins))), twins, {}, 0)

    # ---- keys ------------------------------------------------------------------------------------

    @property
    def memory(self) -> int:
        """Bytes of state, without the objects of Python around it."""
        return sum(monitor.memory for monitor in self._monitors.values())

    def __len__(self) -> int:
        return len(self._monitors)

    def monitor(self, key: NDArray[Any], requirement: str | None) -> OnlineMonitor | None:
        """Return a copy of the monitor of the key of an array of one; None if it is not there."""
        if requirement is not None:
            raise UsageError("the fleet is of one specification, and not of the requirements of a suite")
        found = self._monitors.get(key[0].item())
        return None if found is None else copy(found)

    def contains(self, key: NDArray[Any]) -> bool:
        """Return whether the key in an array of one element exists."""
        return key[0].item() in self._monitors

    def keys(self) -> list[Any]:
        """Return all keys."""
        return list(self._monitors)

    def drop(self, keys: NDArray[Any]) -> int | None:
        """Forget keys; return the index of the first that is not there, and forget none then."""
        given = keys.tolist()
        for index, key in enumerate(given):
            if key not in self._monitors:
                return index
        for key in set(given):
            del self._monitors[key]
            self._newest.pop(key, None)
        return None

    def expire(self, before: float, arrays: Callable[[Sequence[Any]], NDArray[Any]]) -> int:
        """Forget the keys whose newest sample is before a time in seconds; return how many."""
        stale = self.stale(before)
        self.drop(arrays(stale))
        return len(stale)

    def stale(self, before: float) -> list[Any]:
        """Return the keys whose newest sample is before a time in seconds."""
        return [key for key, time in self._newest.items() if time < before]

    # ---- state -------------------------------------------------------------------------------------

    def program(self) -> bytes:
        """Return the program of the monitors, for the C API."""
        from rtamt.fleet.compiled import monitors_program  # with the compiler

        return monitors_program(self._new, self._identities)

    def snapshot(self, gaps: Gaps) -> bytes:  # noqa: ARG002 - gaps are rejected
        """Return the state of all keys."""
        states = MonitorStates(self._new, self._identities)
        return packed(
            Monitors(
                states.version,
                states.made_of,
                self.capacity,
                self.late,
                list(self._monitors),
                [self._newest.get(key, nan) for key in self._monitors],
                [states.put(monitor) for monitor in self._monitors.values()],
            )
        )

    def _restore(self, state: bytes) -> None:
        stored, states = unpacked(state), MonitorStates(self._new, self._identities)
        require_same(stored.made_of, states.made_of)
        if stored.version != states.version:
            raise UsageError(
                f"the state has monitors of version {stored.version}, and this version of rtamt has version "
                f"{states.version}: replay the samples that verdicts still depend on"
            )
        self.capacity = self.capacity or stored.capacity
        if len(stored.keys) > self.capacity:
            raise UsageError(
                f"this state has {len(stored.keys)} keys, more than the capacity of {self.capacity}"
            )
        self.late = stored.late
        for key, time, one in zip(stored.keys, stored.newest, stored.states, strict=True):
            self._monitors[key] = states.get(one)
            if not isnan(time):
                self._newest[key] = time


def _to_list(name: str, column: Any) -> list[Any]:
    """Return the values of a column one by one; of a masked array, what is masked stays masked."""
    if isinstance(column, np.ma.MaskedArray):
        mask = np.ma.getmaskarray(column).tolist()
        data = _to_list(name, column.data)
        return [np.ma.masked if hidden else each for each, hidden in zip(data, mask, strict=True)]
    kind = getattr(getattr(column, "dtype", None), "kind", "")
    if kind not in ("m", "M"):  # as numbers they would be in any unit
        for method in ("tolist", "to_pylist", "to_list"):
            if hasattr(column, method):
                found = getattr(column, method)()
                if isinstance(found, list):
                    return found
    if isinstance(column, str | bytes) or not hasattr(column, "__iter__"):
        raise TraceError(f"'{name}' is {shown(column)}, expected a column of values", variable=name)
    return list(column)
