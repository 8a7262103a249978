"""Queries on a complete recording, and their evaluation with cached plans."""

from __future__ import annotations

from functools import cached_property

from rtamt.engine.engine import engine_of
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from rtamt.engine.direct import Direct
    from rtamt.engine.engine import Engine
    from rtamt.language.formula import Formula
    from rtamt.rewrite.semantics import PredicateSemantics
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.coding import Types
    from rtamt.signals.signal import Signal
    from rtamt.signals.time_domain_interface import DomainTrace, TimeDomain


@dataclass(frozen=True)
class Query:
    """A formula under its semantics, and the time domain in which recordings are read.

    ``text``: the source text of the formula. ``unit``: the unit of numeric times (None: seconds). ``engine``: that
    of the time domain.
    """

    formula: Formula
    text: str
    domain: TimeDomain
    semantics: str | PredicateSemantics
    unit: str | None
    engine: Engine

    @cached_property
    def formulas(self) -> tuple[Formula]:
        """The formula as the only one of a program."""
        return (self.formula,)

    def record(self, data: Any, names: Sequence[str], types: Types) -> DomainTrace:
        """Normalise a finished recording of the variables ``names``. Raises :class:`TraceError`.

        ``types``: of the variables that are no plain numbers.
        """
        found = self.read(data, names, types)
        return self.domain.record(data, names, self.unit, types) if found is None else found

    def read(self, data: Any, names: Sequence[str], types: Types) -> DomainTrace | None:
        """Return the recording if the data needs no conversion and is valid, else None."""
        return None if types or self.unit is not None else self.engine.read(data, names, self.domain)


class Evaluators:
    """Computes robustness signals on one back end, and caches compiled plans."""

    def __init__(self, backend: str) -> None:
        self._backend = backend
        self._evaluators: dict[Any, Callable[[Any], Sequence[Any]]] = {}

    def __reduce__(self) -> tuple[type[Evaluators], tuple[str]]:
        return Evaluators, (self._backend,)  # a copy compiles anew

    def __call__(self, formulas: tuple[Formula, ...], recording: DomainTrace) -> list[Signal]:
        """As :meth:`signals`."""
        return self.signals(formulas, recording)

    def signals(self, formulas: tuple[Formula, ...], recording: DomainTrace) -> list[Signal]:
        """Return the robustness signal of each formula over a recording, all from one program."""
        if recording.bounds:  # an import takes a microsecond each time, as long as a short evaluation
            from rtamt.rewrite.presence import channel_of, presences, tracked

            if asked := presences(*formulas):
                formulas = tuple(map(tracked, formulas))
                recording = recording.with_presence({name: channel_of(name) for name in asked})
        evaluator: Any = self._evaluator(formulas, recording)
        if recording.bounds:
            return list(evaluator(recording))
        return recording.signals(evaluator(recording))

    def direct(self, query: Query, recording: DomainTrace) -> Direct | None:
        """Return the evaluator of a query over data like this recording, all samples known; None if there is none."""
        make = getattr(self._evaluator(query.formulas, recording), "direct", None)
        return None if make is None else make(query.domain, recording)

    def rows(
        self,
        formulas: tuple[Formula],
        one: DomainTrace,
        columns: Mapping[str, FloatArray],
        rows: NDArray[np.int64],
        results: FloatArray,
    ) -> bool:
        """Write the robustness of a formula in these rows of the columns to the same rows of ``results``.

        The recordings in these rows differ from ``one`` in values alone. False where it has to be evaluated
        recording by recording.
        """
        evaluate = getattr(self._evaluator(formulas, one), "rows", None)
        n = len(next(iter(one.columns.values())))
        return evaluate is not None and evaluate(columns, rows, n, results)

    @staticmethod
    def new_rows(count: int, width: int) -> FloatArray:
        """Return a new array of any numbers for so many recordings, in memory that is used again."""
        from rtamt.engine.native import new_rows

        return new_rows(count, width)

    def _evaluator(
        self, formulas: tuple[Formula, ...], recording: DomainTrace
    ) -> Callable[[Any], Sequence[Any]]:
        step, inputs = recording.step, tuple(recording.columns)
        bounded = bool(recording.bounds)
        ratio = step.as_integer_ratio()  # fractions are slow to hash
        key = (type(recording), bounded, formulas, ratio, inputs)
        evaluator = self._evaluators.get(key)
        if evaluator is None:
            backend = engine_of(recording.domain).backends[self._backend]
            grounded = recording.domain.ground(*formulas)
            make = backend.bounds if bounded else backend.evaluator
            evaluator = self._evaluators[key] = make(grounded, step, inputs)
        return evaluator
