"""The dense-time monitor: samples of variables with their own time bases; robustness as soon as it is known."""

from __future__ import annotations

from rtamt.engine.dense.backends import BACKENDS
from rtamt.engine.dense.groups import GroupSession
from rtamt.engine.native import DenseMonitorBase, update_signal_class
from rtamt.engine.online import OnlineMonitor, Watched, depth_of, grounded
from rtamt.engine.slow_path import SlowPath
from rtamt.errors import TraceError, UsageError
from rtamt.language.contents import own_variables
from rtamt.language.undefined_value import undefined
from rtamt.language.units.durations import check_unit
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.rewrite.check import check_online
from rtamt.signals import arrays, dense_arrays
from rtamt.signals.data_errors import unknown_variable
from rtamt.signals.dense import DENSE, Dense
from rtamt.signals.dense_arrays import TickSignal
from rtamt.signals.episodes import Episode, plain_times
from rtamt.signals.samples import time_of
from rtamt.signals.signal import Signal
from rtamt.signals.ticks import TimeScale
from rtamt.usage_guard import exclusive, in_use

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence
    from fractions import Fraction

    from rtamt.errors import EvaluationError
    from rtamt.language.formula import Formula
    from rtamt.signals.dense_arrays import Samples


#: The class of the results of an update, as the compiled monitor reports them.
UpdateSignal = update_signal_class(TickSignal)


