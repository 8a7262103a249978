"""Bounds of the robustness in discrete time: missing and late samples, and the end, which cuts windows."""

from __future__ import annotations

from bisect import bisect_right
from contextlib import contextmanager
from fractions import Fraction
from heapq import heappop, heappush
from itertools import pairwise
from math import floor, inf
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

from rtamt.compiler.graph import FOREVER
from rtamt.engine import SlowPath, inner_of
from rtamt.engine.native import EarlyMonitorBase
from rtamt.errors import UsageError
from rtamt.language.units.durations import format_duration
from rtamt.signals import arrays
from rtamt.signals.outcomes import Change, Interval
from rtamt.signals.sampling_period import irregular
from rtamt.usage_guard import exclusive, in_use
from rtamt.verdicts.early.discrete import DiscreteEarlyMonitor
from rtamt.verdicts.early.interval import IntervalMonitor, LateSampleError
from rtamt.verdicts.early.prediction import Later, later_samples
from rtamt.verdicts.early.rehearsal import Rehearsal

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

#: The first and the last sample with the same bounds, and these.
Run: TypeAlias = "tuple[int, int, float, float]"


class DiscreteIntervalMonitor(DiscreteEarlyMonitor, IntervalMonitor, EarlyMonitorBase):
    """Bounds of the robustness at samples, built by ``Specification.monitor(verdict="interval")``."""

    _remembered: ClassVar[tuple[str, ...]] = (
        "_finished",
        "_clock",
        "_early",
        "_rest",
        "_open_at_end",
        "_at_end",
        "_events",
        "_snapshots",
        "_retracted",
        "_mark",
        "_filled",
        "_noted",
        "_moments",
    )

    def _forget(self) -> None:
        super()._forget()
        # The number of steps of the back end without a sample.
        self._filled = 0
        #: What that changed of each output, since the last sample or watermark.
        self._noted: dict[int, tuple[Any, ...]] = {}
        #: The first samples and their times, which the back end need not keep, while their report is the last one.
        self._moments: tuple[tuple[int, float], ...] = ()
        self._rest: tuple[Any, ...] = ()
        #: Of each output the samples whose bounds were open when the trace ended.
        self._open_at_end: tuple[tuple[int, ...], ...] = ()
        # Samples that arrived before the start of the trace was known.
        self._early: list[Any] = []
        # A back end that has taken them.
        self._rehearsal: Rehearsal | None = None
        self._at_end: Interval | None = None
        # The state of the back end before a call that takes several steps, any of which may fail.
        self._before: bytes | None = None

    # ---- samples ---------------------------------------------------------------------------------

    @property
    def samples(self) -> int:
        """See :class:`EarlyMonitor`."""
        return super().samples - self._filled

    def _resume(self, state: tuple[Any, ...]) -> None:
        self._rehearsal = None  # the original goes on with it
        super()._resume(state)

    def _connect(self, backend: Any) -> None:
        # The core alone would not forget what was noted when it takes the next sample.
        super()._connect(SlowPath(inner_of(backend)) if self._noted else backend)

    def _note(self, noted: dict[int, tuple[Any, ...]]) -> None:
        """Record what one sample changed apart from the last step of the back end."""
        self._moments = ()
        if noted != self._noted:
            self._noted = noted
            self._connect(inner_of(self._backend))

    def _settle_presence(self, place: int) -> None:
        self._note({})
        if self._late is not None:
            self._fill(max(self._backend.newest, place) - self._late - 1)

    def _fill(self, last: int) -> None:
        """Note where variables have no sample, up to an instant that becomes final."""
        numbers = [self._inputs.index(channel) for channel in self._channels.values()]
        backend = self._backend
        for place in range(backend.closed + 1, last + 1) if numbers else ():
            open_here = [k for k in numbers if len(set(backend.known(k, place))) > 1]
            if not open_here:
                continue
            self._keep()
            ahead = max(place - backend.newest, 0)
            time = backend.time(place - ahead) + ahead * float(self._step)
            observations = tuple((k, 0.0, 0.0) for k in open_here)
            backend.learn(time, list(observations), backend.samples)
            self._filled += 1
            for output in self._outputs:
                changed = (*self._noted.get(output, ()), *backend.changes(output))
                self._noted = {**self._noted, output: changed}
            if self._replays:
                self._events.append((time, place, observations))

    @contextmanager
    def _whole(self) -> Iterator[None]:
        """Undo what a call has done if one of its steps fails; of the back end, what followed :meth:`_keep`."""
        remembered = {name: getattr(self, name) for name in self._remembered}
        lengths = [(each, len(each)) for each in remembered.values() if isinstance(each, list)]
        try:
            yield
        except BaseException:
            self.__dict__.update(remembered)
            for each, length in lengths:  # which only grow
                del each[length:]
            backend = inner_of(self._backend)
            if self._before is not None:
                backend = self._session.open()
                backend.restore(self._before)
            self._connect(backend)
            raise
        finally:
            self._before = None

    def _keep(self) -> None:
        """Keep the state of the back end before the first of several steps."""
        if self._before is None:
            self._before = self._backend.state()

    @property
    def _count(self) -> int:
        return self.samples + len(self._early)

    def _take(self, time: Any, values: dict[str, Any]) -> None:
        flat = self._read_by_formula(values)
        if self._finished:
            raise self._is_finished()
        index = self._count
        stamp = self._stamp(time)
        seconds = stamp.seconds
        known = self._bounds_of(flat, index, seconds)
        begun = self._late is None or self._backend.newest >= 0
        try:
            if self._late is None:
                self._check_order(seconds)
                self._backend.take(seconds, *self._row(known), index)
            else:
                with self._whole():
                    if begun:
                        self._check_late(seconds)
                        self._learn(seconds, known)
                    else:
                        self._check_first(seconds)
                        self._begin(seconds, known)
        except self._refused:
            raise in_use() from None
        except self._undefined as error:
            raise self._no_value(error) from None
        self._remember(stamp, begun=begun)

    def _begin(self, time: float, known: dict[str, tuple[float, float] | None]) -> None:
        """Buffer the first samples until no earlier one can arrive: the start of the trace is unknown before."""
        times = self._rehearse(time, known)
        self._early.append((time, known))
        assert self._late is not None
        late = round((times[-1] - times[0]) / float(self._step)) >= self._late
        if late or self._is_first(times[0], self._mark):
            self._start()

    def _is_first(self, time: float, mark: float | None) -> bool:
        """Return whether a watermark excludes all samples before one."""
        return mark is not None and (mark - time) / float(self._step) + self._tolerance >= -1

    def _rehearse(self, time: float, known: dict[str, tuple[float, float] | None]) -> list[float]:
        """Raise the error for a sample that cannot be taken once the trace starts, and every later one with it.

        Returns the times of all first samples, in order.
        """
        samples, rehearsal = [(time, known)], self._rehearsal
        if rehearsal is None or not rehearsal.fits(time, float(self._step), self._tolerance):
            samples = sorted([*self._early, *samples], key=lambda sample: sample[0])
            anywhere = not (self._replays or self._channels)
            rehearsal = Rehearsal(self._session.open(), self._late if anywhere else None)
        remembered = {name: getattr(self, name) for name in self._remembered}
        backend = inner_of(self._backend)
        try:
            self._events, self._snapshots = rehearsal.events, rehearsal.snapshots
            self._connect(rehearsal.backend)
            for each in samples:
                self._check_late(each[0])
                place = self._backend.place(each[0])
                try:
                    self._learn(*each)
                except self._undefined as error:
                    step, wrong = error.args
                    error.args = step, rehearsal.number(wrong, place)
                    raise
                rehearsal.add(each[0], place)
            rehearsal.backend = inner_of(self._backend)
            rehearsal.events, rehearsal.snapshots = self._events, self._snapshots
        finally:
            self.__dict__.update(remembered)
            self._connect(backend)
        self._rehearsal = rehearsal
        return rehearsal.times

    def _start(self) -> None:
        """Take the samples that were kept; all that they changed counts as changed by the last of them."""
        self._keep()
        self._rehearsal = None
        noted: dict[int, list[Any]] = {output: [] for output in self._outputs}
        moments: list[tuple[int, float]] = []
        for time, known in sorted(self._early, key=lambda sample: sample[0]):
            before = self._backend.newest
            if before >= 0:
                self._check_late(time)
            self._learn(time, known)
            if self._backend.newest > before:
                moments.append((self._backend.newest, time))
            for output, runs in noted.items():
                runs.extend(self._news(output))
        self._early = []
        self._note({output: tuple(runs) for output, runs in noted.items()})
        self._moments = tuple(moments)
        self._retracted = None  # nothing was reported that a correction could retract

    def _news(self, output: int) -> list[Any]:
        """Return the runs of samples whose bounds the back end changed while it took a sample."""
        backend = self._backend
        if self._retracted is None:
            return [*self._noted.get(output, ()), *backend.changes(output)]
        return [(t, t, *backend.bounds(output, t)) for t in range(backend.held(output), backend.newest + 1)]

    def _check_late(self, time: float) -> None:
        backend = self._backend
        if backend.newest < 0:
            return
        place = backend.place(time)
        last = backend.time(backend.newest)
        if place is None:
            raise irregular(self.samples, time, last, self._step, self._tolerance)
        if place <= backend.closed:
            raise self._too_late(self.samples, time, backend.time(backend.closed))

    def _check_first(self, time: float) -> None:
        """Raise the error for a first sample that is too late for the newest one of them, or for the watermark."""
        assert self._late is not None
        newest = max((then for then, _ in self._early), default=None)
        last, closed = (time, -inf) if newest is None else (newest, -self._late - 1)
        period = float(self._step)
        if self._mark is not None:
            closed = max(closed, floor((self._mark - last) / period + self._tolerance))
        steps = round((time - last) / period)
        if steps > closed:
            return
        if abs(time - last - steps * period) > self._tolerance * period:
            raise irregular(self._count, time, last, self._step, self._tolerance)
        raise self._too_late(self._count, time, last + closed * period)

    def _too_late(self, index: int, time: float, closed: float) -> LateSampleError:
        """Return the error for a sample; ``closed``: the last time at which none can arrive any more."""
        return LateSampleError(
            f"sample {index}, at {time:.15g} s, is later than the lateness of "
            f"{format_duration(self._lateness)} allows: everything up to {closed:.15g} s "
            f"is final; leave it out, or allow for more lateness",
            variable=arrays.TIME,
            index=index,
        )

    def _format_time(self, time: float) -> str:
        """Return a time in the form of the back end for a message."""
        return f"time {time:.15g} s"

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

    def _mark_at(self, time: Any, *, late: bool = False) -> None:
        if self._finished:
            raise self._is_finished()
        try:
            with self._whole():
                self._watermark(self._seconds(time) - (float(self._lateness) if late else 0))
        except self._undefined as error:
            raise self._no_value(error) from None

    def _watermark(self, time: float) -> None:
        if self._early and self._is_first(min(then for then, _ in self._early), time):
            self._start()
        else:
            self._note({})
        backend = self._backend
        if self._late is not None and backend.newest >= 0:
            ahead = floor((time - backend.time(backend.newest)) / float(self._step) + self._tolerance)
            self._fill(backend.newest + min(ahead, 0))
        super()._watermark(time)

    # ---- results ---------------------------------------------------------------------------------

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
        stamp = self._seconds(time)
        sample = backend.place(stamp) if backend.newest >= 0 else round(Fraction(stamp) / self._step)
        if sample is None or sample < 0:
            raise UsageError(f"there is no sample at {stamp:.15g} s")
        if self._rest:
            first, values = self._rest[0]
            found = values[sample - first] if first <= sample < first + len(values) else None
        else:
            found = backend.bounds(0, sample) if later is None else self._supposed(0, sample, later)
        if found is None:
            raise UsageError(
                f"the bounds at {stamp:.15g} s are final and no longer kept; read them from changes() when they are"
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
        if not self._finished:
            try:
                with self._whole():
                    self._finish()
            except self._undefined as error:
                raise self._no_value(error) from None
        if self.at == "start":
            return []
        return self._changes(0)

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
