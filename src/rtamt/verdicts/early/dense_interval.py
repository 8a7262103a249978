"""Bounds of the robustness in dense time: every variable has its own samples, and holds its value between them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from rtamt.compiler.graph import FOREVER, NEVER
from rtamt.engine.native import EarlyMonitorBase
from rtamt.errors import TraceError, UsageError
from rtamt.language.units.durations import format_duration
from rtamt.signals import arrays, dense_arrays
from rtamt.signals.outcomes import Change, Interval
from rtamt.signals.runs import clipped, compared, merged
from rtamt.usage_guard import exclusive
from rtamt.verdicts.early.dense import DenseEarlyMonitor
from rtamt.verdicts.early.interval import IntervalMonitor, LateSampleError
from rtamt.verdicts.early.prediction import later_steps

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.signals.runs import Run
    from rtamt.signals.ticks import TimeScale
    from rtamt.verdicts.early.prediction import Step


class DenseIntervalMonitor(DenseEarlyMonitor, IntervalMonitor, EarlyMonitorBase):
    """Bounds of the robustness in dense time from the samples so far.

    Built by ``Specification.monitor(verdict="interval", time="dense")``. A sample holds up to the next one of its
    variable; without a ``lateness``, each variable has its samples in order.

    >>> import rtamt
    >>> monitor = rtamt.parse("eventually[0:2](x >= 3)").monitor(
    ...     verdict="interval", time="dense", ranges={"x": (0, 10)}
    ... )
    >>> monitor.update(0.5, x=4)
    >>> monitor.interval()
    Interval(lower=1.0, upper=7.0)
    >>> monitor.update(2.5, x=(1.5, 2))
    >>> monitor.interval(0.5), monitor.interval(1.5)
    (Interval(lower=1.0, upper=1.0), Interval(lower=1.0, upper=7.0))
    """

    _remembered: ClassVar[tuple[str, ...]] = (
        "_finished",
        "_scale",
        "_events",
        "_snapshots",
        "_retracted",
        "_mark",
        "_ended",
    )

    def _forget(self) -> None:
        super()._forget()
        #: Of each output the runs whose bounds were open when the trace ended.
        self._ended: tuple[tuple[Run, ...], ...] = ()

    def _take(self, time: Any, values: dict[str, Any]) -> None:
        scale, tick, known = self._check_sample(time, values)
        if self._late is None:
            self._check_in_order(tick, scale, known)
        self._check_open(tick, scale)
        ranges = dict(zip(self._inputs, self._known_ranges(), strict=True))
        before, self._scale = self._scale, scale
        try:
            if self._late is None:
                self._backend.learn(tick, self._row_of(known), self.samples)
            else:
                self._learn(tick, {name: bounds or ranges[name] for name, bounds in known.items()})
        except BaseException as error:
            self._scale = before
            if isinstance(error, self._refused):
                raise self._refusal(error) from None
            if isinstance(error, self._undefined):
                raise self._no_value(error, scale) from None
            raise
        self._set_time_scale()

    def _check_open(self, tick: int, scale: TimeScale) -> None:
        """Raise the error for a sample at a time that is already closed."""
        backend = self._backend
        if tick > backend.closed:
            return
        final = f"everything up to {scale.show(backend.closed)} is final; leave it out, or"
        if self._late is None:
            raise TraceError(
                f"the sample at {scale.show(tick)} comes too late: {final} set the watermark later",
                variable=arrays.TIME,
                index=self.samples,
            )
        raise LateSampleError(
            f"the sample at {scale.show(tick)} is later than the lateness of "
            f"{format_duration(self._lateness)} allows: {final} allow for more lateness",
            variable=arrays.TIME,
            index=self.samples,
        )

    def _format_time(self, time: float) -> str:
        return f"time {self._caller_time(int(time))}"

    def _differences(self, before: Any, after: Any) -> tuple[Change, ...]:
        if self._hidden:
            return ()
        changes = []
        for begin, end, was, now in compared(before.runs(0), after.runs(0)):
            if was is not None and was != now:
                retracted = not (was[0] <= now[0] and now[1] <= was[1])
                changes.append(self._change(begin, end, *now, retracted=retracted))
        return tuple(changes)

    def _mark_at(self, time: Any, *, late: bool = False) -> None:
        if self._finished:
            raise self._is_finished()
        scale = self._scale_of(time)
        tick = int(scale.ticks([time], arrays.TIME)[0]) - (self._late or 0 if late else 0)
        try:
            self._watermark(tick)
        except self._undefined as error:
            raise self._no_value(error, scale) from None
        self._retracted = None
        self._scale = scale

    # ---- results ---------------------------------------------------------------------------------

    def interval(self, time: Any = None, *, prediction: Mapping[str, Any] | None = None) -> Interval:
        """See :meth:`IntervalMonitor.interval`."""
        later = None if prediction is None else self._later(prediction)
        if time is None:
            return Interval(*(self._backend.at_start() if later is None else self._supposed(None, 0, later)))
        if self.at == "start":
            raise self._start_only()
        scale = self._scale_of(time)
        tick = int(scale.ticks([time], arrays.TIME)[0])
        found = self._backend.bounds(0, tick) if later is None else self._supposed(0, tick, later)
        if found is None:
            begun = self._backend.held(0)
            if begun is None:
                raise UsageError(
                    "the trace has not started: it does when every variable has a sample, and no earlier one can come"
                )
            raise UsageError(
                f"the bounds at {scale.show(tick)} are not kept, which are those from {scale.show(begun)} on; "
                f"read them from changes() when they are"
            )
        return Interval(*found)

    def _later(self, prediction: Mapping[str, Any]) -> list[Step]:
        """Return predictions in the form of the back end."""
        if self._finished:
            raise UsageError("the trace has ended, so that there is nothing to predict")
        scale = self._scale
        if scale is None or self._backend.complete == NEVER:
            raise UsageError(
                "the trace has not started: it does when every variable has a sample, and no earlier one can come; "
                "predictions follow the newest"
            )
        return later_steps(
            prediction,
            self._inputs,
            self._known_ranges(),
            lambda times, name: dense_arrays.samples_of((times, [0.0] * len(times)), name, scale, 0, None)[
                0
            ].tolist(),
        )

    def _supposed(self, output: int | None, tick: int, later: list[Step]) -> Any:
        try:
            return self._backend.supposed(output, tick, later)
        except self._undefined as error:
            raise self._no_value(error) from None

    def _changes(self, output: int) -> list[Change]:
        if self._finished:
            found = [self._change(*run, output=output) for run in self._ended[output]]
        else:
            found = super()._changes(output)
        return [each for each in found if each.begin != each.end]  # else no time is in it

    def _change(
        self, begin: int, end: int, lower: float, upper: float, *, output: int = 0, retracted: bool = False
    ) -> Change:
        lag = self._session.lag(output)
        complete = self._backend.complete
        final = self._finished or lower == upper or (lag < FOREVER and end - 1 + lag <= complete)
        first, last = self._times([begin, end])
        return Change(first, last, Interval(lower, upper), final, retracted)

    def _first_open(self, output: int) -> int:
        """Return the first tick at which an output may still change."""
        lag, complete = self._session.lag(output), self._backend.complete
        return NEVER if lag >= FOREVER or complete <= NEVER else int(complete) - lag + 1

    @exclusive
    def finish(self) -> list[Change]:
        """End the trace: every variable holds its last value. Return the bounds that were still open."""
        if self._finished:
            return []
        self._require_samples()
        backend = self._backend
        outputs = self._outputs
        first = [self._first_open(output) for output in outputs]
        before = [backend.runs(output) for output in outputs]
        try:
            backend.finish()
        except self._undefined as error:
            raise self._no_value(error) from None
        self._ended = tuple(
            _were_open(before[output], backend.runs(output), first[output]) for output in outputs
        )
        self._finished = True
        return [] if self.at == "start" else self._changes(0)


def _were_open(before: Sequence[Run], now: Sequence[Run], first: int) -> tuple[Run, ...]:
    """Return the runs of now, from a tick on, whose bounds were not equal before, or others."""
    return merged(
        (begin, end, *bounds)
        for begin, end, was, bounds in compared(before, tuple(clipped(now, first, FOREVER)))
        if was != bounds or was[0] != was[1]
    )
