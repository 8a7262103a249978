"""Evaluate formulas on a complete discrete-time trace."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from rtamt.compiler.plan import DEFINED, Plan
from rtamt.compiler.shared import Shape
from rtamt.engine.cores import threads
from rtamt.engine.direct import Direct
from rtamt.engine.discrete.recording import Reading, frame_columns
from rtamt.engine.native import calls_of, core, creation_error, culprit
from rtamt.language.formula import Apply, postorder
from rtamt.language.undefined_value import UNNAMED, at_sample, undefined, undefined_text
from rtamt.lazy.modules import np
from rtamt.signals.arrays import TIME
from rtamt.signals.sampling_period import RegularTimes, StoredTimes
from rtamt.signals.signal import Signal

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from fractions import Fraction

    from numpy.typing import NDArray

    from rtamt.compiler.plan import Scan
    from rtamt.compiler.program import Program
    from rtamt.compiler.stored import StoredPlan
    from rtamt.language.formula import Formula
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.discrete import Discrete, DiscreteTrace

    #: Lower and upper bounds at each sample.
    Ends = tuple[FloatArray, FloatArray]


class Evaluator:
    """Evaluates the same formulas on traces, compiling only when necessary."""

    def __init__(self, formulas: Sequence[Formula], period: Fraction) -> None:
        self._asked = tuple(formulas)
        self._period = period
        self._shape = Shape.of(formulas)
        self._longest = longest_bound(self._shape.expanded(), period)
        # The last plan, with what it was clipped to, and what runs its programs.
        self._plan: tuple[int, Plan, list[Run]] | None = None

    #: The last plan that was asked for many traces, and what runs it; None where nothing does.
    _batch: tuple[Plan, Any] | None = None

    def plan(self, n: int) -> tuple[Plan, list[Run]]:
        """Return the plan for traces of n samples, and what runs the program of each stage and the last one."""
        # A trace longer than every bound needs no clipping, so that one plan serves all such traces.
        clip = n if n <= self._longest else self._longest + 1
        last = self._plan
        if last is None or last[0] != clip:
            plan = self._shape.plan(self._period, clip)
            programs = [*(stage.program for stage in plan.stages), plan.program]
            last = self._plan = clip, plan, [Run(program) for program in programs]
        return last[1], last[2]

    def __call__(self, trace: DiscreteTrace) -> list[FloatArray]:
        """Return the robustness of each formula at each of the n samples of the trace."""
        n = len(trace)
        plan, runs = self.plan(n)
        columns = trace.columns
        if not plan.stages:
            return runs[0].over(columns, n, trace, plan, self._asked)
        columns = dict(columns)
        for stage, run in zip(plan.stages, runs, strict=False):  # the last run is that of the program
            values = run.over(columns, n, trace, plan, self._asked)
            for scan in stage.scans:
                operands = [values[i] for i in scan.outputs]
                if scan.kind == DEFINED:
                    columns[scan.name] = defined(scan, operands, trace, plan)
                else:
                    columns[scan.name] = core().scan(scan.kind, *operands)
        return runs[-1].over(columns, n, trace, plan, self._asked)

    def rows(
        self, columns: Mapping[str, FloatArray], rows: NDArray[np.int64], n: int, results: FloatArray
    ) -> bool:
        """Write the robustness of the only formula at the first n samples of these rows to those of ``results``.

        False where it is undefined in one of them, or if an operator has code of its own.
        """
        plan, runs = self.plan(n)
        last = self._batch
        if last is None or last[0] is not plan:
            stages = self._stages(plan, runs, columns)
            last = self._batch = plan, None if stages is None else core().Batch(stages, len(columns))
        batch = last[1]
        return batch is not None and batch.run(list(columns.values()), rows, n, results)

    def direct(self, domain: Discrete, trace: DiscreteTrace) -> Direct | None:
        """Return the direct evaluator of the only formula over recordings like this one; None if there is none."""
        n, names = len(trace), tuple(trace.columns)
        plan, runs = self.plan(n)
        stages = self._stages(plan, runs, names)
        if stages is None:
            return None
        sizes = (n, n) if n <= self._longest else (self._longest + 1, sys.maxsize)
        given = domain.period is not None
        classes = Signal, RegularTimes, StoredTimes, trace.period
        evaluator = core().DirectEvaluator(
            names, TIME, float(trace.period), given, domain.tolerance, *sizes, stages, threads, *classes
        )
        return Direct(evaluator.run, frame_columns, Reading(names, trace.period, given))

    @staticmethod
    def _stages(plan: Plan, runs: Sequence[Run], names: Iterable[str]) -> list[Any] | None:
        """Return the stages of a plan over these variables as the core reads them; None if an operator has code."""
        places = {name: place for place, name in enumerate(names)}
        stages = []
        for run, scans in zip(runs, [*(stage.scans for stage in plan.stages), ()], strict=True):
            if run.evaluator is None or any(scan.kind == DEFINED for scan in scans):
                return None
            inputs = [places[name] for name in run.program.inputs]
            stages.append((run.evaluator, inputs, [(scan.kind, list(scan.outputs)) for scan in scans]))
            for scan in scans:
                places[scan.name] = len(places)
        return stages


class StoredEvaluator(Evaluator):
    """Evaluates a plan without formulas."""

    def __init__(self, stored: StoredPlan) -> None:
        self._asked = ()
        self._stored = stored.plan, [Run(program) for program in stored.programs()]

    def plan(self, n: int) -> tuple[Plan, list[Run]]:  # noqa: ARG002 - longer bounds change no value
        """See :class:`Evaluator`."""
        return self._stored


class BoundsEvaluator(Evaluator):
    """Evaluates bounds of the same formulas over traces that are known in part."""

    def of_bounds(self, trace: DiscreteTrace) -> list[Ends]:
        """Return lower and upper bounds of each formula at each of the n samples of the trace."""
        plan, _ = self.plan(len(trace))
        columns: dict[str, Ends] = dict(trace.bounds)
        for stage in plan.stages:
            values = self._run(stage.program, columns, trace, plan)
            for scan in stage.scans:
                lower, upper = (core().scan(scan.kind, *(values[i][k] for i in scan.outputs)) for k in (0, 1))
                columns[scan.name] = lower, upper
        return self._run(plan.program, columns, trace, plan)

    def _run(
        self, program: Program, columns: Mapping[str, Ends], trace: DiscreteTrace, plan: Plan
    ) -> list[Ends]:
        inputs = [np.stack(columns[name], axis=1) for name in program.inputs]
        try:
            found: list[Ends] = core().evaluate_bounds(program.code(), inputs, len(trace))
        except (RuntimeError, core().Undefined) as error:
            raise failed(error, program, trace, plan, self._asked) from None
        return found


def longest_bound(formulas: Sequence[Formula], period: Fraction) -> int:
    """Return the largest finite bound of any interval, in samples."""
    longest = 0
    for node in postorder(*formulas):
        if isinstance(node, Apply) and node.interval is not None:
            last = node.interval.end if node.interval.end is not None else node.interval.begin
            longest = max(longest, int(last / period))
    return longest


class Run:
    """A program of a plan, ready to run over whole columns any number of times."""

    def __init__(self, program: Program) -> None:
        self.program = program
        # Calls have a state of their own, which belongs to one run.
        self.evaluator: Any = None if program.calls else core().Evaluator(program.code())

    def over(
        self,
        columns: Mapping[str, FloatArray],
        n: int,
        trace: DiscreteTrace,
        plan: Plan,
        asked: Sequence[Formula],
    ) -> list[FloatArray]:
        """Return n values of each output; ``trace``, ``plan`` and the formulas that are ``asked``: for errors."""
        program = self.program
        inputs = [columns[name] for name in program.inputs]
        values: list[FloatArray]
        try:
            if self.evaluator is not None:
                values = self.evaluator.run(inputs, n, threads)
            else:
                calls = calls_of(program)
                values = core().evaluate(program.code(), inputs, n, calls)
        except (RuntimeError, core().Undefined) as error:
            raise failed(error, program, trace, plan, asked) from None
        return values


def failed(
    error: Exception, program: Program, trace: DiscreteTrace, plan: Plan, asked: Sequence[Formula]
) -> Exception:
    """Return the error for a failure of the core, which names the sub-formula and the sample."""
    if isinstance(error, RuntimeError):
        return creation_error(program, error)
    sample = error.args[1]
    where = at_sample(sample, float(trace.times[sample]), dated=trace.dated)
    if program.metadata is not None:
        return undefined_text(program.metadata.meanings.get(error.args[0], UNNAMED), where)
    formula = culprit(error, program, asked, plan.original)
    return undefined(formula, where)


def defined(scan: Scan, operands: list[FloatArray], trace: DiscreteTrace, plan: Plan) -> FloatArray:
    """Return the values of a custom operator of unbounded future, by its definition."""
    from rtamt.engine.user_operators import defined_column

    assert scan.meaning is not None
    values = defined_column(scan.meaning, trace.period, operands)
    wrong = np.flatnonzero(np.isnan(values))
    if len(wrong):
        sample = int(wrong[0])
        raise undefined(
            plan.original(scan.meaning), at_sample(sample, float(trace.times[sample]), dated=trace.dated)
        )
    return values
