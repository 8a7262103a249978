"""Compile core formulas to a program (online) or a plan of programs (offline).

The formula is cut at operators that need the whole future (offline only): their operands are evaluated
first over the whole trace and scanned backwards, and the result becomes an additional input of the rest.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache

from rtamt.compiler.passes import passed
from rtamt.compiler.time_lowering import lowering_of
from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Formula, Interval, Var, fold, folds, postorder
from rtamt.language.operators import STL, Until, Window
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.lazy.typing import TYPE_CHECKING
from rtamt.rewrite.check import reads_unbounded_future
from rtamt.rewrite.horizon import horizon
from rtamt.signals.discrete import Discrete

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from rtamt.compiler.lower import Lowering
    from rtamt.compiler.program import Program
    from rtamt.signals.time_domain_interface import TimeDomain


#: The kind of a scan by the definition of a custom operator.
DEFINED = "defined"


@dataclass(frozen=True, slots=True)
class Scan:
    """A backward pass over outputs of a stage: its result is the later input ``name``."""

    name: str
    kind: str  # run_max, run_min or until; DEFINED: by the definition of ``meaning``
    outputs: tuple[int, ...]
    meaning: Apply | None  # the formula of the result; None in plans without formulas


@dataclass(frozen=True, slots=True)
class Stage:
    """A program to run over the whole trace, and the scans over its outputs."""

    program: Program
    scans: tuple[Scan, ...]


@dataclass(frozen=True, slots=True)
class Plan:
    """The plan of an offline evaluation: the stages in order, then the program."""

    stages: tuple[Stage, ...]
    program: Program

    def original(self, formula: Formula) -> Formula:
        """Return a formula of this plan with scans replaced by their meaning, for messages."""
        return self.originals()(formula)

    def originals(self) -> Callable[[Formula], Formula]:
        """Return :meth:`original` for many formulas."""
        from rtamt.language.parameters import with_values

        meanings: dict[str, Formula] = {}

        def put_back(node: Formula, args: tuple[Formula, ...]) -> Formula:
            if isinstance(node, Var):
                return meanings.get(node.name, node)
            return replace(node, args=args) if isinstance(node, Apply) else node

        for stage in self.stages:
            for scan in stage.scans:
                assert scan.meaning is not None
                meanings[scan.name] = fold(scan.meaning, put_back)
        return lambda formula: with_values([fold(formula, put_back)], self.program.parameters)[0]


def compile_program(
    outputs: Sequence[Formula],
    period: Fraction,
    inputs: tuple[str, ...] | None = None,
    clip: int | None = None,
    domain: type[TimeDomain] = Discrete,
    without: Collection[str] = (),
) -> Program:
    """Compile formulas with bounded future to one program.

    Those of their operators that are not core operators (see ``desugar``) have recipes (``rewrite.recipes``).

    ``period`` is the sampling period, in dense time the length of a tick (seconds). ``inputs`` fixes
    the order of the inputs; by default the variables in order of appearance. ``clip`` is the number
    of samples of a finished trace: longer bounds are clipped to it, which
    changes no value and saves memory. ``without``: the passes to leave out, of those in ``passes.PASSES``.

    >>> from fractions import Fraction
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> from rtamt.rewrite.desugar import desugar
    >>> program = compile_program([desugar(parse_formula("always[0:2](x >= 3)"))], Fraction(1))
    >>> program.inputs, program.lags
    (('x',), (2,))
    """
    if inputs is None:
        inputs = _read_by(outputs)
    lowering, indices = _lowered(outputs, period, inputs, clip, domain)

    def cores() -> Lowering:
        if not lowering.expanded:
            return lowering
        from rtamt.rewrite.merge import merged  # only messages and other values need it

        return _lowered(merged(outputs), period, inputs, clip, domain)[0]

    return passed(lowering.program(tuple(indices), cache(cores)), without)


def _lowered(
    outputs: Sequence[Formula],
    period: Fraction,
    inputs: tuple[str, ...],
    clip: int | None,
    domain: type[TimeDomain],
) -> tuple[Lowering, list[int]]:
    """Return a lowering of formulas, and the index of the value of each."""
    lowering = lowering_of(domain)(domain, period, inputs, clip)
    indices = lowering.lower(outputs)
    if clip is None and lowering.known_early:  # online: each output is known at its horizon all the same
        depths = (horizon(formula, period) for formula in outputs)
        indices = [
            index if depth is None else lowering.late(index, int(depth / period))
            for index, depth in zip(indices, depths, strict=True)
        ]
    return lowering, indices


def compile_plan(
    outputs: Sequence[Formula],
    period: Fraction,
    clip: int | None = None,
    domain: type[TimeDomain] = Discrete,
    inputs: tuple[str, ...] = (),
) -> Plan:
    """Compile core formulas for an offline evaluation; arguments as for :func:`compile_program`.

    ``inputs``: additional inputs, besides those that the formulas read.
    """
    stages: list[Stage] = []
    formulas = tuple(outputs)
    # Every stage reads every variable, so that all stages begin and end together.
    names = _read_by(formulas, inputs)
    while any(isinstance(node, Apply) and reads_unbounded_future(node) for node in postorder(*formulas)):
        formulas, stage = _cut(formulas, names, period, clip, domain, len(stages))
        stages.append(stage)
    program = compile_program(formulas, period, _read_by(formulas, names), clip, domain)
    return Plan(tuple(stages), program)


def _read_by(formulas: Sequence[Formula], names: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Return ``names`` and the variables of the formulas without duplicates."""
    return tuple(dict.fromkeys((*names, *variables(*formulas))))


