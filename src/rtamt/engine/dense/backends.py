"""The back ends of dense time: the compiled core and the definition."""

from __future__ import annotations

from rtamt.compiler.shared import Shape
from rtamt.compiler.stored import StoredPlan
from rtamt.engine import offline_bounds
from rtamt.engine.backend import Compiled, CompiledSession, Defined, Definition, named
from rtamt.engine.dense.evaluate import BoundsEvaluator, Evaluator, StoredEvaluator, settling
from rtamt.engine.dense.python_backend import PythonDenseMonitor
from rtamt.engine.native import calls_of, core, creation_error
from rtamt.language.undefined_value import UndefinedAtTickError, undefined
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.reference import dense_robustness as reference
from rtamt.rewrite.desugar import desugar
from rtamt.signals.dense import Dense

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence
    from fractions import Fraction

    from rtamt.compiler.program import Program
    from rtamt.engine.early import EarlyQuery, EarlySession
    from rtamt.errors import EvaluationError
    from rtamt.language.formula import Formula
    from rtamt.signals.dense import DenseTrace
    from rtamt.signals.dense_arrays import Samples
    from rtamt.signals.outcomes import BoundedSignal


class CompiledDense(Compiled):
    """The compiled core."""

    def evaluator(self, formulas: tuple[Formula, ...], step: Fraction, inputs: tuple[str, ...]) -> Evaluator:
        """See :class:`Backend`."""
        return Evaluator(formulas, step, inputs)

    def stored(self, formulas: tuple[Formula, ...], step: Fraction, inputs: tuple[str, ...]) -> StoredPlan:
        """See :class:`Compiled`."""
        shape = Shape.of(formulas)
        plan = shape.plan(step, domain=Dense, inputs=inputs)
        return StoredPlan.of(plan, formulas, settling(plan, shape.expanded(), step))

    def stored_evaluator(self, plan: StoredPlan) -> StoredEvaluator:
        """See :class:`Compiled`."""
        return StoredEvaluator(plan)

    def core_bounds(
        self, formulas: tuple[Formula, ...], step: Fraction, inputs: tuple[str, ...]
    ) -> Callable[[DenseTrace], list[BoundedSignal]]:
        """See :class:`Compiled`."""
        return BoundsEvaluator(formulas, step, inputs).of_bounds

    def check(self, code: bytes, inputs: Sequence[str]) -> None:
        """See :class:`Compiled`."""
        core().DenseMonitor(code, list(inputs))

    def memory(self, program: Program) -> None:
        """See :class:`Backend`: windows keep as many changes as there are."""

    def session(
        self,
        formulas: Sequence[Formula],
        inputs: tuple[str, ...],
        domain: Dense,
        ignored: Collection[str] = (),
        *,
        parts: bool = False,
    ) -> EventProgram:
        """See :class:`Backend`. ``parts``: whether :meth:`Session.part` is needed."""
        return EventProgram(formulas, inputs, domain, ignored, parts=parts)

    def early_session(self, query: EarlyQuery, domain: Dense) -> EarlySession:
        """See :class:`Backend`."""
        from rtamt.engine.dense import early  # delayed monitors do not wait for it

        return early.program_of(query, domain)


class DefinedDense(Defined):
    """The definition."""

    def evaluator(
        self,
        formulas: tuple[Formula, ...],
        step: Fraction,
        inputs: tuple[str, ...],
    ) -> Callable[[DenseTrace], list[Samples]]:
        """See :class:`Backend`."""

        def evaluated(trace: DenseTrace) -> list[Samples]:
            try:
                steps = [reference.evaluate(f, trace.columns, step) for f in formulas]
            except UndefinedAtTickError as error:
                raise _at_callers_time(error, trace) from None
            return [(each.times, each.values) for each in steps]

        return evaluated

    def bounds_of(self, formula: Formula, trace: DenseTrace) -> BoundedSignal:
        """See :class:`Defined`."""
        try:
            return offline_bounds.dense(formula, trace)
        except UndefinedAtTickError as error:
            raise _at_callers_time(error, trace) from None

    def session(
        self,
        formulas: Sequence[Formula],
        inputs: tuple[str, ...],
        domain: Dense,
        ignored: Collection[str] = (),
        *,
        parts: bool = False,
    ) -> EventDefinition:
        """See :class:`Backend`."""
        return EventDefinition(formulas, inputs, domain)

    def early_session(self, query: EarlyQuery, domain: Dense) -> EarlySession:
        """See :class:`Backend`."""
        from rtamt.engine.dense import early  # delayed monitors do not wait for it

        return early.definition_of(query, domain)


class EventProgram(CompiledSession):
    """Formulas as a program of the compiled core."""

    def __init__(
        self,
        formulas: Sequence[Formula],
        inputs: tuple[str, ...],
        domain: Dense,
        ignored: Collection[str],
        *,
        parts: bool,
    ) -> None:
        program = Shape.of(formulas).program(domain.resolution, inputs, Dense)
        every = range(len(program.instructions)) if parts else ()
        super().__init__(formulas, replace(program, outputs=(*program.outputs, *every)))
        self._outputs = len(program.outputs)
        self._ignored = frozenset(ignored)

    def open(self) -> Any:
        """See :class:`Session`."""
        program = self.program
        calls = calls_of(program)
        try:
            return core().DenseMonitor(
                program.code(), list(program.inputs), self._ignored, calls, self._types
            )
        except RuntimeError as error:
            raise creation_error(program, error) from None

    def part(self, monitor: Any, formula: Formula) -> Samples:
        """See :class:`Session`; for sessions with ``parts``."""
        known: Samples = monitor.last_output(self._outputs + self.program.place_of(desugar(formula)))
        return known


class EventDefinition(Definition):
    """Formulas that are evaluated by definition."""

    def __init__(self, formulas: Sequence[Formula], inputs: tuple[str, ...], domain: Dense) -> None:
        self._made_of = formulas, inputs, domain.resolution

    def open(self) -> PythonDenseMonitor:
        """See :class:`Session`."""
        return PythonDenseMonitor(*self._made_of)

    def part(self, monitor: PythonDenseMonitor, formula: Formula) -> Samples:
        """See :class:`Session`."""
        return monitor.part(formula)


def _at_callers_time(error: UndefinedAtTickError, trace: DenseTrace) -> EvaluationError:
    formula, tick, _ = error.args
    return undefined(formula, f"time {trace.scale.show(tick)}")


_DEFINED = DefinedDense()

#: By name.
BACKENDS = named(CompiledDense(_DEFINED), _DEFINED)
