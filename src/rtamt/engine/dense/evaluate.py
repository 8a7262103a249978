"""Evaluate formulas on a complete dense-time trace; every signal has its own time base."""

from __future__ import annotations

from rtamt.compiler.plan import DEFINED, Stage
from rtamt.compiler.shared import Shape
from rtamt.engine.direct import Direct
from rtamt.engine.native import calls_of, core, creation_error, culprit
from rtamt.engine.offline_bounds import bounded_signal, signal_bounds
from rtamt.engine.user_operators import defined_signal
from rtamt.language.undefined_value import UNNAMED, undefined, undefined_text
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.rewrite.horizon import reach
from rtamt.signals.arrays import TIME
from rtamt.signals.dense import Dense, DenseTrace
from rtamt.signals.sampling_period import merged
from rtamt.signals.signal import Signal
from rtamt.signals.ticks import TimeScale

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from rtamt.compiler.plan import Plan, Scan
    from rtamt.compiler.program import Program
    from rtamt.compiler.stored import StoredPlan
    from rtamt.engine.offline_bounds import StepBounds
    from rtamt.errors import EvaluationError
    from rtamt.language.formula import Formula
    from rtamt.signals.dense_arrays import Samples
    from rtamt.signals.outcomes import BoundedSignal


class Evaluator:
    """Evaluates the same formulas over recordings of ``inputs``, compiled once."""

    def __init__(self, formulas: Sequence[Formula], tick: Fraction, inputs: tuple[str, ...]) -> None:
        self._asked = tuple(formulas)
        # Variables that the formulas do not read also determine where the recording starts and ends.
        shape = Shape.of(formulas)
        self._plan = shape.plan(tick, domain=Dense, inputs=inputs)
        self._settled = settling(self._plan, shape.expanded(), tick)

    def __call__(self, recording: DenseTrace) -> list[Samples]:
        """Return the events of each formula from the recording's start on."""
        plan, columns = self._plan, dict(recording.columns)
        for stage in plan.stages:
            values = run(stage.program, columns, recording.scale, plan, self._asked, self._settled)
            for scan in stage.scans:
                operands = [values[i] for i in scan.outputs]
                if scan.kind == DEFINED:
                    columns[scan.name] = defined(scan, operands, recording, plan)
                else:
                    columns[scan.name] = core().dense_scan(scan.kind, *operands)
        return run(plan.program, columns, recording.scale, plan, self._asked)

    def direct(self, domain: Dense, recording: DenseTrace) -> Direct | None:
        """Return the direct evaluator of the only formula over data with times in seconds; None if there is none."""
        plan, names = self._plan, tuple(recording.columns)
        scale = TimeScale(domain.resolution, "seconds")
        places = {name: place for place, name in enumerate(names)}
        stages = []
        for stage in (*plan.stages, Stage(plan.program, ())):
            if stage.program.calls or any(scan.kind == DEFINED for scan in stage.scans):
                return None
            inputs = [places[name] for name in stage.program.inputs]
            scans = [(scan.kind, list(scan.outputs)) for scan in stage.scans]
            stages.append((stage.program.code(), inputs, scans))
            for scan in stage.scans:
                places[scan.name] = len(places)
        if scale.ticks_in_1 is None:
            return None
        evaluator = core().DenseDirectEvaluator(names, TIME, scale.ticks_in_1, self._settled, stages, Signal)
        return Direct(evaluator.run, lambda *_given: None, Reading(names, scale))


class Reading(NamedTuple):
    """The reading settings of the core's ``DenseDirectEvaluator``: variables, and times in seconds.

    What it returns is ``found``: memory of the samples, their numbers, and the robustness.
    """

    names: tuple[str, ...]
    scale: TimeScale

    def trace(self, found: Any) -> DenseTrace:
        """Return the recording."""
        memory, counts, _ = found
        columns, first = {}, 0
        for name, count in zip(self.names, counts, strict=True):
            ticks = np.frombuffer(memory, np.int64, count, first)
            columns[name] = ticks, np.frombuffer(memory, np.float64, count, first + 8 * count)
            first += 16 * count
        return DenseTrace(columns, self.scale)

    def signal(self, found: Any) -> Signal:
        """Return the robustness: a point for every change, and one at the end."""
        signal: Signal = found[2]
        return signal

    def samples(self, found: Any) -> int:
        """Return the number of samples of all variables."""
        return sum(found[1])


