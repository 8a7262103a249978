"""Convert dense-time data to int64 ticks and float64 values."""

from __future__ import annotations

from math import isnan, nan

from rtamt.errors import TraceError
from rtamt.language.units.durations import NANOSECOND, format_duration
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals import arrays
from rtamt.signals.coding import encoded, require_truths
from rtamt.signals.counting import times_of
from rtamt.signals.data_errors import NAN_MEND, not_a_mapping, refuse_unknown
from rtamt.signals.sampling_period import merged, never_set
from rtamt.signals.signal import Signal
from rtamt.signals.ticks import sequence_of
from rtamt.signals.time_columns import check_frame

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import NDArray

    from rtamt.language.value_types import ValueType
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.ticks import TickArray, TimeScale

    Samples = tuple[TickArray, FloatArray]


class TickSignal(Signal):
    """A signal with lazily created arrays: most online updates report one point or none.

    The base of the class of results of the compiled monitor, whose objects have ``_events``: the ticks, int64, then the
    values, float64.
    """

    __slots__ = ()

    if TYPE_CHECKING:  # by the class of results
        _events: bytes
        _scale: TimeScale

    def __reduce__(self) -> tuple[type[Signal], tuple[NDArray[Any], FloatArray]]:
        return Signal, (self.times, self.values)

    def _many_points(self) -> list[tuple[Any, float]]:
        """Return what :meth:`points` returns, where times are not quotients of doubles."""
        return Signal.points(self)

    @property
    def times(self) -> NDArray[Any]:
        """Times in the caller's format."""
        if not hasattr(self, "_times"):
            ticks = np.frombuffer(self._events, np.int64, len(self._events) // 16)
            self._times = self._scale.times(ticks)
        times: NDArray[Any] = self._times
        return times

    @property
    def values(self) -> FloatArray:
        """Robustness at these times."""
        if not hasattr(self, "_values"):
            half = len(self._events) // 2
            self._values = np.frombuffer(self._events, np.float64, half // 8, half).copy()
        return self._values


def split(samples: Any, name: str) -> tuple[Any, Any]:
    """Return the times and the values of one variable.

    A tuple is (times, values); a list or an array of two columns holds [time, value] pairs.
    """
    if isinstance(samples, tuple) and len(samples) == 2:
        return samples
    if isinstance(samples, np.ndarray) and samples.ndim == 2 and samples.shape[1] == 2:
        return samples[:, 0], samples[:, 1]
    try:
        pairs = [(time, value) for time, value in samples]
    except (TypeError, ValueError):
        raise TraceError(
            f"'{name}' is no dense signal: give (times, values), or a list of [time, value] pairs",
            variable=name,
        ) from None
    return [time for time, _ in pairs], [value for _, value in pairs]


def columns_of(
    data: Any, names: Sequence[str], declared: Collection[str] | None = None
) -> dict[str, tuple[Any, Any]]:
    """Return times (an array or a list) and values (as given) of each variable that is in the data.

    With a key ``"time"`` all variables share its timestamps, unless the formula reads a variable of that
    name. A variable with fields (``req.value``) may be
    given as ``req``, whose values are objects that have them. ``declared``: for a chunk, which need not
    hold every variable, names that it may hold besides.
    """
    if data.__class__ is not dict and isinstance(data, arrays.WithTimeBases):
        data = data.on_own_time_bases(names)
    if not arrays.is_mapping(data):
        if not arrays.is_frame(data):
            raise not_a_mapping(data, "(times, values), such as {'x': ([0.0, 1.5], [3, 4])}")
        check_frame(data, arrays.TIME, names)
        data = {name: data[name] for name in (*names, arrays.TIME) if name in data.columns}
    if declared is not None:
        refuse_unknown(list(data), names, declared)
    stamped = arrays.TIME in data and arrays.TIME not in names
    shared = sequence_of(data[arrays.TIME], arrays.TIME) if stamped else None
    columns = {}
    for name in names:
        head, *path = (name,) if name in data else name.split(".")
        if head not in data:
            continue
        times, values = (shared, data[head]) if shared is not None else split(data[head], head)
        if path:
            values = [arrays.field_of(value, head, path, i) for i, value in enumerate(values)]
        columns[name] = sequence_of(times, name) if shared is None else times, values
    return columns


def samples_of(
    column: tuple[Any, Any],
    name: str,
    scale: TimeScale,
    first: int = 0,
    last: int | None = None,
    type_: ValueType | None = None,
) -> Samples:
    """Return one variable's samples as ticks and values, checked.

    ``last`` is the variable's last tick so far and ``first`` how many samples it has had. Raises
    :class:`TraceError` for lengths that differ, times that do not increase, NaN, and values that are none of
    the type.
    """
    times, raw = column
    values = arrays.array(encoded(raw, name, type_, first), name, first)
    ticks = scale.ticks(times, name, first)
    if len(ticks) != len(values):
        raise TraceError(
            f"'{name}' has {len(ticks)} times but {len(values)} values: give one of each for every sample",
            variable=name,
        )
    before = ticks[:-1] if last is None else np.concatenate(([last], ticks[:-1]))
    after = ticks[1:] if last is None else ticks
    rising = after > before
    if not np.logical_and.reduce(rising):
        i = int(rising.argmin())
        one = last is None and len(ticks) > 2 and ticks[0] == ticks[-1] and not np.diff(ticks).any()
        if one and all(time == times[0] for time in times):  # else ticks are too coarse
            raise never_set(float(ticks[0] * scale.tick), len(ticks), name)
        raise not_increasing(name, first + i + (last is None), int(after[i]), int(before[i]), scale)
    if len(values) and isnan(np.minimum.reduce(values)):  # the least of numbers and a NaN is NaN
        i = int(np.isnan(values).argmax())
        raise TraceError(
            f"'{name}' is NaN at sample {first + i}, time {scale.show(int(ticks[i]))}: {NAN_MEND}",
            variable=name,
            index=first + i,
        )
    if type_ is not None:
        require_truths(
            name, type_, values, lambda i: f"sample {first + i}, time {scale.show(int(ticks[i]))}", first
        )
    return ticks, values


def not_increasing(name: str, index: int, time: int, before: int, scale: TimeScale) -> TraceError:
    """Return the error for a sample that is not later than the variable's last."""
    if time == before:
        return TraceError(
            f"'{name}' has two samples at {scale.show(time)} (sample {index} and the one before, with ticks of "
            f"{format_duration(scale.tick)}): keep one of them"
            f"{', or choose a finer resolution' if scale.tick > NANOSECOND else ''}",
            variable=name,
            index=index,
        )
    return TraceError(
        f"{times_of(name)} does not increase at sample {index}: {scale.show(time)} comes after "
        f"{scale.show(before)}; sort the samples",
        variable=name,
        index=index,
    )


def require_order(name: str, times: Any) -> None:
    """Raise :class:`TraceError` unless times increase: where they are merged with others, their order is lost."""
    base = np.asarray(times)
    rising = base[1:] > base[:-1]
    if not np.logical_and.reduce(rising):
        from rtamt.signals.ticks import TimeScale

        i = int(rising.argmin())
        scale = TimeScale.of(NANOSECOND, [base])
        before, time = scale.ticks(base[i : i + 2], name, i).tolist()
        raise not_increasing(name, i + 1, time, before, scale)


def minimum(signals: Sequence[Samples], before: Sequence[float]) -> Samples:
    """Return the minimum of step functions at each of their ticks; ``before``: what each is before its first tick.

    >>> minimum([(np.array([0, 4]), np.array([2.0, 5.0])), (np.array([3]), np.array([1.0]))], [np.inf, np.inf])
    (array([0, 3, 4]), array([2., 1., 1.]))
    """
    ticks = merged([own for own, _ in signals])
    values = np.full(len(ticks), np.inf)
    for (own, of), first in zip(signals, before, strict=True):
        places = own.searchsorted(ticks, "right")
        np.minimum(values, np.concatenate(((first,), of))[places], out=values)
    return ticks, values


def changes(ticks: TickArray, values: FloatArray, before: float = nan) -> Samples:
    """Return the points of a step function at which its value changes, and the last one.

    ``before``: the value before the first point.

    >>> changes(np.array([0, 3, 4]), np.array([2.0, 2.0, 2.0]))
    (array([0, 4]), array([2., 2.]))
    """
    if not len(ticks):
        return ticks, values
    kept = values != np.concatenate(((before,), values[:-1]))
    kept[-1] = True
    return ticks[kept], values[kept]
