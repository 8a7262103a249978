"""Core formula to program: value numbering, lags, and the delays that align operands.

One function for each shape of kernel in the operator table; no operator is named here.
Where an operator needs the whole future (offline only), the formula is cut: what lies below runs
first over the whole trace, is scanned backwards, and enters the rest as one more input.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import copysign, inf, isnan
from typing import TYPE_CHECKING

import numpy as np

from rtamt.engine.program import Instruction, Program
from rtamt.errors import EvaluationError, UsageError
from rtamt.language.formula import Apply, Const, Formula, Interval, Var, fold, postorder, variables
from rtamt.language.operators import STL, Pointwise, Shift, Since, Tense, Until, Window
from rtamt.rewrite.check import reads_unbounded_future, unbounded_future

if TYPE_CHECKING:
    from collections.abc import Sequence

_IDENTITY = {"max": -inf, "min": inf}


@dataclass(frozen=True, slots=True)
class Scan:
    """A backward pass over outputs of a stage: its result is the input called ``name`` later on."""

    name: str
    kind: str  # run_max, run_min or until
    outputs: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Stage:
    """A program to run over the whole trace, and the scans over what it gives."""

    program: Program
    scans: tuple[Scan, ...]


@dataclass(frozen=True, slots=True)
class Plan:
    """What an offline evaluation runs: the stages in order, then the program."""

    stages: tuple[Stage, ...]
    program: Program


def compile_program(
    outputs: Sequence[Formula],
    period: Fraction,
    inputs: tuple[str, ...] | None = None,
    clip: int | None = None,
) -> Program:
    """Compile core formulas (see ``desugar``) whose future is bounded into one program.

    ``inputs`` fixes the order of the inputs; by default the variables in order of appearance.
    ``clip`` is the number of samples of a finished trace: bounds beyond it are cut to it, which
    changes no value and saves memory.
    """
    if inputs is None:
        inputs = tuple(dict.fromkeys(name for formula in outputs for name in variables(formula)))
    builder = _Builder(period, inputs, clip)
    indices = tuple(builder.lower(formula) for formula in outputs)
    return builder.program(indices)


def compile_plan(outputs: Sequence[Formula], period: Fraction, clip: int) -> Plan:
    """Compile core formulas for the offline evaluation of a trace of ``clip`` samples."""
    stages: list[Stage] = []
    formulas = tuple(outputs)
    while any(unbounded_future(formula) for formula in formulas):
        formulas, stage = _cut(formulas, period, clip, len(stages))
        stages.append(stage)
    return Plan(tuple(stages), compile_program(formulas, period, clip=clip))


def _cut(
    formulas: tuple[Formula, ...], period: Fraction, clip: int, number: int
) -> tuple[tuple[Formula, ...], Stage]:
    """Replace the innermost operators of unbounded future by inputs that a new stage computes."""
    operands: dict[Formula, int] = {}
    scans: dict[tuple[str, tuple[int, ...]], Scan] = {}

    def cut(node: Formula, below: tuple[tuple[Formula, bool], ...]) -> tuple[Formula, bool]:
        """Return the node rebuilt, and whether it or anything below it was unbounded."""
        if not isinstance(node, Apply):
            return node, False
        rebuilt = replace(node, args=tuple(arg for arg, _ in below))
        unbounded = reads_unbounded_future(node)
        if any(was_unbounded for _, was_unbounded in below) or not unbounded:
            return rebuilt, unbounded or any(was_unbounded for _, was_unbounded in below)
        kernel = node.op.kernel
        kind = f"run_{kernel.reduce}" if isinstance(kernel, Window) else "until"
        key = (kind, tuple(operands.setdefault(arg, len(operands)) for arg in node.args))
        scan = scans.setdefault(key, Scan(f"#{number}.{len(scans)}", *key))
        return _after_scan(node, Var(scan.name, node.span), period), True

    rest = tuple(fold(formula, cut)[0] for formula in formulas)
    program = compile_program(tuple(operands), period, clip=clip)
    return rest, Stage(program, tuple(scans.values()))


def _after_scan(node: Apply, scan: Var, period: Fraction) -> Formula:
    """Return what is left of an operator over [a, inf) once its backward pass from t on is known."""
    begin = node.interval.begin if node.interval is not None else Fraction(0)
    if begin == 0:
        return scan
    at_begin = Interval(begin, begin)
    if isinstance(node.op.kernel, Window):
        return replace(node, args=(scan,), interval=at_begin)
    # φ until[a, inf) ψ: φ on [t, t + a), and φ until ψ from t + a on.
    before = STL["always"](node.args[0], interval=Interval(Fraction(0), begin - period))
    return STL["and"](before, STL["eventually"](scan, interval=at_begin))


class _Builder:
    """The instructions so far; emitting one that is there already returns the old one."""

    def __init__(self, period: Fraction, inputs: tuple[str, ...], clip: int | None) -> None:
        self.period = period
        self.inputs = inputs
        self.clip = clip
        self.instructions: list[Instruction] = []
        self.origins: list[Formula | None] = []
        self.index_of: dict[tuple[Instruction, float], int] = {}
        self.value_of: dict[Formula, int] = {}
        self.partial: set[int] = set()

    def program(self, outputs: tuple[int, ...]) -> Program:
        """Return what the outputs need, renumbered, and what can fail: an error is not optimised away."""
        needed = {*outputs, *self.partial}
        for i in reversed(range(len(self.instructions))):
            if i in needed:
                needed.update(j for j in (self.instructions[i].a, self.instructions[i].b) if j is not None)
        new = {old: i for i, old in enumerate(sorted(needed))}
        kept = [self.instructions[i] for i in new]
        return Program(
            tuple(
                replace(ins, a=None if ins.a is None else new[ins.a], b=None if ins.b is None else new[ins.b])
                for ins in kept
            ),
            self.inputs,
            tuple(new[i] for i in outputs),
            self.period,
            {formula: new[i] for formula, i in self.value_of.items() if i in new},
            tuple(self.origins[i] for i in new),
        )

    def lower(self, formula: Formula) -> int:
        """Emit the instructions of a formula, operands first, and return the last one's index."""
        for node in postorder(formula):
            if node not in self.value_of:
                self.value_of[node] = self._lower_node(node)
        return self.value_of[formula]

    def _lower_node(self, node: Formula) -> int:
        if isinstance(node, Const):
            return self.emit(Instruction("const", x=node.value), node)
        if isinstance(node, Var):
            return self.emit(Instruction("input", n=self.inputs.index(node.name)), node)
        assert isinstance(node, Apply)
        args = self.align([self.value_of[arg] for arg in node.args])
        kernel = node.op.kernel
        if isinstance(kernel, Pointwise):
            return self.pointwise(node, kernel, args)
        if isinstance(kernel, Window):
            return self.window(node, kernel, args[0])
        if isinstance(kernel, Shift):
            return self.shift_by_one(node, kernel, args[0])
        if isinstance(kernel, Since):
            return self.since(node, *args)
        if isinstance(kernel, Until):
            return self.until(node, *args)
        raise UsageError(
            f"the operator '{node.op.name}' has a definition but no kernel; evaluate it with backend='python'"
        )

    # ---- emitting --------------------------------------------------------------------------------

    def emit(self, instruction: Instruction, origin: Formula) -> int:
        key = (instruction, copysign(1.0, instruction.x))  # 0.0 == -0.0, but they are two constants
        index = self.index_of.get(key)
        if index is None:
            index = self.index_of[key] = len(self.instructions)
            self.instructions.append(instruction)
            self.origins.append(origin)
        return index

    def lag(self, index: int) -> int:
        return self.instructions[index].lag

    def is_const(self, index: int) -> bool:
        return self.instructions[index].opcode == "const"

    def align(self, indices: list[int]) -> list[int]:
        """Delay operands until all have the lag of the latest; constants have none."""
        lag = max((self.lag(i) for i in indices), default=0)
        return [self.delayed(i, lag) for i in indices]

    def delayed(self, index: int, lag: int) -> int:
        """Return the same value known later: slots move, time does not."""
        behind = lag - self.lag(index)
        if behind == 0 or self.is_const(index):
            return index
        origin = self.origins[index]
        assert origin is not None
        return self.emit(Instruction("shift", index, n=behind, lag=lag), origin)

    def moved(self, index: int, distance: int, fill: float, lag: int, origin: Formula) -> int:
        """Return the operand ``distance`` samples behind, ``fill`` where there is none."""
        return self.emit(Instruction("shift", index, n=distance, x=fill, lag=lag), origin)

    def samples(self, bound: Fraction) -> int:
        count = bound / self.period
        assert count.denominator == 1, "bounds are checked before compilation"
        return count.numerator if self.clip is None else min(count.numerator, self.clip)

    def bounds(self, node: Apply) -> tuple[int, int | None]:
        if node.interval is None:
            return 0, None
        end = node.interval.end
        return self.samples(node.interval.begin), None if end is None else self.samples(end)

    # ---- one function for each shape of kernel -----------------------------------------------------

    def pointwise(self, node: Apply, kernel: Pointwise, args: list[int]) -> int:
        if all(self.is_const(i) for i in args):
            return self.constant_folded(node, args)
        lag = max(self.lag(i) for i in args)
        a, b = (*args, None)[:2]
        index = self.emit(Instruction(kernel.opcode, a, b, lag=lag), node)
        if kernel.partial:
            self.partial.add(index)
        return index

    def constant_folded(self, node: Apply, args: list[int]) -> int:
        value = float(node.op.definition(*(np.array([self.instructions[i].x]) for i in args))[0])
        if isnan(value):
            raise EvaluationError(f"'{node}' has no value: change the formula so that it has one")
        return self.emit(Instruction("const", x=value), node)

    def window(self, node: Apply, kernel: Window, x: int) -> int:
        begin, end = self.bounds(node)
        fill = _IDENTITY[kernel.reduce]
        lag = self.lag(x)
        if node.op.tense is Tense.PAST:
            if end is None:
                x = self.emit(Instruction(f"run_{kernel.reduce}", x, lag=lag), node)
            else:
                x = self.slide(kernel.reduce, x, end - begin + 1, lag, node)
            return self.moved(x, begin, fill, lag, node) if begin else x
        assert end is not None, "unbounded future is cut off before"
        if end == 0:
            return x
        if begin == end:
            return self.moved(x, 0, fill, lag + end, node)
        return self.slide(kernel.reduce, x, end - begin + 1, lag + end, node)

    def slide(self, reduce: str, x: int, width: int, lag: int, origin: Formula) -> int:
        if width == 1:
            return x
        return self.emit(Instruction(f"slide_{reduce}", x, n=width, lag=lag), origin)

    def slid(self, reduce: str, x: int, width: int, lag: int, origin: Formula) -> int:
        """Return a window over an operand of since or until, delayed to their lag (a constant has its own)."""
        return self.delayed(self.slide(reduce, x, width, self.lag(x), origin), lag)

    def shift_by_one(self, node: Apply, kernel: Shift, x: int) -> int:
        if node.op.tense is Tense.PAST:
            return self.moved(x, 1, kernel.fill, self.lag(x), node)
        return self.moved(x, 0, kernel.fill, self.lag(x) + 1, node)

    def since(self, node: Apply, hold: int, goal: int) -> int:
        """φ since[a, b] ψ is once[a, b] ψ, φ on (t - a, t], and (φ since ψ) a ago: O(1) state besides windows."""
        begin, end = self.bounds(node)
        lag = max(self.lag(hold), self.lag(goal))
        x = self.emit(Instruction("since", hold, goal, lag=lag), node)
        if end is not None:
            recent = self.slid("max", goal, end - begin + 1, lag, node)
            x = self.emit(Instruction("min", x, recent, lag=lag), node)
        if begin == 0:
            return x
        x = self.moved(x, begin, -inf, lag, node)
        held = self.slid("min", hold, begin, lag, node)
        return self.emit(Instruction("min", x, held, lag=lag), node)

    def until(self, node: Apply, hold: int, goal: int) -> int:
        """φ until[a, b] ψ over the last b + 1 slots; the past tense (precedes) ends where it stands.

        For a > 0, φ on [t, t') is "φ on [j - a, j) for every j from t + a to t'", so that a window
        over [t + a, t + b] alone sees all of it, and no second delay line is needed.
        """
        begin, end = self.bounds(node)
        assert end is not None, "unbounded future is cut off before"
        lag = max(self.lag(hold), self.lag(goal))
        if begin:
            before = self.slid("min", hold, begin, lag, node)
            hold = self.moved(before, 1, inf, lag, node)
            goal = self.emit(Instruction("min", hold, goal, lag=lag), node)
        future = node.op.tense is Tense.FUTURE
        known = lag + end if future else lag
        if end == begin:
            return self.moved(goal, 0, -inf, known, node) if future and end else goal
        return self.emit(Instruction("until", hold, goal, n=end - begin + 1, lag=known), node)
