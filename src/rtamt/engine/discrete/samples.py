"""Read one sample: its time and a number for every variable."""

from __future__ import annotations

from math import isfinite, isnan
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, shown
from rtamt.signals import arrays
from rtamt.signals.counting import implausible, is_implausible
from rtamt.signals.regular import not_increasing

if TYPE_CHECKING:
    from collections.abc import Mapping


def read_time(time: Any, index: int, last: float | None, *, again: bool = False) -> float:
    """Return a sample's timestamp; raise :class:`TraceError` for an invalid one.

    ``again``: whether it may be the same as the ``last`` one.
    """
    stamp = arrays.number_of(time)
    if stamp is None:
        raise TraceError(
            f"time is {shown(time)} at sample {index}, expected a number of seconds", variable="time"
        )
    if is_implausible(stamp):
        raise implausible("time", index, time if is_implausible(time) else stamp)
    if not isfinite(stamp):
        raise TraceError(f"time is {stamp} at sample {index}: give a finite number of seconds")
    if last is not None and (stamp < last or (stamp == last and not again)):
        raise not_increasing(index, stamp, last)
    return stamp


def read_values(
    values: Mapping[str, Any], names: tuple[str, ...], index: int, time: float
) -> dict[str, float]:
    """Return a sample's values in the order of the names, each read once; raise :class:`TraceError`."""
    for name in values:
        if name not in names:
            raise arrays.unknown_variable(name, names)
    numbers = {}
    for name in names:
        if name not in values:
            raise arrays.missing_variable(name, tuple(values))
        number = arrays.number_of(values[name])
        if number is None:
            raise TraceError(
                f"'{name}' is {shown(values[name])} at sample {index}, expected a number",
                variable=name,
                index=index,
            )
        if isnan(number):
            raise arrays.nan_error(name, index, time)
        numbers[name] = number
    return numbers
