"""Samples of bounds in discrete time: exact, uncertain, missing and late ones, and the first of a trace."""

from __future__ import annotations

from contextlib import contextmanager
from math import floor, inf
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

from rtamt.engine import SlowPath, inner_of
from rtamt.engine.native import EarlyMonitorBase
from rtamt.language.undefined_value import UndefinedByDefinitionError
from rtamt.language.units.durations import format_duration
from rtamt.signals import arrays
from rtamt.signals.sampling_period import irregular
from rtamt.usage_guard import in_use
from rtamt.verdicts.early.discrete import DiscreteEarlyMonitor
from rtamt.verdicts.early.interval import IntervalMonitor, LateSampleError
from rtamt.verdicts.early.rehearsal import Rehearsal

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtamt.signals.outcomes import Interval

#: The first and the last sample with the same bounds, and these.
Run: TypeAlias = "tuple[int, int, float, float]"


class DiscreteIntervalSamples(DiscreteEarlyMonitor, IntervalMonitor, EarlyMonitorBase):
    """The part of :class:`DiscreteIntervalMonitor` that takes samples."""

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
        known = self._bounds_of(flat, index, stamp)
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
            raise self._no_value(error, stamp) from None
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
                except UndefinedByDefinitionError:  # which counts samples from the earliest one
                    raise
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
            raise irregular(
                self.samples, time, time - last, self._step, self._tolerance, dated=self._clock.dated
            )
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
            raise irregular(
                self._count, time, time - last, self._step, self._tolerance, dated=self._clock.dated
            )
        raise self._too_late(self._count, time, last + closed * period)

    def _too_late(self, index: int, time: float, closed: float) -> LateSampleError:
        """Return the error for a sample; ``closed``: the last time at which none can arrive any more."""
        at, until = map(self._clock.text, (time, closed))
        return LateSampleError(
            f"sample {index}, at {at}, is later than the lateness of "
            f"{format_duration(self._lateness)} allows: everything up to {until} "
            f"is final; leave it out, or allow for more lateness",
            variable=arrays.TIME,
            index=index,
        )

    def _format_time(self, time: float) -> str:
        """Return a time in the form of the back end for a message."""
        return f"time {self._clock.text(time)}"

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
