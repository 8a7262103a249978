"""The back ends of discrete time: the compiled core and the definition.

What evaluates recordings, and what evaluates by definition, is imported on use: monitors do not wait for it.
"""

from __future__ import annotations

from fractions import Fraction

from rtamt.compiler.passes import PASSES
from rtamt.compiler.shared import Shape
from rtamt.engine.backend import Compiled, CompiledSession, Defined, Definition, Place, named
from rtamt.engine.native import calls_of, core, core_monitor
from rtamt.engine.online import depth_of
from rtamt.errors import UsageError
from rtamt.language.undefined_value import UndefinedAtSampleError, at_sample, undefined
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.rewrite.desugar import desugar

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from rtamt.compiler.program import Program
    from rtamt.compiler.stored import StoredPlan
    from rtamt.engine.discrete.evaluate import Evaluator, StoredEvaluator
    from rtamt.engine.discrete.python_backend import PythonMonitor
    from rtamt.engine.early import EarlyQuery, EarlySession
    from rtamt.errors import EvaluationError
    from rtamt.language.formula import Formula
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.discrete import Discrete, DiscreteTrace
    from rtamt.signals.outcomes import BoundedSignal

_SECOND = Fraction(1)


class CompiledDiscrete(Compiled):
    """The compiled core."""

    def evaluator(self, formulas: tuple[Formula, ...], step: Fraction, inputs: tuple[str, ...]) -> Evaluator:
        """See :class:`Backend`."""
        from rtamt.engine.discrete.evaluate import Evaluator

        return Evaluator(formulas, step)

    def stored(
        self,
        formulas: tuple[Formula, ...],
        step: Fraction,
        inputs: tuple[str, ...],
    ) -> StoredPlan:
        """See :class:`Compiled`."""
        from rtamt.compiler.stored import StoredPlan
        from rtamt.engine.discrete.evaluate import longest_bound

        shape = Shape.of(formulas)
        return StoredPlan.of(shape.plan(step, longest_bound(shape.expanded(), step) + 1), formulas)

    def stored_evaluator(self, plan: StoredPlan) -> StoredEvaluator:
        """See :class:`Compiled`."""
        from rtamt.engine.discrete.evaluate import StoredEvaluator

        return StoredEvaluator(plan)

    def core_bounds(
        self, formulas: tuple[Formula, ...], step: Fraction, inputs: tuple[str, ...]
    ) -> Callable[[DiscreteTrace], list[BoundedSignal]]:
        """See :class:`Compiled`."""
        from rtamt.engine.discrete.evaluate import BoundsEvaluator
        from rtamt.signals.outcomes import BoundedSignal

        evaluator = BoundsEvaluator(formulas, step)
        return lambda trace: [BoundedSignal(trace.timestamps, *ends) for ends in evaluator.of_bounds(trace)]

    def check(self, code: bytes, inputs: Sequence[str]) -> None:
        """See :class:`Compiled`."""
        core().memory(code)

    def layout(self, program: Program) -> list[Place]:
        """See :class:`Compiled`."""
        places = core().layout(program.code(), calls_of(program))
        return [Place(root, register) for root, register in places]

    def session(
        self,
        formulas: Sequence[Formula],
        inputs: tuple[str, ...],
        domain: Discrete,
        ignored: Collection[str] = (),
        *,
        strict: bool = True,
        unit: Fraction = _SECOND,
        parts: bool = False,
        worst_case: bool = False,
    ) -> SampleProgram:
        """See :class:`Backend`; the other arguments are those of :class:`SampleProgram`."""
        return SampleProgram(
            formulas, inputs, domain, ignored, strict=strict, unit=unit, parts=parts, worst_case=worst_case
        )

    def memory(self, program: Program) -> int:
        """See :class:`Backend`."""
        return int(core().memory(program.code(), calls_of(program)))

    def early_session(self, query: EarlyQuery, domain: Discrete) -> EarlySession:
        """See :class:`Backend`."""
        from rtamt.engine.discrete import early

        return early.program_of(query, domain)


