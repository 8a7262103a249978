"""Long lines, reduced to the range of values in each pixel; numbers as JSON data."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

from rtamt.lazy.modules import np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    View = tuple[float, float]


def line(
    positions: NDArray[np.float64], values: NDArray[np.float64], width: int, view: View | None = None
) -> dict[str, Any]:
    """Return the points to draw: all, or of each of ``width`` parts of the time the lowest and the highest.

    ``view``: the visible time span (begin, end), None for the whole trace; see :func:`kept_in`.

    >>> import numpy as np
    >>> values = np.array([0.0, 9, 1, 2, -5, 3, 4, 5])
    >>> line(np.arange(8.0), values, 2)
    {'x': [0.0, 1.0, 4.0, 7.0], 'y': [0.0, 9.0, -5.0, 5.0], 'points': 8}
    >>> line(np.arange(8.0), values, 2, (2.5, 4.5))
    {'x': [2.0, 3.0, 4.0, 5.0], 'y': [1.0, 2.0, -5.0, 3.0], 'points': 8}
    """
    kept = kept_in(positions, (values,), width, view)
    return {"x": positions[kept].tolist(), "y": numbers(values[kept]), "points": len(values)}


def kept_in(
    positions: NDArray[np.float64], lines: Sequence[NDArray[np.float64]], width: int, view: View | None
) -> NDArray[np.intp]:
    """Return the indices of the points to draw of lines over the same positions.

    These are the points in the view and the nearest one on either side, so that lines reach the edges.
    """
    first, last = 0, len(positions)
    if view is not None:
        first, last = (
            int(np.searchsorted(positions, view[0])),
            int(np.searchsorted(positions, view[1], "right")),
        )
    inside = np.arange(first, last)
    if last - first > 2 * width:
        seen = positions[first:last]
        shown = np.zeros(last - first, bool)
        for values in lines:
            shown[extremes(seen, values[first:last], width)] = True
        inside = first + np.flatnonzero(shown)
    beside = [k for k in (first - 1, last) if 0 <= k < len(positions)]
    kept: NDArray[np.intp] = np.sort(np.append(inside, beside).astype(np.intp))
    return kept


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
