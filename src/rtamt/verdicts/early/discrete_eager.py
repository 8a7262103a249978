"""Online in discrete time: the verdict of every sample as soon as no later one can change it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.engine.native import EarlyMonitorBase
from rtamt.signals.outcomes import Verdict
from rtamt.signals.samples import time_of
from rtamt.usage_guard import exclusive
from rtamt.verdicts.early.discrete import DiscreteEarlyMonitor

if TYPE_CHECKING:
    from rtamt.language.formula import Formula
    from rtamt.signals.outcomes import Cause
    from rtamt.signals.time_domain_interface import TimeDomain


class EagerMonitor(DiscreteEarlyMonitor, EarlyMonitorBase):
    """Reports whether a formula holds at each sample, each once, as soon as no later sample can change it.

    Built by ``Specification.monitor(verdict="eager")``.

    >>> import rtamt
    >>> monitor = rtamt.parse("always[0:9](x >= 3)").monitor(verdict="eager")
    >>> monitor.update(0, x=4), monitor.update(1, x=2)
    ([], [Verdict(time=0.0, satisfied=False, decided_at=1.0), Verdict(time=1.0, satisfied=False, decided_at=1.0)])
    """

    _reports_verdicts = True

    def __init__(self, formula: Formula, domain: TimeDomain, **settings: Any) -> None:
        super().__init__(formula, domain, **settings)
        self._forget()
        self._prepare()

    if TYPE_CHECKING:  # by the base

        def update(self, time: Any, /, **values: Any) -> list[Verdict]:
            """Take one sample: its time, and a number for every variable; return what became settled.

            Times are seconds, numbers of ``time_unit=``, dates or durations, and reported as they were given. A
            value may also be bounds ``(lower, upper)``, or None if it is missing.

            Raises :class:`TraceError` for wrong data and :class:`EvaluationError` where an operation has no
            value; the monitor is then as it was.
            """

    def _update_carefully(self, /, *given: Any, **values: Any) -> list[Verdict]:
        """Take a sample that the core rejected, or report what is wrong with it."""
        found: list[Verdict] = self._take_in_order(time_of(given), values)
        if self._evidence is not None:
            time = time_of(given)
            self._evidence.take(self._steps(time), time, self._read_by_formula(values))
        return found

    def explain(self, verdict: Verdict) -> list[Cause]:
        """Return a minimal set of values that decides a verdict of the formula.

        They decide it independently of all other values, and the last of them arrived at ``verdict.decided_at``.
        Needs a monitor made with ``explain=True``, which keeps samples and takes some microseconds longer for each. A
        verdict can be explained until the next one is reported, or for ever if the formula has an operator without an
        upper bound.

        >>> import rtamt
        >>> spec = rtamt.parse("always[0:9](x >= 3 or y >= 1)")
        >>> monitor = spec.monitor(verdict="eager", explain=True)
        >>> found = [monitor.update(t, x=x, y=0) for t, x in enumerate([4, 5, 2])]
        >>> monitor.explain(found[2][0])
        [Cause(variable='x', time=2, value=2), Cause(variable='y', time=2, value=0)]
        """
        return self._explain(verdict)

    @exclusive
    def finish(self) -> list[Verdict]:
        """End the trace; return the verdicts that were still open."""
        if self._finished:
            return []
        news: list[Verdict] = self._as_given(self._end())
        self._finished = True
        return news

    def __getitem__(self, name: str | Formula) -> list[Verdict]:
        """Return the verdicts of a formula that is watched which the last call settled."""
        news: list[Verdict] = self._as_given(self._backend.verdicts(self._output(name)))
        return news

    def _as_given(self, verdicts: Any) -> Any:
        """Return verdicts with their times in the form of the caller's."""
        if self._clock.plain:
            return verdicts
        time = self._clock.time
        return [Verdict(time(each.time), each.satisfied, time(each.decided_at)) for each in verdicts]
