"""Dense time: every signal on its own timestamps, counted in ticks, constant between them."""

from __future__ import annotations

from rtamt.errors import StlError, TraceError, UsageError, shown
from rtamt.language.units.durations import NANOSECOND, positive_period
from rtamt.lazy.dataclasses import dataclass, field, replace
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any, ClassVar
from rtamt.rewrite.check import TICKS, check_bounds, check_dense
from rtamt.signals import arrays
from rtamt.signals.coding import NO_TYPES
from rtamt.signals.signal import Signal
from rtamt.signals.time_domain_interface import DomainTrace, TimeDomain

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence
    from fractions import Fraction

    from numpy.typing import NDArray

    from rtamt.language.formula import Formula
    from rtamt.language.units.durations import Duration
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.coding import Types
    from rtamt.signals.dense_arrays import Samples
    from rtamt.signals.ticks import TickArray, TimeScale
    from rtamt.signals.time_domain_interface import Bounds, Mask


@dataclass(frozen=True, init=False)
class Dense(TimeDomain):
    """Dense time: every variable may change at any instant, and holds its value up to its next sample.

    ``resolution``: the length of a tick, in which time is counted: seconds, or text such as ``"1us"``.
    Bounds must be multiples of it.

    >>> import rtamt
    >>> spec = rtamt.parse("eventually[0:1](x >= 3)", time=rtamt.Dense(resolution="1us"))
    >>> spec.evaluate({"x": ([0, 0.7, 5], [1, 4, 0])}).robustness
    1.0
    """

    name: ClassVar[str] = "dense"
    summary: ClassVar[str] = "signals change at any instant"
    continuous: ClassVar[bool] = True
    sampled: ClassVar[bool] = False
    own_time_bases: ClassVar[bool] = True
    held_at_end: ClassVar[bool] = True
    unit = TICKS
    setting: ClassVar[str] = "resolution"
    parts: ClassVar[Mapping[str, str]] = {
        "engine": "rtamt.engine.dense:ENGINE",
        "time_axis": "rtamt.engine.dense.time_axis:DenseTimeAxis",
        "members": "rtamt.engine.dense.quantifiers:DenseMemberMonitor",
        "stream": "rtamt.verdicts.dense_stream:DenseStream",
        "eager": "rtamt.verdicts.early.dense_eager:DenseEagerMonitor",
        "interval": "rtamt.verdicts.early.dense_interval:DenseIntervalMonitor",
        "causation": "rtamt.verdicts.early.dense_causation:DenseCausationMonitor",
        "early_check": "rtamt.verdicts.early.dense_check:DenseEarlyCheck",
        "replay": "rtamt.plot.band:replay_ticks",
        "ros_groups": "rtamt.ros.groups:of_messages",
    }

    resolution: Fraction

    def __init__(self, resolution: Duration = NANOSECOND) -> None:
        object.__setattr__(self, "resolution", positive_period(resolution, "resolution"))

    @classmethod
    def of(cls, period: Duration | None, tolerance: float, resolution: Duration) -> Dense:  # noqa: ARG003 - it has neither
        """See :class:`TimeDomain`."""
        return cls(resolution)

    @property
    def step(self) -> Fraction:
        """See :class:`TimeDomain`."""
        return self.resolution

    @property
    def online(self) -> Dense:
        """See :class:`TimeDomain`."""
        return self

    def check(self, formula: Formula, text: str | None = None) -> Formula:
        """See :class:`TimeDomain`."""
        check_dense(formula, text)
        check_bounds(formula, self.resolution, text, self.unit)
        return self.ground(formula)[0]

    def check_inputs(self, names: Collection[str]) -> None:
        """See :class:`TimeDomain`: the instants are those of the variables."""
        _require_variables(names)

    def record(
        self, data: Any, names: Sequence[str], unit: str | None = None, types: Types = NO_TYPES
    ) -> DenseTrace:
        """See :class:`TimeDomain`."""
        return record_dense(data, names, self.resolution, unit=unit, types=types)


#: Dense time with its default settings.
DENSE = Dense()


