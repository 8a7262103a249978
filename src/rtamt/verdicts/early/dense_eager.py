"""Online in dense time: the verdict of every instant as soon as no later sample can change it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from rtamt.engine.native import EarlyMonitorBase
from rtamt.signals.outcomes import VerdictRun
from rtamt.signals.samples import time_of
from rtamt.usage_guard import exclusive
from rtamt.verdicts.early.dense import DenseEarlyMonitor

if TYPE_CHECKING:
    from rtamt.language.formula import Formula
    from rtamt.signals.outcomes import Cause
    from rtamt.signals.time_domain_interface import TimeDomain


class DenseEagerMonitor(DenseEarlyMonitor, EarlyMonitorBase):
    """Reports whether a formula holds at each instant, each once, as soon as no later sample can change it.

    Built by ``Specification.monitor(verdict="eager", time="dense")``.

    >>> import rtamt
    >>> monitor = rtamt.parse("always[0:9](x >= 3)").monitor(verdict="eager", time="dense")
    >>> monitor.update(0.5, x=4), monitor.update(1.5, x=2)
    ([], [VerdictRun(begin=0.5, end=1.500000001, satisfied=False, decided_at=1.5)])
    """

    _remembered: ClassVar[tuple[str, ...]] = ("_finished", "_scale", "_evidence")
    _reports_verdicts = True

    def __init__(self, formula: Formula, domain: TimeDomain, **settings: Any) -> None:
        super().__init__(formula, domain, **settings)
        self._forget()
        self._prepare()

    if TYPE_CHECKING:  # by the base

        def update(self, time: Any, /, **values: Any) -> list[VerdictRun]:
            """Take the values of any variables at one instant; return the runs of instants that became settled.

            ``time``: seconds, numbers in ``time_unit=``, or a datetime. A value is a number, bounds
            ``(lower, upper)``, or None if it is missing from here on.

            Raises :class:`TraceError` for wrong data and :class:`EvaluationError` where an operation has no
            value; the monitor is then as it was.
            """

    def _update_carefully(self, /, *given: Any, **values: Any) -> list[VerdictRun]:
        """Take an instant that the core rejected, or report what is wrong with it."""
        time = time_of(given)
        with self._usage:
            scale, tick, known = self._check_sample(time, values)
            self._check_in_order(tick, scale, known)
            try:
                self._backend.learn(tick, self._row_of(known), self.samples)
            except self._refused as error:
                raise self._refusal(error) from None
            except self._undefined as error:
                raise self._no_value(error, scale) from None
            self._scale = scale
            self._set_time_scale()
            if self._evidence is not None:
                self._evidence.take(tick, time, self._read_by_formula(values))
            return self._news(0)

    def explain(self, verdict: VerdictRun) -> list[Cause]:
        """Return the values that decide a run of verdicts, as :meth:`EagerMonitor.explain`: all instants of it.

        >>> import rtamt
        >>> spec = rtamt.parse("always[0:9](x >= 3)")
        >>> monitor = spec.monitor(verdict="eager", explain=True, time="dense")
        >>> found = [monitor.update(t, x=x) for t, x in [(0.5, 4), (1.5, 2)]]
        >>> monitor.explain(found[1][0])
        [Cause(variable='x', time=1.5, value=2)]
        """
        return self._explain(verdict)

    @exclusive
    def finish(self) -> list[VerdictRun]:
        """End the trace, so that each variable holds its last value; return the verdicts that were still open."""
        if self._finished:
            return []
        self._require_samples()
        try:
            self._backend.finish()
        except self._undefined as error:
            raise self._no_value(error) from None
        self._finished = True
        return self._news(0)

    def __getitem__(self, name: str | Formula) -> list[VerdictRun]:
        """Return the verdicts of a formula that is watched which the last call settled."""
        return self._news(self._output(name))

    def _news(self, output: int) -> list[VerdictRun]:
        runs = self._backend.verdicts(output)
        begins, ends, decided = (self._times([run[i] for run in runs]) for i in (0, 1, 3))
        return [
            VerdictRun(begin, end, run[2], at)
            for begin, end, at, run in zip(begins, ends, decided, runs, strict=True)
            if begin != end  # else no time is in it
        ]


def decided_ticks(monitor: DenseEagerMonitor, output: int) -> list[tuple[int, int, bool, int]]:
    """Return the decisions of the last call on an output: runs (begin, end, satisfied, decided at) in ticks."""
    found: list[tuple[int, int, bool, int]] = monitor._backend.verdicts(output)
    return found
