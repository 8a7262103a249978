"""Bounds of the robustness in discrete time: what is reported, and the end, which cuts windows."""

from __future__ import annotations

from bisect import bisect_right
from fractions import Fraction
from heapq import heappop, heappush
from itertools import pairwise
from math import inf
from typing import TYPE_CHECKING, Any, TypeAlias

from rtamt.compiler.graph import FOREVER
from rtamt.errors import UsageError
from rtamt.signals.outcomes import Change, Interval
from rtamt.usage_guard import exclusive
from rtamt.verdicts.early.discrete_samples import DiscreteIntervalSamples
from rtamt.verdicts.early.prediction import Later, later_samples

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

#: The first and the last sample with the same bounds, and these.
Run: TypeAlias = "tuple[int, int, float, float]"


class DiscreteIntervalMonitor(DiscreteIntervalSamples):
    """Bounds of the robustness at samples, built by ``Specification.monitor(verdict="interval")``."""

    def interval(self, time: Any = None, *, prediction: Mapping[str, Any] | None = None) -> Interval:
        """See :meth:`IntervalMonitor.interval`."""
        later = None if prediction is None else self._later(prediction)
        if time is None:
            if later is not None:
                return Interval(*self._supposed(None, 0, later))
            return Interval(*self._backend.at_start()) if self._at_end is None else self._at_end
        if self.at == "start":
            raise self._start_only()
        backend = self._backend
        stamp = self._stamp(time)
        if self._early:  # which instant of the trace this is depends on samples that may still come
            raise UsageError(
                f"the trace has not started at {stamp}: it does when no earlier sample can come; "
                f"until then interval() gives the bounds at its start"
            )
        seconds = stamp.seconds
        sample = backend.place(seconds) if backend.newest >= 0 else round(Fraction(seconds) / self._step)
        if sample is None or sample < 0:
            raise UsageError(f"there is no sample at {stamp}")
        if self._rest:
            first, values = self._rest[0]
            found = values[sample - first] if first <= sample < first + len(values) else None
        else:
            found = backend.bounds(0, sample) if later is None else self._supposed(0, sample, later)
        if found is None:
            raise UsageError(
                f"the bounds at {stamp} are final and no longer kept; read them from changes() when they are"
            )
        return Interval(*found)

    def _later(self, prediction: Mapping[str, Any]) -> list[Later]:
        """Return predictions in the form of the back end."""
        if self._finished:
            raise UsageError("the trace has ended, so that there is nothing to predict")
        if self._early:
            raise UsageError(
                "the trace has not started: it does when no earlier sample can come, and predictions follow the newest"
            )
        return later_samples(prediction, self._inputs, self._known_ranges())

    def _supposed(self, output: int | None, sample: int, later: list[Later]) -> Any:
        try:
            return self._backend.supposed(output, sample, later)
        except self._undefined as error:
            raise self._no_value(error) from None

    def _changes(self, output: int) -> list[Change]:
        if self._rest:
            first, values = self._rest[output]
            return [self._change(t, t, *values[t - first], output=output) for t in self._open_at_end[output]]
        if self._retracted is not None and output == 0:
            now = list(self._retracted)
        else:
            now = self._backend.reported(output)
            if not self._clock.plain:
                time = self._clock.time
                now = [each._replace(begin=time(each.begin), end=time(each.end)) for each in now]
        noted = self._noted.get(output)
        if not noted:
            return now
        if self._retracted is None or output:
            return [
                self._change(*run, output=output) for run in latest((*noted, *self._backend.changes(output)))
            ]
        last = {change.begin for change in now}
        before = [self._change(*run, output=output) for run in noted]
        return [*(change for change in before if change.begin not in last), *now]

    def _change(
        self, first: int, last: int, lower: float, upper: float, *, output: int = 0, retracted: bool = False
    ) -> Change:
        backend = self._backend
        lag = self._session.lag(output)
        final = (
            self._finished
            or lower == upper
            or (lag < FOREVER and last + lag <= min(backend.closed, backend.newest))
        )
        begin, end = (self._clock.time(self._time_of(t)) for t in (first, last))
        return Change(begin, end, Interval(lower, upper), final, retracted)

    def _differences(self, before: Any, after: Any) -> tuple[Change, ...]:
        if self._hidden:
            return ()
        changes: list[Change] = []
        for sample in range(max(before.held(0), after.held(0)), after.newest + 1):
            was, now = before.bounds(0, sample), after.bounds(0, sample)
            if was != now:
                retracted = not (was[0] <= now[0] and now[1] <= was[1])
                changes.append(self._change(sample, sample, *now, retracted=retracted))
        return tuple(changes)

    def _time_of(self, sample: int) -> float:
        """Return the time of a sample that is reported."""
        place = bisect_right(self._moments, (sample, inf)) - 1
        if place < 0:
            return float(self._backend.time(sample))
        earlier, time = self._moments[place]
        return time if earlier == sample else time + (sample - earlier) * float(self._step)

    def _first_open(self, output: int) -> int:
        """Return the first sample at which an output may still change."""
        backend = self._backend
        return int(max(0, min(backend.closed, backend.newest) - self._session.lag(output) + 1))

    @exclusive
    def finish(self) -> list[Change]:
        """End the trace; return the bounds that were still open, which are final now."""
        if self._finished:
            return []
        try:
            with self._whole():
                self._finish()
        except self._undefined as error:
            raise self._no_value(error) from None
        return [] if self.at == "start" else self._changes(0)

    def _finish(self) -> None:
        unreported = bool(self._early)
        if unreported:
            self._start()
        backend = self._backend
        held = [backend.held(output) for output in self._outputs]
        before = [
            {
                t: backend.bounds(output, t)
                for t in range(first if unreported else self._first_open(output), backend.newest + 1)
            }
            for output, first in zip(self._outputs, held, strict=True)
        ]
        if self._late is not None:
            self._fill(backend.newest)
        rest, at_end = self._end()
        self._at_end = None if at_end is None else Interval(*at_end)
        self._rest = tuple(
            (kept, values[kept - first :]) for kept, (first, values) in zip(held, rest, strict=True)
        )
        # In one class of formulas the end changes bounds that had met.
        self._open_at_end = tuple(
            tuple(
                t for t, ends in each.items() if unreported or ends[0] != ends[1] or ends != values[t - first]
            )
            for each, (first, values) in zip(before, self._rest, strict=True)
        )
        self._finished = True


def latest(runs: Sequence[Run]) -> list[Run]:
    """Return runs without overlap, in the order of their samples: each sample has the bounds of its last run."""
    begins = sorted((run[0], -place) for place, run in enumerate(runs))
    cuts = sorted({cut for begin, end, _, _ in runs for cut in (begin, end + 1)})
    found: list[Run] = []
    open_runs: list[int] = []
    taken = 0
    for begin, after in pairwise(cuts):
        while taken < len(begins) and begins[taken][0] <= begin:
            heappush(open_runs, begins[taken][1])
            taken += 1
        while open_runs and runs[-open_runs[0]][1] < begin:
            heappop(open_runs)
        if not open_runs:
            continue
        bounds = runs[-open_runs[0]][2:]
        if found and found[-1][1] == begin - 1 and found[-1][2:] == bounds:
            found[-1] = (found[-1][0], after - 1, *bounds)
        else:
            found.append((begin, after - 1, *bounds))
    return found