@dataclass(frozen=True, slots=True, eq=False)
class DenseTrace(DomainTrace):
    """A finished recording in dense time: the ticks and values of each variable, which has at least one."""

    columns: Mapping[str, Samples]
    scale: TimeScale
    #: The units of the variables whose source provides them.
    units: Mapping[str, str] = field(default_factory=dict)
    #: Lower and upper bounds of the samples of each variable; empty where all are known exactly.
    bounds: Mapping[str, Bounds] = field(default_factory=dict)
    #: Which samples of a variable are missing.
    missing: Mapping[str, Mask] = field(default_factory=dict)
    #: The variables that end the recording; empty if all do.
    ending: frozenset[str] = frozenset()

    @property
    def start(self) -> int:
        """The latest first tick: before it, not every variable has a value."""
        return max(int(ticks[0]) for ticks, _ in self.columns.values())

    @property
    def end(self) -> int:
        """The latest last tick."""
        return max(
            int(self.columns[name][0][-1]) for name in self.ending & self.columns.keys() or self.columns
        )

    @property
    def latest(self) -> int:
        """See :class:`DomainTrace`: the latest last tick of any variable."""
        return max(int(ticks[-1]) for ticks, _ in self.columns.values())

    @property
    def domain(self) -> Dense:
        """See :class:`DomainTrace`."""
        return Dense(self.scale.tick)

    @property
    def step(self) -> Fraction:
        """See :class:`DomainTrace`."""
        return self.scale.tick

    @property
    def samples(self) -> int:
        """See :class:`DomainTrace`."""
        from rtamt.signals.sample_count import SampleCount

        count = SampleCount(self.columns)
        count.take(self.columns)
        return count.total

    @property
    def size(self) -> int:
        """See :class:`DomainTrace`."""
        return sum(len(ticks) for ticks, _ in self.columns.values())

    def check(self, formula: Formula, text: str | None = None, *, given: bool = True) -> Formula:  # noqa: ARG002 - it always is
        """See :class:`DomainTrace`."""
        return self.domain.check(formula, text)

    def select(self, names: Iterable[str]) -> DenseTrace:
        """See :class:`DomainTrace`."""
        return replace(self, columns={name: self.columns[name] for name in names})

    def bounded(self, bounds: Mapping[str, Bounds], missing: Mapping[str, Mask]) -> DenseTrace:
        """See :class:`DomainTrace`."""
        return replace(self, bounds=bounds, missing=missing)

    def values(self, name: str) -> FloatArray:
        """See :class:`DomainTrace`."""
        return self.columns[name][1]

    def with_presence(self, channels: Mapping[str, str]) -> DenseTrace:
        """See :class:`DomainTrace`: a variable is missing from a sample that is, until its next one."""
        made = {}
        for name, channel in channels.items():
            ticks, _ = self.columns[name]
            gaps = self.missing.get(name, np.zeros(len(ticks), bool))
            made[channel] = ticks, np.where(np.pad(gaps, (0, len(ticks) - len(gaps)), "edge"), 0.0, 1.0)
        exact = {channel: (values, values) for channel, (_, values) in made.items()}
        return replace(self, columns={**self.columns, **made}, bounds={**self.bounds, **exact})

    def with_units(self, units: Mapping[str, str]) -> DenseTrace:
        """See :class:`DomainTrace`."""
        return replace(self, units=units)

    def started(self, names: Collection[str]) -> DenseTrace:
        """See :class:`DomainTrace`."""
        return self.select(name for name in self.columns if name in names)

    def ended_by(self, names: Collection[str]) -> DenseTrace:
        """See :class:`DomainTrace`."""
        return replace(self, ending=frozenset(names))

    def held_until(self, end: int) -> DenseTrace:
        """See :class:`DomainTrace`: every variable holds its last value for ever."""
        if end <= self.end:
            return self
        name = next(iter(self.ending & self.columns.keys() or self.columns))
        ticks, values = self.columns[name]
        held = np.append(ticks, end), np.append(values, values[-1])
        return replace(self, columns={**self.columns, name: held})

    def in_steps(self) -> DenseTrace:
        """See :class:`DomainTrace`."""
        from rtamt.signals.ticks import TimeScale

        return replace(self, scale=TimeScale.in_ticks(self.scale.tick))

    def positions(self, signal: Signal) -> NDArray[np.int64]:
        """See :class:`DomainTrace`."""
        return signal.times - self.start

    def in_caller_times(self, signal: Signal) -> Signal:
        """See :class:`DomainTrace`."""
        return self.signal(signal.times, signal.values)

    def signals(self, values: Sequence[Samples]) -> list[Signal]:
        """See :class:`DomainTrace`."""
        return [self.signal(*events) for events in values]

    def signal(self, ticks: TickArray, values: arrays.FloatArray) -> Signal:
        """Return events as a signal up to the end: a point for every change, and one at the end."""
        end = self.end
        if len(ticks) and ticks[-1] > end:
            inside = int(ticks.searchsorted(end, "right"))
            ticks, values = ticks[:inside], values[:inside]
        if len(ticks) and ticks[-1] < end:
            ticks, values = np.concatenate((ticks, (end,))), np.concatenate((values, values[-1:]))
        return Signal(self.scale.times(ticks), values)

    def time(self, position: int) -> Any:
        """See :class:`DomainTrace`."""
        return self.scale.time(self.start + position)

    def times_at(self, positions: NDArray[np.int64]) -> NDArray[Any]:
        """See :class:`DomainTrace`."""
        return self.scale.times(self.start + positions)

    def nanoseconds(self, positions: Any) -> NDArray[np.int64]:
        """See :class:`DomainTrace`."""
        from rtamt.signals.counting import rescaled
        from rtamt.signals.ticks import TimeScale

        ticks = np.asarray(positions, np.int64) + self.start
        try:
            return rescaled(ticks, self.scale.tick / NANOSECOND)
        except OverflowError:
            raise TimeScale(NANOSECOND, self.scale.kind).too_far(arrays.TIME) from None

    def sampled(self, name: str) -> NDArray[np.int64]:
        """See :class:`DomainTrace`."""
        ticks: NDArray[np.int64] = self.columns[name][0] - self.start
        return ticks

    def show(self, position: int) -> str:
        """See :class:`DomainTrace`."""
        return self.scale.show(self.start + position)

    def position(self, at: Any) -> int:
        """See :class:`DomainTrace`."""
        try:
            found = self.later(at)
        except (StlError, TypeError, ValueError):
            found = -1
        if 0 <= found <= self.last:
            return found
        raise UsageError(
            f"{shown(at)} is no instant of the recording, "
            f"which lasts from {self.show(0)} to {self.show(self.last)}"
        )

    def later(self, at: Any) -> int:
        """See :class:`DomainTrace`."""
        return int(self.scale.widened([[at]]).ticks([at], "at")[0]) - self.start

    @property
    def origin(self) -> Fraction | np.datetime64:
        """See :class:`DomainTrace`."""
        start = self.scale.time(self.start)
        return start if isinstance(start, np.datetime64) else self.start * self.scale.tick

    def seconds(self, times: Any, *, elapsed: bool) -> arrays.FloatArray:
        """See :class:`DomainTrace`."""
        return self._seconds(self.scale.ticks(times, arrays.TIME), elapsed)

    def _seconds(self, ticks: Any, elapsed: bool) -> arrays.FloatArray:
        tick = self.scale.tick  # nearly always 1/n: one division rounds once
        zero = self.start if elapsed else 0
        seconds: arrays.FloatArray = (
            (np.asarray(ticks, np.int64) - zero) * float(tick.numerator) / tick.denominator
        )
        return seconds

    def ends(self, *, elapsed: bool) -> tuple[float, float]:
        """See :class:`DomainTrace`."""
        first, last = self._seconds([self.start, self.end], elapsed).tolist()
        return first, last

    def points(self, name: str, *, elapsed: bool) -> tuple[arrays.FloatArray, arrays.FloatArray]:
        """See :class:`DomainTrace`: the last value holds up to the end."""
        ticks, values = self.columns[name]
        if ticks[-1] < self.end:
            ticks, values = np.append(ticks, self.end), np.append(values, values[-1])
        return self._seconds(ticks, elapsed), np.asarray(values)


