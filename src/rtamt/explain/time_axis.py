"""A recording in cells: formulas over it and over stand-ins for predicates, and times back and forth."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from fractions import Fraction
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.engine.domains import engine_of
from rtamt.errors import UsageError
from rtamt.explain.instants import StepFunction
from rtamt.language.formula import Apply, postorder
from rtamt.language.units import decimal
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.horizon import reach
from rtamt.rewrite.structure import NEVER
from rtamt.signals.datetimes import nanoseconds_of
from rtamt.signals.dense import Dense, DenseTrace
from rtamt.signals.discrete import Discrete, DiscreteTrace
from rtamt.signals.epoch import is_epoch, moment_text

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from rtamt.language.formula import Formula
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.dense_arrays import Samples
    from rtamt.signals.domain_interface import DomainTrace, TimeDomain

    #: From a function of cells for each variable to one for each formula.
    Runner = Callable[[Mapping[str, StepFunction]], list[StepFunction]]


class Timeline(ABC):
    """The cells of a recording: ``period`` is the seconds from one to the next, ``end`` how many there are.

    Formulas go to the back end of the specification: the engine, or the definition.
    """

    period: Fraction
    end: int

    @abstractmethod
    def measured(self, formulas: Sequence[Formula]) -> list[StepFunction]:
        """Evaluate formulas over the recording."""

    @abstractmethod
    def runner(self, formulas: Sequence[Formula]) -> Runner:
        """Prepare to evaluate core formulas (in cells) again and again, over other signals each time."""

    @abstractmethod
    def cell(self, at: Any) -> int:
        """Return the cell of a time as the caller tells it; raise :class:`UsageError` outside the recording."""

    @abstractmethod
    def later(self, time: Any) -> int:
        """Return the cell of a time that came out of this trace; it may be after its end."""

    @abstractmethod
    def time(self, cell: int) -> Any:
        """Return the time of a cell as the caller tells it; None where there is none so late."""

    @abstractmethod
    def show(self, cell: int) -> str:
        """Return the time of a cell for a sentence."""

    @property
    @abstractmethod
    def last(self) -> int:
        """The last cell that was recorded."""

    @abstractmethod
    def closes(self, end: int, formula: Formula, at: int) -> bool:
        """Return whether an interval of cells up to ``end`` is better told by its last cell than by ``end``.

        It is part of the answer to why the formula has its verdict at the cell ``at``.
        """


class DiscreteTimeline(Timeline):
    """Cells are samples."""

    def __init__(self, recording: DiscreteTrace, backend: str) -> None:
        self._recording = recording
        self._backend = engine_of(recording.domain).backends[backend]
        self.period = recording.period
        self.end = len(recording)

    def measured(self, formulas: Sequence[Formula]) -> list[StepFunction]:
        """See :class:`Timeline`."""
        evaluator = self._evaluator([desugar(formula) for formula in formulas])
        return [StepFunction.of_samples(values) for values in evaluator(self._recording)]

    def runner(self, formulas: Sequence[Formula]) -> Runner:
        """See :class:`Timeline`."""
        evaluator = self._evaluator(formulas)

        def run(signals: Mapping[str, StepFunction]) -> list[StepFunction]:
            columns = {name: self._samples(steps) for name, steps in signals.items()}
            recording = DiscreteTrace(self._recording.times, columns, self.period)
            return [StepFunction.of_samples(values) for values in evaluator(recording)]

        return run

    def _evaluator(self, formulas: Sequence[Formula]) -> Callable[[DiscreteTrace], Sequence[FloatArray]]:
        names = tuple(self._recording.columns)
        return self._backend.evaluator(tuple(formulas), self.period, names)

    def _samples(self, steps: StepFunction) -> np.ndarray[Any, Any]:
        return np.repeat(steps.values, np.diff(steps.changes, append=self.end))

    def cell(self, at: Any) -> int:
        """See :class:`Timeline`."""
        return self._recording.position(at)

    def later(self, time: Any) -> int:
        """See :class:`Timeline`."""
        return self.cell(time)

    def time(self, cell: int) -> Any:
        """See :class:`Timeline`."""
        return self._recording.time(cell)

    def show(self, cell: int) -> str:
        """See :class:`Timeline`."""
        stamps = self._recording.stamps
        if stamps.dtype.kind in "mM":
            seconds = [Fraction(nanoseconds_of(stamps[i]) or 0, 10**9) for i in (0, cell)]
        else:
            seconds = [Fraction(repr(float(self._recording.times[i]))) for i in (0, cell)]
        if stamps.dtype.kind == "M" or is_epoch(seconds[0]):
            return moment_text(seconds[1], seconds[0])
        return self._recording.show(cell)

    @property
    def last(self) -> int:
        """See :class:`Timeline`."""
        return self.end - 1

    def closes(self, end: int, formula: Formula, at: int) -> bool:  # noqa: ARG002 - samples are all there is
        """See :class:`Timeline`."""
        return True


class DenseTimeline(Timeline):
    """Cells are ticks, from the recording's start on for ever: the last values hold."""

    def __init__(self, recording: DenseTrace, backend: str) -> None:
        self._recording = recording
        self._backend = engine_of(recording.domain).backends[backend]
        self._start = recording.start
        self.period = recording.scale.tick
        self.end = NEVER
        self._last = recording.end - self._start
        self._grains: dict[Formula, int] = {}
        if self._last >= NEVER // 2:
            raise UsageError(
                "the recording has too many ticks to be explained; choose a coarser resolution, such as "
                "resolution='1us'"
            )

    def measured(self, formulas: Sequence[Formula]) -> list[StepFunction]:
        """See :class:`Timeline`."""
        found = self._evaluator([desugar(formula) for formula in formulas])(self._recording.columns)
        return [StepFunction(ticks - self._start, values, NEVER) for ticks, values in found]

    def runner(self, formulas: Sequence[Formula]) -> Runner:
        """See :class:`Timeline`."""
        evaluator = self._evaluator(formulas)

        def run(signals: Mapping[str, StepFunction]) -> list[StepFunction]:
            columns = {name: (steps.changes, steps.values) for name, steps in signals.items()}
            return [StepFunction(ticks, values, NEVER) for ticks, values in evaluator(columns)]

        return run

    def _evaluator(self, formulas: Sequence[Formula]) -> Callable[[Mapping[str, Samples]], Sequence[Samples]]:
        """Return what evaluates formulas as far as anything can change, after the recording's end too."""
        after = min(max(reach(formula, self.period) for formula in formulas), NEVER)
        evaluator: Callable[[DenseTrace], Sequence[Samples]] | None = None

        def evaluated(columns: Mapping[str, Samples]) -> Sequence[Samples]:
            nonlocal evaluator
            if evaluator is None:
                evaluator = self._backend.evaluator(tuple(formulas), self.period, tuple(columns))
            recording = DenseTrace(columns, self._recording.scale)
            return evaluator(recording.held_until(recording.end + after))

        return evaluated

    def cell(self, at: Any) -> int:
        """See :class:`Timeline`."""
        return self._recording.position(at)

    def later(self, time: Any) -> int:
        """See :class:`Timeline`."""
        return int(self._recording.scale.widened([[time]]).ticks([time], "at")[0]) - self._start

    def time(self, cell: int) -> Any:
        """See :class:`Timeline`."""
        if cell >= NEVER // 2:
            return None
        return self._recording.time(cell)

    def show(self, cell: int) -> str:
        """See :class:`Timeline`."""
        scale = self._recording.scale
        start = self._recording.start * scale.tick
        if scale.kind == "zoned":
            return f"{self._recording.show(cell)} (+{decimal(cell * scale.tick)} s)"
        if scale.kind == "datetimes" or is_epoch(start):
            return moment_text(start + cell * scale.tick, start)
        return self._recording.show(cell)

    @property
    def last(self) -> int:
        """See :class:`Timeline`."""
        return self._last

    def closes(self, end: int, formula: Formula, at: int) -> bool:
        """See :class:`Timeline`.

        [2 s, 5 s] and [2 s, 5 s + 1 tick) are the same ticks, as are [2 s, 5 s) and [2 s, 5 s - 1 tick]. What
        is meant is the end on the grid that all samples and bounds, and the instant asked for, share.
        """
        grain = self._grains.get(formula)
        if grain is None:
            grain = self._grains[formula] = self._grain(formula)
        grain = math.gcd(grain, at + self._start)
        return (end + self._start) % grain != 0 == (end + self._start - 1) % grain

    def _grain(self, formula: Formula) -> int:
        """Return the ticks from line to line of the finest grid that holds all samples and bounds."""
        grain = math.gcd(*(int(np.gcd.reduce(ticks)) for ticks, _ in self._recording.columns.values()))
        for node in postorder(formula):
            if isinstance(node, Apply) and node.interval is not None:
                bounds = node.interval.begin, node.interval.end or 0
                grain = math.gcd(grain, *(int(bound / self.period) for bound in bounds))
        return grain or 1


_TIMELINES: Mapping[type[TimeDomain], Callable[[Any, str], Timeline]] = MappingProxyType(
    {Discrete: DiscreteTimeline, Dense: DenseTimeline}
)


def timeline(recording: DomainTrace, backend: str) -> Timeline:
    """Return the cells of a recording."""
    return _TIMELINES[type(recording.domain)](recording, backend)
