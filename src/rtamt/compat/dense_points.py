"""Signals of dense time as RTAMT represents them: lists of [time, value]."""

from __future__ import annotations

from bisect import bisect_right
from typing import TYPE_CHECKING, Any, TypeAlias

from rtamt.errors import TraceError, shown

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.signals.signal import Signal

#: Times and values as given.
Samples: TypeAlias = tuple[list[Any], list[Any]]


def points_of(signal: Signal, whole: bool) -> list[list[float]]:
    """Return [time, value] pairs; times are floats, or ints where they can be if those given were (``whole``)."""
    times = signal.times.tolist()
    if not whole:
        times = map(float, times)
    return [list(point) for point in zip(times, signal.values.tolist(), strict=True)]


def with_points_at(
    points: list[list[float]], times: Sequence[float], before: Sequence[list[float]]
) -> list[list[float]]:
    """Return a step function with further points, where it has none at one of ``times``.

    ``before``: its last point so far, or nothing.
    """
    if not points:
        return points
    steps = [*before, *points]
    known = [time for time, _ in steps]
    more = {time for time in times if known[0] < time < known[-1]}.difference(known)
    return sorted([*points, *([time, steps[bisect_right(known, time) - 1][1]] for time in more)])


def samples_by_name(dataset: tuple[Any, ...]) -> dict[str, Samples]:
    """Return the times and the values of each variable by its name."""
    given: dict[str, Samples] = {}
    for entry in dataset:
        if not (isinstance(entry, (list, tuple)) and len(entry) == 2 and isinstance(entry[0], str)):
            raise TraceError(
                f"expected a name and samples for each variable, such as ['x', [[0.0, 5.0], [2.5, 1.0]]], "
                f"got {shown(entry)}"
            )
        if entry[0] in given:
            raise TraceError(f"'{entry[0]}' is given twice: give all its samples at once", variable=entry[0])
        given[entry[0]] = _split(entry[1], entry[0])
    return given


def _split(samples: Any, name: str) -> Samples:
    try:
        pairs = [(time, value) for time, value in samples]
    except (TypeError, ValueError):
        raise TraceError(
            f"'{name}' is no dense signal: give a list of [time, value] pairs, such as [[0.0, 5.0], [2.5, 1.0]]",
            variable=name,
        ) from None
    return [time for time, _ in pairs], [value for _, value in pairs]
