"""Samples that the core does not take directly: times in the caller's format, conversions, and errors."""

from __future__ import annotations

from abc import abstractmethod

from rtamt.engine.online import OnlineMonitor
from rtamt.engine.slow_path import inner_of
from rtamt.errors import TraceError, UsageError
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals import arrays
from rtamt.signals.arrays import Timestamps
from rtamt.signals.sampling_period import check_increasing, check_regular, irregular
from rtamt.usage_guard import exclusive, in_use

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from fractions import Fraction

    from numpy.typing import NDArray

    from rtamt.signals.caller_times import CallerTimes


class CheckedSamples(OnlineMonitor):
    """The base of :class:`~rtamt.engine.discrete.monitor.Monitor` for samples that need checks or conversion."""

    _period: Fraction
    _tolerance: float
    _times: CallerTimes
    #: Whether times are seconds and nothing is recorded here, so that the back end takes samples directly.
    _plain: bool
    #: How many samples later each formula is known.
    _lags: tuple[int, ...]
    _update: Callable[..., Any]
    _step: Callable[..., Any]
    _refused: Any
    _undefined: Any

    @abstractmethod
    def _connect(self, backend: Any) -> None:
        """Use a back end."""

    def _update_carefully(self, /, *given: Any, **values: Any) -> float | None:
        """Take a sample that the core rejected, or report what is wrong with it."""
        from rtamt.signals.samples import time_of

        time = time_of(given)
        if self._plain and not self._begins_with_moment(time):
            return self._take(time, values)
        return self._take_alone(time, values)

    def _begins_with_moment(self, time: Any) -> bool:
        """Return whether a time is a date or a duration, and that of the first sample: it decides for the others."""
        return arrays.is_moment(time) and self._times.plain and not self.samples

    @exclusive
    def _take_alone(self, time: Any, values: dict[str, Any]) -> float | None:
        """Take a sample whose time or value is remembered here."""
        plain = self._times.plain and not self._begins_with_moment(time)
        robustness = self._take(time, values) if plain else self._take_at_caller_time(time, values)
        self._note_sample(robustness)
        return robustness

    def _take_at_caller_time(self, time: Any, values: dict[str, Any]) -> float | None:
        """Take a sample whose time is not given in seconds."""
        timestamp = self._times.read([time], self.samples)
        robustness = self._take(
            float(timestamp.seconds[0]), values, dated=arrays.are_dates(timestamp.original)
        )
        self._remember(timestamp.original)
        return robustness

    def _take(self, time: Any, values: dict[str, Any], *, dated: bool = False) -> float | None:
        from rtamt.signals.samples import read_time, read_values

        flat = self._read_by_formula(values)
        if self._finished:
            raise self._is_finished()
        timestamp = read_time(time, self.samples, self._last_time, dated=dated)
        numbers = read_values(flat, self.input_names, self.samples, timestamp, self._types, dated=dated)
        try:
            robustness: float | None = self._update(timestamp, numbers)
        except self._refused:
            raise self._refusal(timestamp, dated=dated) from None
        except self._undefined as error:
            raise self._no_value(error, dated=dated) from None
        return robustness

    def _step_carefully(self, *values: Any) -> float | None:
        """Take a sample by position that the core did not take, or find out what is wrong with it."""
        if self._plain:
            return self._take_row(values)
        return self._take_row_alone(values)

    @exclusive
    def _take_row_alone(self, values: tuple[float, ...]) -> float | None:
        robustness = self._take_row(values) if self._times.plain else self._take_row_at_caller_time(values)
        self._note_sample(robustness)
        return robustness

    def _take_row_at_caller_time(self, values: tuple[float, ...]) -> float | None:
        """Take a sample after samples whose times are not in seconds."""
        later = self._times.later(1)
        robustness = self._take_row(values, dated=arrays.are_dates(later))
        self._remember(later)
        return robustness

    def _take_row(self, values: tuple[float, ...], *, dated: bool = False) -> float | None:
        from rtamt.signals.samples import read_values

        if len(values) != len(self.input_names):
            raise TraceError(
                f"sample {self.samples} has the wrong number of values: expected {len(self.input_names)} "
                f"({', '.join(self.input_names) or 'the formula reads no variable'}), got {len(values)}"
            )
        if self._finished:
            raise self._is_finished()
        named = dict(zip(self.input_names, values, strict=True))
        time = self._next_time()
        numbers = read_values(named, self.input_names, self.samples, time, self._types, dated=dated)
        try:
            robustness: float | None = self._step(*numbers.values())
        except self._refused:
            raise self._refusal(time, dated=dated) from None
        except self._undefined as error:
            raise self._no_value(error, dated=dated) from None
        return robustness

    def _note_sample(self, robustness: float | None) -> None:
        """Look at what the last sample made known of each formula."""
        if self._episodes is None:
            return
        from rtamt.signals.episodes import plain_times

        for output, lag in enumerate(self._lags):
            value = self._backend.latest(output) if output else robustness
            if value is not None:
                self._episodes[output].take([(plain_times(self._recent(lag + 1)[:1])[0], value)])

    # ---- times -----------------------------------------------------------------------------------

    @property
    def _last_time(self) -> float | None:
        last: float | None = self._backend.last_time
        return last

    def _next_time(self) -> float:
        return float(self._next_times(1)[0])

    def _next_times(self, n: int) -> arrays.FloatArray:
        """Return the times of the next samples if they have none: those of a recording while none had."""
        samples, last, period = self.samples, self._last_time, float(self._period)
        if last is None or last == (samples - 1) * period:
            first, start = samples, 0.0
        else:
            first, start = 1, last
        return np.array(start + np.arange(first, first + n) * period, np.float64)

    # ---- timestamps that are not in seconds ------------------------------------------------------

    def _remember(self, original: NDArray[Any]) -> None:
        first = self._times.original is None
        self._times = self._times.extended(original)
        if first:
            self._connect(inner_of(self._backend))

    def _recent(self, count: int) -> NDArray[Any]:
        """Return the timestamps of the last samples in the caller's format."""
        original = self._times.original
        if original is not None:
            return original[len(original) - count :]
        return (
            np.array(self._backend.recent(count))
            if count or self._times.unit is None
            else np.empty(0, np.int64)
        )

    # ---- checks and errors -----------------------------------------------------------------------

    def _chunk(
        self, timestamps: Timestamps | None, columns: Mapping[str, arrays.FloatArray], n: int
    ) -> tuple[Timestamps, list[arrays.FloatArray]]:
        last = self._last_time
        if timestamps is None:
            times = self._next_times(n)
            timestamps = Timestamps(times, times if self._times.plain else self._times.later(n))
        elif n:
            self._times.require_alike(timestamps, self.samples)
        else:
            timestamps = Timestamps(timestamps.seconds, self._recent(0))
        times, ordered = timestamps.seconds, [columns[name] for name in self.input_names]
        if not self._backend.accepts(times, ordered):
            dated = arrays.are_dates(timestamps.original)
            check_increasing(times, last, self.samples, dated=dated)
            check_regular(times, self._period, self._tolerance, last, self.samples, dated=dated)
            for name, column in columns.items():
                arrays.check_numbers(name, column, times, self.samples, self._types.get(name), dated=dated)
        return timestamps, ordered

    def _is_finished(self) -> UsageError:
        return UsageError("the monitor has finished its trace; call reset() before the next sample")

    def _refusal(self, time: float, *, dated: bool) -> Exception:
        """Return the error for a sample that the back end rejected."""
        from rtamt.signals.samples import read_time

        if self._finished:
            return self._is_finished()
        index, last = self.samples, self._last_time
        read_time(time, index, last, dated=dated)
        period = float(self._period)
        if last is None or abs(time - last - period) <= self._tolerance * period:
            return in_use()  # the cause has disappeared meanwhile
        return irregular(index, time, time - last, self._period, self._tolerance, dated=dated)

    def _no_value(self, error: Any, *, dated: bool | None = None) -> Exception:
        """Return the error for an undefined value, with its sub-formula and instant.

        ``dated``: whether the caller's times are dates, by default as before.
        """
        from rtamt.language.undefined_value import at_sample, undefined

        dated = arrays.are_dates(self._times.original) if dated is None else dated
        return undefined(self._session.culprit(error), at_sample(error.args[1], error.time, dated=dated))
