"""Explanations in dense time: a recording in ticks."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from rtamt.engine.dense.backends import BACKENDS
from rtamt.engine.time_axis import TimeAxis
from rtamt.errors import UsageError
from rtamt.language.formula import Apply, postorder
from rtamt.language.shares import rank_of
from rtamt.language.units.durations import decimal
from rtamt.lazy.modules import np
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.horizon import reach
from rtamt.rewrite.structure import NEVER
from rtamt.signals.dense import DenseTrace
from rtamt.signals.epoch import is_epoch, moment_text
from rtamt.signals.instants import StepFunction

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from rtamt.engine.time_axis import Runner
    from rtamt.language.formula import Formula
    from rtamt.signals.dense_arrays import Samples


class DenseTimeAxis(TimeAxis):
    """Cells are ticks, from the recording's start on for ever: the last values hold."""

    def __init__(self, recording: DenseTrace, backend: str) -> None:
        self._recording = recording
        self._backend = BACKENDS[backend]
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
        """See :class:`TimeAxis`."""
        found = self._evaluator([desugar(formula) for formula in formulas])(self._recording.columns)
        return [StepFunction(ticks - self._start, values, NEVER) for ticks, values in found]

    def runner(self, formulas: Sequence[Formula]) -> Runner:
        """See :class:`TimeAxis`."""
        evaluator = self._evaluator(formulas)

        def run(signals: Mapping[str, StepFunction]) -> list[StepFunction]:
            columns = {name: (steps.changes, steps.values) for name, steps in signals.items()}
            return [StepFunction(ticks, values, NEVER) for ticks, values in evaluator(columns)]

        return run

    def _evaluator(self, formulas: Sequence[Formula]) -> Callable[[Mapping[str, Samples]], Sequence[Samples]]:
        """Return the evaluator of formulas as far as anything can change, also after the recording's end."""
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
        """See :class:`TimeAxis`."""
        return self._recording.position(at)

    def later(self, time: Any) -> int:
        """See :class:`TimeAxis`."""
        return self._recording.later(time)

    def time(self, cell: int) -> Any:
        """See :class:`TimeAxis`."""
        if cell >= NEVER // 2:
            return None
        return self._recording.time(cell)

    def show(self, cell: int) -> str:
        """See :class:`TimeAxis`."""
        scale = self._recording.scale
        start = self._recording.start * scale.tick
        if scale.kind == "zoned":
            return f"{self._recording.show(cell)} (+{decimal(cell * scale.tick)} s)"
        if scale.kind == "datetimes" or is_epoch(start):
            return moment_text(start + cell * scale.tick, start)
        return self._recording.show(cell)

    @property
    def last(self) -> int:
        """See :class:`TimeAxis`."""
        return self._last

    def closes(self, end: int, formula: Formula, at: int) -> bool:
        """See :class:`TimeAxis`.

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
            if isinstance(node, Apply) and node.interval is not None and not node.interval.implied:
                bounds = node.interval.begin, node.interval.end or 0
                grain = math.gcd(grain, *(int(bound / self.period) for bound in bounds))
                if node.op.share:
                    grain = math.gcd(grain, rank_of(node.interval, self.period, continuous=True).k)
        return grain or 1