class DefinedDiscrete(Defined):
    """The definition."""

    def evaluator(
        self,
        formulas: tuple[Formula, ...],
        step: Fraction,
        inputs: tuple[str, ...],
    ) -> Callable[[DiscreteTrace], list[FloatArray]]:
        """See :class:`Backend`."""
        from rtamt.reference import discrete_robustness as reference

        def evaluated(trace: DiscreteTrace) -> list[FloatArray]:
            start = float(trace.times[0])
            try:
                return [reference.evaluate(f, trace.columns, len(trace), step, start) for f in formulas]
            except UndefinedAtSampleError as error:
                raise _at_callers_time(error, trace) from None

        return evaluated

    def bounds_of(self, formula: Formula, trace: DiscreteTrace) -> BoundedSignal:
        """See :class:`Defined`."""
        from rtamt.engine import offline_bounds

        try:
            return offline_bounds.discrete(formula, trace)
        except UndefinedAtSampleError as error:
            raise _at_callers_time(error, trace) from None

    def session(
        self,
        formulas: Sequence[Formula],
        inputs: tuple[str, ...],
        domain: Discrete,
        ignored: Collection[str] = (),
        *,
        strict: bool = True,
        unit: Fraction = _SECOND,
        parts: bool = False,
        worst_case: bool = False,
    ) -> SampleDefinition:
        """See :class:`Backend`; the other arguments are those of :class:`SampleDefinition`."""
        if worst_case:
            raise UsageError("worst_case=True needs the compiled core; leave out backend='python'")
        return SampleDefinition(formulas, inputs, domain, strict=strict, unit=unit)

    def early_session(self, query: EarlyQuery, domain: Discrete) -> EarlySession:
        """See :class:`Backend`."""
        from rtamt.engine.discrete import early

        return early.definition_of(query, domain)


class SampleProgram(CompiledSession):
    """Formulas as a program of the compiled core.

    ``parts``: whether :meth:`part` is called, for which the value of every instruction is kept. ``worst_case``: whether
    no sample may take longer than others.
    """

    def __init__(
        self,
        formulas: Sequence[Formula],
        inputs: tuple[str, ...],
        domain: Discrete,
        ignored: Collection[str],
        *,
        strict: bool,
        unit: Fraction,
        parts: bool,
        worst_case: bool,
    ) -> None:
        assert domain.period is not None
        without = frozenset(PASSES) if parts else frozenset()
        program = Shape.of(formulas).program(domain.period, inputs, without=without)
        if worst_case:
            program = program.for_worst_case(formulas)
        super().__init__(formulas, program)
        self._made_of = float(domain.period / unit), domain.tolerance, strict, ignored

    @property
    def lags(self) -> tuple[int, ...]:
        """The samples after which each formula's value at a sample is known."""
        return self.program.lags

    def open(self) -> Any:
        """See :class:`Session`."""
        return core_monitor(self.program, *self._made_of, self._types)

    def part(self, monitor: Any, formula: Formula) -> float:
        """Return the value at the last sample of a part without future operators."""
        place = self.program.place_of(desugar(formula))
        instruction = self.program.instructions[place]
        return instruction.x if instruction.opcode == "const" else float(monitor.last(place))


class SampleDefinition(Definition):
    """Formulas that are evaluated by definition.

    ``strict``: reject a sample off the period, instead of counting it. ``unit``: seconds in a unit of the timestamps.
    """

    def __init__(
        self,
        formulas: Sequence[Formula],
        inputs: tuple[str, ...],
        domain: Discrete,
        *,
        strict: bool,
        unit: Fraction,
    ) -> None:
        assert domain.period is not None
        self._made_of = formulas, inputs, domain.period, domain.tolerance, strict, unit

    @property
    def lags(self) -> tuple[int, ...]:
        """The samples after which each formula's value at a sample is known."""
        formulas, _, period, *_ = self._made_of
        return tuple([int(depth_of(each, period) / period) for each in formulas])

    def open(self) -> PythonMonitor:
        """See :class:`Session`."""
        from rtamt.engine.discrete.python_backend import PythonMonitor

        return PythonMonitor(*self._made_of)

    def part(self, monitor: PythonMonitor, formula: Formula) -> float:
        """Return the value at the last sample of a part without future operators."""
        return monitor.last(formula)


def _at_callers_time(error: UndefinedAtSampleError, trace: DiscreteTrace) -> EvaluationError:
    formula, sample, seconds = error.args
    return undefined(formula, at_sample(sample, seconds, dated=trace.dated))


_DEFINED = DefinedDiscrete()

#: By name.
BACKENDS = named(CompiledDiscrete(_DEFINED), _DEFINED)
