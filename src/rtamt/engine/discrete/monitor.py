"""The discrete-time monitor: samples in, robustness out as soon as it is known; a failed update changes nothing."""

from __future__ import annotations

from math import nan

from rtamt.engine.discrete.backends import BACKENDS
from rtamt.engine.discrete.checked_samples import CheckedSamples
from rtamt.engine.native import MonitorBase
from rtamt.engine.online import OnlineMonitor, Watched, grounded
from rtamt.engine.slow_path import SlowPath, inner_of
from rtamt.language.units.durations import check_unit
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.rewrite.check import check_online
from rtamt.signals import arrays
from rtamt.signals.caller_times import CallerTimes
from rtamt.signals.discrete import DISCRETE, Discrete
from rtamt.signals.signal import Signal
from rtamt.usage_guard import exclusive

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence
    from fractions import Fraction

    from rtamt.engine.discrete.fleet import DiscreteFleet
    from rtamt.language.formula import Formula
    from rtamt.signals.arrays import Timestamps


class Monitor(MonitorBase, CheckedSamples):
    """Monitors one formula on a stream of samples in discrete time.

    Built by ``Specification.monitor``. Feed it with one of :meth:`update` (a sample by name),
    :meth:`step` (a sample by position, fastest) and :meth:`update_many` (a chunk), then
    :meth:`finish`. Values come in order, each exactly once: ρ at t as soon as the input has
    reached t + horizon.

    >>> import rtamt
    >>> monitor = rtamt.parse("always[0:1](x >= 3)").monitor(period=1)
    >>> [monitor.update(t, x=x) for t, x in enumerate([5.0, 4.0, 6.0])]
    [None, 1.0, 1.0]
    >>> monitor.finish()
    Signal(times=array([2.]), values=array([3.]))

    ``copy.copy`` branches a monitor: the copy has the same state and is independent. Pickling works likewise.
    Give each thread its own monitor: a monitor shared by threads takes each sample atomically, in some order, or
    raises :class:`UsageError`.
    """

    _remembered = ("_finished", "_news", "_times", "_episodes")
    _base = MonitorBase

    def __init__(
        self,
        formula: Formula,
        domain: Discrete = DISCRETE,
        *,
        text: str | None = None,
        backend: str = "cpp",
        declared: Collection[str] = (),
        watch: Sequence[Watched] = (),
        factory: Callable[..., OnlineMonitor] | None = None,
        unit: str | None = None,
        requirements: Sequence[Formula] = (),  # noqa: ARG002 - in discrete time they start together
        episodes: bool = False,
        worst_case: bool = False,
    ) -> None:
        domain = domain.online
        period = domain.period
        assert period is not None
        formula, watch = grounded(domain, formula, text, watch)
        for each in (Watched("", formula, text), *watch):
            check_online(each.formula, each.text)
        OnlineMonitor.__init__(self, formula, watch, declared, factory)
        if episodes:
            self._remember_episodes(continuous=False)
        self._period = period
        self._assumed = domain.assumed
        self._tolerance = domain.tolerance
        # The results of the last chunk, and the number of samples at that time: after any other update
        # the number is larger.
        self._news: tuple[int, list[Signal]] = (0, [])
        unit = None if unit is None else check_unit(unit)
        session = BACKENDS[backend].session(self._formulas, self.input_names, domain, worst_case=worst_case)
        self._session = session
        self._lags = session.lags
        self._oldest = max(self._lags)  # the largest number of samples without a value
        self._times = CallerTimes(unit, period, self._oldest)
        self._connect(session.open())

    def _connect(self, backend: Any) -> None:
        #: Whether times are seconds, so that the back end takes samples without us.
        self._plain = self._times.plain and self._episodes is None
        self._backend = backend if self._plain else SlowPath(backend)
        self._update = backend.update
        self._step = backend.step
        self._refused = self._session.refused
        self._undefined: Any = self._session.undefined

    @property
    def horizon(self) -> float:
        """Seconds after t at which ρ at t is known."""
        return float(self._lags[0] * self._period)

    @property
    def period(self) -> Fraction:
        """The sampling period in seconds."""
        return self._period

    @property
    def samples(self) -> int:
        """The number of samples since the start or the last reset."""
        return int(self._backend.samples)

    if TYPE_CHECKING:  # by the base

        def update(self, time: float, /, **values: float) -> float | None:
            """Take one sample: ``time`` in seconds, or in ``time_unit=``, and a number for every variable.

            Returns ρ at ``time - horizon``; None until the horizon has passed. Raises
            :class:`TraceError` for wrong data and :class:`EvaluationError` where an operation has no
            value; the monitor is then unchanged. A formula that reads ``req.value`` takes an object
            with that field as ``req=``, or the number as ``**{"req.value": 3}``.

            >>> import rtamt
            >>> monitor = rtamt.parse("(req >= 3) -> eventually[0:1](gnt >= 3)").monitor()
            >>> print(monitor.update(0.0, req=5, gnt=0), monitor.update(1.0, req=0, gnt=4))
            None 1.0
            """

        def step(self, *values: float) -> float | None:
            """Take one sample by position, in the order of ``input_names``, one period after the last.

            Returns and raises as :meth:`update` does; for loops in which a microsecond counts.

            >>> import rtamt
            >>> monitor = rtamt.parse("once[0:1](x >= y)").monitor(period=0.1)
            >>> monitor.input_names
            ('x', 'y')
            >>> [monitor.step(5, 4), monitor.step(1, 4)]
            [1.0, 1.0]
            """

    @exclusive
    def update_many(self, data: Any) -> Signal:
        """Take a chunk of samples: a mapping (or frame) from variable to values, with ``"time"``.

        Returns the new values as a Signal. ``"time"`` is optional; without it, samples are one
        period apart. Raises the errors of :meth:`update`.

        >>> import rtamt
        >>> monitor = rtamt.parse("always[0:1](x >= 3)").monitor()
        >>> monitor.update_many({"time": [0, 1, 2], "x": [5, 4, 6]})
        Signal(times=array([0., 1.]), values=array([1., 1.]))
        """
        if self._finished:
            raise self._is_finished()
        if data.__class__ is not dict or self._binding.columns or self._binding.unread:
            data = self._binding.applied(data)
        taken = self._take_columns(data)
        if taken is not None:
            return taken
        regular = self.is_period_known(data)
        names, unit, first = self.input_names, self._times.unit, self.samples
        return self._push(*arrays.columns_of(data, names, unit, self._types, first=first, regular=regular))

    def is_period_known(self, data: Any) -> bool:
        """See :func:`rtamt.signals.assumed_period.is_known`."""
        from rtamt.signals.assumed_period import is_known  # samples alone do not need it

        return is_known(data, self.samples, given=not self._assumed)

    def _take_columns(self, data: Any) -> Signal | None:
        """Take a chunk that needs no conversion; None for any other, which is not taken."""
        if not self._plain:
            return None
        try:
            taken = self._backend.take_columns(data, arrays.TIME)
        except self._undefined as error:
            raise self._no_value(error) from None
        if taken is None:
            return None
        samples, known = taken
        news = [Signal(times, values) for times, values in known]
        self._news = samples, news
        return news[0]

    def _push(self, timestamps: Timestamps | None, given: Mapping[str, arrays.FloatArray], n: int) -> Signal:
        """See :func:`push_samples`."""
        samples = self.samples
        (times, original), columns = self._chunk(timestamps, given, n)
        before = self._recent(min(self._oldest, samples))
        try:
            known = self._backend.push(times, columns, samples)
        except self._undefined as error:
            raise self._no_value(error, dated=arrays.are_dates(original)) from None
        if not self._times.plain or (len(original) and original is not times):
            self._remember(original)
        every = np.concatenate((before, original)) if len(before) else original
        news = []
        for lag, values in zip(self._lags, known, strict=True):
            first = len(before) - min(lag, samples)
            news.append(Signal(every[first : first + len(values)], values))
        self._news = samples + len(times), news
        self._note(news)
        return news[0]

    @exclusive
    def finish(self) -> Signal:
        """End the trace and return the values that were still unknown.

        >>> import rtamt
        >>> monitor = rtamt.parse("always[0:1](x >= 3)").monitor()
        >>> _ = monitor.update_many({"time": [0, 1, 2], "x": [5, 4, 6]})
        >>> monitor.finish()
        Signal(times=array([2.]), values=array([3.]))
        """
        if self._finished:
            return Signal(self._recent(0), np.empty(0))
        try:
            known = self._backend.finish()
        except self._undefined as error:
            raise self._no_value(error) from None
        self._finished = True
        news = [Signal(self._recent(len(values)), values) for values in known]
        self._news = self.samples, news
        self._note(news)
        return news[0]

    def _note(self, news: list[Signal]) -> None:
        """Look at what a chunk made known of each formula."""
        if self._episodes is None:
            return
        from rtamt.signals.episodes import plain_times

        for tracker, signal in zip(self._episodes, news, strict=True):
            tracker.take(zip(plain_times(signal.times), signal.values.tolist(), strict=True))

    def __getitem__(self, name: str | Formula) -> float | Signal | None:
        """Return the new values of a watched formula after the last update (see ``Specification.monitor``).

        ``name``: as given to ``watch=``. After :meth:`update` and :meth:`step` it is the value at the time of
        the sample minus the formula's own horizon, None before that; after :meth:`update_many` and
        :meth:`finish` it is a Signal. Raises :class:`UsageError` for a formula that is not watched.

        >>> import rtamt
        >>> monitor = rtamt.parse("eventually[0:1](x >= 3)").monitor(watch=["x >= 3"])
        >>> print(monitor.update(0.0, x=1), monitor["x >= 3"])
        None -2.0
        """
        output = self._output(name)
        samples, news = self._news
        if news and samples == self.samples:
            return news[output]
        value: float | None = self._backend.latest(output)
        return value

    @exclusive
    def reset(self, /, **parameters: Any) -> None:
        """Forget the trace; the next sample is the first.

        ``parameters``: their values from now on, as ``Specification.with_parameters`` takes them.

        >>> import rtamt
        >>> monitor = rtamt.parse("once(x >= 3)").monitor()
        >>> monitor.update(0.0, x=9)
        6.0
        >>> monitor.reset()
        >>> monitor.update(0.0, x=1)
        -2.0
        """
        self._assign(parameters)
        self._backend.reset()
        self._finished = False
        self._news = (0, [])
        if self._episodes is not None:
            self._remember_episodes(continuous=False)
        if self._times.original is not None:
            self._times = replace(self._times, original=None)
            self._connect(inner_of(self._backend))

    def records(
        self,
        capacity: int,
        *,
        restart: bool,
        state: bytes | None,
        identities: Mapping[str, str],
        watched: bool = False,
    ) -> DiscreteFleet | None:
        """See :class:`OnlineMonitor`."""
        from rtamt.engine.discrete.fleet import DiscreteFleet, has_records  # monitors do not wait for it

        if not has_records(self, watched=watched):
            return None
        return DiscreteFleet(
            self, capacity, restart=restart, state=state, identities=identities, watched=watched
        )


def push_samples(
    monitor: Monitor, timestamps: Timestamps | None, columns: Mapping[str, arrays.FloatArray], n: int
) -> Signal:
    """Take a chunk of ``n`` samples as returned by ``arrays.columns_of``; not thread-safe."""
    return monitor._push(timestamps, columns, n)


def last_settled_time(monitor: Monitor, *, known: bool) -> Any:
    """Return the time that the value is for which the last sample made known, in the caller's format.

    If no value is ``known``, NaN or NaT.
    """
    if known:
        return arrays.plain(monitor._recent(monitor._lags[0] + 1)[0])
    original = monitor._times.original
    return nan if original is None or original.dtype.kind not in "mM" else original.dtype.type("NaT", "ns")
