"""Verdicts and bounds before the horizon in discrete time: samples a period apart, and the caller's times."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any, ClassVar

from rtamt.engine import SlowPath, inner_of
from rtamt.errors import TraceError, changed_state
from rtamt.language.undefined_value import at_sample, undefined
from rtamt.language.units.durations import check_unit
from rtamt.signals import arrays
from rtamt.signals.data_errors import missing_variable, unknown_variable
from rtamt.signals.samples import read_time
from rtamt.signals.sampling_period import irregular, not_increasing
from rtamt.usage_guard import in_use
from rtamt.verdicts.early.caller_clock import CallerClock, Timestamp
from rtamt.verdicts.early.monitor import EarlyMonitor

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from rtamt.language.formula import Formula
    from rtamt.signals.time_domain_interface import TimeDomain


class DiscreteEarlyMonitor(EarlyMonitor):
    """The base of the monitors of discrete time. Not instantiated by users."""

    _clock: CallerClock

    _remembered: ClassVar[tuple[str, ...]] = ("_finished", "_clock", "_evidence")

    def __init__(
        self,
        formula: Formula,
        domain: TimeDomain,
        *,
        unit: str | None = None,
        requirements: Sequence[Formula] = (),  # noqa: ARG002 - in discrete time they start together
        **settings: Any,
    ) -> None:
        self._unit = None if unit is None else check_unit(unit)
        self._tolerance = domain.tolerance
        super().__init__(formula, domain, **settings)

    def _connect(self, backend: Any) -> None:
        super()._connect(backend if self._clock.plain else SlowPath(inner_of(backend)))

    def _resume(self, state: tuple[Any, ...]) -> None:
        super()._resume(state)
        self._clock = self._clock.copied()

    def _forget(self) -> None:
        super()._forget()
        self._clock = CallerClock(self._unit, self._step)

    @property
    def period(self) -> Fraction:
        """Seconds from one sample to the next."""
        return self._step

    # ---- samples ---------------------------------------------------------------------------------

    @property
    def _count(self) -> int:
        """The number of samples so far, including those not yet passed to the back end."""
        return self.samples

    def _stamp(self, time: Any) -> Timestamp:
        """Return a time in seconds and as it was given; raise :class:`TraceError` for anything else."""
        stamp = self._clock.read(time, self._count)
        if stamp is None:
            return Timestamp(read_time(time, self._count, None))
        if not isfinite(stamp.seconds):
            raise TraceError(
                f"time is {stamp.seconds} at sample {self._count}: give a finite number of seconds"
            )
        return stamp

    def _steps(self, time: Any) -> float:
        return self._seconds(time) / float(self._step)

    def _seconds(self, time: Any) -> float:
        return self._stamp(time).seconds

    def _remember(self, stamp: Timestamp, *, begun: bool = True) -> None:
        """Remember the time of a sample that the back end has taken, if it was not given in seconds."""
        if stamp.original is None:
            return
        plain, backend = self._clock.plain, self._backend
        place = backend.place(stamp.seconds) if begun else None
        if place is None:
            self._clock.take(stamp, begun=False)
        elif backend.time(place) == stamp.seconds:
            later = map(backend.time, range(place + 1, backend.newest + 1))
            self._clock.take(stamp, begun=True, later=later)
        else:
            self._clock.extend(stamp)  # the instant has the time of its first sample
        if plain != self._clock.plain:
            self._connect(self._backend)
        if self._clock.full and begun:
            self._clock.forget(self._backend.earliest)

    def _bounds_of(
        self, values: Mapping[str, Any], index: int, stamp: Timestamp
    ) -> dict[str, tuple[float, float] | None]:
        """Return the bounds of a sample, None where it is missing; raise :class:`TraceError` for wrong data."""
        read: dict[str, tuple[float, float] | None] = {}
        for name in values:
            if name not in self._inputs:
                raise unknown_variable(name, self.input_names)
        for name in self._inputs:
            if name not in values:
                if self._late is None:
                    raise missing_variable(name, tuple(values))
                continue
            read[name] = self._known_of(name, values[name], index, f"time {stamp}")
        return read

    def _row(self, known: Mapping[str, tuple[float, float] | None]) -> tuple[list[float], list[float]]:
        """Return the lower and the upper bounds of every variable at a sample."""
        ranges = zip(self._inputs, self._known_ranges(), strict=True)
        row = [known.get(name) or bounds for name, bounds in ranges]
        return [low for low, _ in row], [high for _, high in row]

    def _check_order(self, time: float) -> None:
        """Raise the error for a time at which no sample of an ordered trace can arrive."""
        backend = self._backend
        if backend.newest < 0:
            return
        last = backend.time(backend.newest)
        if time <= last:
            raise not_increasing(self.samples, time, last, dated=self._clock.dated)
        place = backend.place(time)
        if place is None or not backend.newest < place <= max(backend.newest, backend.closed) + 1:
            dated = self._clock.dated
            raise irregular(self.samples, time, time - last, self._step, self._tolerance, dated=dated)

    def _take_in_order(self, time: Any, values: dict[str, Any]) -> Any:
        """Take the next sample in order, or raise an error."""
        with self._usage:
            flat = self._read_by_formula(values)
            if self._finished:
                raise self._is_finished()
            after = self.samples
            stamp = self._stamp(time)
            known = self._bounds_of(flat, after, stamp)
            self._check_order(stamp.seconds)
            try:
                found = self._backend.take(stamp.seconds, *self._row(known), after)
                self._remember(stamp)
                return self._as_given(found)
            except self._refused:
                raise in_use() from None
            except self._undefined as error:
                raise self._no_value(error, stamp) from None

    def _end(self) -> Any:
        """End the trace in the back end; all that is known then is final."""
        try:
            return self._backend.finish()
        except self._undefined as error:
            raise self._no_value(error) from None
        except ValueError:
            raise changed_state() from None

    def _as_given(self, found: Any) -> Any:
        """Return a result of the back end with times in the caller's format."""
        return found

    def _no_value(self, error: Any, stamp: Timestamp | None = None) -> Exception:
        """Name the sub-formula and the instant of a value that does not exist; ``stamp``: of the new sample."""
        dated = self._clock.dated or (stamp is not None and arrays.are_dates(stamp.original))
        return undefined(self._session.culprit(error), at_sample(error.args[1], error.time, dated=dated))
