"""Dense time at the edge: whatever the caller has becomes int64 ticks and float64 values, once.

Time is counted in ticks (1 ns unless set otherwise), in which samples and bounds are exact: no
sliver of a segment can come from rounding, hours into a log with stamps of 10^18 ns.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.engine import signals
from rtamt.engine.signals import Signal
from rtamt.errors import TraceError
from rtamt.language.units import format_duration

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import NDArray

    from rtamt.engine.signals import FloatArray

    TickArray = NDArray[np.int64]
    Samples = tuple[TickArray, FloatArray]

#: One tick, unless the caller chooses another: a nanosecond.
NANOSECOND = Fraction(1, 10**9)

#: Stamps stay this far from the ends of int64, so that bounds can be added to them.
FARTHEST = 2**62


@dataclass(frozen=True, slots=True)
class TimeScale:
    """How the caller tells time, and how long a tick is.

    ``kind``: ``"seconds"`` (numbers), ``"ns"`` (arrays of integers: nanoseconds) or ``"datetime"``.
    """

    tick: Fraction
    kind: str

    def ticks(self, times: Any, name: str, first: int = 0) -> TickArray:
        """Return times as ticks, rounded to the nearest; raise :class:`TraceError` where that cannot be.

        ``first`` is the index of ``times[0]`` in the recording of ``name``, for messages.
        """
        if self.kind == "seconds":
            seconds = signals.array(times, f"time of '{name}'")
            finite = np.isfinite(seconds)
            if not finite.all():
                i = int((~finite).argmax())
                raise not_finite(name, first + i, float(seconds[i]))
            exact = np.rint(seconds * float(1 / self.tick))
        else:
            raw = np.asarray(times)
            if raw.dtype.kind == "O":
                raw = raw.astype("datetime64[us]")
            if raw.dtype.kind == "M":
                missing = np.isnat(raw)
                if missing.any():
                    raise not_finite(name, first + int(missing.argmax()), raw[missing][0])
                # Looked at in seconds first, which every date fits into.
                far = np.abs(raw.astype("datetime64[s]").astype(np.int64)) >= FARTHEST // 10**9
                if far.any():
                    raise self._too_far(name)
                raw = raw.astype("datetime64[ns]").astype(np.int64)
            if len(raw) and max(abs(int(raw.min())), abs(int(raw.max()))) >= FARTHEST:
                raise self._too_far(name)
            per_tick = self.tick / NANOSECOND
            if per_tick == 1:
                return np.array(raw, dtype=np.int64)
            exact = np.array([round(Fraction(int(t)) / per_tick) for t in raw], dtype=object)
        if len(exact) and max(abs(float(exact.min())), abs(float(exact.max()))) >= FARTHEST:
            raise self._too_far(name)
        return exact.astype(np.int64)

    def _too_far(self, name: str) -> TraceError:
        return TraceError(
            f"'{name}' has a time too far from 0 for ticks of {format_duration(self.tick)}: "
            f"subtract a start time, or choose a coarser resolution",
            variable=name,
        )

    def times(self, ticks: TickArray) -> NDArray[Any]:
        """Return ticks as the caller tells time: float64 seconds, int64 nanoseconds or datetime64[ns]."""
        if self.kind == "seconds":
            # Dividing by a whole number of ticks a second rounds once: 300 ms comes back as 0.3.
            per_second = 1 / self.tick
            if per_second.denominator == 1:
                return ticks / float(per_second)
            return ticks * float(self.tick)
        per_tick = self.tick / NANOSECOND
        nanoseconds = (
            ticks if per_tick == 1 else np.array([int(t * per_tick) for t in ticks.tolist()], np.int64)
        )
        return nanoseconds if self.kind == "ns" else nanoseconds.astype("datetime64[ns]")

    def show(self, tick: int) -> str:
        """Return a tick for a message."""
        time = self.times(np.array([tick], dtype=np.int64))[0]
        return (
            f"{time:.12g} s" if self.kind == "seconds" else f"{time} ns" if self.kind == "ns" else str(time)
        )


class TickSignal(Signal):
    """A signal whose arrays are made when they are asked for: most online updates tell a point or none.

    Made by the compiled monitor, which sets ``_events``: the ticks, int64, then the values, float64.
    """

    __slots__ = ("_events", "_scale")

    _events: bytes
    _scale: TimeScale

    def __init__(self, scale: TimeScale, ticks: TickArray, values: FloatArray) -> None:
        self._scale = scale
        self._events = ticks.tobytes() + values.tobytes()

    def __len__(self) -> int:
        return len(self._events) // 16

    @property
    def times(self) -> NDArray[Any]:
        """Times as the caller tells them."""
        if not hasattr(self, "_times"):
            self._times = self._scale.times(np.frombuffer(self._events, np.int64, len(self)).copy())
        return self._times

    @property
    def values(self) -> FloatArray:
        """Robustness at these times."""
        if not hasattr(self, "_values"):
            self._values = np.frombuffer(self._events, np.float64, len(self), 8 * len(self)).copy()
        return self._values


def kind_of(times: Any) -> str:
    """Tell how times are given: integers in an array are nanoseconds, other numbers seconds."""
    dtype = getattr(times, "dtype", None)
    if dtype is not None and np.dtype(dtype).kind in "iu":
        return "ns"
    if dtype is not None and np.dtype(dtype).kind == "M":
        return "datetime"
    first = next(iter(times), None) if np.ndim(times) else times
    return "datetime" if isinstance(first, (datetime, np.datetime64)) else "seconds"


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


def columns_of(data: Any, names: Sequence[str], known: Collection[str] = ()) -> dict[str, tuple[Any, Any]]:
    """Return times and values of each variable that is in the data, as given.

    With a key ``"time"`` all variables share its stamps.
    """
    if isinstance(data, signals.Clocked):
        data = data.on_own_clocks(names)
    if not isinstance(data, Mapping):
        if not hasattr(data, "columns"):
            raise TraceError(
                "expected a mapping from variable to (times, values), such as {'x': ([0.0, 1.5], [3, 4])}, "
                f"got {type(data).__name__}"
            )
        data = {name: data[name] for name in (*names, signals.TIME) if name in data.columns}
    signals.refuse_unknown(list(data), names, known)
    if signals.TIME not in data:
        return {name: split(data[name], name) for name in names if name in data}
    return {name: (data[signals.TIME], data[name]) for name in names if name in data}


def samples_of(
    column: tuple[Any, Any], name: str, scale: TimeScale, first: int = 0, last: int | None = None
) -> Samples:
    """Return one variable's samples as ticks and values, checked.

    ``last`` is the variable's last tick so far and ``first`` how many samples it has had. Raises
    :class:`TraceError` for lengths that differ, times that do not increase, NaN.
    """
    times, raw = column
    if kind_of(times) != scale.kind and np.size(times):
        raise TraceError(
            f"'{name}' tells time in {kind_of(times)}, but others in {scale.kind}: use one of them for all",
            variable=name,
        )
    values = signals.array(raw, name, first)
    ticks = scale.ticks(times, name, first)
    if len(ticks) != len(values):
        raise TraceError(
            f"'{name}' has {len(ticks)} times but {len(values)} values: give one of each for every sample",
            variable=name,
        )
    before = ticks[:-1] if last is None else np.concatenate(([last], ticks[:-1]))
    after = ticks[1:] if last is None else ticks
    late = after <= before
    if late.any():
        i = int(late.argmax())
        raise not_increasing(name, first + i + (last is None), int(after[i]), int(before[i]), scale)
    bad = np.isnan(values)
    if bad.any():
        i = int(bad.argmax())
        raise TraceError(
            f"'{name}' is NaN at sample {first + i}, time {scale.show(int(ticks[i]))}: "
            f"fill the gap or leave the sample out",
            variable=name,
            index=first + i,
        )
    return ticks, values


def not_finite(name: str, index: int, time: Any) -> TraceError:
    """Return the error for a time that is none."""
    return TraceError(
        f"the time of '{name}' is {time} at sample {index}: give a finite time", variable=name, index=index
    )


def not_increasing(name: str, index: int, time: int, before: int, scale: TimeScale) -> TraceError:
    """Return the error for a sample that is not later than the variable's last."""
    if time == before:
        return TraceError(
            f"'{name}' has two samples at {scale.show(time)} (sample {index} and the one before, with ticks of "
            f"{format_duration(scale.tick)}): keep one of them",
            variable=name,
            index=index,
        )
    return TraceError(
        f"the time of '{name}' does not increase at sample {index}: {scale.show(time)} comes after "
        f"{scale.show(before)}; sort the samples",
        variable=name,
        index=index,
    )
