"""The modern face: a requirement that can be evaluated, monitored, printed and rewritten."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rtamt.engine import reference, signals
from rtamt.engine.evaluate import Evaluator
from rtamt.engine.monitor import Monitor
from rtamt.engine.signals import Signal, Trace
from rtamt.errors import UsageError, did_you_mean
from rtamt.language.formula import Formula, variables
from rtamt.language.operators import STL, Language
from rtamt.language.parser import parse_formula
from rtamt.language.specfile import Document, parse_document
from rtamt.language.units import duration
from rtamt.rewrite import interface
from rtamt.rewrite.check import check_bounds
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.pastify import pastify

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    from rtamt.engine.signals import FloatArray

BACKENDS = ("cpp", "python")

Duration = str | float | Fraction


@dataclass(frozen=True)
class Specification:
    """A requirement: one formula, with the names, types and sub-formulas of its document.

    Made by :func:`parse` and :func:`load`; immutable, so that it can be shared and reused.
    """

    document: Document
    period: Fraction | None = None
    unit: str = "s"
    backend: str = "cpp"
    language: Language = field(default=STL, repr=False)

    @property
    def formula(self) -> Formula:
        """The formula of the last assertion."""
        return self.document.formula

    @property
    def text(self) -> str:
        """The text as it was given."""
        return self.document.text

    @property
    def name(self) -> str | None:
        """The name after ``specification``, if there is one."""
        return self.document.name

    @cached_property
    def input_names(self) -> tuple[str, ...]:
        """The variables that the formula reads, in order of appearance."""
        return variables(self.formula)

    @property
    def horizon(self) -> float:
        """Seconds after t at which ρ at t is known online; inf if never. The paper's Definition 3."""
        depth = horizon(self.formula, self.period or Fraction(1))
        return float("inf") if depth is None else float(depth)

    def pastified(self, period: Duration | None = None) -> Formula:
        """Return Π(φ): past operators only, the same value one horizon later (Definition 4)."""
        return pastify(self.formula, self._period(period) or Fraction(1), self.text)

    def evaluate(self, data: Any, *, period: Duration | None = None) -> Result:
        """Compute the robustness of a finished recording at every sample.

        ``data``: a mapping (or frame) from variable to n numbers; ``"time"``: n stamps in seconds
        (or datetimes), may be left out. ``period``: seconds, or text such as ``"100ms"``; by default
        that of the specification, else the median gap of the stamps, else 1 s.

        Raises :class:`TraceError` where the data is wrong, :class:`BoundError` where an interval is
        no multiple of the period, :class:`EvaluationError` where an operation has no value.

        >>> import rtamt
        >>> result = rtamt.parse("always(x >= 3)").evaluate({"time": [0, 1, 2], "x": [5, 4, 6]})
        >>> result.robustness, result.satisfied, result.signal.values
        (1.0, True, array([1., 1., 3.]))
        """
        trace = signals.trace(data, self.input_names, self._period(period), self._declared)
        check_bounds(self.formula, trace.period, self.text)
        return Result(self, trace, Signal(trace.times, self.robustness_of(self.formula, trace)))

    def monitor(
        self,
        *,
        period: Duration | None = None,
        tolerance: float = signals.TOLERANCE,
    ) -> Monitor:
        """Return an online monitor.

        ``period`` as in :meth:`evaluate`, by default 1 s. ``tolerance``: the fraction of the period
        by which a gap between samples may miss it. Raises :class:`BoundError` for unbounded future.
        """
        return Monitor(
            self.formula,
            text=self.text,
            period=self._period(period) or Fraction(1),
            tolerance=tolerance,
            backend=self.backend,
        )

    def robustness_of(self, formula: Formula, trace: Trace) -> FloatArray:
        """Return the robustness signal of any formula over a normalised trace: n values."""
        if self.backend == "python":
            start = float(trace.times[0])
            return reference.evaluate(formula, trace.columns, len(trace), trace.period, start)
        key = (formula, trace.period)
        evaluator = self._evaluators.get(key)
        if evaluator is None:
            evaluator = self._evaluators[key] = Evaluator((desugar(formula),), trace.period)
        return evaluator(trace)[0]

    def named(self, name: str) -> Formula:
        """Return a named sub-specification, or the formula of any other text, parsed as part of this one."""
        for assertion in self.document.assertions:
            if assertion.name == name:
                return assertion.formula
        return parse_formula(
            name,
            language=self.language,
            constants=self.document.constants,
            definitions=self.document.definitions,
            variables=self.document.variables or None,
            unit=self.unit,
        )

    @cached_property
    def _evaluators(self) -> dict[tuple[Formula, Fraction], Evaluator]:
        return {}

    @property
    def _declared(self) -> tuple[str, ...]:
        return tuple(declaration.name for declaration in self.document.declarations)

    def _period(self, period: Duration | None) -> Fraction | None:
        return self.period if period is None else positive_period(period)

    def __str__(self) -> str:
        return str(self.formula)


