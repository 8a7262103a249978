"""Online in discrete time: by how much each sample alone violates or satisfies a formula."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.compiler.causation import compile_causes
from rtamt.engine.native import EarlyMonitorBase
from rtamt.engine.online import time_of
from rtamt.engine.usage_guard import exclusive
from rtamt.errors import SpecificationError, TraceError, UsageError, shown
from rtamt.language.printing.printer import excerpt
from rtamt.rewrite.check import unbounded_future
from rtamt.rewrite.early import causeless
from rtamt.signals.outcomes import Causation
from rtamt.verdicts.discrete_early import DiscreteEarlyMonitor

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.compiler.graph import Graph
    from rtamt.engine.online import Watched
    from rtamt.language.formula import Formula
    from rtamt.signals.domain_interface import TimeDomain


START_ONLY = "a formula of unbounded future has causation at the start of the trace alone; call causation()"


def check_causation(formula: Formula, text: str | None, watch: Sequence[Watched]) -> None:
    """Raise :class:`SpecificationError` for a formula without causation."""
    for each, source in ((formula, text), *((w.formula, w.text) for w in watch)):
        culprit = causeless(each)
        if culprit is not None:
            raise SpecificationError(
                f"'{excerpt(culprit)}' is a share of a window, which has no causation; use another verdict mode",
                source,
                culprit.span,
            )


def not_exact(name: str, given: Any, index: int, moment: str) -> TraceError:
    """Return the error for a sample that is missing or uncertain."""
    return TraceError(
        f"'{name}' is {shown(given)} at sample {index}, {moment}, and causation needs exact samples: give a number, "
        f"or monitor with verdict='interval'",
        variable=name,
        index=index,
    )


class CausationMonitor(DiscreteEarlyMonitor, EarlyMonitorBase):
    """Reports by how much each sample alone violates or satisfies a formula.

    Built by ``Specification.monitor(verdict="causation")``.

    >>> import rtamt
    >>> monitor = rtamt.parse("always(x >= 3)").monitor(verdict="causation")
    >>> for t, x in enumerate([5, 1, 4]):
    ...     print(monitor.update(t, x=x))
    Causation(violation=2.0, satisfaction=-inf)
    Causation(violation=-2.0, satisfaction=-inf)
    Causation(violation=1.0, satisfaction=-inf)
    """

    _verdict = None

    def __init__(self, formula: Formula, domain: TimeDomain, **settings: Any) -> None:
        check_causation(formula, settings.get("text"), settings.get("watch", ()))
        self._bounded = unbounded_future(formula) is None
        super().__init__(formula, domain, start=True, every=self._bounded, **settings)
        self._forget()
        self._prepare()

    def _extend(self, graph: Graph, outputs: Sequence[Formula]) -> None:
        self._causes = compile_causes(graph, outputs)

    if TYPE_CHECKING:  # by the base

        def update(self, time: Any, /, **values: Any) -> Causation:
            """Take one sample, ``time`` in seconds and a number for every variable.

            Return by how much it alone violates and satisfies the formula at the start of the trace.

            Raises :class:`TraceError` for wrong data and :class:`EvaluationError` where an operation has no
            value; the monitor is then as it was.
            """

    def _update_carefully(self, *given: Any, **values: Any) -> Causation:
        """Take a sample that the core rejected, or report what is wrong with it."""
        return self._take_in_order(time_of(given), values)  # type: ignore[no-any-return]

    def _bounds_of(
        self, values: Mapping[str, Any], index: int, time: float
    ) -> dict[str, tuple[float, float] | None]:
        known = super()._bounds_of(values, index, time)
        for name, bounds in known.items():
            if bounds is None or bounds[0] != bounds[1]:
                raise not_exact(name, values[name], index, f"time {time:.15g} s")
        return known

    def causation(self, time: Any = None) -> Causation:
        """Return what the newest sample causes at an instant, by default at the start of the trace.

        A formula of unbounded future has causation at the start alone.
        """
        if time is None:
            return Causation(*self._backend.causation_at_start())
        if not self._bounded:
            raise UsageError(START_ONLY)
        backend = self._backend
        stamp = self._seconds(time)
        sample = backend.place(stamp) if backend.newest >= 0 else None
        if sample is None or sample < 0:
            raise UsageError(f"there is no sample at {stamp:.15g} s")
        return Causation(*backend.causation(0, sample))

    def __getitem__(self, name: str | Formula) -> Causation:
        """Return what the newest sample causes for a formula that is watched, at the start of the trace."""
        return Causation(*self._backend.causation(self._output(name) - self._hidden, 0))

    @exclusive
    def finish(self) -> None:
        """End the trace; the causation of every sample is already known."""
        self._finished = True
        self._backend.finish()