def _cut(
    formulas: tuple[Formula, ...],
    names: tuple[str, ...],
    period: Fraction,
    clip: int | None,
    domain: type[TimeDomain],
    number: int,
) -> tuple[tuple[Formula, ...], Stage]:
    """Replace the innermost operators of unbounded future by inputs that a new stage computes."""
    operands: dict[Formula, int] = {}
    scans: dict[tuple[Formula | None, str, tuple[int, ...]], Scan] = {}
    just_before = lowering_of(domain).until_just_before(period)

    def cut(node: Formula, below: tuple[tuple[Formula, bool], ...]) -> tuple[Formula, bool]:
        """Return the rebuilt node, and whether it or a node below it has unbounded future."""
        if not isinstance(node, Apply):
            return node, False
        rebuilt = replace(node, args=tuple(arg for arg, _ in below))
        unbounded = reads_unbounded_future(node)
        if any(was_unbounded for _, was_unbounded in below) or not unbounded:
            return rebuilt, unbounded or any(was_unbounded for _, was_unbounded in below)
        kind, outputs = _kind(node), tuple(operands.setdefault(arg, len(operands)) for arg in node.args)
        defined = kind == DEFINED
        meaning = node if defined else replace(node, interval=None)
        key = (node if defined else None, kind, outputs)
        scan = scans.setdefault(key, Scan(f"#{number}.{len(scans)}", kind, outputs, meaning))
        result = Var(scan.name, node.span)
        return result if defined else _after_scan(node, result, just_before), True

    rest = tuple(formula for formula, _ in folds(formulas, cut))
    program = compile_program(tuple(operands), period, _read_by(tuple(operands), names), clip, domain)
    return rest, Stage(program, tuple(scans.values()))


def _kind(node: Apply) -> str:
    """Return the kind of backward pass that computes an operator of unbounded future."""
    kernel = node.op.kernel
    if isinstance(kernel, Window):
        return f"run_{kernel.reduce}"
    return "until" if isinstance(kernel, Until) else DEFINED


def _after_scan(node: Apply, scan: Var, just_before: Fraction) -> Formula:
    """Return the rest of an operator over [a, inf), given its backward pass over [t, inf).

    ``just_before``: how much shorter than a the closed window for [0, a) is.
    """
    begin = node.interval.begin if node.interval is not None else Fraction(0)
    if begin == 0:
        return scan
    at_begin = Interval(begin, begin)
    if isinstance(node.op.kernel, Window):
        return replace(node, args=(scan,), interval=at_begin)
    # φ until[a, inf) ψ: φ on [t, t + a), and φ until ψ from t + a on.
    before = STL["always"](node.args[0], interval=Interval(Fraction(0), begin - just_before))
    return STL["and"](before, STL["eventually"](scan, interval=at_begin))
