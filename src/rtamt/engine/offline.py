"""Offline: what is asked of a finished recording, how that is read, and what answers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rtamt.engine import dense_evaluate
from rtamt.engine.evaluate import Evaluator
from rtamt.errors import BoundError
from rtamt.reference import dense as dense_reference
from rtamt.reference import discrete as reference
from rtamt.rewrite.check import check_bounds
from rtamt.signals.dense import record_dense
from rtamt.signals.discrete import DiscreteTrace, record_discrete
from rtamt.signals.signal import Signal

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence
    from fractions import Fraction

    from rtamt.language.formula import Formula
    from rtamt.rewrite.semantics import PredicateSemantics
    from rtamt.signals.dense import DenseTrace


@dataclass(frozen=True, slots=True)
class Query:
    """A formula whose predicates are judged already, and the clock by which recordings are read.

    ``text``: what the formula was parsed from. ``step``: the sampling period in seconds (None: that of
    the stamps), in dense time the length of a tick. ``unit``: of times that are numbers (None: seconds).
    """

    formula: Formula
    text: str
    time: str
    step: Fraction | None
    semantics: str | PredicateSemantics
    unit: str | None = None

    def record(
        self, data: Any, names: Sequence[str], declared: Collection[str], tolerance: float
    ) -> DiscreteTrace | DenseTrace:
        """Normalise a finished recording of the variables ``names``; ``declared``: others that may be there.

        Raises :class:`TraceError`.
        """
        if self.time == "dense":
            assert self.step is not None
            return record_dense(data, names, self.step, declared, unit=self.unit)
        return record_discrete(data, names, self.step, declared, tolerance, self.unit)

    def check(self, recording: DiscreteTrace) -> None:
        """Raise :class:`BoundError` where an interval is no multiple of the recording's period."""
        try:
            check_bounds(self.formula, recording.period, self.text)
        except BoundError as error:
            if not recording.inferred:
                raise
            raise BoundError(
                f"{error.message} (the period was taken from the time stamps; period= sets it)",
                self.text,
                error.span,
            ) from None


class Evaluators:
    """What computes robustness signals on one back end; what it has compiled it keeps."""

    def __init__(self, backend: str) -> None:
        self._backend = backend
        self._discrete: dict[Any, Evaluator] = {}
        self._dense: dict[Any, dense_evaluate.Evaluator] = {}

    def __call__(self, formulas: tuple[Formula, ...], recording: DiscreteTrace | DenseTrace) -> list[Signal]:
        """Return the robustness signal of each formula over a recording, all from one program."""
        if isinstance(recording, DiscreteTrace):
            return self._samples(formulas, recording)
        return self._events(formulas, recording)

    def _samples(self, formulas: tuple[Formula, ...], recording: DiscreteTrace) -> list[Signal]:
        times, period = recording.times.view(), recording.period
        times.flags.writeable = False  # all signals of a recording share its times
        if self._backend == "python":
            n, start = len(recording), float(times[0])
            columns = [reference.evaluate(f, recording.columns, n, period, start) for f in formulas]
        else:
            key = (formulas, period.as_integer_ratio())  # fractions are slow to hash
            evaluator = self._discrete.get(key)
            if evaluator is None:
                evaluator = self._discrete[key] = Evaluator(formulas, period)
            columns = evaluator(recording)
        stamps = times if recording.told is None else recording.told.view()
        stamps.flags.writeable = False
        return [Signal(stamps, values) for values in columns]

    def _events(self, formulas: tuple[Formula, ...], recording: DenseTrace) -> list[Signal]:
        tick, inputs = recording.scale.tick, tuple(recording.columns)
        if self._backend == "python":
            steps = [dense_reference.evaluate(f, recording.columns, tick) for f in formulas]
            return [recording.signal(each.times, each.values) for each in steps]
        key = (formulas, tick.as_integer_ratio(), inputs)
        evaluator = self._dense.get(key)
        if evaluator is None:
            evaluator = dense_evaluate.Evaluator(formulas, tick, inputs)
            self._dense[key] = evaluator
        return [recording.signal(*events) for events in evaluator(recording)]
