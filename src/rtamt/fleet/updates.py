"""The results of a batch: of its samples, and of those that it released."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, choices, shown
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rtamt.signals.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Released:
    """The results of samples outside the batch: those that waited for earlier ones, or fill a gap.

    ``keys``: of each value, ``times``: the time that it is for, ``requirements``: of a suite, the number of its
    requirement; else 0.
    """

    keys: NDArray[Any]
    times: NDArray[Any]
    values: FloatArray
    requirements: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.values)


@dataclass(frozen=True, slots=True)
class FleetUpdate:
    """The results of a batch, in the order of the batch.

    ``values``: for each sample, the robustness that it made final, as ``Monitor.update`` returns it; only valid where
    ``known``. ``times``: the time that this robustness is for, that of the key's sample one horizon before, in the
    caller's format (dates to the microsecond); NaN or NaT where it is not known. ``warming``: whether it is not known
    because the requirement has changed (:meth:`Fleet.restore`). Of a suite, these four have a column for each
    requirement, and ``update["SPEED"]`` is the update of one. ``late``: which samples arrived too late, or a second
    time, and were left out. ``released``: what samples made known that are not of this batch. ``requirements``: the
    names of those of a suite.

    >>> import rtamt
    >>> fleet = rtamt.Fleet(rtamt.parse("always[0:1](x >= 3)"), capacity=10)
    >>> update = fleet.update_many(["car-1", "car-2", "car-1"], [0, 0, 1], {"x": [5, 1, 4]})
    >>> update.known.tolist(), update.values[update.known].tolist(), update.times[update.known].tolist()
    ([False, False, True], [1.0], [0.0])
    """

    values: FloatArray
    known: NDArray[np.bool_]
    times: NDArray[Any]
    warming: NDArray[np.bool_]
    late: NDArray[np.bool_]
    released: Released
    requirements: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, name: str) -> FleetUpdate:
        if name not in self.requirements:
            raise UsageError(
                f"the fleet has no requirement {shown(name)}{choices(name, self.requirements, 'requirements')}"
            )
        column = self.requirements.index(name)
        every = self.released
        own = every.requirements == column
        released = Released(
            every.keys[own], every.times[own], every.values[own], np.zeros(own.sum(), np.int64)
        )
        return FleetUpdate(
            self.values[:, column],
            self.known[:, column],
            self.times[:, column],
            self.warming[:, column],
            self.late,
            released,
        )
