"""Recorded data: named signals, each with its own time base.

::

    Trace                    what users read from files and frames
      └── Channel            one signal: its times, its values, its unit
    DiscreteTrace            one time base, a period  (discrete.py)           discrete time evaluates this
    DenseTrace               integer ticks            (dense.py)              dense time evaluates this
"""

from __future__ import annotations

from importlib import import_module

from rtamt.errors import TraceError, UsageError, choices, shown
from rtamt.language.units.durations import duration, positive_period
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any, overload
from rtamt.signals.arrays import TIME, WithTimeBases, timestamps
from rtamt.signals.data_errors import FILE_MENDS, TRACE_MENDS, missing_sample, possible_times
from rtamt.signals.listing import html, listing
from rtamt.signals.sampling_period import merged
from rtamt.signals.signal import Signal, read_only
from rtamt.signals.trace_checks import require_one_time_base, require_own_clock

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
    from fractions import Fraction

    from numpy.typing import NDArray

    from rtamt.signals.arrays import FloatArray

    Times = NDArray[Any]


@dataclass(frozen=True, slots=True, eq=False)
class Channel:
    """One signal of a trace.

    ``times``: n strictly increasing timestamps, float64 seconds, or, where a double cannot hold them,
    timedelta64[ns], or datetime64[ns]; None where the source has none. ``values``: n numbers, float64.
    ``unit``: the unit of the values, as the source writes it. ``column``: the name of the signal in the source.
    ``first_gap``: the first sample of the source at which the signal has no value, so that its times are fewer
    than those of its ``table``; both None where it has all. ``alias``: another name, which listings leave out.
    ``stepped``: whether there is nothing between two values, as of truths and members of enumerations.
    ``retimed``: whether its times are those of its recording, because others that were read with it have another clock.
    The arrays cannot be written.

    >>> import rtamt
    >>> trace = rtamt.read({"time": [0, 0.1], "speed [m/s]": [10, 11]})
    >>> speed = trace.channel("speed")
    >>> speed.times, speed.unit, speed.column
    (array([0. , 0.1]), 'm/s', 'speed [m/s]')
    """

    times: Times | None
    values: FloatArray
    unit: str = ""
    column: str = ""
    first_gap: int | None = None
    table: Times | None = None
    alias: str = ""
    stepped: bool = False
    retimed: bool = False

    def __post_init__(self) -> None:
        if self.times is not None:
            object.__setattr__(self, "times", read_only(self.times))
        object.__setattr__(self, "values", read_only(self.values))


#: The beginning of the note that names columns without numbers.
LEFT_OUT = "left out, not numbers: "


