"""Queries on a complete recording, and their evaluation with cached plans."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rtamt.engine.engine import engine_of
from rtamt.rewrite.presence import channel_of, presences, tracked

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rtamt.language.formula import Formula
    from rtamt.rewrite.semantics import PredicateSemantics
    from rtamt.signals.coding import Types
    from rtamt.signals.domain_interface import DomainTrace, TimeDomain
    from rtamt.signals.signal import Signal


@dataclass(frozen=True, slots=True)
class Query:
    """A formula under its semantics, and the time domain in which recordings are read.

    ``text``: the source text of the formula. ``unit``: the unit of numeric times (None: seconds).
    """

    formula: Formula
    text: str
    domain: TimeDomain
    semantics: str | PredicateSemantics
    unit: str | None = None

    def record(self, data: Any, names: Sequence[str], types: Types) -> DomainTrace:
        """Normalise a finished recording of the variables ``names``. Raises :class:`TraceError`.

        ``types``: of the variables that are no plain numbers.
        """
        return self.domain.record(data, names, self.unit, types)


class Evaluators:
    """Computes robustness signals on one back end, and caches compiled plans."""

    def __init__(self, backend: str) -> None:
        self._backend = backend
        self._evaluators: dict[Any, Callable[[Any], Sequence[Any]]] = {}

    def __reduce__(self) -> tuple[type[Evaluators], tuple[str]]:
        return Evaluators, (self._backend,)  # a copy compiles anew

    def __call__(self, formulas: tuple[Formula, ...], recording: DomainTrace) -> list[Signal]:
        """Return the robustness signal of each formula over a recording, all from one program."""
        if recording.bounds and (asked := presences(*formulas)):
            formulas = tuple(map(tracked, formulas))
            recording = recording.with_presence({name: channel_of(name) for name in asked})
        step, inputs = recording.step, tuple(recording.columns)
        bounded = bool(recording.bounds)
        key = (
            type(recording),
            bounded,
            formulas,
            step.as_integer_ratio(),
            inputs,
        )  # fractions are slow to hash
        evaluator = self._evaluators.get(key)
        if evaluator is None:
            backend = engine_of(recording.domain).backends[self._backend]
            grounded = recording.domain.ground(*formulas)
            make = backend.bounds if bounded else backend.evaluator
            evaluator = self._evaluators[key] = make(grounded, step, inputs)
        return list(evaluator(recording)) if bounded else recording.signals(evaluator(recording))