class DenseMonitor(DenseMonitorBase, OnlineMonitor):
    """Monitors one formula on signals that change at any instant.

    Built by ``Specification.monitor(time="dense")``. After every update, ρ has been reported for exactly
    the instants up to the earliest last sample of any variable, minus the horizon: never an instant
    twice, and never late. Updates return a Signal: a point for every change, and one at the
    last known instant.

    >>> import rtamt
    >>> monitor = rtamt.parse("always[0:1](x >= 3)").monitor(time="dense")
    >>> monitor.update(0.0, x=5.0)
    Signal(times=array([], dtype=float64), values=array([], dtype=float64))
    >>> monitor.update(2.5, x=4.0)
    Signal(times=array([0. , 1.5]), values=array([2., 1.]))

    ``copy.copy`` branches a monitor: the copy has the same state and is independent. Pickling works likewise.
    """

    _remembered = ("_finished", "_scale", "_episodes")
    _base = DenseMonitorBase

    def __init__(
        self,
        formula: Formula,
        domain: Dense = DENSE,
        *,
        text: str | None = None,
        backend: str = "cpp",
        declared: Collection[str] = (),
        watch: Sequence[Watched] = (),
        factory: Callable[..., OnlineMonitor] | None = None,
        scale: TimeScale | None = None,
        unit: str | None = None,
        parts: bool = False,
        requirements: Sequence[Formula] = (),
        episodes: bool = False,
    ) -> None:
        # ``requirements``: the conjuncts of the formula, each with its own trace.
        formula, watch = grounded(domain, formula, text, watch)
        requirements = domain.ground(*requirements)
        for watched in (Watched("", formula, text), *watch):
            check_online(watched.formula, watched.text)
        OnlineMonitor.__init__(self, formula, watch, declared, factory)
        domain.check_inputs(self.input_names)
        if episodes:
            self._remember_episodes(continuous=True)
        self._tick = domain.resolution
        self._given_scale = scale
        self._unit = None if unit is None else check_unit(unit)
        self._scale: TimeScale | None = None
        engine = BACKENDS[backend]
        if len({frozenset(own_variables(each, self.input_names)) for each in requirements}) > 1:
            self._session = GroupSession(requirements, self._formulas[1:], self.input_names, domain, engine)
        else:
            self._session = engine.session(
                self._formulas, self.input_names, domain, self._unread, parts=parts
            )
        self._connect(self._session.open())

    def _connect(self, backend: Any) -> None:
        self._backend = backend if self._episodes is None else SlowPath(backend)
        self._refused = self._session.refused
        self._undefined: Any = self._session.undefined
        if self._scale is not None:
            self._set_time_scale(self._scale)

    @property
    def horizon(self) -> float:
        """Seconds after t at which ρ at t is known."""
        return float(self._depth)

    @property
    def _depth(self) -> Fraction:
        return depth_of(self._formulas[0])

    @property
    def samples(self) -> int:
        """The number of samples of any variable since the start or the last reset."""
        return sum(self._backend.counts)

    if TYPE_CHECKING:  # by the base

        def update(self, time: Any, /, **values: float) -> Signal:
            """Take the values of any variables at one instant: seconds, numbers in ``time_unit=``, or a datetime.

            Without values, only the time is checked. Returns the newly known robustness. Raises :class:`TraceError`
            for wrong data and :class:`EvaluationError` where an operation has no value; the monitor is then unchanged.
            """

    def _update_carefully(self, /, *given: Any, **values: Any) -> Signal:
        """Take an instant that the core rejected, or report what is wrong with it."""
        time = time_of(given)
        flat = self._read_by_formula(values)
        for name in flat:
            if name not in self.input_names:
                raise unknown_variable(name, self.input_names)
        if not flat:
            self._scale_of([[time]]).ticks([time], arrays.TIME)
        return self._take({name: ([time], [value]) for name, value in flat.items()})

    def update_many(self, data: Any) -> Signal:
        """Take samples: a mapping from variable to (times, values), or to [time, value] pairs.

        Variables may be left out or have no samples. Returns and raises as :meth:`update` does.
        """
        arrays.require_no_unit(data, self._unit)
        data = self._binding.applied(data, partial=True)
        return self._take(dense_arrays.columns_of(data, self.input_names, self._declared))

    @exclusive
    def finish(self) -> Signal:
        """End the trace: every signal holds its last value. Returns the rest of the robustness."""
        return self._signal(self._rest())

    def _rest(self) -> Samples:
        """See :func:`finish_ticks`."""
        if self._finished:
            return np.empty(0, np.int64), np.empty(0)
        for name, last in zip(self.input_names, self._backend.last_times, strict=True):
            if last is None:
                raise TraceError(f"'{name}' has no samples; provide one before finish()", variable=name)
        known = self._run(self._backend.finish, self._scale)
        self._finished = True
        self._note(known)
        return known

    def __getitem__(self, name: str | Formula) -> Signal:
        """Return the new values of a watched formula after the last update (see ``Specification.monitor``).

        ``name``: as given to ``watch=``. The Signal has the form of the result of :meth:`update`; each
        formula has its own horizon. Raises :class:`UsageError` for a formula that is not watched.

        >>> import rtamt
        >>> monitor = rtamt.parse("eventually[0:1](x >= 3)").monitor(time="dense", watch=["x >= 3"])
        >>> _ = monitor.update(0.5, x=1.0)
        >>> monitor["x >= 3"]
        Signal(times=array([0.5]), values=array([-2.]))
        """
        return self._signal(self._known(name))

    def _known(self, name: str | Formula) -> Samples:
        """See :func:`known_ticks`."""
        known: Samples = self._backend.last_output(self._output(name))
        return known

    @exclusive
    def reset(self, /, **parameters: Any) -> None:
        """Forget the trace; the next sample is the first.

        ``parameters``: their values from now on, as ``Specification.with_parameters`` takes them.
        """
        self._assign(parameters)
        self._backend.reset()
        self._finished = False
        self._scale = None
        if self._episodes is not None:
            self._remember_episodes(continuous=True)

    # ---- the slow path ---------------------------------------------------------------------------

    def _push(self, chunk: Mapping[str, Samples], scale: TimeScale) -> Samples:
        """See :func:`push_ticks`."""
        empty = np.empty(0, np.int64), np.empty(0)
        samples = [chunk.get(name, empty) for name in self.input_names]
        known = self._run(lambda: self._backend.push(samples), scale)
        if self._scale is not scale:
            self._scale = scale
            self._set_time_scale(scale)
        self._note(known)
        return known

    def _note(self, known: Samples) -> None:
        """Look at what became known of each formula."""
        for output, tracker in enumerate(self._episodes or ()):
            ticks, values = self._backend.last_output(output) if output else known
            tracker.take(zip(ticks.tolist(), values.tolist(), strict=True))

    def episodes(self, name: str | Formula | None = None) -> list[Episode]:
        """See :meth:`OnlineMonitor.episodes`; the end of an episode is excluded."""
        found = super().episodes(name)
        if not found:
            return []
        assert self._scale is not None
        ticks = np.array([tick for each in found for tick in (each.begin, each.end, each.at)], np.int64)
        times = iter(plain_times(self._scale.times(ticks)))
        return [Episode(next(times), next(times), each.worst, next(times)) for each in found]

    @exclusive
    def _take(self, columns: dict[str, tuple[Any, Any]]) -> Signal:
        if self._finished:
            raise UsageError("the monitor has finished its trace; call reset() before the next sample")
        given = {name: column for name, column in columns.items() if len(column[0])}
        if not given and self._scale is None:
            return self._signal((np.empty(0, np.int64), np.empty(0)))
        scale = self._scale_of([times for times, _ in given.values()])
        return self._signal(self._push(self._chunk(columns, scale), scale))

    def _scale_of(self, times: Sequence[Any]) -> TimeScale:
        """Return the time scale after these times."""
        scale = self._scale or self._given_scale
        return TimeScale.of(self._tick, times, self._unit) if scale is None else scale.widened(times)

    def _set_time_scale(self, scale: TimeScale) -> None:
        """Set the time scale of the back end, so that it reads plain times itself."""
        if scale.ticks_in_1 is not None:
            self._backend.set_time_scale(UpdateSignal, scale, float(scale.ticks_in_1), scale.kind == "whole")

    def _chunk(self, columns: dict[str, tuple[Any, Any]], scale: TimeScale) -> dict[str, Samples]:
        so_far = zip(self.input_names, self._backend.counts, self._backend.last_times, strict=True)
        return {
            name: dense_arrays.samples_of(columns[name], name, scale, count, last, self._types.get(name))
            for name, count, last in so_far
            if name in columns
        }

    def _run(self, call: Callable[[], Samples], scale: TimeScale | None) -> Samples:
        """Call the back end; convert its failures to errors."""
        try:
            return call()
        except self._refused:  # all was checked, but a concurrent update arrived first
            raise in_use() from None
        except self._undefined as error:
            raise self._no_value(error, scale) from None

    def _no_value(self, error: Exception, scale: TimeScale | None = None) -> EvaluationError:
        scale = scale or self._scale
        assert scale is not None
        return undefined(self._session.culprit(error), f"time {scale.show(error.args[1])}")

    def _signal(self, known: Samples) -> Signal:
        ticks, values = known
        scale = self._scale or self._given_scale or TimeScale.of(self._tick, [], self._unit)
        return Signal(scale.times(ticks), values)