class Trace(WithTimeBases):
    """Named signals of one recording, each with its own times and values; cannot be changed.

    Made by :func:`rtamt.read`; ``Specification.evaluate`` and the monitors' ``update_many`` take it.
    In dense time every variable keeps its own time base. Discrete time needs a common time base:
    that of the source, or one chosen explicitly with :meth:`resample` or :meth:`hold`. A sample that the source lacks
    may have any value: ``evaluate`` bounds the robustness, and monitors need the sample.

    ``print(trace)`` shows the signals, and what was guessed.

    >>> import rtamt
    >>> trace = rtamt.read({"req": ([0.0, 2.5], [5, 0]), "gnt": ([0.0, 1.0, 4.0], [0, 4, 0])})
    >>> trace
    Trace of a dict: 2 signals, 0 s to 4 s
      req  2 samples, 0 s to 2.5 s
      gnt  3 samples, 0 s to 4 s
    >>> rtamt.parse("eventually[0:2](gnt >= 3)").evaluate(trace, time="dense").robustness
    1.0
    """

    __slots__ = ("_channels", "_conversions", "_losses", "_notes", "_origin", "_possible_times", "_source")

    def __init__(
        self,
        channels: Mapping[str, Channel],
        *,
        source: str = "data",
        notes: Sequence[str] = (),
        losses: Sequence[str] = (),
        conversions: Sequence[str] = (),
        origin: np.datetime64 | None = None,
        possible_times: str | None = None,
    ) -> None:
        if not hasattr(channels, "values") or not all(isinstance(one, Channel) for one in channels.values()):
            raise UsageError(f"a trace is made by rtamt.read(data), got {shown(channels)}")
        self._channels = dict(channels)
        self._source = source
        self._notes = tuple(notes)
        self._losses = tuple(losses)
        self._conversions = tuple(conversions)
        self._origin = origin
        self._possible_times = possible_times

    # ---- contents --------------------------------------------------------------------------------

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the signals, in the order of the source."""
        return tuple(self._channels)

    @property
    def source(self) -> str:
        """The source of the trace."""
        return self._source

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on inferred, omitted or converted data, one sentence each, including :attr:`remarks`."""
        return (*self._notes, *self.remarks)

    @property
    def remarks(self) -> tuple[str, ...]:
        """The notes that reports show with a verdict: :attr:`losses`, and signals whose unit was converted."""
        return (*self._conversions, *self._losses)

    @property
    def losses(self) -> tuple[str, ...]:
        """Missing data: the rest of a damaged file, samples that are NaN or skipped."""
        return self._losses

    @property
    def origin(self) -> np.datetime64 | None:
        """The date and time (UTC) of time 0, if the source provides it."""
        return self._origin

    @property
    def start(self) -> Any:
        """The earliest time of any signal; None without timestamps."""
        return min((c.times[0] for c in self._timed()), default=None)

    @property
    def end(self) -> Any:
        """The latest time of any signal; None without timestamps."""
        return max((c.times[-1] for c in self._timed()), default=None)

    @property
    def units(self) -> dict[str, str]:
        """The units of the signals whose source provides them.

        >>> import rtamt
        >>> rtamt.read({"time": [0, 1], "speed [m/s]": [5, 4], "gear": [1, 1]}).units
        {'speed': 'm/s'}
        """
        return {name: channel.unit for name, channel in self._channels.items() if channel.unit}

    def channel(self, name: str) -> Channel:
        """Return one signal with its unit; raise :class:`TraceError` if there is none of that name."""
        found = self._channels.get(name) or self._channels.get(self.aliases.get(name, ""))
        if found is None:
            if any(name in note.removeprefix(LEFT_OUT).split(", ") for note in self._notes):
                raise TraceError(
                    f"'{name}' of {self._source} was left out, because its values are not all numbers in the range "
                    f"of doubles; columns=['{name}'] names the first that is none, and types=spec.types reads members "
                    f"of enumerations by their names",
                    variable=name,
                )
            raise TraceError(
                f"{self._source} has no '{name}'{choices(name, self._channels, 'signals')}", variable=name
            )
        return found

    @property
    def aliases(self) -> dict[str, str]:
        """The names of signals by their other names: ``topic[0].field`` of a PX4 log is ``topic.field``."""
        return {channel.alias: name for name, channel in self._channels.items() if channel.alias}

    @overload
    def __getitem__(self, name: str) -> Signal: ...

    @overload
    def __getitem__(self, name: slice) -> Trace: ...

    def __getitem__(self, name: str | slice) -> Signal | Trace:
        """Return times and values of one signal, or of a slice of times the trace from one to the other.

        Both ends are included, as in pandas: seconds, or dates as text where the trace has dates.

        >>> import rtamt
        >>> trace = rtamt.read({"time": [0, 1, 2, 3], "x": [5, 4, 2, 6]})
        >>> trace[1:2]["x"]
        Signal(times=array([1., 2.]), values=array([4., 2.]))
        """
        from rtamt.signals.slicing import sliced

        if isinstance(name, slice):
            return self.with_channels({each: sliced(each, self._channels[each], name) for each in self})
        channel = self.channel(name)
        times = np.arange(len(channel.values)) if channel.times is None else channel.times
        return Signal(times, channel.values)

    def __iter__(self) -> Iterator[str]:
        return iter(self._channels)

    def rename(self, names: Mapping[str, str]) -> Trace:
        """Return the trace with signals under other names: ``names`` maps new to present ones.

        >>> import rtamt
        >>> rtamt.read({"battery_status[1].voltage_v": [12.1]}).rename({"v": "battery_status[1].voltage_v"}).names
        ('v',)
        """
        for old in names.values():
            self.channel(old)
        new = {old: name for name, old in names.items()}
        renamed = {
            new.get(name, name): replace(channel, alias="") if name in new else channel
            for name, channel in self._channels.items()
        }
        if len(renamed) < len(self._channels):
            twice = next(name for name in names if name in self._channels and name not in names.values())
            raise UsageError(f"{self._source} has a '{twice}' already; choose another name")
        return self.with_channels(renamed)

    def select(self, names: Collection[str]) -> Trace:
        """Return the trace with only some of its signals, in its own order.

        >>> import rtamt
        >>> rtamt.read({"x": [1, 2], "y": [3, 4]}).select(["y"]).names
        ('y',)
        """
        for name in names:
            self.channel(name)
        return self.with_channels(
            {name: each for name, each in self._channels.items() if name in names or each.alias in names}
        )

    def extended(self, signals: Mapping[str, Signal], units: Mapping[str, str] | None = None) -> Trace:
        """Return the trace with further signals, such as those of a result; one of the same name is replaced.

        >>> import rtamt
        >>> trace = rtamt.read({"time": [0, 1], "v [m/s]": [5, 10]})
        >>> speed = rtamt.parse("v * 3.6").evaluate(trace).signal
        >>> trace.extended({"speed": speed}, units={"speed": "km/h"}).names
        ('v', 'speed')
        """
        units = units or {}
        found = dict(self._channels)
        for name, signal in signals.items():
            if not isinstance(signal, Signal):
                raise UsageError(
                    f"'{name}' is {shown(signal)}; give a signal, such as rtamt.Signal(times, values)"
                )
            found[name] = Channel(np.array(signal.times), np.array(signal.values, float), units.get(name, ""))
        return self.with_channels(found)

    def to_pandas(self) -> Any:
        """Return a pandas DataFrame: a column for each signal, NaN at times at which it has no sample.

        >>> import rtamt
        >>> rtamt.read({"x": ([0.0, 1.0], [1, 2]), "y": ([1.0], [3])}).to_pandas()["y"].tolist()
        [nan, 3.0]
        """
        try:
            pd: Any = import_module("pandas")
        except ModuleNotFoundError:
            raise UsageError("a DataFrame needs pandas, which is not installed: pip install pandas") from None
        series = {name: pd.Series(self[name].values, index=self[name].times) for name in self._channels}
        return pd.DataFrame(series).rename_axis(TIME)

    # ---- for the engine --------------------------------------------------------------------------

    def on_one_time_base(self, names: Collection[str]) -> dict[str, Any]:
        """Return discrete-time data: n values for each name, and ``"time"``.

        Raises :class:`TraceError` if the signals have different time bases.
        """
        channels = {name: self.channel(name) for name in names if name != TIME}
        self.require_all_samples(channels, TRACE_MENDS)
        require_own_clock(channels, self._source)
        chosen = channels or self._channels
        require_one_time_base(chosen)
        result: dict[str, Any] = {name: channel.values for name, channel in channels.items()}
        times = next((channel.times for channel in chosen.values()), None)
        if times is not None:
            return {TIME: times, **result}
        return result or {name: channel.values for name, channel in self._channels.items()}

    def require_all_samples(self, names: Iterable[str], mends: str = FILE_MENDS) -> None:
        """Raise :class:`TraceError` if one of these signals lacks a sample of its table; ``mends``: how to mend it."""
        for name in names:
            if name != TIME and (gap := self.channel(name).first_gap) is not None:
                raise missing_sample(name, gap, self._source, mends)

    def require_own_clock(self, names: Iterable[str]) -> None:
        """Raise :class:`TraceError` if the times of these signals are others than where only they are read."""
        present = [name for name in names if name in self._channels or name in self.aliases]
        require_own_clock({name: self.channel(name) for name in present if name != TIME}, self._source)

    def require_period(self, names: Collection[str]) -> None:
        """Raise :class:`TraceError` where samples can only be taken to be one period apart, and none is given.

        That is so if there are no timestamps, but a first column that may hold them, and that no formula reads.
        """
        column = self._possible_times
        if column is None or any(self.channel(name).column == column for name in names if name != TIME):
            return
        raise possible_times(column)

    def on_own_time_bases(self, names: Collection[str]) -> dict[str, tuple[Times, FloatArray]]:
        """Return dense-time data: (times, values) for each name."""
        self.require_own_clock(names)
        result = {}
        for name in names:
            channel = self.channel(name)
            if channel.times is None:
                raise TraceError(
                    f"{self._source} has no timestamps, which dense time needs: "
                    f"name their column with time=, or on the command line --time-column",
                    variable=name,
                )
            result[name] = (channel.times, channel.values)
        return result

    # ---- one time base, chosen openly ------------------------------------------------------------

    def resample(
        self,
        period: str | float | Fraction,
        how: str = "hold",
        hold_for: str | float | Fraction | None = None,
    ) -> Trace:
        """Return all signals on one time base: a sample every ``period`` from the first instant at which all have one.

        ``how``: ``"hold"``, the last value before or at an instant (what dense time means; up to the
        latest last sample), or ``"linear"``, on the line between the two samples around it (up to the
        earliest last sample; signals that were read as Booleans or enumerations, with ``types=`` of :func:`rtamt.read`,
        are held). ``period``: seconds, or text such as ``"10ms"``. Samples in between are
        left out and listed in :attr:`losses`. A time that the rounding of a double puts just behind an instant, such
        as 3 * 0.1 s, counts as that instant. ``hold_for``: the maximum age of a held value; an older one is an error.

        >>> import rtamt
        >>> trace = rtamt.read({"x": ([0.0, 1.0], [0, 10]), "y": ([0.0, 0.6, 1.0], [1, 2, 3])})
        >>> trace.resample("500ms")["x"].values, trace.resample("500ms", how="linear")["x"].values
        (array([ 0.,  0., 10.]), array([ 0.,  5., 10.]))
        """
        from rtamt.signals.resampling import grid_of

        limit = (
            None if hold_for is None else positive_period(hold_for, "longest time for which a value is held")
        )
        if limit is not None and how != "hold":
            raise UsageError(f"hold_for= is for how='hold', got how='{how}'")
        return self._at(grid_of(self._all_timed(), period, how), how, limit, duration(period))

    def hold(self) -> Trace:
        """Return all signals at the timestamps of each, holding last values, from the latest first timestamp on.

        >>> import rtamt
        >>> trace = rtamt.read({"x": ([0.0, 1.0], [0, 10]), "y": ([0.0, 0.5, 1.0], [1, 2, 3])})
        >>> trace.hold()["x"]
        Signal(times=array([0. , 0.5, 1. ]), values=array([ 0.,  0., 10.]))
        """
        timed = self._all_timed()
        grid = merged(timed)
        return self._at(grid[grid >= max(times[0] for times in timed)], "hold")

    def _at(
        self, grid: Times, how: str, hold_for: Fraction | None = None, step: Fraction | None = None
    ) -> Trace:
        from rtamt.signals.resampling import resampled

        channels: dict[str, Channel] = {}
        losses: list[str] = []
        for name, channel in self._channels.items():
            assert channel.times is not None
            mine = "hold" if channel.stepped else how
            values, left_out = resampled(name, channel.times, channel.values, grid, mine, hold_for, step)
            losses += left_out
            channels[name] = replace(channel, times=grid, values=values, first_gap=None, table=None)
        return self.with_channels(channels, losses)

    # ---- inside ----------------------------------------------------------------------------------

    def with_channels(
        self, channels: Mapping[str, Channel], losses: Sequence[str] = (), conversions: Sequence[str] = ()
    ) -> Trace:
        """Return the trace with other signals, and with notes on what was lost and converted on the way."""
        return Trace(
            channels,
            source=self._source,
            notes=self._notes,
            losses=(*self._losses, *losses),
            conversions=(*self._conversions, *conversions),
            origin=self._origin,
            possible_times=self._possible_times,
        )

    def _timed(self) -> list[Any]:
        return [c for c in self._channels.values() if c.times is not None and len(c.times)]

    def _all_timed(self) -> list[Times]:
        if not self._channels:
            raise TraceError(f"{self._source} has no signals")
        for name, channel in self._channels.items():
            if channel.times is None:
                raise TraceError(f"'{name}' has no timestamps, so that it cannot be put on another time base")
            if not len(channel.times):
                raise TraceError(f"'{name}' has no samples: give at least one", variable=name)
        return [channel.times for channel in self._channels.values() if channel.times is not None]

    def __repr__(self) -> str:
        return listing(self)

    def _repr_html_(self) -> str:
        return html(self)


def in_seconds(times: Times) -> FloatArray:
    """Return times as float64 seconds; datetimes count from 1970."""
    return timestamps(times).seconds
