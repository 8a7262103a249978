"""Long lines, reduced to the range of values in each pixel; numbers as JSON data."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

from rtamt.lazy_numpy import np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def line(positions: NDArray[np.float64], values: NDArray[np.float64], width: int) -> dict[str, Any]:
    """Return the points to draw: all, or of each of ``width`` parts of the time the lowest and the highest.

    >>> import numpy as np
    >>> line(np.arange(8.0), np.array([0.0, 9, 1, 2, -5, 3, 4, 5]), 2)
    {'x': [0.0, 1.0, 4.0, 7.0], 'y': [0.0, 9.0, -5.0, 5.0], 'points': 8, 'low': -5.0, 'high': 9.0}
    """
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if len(finite) else (None, None)
    count = len(values)
    if count > 2 * width:
        kept = extremes(positions, values, width)
        positions, values = positions[kept], values[kept]
    return {"x": positions.tolist(), "y": numbers(values), "points": count, "low": low, "high": high}


def extremes(positions: NDArray[np.float64], values: NDArray[np.float64], width: int) -> NDArray[np.intp]:
    """Return the indices of the lowest and the highest value in each part of the time, in order."""
    starts = parts(positions, width)
    group = np.repeat(np.arange(len(starts)), np.diff(starts, append=len(values)))
    by_value = np.lexsort((values, group))  # within each part from the lowest to the highest
    ends = np.append(starts[1:], len(values)) - 1
    kept: NDArray[np.intp] = np.sort(np.concatenate([by_value[starts], by_value[ends]]))
    return kept[np.diff(kept, prepend=-1) > 0]


def parts(positions: NDArray[np.float64], width: int) -> NDArray[np.intp]:
    """Return the first index of each part of the time that has positions, of ``width`` equal parts."""
    span = float(positions[-1] - positions[0]) or 1.0
    column = np.minimum(((positions - positions[0]) / span * width).astype(int), width - 1)
    return np.flatnonzero(np.diff(column, prepend=-1))


def numbers(values: NDArray[np.float64]) -> list[float | str]:
    """Return numbers as JSON data, infinities as JavaScript reads them."""
    found: list[Any] = values.tolist()
    return found if np.isfinite(values).all() else [number(each) for each in found]


def number(value: float) -> float | str:
    """Return one number as JSON data.

    >>> number(2.5), number(float("-inf"))
    (2.5, '-Infinity')
    """
    return value if isfinite(value) else f"{'-' if value < 0 else ''}Infinity"