# ---- in ticks --------------------------------------------------------------------------------------


def push_ticks(monitor: DenseMonitor, chunk: Mapping[str, Samples], scale: TimeScale) -> Samples:
    """Take checked samples in ticks; return the newly known robustness as ticks and values.

    ``scale``: the caller's time scale, for messages and later results.
    """
    return monitor._push(chunk, scale)


def finish_ticks(monitor: DenseMonitor) -> Samples:
    """End the trace; return the rest of the robustness as ticks and values."""
    return monitor._rest()


def known_ticks(monitor: DenseMonitor, name: str | Formula) -> Samples:
    """Return the new values of a watched formula after the last update, as ticks and values."""
    return monitor._known(name)


def points_of(monitor: DenseMonitor) -> list[list[tuple[int, float]]]:
    """Return the new values after the last update as pairs of tick and value, for fast loops.

    A list for the result, empty where ``update`` has returned it, then one for each watched formula.
    """
    known: list[list[tuple[int, float]]] = monitor._backend.points()
    return known


def part_of(monitor: DenseMonitor, formula: Formula) -> Signal:
    """Return the new values of any part of the formulas after the last update; they have no future operators.

    Only for monitors with ``parts=True``, whose updates cost a few nanoseconds more for each part.
    """
    return monitor._signal(monitor._session.part(monitor._backend, formula))
