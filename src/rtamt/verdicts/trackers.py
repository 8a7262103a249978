"""The value of a formula at the first instant, and where it is first violated, from its leaves' signals."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from rtamt.language.formula import Var
from rtamt.lazy.modules import np
from rtamt.signals.discrete import DiscreteTrace
from rtamt.signals.episodes import place_in

if TYPE_CHECKING:
    from collections.abc import Sequence

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
        return self._values([self._anchored.skeleton], evaluate)[0]

    def violation(self, evaluate: Evaluate) -> int | None:
        """Return the first position at which the formula, a truth, is violated; None where it holds.

        That is the earliest one at which a part that must hold is violated. A part that is no window of
        ``always`` is violated at the first instant.
        """
        if self.value(evaluate) > 0:
            return None
        found: list[int] = []
        others: list[Formula] = []
        for part in self._anchored.conjuncts():
            tracker = self._tracker(part)
            if tracker is None or tracker.leaf.reduce != "min":
                others.append(part)
            elif tracker.violated is not None:
                found.append(tracker.violated)
        if not all(value > 0 for value in self._values(others, evaluate)):
            found.append(0)
        return min(found)

    def _tracker(self, part: Formula) -> Tracker | None:
        """Return the tracker of the leaf that a part of the skeleton is, if it is one."""
        return self.leaves[int(part.name[1:])] if isinstance(part, Var) else None

    def _values(self, parts: Sequence[Formula], evaluate: Evaluate) -> list[float]:
        """Return the values of parts of the skeleton; what is no leaf is evaluated in one program."""
        asked = tuple(dict.fromkeys(part for part in parts if not isinstance(part, Var)))
        known: dict[Formula, float] = {}
        if asked:
            columns = {f"#{i}": np.array([tracker.value]) for i, tracker in enumerate(self.leaves)}
            signals = evaluate(asked, DiscreteTrace(np.zeros(1), columns, Fraction(1)))
            known = {part: float(signal.values[0]) for part, signal in zip(asked, signals, strict=True)}
        trackers = map(self._tracker, parts)
        return [
            known[part] if tracker is None else tracker.value
            for part, tracker in zip(parts, trackers, strict=True)
        ]
