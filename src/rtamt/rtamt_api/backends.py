"""What runs the paper's classes: the compiled core, or the definition where there is none."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.compiler.plan import compile_program
from rtamt.engine import dense_evaluate
from rtamt.engine.evaluate import Evaluator
from rtamt.engine.native import core, core_monitor, culprit
from rtamt.engine.python_backend import PythonMonitor, Refused
from rtamt.errors import UsageError
from rtamt.language.formula import Const
from rtamt.language.undefined_value import at_sample, undefined
from rtamt.language.units import UNITS
from rtamt.reference import dense as dense_reference
from rtamt.reference import discrete as reference
from rtamt.rewrite.desugar import desugar
from rtamt.rtamt_api.options import Language

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence
    from fractions import Fraction

    from rtamt.language.formula import Formula
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.dense import DenseTrace
    from rtamt.signals.discrete import DiscreteTrace
    from rtamt.signals.signal import Signal


def is_compiled() -> bool:
    """Tell whether the compiled core can be loaded."""
    try:
        core()
    except UsageError:
        return False
    return True


def require_core(what: str, instead: str) -> None:
    """Raise :class:`UsageError` for ``what`` where the core cannot be loaded, naming what to use ``instead``."""
    try:
        core()
    except UsageError as reason:
        raise UsageError(
            f"{what} needs the compiled core, which cannot be loaded; install the package with a C++ compiler "
            f"at hand, or use {instead}, which gives the same results more slowly"
        ) from reason


def check_language(language: Language) -> None:
    """Raise :class:`UsageError` for a language that the combined classes cannot be made with."""
    if not isinstance(language, Language):
        raise UsageError(f"the language is {language!r}; choose Language.PYTHON or Language.CPP")
    if language is Language.CPP:
        require_core("Language.CPP", "Language.PYTHON")


def dense_signal(formula: Formula, recording: DenseTrace) -> Signal:
    """Return the robustness of a formula over a finished recording in dense time."""
    if is_compiled():
        return dense_evaluate.evaluate(formula, recording)
    steps = dense_reference.evaluate(formula, recording.columns, recording.scale.tick)
    return recording.signal(steps.times, steps.values)


def signal(formula: Formula, trace: DiscreteTrace) -> FloatArray:
    """Return the robustness of a formula at every sample of a finished trace."""
    if is_compiled():
        return Evaluator((formula,), trace.period)(trace)[0]
    start = float(trace.times[0])
    return reference.evaluate(formula, trace.columns, len(trace), trace.period, start)


def open_stream(
    formulas: Sequence[Formula],
    inputs: tuple[str, ...],
    period: Fraction,
    unit: str,
    tolerance: float,
    ignored: Collection[str],
) -> CompiledStream | DefinedStream:
    """Return a stream of samples that has not begun.

    ``formulas``: past formulas, that of the result first. ``inputs``: what they read. ``period``:
    seconds from sample to sample. ``unit``: that of the time stamps. ``tolerance``: the fraction of the
    period by which a gap may miss it before it is counted. ``ignored``: what a sample may hold besides.
    """
    if is_compiled():
        return CompiledStream(formulas, inputs, period, unit, tolerance, ignored)
    return DefinedStream(formulas, inputs, period, unit, tolerance)


class CompiledStream:
    """A stream through the compiled core; made by :func:`open_stream`."""

    def __init__(
        self,
        formulas: Sequence[Formula],
        inputs: tuple[str, ...],
        period: Fraction,
        unit: str,
        tolerance: float,
        ignored: Collection[str],
    ) -> None:
        compiled = core()
        self._made_of = (formulas, inputs, period, unit, tolerance, ignored)
        self._program = compile_program([desugar(formula) for formula in formulas], period, inputs)
        self._unit = float(UNITS[unit])
        self._undefined: Any = compiled.Undefined
        in_units = float(period / UNITS[unit])
        #: Counts samples and gaps, and forgets them.
        self.monitor: Any = core_monitor(self._program, in_units, tolerance, strict=False, ignored=ignored)
        #: Raised by :meth:`take` for a sample that cannot be taken.
        self.refused: type[Exception] = compiled.Refused
        #: A quick way in for whatever a caller has (None if there is none), and what it raises if that will not do.
        self.quick: Callable[[Any, Any], Any] | None = self.monitor.update_pairs
        self.refusals: tuple[type[Exception], ...] = (compiled.Refused, compiled.Undefined, UsageError)

    def take(self, timestamp: Any, numbers: Mapping[str, Any]) -> float:
        """Take a sample and return the robustness.

        Raises :attr:`refused`, or :class:`EvaluationError` where an operation has no value; nothing
        has changed then.
        """
        try:
            robustness: float = self.monitor.update_pairs(timestamp, list(numbers.items()))
        except self._undefined as error:
            formula = culprit(error, self._program, self._made_of[0])
            raise undefined(formula, at_sample(error.args[1], error.time * self._unit)) from None
        return robustness

    def __reduce__(self) -> tuple[Any, ...]:
        return _reopened, (self._made_of, self.monitor.state())

    def latest(self, part: Formula) -> float:
        """Return the value of a formula, or of a part of one, at the latest sample."""
        if isinstance(part, Const):
            return part.value
        return float(self.monitor.last(self._program.value_of[desugar(part)]))


def _reopened(made_of: tuple[Any, ...], state: bytes) -> CompiledStream:
    stream = CompiledStream(*made_of)
    stream.monitor.restore(state)
    return stream


class DefinedStream:
    """The same through the definition, in Python; see :class:`CompiledStream`."""

    def __init__(
        self,
        formulas: Sequence[Formula],
        inputs: tuple[str, ...],
        period: Fraction,
        unit: str,
        tolerance: float,
    ) -> None:
        self.monitor = PythonMonitor(formulas, inputs, period, tolerance, strict=False, unit=UNITS[unit])
        self.refused = Refused
        self.quick = None
        self.refusals: tuple[type[Exception], ...] = ()

    def take(self, timestamp: Any, numbers: Mapping[str, Any]) -> float:
        """Take a sample and return the robustness."""
        robustness = self.monitor.update_pairs(timestamp, list(numbers.items()))
        assert robustness is not None, "past formulas are known at once"
        return robustness

    def latest(self, part: Formula) -> float:
        """Return the value of a formula, or of a part of one, at the latest sample."""
        return self.monitor.last(part)
