"""Read one sample: its time and a number for every variable."""

from __future__ import annotations

from math import isfinite, isnan

from rtamt.errors import TraceError, UsageError, shown
from rtamt.language.units.moments import time_text
from rtamt.language.value_types import BOOLEAN
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals import arrays
from rtamt.signals.coding import NO_TYPES, encoded_value, no_truth
from rtamt.signals.counting import implausible, is_implausible
from rtamt.signals.data_errors import missing_variable, nan_error, unknown_variable
from rtamt.signals.sampling_period import not_increasing

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.signals.coding import Types


def time_of(given: tuple[Any, ...]) -> Any:
    """Return the only value without a name that ``update`` takes, the time of the sample."""
    if len(given) != 1:
        raise UsageError(
            f"update() takes one time, and each variable by its name, such as update(0.5, x=1.0); got {len(given)} "
            f"values without a name"
        )
    return given[0]


def read_time(
    time: Any, index: int, last: float | None, *, again: bool = False, dated: bool = False
) -> float:
    """Return a sample's timestamp; raise :class:`TraceError` for an invalid one.

    ``again``: whether it may be the same as the ``last`` one. ``dated``: whether the caller's times are dates.
    """
    timestamp = arrays.number_of(time)
    if timestamp is None:
        raise TraceError(
            f"time is {shown(time)} at sample {index}, {arrays.number_expected(time, ' of seconds')}",
            variable="time",
        )
    if is_implausible(timestamp):
        raise implausible("time", index, time if is_implausible(time) else timestamp)
    if not isfinite(timestamp):
        raise TraceError(f"time is {timestamp} at sample {index}: give a finite number of seconds")
    if last is not None and (timestamp < last or (timestamp == last and not again)):
        raise not_increasing(index, timestamp, last, dated=dated)
    return timestamp


def read_values(
    values: Mapping[str, Any],
    names: tuple[str, ...],
    index: int,
    time: float,
    types: Types = NO_TYPES,
    *,
    dated: bool = False,
) -> dict[str, float]:
    """Return a sample's values in the order of the names, each read once; raise :class:`TraceError`.

    ``dated``: whether the caller's times are dates.
    """
    for name in values:
        if name not in names:
            raise unknown_variable(name, names)
    numbers = {}
    for name in names:
        if name not in values:
            raise missing_variable(name, tuple(values))
        type_ = types.get(name)
        where = "" if type_ is None else f"sample {index}, time {time_text(time, dated=dated)}"
        number = arrays.number_of(encoded_value(values[name], name, type_, where, index))
        if number is None:
            raise TraceError(
                f"'{name}' is {shown(values[name])} at sample {index}, {arrays.number_expected(values[name])}",
                variable=name,
                index=index,
            )
        if isnan(number):
            raise nan_error(name, index, time, dated=dated)
        if type_ is BOOLEAN and number not in (0.0, 1.0):
            raise no_truth(name, number, where, index)
        numbers[name] = number
    return numbers