class StoredEvaluator(Evaluator):
    """Evaluates a plan without formulas."""

    def __init__(self, stored: StoredPlan) -> None:
        self._asked, self._plan, self._settled = (), stored.plan, stored.settled


def settling(plan: Plan, formulas: Sequence[Formula], tick: Fraction) -> int:
    """Return the ticks after the last sample for which the stages of a plan run.

    What unbounded future reads must have settled: past windows slide on after the last sample.
    """
    return max(reach(formula, tick) for formula in formulas) if plan.stages else 0


class BoundsEvaluator(Evaluator):
    """Evaluates bounds of the same formulas over recordings that are known in part."""

    def of_bounds(self, recording: DenseTrace) -> list[BoundedSignal]:
        """Return the bounds of each formula from the recording's start to its end."""
        plan, columns = self._plan, signal_bounds(recording)
        for stage in plan.stages:
            values = self._run(stage.program, columns, recording, self._settled)
            for scan in stage.scans:
                operands = [values[i] for i in scan.outputs]
                lower, upper = (
                    core().dense_scan(scan.kind, *((each[0], each[k]) for each in operands)) for k in (1, 2)
                )
                columns[scan.name] = _join(lower, upper)
        found = self._run(plan.program, columns, recording)
        return [bounded_signal(recording, *each) for each in found]

    def _run(
        self, program: Program, columns: Mapping[str, StepBounds], recording: DenseTrace, extra: int = 0
    ) -> list[StepBounds]:
        _core = core()
        inputs = [columns[name] for name in program.inputs]
        signals = [(ticks, np.stack((lower, upper), axis=1)) for ticks, lower, upper in inputs]
        try:
            found: list[StepBounds] = _core.dense_evaluate_bounds(program.code(), signals, extra)
        except _core.Undefined as error:
            raise _undefined(error, program, recording.scale, self._plan, self._asked) from None
        return found


def _join(lower: Samples, upper: Samples) -> StepBounds:
    """Return two step functions from the same instant on as one pair of bounds."""
    ticks = merged([lower[0], upper[0]])
    low, high = (values[own.searchsorted(ticks, "right") - 1] for own, values in (lower, upper))
    return ticks, low, high


def run(
    program: Program,
    columns: Mapping[str, Samples],
    scale: TimeScale,
    plan: Plan,
    asked: Sequence[Formula],
    extra: int = 0,
) -> list[Samples]:
    """Run one program of a plan, for what is ``asked``, over whole signals and ``extra`` ticks on."""
    _core = core()
    try:
        values: list[Samples] = _core.dense_evaluate(
            program.code(), [columns[name] for name in program.inputs], extra, calls_of(program)
        )
    except RuntimeError as error:
        raise creation_error(program, error) from None
    except _core.Undefined as error:
        raise _undefined(error, program, scale, plan, asked) from None
    return values


def _undefined(
    error: Exception, program: Program, scale: TimeScale, plan: Plan, asked: Sequence[Formula]
) -> EvaluationError:
    """Return the error for a value that does not exist."""
    where = f"time {scale.show(error.args[1])}"
    if program.metadata is not None:
        return undefined_text(program.metadata.meanings.get(error.args[0], UNNAMED), where)
    return undefined(culprit(error, program, asked, plan.original), where)


def defined(scan: Scan, operands: list[Samples], recording: DenseTrace, plan: Plan) -> Samples:
    """Return the values of a custom operator of unbounded future, by its definition."""
    assert scan.meaning is not None
    ticks, values = defined_signal(scan.meaning, recording.scale.tick, operands)
    wrong = np.flatnonzero(np.isnan(values) & (ticks <= recording.end))
    if len(wrong):
        where = f"time {recording.scale.show(int(ticks[wrong[0]]))}"
        raise undefined(plan.original(scan.meaning), where)
    return ticks, values
