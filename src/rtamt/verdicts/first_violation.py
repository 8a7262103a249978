"""Where a requirement is first violated, from signals that come whole or in chunks."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.engine.dense_evaluate import DenseRecording, reach
from rtamt.language.formula import Const, Var
from rtamt.language.operators import STL
from rtamt.rewrite.desugar import desugar
from rtamt.signals.arrays import Recording
from rtamt.signals.ticks import TimeScale, kind_of
from rtamt.verdicts.decompose import Anchored, Leaf, anchor

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from rtamt.language.formula import Formula
    from rtamt.results import Result
    from rtamt.signals.arrays import Signal
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
    anchored = anchor(spec.judged(spec.formula, "boolean"))
    unit = recording.period if isinstance(recording, Recording) else recording.scale.tick
    trackers = [Tracker(leaf, unit, not isinstance(recording, Recording)) for leaf in anchored.leaves]
    for tracker in trackers:
        formula = together(tracker.leaf.formula, tuple(recording.columns))
        if isinstance(recording, Recording):
            signal = spec.signal_of(formula, recording)
            tracker.take(np.arange(len(signal)), signal)
        else:
            signal = spec.signal_of(formula, settled(recording, formula))
            tracker.take(ticks_of(signal, unit) - recording.start, signal)
        tracker.finish()
    return violation_of(spec, anchored, trackers, result.signal.times[0])


def together(formula: Formula, names: Sequence[str]) -> Formula:
    """Return a formula with the same values that reads all the names: so several formulas begin and end together."""
    if not names:
        return formula
    everything: Formula = Var(names[0])
    for name in names[1:]:
        everything = STL["and"](everything, Var(name))
    return STL["and"](formula, STL["or"](Const(float("inf")), everything))


def ticks_of(signal: Signal, tick: Fraction) -> Positions:
    """Return the times of a dense robustness signal in ticks."""
    return TimeScale(tick, kind_of(signal.times)).ticks(signal.times, "robustness")


def settled(recording: DenseRecording, formula: Formula) -> DenseRecording:
    """Return a recording whose last values hold until the past windows of a formula have slid on over them."""
    end = recording.end + reach(desugar(formula), recording.scale.tick) + 1
    columns = {
        name: (np.append(ticks, end), np.append(values, values[-1]))
        for name, (ticks, values) in recording.columns.items()
    }
    return DenseRecording(columns, recording.scale)


def violation_of(spec: Specification, anchored: Anchored, trackers: Sequence[Tracker], first: Any) -> Any:
    """Return the earliest violation among the parts that must all hold; ``trackers``: of the leaves, in order."""
    found = []
    for part in anchored.conjuncts():
        leaf = anchored.leaf(part)
        if leaf is not None and leaf.reduce == "min":
            found += [t.violated for t in trackers if t.leaf == leaf and t.violated is not None]
        elif not value_of(spec, part, trackers) > 0:
            found.append(first)
    first_of_all = min(found)
    # numpy's numbers are for arrays; a date of nanoseconds has no counterpart in Python.
    return first_of_all if isinstance(first_of_all, np.datetime64) else first_of_all.item()


def value_of(spec: Specification, skeleton: Formula, trackers: Sequence[Tracker]) -> float:
    """Return the value of a skeleton, given those of its leaves."""
    columns = {f"#{i}": np.array([tracker.value]) for i, tracker in enumerate(trackers)}
    return float(spec.signal_of(skeleton, Recording(np.zeros(1), columns, Fraction(1))).values[0])


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
        self._first: Any = None
        self._pending: tuple[int, Any, float] | None = None
        self.value = float("-inf") if leaf.reduce == "max" else float("inf")
        #: The earliest instant of the window at which the value is below 0.
        self.violated: Any = None

    def take(self, positions: Positions, signal: Signal) -> None:
        """Take what became known of the leaf's formula."""
        if not len(positions):
            return
        times, values = signal.times, signal.values
        if self._pending is None:
            self._first = times[0]
        else:
            position, time, value = self._pending
            positions = np.concatenate(([position], positions))
            times, values = np.concatenate(([time], times)), np.concatenate(([value], values))
        self._reduce(positions[:-1], positions[1:], times, values)
        self._pending = (int(positions[-1]), times[-1], float(values[-1]))

    def finish(self) -> None:
        """Take the last value: nothing comes after it."""
        if self._pending is not None:
            position, time, value = self._pending
            stop = max(position, self._begin) + 1 if self._dense else position + 1
            self._reduce(np.array([position]), np.array([stop]), np.array([time]), np.array([value]))
            self._pending = None

    def _reduce(self, starts: Positions, stops: Positions, times: Any, values: Any) -> None:
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
            i = where[int(below.argmax())]
            late = starts[i] >= self._begin
            self.violated = times[i] if late else _later(self._first, self.leaf.begin)


def _later(time: Any, seconds: Fraction) -> Any:
    """Return a time some seconds later, in its own kind."""
    if isinstance(time, np.datetime64):
        return time + np.timedelta64(int(seconds * 10**9), "ns")
    return time + (int(seconds * 10**9) if isinstance(time, np.integer) else float(seconds))
