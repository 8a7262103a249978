"""Where a requirement is first violated, from signals that come whole or in chunks."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.engine.dense_evaluate import reach
from rtamt.language.formula import Const, Var
from rtamt.language.operators import STL
from rtamt.rewrite.desugar import desugar
from rtamt.signals.dense import DenseTrace
from rtamt.signals.discrete import DiscreteTrace
from rtamt.signals.ticks import TimeScale
from rtamt.verdicts.decompose import Anchored, Leaf, anchor

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from rtamt.language.formula import Formula
    from rtamt.results import Result
    from rtamt.signals.arrays import FloatArray
    from rtamt.specification import Specification

    Positions = NDArray[np.int64]


def first_violation(result: Result) -> Any:
    """Return when a requirement is first violated, in the times of the recording; None where it holds.

    For ``always φ`` the earliest instant of its window at which φ does not hold, for a conjunction the
    earliest of its parts, for any other formula the first instant of the recording. Boolean semantics.

    >>> import rtamt
    >>> from rtamt.verdicts.first_violation import first_violation
    >>> first_violation(rtamt.parse("always(x >= 3)").evaluate({"time": [0, 1, 2], "x": [5, 1, 0]}))
    1.0
    """
    if result.satisfied:
        return None
    spec, recording = result.specification, result.trace
    anchored = anchor(spec.apply_semantics(spec.formula, "boolean"))
    discrete = isinstance(recording, DiscreteTrace)
    unit = recording.period if isinstance(recording, DiscreteTrace) else recording.scale.tick
    trackers = [Tracker(leaf, unit, not discrete) for leaf in anchored.leaves]
    for tracker in trackers:
        formula = align_inputs(tracker.leaf.formula, tuple(recording.columns))
        if isinstance(recording, DiscreteTrace):
            signal = spec.signal_of(formula, recording)
            tracker.take(np.arange(len(signal)), signal.values)
        else:
            signal = spec.signal_of(formula, settled(recording, formula))
            tracker.take(signal.times - recording.start, signal.values)
        tracker.finish()
    position = violation_of(spec, anchored, trackers)
    if isinstance(recording, DiscreteTrace):
        return recording.stamp(position)
    return recording.scale.time(recording.start + position)


def align_inputs(formula: Formula, names: Sequence[str]) -> Formula:
    """Return a formula with the same values that reads all the names: so several formulas begin and end together."""
    if not names:
        return formula
    everything: Formula = Var(names[0])
    for name in names[1:]:
        everything = STL["and"](everything, Var(name))
    return STL["and"](formula, STL["or"](Const(float("inf")), everything))


def settled(recording: DenseTrace, formula: Formula) -> DenseTrace:
    """Return a recording, in ticks, whose last values hold until the past windows of a formula have slid over them."""
    end = recording.end + reach(desugar(formula), recording.scale.tick) + 1
    columns = {
        name: (np.append(ticks, end), np.append(values, values[-1]))
        for name, (ticks, values) in recording.columns.items()
    }
    return DenseTrace(columns, TimeScale.in_ticks(recording.scale.tick))


def violation_of(spec: Specification, anchored: Anchored, trackers: Sequence[Tracker]) -> int:
    """Return the earliest position at which one of the parts that must all hold is violated.

    ``trackers``: of the leaves, in order.
    """
    found = []
    for part in anchored.conjuncts():
        leaf = anchored.leaf(part)
        if leaf is not None and leaf.reduce == "min":
            found += [t.violated for t in trackers if t.leaf == leaf and t.violated is not None]
        elif not value_of(spec, part, trackers) > 0:
            found.append(0)
    return min(found)


def value_of(spec: Specification, skeleton: Formula, trackers: Sequence[Tracker]) -> float:
    """Return the value of a skeleton, given those of its leaves."""
    columns = {f"#{i}": np.array([tracker.value]) for i, tracker in enumerate(trackers)}
    return float(spec.signal_of(skeleton, DiscreteTrace(np.zeros(1), columns, Fraction(1))).values[0])


class Tracker:
    """One leaf of an anchored formula: takes its signal in chunks, keeps the value and the first violation.

    Positions count periods or ticks (``unit`` seconds each) from the first instant. A value holds up
    to the next position; the last one, in dense time, for ever.
    """

    def __init__(self, leaf: Leaf, unit: Fraction, dense: bool) -> None:
        self.leaf = leaf
        self._begin = int(leaf.begin / unit)
        self._end = None if leaf.end is None else int(leaf.end / unit)
        self._dense = dense
        self._pending: tuple[int, float] | None = None
        self.value = float("-inf") if leaf.reduce == "max" else float("inf")
        #: The earliest position of the window at which the value is below 0.
        self.violated: int | None = None

    def take(self, positions: Positions, values: FloatArray) -> None:
        """Take what became known of the leaf's formula."""
        if not len(positions):
            return
        if self._pending is not None:
            position, value = self._pending
            positions, values = np.concatenate(([position], positions)), np.concatenate(([value], values))
        self._reduce(positions[:-1], positions[1:], values)
        self._pending = (int(positions[-1]), float(values[-1]))

    def finish(self) -> None:
        """Take the last value: nothing comes after it."""
        if self._pending is not None:
            position, value = self._pending
            stop = max(position, self._begin) + 1 if self._dense else position + 1
            self._reduce(np.array([position]), np.array([stop]), np.array([value]))
            self._pending = None

    def _reduce(self, starts: Positions, stops: Positions, values: FloatArray) -> None:
        inside = stops > self._begin
        if self._end is not None:
            inside &= starts <= self._end
        where = np.flatnonzero(inside)
        if not len(where):
            return
        found = values[where]
        if self.leaf.reduce is None:
            self.value = float(found[0])
        elif self.leaf.reduce == "min":
            self.value = min(self.value, float(found.min()))
        else:
            self.value = max(self.value, float(found.max()))
        below = found < 0
        if self.violated is None and below.any():
            self.violated = max(int(starts[where[int(below.argmax())]]), self._begin)
