"""Online in discrete time: by how much each sample alone violates or satisfies a formula."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.compiler.graph import FOREVER
from rtamt.engine.native import EarlyMonitorBase
from rtamt.errors import UsageError
from rtamt.signals.outcomes import Causation, CausationRun
from rtamt.signals.samples import time_of
from rtamt.usage_guard import exclusive
from rtamt.verdicts.early.causation import CausationMonitor, not_exact
from rtamt.verdicts.early.discrete import DiscreteEarlyMonitor

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.language.formula import Formula
    from rtamt.verdicts.early.caller_clock import Timestamp


class DiscreteCausationMonitor(DiscreteEarlyMonitor, CausationMonitor, EarlyMonitorBase):
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

    if TYPE_CHECKING:  # by the base

        def update(self, time: Any, /, **values: Any) -> Causation:
            """Take one sample, ``time`` in seconds and a number for every variable.

            Return by how much it alone violates and satisfies the formula at the start of the trace.

            Raises :class:`TraceError` for wrong data and :class:`EvaluationError` where an operation has no
            value; the monitor is then as it was.
            """

    def _update_carefully(self, /, *given: Any, **values: Any) -> Causation:
        """Take a sample that the core rejected, or report what is wrong with it."""
        caused: Causation = self._take_in_order(time_of(given), values)
        return caused

    def _bounds_of(
        self, values: Mapping[str, Any], index: int, stamp: Timestamp
    ) -> dict[str, tuple[float, float] | None]:
        known = super()._bounds_of(values, index, stamp)
        for name, bounds in known.items():
            if bounds is None or bounds[0] != bounds[1]:
                raise not_exact(name, values[name], index, f"time {stamp}")
        return known

    def causation(self, time: Any = None) -> Causation:
        """Return the causation of the newest sample at an instant, by default at the start of the trace.

        A formula of unbounded future has causation at the start alone.
        """
        if time is None:
            return Causation(*self._backend.causation_at_start())
        self._require_bounded_past()
        backend = self._backend
        stamp = self._stamp(time)
        sample = backend.place(stamp.seconds) if backend.newest >= 0 else None
        if sample is None or sample < 0:
            raise UsageError(f"there is no sample at {stamp}")
        return Causation(*backend.causation(0, sample))

    def runs(self) -> list[CausationRun]:
        """See :meth:`CausationMonitor.runs`."""
        self._require_bounded_past()
        backend, clock = self._backend, self._clock
        return [
            CausationRun(
                clock.time(backend.time(first)),
                None if last >= FOREVER else clock.time(backend.time(last)),
                violation,
                satisfaction,
            )
            for first, last, violation, satisfaction in backend.caused(0)
        ]

    def __getitem__(self, name: str | Formula) -> Causation:
        """Return the causation of the newest sample for a watched formula, at the start of the trace."""
        return Causation(*self._backend.causation(self._output(name) - self._hidden, 0))

    @exclusive
    def finish(self) -> None:
        """End the trace; the causation of every sample is already known."""
        if not self._finished:
            self._end()
            self._finished = True
