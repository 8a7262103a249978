"""Offline in dense time: formulas and finished signals, each on its own clock, to robustness signals."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.compiler.plan import DEFINED, compile_plan
from rtamt.engine.native import core, culprit, not_made
from rtamt.engine.user_operators import calls_of, defined_signal
from rtamt.errors import TraceError, UsageError
from rtamt.language.formula import Apply, fold
from rtamt.language.undefined_value import undefined
from rtamt.rewrite.desugar import desugar
from rtamt.signals import arrays, dense_arrays
from rtamt.signals.arrays import Signal
from rtamt.signals.ticks import TimeScale

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence
    from fractions import Fraction

    from rtamt.compiler.plan import Plan, Scan
    from rtamt.compiler.program import Program
    from rtamt.language.formula import Formula
    from rtamt.signals.dense_arrays import Samples
    from rtamt.signals.ticks import TickArray


@dataclass(frozen=True, slots=True, eq=False)
class DenseRecording:
    """A finished recording in dense time: for each variable its ticks and values, none of them empty."""

    columns: Mapping[str, Samples]
    scale: TimeScale
    #: The units of the variables whose source tells them.
    units: Mapping[str, str] = field(default_factory=dict)

    @property
    def start(self) -> int:
        """The latest first tick: before it, not every variable has a value."""
        return max(int(ticks[0]) for ticks, _ in self.columns.values())

    @property
    def end(self) -> int:
        """The latest last tick."""
        return max(int(ticks[-1]) for ticks, _ in self.columns.values())

    def signal(self, ticks: TickArray, values: arrays.FloatArray) -> Signal:
        """Return events as a signal up to the end: a point for every change, and one at the end."""
        end = self.end
        if len(ticks) and ticks[-1] > end:
            inside = int(ticks.searchsorted(end, "right"))
            ticks, values = ticks[:inside], values[:inside]
        if len(ticks) and ticks[-1] < end:
            ticks, values = np.concatenate((ticks, (end,))), np.concatenate((values, values[-1:]))
        return Signal(self.scale.times(ticks), values)


def trace(
    data: Any,
    names: Sequence[str],
    tick: Fraction,
    known: Collection[str] = (),
    scale: TimeScale | None = None,
    unit: str | None = None,
) -> DenseRecording:
    """Normalise a finished recording; the caller's data is never changed.

    ``data``: a mapping from variable to (times, values) or to a list of [time, value] pairs; with a
    key ``"time"`` all variables share its stamps. ``tick``: seconds. ``scale``: how the caller tells
    time, by default found out from the first variable. ``unit``: of times that are numbers, by default
    seconds. Raises :class:`TraceError`.
    """
    if not names:
        raise UsageError("the formula reads no variable, so in dense time nothing says when to evaluate it")
    arrays.require_no_unit(data, unit)
    columns = dense_arrays.columns_of(data, names, known)
    for name in names:
        if name not in columns:
            raise arrays.missing_variable(name, [str(key) for key in getattr(data, "columns", data)])
        if not len(columns[name][0]):
            raise TraceError(f"'{name}' has no samples: give at least one", variable=name)
    scale = scale or TimeScale.of(tick, [columns[name][0] for name in names], unit)
    samples = {name: dense_arrays.samples_of(columns[name], name, scale) for name in names}
    result = DenseRecording(samples, scale, arrays.units_of(data))
    if result.start > result.end:
        raise TraceError("the signals have no instant in common")
    return result


class Evaluator:
    """Evaluates the same formulas over recordings of ``inputs``, compiled once."""

    def __init__(self, formulas: Sequence[Formula], tick: Fraction, inputs: tuple[str, ...]) -> None:
        self._asked = tuple(formulas)
        formulas = tuple(map(desugar, formulas))
        # Also what these formulas do not read says where the recording starts and ends.
        self._plan = compile_plan(formulas, tick, domain="dense", inputs=inputs)
        # What unbounded future reads must have settled: past windows slide on after the last sample.
        self._settled = max(reach(formula, tick) for formula in formulas) if self._plan.stages else 0

    def __call__(self, recording: DenseRecording) -> list[Samples]:
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


def evaluate(formula: Formula, recording: DenseRecording) -> Signal:
    """Return the robustness of a formula from the recording's start to its end."""
    evaluator = Evaluator((formula,), recording.scale.tick, tuple(recording.columns))
    return recording.signal(*evaluator(recording)[0])


def reach(formula: Formula, tick: Fraction) -> int:
    """Return the most ticks after its operands' last change for which a formula can still change."""

    def step(node: Formula, below: tuple[int, ...]) -> int:
        own = 0
        if isinstance(node, Apply) and node.interval is not None:
            own = int((node.interval.end or node.interval.begin) / tick)
        return own + max(below, default=0)

    return fold(formula, step)


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
        raise not_made(program, error) from None
    except _core.Undefined as error:
        formula = culprit(error, program, asked, plan.original)
        raise undefined(formula, f"time {scale.show(error.args[1])}") from None
    return values


def defined(scan: Scan, operands: list[Samples], recording: DenseRecording, plan: Plan) -> Samples:
    """Return the values of a user's operator of unbounded future, by its definition."""
    ticks, values = defined_signal(scan.meaning, recording.scale.tick, operands)
    wrong = np.flatnonzero(np.isnan(values) & (ticks <= recording.end))
    if len(wrong):
        where = f"time {recording.scale.show(int(ticks[wrong[0]]))}"
        raise undefined(plan.original(scan.meaning), where)
    return ticks, values
