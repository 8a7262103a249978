"""The value of a formula at the first instant, and where it is first violated, from its leaves' signals."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from rtamt.language.formula import Var
from rtamt.lazy_numpy import np
from rtamt.signals.discrete import DiscreteTrace
from rtamt.signals.episodes import place_in

if TYPE_CHECKING:
    from rtamt.language.formula import Formula
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.episodes import Positions
    from rtamt.verdicts.decompose import Anchored, Leaf
    from rtamt.verdicts.robustness_and_truth import Evaluate


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
        #: Of a minimum the earliest position of the window at which the value is below 0.
        self.violated: int | None = None

    def take(self, positions: Positions, values: FloatArray) -> None:
        """Take what became known of the leaf's formula."""
        if not len(positions):
            return
        if self._pending is not None:
            self._reduce_one(*self._pending, int(positions[0]))
        self._reduce(positions[:-1], positions[1:], values)
        self._pending = (int(positions[-1]), float(values[-1]))

    def finish(self) -> None:
        """Take the last value of the trace."""
        if self._pending is not None:
            position, value = self._pending
            stop = max(position, self._begin) + 1 if self._dense else position + 1
            self._reduce_one(position, value, stop)
            self._pending = None

    def _reduce_one(self, start: int, value: float, stop: int) -> None:
        self._reduce(range(start, start + 1), range(stop, stop + 1), np.array([value]))

    def _reduce(self, starts: Positions, stops: Positions, values: FloatArray) -> None:
        # Positions increase: those of the window are a slice, which costs no copy.
        first = place_in(stops, self._begin, "right")
        end = len(starts) if self._end is None else place_in(starts, self._end, "right")
        if first >= end:
            return
        found = values[first:end]
        if self.leaf.reduce is None:
            self.value = float(found[0])
        elif self.leaf.reduce == "max":
            self.value = max(self.value, float(found.max()))
        else:
            lowest = float(found.min())
            self.value = min(self.value, lowest)
            if self.violated is None and lowest < 0:
                place = first + int((found < 0).argmax())
                self.violated = max(int(starts[place]), self._begin)


class Trackers:
    """The leaves of one anchored formula over a trace.

    ``unit``: seconds of a period or tick. Hand on the signals of ``leaves``, then call :meth:`finish`.
    """

    def __init__(self, anchored: Anchored, unit: Fraction, dense: bool) -> None:
        self._anchored = anchored
        self.leaves = [Tracker(leaf, unit, dense) for leaf in anchored.leaves]

    def finish(self) -> None:
        """End the trace."""
        for tracker in self.leaves:
            tracker.finish()

    def value(self, evaluate: Evaluate) -> float:
        """Return the value of the formula at the first instant."""
        return self._value(self._anchored.skeleton, evaluate)

    def violation(self, evaluate: Evaluate) -> int | None:
        """Return the first position at which the formula, a truth, is violated; None where it holds.

        That is the earliest one at which a part that must hold is violated. A part that is no window of
        ``always`` is violated at the first instant.
        """
        if self.value(evaluate) > 0:
            return None
        found = []
        for part in self._anchored.conjuncts():
            leaf = self._anchored.leaf(part)
            if leaf is not None and leaf.reduce == "min":
                found += [t.violated for t in self.leaves if t.leaf == leaf and t.violated is not None]
            elif not self._value(part, evaluate) > 0:
                found.append(0)
        return min(found)

    def _value(self, skeleton: Formula, evaluate: Evaluate) -> float:
        if isinstance(skeleton, Var):
            return self.leaves[int(skeleton.name[1:])].value
        columns = {f"#{i}": np.array([tracker.value]) for i, tracker in enumerate(self.leaves)}
        (signal,) = evaluate((skeleton,), DiscreteTrace(np.zeros(1), columns, Fraction(1)))
        return float(signal.values[0])