@dataclass(frozen=True)
class Result:
    """What an evaluation gives: numbers and a verdict at the first instant, and the whole signal."""

    specification: Specification
    trace: Trace
    #: ρ at every sample: ``.times`` (seconds) and ``.values``, n each.
    signal: Signal

    @property
    def robustness(self) -> float:
        """ρ at the first instant: how far the recording is from violating (or satisfying)."""
        return float(self.signal.values[0])

    @cached_property
    def satisfied(self) -> bool:
        """Whether the formula holds at the first instant: Boolean semantics, evaluated on its own.

        Where the robustness is 0, only this has a verdict.
        """
        lowered = interface.boolean(self.specification.formula)
        return bool(self.specification.robustness_of(lowered, self.trace)[0] > 0)

    def __getitem__(self, name: str) -> Signal:
        """Return the signal of a named sub-specification, or of any formula over the same variables."""
        formula = self.specification.named(name)
        for variable in variables(formula):
            if variable not in self.trace.columns:
                raise signals.missing_variable(variable, tuple(self.trace.columns))
        check_bounds(formula, self.trace.period, name)
        return Signal(self.trace.times, self.specification.robustness_of(formula, self.trace))


def parse(
    text: str,
    *,
    period: Duration | None = None,
    unit: str = "s",
    backend: str = "cpp",
    constants: Mapping[str, float] | None = None,
    language: Language = STL,
) -> Specification:
    """Read a requirement: a formula, or the whole text of a specification file.

    ``period``: the sampling period, seconds or text such as ``"100ms"``; if it is given, every bound
    must be a multiple of it. ``unit``: of bounds without one. ``backend``: ``"cpp"`` or ``"python"``.
    ``constants``: named numbers. Raises :class:`SpecificationError` with the place in the text.

    >>> import rtamt
    >>> spec = rtamt.parse("always((req >= 3) -> eventually[0:5](gnt >= 3))")
    >>> spec.input_names
    ('req', 'gnt')
    """
    if backend not in BACKENDS:
        raise UsageError(
            f"unknown backend '{backend}'{did_you_mean(backend, BACKENDS)}; choose from {', '.join(BACKENDS)}"
        )
    document = parse_document(text, language=language, unit=unit, constants=constants)
    exact = None if period is None else positive_period(period)
    spec = Specification(document, exact, unit, backend, language)
    if exact is not None:
        for assertion in document.assertions:
            check_bounds(assertion.formula, exact, text)
    return spec


def load(path: str | os.PathLike[str], **options: Any) -> Specification:
    """Read a specification file (``.stl``); options as for :func:`parse`."""
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except OSError as error:
        raise UsageError(f"cannot read the specification '{path}': {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise UsageError(
            f"'{path}' is not UTF-8 text (byte {error.start}); is it a specification?"
        ) from error
    return parse(text, **options)


def robustness(text: str, data: Any, **options: Any) -> float:
    """Return the robustness of a recording at its first instant; options as for :func:`parse`.

    >>> import rtamt
    >>> rtamt.robustness("eventually(x >= 3)", {"x": [1, 2, 5]})
    2.0
    """
    return parse(text, **options).evaluate(data).robustness


def positive_period(period: Duration) -> Fraction:
    """Return a sampling period in seconds, exact."""
    exact = duration(period)
    if exact <= 0:
        raise UsageError(f"the sampling period is {period!r}; it must be positive")
    return exact
