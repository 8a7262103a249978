"""Explanations in discrete time: a recording in samples."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from rtamt.engine.discrete.backends import BACKENDS
from rtamt.engine.time_axis import TimeAxis
from rtamt.language.formula import Apply, Formula, Var, folds
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.modules import np
from rtamt.rewrite.check import reads_unbounded_future
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.structure import settling
from rtamt.signals.datetimes import nanoseconds_of
from rtamt.signals.discrete import DiscreteTrace
from rtamt.signals.epoch import is_epoch, moment_text
from rtamt.signals.instants import StepFunction
from rtamt.signals.shortened import Shortened

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from rtamt.engine.time_axis import Runner
    from rtamt.signals.arrays import FloatArray


class DiscreteTimeAxis(TimeAxis):
    """Cells are samples."""

    def __init__(self, recording: DiscreteTrace, backend: str) -> None:
        self._recording = recording
        self._backend = BACKENDS[backend]
        self.period = recording.period
        self.end = len(recording)

    def measured(self, formulas: Sequence[Formula]) -> list[StepFunction]:
        """See :class:`TimeAxis`."""
        evaluator = self._evaluator([desugar(formula) for formula in formulas])
        return [StepFunction.of_samples(values) for values in evaluator(self._recording)]

    def runner(self, formulas: Sequence[Formula]) -> Runner:
        """See :class:`TimeAxis`."""
        # The engine computes operands of unbounded operators before all else; those asked for are inputs instead.
        first, rest = _apart(formulas)
        evaluators = self._evaluator(list(first.values())), self._evaluator(list(rest.values()))
        margin = settling(formulas, self.period)

        def run(signals: Mapping[str, StepFunction]) -> list[StepFunction]:
            changes = sum(len(steps.changes) for steps in signals.values())
            if not changes or changes * 2 * margin >= self.end:
                return over(signals, self.end)
            short = Shortened.of(signals.values(), margin)
            found = over({name: short.of_function(steps) for name, steps in signals.items()}, short.end)
            return [short.back(steps) for steps in found]

        def over(signals: Mapping[str, StepFunction], end: int) -> list[StepFunction]:
            columns = {name: _samples(steps) for name, steps in signals.items()}
            found: dict[str, FloatArray] = {}
            for names, evaluator in zip((first, rest), evaluators, strict=True):
                recording = DiscreteTrace(self._recording.times[:end], {**columns, **found}, self.period)
                found.update(zip(names, evaluator(recording) if names else (), strict=True))
            return [StepFunction.of_samples(found[_name(number)]) for number in range(len(formulas))]

        return run

    def _evaluator(self, formulas: Sequence[Formula]) -> Callable[[DiscreteTrace], Sequence[FloatArray]]:
        names = tuple(self._recording.columns)
        return self._backend.evaluator(tuple(formulas), self.period, names)

    def cell(self, at: Any) -> int:
        """See :class:`TimeAxis`."""
        return self._recording.position(at)

    def later(self, time: Any) -> int:
        """See :class:`TimeAxis`."""
        return self.cell(time)

    def time(self, cell: int) -> Any:
        """See :class:`TimeAxis`."""
        return self._recording.time(cell)

    def show(self, cell: int) -> str:
        """See :class:`TimeAxis`."""
        timestamps = self._recording.timestamps
        if timestamps.dtype.kind in "mM":
            seconds = [Fraction(nanoseconds_of(timestamps[i]) or 0, 10**9) for i in (0, cell)]
        else:
            seconds = [Fraction(repr(float(self._recording.times[i]))) for i in (0, cell)]
        if timestamps.dtype.kind == "M" or is_epoch(seconds[0]):
            return moment_text(seconds[1], seconds[0])
        return self._recording.show(cell)

    @property
    def last(self) -> int:
        """See :class:`TimeAxis`."""
        return self.end - 1

    def closes(self, end: int, formula: Formula, at: int) -> bool:  # noqa: ARG002 - samples are all there is
        """See :class:`TimeAxis`."""
        return True


def _apart(formulas: Sequence[Formula]) -> tuple[dict[str, Formula], dict[str, Formula]]:
    """Return the formulas of bounded future, and the others over variables for these; each with its name."""

    def far(node: Formula, below: tuple[bool, ...]) -> bool:
        return any(below) or (isinstance(node, Apply) and reads_unbounded_future(node))

    later = folds(formulas, far)
    first = {_name(number): formula for number, formula in enumerate(formulas) if not later[number]}
    known = {formula: Var(name) for name, formula in first.items()} if any(later) else {}

    def over_known(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if node in known or not isinstance(node, Apply):
            return known.get(node, node)
        return replace(node, args=args)

    rest = folds(formulas, over_known)
    return first, {_name(number): rest[number] for number in range(len(formulas)) if later[number]}


def _name(number: int) -> str:
    return f"={number}"


def _samples(steps: StepFunction) -> np.ndarray[Any, Any]:
    if len(steps.changes) == steps.end:  # it changes with every sample
        return steps.values
    return np.repeat(steps.values, np.diff(steps.changes, append=steps.end))
