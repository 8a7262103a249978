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

    def _update_carefully(self, *given: Any, **values: Any) -> float | None:
        """Take a sample that the core rejected, or report what is wrong with it."""
        from rtamt.signals.samples import time_of

        time = time_of(given)
        if self._plain:
            return self._take(time, values)
        return self._take_alone(time, values)

    @exclusive
    def _take_alone(self, time: Any, values: dict[str, Any]) -> float | None:
        """Take a sample whose time or value is remembered here."""
        robustness = (
            self._take(time, values) if self._times.plain else self._take_at_caller_time(time, values)
        )
        self._note_sample(robustness)
        return robustness

    def _take_at_caller_time(self, time: Any, values: dict[str, Any]) -> float | None:
        """Take a sample whose time is not given in seconds."""
        timestamp = self._times.read([time], self.samples)
        robustness = self._take(float(timestamp.seconds[0]), values)
        self._remember(timestamp.original)
        return robustness

    def _take(self, time: Any, values: dict[str, Any]) -> float | None:
        from rtamt.signals.samples import read_time, read_values

        flat = self._read_by_formula(values)
        if self._finished:
            raise self._is_finished()
        timestamp = read_time(time, self.samples, self._last_time)
        numbers = read_values(flat, self.input_names, self.samples, timestamp, self._types)
        try:
            robustness: float | None = self._update(timestamp, numbers)
        except self._refused:
            raise self._refusal(timestamp) from None
        except self._undefined as error:
            raise self._no_value(error) from None
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
        robustness = self._take_row(values)
        self._remember(later)
        return robustness

    def _take_row(self, values: tuple[float, ...]) -> float | None:
        from rtamt.signals.samples import read_values

        if len(values) != len(self.input_names):
            raise TraceError(
                f"sample {self.samples} has the wrong number of values: expected {len(self.input_names)} "
                f"({', '.join(self.input_names) or 'the formula reads no variable'}), got {len(values)}"
            )
        if self._finished:
            raise self._is_finished()
        named = dict(zip(self.input_names, values, strict=True))
        numbers = read_values(named, self.input_names, self.samples, self._next_time(), self._types)
        try:
            robustness: float | None = self._step(*numbers.values())
        except self._refused:
            raise self._refusal(self._next_time()) from None
        except self._undefined as error:
            raise self._no_value(error) from None
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
        last = self._last_time
        return 0.0 if last is None else last + float(self._period)

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
            times = np.array(self._next_time() + float(self._period) * np.arange(n), dtype=np.float64)
            timestamps = Timestamps(times, times if self._times.plain else self._times.later(n))
        elif n:
            self._times.require_alike(timestamps, self.samples)
        else:
            timestamps = Timestamps(timestamps.seconds, self._recent(0))
        times, ordered = timestamps.seconds, [columns[name] for name in self.input_names]
        if not self._backend.accepts(times, ordered):
            dates = None if timestamps.original.dtype.kind != "M" else timestamps.original
            if dates is not None and last is not None:
                dates = np.concatenate((self._recent(1), dates))
            check_increasing(times, last, self.samples, dates)
            check_regular(times, self._period, self._tolerance, last, self.samples, dates)
            for name, column in columns.items():
                arrays.check_numbers(name, column, times, self.samples, self._types.get(name))
        return timestamps, ordered

    def _is_finished(self) -> UsageError:
        return UsageError("the monitor has finished its trace; call reset() before the next sample")

    def _refusal(self, time: float) -> Exception:
        """Return the error for a sample that the back end rejected."""
        from rtamt.signals.samples import read_time

        if self._finished:
            return self._is_finished()
        index, last = self.samples, self._last_time
        read_time(time, index, last)
        period = float(self._period)
        if last is None or abs(time - last - period) <= self._tolerance * period:
            return in_use()  # the cause has disappeared meanwhile
        return irregular(index, time, last, self._period, self._tolerance)

    def _no_value(self, error: Any) -> Exception:
        """Return the error for an undefined value, with its sub-formula and instant."""
        from rtamt.language.undefined_value import at_sample, undefined

        return undefined(self._session.culprit(error), at_sample(error.args[1], error.time))
