"""The results of a batch of a fleet of monitors, as arrays: one class for each form of report."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Generic, TypeVar

from rtamt.errors import UsageError, choices, shown
from rtamt.lazy.dataclasses import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np
    from numpy.typing import NDArray

    from rtamt.signals.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class FleetPoints:
    """Delayed verdicts in dense time: the points of the robustness that samples made final.

    ``keys``: of each point; ``index``: the sample of the batch that made it final; ``times`` and ``values``: as in the
    Signal that ``DenseMonitor.update`` returns.

    >>> import rtamt
    >>> fleet = rtamt.Fleet(rtamt.parse("once[0:1](x >= 3)"), capacity=10, time="dense")
    >>> update = fleet.update_many(["car-1", "car-2", "car-1"], [0, 0, 2], {"x": [5, 1, 0]})
    >>> list(zip(update.keys.tolist(), update.times.tolist(), update.values.tolist()))
    [('car-1', 0.0, 2.0), ('car-2', 0.0, -2.0), ('car-1', 2.0, 2.0)]
    """

    keys: NDArray[Any]
    index: NDArray[np.int64]
    times: NDArray[Any]
    values: FloatArray

    def __len__(self) -> int:
        return len(self.values)


@dataclass(frozen=True, slots=True)
class FleetVerdicts:
    """Eager verdicts: what samples decided.

    ``keys``: of each verdict; ``index``: the sample of the batch that released it; ``times``: the sample that it is
    for; ``satisfied``: whether the formula holds there; ``decided_at``: the time of the sample that decided it.
    ``ends``: in dense time, a verdict is for all instants from ``times[i]`` up to but excluding ``ends[i]``; in
    discrete time they are the same.

    >>> import rtamt
    >>> fleet = rtamt.Fleet(rtamt.parse("eventually[0:1](x >= 3)"), capacity=10, verdict="eager")
    >>> update = fleet.update_many(["car-1", "car-2", "car-2"], [0, 0, 1], {"x": [5, 1, 2]})
    >>> list(zip(update.keys.tolist(), update.times.tolist(), update.satisfied.tolist(), update.decided_at.tolist()))
    [('car-1', 0.0, True, 0.0), ('car-2', 0.0, False, 1.0)]
    """

    keys: NDArray[Any]
    index: NDArray[np.int64]
    times: NDArray[Any]
    ends: NDArray[Any]
    satisfied: NDArray[np.bool_]
    decided_at: NDArray[Any]

    def __len__(self) -> int:
        return len(self.satisfied)


@dataclass(frozen=True, slots=True)
class FleetChanges:
    """The runs whose bounds samples changed, with the new bounds, as ``IntervalMonitor.changes`` returns them.

    ``keys``: of each run; ``index``: the sample of the batch that changed it; the others are those of ``Change``.
    """

    keys: NDArray[Any]
    index: NDArray[np.int64]
    begins: NDArray[Any]
    ends: NDArray[Any]
    lower: FloatArray
    upper: FloatArray
    final: NDArray[np.bool_]
    retracted: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.lower)


@dataclass(frozen=True, slots=True)
class FleetBounds:
    """Interval verdicts: for each sample, in the order of the batch, bounds of the robustness of its key after it.

    ``lower`` and ``upper``: at the start of the trace of ``keys[i]``. ``late``: which samples arrived later than the
    lateness allows, and were left out. ``changes``: of the bounds at other instants; empty with ``at="start"``.

    >>> import rtamt
    >>> spec = rtamt.parse("eventually[0:1](x >= 3)")
    >>> fleet = rtamt.Fleet(spec, capacity=10, verdict="interval", ranges={"x": (0, 10)})
    >>> update = fleet.update_many(["car-1", "car-2", "car-2"], [0, 0, 1], {"x": [5, 1, 2]})
    >>> update.lower.tolist(), update.upper.tolist()
    ([2.0, -2.0, -1.0], [7.0, 7.0, -1.0])
    """

    keys: NDArray[Any]
    lower: FloatArray
    upper: FloatArray
    late: NDArray[np.bool_]
    changes: FleetChanges

    def __len__(self) -> int:
        return len(self.lower)


@dataclass(frozen=True, slots=True)
class FleetCausation:
    """Causation: by how much each sample alone, in the order of the batch, violates and satisfies the formula.

    ``violation`` and ``satisfaction``: at the start of the trace of ``keys[i]``, as in ``Causation``.

    >>> import rtamt
    >>> fleet = rtamt.Fleet(rtamt.parse("always[0:1](x >= 3)"), capacity=10, verdict="causation")
    >>> update = fleet.update_many(["car-1", "car-1"], [0, 1], {"x": [5, 1]})
    >>> update.violation.tolist(), update.satisfaction.tolist()
    ([2.0, -2.0], [-inf, -2.0])
    """

    keys: NDArray[Any]
    violation: FloatArray
    satisfaction: FloatArray

    def __len__(self) -> int:
        return len(self.violation)


Of = TypeVar("Of")


@dataclass(frozen=True, slots=True)
class SuiteUpdate(Generic[Of]):
    """The results of a batch for each requirement of a suite: ``update["SPEED"]`` is the update of one.

    >>> import rtamt
    >>> suite = rtamt.Suite([rtamt.parse("specification SPEED always[0:1](x <= 3)")], time="dense")
    >>> fleet = rtamt.Fleet(suite, capacity=10)
    >>> fleet.update_many(["car-1", "car-1"], [0, 2], {"x": [5, 1]})["SPEED"].values
    array([-2., -2.])
    """

    updates: Mapping[str, Of]

    @property
    def requirements(self) -> tuple[str, ...]:
        """The names of the requirements."""
        return tuple(self.updates)

    def __getitem__(self, name: str) -> Of:
        if name not in self.updates:
            raise UsageError(
                f"the fleet has no requirement {shown(name)}{choices(name, self.requirements, 'requirements')}"
            )
        return self.updates[name]
