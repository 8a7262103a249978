"""Online in dense time: by how much the newest samples alone violate or satisfy a formula."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Any, ClassVar

from rtamt.compiler.graph import FOREVER
from rtamt.engine.native import EarlyMonitorBase
from rtamt.errors import TraceError, UsageError
from rtamt.signals import arrays
from rtamt.signals.outcomes import Causation, CausationRun
from rtamt.signals.samples import time_of
from rtamt.usage_guard import exclusive
from rtamt.verdicts.early.causation import CausationMonitor, not_exact
from rtamt.verdicts.early.dense import DenseEarlyMonitor

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rtamt.language.formula import Formula
    from rtamt.signals.ticks import TimeScale


class DenseCausationMonitor(DenseEarlyMonitor, CausationMonitor, EarlyMonitorBase):
    """Reports by how much each sample, watermark and the end of the trace alone violate or satisfy a formula.

    Built by ``Specification.monitor(verdict="causation", time="dense")``. A sample makes known its own tick, and
    the value of its variable since the sample before.

    >>> import rtamt
    >>> monitor = rtamt.parse("eventually[0:1](x >= 3)").monitor(verdict="causation", time="dense")
    >>> monitor.update(0.5, x=4), monitor.update(2.5, x=1)
    (Causation(violation=inf, satisfaction=1.0), Causation(violation=1.0, satisfaction=1.0))
    >>> monitor.runs()[0]
    CausationRun(begin=0.5, end=1.500000001, violation=1.0, satisfaction=1.0)
    """

    _remembered: ClassVar[tuple[str, ...]] = ("_finished", "_scale")

    if TYPE_CHECKING:  # by the base

        def update(self, time: Any, /, **values: Any) -> Causation:
            """Take the values of any variables at one instant, ``time`` as for the other modes.

            Return by how much they alone violate and satisfy the formula at the start of the trace.

            Raises :class:`TraceError` for wrong data and :class:`EvaluationError` where an operation has no
            value; the monitor is then as it was.
            """

    def _update_carefully(self, /, *given: Any, **values: Any) -> Causation:
        """Take an instant that the core rejected, or report what is wrong with it."""
        time = time_of(given)
        with self._usage:
            scale, tick, known = self._check_sample(time, values)
            self._check_in_order(tick, scale, known)
            if tick <= self._backend.closed:
                final = f"everything up to {scale.show(self._backend.closed)} is final"
                raise TraceError(
                    f"the sample at {scale.show(tick)} comes too late: {final}; leave it out, or set the "
                    f"watermark later",
                    variable=arrays.TIME,
                    index=self.samples,
                )
            return self._event(lambda: self._backend.learn(tick, self._row_of(known), self.samples), scale)

    def _check_sample(self, time: Any, values: Mapping[str, Any]) -> tuple[TimeScale, int, dict[str, Any]]:
        scale, tick, known = super()._check_sample(time, values)
        for name, bounds in known.items():
            if bounds is None or bounds[0] != bounds[1]:
                count = self._backend.counts[self._inputs.index(name)]
                raise not_exact(name, values.get(name), count, f"time {scale.show(tick)}")
        return scale, tick, known

    def _event(self, happens: Callable[[], None], scale: TimeScale | None) -> Causation:
        """Let the back end learn something; return what that causes."""
        before, self._scale = self._scale, scale
        try:
            happens()
        except BaseException as error:
            wrong = self._no_value(error, scale) if isinstance(error, self._undefined) else None
            self._scale = before
            if isinstance(error, self._refused):
                raise self._refusal(error) from None
            if wrong is not None:
                raise wrong from None
            raise
        self._set_time_scale()
        return self.causation()

    @exclusive
    def watermark(self, time: Any) -> Causation:
        """Declare that no sample at or before a time will arrive: every variable holds its value up to it.

        Return by how much that alone violates and satisfies the formula at the start of the trace.
        """
        if self._finished:
            raise self._is_finished()
        scale = self._scale_of(time)
        tick = int(scale.ticks([time], arrays.TIME)[0])
        return self._event(lambda: self._backend.watermark(tick), scale)

    @exclusive
    def finish(self) -> Causation:
        """End the trace: every variable holds its last value. Return what that causes at the start."""
        if self._finished:
            return Causation(inf, -inf)
        self._require_samples()
        self._event(self._backend.finish, self._scale)
        self._finished = True
        return self.causation()

    # ---- results ---------------------------------------------------------------------------------

    def causation(self, time: Any = None) -> Causation:
        """Return the causation of the last call at an instant, by default at the start of the trace.

        A formula of unbounded future has causation at the start alone.
        """
        if time is None:
            return Causation(*self._backend.causation_at_start())
        self._require_bounded_past()
        scale = self._scale_of(time)
        tick = int(scale.ticks([time], arrays.TIME)[0])
        found = self._backend.causation(0, tick)
        if found is None:
            raise UsageError(
                f"the trace has not started at {scale.show(tick)}: it does when every variable has a sample"
            )
        return Causation(*found)

    def runs(self) -> list[CausationRun]:
        """See :meth:`CausationMonitor.runs`."""
        self._require_bounded_past()
        rows = self._backend.caused(0)
        begins = self._times([row[0] for row in rows])
        ends = self._times([row[1] for row in rows if row[1] < FOREVER])
        ends += [None] * (len(begins) - len(ends))
        return [
            CausationRun(begin, end, *row[2:])
            for begin, end, row in zip(begins, ends, rows, strict=True)
            if begin != end  # else no time is in it
        ]

    def __getitem__(self, name: str | Formula) -> Causation:
        """Return the causation of the last call for a watched formula, at the start of the trace."""
        found = self._backend.causation(self._output(name) - self._hidden, None)
        return Causation(*(found or (inf, -inf)))