def record_dense(
    data: Any,
    names: Sequence[str],
    tick: Fraction,
    scale: TimeScale | None = None,
    unit: str | None = None,
    types: Types = NO_TYPES,
) -> DenseTrace:
    """Normalise a finished recording; the caller's data is never changed.

    ``data``: a mapping from variable to (times, values) or to a list of [time, value] pairs; with a
    key ``"time"`` all variables share its timestamps. ``tick``: seconds. ``scale``: the caller's time
    scale, by default inferred from the first variable. ``unit``: the unit of numeric times, by default
    seconds. ``types``: of the variables that are no plain numbers. Raises :class:`TraceError`.
    """
    from rtamt.signals.dense_arrays import columns_of, samples_of

    _require_variables(names)
    arrays.require_no_unit(data, unit)
    columns = columns_of(data, names)
    for name in names:
        if name not in columns:
            from rtamt.signals.data_errors import missing_variable

            raise missing_variable(name, [str(key) for key in getattr(data, "columns", data)])
        if not len(columns[name][0]):
            raise TraceError(f"'{name}' has no samples: give at least one", variable=name)
    if scale is None:
        from rtamt.signals.ticks import TimeScale

        scale = TimeScale.of(tick, [columns[name][0] for name in names], unit)
    samples = {name: samples_of(columns[name], name, scale, type_=types.get(name)) for name in names}
    result = DenseTrace(samples, scale, arrays.units_of(data))
    if result.start > result.end:
        raise TraceError("the signals have no instant in common")
    return result


def _require_variables(names: Collection[str]) -> None:
    if not names:
        raise UsageError(
            "the formula reads no variable, so that it has no instants in dense time: let it read a variable, or "
            "evaluate it in discrete time"
        )
