"""Discrete time: one value of every variable at each sample, one sampling period apart."""

from __future__ import annotations

from fractions import Fraction
from math import isfinite

from rtamt.errors import BoundError, StlError, TraceError, UsageError, shown
from rtamt.language.units.durations import NANOSECOND, UNITS, decimal, positive_period
from rtamt.lazy.dataclasses import dataclass, field, replace
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any, ClassVar
from rtamt.rewrite.check import PERIODS, check_bounds
from rtamt.signals.arrays import (
    TIME,
    Timestamps,
    are_dates,
    check_numbers,
    columns_of,
    is_number,
    plain,
    timestamps,
    units_of,
)
from rtamt.signals.coding import NO_TYPES
from rtamt.signals.sampling_period import (
    TOLERANCE,
    DeferredTimes,
    RegularTimes,
    check_increasing,
    check_regular,
    check_tolerance,
    elapsed,
)
from rtamt.signals.signal import Signal, read_only
from rtamt.signals.time_domain_interface import DomainTrace, TimeDomain

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.language.formula import Formula
    from rtamt.language.units.durations import Duration
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.coding import Types
    from rtamt.signals.time_domain_interface import Bounds, Mask


def _with_origin_of_period(error: BoundError, origin: str) -> BoundError:
    """Return the error for a bound that does not fit a period that nobody gave, with where the period is from."""
    return BoundError(
        f"{error.message} (the period {origin}; period=, or on the command line --period, sets it)",
        error.text,
        error.span,
    )


@dataclass(frozen=True, init=False)
class Discrete(TimeDomain):
    """Discrete time: all variables have a sample at the same instants, one sampling period apart.

    ``period``: seconds, or text such as ``"100ms"``; None infers it from the timestamps (online 1 s).
    ``tolerance``: the fraction of the period by which a gap between samples may differ from it.

    >>> import rtamt
    >>> spec = rtamt.parse("eventually[0:1](x >= 3)", time=rtamt.Discrete(period="500ms"))
    >>> spec.evaluate({"x": [1, 2, 5]}).robustness
    2.0
    """

    name: ClassVar[str] = "discrete"
    summary: ClassVar[str] = "every variable has one sample per period"
    continuous: ClassVar[bool] = False
    sampled: ClassVar[bool] = True
    own_time_bases: ClassVar[bool] = False
    held_at_end: ClassVar[bool] = False
    unit = PERIODS
    setting: ClassVar[str] = "period"
    parts: ClassVar[Mapping[str, str]] = {
        "engine": "rtamt.engine.discrete:ENGINE",
        "time_axis": "rtamt.engine.discrete.time_axis:DiscreteTimeAxis",
        "stream": "rtamt.verdicts.discrete_stream:DiscreteStream",
        "eager": "rtamt.verdicts.early.discrete_eager:EagerMonitor",
        "interval": "rtamt.verdicts.early.discrete_interval:DiscreteIntervalMonitor",
        "causation": "rtamt.verdicts.early.discrete_causation:DiscreteCausationMonitor",
        "early_check": "rtamt.verdicts.early.check:DiscreteEarlyCheck",
        "replay": "rtamt.plot.band:replay_samples",
        "ros_groups": "rtamt.ros.groups:sampled",
        "members": "rtamt.engine.discrete.quantifiers:MemberMonitor",
        "members_interval": "rtamt.verdicts.early.member_bounds:MemberIntervalMonitor",
    }

    period: Fraction | None
    tolerance: float
    #: Whether nothing gave the period, so that it is 1 s.
    assumed: bool = field(default=False, compare=False, repr=False)

    def __init__(self, period: Duration | None = None, tolerance: float = TOLERANCE) -> None:
        check_tolerance(tolerance)
        object.__setattr__(self, "period", None if period is None else positive_period(period))
        object.__setattr__(self, "tolerance", tolerance)
        object.__setattr__(self, "assumed", False)

    @classmethod
    def of(cls, period: Duration | None, tolerance: float, resolution: Duration) -> Discrete:  # noqa: ARG003 - it has none
        """See :class:`TimeDomain`."""
        return cls(period, tolerance)

    @property
    def step(self) -> Fraction | None:
        """See :class:`TimeDomain`."""
        return self.period

    @property
    def online(self) -> Discrete:
        """See :class:`TimeDomain`."""
        if self.period is not None:
            return self
        found = Discrete(Fraction(1), self.tolerance)
        object.__setattr__(found, "assumed", True)
        return found

    def check(self, formula: Formula, text: str | None = None) -> Formula:
        """See :class:`TimeDomain`."""
        if self.period is not None:
            try:
                check_bounds(formula, self.period, text, self.unit)
            except BoundError as error:
                raise (_with_origin_of_period(error, "is the default") if self.assumed else error) from None
        return self.ground(formula)[0]

    def check_inputs(self, names: Collection[str]) -> None:
        """See :class:`TimeDomain`: samples are instants also where a formula reads no variable."""

    def record(
        self, data: Any, names: Sequence[str], unit: str | None = None, types: Types = NO_TYPES
    ) -> DiscreteTrace:
        """See :class:`TimeDomain`."""
        return record_discrete(data, names, self.period, self.tolerance, unit, types)


