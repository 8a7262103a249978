"""Intervals of predicates and the samples that they read, as data and in words."""

from __future__ import annotations

from bisect import bisect_right
from itertools import accumulate
from math import isinf
from typing import TYPE_CHECKING

from rtamt.explain.explanation import Listed, Reading, Stretch
from rtamt.explain.readings import Readings
from rtamt.explain.wording import predicate_text, reading
from rtamt.language.contents import types_of, variables
from rtamt.language.formula import Var
from rtamt.language.value_types import value_text
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.modules import np
from rtamt.rewrite.structure import NEVER
from rtamt.signals.instants import NONE, Cells

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from rtamt.engine import TimeAxis
    from rtamt.explain.explanation import CriticalPoint
    from rtamt.explain.intervals import Interval
    from rtamt.language.formula import Formula
    from rtamt.rewrite.structure import Structure
    from rtamt.signals.instants import StepFunction


class Description:
    """The description of the predicates of an explanation; ``cell``: the explained instant."""

    def __init__(
        self,
        formula: Formula,
        text: str | None,
        structure: Structure,
        axis: TimeAxis,
        values: Mapping[str, StepFunction],
        cell: int,
    ) -> None:
        self._formula = formula
        self._text = text
        self._structure = structure
        self._axis = axis
        self._values = values
        self._cell = cell
        self._dense = axis.end >= NEVER
        self._readings = Readings(axis, dense=self._dense)

    def with_source(self, point: CriticalPoint, cell: int) -> tuple[CriticalPoint, str]:
        """Return the critical point with the samples that determine its value, and their description."""
        if point.formula is None or point.decided_by == "constant":
            return point, ""
        found = self._readings.source(point.formula, cell)
        text = self._in_words(point.formula, Cells.of([(cell, cell + 1)]), found)
        if self._dense and found:
            steps = dict(zip(found, self._axis.measured([Var(name) for name in found]), strict=True))
            found = {
                name: Cells.of(
                    steps[name].around(start) if end == start + 1 else (start, end) for start, end in cells
                )
                for name, cells in found.items()
            }
        recorded = self._recorded_values(point.formula, (point.value,), found)
        return replace(point, reads=self._as_data(found), recorded=recorded), text

    def stretch(self, interval: Interval, *, satisfied: bool) -> tuple[Stretch, str, str]:
        """Return an interval of the implicant as data, and in words when it is and what it reads."""
        leaf = self._structure.leaves[interval.name]
        holds = satisfied == (interval.sign > 0)
        here = Cells.of([(interval.start, interval.end)])
        read = self._readings.of(leaf.formula, *((here, NONE) if holds else (NONE, here)))
        _, values = self._values[leaf.name].between(interval.start, interval.end)
        start, stop, closed = self._ends(interval.start, interval.end)
        stretch = Stretch(
            predicate_text(leaf.formula, self._text),
            leaf.formula,
            holds,
            start,
            stop,
            closed,
            float(values.min()),
            float(values.max()),
            self._as_data(read),
            self._recorded_values(leaf.formula, values, read),
        )
        return stretch, self._when(interval.start, interval.end), self._in_words(leaf.formula, here, read)

    def _recorded_values(self, predicate: Formula, values: Iterable[float], read: Mapping[str, Cells]) -> str:
        """Return the Booleans and members that a predicate of truth reads."""
        types = {name: type_ for name, type_ in types_of(predicate).items() if name in read}
        if not types or not all(map(isinf, values)):
            return ""
        found = []
        steps = self._axis.measured([Var(name) for name in types])
        for (name, type_), step in zip(types.items(), steps, strict=True):
            pieces = read[name] & Cells(step.changes, np.append(step.changes[1:], step.end))
            recorded = step.each(pieces.starts).tolist()
            texts = dict.fromkeys(value_text(value, type_) or f"{value:g}" for value in recorded)
            found.append(f"{name} is {' or '.join(texts)}")
        return ", ".join(found)

    def _ends(self, start: int, end: int) -> tuple[object, object, bool]:
        """Return the times at which an interval of cells begins and ends, and whether the end belongs to it."""
        closed = self._closed(end)
        stop = None if end >= NEVER else self._axis.time(end - 1 if closed else end)
        return self._axis.time(start), stop, closed

    def _closed(self, end: int) -> bool:
        return end < NEVER and self._axis.closes(end, self._formula, self._cell)

    def _as_data(self, read: Mapping[str, Cells]) -> Sequence[Reading]:
        names = sorted(read)
        firsts = [0, *accumulate(len(read[name]) for name in names)]

        def one(number: int) -> Reading:
            k = bisect_right(firsts, number) - 1
            cells, place = read[names[k]], number - firsts[k]
            return Reading(names[k], *self._ends(int(cells.starts[place]), int(cells.ends[place])))

        return Listed(firsts[-1], one)

    def _in_words(self, predicate: Formula, here: Cells, read: Mapping[str, Cells]) -> str:
        """Return what a predicate reads on some cells: nothing if that is its variables, on these cells."""

        def same(name: str) -> bool:
            return name in read and not len(read[name] - here) and not len(here - read[name])

        if all(map(same, variables(predicate))):
            return ""
        return reading((name, Listed(len(read[name]), self._time(read[name]))) for name in sorted(read))

    def _time(self, cells: Cells) -> Callable[[int], str]:
        return lambda place: self._when(int(cells.starts[place]), int(cells.ends[place]))

    def _when(self, start: int, end: int) -> str:
        show = self._axis.show
        if end >= NEVER:
            when = f"from {show(start)} on"
        elif not self._closed(end):
            when = f"from {show(start)} until {show(end)}"
        elif end - 1 == start:
            when = f"at {show(start)}"
        else:
            when = f"from {show(start)} to {show(end - 1)}"
        return when if start <= self._axis.last else f"{when} (after the last sample, whose values hold)"
