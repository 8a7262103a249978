"""Verdicts before the horizon in dense time, and what they share with bounds there."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError
from rtamt.language.undefined_value import undefined
from rtamt.language.units.durations import check_unit, format_duration
from rtamt.lazy.modules import np
from rtamt.rewrite.presence import tracked
from rtamt.signals import arrays, dense_arrays
from rtamt.signals.data_errors import unknown_variable
from rtamt.signals.outcomes import VerdictRun
from rtamt.signals.ticks import TimeScale
from rtamt.usage_guard import in_use
from rtamt.verdicts.early.monitor import EarlyMonitor

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from rtamt.language.formula import Formula
    from rtamt.signals.time_domain_interface import TimeDomain


class DenseEarlyMonitor(EarlyMonitor):
    """The base of the monitors of dense time: samples in ticks, and the caller's times. Not instantiated by users."""

    def __init__(
        self,
        formula: Formula,
        domain: TimeDomain,
        *,
        unit: str | None = None,
        requirements: Sequence[Formula] = (),
        **settings: Any,
    ) -> None:
        # ``requirements``: the conjuncts of the formula, each with its own trace.
        self._unit = None if unit is None else check_unit(unit)
        self._requirements = tuple(map(tracked, domain.ground(*(requirements or (formula,)))))
        super().__init__(formula, domain, **settings)

    def _prepare(self) -> None:
        self._domain.check_inputs(self._inputs)
        super()._prepare()

    @property
    def _settled(self) -> bool:
        """See :class:`EarlyMonitor`: a variable is missing from its sample on, until its next one."""
        return True

    def _connect(self, backend: Any) -> None:
        super()._connect(backend)
        self._scale_in_use: TimeScale | None = None
        self._set_time_scale()

    def _set_time_scale(self) -> None:
        """Set the time scale of the back end, so that it can read plain times itself."""
        scale = self._scale
        if scale is None or scale is self._scale_in_use:
            return
        self._scale_in_use = scale
        if scale.rate is not None and scale.ticks_in_1 is not None:
            self._backend.set_time_scale(VerdictRun, float(scale.rate))

    def _forget(self) -> None:
        super()._forget()
        self._scale: TimeScale | None = None

    def _no_value(self, error: Any, scale: TimeScale | None = None) -> Exception:
        """Name the sub-formula and the instant of a value that does not exist, in the ``scale`` of the new sample."""
        tick = error.args[1]
        where = self._caller_time(tick) if scale is None else scale.show(tick)
        return undefined(self._session.culprit(error), f"time {where}")

    # ---- times -----------------------------------------------------------------------------------

    def _scale_of(self, time: Any) -> TimeScale:
        """Return the time scale after this time."""
        if self._scale is None:
            return TimeScale.of(self._step, [[time]], self._unit)
        return self._scale.widened([[time]])

    def _steps(self, time: Any) -> float:
        return int(self._scale_of(time).ticks([time], arrays.TIME)[0])

    def _caller_time(self, tick: int) -> str:
        scale = self._scale or TimeScale.of(self._step, [], self._unit)
        return scale.show(tick)

    def _times(self, ticks: Sequence[int]) -> list[Any]:
        scale = self._scale or TimeScale.of(self._step, [], self._unit)
        times = scale.times(np.array(ticks, np.int64))
        return list(times) if times.dtype.kind in "mM" else times.tolist()

    # ---- samples ---------------------------------------------------------------------------------

    def _check_sample(self, time: Any, values: Mapping[str, Any]) -> tuple[TimeScale, int, dict[str, Any]]:
        """Return a checked sample: the time scale after it, its tick, and what is known of some variables."""
        flat = self._read_by_formula(values)
        if self._finished:
            raise self._is_finished()
        for name in flat:
            if name not in self._inputs:
                raise unknown_variable(name, self.input_names)
        counts = dict(zip(self._inputs, self._backend.counts, strict=True))
        scale = self._scale_of(time)
        named = next(iter(flat), arrays.TIME)
        tick = int(scale.ticks([time], named, counts.get(named, 0))[0])
        moment = f"time {scale.show(tick)}"
        return scale, tick, {name: self._known_of(name, flat[name], counts[name], moment) for name in flat}

    def _check_in_order(self, tick: int, scale: TimeScale, names: Iterable[str]) -> None:
        """Raise the error for a sample that is not later than the last one of its variable."""
        counts, lasts = self._backend.counts, self._backend.last_times
        for name in names:
            number = self._inputs.index(name)
            if lasts[number] is not None and tick <= lasts[number]:
                raise dense_arrays.not_increasing(name, counts[number], tick, lasts[number], scale)

    def _require_samples(self) -> None:
        for name, count in zip(self._inputs, self._backend.counts, strict=True):
            if not count:
                raise TraceError(f"'{name}' has no samples; provide one before finish()", variable=name)

    def _refusal(self, error: Exception) -> Exception:
        """Return the error for a sample that the back end refuses although it is in order."""
        if error.args != ("order",):
            return in_use()
        return TraceError(
            f"the trace spans more than 2^60 ticks of {format_duration(self._step)}, too many for early verdicts, "
            f"bounds and causation: leave out samples from before the clock was set, or choose a coarser resolution",
            variable=arrays.TIME,
            index=self.samples,
        )

    def _row_of(self, known: Mapping[str, Any]) -> list[tuple[int, float, float]]:
        """Return samples in the form of the back end; of a missing one the range is known."""
        ranges = self._known_ranges()
        numbers = {name: self._inputs.index(name) for name in known}
        return [(i, *(known[name] or ranges[i])) for name, i in numbers.items()]


def push_tick(monitor: DenseEarlyMonitor, tick: int, row: Mapping[str, float]) -> None:
    """Take the values of some variables at a tick."""
    try:
        monitor._backend.learn(
            tick, monitor._row_of({name: (x, x) for name, x in row.items()}), monitor.samples
        )
    except monitor._refused as error:
        raise monitor._refusal(error) from None
    except monitor._undefined as error:
        raise monitor._no_value(error) from None
