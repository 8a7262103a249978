"""The definitions of verdicts and bounds behind the interface that laws compare."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt import Interval, Verdict, VerdictRun
from rtamt.compiler.graph import FOREVER
from rtamt.language.contents import variables
from rtamt.language.definitions.enclosures import Enclosure
from rtamt.lazy.dataclasses import replace
from rtamt.reference import dense_bounds, discrete_bounds, discrete_causation, eager_verdicts
from rtamt.reference.dense_bounds import DenseKnowledge
from rtamt.reference.discrete_bounds import ANYTHING, Knowledge
from rtamt.signals.dense import Dense
from tests.laws.early import causation_grid

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rtamt import Causation
    from rtamt.language.formula import Formula
    from rtamt.reference.dense_bounds import StepBounds
    from tests.laws.early.cases import Range

PERIOD = TICK = Fraction(1)
SECONDS = Dense(TICK)


@dataclass(frozen=True)
class Implementation:
    """How monitors are made: of a formula, its variables, declared ranges, and in discrete time the lateness.

    Times are whole seconds: the period and the tick are 1 s. A monitor of bounds has ``update(t, x=…)``, which
    takes a number, bounds or None (missing), ``interval(t)`` and ``finish()``; one of verdicts has
    ``update`` and ``finish``, which return lists of ``Verdict``, in dense time of ``VerdictRun``; one of causation
    has ``update``, which returns what a sample causes at the start, and ``causation(t)``, in dense time also
    ``watermark(t)`` and ``finish()``, which return the same as ``update``.
    """

    name: str
    interval: Callable[[Formula, tuple[str, ...], Mapping[str, Range], int], Any]
    eager: Callable[[Formula, tuple[str, ...], Mapping[str, Range]], Any]
    causation: Callable[[Formula], Any]
    #: Also with a lateness and whether to replay corrections.
    dense_interval: Callable[..., Any]
    dense_eager: Callable[[Formula, tuple[str, ...], Mapping[str, Range]], Any]
    dense_causation: Callable[[Formula], Any]
    #: The back end of specifications, if it is one.
    backend: str | None = None


def bounds_of(value: Any, limits: Range) -> Range:
    if value is None:
        return limits
    return value if isinstance(value, tuple) else (value, value)


class _Discrete:
    """What all monitors of the definition share in discrete time: the samples so far."""

    def __init__(
        self, formula: Formula, names: tuple[str, ...], ranges: Mapping[str, Range], _lateness: int = 0
    ) -> None:
        self._formula, self._names, self._ranges = formula, names, ranges
        self._rows: dict[int, dict[str, Range]] = {}
        self._finished = False

    def _take(self, t: int, values: Mapping[str, Any]) -> None:
        self._rows[t] = {name: bounds_of(v, self._limits(name)) for name, v in values.items()}

    def _limits(self, name: str) -> Range:
        return self._ranges.get(name, ANYTHING)

    @property
    def known(self) -> Knowledge:
        n = max(self._rows, default=-1) + 1
        columns = {}
        for name in self._names:
            ends = [self._rows[i][name] if i in self._rows else self._limits(name) for i in range(n)]
            columns[name] = Enclosure(*(np.array([each[k] for each in ends], float) for k in (0, 1)))
        return Knowledge(columns, n, self._ranges, self._finished)


class _Intervals(_Discrete):
    _found: Enclosure | None = None

    def update(self, t: int, **values: Any) -> None:
        self._take(t, values)
        self._found = None

    def interval(self, t: int = 0) -> Interval:
        if self._found is None:
            self._found = discrete_bounds.bounds(self._formula, self.known, PERIOD)
        found = self._found
        i = min(t, len(found.lower) - 1)
        return Interval(float(found.lower[i]), float(found.upper[i]))

    def finish(self) -> None:
        self._finished = True
        self._found = None


class _Eager(_Discrete):
    def __init__(self, formula: Formula, names: tuple[str, ...], ranges: Mapping[str, Range]) -> None:
        super().__init__(formula, names, ranges)
        self._found: list[Enclosure] = []

    def update(self, t: int, **values: Any) -> list[Verdict]:
        self._take(t, values)
        return self._reported()

    def finish(self) -> list[Verdict]:
        self._finished = True
        return self._reported()

    def _reported(self) -> list[Verdict]:
        found = eager_verdicts.verdicts(self._formula, self.known, PERIOD, self._found)
        return [Verdict(*each) for each in found[-1]]


class _Causes(_Discrete):
    def __init__(self, formula: Formula) -> None:
        super().__init__(formula, variables(formula), {})
        self._found: list[Causation] = []

    def update(self, t: int, **values: Any) -> Causation:
        self._take(t, values)
        self._found = []
        return self.causation(0)

    def causation(self, t: int) -> Causation:
        if t >= len(self._found):
            until = max(t, len(self._rows)) if t else 0  # at first the start alone is asked for
            self._found = discrete_causation.causation(self._formula, self.known, PERIOD, until + 1)
        return self._found[t]


class _Dense:
    """The same in dense time."""

    def __init__(self, formula: Formula, names: tuple[str, ...], ranges: Mapping[str, Range]) -> None:
        self._formula, self._names, self._ranges = formula, names, ranges
        self._updates: list[tuple[int, dict[str, Range]]] = []
        self._finished = False

    def _take(self, t: int, values: Mapping[str, Any]) -> None:
        row = {name: bounds_of(v, self._ranges.get(name, ANYTHING)) for name, v in values.items()}
        self._updates.append((t, row))


class _DenseIntervals(_Dense):
    """Bounds; with a lateness, from what each tick by itself is known to be."""

    def __init__(
        self,
        formula: Formula,
        names: tuple[str, ...],
        ranges: Mapping[str, Range],
        lateness: int | None = None,
        *,
        replay: bool = False,
    ) -> None:
        super().__init__(formula, names, ranges)
        self._lateness = 0 if replay and lateness is None else lateness
        self._mark: int | None = None
        self._found: StepBounds | None = None

    def update(self, t: int, **values: Any) -> None:
        self._take(t, values)
        self._found = None

    def watermark(self, t: int) -> None:
        self._mark = t if self._mark is None else max(t, self._mark)
        self._found = None

    def finish(self) -> None:
        self._finished = True
        self._found = None

    @property
    def known(self) -> DenseKnowledge:
        if self._lateness is None and self._mark is None:
            return eager_verdicts.after(self._updates, self._names, self._ranges, finished=self._finished)
        samples: dict[str, dict[int, Range]] = {name: {} for name in self._names}
        for t, row in self._updates:
            for name, bounds in row.items():
                samples[name][t] = bounds
        newest = max((t for t, _ in self._updates), default=-FOREVER)
        late = -FOREVER if self._lateness is None else newest - self._lateness - 1
        closed = max(late, -FOREVER if self._mark is None else self._mark)
        columns: dict[str, Any] = {}
        for name, own in samples.items():
            known = max([closed, *(own if self._lateness is None else ())])
            if not own or (min(own) > known + 1 and not self._finished):
                columns[name] = (), (), ()
                continue
            ticks = range(min(own), max(newest, known, *own) + 2)
            ends = [self._at(own, name, t, known) for t in ticks]
            columns[name] = ticks, [low for low, _ in ends], [high for _, high in ends]
        every = dict.fromkeys(self._names, FOREVER)
        return DenseKnowledge(columns, self._ranges, self._finished, every)

    def _at(self, samples: Mapping[int, Range], name: str, t: int, known: int) -> Range:
        if t in samples:
            return samples[t]
        if t > known and not self._finished:
            return self._ranges.get(name, ANYTHING)
        return samples[max(each for each in samples if each < t)]

    @property
    def _steps(self) -> StepBounds:
        if self._found is None:
            self._found = dense_bounds.bounds(self._formula, self.known, TICK)
        return self._found

    @property
    def started(self) -> bool:
        return self.known.start is not None

    def start(self) -> Interval:
        return Interval(*self._steps.at(self._steps.times[0]))

    def interval(self, t: int) -> Interval:
        return Interval(*self._steps.at(t))


class _DenseEager(_Dense):
    def __init__(self, formula: Formula, names: tuple[str, ...], ranges: Mapping[str, Range]) -> None:
        super().__init__(formula, names, ranges)
        self._found: list[StepBounds | None] = []

    def update(self, t: int, **values: Any) -> list[VerdictRun]:
        self._take(t, values)
        return self._reported()

    def finish(self) -> list[VerdictRun]:
        self._finished = True
        return self._reported()

    def _reported(self) -> list[VerdictRun]:
        found = eager_verdicts.dense_verdicts(
            self._formula,
            self._updates,
            self._names,
            TICK,
            self._ranges,
            finished=self._finished,
            found=self._found,
        )
        return [VerdictRun(*run) for run in eager_verdicts.runs(found[-1])]


class _DenseCauses(_DenseIntervals):
    """Causation by brute force."""

    def __init__(self, formula: Formula) -> None:
        super().__init__(formula, variables(formula), {})
        self._last: list[Causation] | None = None

    def update(self, t: int, **values: Any) -> Causation:
        before = self._known
        self._take(t, values)
        return self._look(before)

    def watermark(self, t: int) -> Causation:
        before = self._known
        self._mark = t if self._mark is None else max(t, self._mark)
        return self._look(before)

    def finish(self) -> Causation:
        before = self._known
        self._finished = True
        return self._look(before)

    @property
    def _known(self) -> DenseKnowledge:
        found = eager_verdicts.after(self._updates, self._names, {}, finished=self._finished)
        marks = {}
        for name, (times, _, _) in found.samples.items():
            marks[name] = max([*times[-1:], *([] if self._mark is None else [self._mark])], default=-FOREVER)
        return replace(found, closed=marks)

    def _look(self, before: DenseKnowledge) -> Causation:
        known = self._known
        self._start = known.start
        self._last = (
            None if known.start is None else causation_grid.on_grid(self._formula, before, known, TICK)
        )
        return self.causation(known.start or 0)

    def causation(self, t: int) -> Causation:
        if self._last is None or self._start is None:
            return causation_grid.NOTHING
        return self._last[min(t - self._start, len(self._last) - 1)]


DEFINITION = Implementation(
    "definition", _Intervals, _Eager, _Causes, _DenseIntervals, _DenseEager, _DenseCauses
)