#: Discrete time with its default settings.
DISCRETE = Discrete()


@dataclass(slots=True, eq=False)  # to make a frozen one takes as long as to evaluate a short trace
class DiscreteTrace(DomainTrace):
    """A finished recording in discrete time: one column of ``len(times)`` samples for each variable."""

    _times: FloatArray | DeferredTimes
    columns: Mapping[str, FloatArray]
    period: Fraction
    #: Whether the period was inferred from the timestamps.
    inferred: bool = False
    #: The timestamps in the caller's format; None if that is seconds.
    original: NDArray[Any] | None = None
    #: The unit of numeric timestamps that are not in seconds.
    unit: str | None = None
    #: The units of the variables whose source provides them.
    units: Mapping[str, str] = field(default_factory=dict)
    #: Lower and upper bounds of the samples of each variable; empty where all are known exactly.
    bounds: Mapping[str, Bounds] = field(default_factory=dict)
    #: Which samples of a variable are missing.
    missing: Mapping[str, Mask] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self._times)

    @property
    def times(self) -> FloatArray:
        """Seconds; of dates, since 1970."""
        times = self._times
        return times.array if isinstance(times, DeferredTimes) else times

    @property
    def dated(self) -> bool:
        """Whether the caller's times are dates."""
        return are_dates(self.original)

    @property
    def domain(self) -> Discrete:
        """See :class:`DomainTrace`."""
        return Discrete(self.period)

    @property
    def step(self) -> Fraction:
        """See :class:`DomainTrace`."""
        return self.period

    @property
    def start(self) -> int:
        """See :class:`DomainTrace`."""
        return 0

    @property
    def end(self) -> int:
        """See :class:`DomainTrace`."""
        return len(self) - 1

    @property
    def samples(self) -> int:
        """See :class:`DomainTrace`."""
        return len(self)

    @property
    def size(self) -> int:
        """See :class:`DomainTrace`."""
        return len(self)

    def check(self, formula: Formula, text: str | None = None, *, given: bool = True) -> Formula:
        """See :class:`DomainTrace`."""
        try:
            return self.domain.check(formula, text)
        except BoundError as error:
            if self.inferred:
                raise _with_origin_of_period(error, "was taken from the timestamps") from None
            raise (error if given else _with_origin_of_period(error, "is the default")) from None

    def select(self, names: Iterable[str]) -> DiscreteTrace:
        """See :class:`DomainTrace`."""
        columns = {name: self.columns[name] for name in names}
        if self.bounds:
            return replace(self, columns=columns)
        return DiscreteTrace(
            self._times, columns, self.period, self.inferred, self.original, self.unit, self.units
        )

    def bounded(self, bounds: Mapping[str, Bounds], missing: Mapping[str, Mask]) -> DiscreteTrace:
        """See :class:`DomainTrace`."""
        return replace(self, bounds=bounds, missing=missing)

    def values(self, name: str) -> FloatArray:
        """See :class:`DomainTrace`."""
        return self.columns[name]

    def with_presence(self, channels: Mapping[str, str]) -> DiscreteTrace:
        """See :class:`DomainTrace`."""
        none = np.zeros(len(self), bool)
        made = {
            channel: np.where(self.missing.get(name, none), 0.0, 1.0) for name, channel in channels.items()
        }
        exact = {channel: (values, values) for channel, values in made.items()}
        return replace(self, columns={**self.columns, **made}, bounds={**self.bounds, **exact})

    def with_units(self, units: Mapping[str, str]) -> DiscreteTrace:
        """See :class:`DomainTrace`."""
        return replace(self, units=units)

    def started(self, names: Collection[str]) -> DiscreteTrace:  # noqa: ARG002 - all start together
        """See :class:`DomainTrace`: all variables start with the first sample."""
        return self

    def held_until(self, end: int) -> DiscreteTrace:  # noqa: ARG002 - values are not held
        """See :class:`DomainTrace`: there is nothing after the last sample."""
        return self

    def in_steps(self) -> DiscreteTrace:
        """See :class:`DomainTrace`."""
        return self

    def positions(self, signal: Signal) -> NDArray[np.int64]:
        """See :class:`DomainTrace`."""
        return np.arange(len(signal))

    def in_caller_times(self, signal: Signal) -> Signal:
        """See :class:`DomainTrace`."""
        return signal

    def signals(self, values: Sequence[FloatArray]) -> list[Signal]:
        """See :class:`DomainTrace`; all signals share its timestamps, which cannot be written."""
        times: Any = self._times if self.original is None else self.original
        if not isinstance(times, DeferredTimes):
            times = read_only(times)
        return [Signal(times, column) for column in values]

    @property
    def timestamps(self) -> NDArray[Any]:
        """The timestamps in the caller's format."""
        return self.times if self.original is None else self.original

    def time(self, position: int) -> Any:
        """See :class:`DomainTrace`: a number of Python, or a date or duration of numpy."""
        return plain(self.timestamps[position])

    def times_at(self, positions: NDArray[np.int64]) -> NDArray[Any]:
        """See :class:`DomainTrace`."""
        return self.timestamps[positions]

    def nanoseconds(self, positions: Any) -> NDArray[np.int64]:
        """See :class:`DomainTrace`."""
        from rtamt.signals.ticks import TimeScale

        scale = TimeScale.of(NANOSECOND, [self.timestamps], self.unit)
        return scale.ticks(self.timestamps[np.asarray(positions, np.int64)], TIME)

    def sampled(self, name: str) -> NDArray[np.int64]:  # noqa: ARG002 - the same for all
        """See :class:`DomainTrace`: all variables have the same samples."""
        return np.arange(len(self))

    def show(self, position: int) -> str:
        """See :class:`DomainTrace`."""
        timestamp = self.time(position)
        if isinstance(timestamp, np.datetime64):
            return (
                str(timestamp.astype("M8[ms]")) if timestamp == timestamp.astype("M8[ms]") else str(timestamp)
            )
        if isinstance(timestamp, np.timedelta64):
            return f"{decimal(int(timestamp.astype(np.int64)) * UNITS['ns'])} s"
        number = f"{timestamp:.15g}" if isinstance(timestamp, float) else str(timestamp)
        return f"{number} {self.unit or 's'}"

    def position(self, at: Any) -> int:
        """See :class:`DomainTrace`."""
        try:
            seconds: Any = timestamps([at], self.unit).seconds[0]
        except StlError:
            seconds = None
        if is_number(seconds) and isfinite(seconds):
            nearest = int(np.abs(self.times - float(seconds)).argmin())
            if abs(float(self.times[nearest]) - float(seconds)) <= TOLERANCE * float(self.period):
                return nearest
        original = at if isinstance(at, np.datetime64) else shown(at)
        if isinstance(at, np.timedelta64):
            original = f"{decimal(int(at.astype('m8[ns]').astype(np.int64)) * UNITS['ns'])} s"
        raise UsageError(
            f"there is no sample at {original}; the recording has {len(self)}, "
            f"from {self.show(0)} to {self.show(self.last)}"
        )

    @property
    def origin(self) -> Fraction | np.datetime64:
        """See :class:`DomainTrace`."""
        from rtamt.signals.datetimes import nanoseconds_of

        first = self.timestamps[0]
        if isinstance(first, np.timedelta64):
            return Fraction(nanoseconds_of(first) or 0, 10**9)
        return first if isinstance(first, np.datetime64) else Fraction(repr(float(self.times[0])))

    def seconds(self, times: Any, *, elapsed: bool) -> FloatArray:
        """See :class:`DomainTrace`."""
        from rtamt.signals.counting import quotients

        own = isinstance(times, np.ndarray) and _same_memory(
            times, self.timestamps
        )  # of a signal over this recording
        if own and not elapsed:
            return self.times
        given = Timestamps(self.times, self.timestamps) if own else timestamps(times, self.unit)
        if not elapsed:
            return given.seconds
        if given.original.dtype.kind in "mM":  # exact, while seconds since 1970 are rounded to 0.2 µs
            return quotients((given.original - self.timestamps[0]).view(np.int64), 1, 10**9)
        since: FloatArray = given.seconds - self.times[0]
        return since

    def ends(self, *, elapsed: bool) -> tuple[float, float]:
        """See :class:`DomainTrace`."""
        first, last = self.seconds(self.timestamps[[0, -1]], elapsed=elapsed).tolist()
        return first, last

    def points(self, name: str, *, elapsed: bool) -> tuple[FloatArray, FloatArray]:
        """See :class:`DomainTrace`."""
        return self.seconds(self.timestamps, elapsed=elapsed), self.columns[name]


