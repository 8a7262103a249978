"""Offline bounds: formulas and a finished recording that is known in part to [L, U] at every instant.

The definitions are imported on use: the start of most programs would pay for them.
"""

from __future__ import annotations

from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, TypeAlias
from rtamt.signals.outcomes import BoundedSignal

if TYPE_CHECKING:
    from rtamt.language.formula import Formula
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.dense import DenseTrace
    from rtamt.signals.discrete import DiscreteTrace
    from rtamt.signals.ticks import TickArray

    #: Ticks, and the lower and the upper bound from each of them on.
    StepBounds: TypeAlias = tuple[TickArray, FloatArray, FloatArray]


def discrete(formula: Formula, trace: DiscreteTrace) -> BoundedSignal:
    """Return the bounds of a formula over a recording in discrete time, by the definition."""
    from rtamt.language.definitions.enclosures import Enclosure
    from rtamt.reference.discrete_bounds import Knowledge, bounds

    columns = {name: Enclosure(*ends) for name, ends in trace.bounds.items()}
    known = Knowledge(columns, len(trace), finished=True)
    found = bounds(formula, known, trace.period, float(trace.times[0]))
    return BoundedSignal(trace.timestamps, found.lower, found.upper)


def dense(formula: Formula, trace: DenseTrace) -> BoundedSignal:
    """Return the bounds of a formula over a recording in dense time, by the definition."""
    from rtamt.reference.dense_bounds import DenseKnowledge, bounds

    samples = {name: tuple(each.tolist() for each in steps) for name, steps in signal_bounds(trace).items()}
    steps = bounds(formula, DenseKnowledge(samples, finished=True), trace.scale.tick)
    return bounded_signal(trace, np.array(steps.times), np.array(steps.lower), np.array(steps.upper))


def signal_bounds(trace: DenseTrace) -> dict[str, StepBounds]:
    """Return ticks, lower and upper bounds of each variable of a recording."""
    found = {}
    for name, (ticks, _) in trace.columns.items():
        lower, upper = (_held(ends, len(ticks)) for ends in trace.bounds[name])
        found[name] = ticks, lower, upper
    return found


def bounded_signal(
    trace: DenseTrace, ticks: TickArray, lower: FloatArray, upper: FloatArray
) -> BoundedSignal:
    """Return bounds that change at these ticks, as far as the recording goes and with a point at its end."""
    inside = ticks[ticks <= trace.end]
    if inside[-1] < trace.end:
        inside = np.append(inside, trace.end)
    places = ticks.searchsorted(inside, "right") - 1
    return BoundedSignal(trace.scale.times(inside), lower[places], upper[places])


def _held(values: FloatArray, count: int) -> FloatArray:
    """Return values of a recording that was prolonged: the last one is held."""
    return np.pad(values, (0, count - len(values)), "edge")
