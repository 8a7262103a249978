"""matplotlib, and the vertical axis of a panel with infinities at its edges."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.extras import library
from rtamt.lazy.modules import np
from rtamt.plot import style
from rtamt.plot.texts import literal, shorten
from rtamt.signals.sampling_period import merged

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.plot.lines import Line
    from rtamt.signals.arrays import FloatArray


#: Names of values that have room at an axis, and the characters of each.
_NAMES, _LONGEST = 6, 9

#: The largest value that matplotlib draws without overflow, and the factor of panels with larger ones.
_LARGEST, _SCALE = 1e290, 1e-20


def matplotlib(module: str = "figure") -> Any:
    """Return a module of matplotlib."""
    return library(f"matplotlib.{module}", "a plot", "plot")


def names_of(lines: Sequence[Line]) -> Mapping[float, str]:
    """Return the names of values on an axis for some lines: none, unless all lines have the same."""
    return lines[0].names if lines and all(line.names == lines[0].names for line in lines) else {}


def _thin_out(values: Sequence[float], distance: float) -> list[float]:
    """Return those of increasing values that are far enough from the one before.

    >>> _thin_out([0, 1, 2, 9], 2)
    [0, 2, 9]
    """
    found: list[float] = []
    for value in values:
        if not found or value - found[-1] >= distance:
            found.append(value)
    return found


class Edges:
    """The vertical axis: finite values in the middle, infinities at the edges, if there are any."""

    def __init__(self, axis: Any, finite: FloatArray, lines: Sequence[Line]) -> None:
        low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 0.0)
        self._scale = _SCALE if max(-low, high) > _LARGEST else 1.0
        low, high = self._scale * low, self._scale * high
        if low == high:
            low, high = low - 1.0, high + 1.0
        pad = 0.09 * (high - low)
        self._ends = (low - 3 * pad, high + 3 * pad)
        self.middle = (low + high) / 2
        infinite = [any((line.values == sign * np.inf).any() for line in lines) for sign in (-1, 1)]
        limits = [low - (4 if infinite[0] else 1) * pad, high + (4 if infinite[1] else 1) * pad]
        names = names_of(lines)
        if names:
            ticks = _thin_out(merged([finite]).tolist(), (high - low) / _NAMES)
        else:
            ticks = [
                t for t in matplotlib("ticker").MaxNLocator(3).tick_values(low, high) if low <= t <= high
            ]
        values = [t / self._scale for t in ticks]
        labels = [literal(shorten(names.get(t, style.number(t)), _LONGEST)) for t in values]
        for is_above, there in enumerate(infinite):
            if there:
                ticks.append(self._ends[is_above])
                labels.append(style.INFINITE[bool(is_above)])
                axis.axhline(self._ends[is_above], color=style.QUIET, linewidth=0.6, linestyle=":")
        axis.set_ylim(*limits)
        axis.set_yticks(ticks, labels)

    def shown(self, values: FloatArray) -> FloatArray:
        """Return values as they are drawn."""
        return np.clip(self._scale * values, *self._ends)

    def place(self, value: float) -> float:
        """Return one value as it is drawn."""
        return float(self.shown(np.array([value]))[0])
