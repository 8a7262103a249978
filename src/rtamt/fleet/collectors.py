"""Collects what the monitors of a fleet report, sample by sample: one class for each form of report.

``COLLECTORS`` is THE LIST of monitors that a fleet can have for its keys.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar

from rtamt.engine.dense.monitor import DenseMonitor
from rtamt.engine.discrete.monitor import Monitor, last_settled_time
from rtamt.fleet.reports import FleetBounds, FleetCausation, FleetChanges, FleetPoints, FleetVerdicts
from rtamt.fleet.updates import FleetUpdate, Released
from rtamt.lazy.modules import np
from rtamt.verdicts.early.causation import CausationMonitor
from rtamt.verdicts.early.dense_eager import DenseEagerMonitor
from rtamt.verdicts.early.discrete_eager import EagerMonitor
from rtamt.verdicts.early.interval import IntervalMonitor

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.engine import OnlineMonitor
    from rtamt.signals.outcomes import Causation, Verdict, VerdictRun
    from rtamt.signals.signal import Signal


class Collector(ABC):
    """The reports of one batch, in its order."""

    #: What the monitors report, for messages.
    what: ClassVar[str]
    #: The number of the mode in programs for the C API.
    mode: ClassVar[int]

    def __init__(self) -> None:
        #: Of each row of a report with several for a sample, the index of the sample.
        self._index: list[int] = []

    @abstractmethod
    def take(self, index: int, monitor: Any, report: Any) -> None:
        """Take what a monitor reported of a sample: the next one, at an index of the batch."""

    def leave_out(self, index: int, monitor: Any) -> None:  # noqa: ARG002 - nothing was reported
        """Note a sample that arrived too late."""
        raise AssertionError("only bounds take late samples")

    @abstractmethod
    def update(self, keys: NDArray[Any]) -> Any:
        """Return the reports as arrays; ``keys``: of the samples, an array that the caller may write to later."""

    def _rows(self, keys: NDArray[Any]) -> tuple[NDArray[Any], NDArray[np.int64]]:
        """Return the key of each row, and the index of its sample."""
        index = np.array(self._index, np.int64)
        return keys[index], index


class _Values(Collector):
    """Delayed verdicts in discrete time."""

    what, mode = "delayed verdicts with settings that the records of the core do not have", 0

    def __init__(self) -> None:
        super().__init__()
        self._values: list[float | None] = []
        self._times: list[Any] = []

    def take(self, index: int, monitor: Monitor, report: float | None) -> None:  # noqa: ARG002 - as Collector has it
        """See :class:`Collector`."""
        self._values.append(report)
        self._times.append(last_settled_time(monitor, known=report is not None))

    def update(self, keys: NDArray[Any]) -> FleetUpdate:
        """See :class:`Collector`."""
        n = len(self._values)
        values = np.array([0.0 if value is None else value for value in self._values], np.float64)
        known = np.array([value is not None for value in self._values], np.bool_)
        nothing, none = np.zeros(n, np.bool_), np.empty(0)
        released = Released(keys[:0], none, none, np.empty(0, np.int64))
        return FleetUpdate(values, known, _times(self._times), nothing, nothing.copy(), released)


class _Points(Collector):
    """Delayed verdicts in dense time."""

    what, mode = "delayed verdicts in dense time", 0

    def __init__(self) -> None:
        super().__init__()
        self._times: list[Any] = []
        self._values: list[float] = []

    def take(self, index: int, monitor: DenseMonitor, report: Signal) -> None:  # noqa: ARG002 - as Collector has it
        """See :class:`Collector`."""
        self._index += [index] * len(report.values)
        self._times += _to_list(report.times)
        self._values += report.values.tolist()

    def update(self, keys: NDArray[Any]) -> FleetPoints:
        """See :class:`Collector`."""
        return FleetPoints(*self._rows(keys), _times(self._times), np.array(self._values, np.float64))


class _Verdicts(Collector):
    """Eager verdicts in discrete time."""

    what, mode = "verdict='eager'", 1

    def __init__(self) -> None:
        super().__init__()
        self._runs: list[tuple[Any, Any, bool, Any]] = []

    def take(self, index: int, monitor: EagerMonitor, report: Sequence[Verdict]) -> None:  # noqa: ARG002 - as Collector has it
        """See :class:`Collector`."""
        self._index += [index] * len(report)
        self._runs += [(each.time, each.time, each.satisfied, each.decided_at) for each in report]

    def update(self, keys: NDArray[Any]) -> FleetVerdicts:
        """See :class:`Collector`."""
        times, ends, satisfied, decided = _columns(self._runs, 4)
        return FleetVerdicts(
            *self._rows(keys), _times(times), _times(ends), np.array(satisfied, np.bool_), _times(decided)
        )


class _Runs(_Verdicts):
    """Eager verdicts in dense time."""

    def take(self, index: int, monitor: Any, report: Sequence[Any]) -> None:  # noqa: ARG002 - as Collector has it
        """See :class:`Collector`."""
        runs: Sequence[VerdictRun] = report
        self._index += [index] * len(runs)
        self._runs += [(each.begin, each.end, each.satisfied, each.decided_at) for each in runs]


class _Bounds(Collector):
    """Interval verdicts."""

    what, mode = "verdict='interval'", 2

    def __init__(self) -> None:
        super().__init__()
        self._bounds: list[tuple[float, float, bool]] = []
        self._changes: list[Any] = []

    def take(self, index: int, monitor: IntervalMonitor, report: None) -> None:  # noqa: ARG002 - as Collector has it
        """See :class:`Collector`."""
        at_start = monitor.interval()
        self._bounds.append((at_start.lower, at_start.upper, False))
        if monitor.at != "start":
            changes = monitor.changes()
            self._index += [index] * len(changes)
            self._changes += changes

    def leave_out(self, index: int, monitor: IntervalMonitor) -> None:  # noqa: ARG002 - as Collector has it
        """See :class:`Collector`."""
        at_start = monitor.interval()
        self._bounds.append((at_start.lower, at_start.upper, True))

    def update(self, keys: NDArray[Any]) -> FleetBounds:
        """See :class:`Collector`."""
        lower, upper, late = _columns(self._bounds, 3)
        begins, ends, intervals, final, retracted = _columns(self._changes, 5)
        changes = FleetChanges(
            *self._rows(keys),
            _times(begins),
            _times(ends),
            np.array([each.lower for each in intervals], np.float64),
            np.array([each.upper for each in intervals], np.float64),
            np.array(final, np.bool_),
            np.array(retracted, np.bool_),
        )
        return FleetBounds(
            keys.copy(),
            np.array(lower, np.float64),
            np.array(upper, np.float64),
            np.array(late, np.bool_),
            changes,
        )


class _Causes(Collector):
    """Causation."""

    what, mode = "verdict='causation'", 3

    def __init__(self) -> None:
        super().__init__()
        self._causes: list[tuple[float, float]] = []

    def take(self, index: int, monitor: CausationMonitor, report: Causation) -> None:  # noqa: ARG002 - as Collector has it
        """See :class:`Collector`."""
        self._causes.append((report.violation, report.satisfaction))

    def update(self, keys: NDArray[Any]) -> FleetCausation:
        """See :class:`Collector`."""
        violation, satisfaction = _columns(self._causes, 2)
        return FleetCausation(
            keys.copy(), np.array(violation, np.float64), np.array(satisfaction, np.float64)
        )


#: THE LIST of the monitors that a fleet can have, each with what collects its reports.
COLLECTORS: Mapping[type, type[Collector]] = MappingProxyType(
    {
        Monitor: _Values,
        DenseMonitor: _Points,
        EagerMonitor: _Verdicts,
        DenseEagerMonitor: _Runs,
        IntervalMonitor: _Bounds,
        CausationMonitor: _Causes,
    }
)


def collector_of(monitor: OnlineMonitor) -> type[Collector]:
    """Return the collector of the reports of a monitor."""
    return next(COLLECTORS[each] for each in type(monitor).__mro__ if each in COLLECTORS)


def _columns(rows: Sequence[tuple[Any, ...]], width: int) -> Sequence[Sequence[Any]]:
    return list(zip(*rows, strict=True)) if rows else [()] * width


def _to_list(times: NDArray[Any]) -> list[Any]:
    """Return times as a list; dates stay dates of numpy."""
    return list(times) if times.dtype.kind in "mM" else times.tolist()


def _times(times: Sequence[Any]) -> NDArray[Any]:
    """Return times in the form of the caller's: numbers, or dates."""
    return np.array(times) if times else np.empty(0)
