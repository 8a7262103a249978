"""Online: bounds of the robustness from the samples so far, in all time domains.

Late samples and corrections are dealt with here; ``discrete_interval`` and ``dense_interval`` do the rest.
"""

from __future__ import annotations

from abc import abstractmethod
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from rtamt.errors import BoundError, TraceError, UsageError, choices, shown
from rtamt.language.units.durations import duration
from rtamt.rewrite.check import unbounded_future
from rtamt.signals.samples import time_of
from rtamt.usage_guard import exclusive
from rtamt.verdicts.early.monitor import EarlyMonitor

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.language.formula import Formula
    from rtamt.language.units.durations import Duration
    from rtamt.signals.outcomes import Change, Interval
    from rtamt.signals.time_domain_interface import TimeDomain

#: A monitor that replays corrections keeps about so many snapshots, with at least so many events between two of them.
_SNAPSHOTS = 16
_LEAST_EVENTS = 64

STARTS = ("start", "every")
CORRECTIONS = ("reject", "replay")


class LateSampleError(TraceError):
    """A sample arrived later than the lateness allows; a :class:`TraceError` to users."""


class IntervalMonitor(EarlyMonitor):
    """Bounds of the robustness from the samples so far.

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
            self._late = int(self._lateness / self._step)
        self._forget()
        self._prepare()

    def _forget(self) -> None:
        super()._forget()
        # What a correction is replayed on: samples, and the states before some of them.
        self._events: list[Any] = []
        self._snapshots: tuple[Any, ...] = ()
        self._retracted: tuple[Change, ...] | None = None
        # The last watermark that was given, as the back end takes it.
        self._mark: float | None = None

    def _state(self) -> tuple[Any, ...]:
        fingerprint, remembered, of_backend = super()._state()
        return fingerprint, _unshared(remembered), of_backend

    def _resume(self, state: tuple[Any, ...]) -> None:
        fingerprint, remembered, of_backend = state
        super()._resume((fingerprint, _unshared(remembered), of_backend))

    # ---- samples ---------------------------------------------------------------------------------

    if TYPE_CHECKING:  # by the base

        def update(self, time: Any, /, **values: Any) -> None:
            """Take what is known at one time: of a variable a number, bounds ``(lower, upper)``, or None if missing.

            Times are seconds, numbers of ``time_unit=``, dates or durations, and reported as they were given.
            With a ``lateness``, samples may arrive in any order, variables one by one, and may be made more precise.
            Raises :class:`TraceError` for wrong data and :class:`EvaluationError` where an operation has no
            value; the monitor is then as it was.
            """

    def _update_carefully(self, /, *given: Any, **values: Any) -> None:
        """Take a sample that the core rejected, or report what is wrong with it."""
        time = time_of(given)
        with self._usage:
            self._take(time, values)

    @abstractmethod
    def _take(self, time: Any, values: dict[str, Any]) -> None:
        """Take a sample."""

    @abstractmethod
    def _format_time(self, time: float) -> str:
        """Return a time in the form of the back end for a message."""

    def _learn(self, time: float, known: Mapping[str, tuple[float, float] | None]) -> None:
        """Take a sample in whatever order; replay the trace from before where it corrects an earlier one."""
        place = self._backend.place(time)
        observations, wrong = [], []
        for name, bounds in known.items():
            if bounds is None:
                continue
            number = self._inputs.index(name)
            low, high = self._backend.known(number, place)
            if low <= bounds[0] and bounds[1] <= high:
                observations.append((number, *bounds))
            elif bounds[0] <= low and high <= bounds[1] and (low, high) != self._known_ranges()[number]:
                continue  # less precise than what is known
            else:
                wrong.append((number, *bounds))
                if not self._replays:
                    raise TraceError(
                        f"'{name}' is {_text(bounds)} at {self._format_time(time)}, which contradicts what was known "
                        f"of it, {_text((low, high))}: correct it, or make the monitor with on_correction='replay'",
                        variable=name,
                        index=self.samples,
                    )
        self._settle_presence(place)
        if wrong:
            self._replay(time, place, [*observations, *wrong])
            return
        if self._replays:
            self._keep_snapshot()
        self._backend.learn(time, observations, self._backend.samples)
        self._retracted = None
        if self._replays:
            self._events.append((time, place, tuple(observations)))

    def _settle_presence(self, place: int) -> None:
        """Before a sample makes others final: variables without a sample there have none."""

    def _keep_snapshot(self) -> None:
        """Keep a state from time to time, of which one is before every sample that may be corrected."""
        backend = self._backend
        events = len(self._events)
        if self._snapshots and events - self._snapshots[-1][1] < max(_LEAST_EVENTS, events // _SNAPSHOTS):
            return
        kept = (*self._snapshots, (backend.newest, len(self._events), backend.state()))
        usable = [i for i, (newest, _, _) in enumerate(kept) if newest <= backend.closed]
        kept = kept[usable[-1] :] if usable else kept
        first = kept[0][1]
        self._events = self._events[first:]
        self._snapshots = tuple((newest, count - first, state) for newest, count, state in kept)

    def _replay(self, time: float, place: int, observations: list[tuple[int, float, float]]) -> None:
        before = self._backend
        corrected = {number for number, _, _ in observations}
        usable = [each for each in self._snapshots if each[0] < place]
        _, first, state = usable[-1]
        events = list(self._events[:first])
        for then, there, taken in self._events[first:]:
            kept = tuple(lesson for lesson in taken if there != place or lesson[0] not in corrected)
            events.append((then, there, kept))
        events.append((time, place, tuple(observations)))
        backend = self._session.open()
        backend.restore(state)
        for then, _, taken in events[first:]:
            backend.learn(then, list(taken), backend.samples)
        if self._mark is not None:
            backend.watermark(self._mark)
        self._connect(backend)
        self._events = events
        self._snapshots = tuple(usable)
        self._retracted = self._differences(before, backend)

    @abstractmethod
    def _differences(self, before: Any, after: Any) -> tuple[Change, ...]:
        """Return the changes of a correction, from two monitors of the back end."""

    @exclusive
    def watermark(self, time: Any) -> None:
        """Declare that no sample at or before a time will arrive.

        In discrete time what is missing up to it stays unknown; in dense time every variable holds its value.
        """
        self._mark_at(time)

    @exclusive
    def advance(self, now: Any) -> None:
        """Set the current time: samples older than the lateness will not arrive."""
        self._mark_at(now, late=True)

    @abstractmethod
    def _mark_at(self, time: Any, *, late: bool = False) -> None:
        """Set the watermark; ``late``: whether it follows from the lateness."""

    def _watermark(self, time: float) -> None:
        self._backend.watermark(time)
        self._mark = time if self._mark is None else max(self._mark, time)

    # ---- results ---------------------------------------------------------------------------------

    @abstractmethod
    def interval(self, time: Any = None, *, prediction: Mapping[str, Any] | None = None) -> Interval:
        """Return the bounds at the start of the trace, or at an instant that is not long final (``at="every"``).

        ``prediction``: what samples after the newest one are supposed to be, for this call alone:
        from a variable to (lower, upper), two numbers for all later samples, or two arrays over the next ones. In
        dense time, what the signal is supposed to be after the newest sample of its variable: two numbers, or
        (times, lower, upper), three arrays of bounds from each time on, the last for ever.
        The robustness lies within the bounds if the samples do; see :func:`rtamt.calibrate`. The
        cost of a call is proportional to the length of the arrays.
        """

    def changes(self) -> list[Change]:
        """Return the runs of samples up to the newest one whose bounds the last update changed, with the new bounds."""
        if self.at == "start":
            raise self._start_only()
        return self._changes(0)

    def _start_only(self) -> UsageError:
        return UsageError("the monitor gives bounds at the start alone; make it with at='every' for others")

    def __getitem__(self, name: str | Formula) -> list[Change]:
        """Return the changes of a formula that is watched, as :meth:`changes` does for the formula itself."""
        return self._changes(self._output(name) - self._hidden)

    def _changes(self, output: int) -> list[Change]:
        if self._retracted is not None and output == 0:
            return list(self._retracted)
        return [self._change(*run, output=output) for run in self._backend.changes(output)]

    @abstractmethod
    def _change(
        self, begin: int, end: int, lower: float, upper: float, *, output: int = 0, retracted: bool = False
    ) -> Change:
        """Return a run of the back end as a change, with its bounds."""

    @abstractmethod
    def finish(self) -> list[Change]:
        """End the trace; return the bounds that were still open, which are final now."""


def _unshared(remembered: Mapping[str, Any]) -> dict[str, Any]:
    """Return a copy of what a monitor remembers, with copies of the lists, which grow in place."""
    return {name: list(each) if isinstance(each, list) else each for name, each in remembered.items()}


def _text(bounds: tuple[float, float]) -> str:
    low, high = bounds
    return f"{low:.15g}" if low == high else f"[{low:.15g}, {high:.15g}]"


def _choice(what: str, given: Any, known: Sequence[str]) -> None:
    if given not in known:
        raise UsageError(f"{what} is {shown(given)}{choices(given, known, 'choices')}")
