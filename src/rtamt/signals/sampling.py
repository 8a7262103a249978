"""Sample signals with arbitrary timestamps in discrete time: each variable has its latest value.

Of a whole recording with :func:`sampled`, of messages with :func:`sampled_messages`, of a stream with
:class:`HeldSampler`: the same samples.
"""

from __future__ import annotations

from math import isnan

from rtamt.errors import TraceError, UsageError
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals import arrays, dense_arrays
from rtamt.signals.inferred_period import infer_period
from rtamt.signals.listing import show_time
from rtamt.signals.resampling import Sampler
from rtamt.signals.sampling_period import check_increasing, check_regular, elapsed
from rtamt.signals.trace import Channel, Trace

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from numpy.typing import NDArray

    from rtamt.language.parsing.sampling_clause import Sampling


def sampled(
    data: Any, names: Sequence[str], rule: Sampling, period: Fraction, unit: str | None = None
) -> Any:
    """Return a recording sampled every ``period`` from the first instant at which all variables have a sample.

    ``rule``: how old values may be that are held, and whether NaN is left out. Data without times is returned as it
    is: its samples are one period apart. Raises :class:`TraceError` for wrong data and values that are too old.
    """
    if isinstance(data, Trace):
        known = [name for name in names if name in data.names or name in data.aliases]
        if len(known) < len(names) or any(data.channel(name).times is None for name in known):
            return data  # the evaluation reports what is missing
        return _held(data.select(known), rule, period) if known else data
    if unit is not None:
        raise UsageError(
            "time_unit= and a specification with 'sample ... hold': read the data with rtamt.read(data, time_unit=...)"
        )
    if not names or not (arrays.is_mapping(data) or arrays.is_frame(data)):
        return data
    keys = list(data) if arrays.is_mapping(data) else list(data.columns)
    if arrays.TIME not in keys and not all(_has_times(data[key]) for key in keys if key in names):
        return data
    columns = dense_arrays.columns_of(data, names)
    if len(columns) < len(names):
        return data
    channels = {name: _channel(name, *columns[name]) for name in names}
    return _held(Trace(channels, source="the data"), rule, period)


def sampled_messages(data: Trace, period: Fraction | None) -> Trace:
    """Return the messages of a bag as samples of discrete time: every ``period`` the latest, as a node has them.

    Without a period, each message is a sample. Raises :class:`TraceError` unless they are then one period apart.
    """
    if period is not None:
        return data.resample(period)
    try:
        times = arrays.timestamps(data.on_one_time_base(data.names)[arrays.TIME])
        exact = elapsed(times)
        check_regular(times.seconds, infer_period(times, exact), exact=exact)
    except TraceError as error:
        raise TraceError(
            "the messages of this bag are not samples one period apart: choose a sampling period, such as "
            "--period 100ms, or use --time dense, which reads every message at its own time",
            variable=error.variable,
        ) from None
    return data


def _held(trace: Trace, rule: Sampling, period: Fraction) -> Trace:
    if rule.skip_nan:
        trace = _without_nan(trace)
    return trace.resample(period, "hold", rule.limit)


def _without_nan(trace: Trace) -> Trace:
    """Return a trace without the samples that are NaN, and with a note on them."""
    channels, losses = {}, []
    for name in trace:
        channel = channels[name] = trace.channel(name)
        bad = _nan(channel.values)
        if not bad.any() or channel.times is None:
            continue
        first, count = int(bad.argmax()), int(bad.sum())
        at = show_time(channel.times[first])
        losses.append(f"left out, NaN: {count:,} sample{'s' * (count != 1)} of {name}, the first at {at}")
        channels[name] = replace(channel, times=channel.times[~bad], values=channel.values[~bad])
    return trace.with_channels(channels, losses)


def without_values(trace: Trace, rule: Sampling | None) -> frozenset[str]:
    """Return the signals of a trace all of whose samples a rule leaves out."""
    if rule is None or not rule.skip_nan:
        return frozenset()
    return frozenset(name for name in trace if _nan(trace.channel(name).values).all())


def _nan(values: NDArray[Any]) -> NDArray[np.bool_]:
    if values.dtype.kind == "f":
        found: NDArray[np.bool_] = np.isnan(values)
        return found
    return np.array([isinstance(value, float) and isnan(value) for value in values.tolist()], bool)


def _has_times(samples: Any) -> bool:
    """Return whether samples have times of their own: a pair of sequences, or [time, value] pairs."""
    if isinstance(samples, tuple):
        return len(samples) == 2 and all(np.ndim(part) == 1 for part in samples)
    return np.ndim(samples) == 2


def _channel(name: str, times: Any, values: Any) -> Channel:
    """Return the samples of a variable that are not missing."""
    raw = arrays.as_array(values)
    absent = (
        np.ma.getmaskarray(values) if isinstance(values, np.ma.MaskedArray) else np.zeros(raw.shape, bool)
    )
    if raw.dtype.kind == "O":
        absent = absent | np.array([value is None for value in raw], dtype=bool)
    seconds, original = arrays.timestamps(times)
    if len(seconds) != len(raw):
        raise TraceError(
            f"'{name}' has {len(seconds)} times but {len(raw)} values: give one of each for every sample",
            variable=name,
        )
    check_increasing(seconds, dated=arrays.are_dates(original))
    return Channel(original[~absent], raw[~absent])


class HeldSampler:
    """Samples a stream: each sample is known once a later time arrives, since values may share a time.

    ``names``: the variables; ``period``: in seconds; ``rule``: as for :func:`sampled`.
    """

    def __init__(self, names: Sequence[str], rule: Sampling, period: Fraction) -> None:
        self._sampler = Sampler(names, period, "hold", rule.limit)
        self._skip_nan = rule.skip_nan
        self._last: dict[str, Any] = {}
        self._now: Any = None

    def take(self, time: Any, values: Mapping[str, float]) -> list[tuple[Any, dict[str, float]]]:
        """Take values of some variables at one time; return the samples before it.

        Raises :class:`TraceError` for times that decrease, and where a value is too old: the samples are then left out.
        """
        if self._now is not None and time < self._now:
            raise TraceError(
                f"time does not increase: {show_time(time)} comes after {show_time(self._now)}; sort the samples",
                variable=arrays.TIME,
            )
        for name in values:
            if self._last.get(name) == time:
                raise TraceError(
                    f"'{name}' has two samples at {show_time(time)}: keep one of them", variable=name
                )
        if self._skip_nan:
            values = {name: value for name, value in values.items() if not isnan(value)}
        self._now = time
        self._last.update(dict.fromkeys(values, time))
        at = np.array([time])
        return _rows(self._sampler.take_at(time, {n: (at, np.array([value])) for n, value in values.items()}))

    def finish(self) -> list[tuple[Any, dict[str, float]]]:
        """Return the samples up to the last time."""
        return _rows(self._sampler.finish())


def _rows(known: tuple[Any, dict[str, Any]] | None) -> list[tuple[Any, dict[str, float]]]:
    if known is None:
        return []
    grid, columns = known
    times = grid.tolist() if grid.dtype.kind == "f" else list(grid)
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    return [(time, dict(zip(columns, row, strict=True))) for time, row in zip(times, rows, strict=True)]
