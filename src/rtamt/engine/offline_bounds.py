"""Offline bounds: formulas and a finished recording that is known in part to [L, U] at every instant."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rtamt.language.enclosures import Enclosure
from rtamt.reference import dense_bounds, discrete_bounds
from rtamt.reference.dense_bounds import DenseKnowledge
from rtamt.reference.discrete_bounds import Knowledge
from rtamt.signals.outcomes import BoundedSignal

if TYPE_CHECKING:
    from rtamt.language.formula import Formula
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.dense import DenseTrace
    from rtamt.signals.discrete import DiscreteTrace


def discrete(formula: Formula, trace: DiscreteTrace) -> BoundedSignal:
    """Return the bounds of a formula over a recording in discrete time, by the definition."""
    columns = {name: Enclosure(*ends) for name, ends in trace.bounds.items()}
    known = Knowledge(columns, len(trace), finished=True)
    found = discrete_bounds.bounds(formula, known, trace.period, float(trace.times[0]))
    return BoundedSignal(trace.stamps, found.lower, found.upper)


def dense(formula: Formula, trace: DenseTrace) -> BoundedSignal:
    """Return the bounds of a formula over a recording in dense time, by the definition."""
    samples = {}
    for name, (ticks, _) in trace.columns.items():
        lower, upper = (_held(ends, len(ticks)) for ends in trace.bounds[name])
        samples[name] = ticks.tolist(), lower.tolist(), upper.tolist()
    steps = dense_bounds.bounds(formula, DenseKnowledge(samples, finished=True), trace.scale.tick)
    inside = [t for t in steps.times if t <= trace.end]
    if inside[-1] < trace.end:
        inside.append(trace.end)
    pairs = np.array([steps.at(t) for t in inside])
    return BoundedSignal(
        trace.scale.times(np.array(inside, np.int64)), pairs[:, 0].copy(), pairs[:, 1].copy()
    )


def _held(values: FloatArray, count: int) -> FloatArray:
    """Return values of a recording that was prolonged: the last one is held."""
    return np.pad(values, (0, count - len(values)), "edge")
