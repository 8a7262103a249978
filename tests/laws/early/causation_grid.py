"""Causation in dense time by brute force: literally by its definition, at every quarter of a tick.

Signals change at ticks alone, and so do bounds, so that a quarter inside a tick stands for all of its instants; windows
reach from there to the same place in other ticks. Nothing is shared with ``rtamt.reference.dense_causation`` but the
formula and the bounds.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from rtamt import Causation
from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Formula, postorder
from rtamt.language.operators import Tense
from rtamt.reference import dense_bounds
from rtamt.reference.cores import core_of

if TYPE_CHECKING:
    from collections.abc import Iterator
    from fractions import Fraction

    from rtamt.reference.dense_bounds import DenseKnowledge, StepBounds

QUARTERS = 4
INSIDE = 2  # the quarter that stands for a tick
NOTHING = Causation(inf, -inf)

#: An operand by its place, at a tick.
_Part = tuple[int, int]


def on_grid(formula: Formula, before: DenseKnowledge, now: DenseKnowledge, tick: Fraction) -> list[Causation]:
    """Return what the last event causes at the ticks of the trace: the last entry is that of all later ones.

    ``before`` and ``now``: what is known before and after the event, with which the trace has started.
    """
    core = core_of(formula, tick, continuous=True).formula
    return _Grid(formula, core, before, now, tick).of(core)


class _Grid:
    def __init__(
        self, formula: Formula, core: Formula, before: DenseKnowledge, now: DenseKnowledge, tick: Fraction
    ) -> None:
        start = now.start
        assert start is not None
        self._start, self._before, self._now, self._tick = start, before, now, tick
        self._formula = formula
        self._parts: dict[int, dict[Formula, StepBounds]] = {}  # by the identity of what is known
        last = max(max(int(times[-1]), now.until(name)) for name, (times, _, _) in now.samples.items())
        # Bounds of a count still change some ticks after the last known one.
        last = max(
            last, *(found.times[-1] for each in (before, now) for found in self._of_parts(each).values())
        )
        self._size = last - start + 2 + 2 * sum(map(self._reach, postorder(core)))
        self._found: dict[Formula, list[Causation]] = {}

    def _of_parts(self, known: DenseKnowledge) -> dict[Formula, StepBounds]:
        if id(known) not in self._parts:
            self._parts[id(known)] = dense_bounds.bounds_of_parts(self._formula, known, self._tick)
        return self._parts[id(known)]

    def _bounds(self, node: Formula, known: DenseKnowledge) -> list[tuple[float, float]]:
        found = self._of_parts(known)[node]
        first = self._start if known.start is not None else 0
        return [found.at(first + k) for k in range(self._size)]

    def of(self, node: Formula) -> list[Causation]:
        if node not in self._found:
            self._found[node] = self._of(node)
        return self._found[node]

    def _of(self, node: Formula) -> list[Causation]:
        now = self._bounds(node, self._now)
        if not isinstance(node, Apply) or node.op.name not in _ALTERNATIVES:
            if any(isinstance(each, Apply) and each.op.tense is not Tense.NONE for each in postorder(node)):
                pairs = zip(now, self._bounds(node, self._before), strict=True)
                return [
                    Causation(high if high < top else inf, low if low > bottom else -inf)
                    for (low, high), (bottom, top) in pairs
                ]
            new = self._new(node)
            return [Causation(high, low) if k in new else NOTHING for k, (low, high) in enumerate(now)]
        if _ALTERNATIVES[node.op.name] is None:
            return [Causation(-each.satisfaction, -each.violation) for each in self.of(node.args[0])]
        operands = [self.of(arg) for arg in node.args]
        limits = [self._bounds(arg, self._now) for arg in node.args]
        result = []
        for k, (_, upper) in enumerate(now):
            begin, end = self._interval(node)
            viol, sat, ways = inf, -inf, 0
            for parts in _ALTERNATIVES[node.op.name](QUARTERS * k + INSIDE, begin, end):
                each = [(i, min(t, self._size - 1)) for i, t in parts]
                if not each:
                    continue
                ways += 1
                viol = min(viol, *(operands[i][t].violation for i, t in each))
                all_of_them = min(limits[i][t][0] for i, t in each)
                sat = max(sat, min(max(operands[i][t].satisfaction for i, t in each), all_of_them))
            result.append(Causation(max(viol, upper), sat) if ways else NOTHING)
        return result

    def _new(self, node: Formula) -> set[int]:
        """Return the ticks at which the event has made a variable of a predicate known."""
        found = set()
        for k in range(self._size):
            for name in variables(node):
                now = _is_known(self._now, name, self._start + k)
                if now and not (
                    self._before.start is not None and _is_known(self._before, name, self._start + k)
                ):
                    found.add(k)
        return found

    def _interval(self, node: Apply) -> tuple[int, int]:
        if node.interval is None:
            return 0, QUARTERS * self._size
        begin, end = node.interval.begin / self._tick, node.interval.end
        return int(begin) * QUARTERS, QUARTERS * (self._size if end is None else int(end / self._tick))

    def _reach(self, node: Formula) -> int:
        if not isinstance(node, Apply) or node.interval is None:
            return 0
        begin, end = node.interval.begin, node.interval.end
        return int((begin if end is None else end) / self._tick)


def _is_known(known: DenseKnowledge, name: str, tick: int) -> bool:
    times = known.samples[name][0]
    return known.finished or tick in times or tick <= known.until(name)


def _while(begin: int, end: int) -> set[_Part]:
    """The first operand from a quarter up to, and without, another."""
    return {(0, u // QUARTERS) for u in range(begin, end)}


def _until(t: int, a: int, b: int) -> Iterator[set[_Part]]:
    for goal in range(t + a, t + b + 1):
        yield {(1, goal // QUARTERS), *_while(t, goal)}


def _since(t: int, a: int, b: int) -> Iterator[set[_Part]]:
    for goal in range(max(t - b, 0), t - a + 1):
        # The rest of the goal's own quarter comes after it.
        yield {(1, goal // QUARTERS), *(_while(goal, t + 1) if goal < t else ())}


def _precedes(t: int, a: int, b: int) -> Iterator[set[_Part]]:
    begin = max(t - b, 0)
    for goal in range(max(t - b + a, 0), t + 1):
        yield {(1, goal // QUARTERS), *_while(begin, goal)}


def _ahead(t: int, a: int, b: int) -> set[_Part]:
    return _while(t + a, t + b + 1)


def _behind(t: int, a: int, b: int) -> set[_Part]:
    return _while(max(t - b, 0), t - a + 1)


#: The ways in which an operator can hold at a quarter: what must hold together in each.
_ALTERNATIVES = {
    "neg": None,
    "and": lambda t, *_: [{(0, t // QUARTERS), (1, t // QUARTERS)}],
    "or": lambda t, *_: [{(0, t // QUARTERS)}, {(1, t // QUARTERS)}],
    "always": lambda *window: [_ahead(*window)],
    "eventually": lambda *window: [{part} for part in _ahead(*window)],
    "historically": lambda *window: [_behind(*window)],
    "once": lambda *window: [{part} for part in _behind(*window)],
    "until": _until,
    "since": _since,
    "precedes": _precedes,
}
_ALTERNATIVES |= {
    "not": _ALTERNATIVES["neg"],
    "min": _ALTERNATIVES["and"],
    "max": _ALTERNATIVES["or"],
    "minimum": _ALTERNATIVES["historically"],
    "maximum": _ALTERNATIVES["once"],
}
