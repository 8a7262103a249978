"""Online in discrete time: bounds of the robustness, from whatever is known of the signals by now.

What is not a plain number in order is dealt with here: intervals, missing and late samples, corrections.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from rtamt.compiler.early import FOREVER
from rtamt.engine.gate import alone, in_use
from rtamt.errors import BoundError, TraceError, UsageError, did_you_mean, shown
from rtamt.language.units import duration, format_duration
from rtamt.rewrite.check import unbounded_future
from rtamt.signals import arrays
from rtamt.signals.outcomes import Interval
from rtamt.signals.regular import irregular
from rtamt.verdicts.early import EarlyMonitor

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.language.formula import Formula
    from rtamt.language.units import Duration
    from rtamt.signals.domain_interface import TimeDomain

#: How many samples come between two snapshots of a monitor that replays corrections.
_SNAPSHOT_EVERY = 64

STARTS = ("start", "every")
CORRECTIONS = ("reject", "replay")


class Change(NamedTuple):
    """The bounds that samples from ``begin`` to ``end`` have now, which changed; ``final`` if they stay.

    ``retracted``: whether they are outside what they were, after a correction.
    """

    begin: Any
    end: Any
    interval: Interval
    final: bool
    retracted: bool = False


class IntervalMonitor(EarlyMonitor):
    """Bounds of the robustness, from whatever is known of the signals by now.

    Built by ``Specification.monitor(verdict="interval")``.

    >>> import rtamt
    >>> monitor = rtamt.parse("eventually[0:2](x >= 3)").monitor(verdict="interval", ranges={"x": (0, 10)})
    >>> monitor.update(0, x=4)
    >>> monitor.interval()
    Interval(lower=1.0, upper=7.0)
    >>> monitor.update(1, x=(7.5, 8))
    >>> monitor.interval(0), monitor.interval(1)
    (Interval(lower=4.5, upper=7.0), Interval(lower=4.5, upper=7.0))
    """

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
    )
    _verdict = None

    def __init__(
        self,
        formula: Formula,
        domain: TimeDomain,
        *,
        at: str | None = None,
        lateness: Duration | None = None,
        on_correction: str = "reject",
        **settings: Any,
    ) -> None:
        open_ended = unbounded_future(formula)
        if at is None:
            at = "every" if open_ended is None else "start"
        _choice("at", at, STARTS)
        _choice("on_correction", on_correction, CORRECTIONS)
        if at == "every" and open_ended is not None:
            raise BoundError(
                f"'{open_ended.op.name}' without an upper bound is open at every instant; "
                f"ask for the start of the trace with at='start', or give it a bound",
                settings.get("text"),
                open_ended.span,
            )
        super().__init__(formula, domain, start=True, every=at == "every", **settings)
        self.at = at
        self._lateness = Fraction(0) if lateness is None else duration(lateness)
        if self._lateness < 0:
            raise UsageError(f"the lateness is {shown(lateness)}; it must not be negative")
        self._replays = on_correction == "replay"
        if self._lateness > 0 or self._replays:
            self._late = int(self._lateness / self._period)
        self._forget()
        self._prepare()

    def _forget(self) -> None:
        self._rest: tuple[Any, ...] = ()
        #: Of each output the samples whose bounds were open when the trace ended.
        self._open_at_end: tuple[tuple[int, ...], ...] = ()
        # Samples that came before it is known where the trace starts.
        self._early: tuple[Any, ...] = ()
        self._at_end: Interval | None = None
        # What a correction is replayed on: samples, and the states before some of them.
        self._events: tuple[Any, ...] = ()
        self._snapshots: tuple[Any, ...] = ()
        self._retracted: tuple[Change, ...] | None = None

    # ---- samples ---------------------------------------------------------------------------------

    if TYPE_CHECKING:  # by the base

        def update(self, time: Any, /, **values: Any) -> None:
            """Take what is known at one time: of a variable a number, bounds ``(lower, upper)``, or None if missing.

            Times are seconds, numbers of ``time_unit=``, dates or durations, and reported as they were given.
            With a ``lateness``, samples may come in any order, variables one by one, and may be made more precise.
            Raises :class:`TraceError` for wrong data and :class:`EvaluationError` where an operation has no
            value; the monitor is then as it was.
            """

    def _update_carefully(self, time: Any, /, **values: Any) -> None:
        """Take a sample that the core did not take, or find out what is wrong with it."""
        with self._gate:
            self._take(time, values)

    @property
    def _count(self) -> int:
        return self.samples + len(self._early)

    def _take(self, time: Any, values: dict[str, Any]) -> None:
        flat = self._read_by_formula(values)
        if self._finished:
            raise self._is_finished()
        index = self.samples
        stamp = self._stamp(time)
        seconds = stamp.seconds
        known = self._bounds_of(flat, index, seconds)
        begun = self._late is None or self._backend.newest >= 0
        try:
            if self._late is None:
                self._check_order(seconds)
                self._backend.take(seconds, *self._row(known), index)
            elif begun:
                self._check_late(seconds)
                self._learn(seconds, known)
            else:
                self._begin(seconds, known)
        except self._refused:
            raise in_use() from None
        except self._undefined as error:
            raise self._no_value(error) from None
        self._remember(stamp, begun=begun)

    def _begin(self, time: float, known: dict[str, tuple[float, float] | None]) -> None:
        """Keep the first samples until no earlier one can come: only then it is known where the trace starts."""
        self._early = (*self._early, (time, known))
        times = [time for time, _ in self._early]
        assert self._late is not None
        if round((max(times) - min(times)) / float(self._period)) > self._late:
            self._start()

    def _start(self) -> None:
        early = sorted(self._early, key=lambda sample: sample[0])
        kept = (self._events, self._snapshots)
        try:
            for time, known in early:
                if self._backend.newest >= 0:
                    self._check_late(time)
                self._learn(time, known)
        except BaseException as error:
            self._connect(self._session.open())
            self._early, (self._events, self._snapshots) = self._early[:-1], kept
            if isinstance(error, self._undefined):
                raise self._no_value(error) from None
            raise
        self._early = ()

    def _check_late(self, time: float) -> None:
        backend = self._backend
        if backend.newest < 0:
            return
        place = backend.place(time)
        last = backend.time(backend.newest)
        if place is None:
            raise irregular(self.samples, time, last, self._period, self._tolerance)
        if place <= backend.closed:
            raise TraceError(
                f"sample {self.samples} is of time {time:.15g} s, later than the lateness of "
                f"{format_duration(self._lateness)} allows: what was up to {backend.time(backend.closed):.15g} s "
                f"is final; leave it out, or allow for more lateness",
                variable=arrays.TIME,
                index=self.samples,
            )

    def _learn(self, time: float, known: Mapping[str, tuple[float, float] | None]) -> None:
        """Take a sample in whatever order; replay the trace from before where it corrects an earlier one."""
        place = self._backend.place(time)
        lessons, wrong = [], []
        for name, bounds in known.items():
            if bounds is None:
                continue
            number = self.input_names.index(name)
            low, high = self._backend.known(number, place)
            if low <= bounds[0] and bounds[1] <= high:
                lessons.append((number, *bounds))
            elif bounds[0] <= low and high <= bounds[1] and (low, high) != self._known_ranges()[number]:
                continue  # less precise than what is known
            else:
                wrong.append((number, *bounds))
                if not self._replays:
                    raise TraceError(
                        f"'{name}' is {_text(bounds)} at time {time:.15g} s, which contradicts what was known of "
                        f"it, {_text((low, high))}: correct it, or make the monitor with on_correction='replay'",
                        variable=name,
                        index=self.samples,
                    )
        if wrong:
            self._replay(time, place, [*lessons, *wrong])
            return
        if self._replays:
            self._keep_snapshot()
        self._backend.learn(time, lessons, self.samples)
        self._retracted = None
        if self._replays:
            self._events = (*self._events, (time, place, tuple(lessons)))

    def _keep_snapshot(self) -> None:
        """Keep a state from time to time, of which one is before every sample that may be corrected."""
        backend = self._backend
        if self._snapshots and len(self._events) - self._snapshots[-1][1] < _SNAPSHOT_EVERY:
            return
        kept = (*self._snapshots, (backend.newest, len(self._events), backend.state()))
        usable = [i for i, (newest, _, _) in enumerate(kept) if newest <= backend.closed]
        kept = kept[usable[-1] :] if usable else kept
        first = kept[0][1]
        self._events = self._events[first:]
        self._snapshots = tuple((newest, count - first, state) for newest, count, state in kept)

    def _replay(self, time: float, place: int, lessons: list[tuple[int, float, float]]) -> None:
        before = self._backend
        corrected = {number for number, _, _ in lessons}
        usable = [each for each in self._snapshots if each[0] < place]
        _, first, state = usable[-1]
        events = list(self._events[:first])
        for then, there, taken in self._events[first:]:
            kept = tuple(lesson for lesson in taken if there != place or lesson[0] not in corrected)
            events.append((then, there, kept))
        events.append((time, place, tuple(lessons)))
        backend = self._session.open()
        backend.restore(state)
        for then, _, taken in events[first:]:
            backend.learn(then, list(taken), backend.samples)
        self._connect(backend)
        self._events = tuple(events)
        self._snapshots = tuple(usable)
        self._retracted = self._differences(before, backend)

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

    @alone
    def watermark(self, time: Any) -> None:
        """Say that nothing at or before a time will come: what is missing there stays unknown."""
        if self._finished:
            raise self._is_finished()
        self._watermark(self._seconds(time))

    @alone
    def advance(self, now: Any) -> None:
        """Say what time it is: nothing that is later than the lateness will come."""
        if self._finished:
            raise self._is_finished()
        self._watermark(self._seconds(now) - float(self._lateness))

    def _watermark(self, time: float) -> None:
        if self._early and time >= min(then for then, _ in self._early):
            self._start()
        self._backend.watermark(time)

    # ---- answers ---------------------------------------------------------------------------------

    def interval(self, time: Any = None) -> Interval:
        """Return the bounds at the start of the trace, or at a sample that is not long final (``at="every"``)."""
        if time is None:
            return Interval(*self._backend.origin()) if self._at_end is None else self._at_end
        if self.at == "start":
            raise UsageError(
                "the monitor gives bounds at the start alone; make it with at='every' for others"
            )
        backend = self._backend
        stamp = self._seconds(time)
        sample = backend.place(stamp) if backend.newest >= 0 else round(Fraction(stamp) / self._period)
        if sample is None or sample < 0:
            raise UsageError(f"there is no sample at {stamp:.15g} s")
        if self._rest:
            first, values = self._rest[0]
            found = values[sample - first] if first <= sample < first + len(values) else None
        else:
            found = backend.bounds(0, sample)
        if found is None:
            raise UsageError(
                f"the bounds at {stamp:.15g} s are final and no longer kept; read them from changes() when they are"
            )
        return Interval(*found)

    def changes(self) -> list[Change]:
        """Return runs of samples up to the newest one whose bounds the last update changed, with what they are now."""
        if self.at == "start":
            raise UsageError(
                "the monitor gives bounds at the start alone; make it with at='every' for others"
            )
        return self._changes(0)

    def __getitem__(self, name: str | Formula) -> list[Change]:
        """Return the changes of a formula that is watched, as :meth:`changes` does for the formula itself."""
        return self._changes(self._output(name) - self._hidden)

    def _changes(self, output: int) -> list[Change]:
        if self._rest:
            first, values = self._rest[output]
            return [self._change(t, t, *values[t - first], output=output) for t in self._open_at_end[output]]
        if self._retracted is not None and output == 0:
            return list(self._retracted)
        return [self._change(*run, output=output) for run in self._backend.changes(output)]

    def _change(
        self, first: int, last: int, lower: float, upper: float, *, output: int = 0, retracted: bool = False
    ) -> Change:
        backend = self._backend
        lag = max(0, self._graph.horizon(self._outputs[output]))
        final = self._finished or lower == upper or (lag < FOREVER and last + lag <= backend.closed)
        begin, end = (self._clock.time(backend.time(t)) for t in (first, last))
        return Change(begin, end, Interval(lower, upper), final, retracted)

    @alone
    def finish(self) -> list[Change]:
        """Say that no more samples will come; return the bounds that were still open, which are final now."""
        if not self._finished:
            if self._early:
                self._start()
            backend = self._backend
            before = [
                {t: backend.bounds(output, t) for t in range(backend.held(output), backend.newest + 1)}
                for output in range(len(self._outputs))
            ]
            rest, at_end = backend.finish()
            self._at_end = None if at_end is None else Interval(*at_end)
            self._rest = tuple(rest)
            # In one class of formulas the end changes bounds that had met.
            self._open_at_end = tuple(
                tuple(
                    t
                    for t, ends in each.items()
                    if t >= first and (ends[0] != ends[1] or ends != values[t - first])
                )
                for each, (first, values) in zip(before, rest, strict=True)
            )
            self._finished = True
        if self.at == "start" or self._hidden:
            return []
        return self._changes(0)

    @alone
    def reset(self) -> None:
        """Forget the trace; the next sample is the first."""
        self._finished = False
        self._clock = self._clock.cleared()
        self._forget()
        self._connect(self._session.open())


def _text(bounds: tuple[float, float]) -> str:
    low, high = bounds
    return f"{low:.15g}" if low == high else f"[{low:.15g}, {high:.15g}]"


def _choice(what: str, given: Any, choices: Sequence[str]) -> None:
    if given not in choices:
        raise UsageError(
            f"{what} is {shown(given)}{did_you_mean(str(given), choices)}; choose from {', '.join(choices)}"
        )
