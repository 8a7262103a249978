"""Evaluate formulas on a complete discrete-time trace."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from rtamt.compiler.plan import DEFINED, Plan
from rtamt.compiler.shared import Shape
from rtamt.engine.native import core, culprit, not_made
from rtamt.engine.user_operators import SampleDriver, calls_of, defined_column
from rtamt.language.formula import Apply, postorder
from rtamt.language.undefined_value import at_sample, undefined

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from fractions import Fraction

    from rtamt.compiler.plan import Scan
    from rtamt.compiler.program import Program
    from rtamt.language.formula import Formula
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.discrete import DiscreteTrace

    #: Lower and upper bounds at each sample.
    Ends = tuple[FloatArray, FloatArray]


class Evaluator:
    """Evaluates the same formulas on traces, compiling only when necessary."""

    def __init__(self, formulas: Sequence[Formula], period: Fraction) -> None:
        self._asked = tuple(formulas)
        self._period = period
        self._shape = Shape.of(formulas)
        self._longest = longest_bound(self._shape.expanded(), period)
        self._plans: dict[int, Plan] = {}

    def plan(self, n: int) -> Plan:
        """Return the plan for traces of n samples."""
        # A trace longer than every bound needs no clipping, so that one plan serves all such traces.
        clip = min(n, self._longest + 1)
        plan = self._plans.get(clip)
        if plan is None:
            self._plans.clear()
            plan = self._plans[clip] = self._shape.plan(self._period, clip)
        return plan

    def __call__(self, trace: DiscreteTrace) -> list[FloatArray]:
        """Return the robustness of each formula at each of the n samples of the trace."""
        plan = self.plan(len(trace))
        columns = dict(trace.columns)
        for stage in plan.stages:
            values = run(stage.program, columns, trace, plan, self._asked)
            for scan in stage.scans:
                operands = [values[i] for i in scan.outputs]
                if scan.kind == DEFINED:
                    columns[scan.name] = defined(scan, operands, trace, plan)
                else:
                    columns[scan.name] = core().scan(scan.kind, *operands)
        return run(plan.program, columns, trace, plan, self._asked)


class BoundsEvaluator(Evaluator):
    """Evaluates bounds of the same formulas over traces that are known in part."""

    def of_bounds(self, trace: DiscreteTrace) -> list[Ends]:
        """Return lower and upper bounds of each formula at each of the n samples of the trace."""
        plan = self.plan(len(trace))
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
        with undefined_named(program, trace, plan, self._asked):
            found: list[Ends] = core().evaluate_bounds(program.code(), inputs, len(trace))
        return found


def longest_bound(formulas: Sequence[Formula], period: Fraction) -> int:
    """Return the largest finite bound of any interval, in samples."""
    longest = 0
    for formula in formulas:
        for node in postorder(formula):
            if isinstance(node, Apply) and node.interval is not None:
                last = node.interval.end if node.interval.end is not None else node.interval.begin
                longest = max(longest, int(last / period))
    return longest


def run(
    program: Program,
    columns: Mapping[str, FloatArray],
    trace: DiscreteTrace,
    plan: Plan,
    asked: Sequence[Formula],
) -> list[FloatArray]:
    """Run one program of a plan, made for the formulas that are ``asked``, over whole columns."""
    inputs = [columns[name] for name in program.inputs]
    with undefined_named(program, trace, plan, asked):
        values: list[FloatArray] = core().evaluate(
            program.code(), inputs, len(trace), calls_of(program, SampleDriver)
        )
    return values


@contextmanager
def undefined_named(
    program: Program, trace: DiscreteTrace, plan: Plan, asked: Sequence[Formula]
) -> Iterator[None]:
    """Turn failures of the core into errors that name the sub-formula and the sample."""
    try:
        yield
    except RuntimeError as error:
        raise not_made(program, error) from None
    except core().Undefined as error:
        sample = error.args[1]
        formula = culprit(error, program, asked, plan.original)
        raise undefined(formula, at_sample(sample, float(trace.times[sample]))) from None


def defined(scan: Scan, operands: list[FloatArray], trace: DiscreteTrace, plan: Plan) -> FloatArray:
    """Return the values of a custom operator of unbounded future, by its definition."""
    values = defined_column(scan.meaning, trace.period, operands)
    wrong = np.flatnonzero(np.isnan(values))
    if len(wrong):
        sample = int(wrong[0])
        raise undefined(plan.original(scan.meaning), at_sample(sample, float(trace.times[sample])))
    return values
