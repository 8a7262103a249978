"""The trace of dense time: every signal on its own timestamps, counted in ticks."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.errors import TraceError, UsageError
from rtamt.signals import arrays, dense_arrays
from rtamt.signals.signal import Signal
from rtamt.signals.ticks import TimeScale

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence
    from fractions import Fraction

    from rtamt.signals.dense_arrays import Samples
    from rtamt.signals.ticks import TickArray


@dataclass(frozen=True, slots=True, eq=False)
class DenseTrace:
    """A finished recording in dense time: for each variable its ticks and values, none of them empty."""

    columns: Mapping[str, Samples]
    scale: TimeScale
    #: The units of the variables whose source tells them.
    units: Mapping[str, str] = field(default_factory=dict)

    @property
    def start(self) -> int:
        """The latest first tick: before it, not every variable has a value."""
        return max(int(ticks[0]) for ticks, _ in self.columns.values())

    @property
    def end(self) -> int:
        """The latest last tick."""
        return max(int(ticks[-1]) for ticks, _ in self.columns.values())

    def held_until(self, tick: int) -> DenseTrace:
        """Return the trace up to a later tick: every variable holds its last value, as it does for ever."""
        if tick <= self.end:
            return self
        name, (ticks, values) = next(iter(self.columns.items()))
        held = np.append(ticks, tick), np.append(values, values[-1])
        return replace(self, columns={**self.columns, name: held})

    def signal(self, ticks: TickArray, values: arrays.FloatArray) -> Signal:
        """Return events as a signal up to the end: a point for every change, and one at the end."""
        end = self.end
        if len(ticks) and ticks[-1] > end:
            inside = int(ticks.searchsorted(end, "right"))
            ticks, values = ticks[:inside], values[:inside]
        if len(ticks) and ticks[-1] < end:
            ticks, values = np.concatenate((ticks, (end,))), np.concatenate((values, values[-1:]))
        return Signal(self.scale.times(ticks), values)


def record_dense(
    data: Any,
    names: Sequence[str],
    tick: Fraction,
    declared: Collection[str] = (),
    scale: TimeScale | None = None,
    unit: str | None = None,
) -> DenseTrace:
    """Normalise a finished recording; the caller's data is never changed.

    ``data``: a mapping from variable to (times, values) or to a list of [time, value] pairs; with a
    key ``"time"`` all variables share its stamps. ``tick``: seconds. ``scale``: how the caller tells
    time, by default found out from the first variable. ``unit``: of times that are numbers, by default
    seconds. Raises :class:`TraceError`.
    """
    if not names:
        raise UsageError("the formula reads no variable, so in dense time nothing says when to evaluate it")
    arrays.require_no_unit(data, unit)
    columns = dense_arrays.columns_of(data, names, declared)
    for name in names:
        if name not in columns:
            raise arrays.missing_variable(name, [str(key) for key in getattr(data, "columns", data)])
        if not len(columns[name][0]):
            raise TraceError(f"'{name}' has no samples: give at least one", variable=name)
    scale = scale or TimeScale.of(tick, [columns[name][0] for name in names], unit)
    samples = {name: dense_arrays.samples_of(columns[name], name, scale) for name in names}
    result = DenseTrace(samples, scale, arrays.units_of(data))
    if result.start > result.end:
        raise TraceError("the signals have no instant in common")
    return result