def record_discrete(
    data: Any,
    names: Sequence[str],
    period: Fraction | None,
    tolerance: float = TOLERANCE,
    unit: str | None = None,
    types: Types = NO_TYPES,
) -> DiscreteTrace:
    """Normalise a finished recording; the caller's data is never changed.

    ``data``: a mapping, or anything with columns (a pandas or polars frame), from variable to n
    numbers; ``"time"`` (n timestamps, seconds or datetimes) is optional. ``names`` are the variables the
    formula reads; others do no harm. Without a ``period`` (seconds) it is taken
    from the timestamps. ``unit``: of timestamps that are numbers, by default seconds. ``types``: of the variables
    that are no plain numbers. Raises :class:`TraceError`.
    """
    stamped, columns, n = columns_of(data, names, unit, types, regular=period is not None)
    if n == 0:
        raise TraceError("the trace is empty: give at least one sample")
    inferred, original, dated = False, None, False
    times: FloatArray | RegularTimes
    if stamped is None:
        period = period or Fraction(1)
        times = RegularTimes(n, period)
    else:
        times = stamped.seconds
        original = None if stamped.original is times else stamped.original
        dated = are_dates(original)
        exact = elapsed(stamped, unit)
        check_increasing(times, dated=dated, exact=exact)
        inferred = period is None
        if period is None:
            from rtamt.signals.inferred_period import infer_period  # monitors have a period

            period = infer_period(stamped, exact)
        check_regular(times, period, tolerance, dated=dated, exact=exact)
    for name, column in columns.items():
        check_numbers(name, column, times, type_=types.get(name), dated=dated)
    return DiscreteTrace(times, columns, period, inferred, original, unit, units_of(data))


def _same_memory(one: NDArray[Any], other: NDArray[Any]) -> bool:
    """Return whether two arrays are views of the same numbers."""
    return (one.ctypes.data, one.dtype, one.shape, one.strides) == (
        other.ctypes.data,
        other.dtype,
        other.shape,
        other.strides,
    )
