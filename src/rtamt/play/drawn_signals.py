"""Signals that the user draws, as samples."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError
from rtamt.lazy.modules import np
from rtamt.play.messages import MOST_SAMPLES

if TYPE_CHECKING:
    from collections.abc import Mapping
    from fractions import Fraction

    from numpy.typing import NDArray

    from rtamt.play.messages import Drawn

#: How far a point may be behind an instant, in periods, and still count as of that instant.
_TOLERANCE = 1e-6
#: More samples than this have no exact number in a message.
_COUNTABLE = 1e15


def sample_signals(signals: Mapping[str, Drawn], period: Fraction, duration: float) -> dict[str, Any]:
    """Return samples of discrete time: from 0 to ``duration``, one every ``period``.

    >>> from fractions import Fraction
    >>> from rtamt.play.messages import Drawn
    >>> steps = {"x": Drawn(((0.0, 1.0), (0.3, 5.0)), hold=True), "y": Drawn(((0.0, 0.0), (0.4, 4.0)), hold=False)}
    >>> data = sample_signals(steps, Fraction(1, 10), 0.4)
    >>> data["x"], data["y"].round(9)
    (array([1., 1., 1., 5., 5.]), array([0., 1., 2., 3., 4.]))
    """
    count = _count(period, duration)
    times = _grid(period, count)
    return {"time": times, **{name: _values(each, times, float(period)) for name, each in signals.items()}}


def signal_points(signals: Mapping[str, Drawn], period: Fraction, duration: float) -> dict[str, Any]:
    """Return signals of dense time: values hold from point to point; lines are sampled every ``period``."""
    found = {}
    for name, each in signals.items():
        if each.hold:
            with np.errstate(over="ignore"):  # such times are after the end
                times = np.array([time for time, _ in each.points]).round(9)
            values = np.array([value for _, value in each.points])
            inside = (times > 0) & (times < duration)
            start, end = _values(each, np.array([0.0, duration]), 0.0)
            times = np.concatenate([[0.0], times[inside], [duration]])
            found[name] = times, np.concatenate([[start], values[inside], [end]])
        else:
            times = _grid(period, _count(period, duration))
            found[name] = times, _values(each, times, float(period))
    return found


def _count(period: Fraction, duration: float) -> int:
    if duration < 0:
        raise UsageError(f"the duration is {duration:g} s; it must not be negative")
    periods = duration / float(period) + _TOLERANCE
    if periods >= MOST_SAMPLES:
        count = f"{int(periods) + 1}" if periods < _COUNTABLE else "more than 10^15"
        raise UsageError(
            f"{count} samples are too many to draw, at most {MOST_SAMPLES}: choose a longer period, "
            f"a shorter duration, or load a recording"
        )
    return int(periods) + 1


def _grid(period: Fraction, count: int) -> NDArray[np.float64]:
    """Return the multiples of a period, each rounded once."""
    grid: NDArray[np.float64] = np.arange(count, dtype=float) * period.numerator / period.denominator
    return grid


def _values(signal: Drawn, times: NDArray[np.float64], period: float) -> NDArray[np.float64]:
    at, values = (np.array(column) for column in zip(*signal.points, strict=True))
    if not signal.hold:
        lines: NDArray[np.float64] = np.interp(times, at, values)
        return lines
    # A point on the grid may be behind its instant by the rounding of a double.
    last = np.searchsorted(at, times + _TOLERANCE * period, side="right") - 1
    held: NDArray[np.float64] = values[np.maximum(last, 0)]
    return held
