"""Partly known recordings: missing samples, measurement errors, declared ranges.

``None``, a null of Arrow or polars, ``pandas.NA`` and a masked value are missing samples; NaN is an error. A missing
sample may have any value in the range of its variable, one with an uncertainty ε any value from v - ε to v + ε. The
same holds in discrete time for what a trace that was read lacks (an empty cell, a null, a NaN of pandas); in dense time
such a signal has no sample there, and holds its value.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import inf, isnan
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, UsageError, did_you_mean, shown
from rtamt.lazy.dataclasses import dataclass, field, replace
from rtamt.lazy.modules import np
from rtamt.signals import dense_arrays
from rtamt.signals.arrays import TIME, is_mapping, number_of
from rtamt.signals.gaps import gaps_of, items_of
from rtamt.signals.time_columns import check_mapping
from rtamt.signals.trace import Trace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from rtamt.signals.time_domain_interface import DomainTrace

    Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """The measurement errors and ranges of variables, as declared by the caller."""

    errors: Mapping[str, float] = field(default_factory=dict)
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    @classmethod
    def of(cls, uncertainty: Any, ranges: Any, names: Sequence[str]) -> Uncertainty:
        """Check and return the declarations; ``names`` are the variables that the formula reads.

        >>> Uncertainty.of({"x": 0.5}, {"x": (0, 120)}, ["x", "y"])
        Uncertainty(errors={'x': 0.5}, ranges={'x': (0.0, 120.0)})
        """
        if uncertainty is None and ranges is None:
            return _EXACT
        errors = {}
        for name, value in _items(uncertainty, "uncertainty", "{'x': 0.1}", names):
            number = number_of(value)
            if number is None or not number >= 0:
                raise UsageError(
                    f"the uncertainty of '{name}' is {shown(value)}; give a number that is not negative"
                )
            errors[name] = number
        limits = {}
        for name, value in _items(ranges, "ranges", "{'x': (0, 120)}", names):
            limits[name] = range_of(name, value)
        return cls(errors, limits)

    def within(self, ranges: Mapping[str, tuple[float, float]]) -> Uncertainty:
        """Return the same with ranges for the variables that have none."""
        return Uncertainty(self.errors, {**ranges, **self.ranges}) if ranges else self

    def applied(self, recording: DomainTrace, missing: Mapping[str, Mask]) -> DomainTrace:
        """Return the recording with bounds of its samples; unchanged if all are known exactly.

        Raises :class:`TraceError` at a sample that cannot lie in its declared range.
        """
        if self is _EXACT and not missing:
            return recording
        if not any(
            name in each for each in (missing, self.errors, self.ranges) for name in recording.columns
        ):
            return recording
        bounds = {}
        for name in recording.columns:
            values = recording.values(name)
            low, high = self.ranges.get(name, (-inf, inf))
            error = self.errors.get(name, 0.0)
            gaps = missing.get(name, np.zeros(len(values), bool))
            lower, upper = values - error, values + error
            outside = ~gaps & ((upper < low) | (lower > high))
            if outside.any():
                i = int(outside.argmax())
                raise TraceError(
                    f"'{name}' is {values[i]:.15g} at sample {i}, outside its declared range [{low:g}, {high:g}]: "
                    f"correct the value, or declare a wider range",
                    variable=name,
                    index=i,
                )
            lower, upper = (
                np.where(gaps, low, np.maximum(lower, low)),
                np.where(gaps, high, np.minimum(upper, high)),
            )
            bounds[name] = lower, upper
        if not missing and not any(self.errors.get(name) for name in recording.columns):
            return recording
        return recording.bounded(bounds, missing)


_EXACT = Uncertainty()


def range_of(name: str, value: Any) -> tuple[float, float]:
    """Return a declared range as two numbers; raise :class:`UsageError` if it is invalid."""
    ends = [number_of(end) for end in value] if isinstance(value, tuple | list) else []
    if len(ends) != 2 or None in ends or any(isnan(end) for end in ends if end is not None):
        raise UsageError(f"the range of '{name}' is {shown(value)}; give (lowest, highest), such as (0, 120)")
    low, high = (float(end) for end in ends if end is not None)
    if low > high:
        raise UsageError(
            f"the range of '{name}' is reversed: {low:g} is greater than {high:g}; give (lowest, highest)"
        )
    return low, high


def fill_gaps(data: Any, names: Sequence[str], *, own_time_bases: bool) -> tuple[Any, dict[str, Mask]]:
    """Return the data with missing samples replaced by zeros, and masks of the variables with missing samples.

    In a trace that was read, a signal that lacks samples of its table has its own time base, which dense time uses.
    """
    if isinstance(data, Trace):
        return (data, {}) if own_time_bases else _fill_gaps_of_trace(data, names)
    missing: dict[str, Mask] = {}
    if own_time_bases:
        filled: dict[str, Any] = {}
        for name, (times, values) in dense_arrays.columns_of(data, names).items():
            filled[name] = times, _fill_gaps(values, name, missing)
        return filled, missing
    keys = list(data) if is_mapping(data) else list(data.columns)
    if is_mapping(data) and TIME not in keys:
        check_mapping(data, TIME, names)
    kept = [key for key in keys if key == TIME or key in names or is_mapping(data)]
    return {key: _fill_gaps(data[key], key, missing) if key in names else data[key] for key in kept}, missing


def _fill_gaps_of_trace(trace: Trace, names: Sequence[str]) -> tuple[Trace, dict[str, Mask]]:
    """Return a trace in which each signal that lacks samples of its table has all of them."""
    made, missing = {name: trace.channel(name) for name in trace}, {}
    for name in names:
        place = trace.aliases.get(name, name)
        channel = made.get(place)
        if channel is None or channel.times is None or channel.table is None:
            continue
        gaps = np.isin(channel.table, channel.times, assume_unique=True, invert=True)
        values = np.zeros(len(gaps))
        values[~gaps] = channel.values
        made[place] = replace(channel, times=channel.table, values=values, first_gap=None, table=None)
        missing[name] = gaps
    return trace.with_channels(made), missing


def _items(given: Any, what: str, example: str, names: Sequence[str]) -> list[tuple[str, Any]]:
    if given is None:
        return []
    if not isinstance(given, Mapping):
        raise UsageError(f"{what}={shown(given)} is no mapping from variables; give for example {example}")
    for name in given:
        if name not in names:
            reads = ", ".join(names) or "no variable"
            raise UsageError(
                f"{what}= has '{name}', and the formula reads {reads}{did_you_mean(str(name), names)}"
            )
    return list(given.items())


def _fill_gaps(values: Any, name: str, missing: dict[str, Mask]) -> Any:
    """Return values with zeros in the gaps, which are put into ``missing``."""
    mask = gaps_of(values)
    if mask is None or not mask.any():
        return values
    missing[name] = mask
    return [0.0 if gap else value for value, gap in zip(items_of(values), mask, strict=True)]
