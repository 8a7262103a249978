"""Numbers over time and shares of a window, by brute force: lists in, lists out.

A list holds one entry a sample (discrete time) or a cell (dense time); a condition is a list of Booleans. What
differs between the two is said where it does. ``a`` and ``b`` are whole steps, b may be infinite, and the window
of an entry t is [t - b, t - a], cut to the trace.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.language.formula import Interval

    Values = list[Any]

inf = math.inf


class Time(NamedTuple):
    """What an operator is applied in."""

    step: Fraction  # seconds
    dense: bool
    a: int
    b: float
    interval: Interval | None


# Which operands are conditions.
CONDITIONS = {"if": (0,), "held": (1,), "duration": (0,), "count": (0,)}


def window_of(interval: Interval | None, step: Fraction) -> tuple[int, float]:
    """Return the bounds in whole steps: an open one is a step further inside."""
    if interval is None:
        return 0, inf
    begin = int(interval.begin / step) + getattr(interval, "begin_open", False)
    if interval.end is None:
        return begin, inf
    return begin, int(interval.end / step) - getattr(interval, "end_open", False)


# ---- values at other instants ----------------------------------------------------------------------


def _choice(_time: Time, condition: Values, x: Values, y: Values) -> Values:
    return [v if c else w for c, v, w in zip(condition, x, y, strict=True)]


def _distance(time: Time) -> int:
    return 1 if time.interval is None else time.a


def _delay(time: Time, x: Values, init: Values | None = None) -> Values:
    d = _distance(time)
    return [x[t - d] if t >= d else x[0] if init is None else init[t] for t in range(len(x))]


def _ahead(time: Time, x: Values) -> Values:
    # Of a list of cells the last entry stands for the rest of time: the same formula.
    return [x[min(t + _distance(time), len(x) - 1)] for t in range(len(x))]


def _diff(time: Time, x: Values) -> Values:
    return [now - before for now, before in zip(x, _delay(time, x), strict=True)]


def _rate(time: Time, x: Values) -> Values:
    return [d / float(_distance(time) * time.step) for d in _diff(time, x)]


def _held(_time: Time, x: Values, condition: Values, init: Values | None = None) -> Values:
    # In dense time the value just before the condition ended is the one in its last cell.
    values = []
    for t in range(len(x)):
        past = [u for u in range(t + 1) if condition[u]]
        values.append(x[past[-1]] if past else x[0] if init is None else init[t])
    return values


# ---- windows -----------------------------------------------------------------------------------------


def _within(time: Time, t: int) -> range:
    return range(int(max(t - time.b, 0)), t - time.a + 1)


def _added(values: Values) -> float:
    total = values[0]
    for v in values[1:]:
        total += v
    return float(total)


def _sum_at(time: Time, x: Values, t: int) -> float:
    """Blocks as long as the window, from sample 0 on: the end of one, backwards, and the begin of the next."""
    window = _within(time, t)
    if not window:
        return 0.0
    first, last = window[0], window[-1]
    block = 0 if time.b == inf else last - last % (int(time.b) - time.a + 1)
    if block <= first:
        return _added(x[first : last + 1])
    return _added(x[first:block][::-1]) + _added(x[block : last + 1])


def _sum(time: Time, x: Values) -> Values:
    return [_sum_at(time, x, t) for t in range(len(x))]


def _mean(time: Time, x: Values, init: Values | None = None) -> Values:
    values = []
    for t in range(len(x)):
        count = len(_within(time, t))
        values.append(_sum_at(time, x, t) / count if count else x[0] if init is None else init[t])
    return values


def _times(step: Fraction, value: float) -> float:
    return float(Fraction(value) * step) if math.isfinite(value) else value


def _integral(time: Time, x: Values) -> Values:
    return [_times(time.step, v) for v in _sum(time, x)]


def _duration(time: Time, condition: Values) -> Values:
    return [_times(time.step, sum(condition[u] for u in _within(time, t))) for t in range(len(condition))]


def _count(time: Time, condition: Values) -> Values:
    # `rise` is true for a sample, and for a tick in dense time: the pulses that the window meets.
    rises = [now and not (t and condition[t - 1]) for t, now in enumerate(condition)]
    return [float(sum(rises[u] for u in _within(time, t))) for t in range(len(rises))]


#: In dense time sums are lines, not steps.
DISCRETE_ONLY = {"sum", "mean", "integral", "duration"}

NUMBERS: dict[str, Callable[..., Values]] = {
    "if": _choice,
    "delay": _delay,
    "ahead": _ahead,
    "diff": _diff,
    "rate": _rate,
    "held": _held,
    "sum": _sum,
    "mean": _mean,
    "integral": _integral,
    "duration": _duration,
    "count": _count,
}


# ---- shares of a window --------------------------------------------------------------------------------


def _needed(time: Time) -> tuple[int, bool]:
    """Return how many steps of the window are needed, and whether those outside the trace count."""
    share: Any = time.interval.share
    nominal = int(time.b) - time.a + (not time.dense)
    kind = str(getattr(share.kind, "value", share.kind))
    if kind == "percent":
        return math.ceil(share.amount / 100 * nominal), True
    if kind == "duration":
        return math.ceil(share.amount / time.step), False
    return int(share.amount), False


def share_at(time: Time, p: Values, t: int, bottom: Any, top: Any, *, past: bool) -> Any:
    """Return the k-th largest value of a window.

    In dense time the window of an instant inside cell t covers a part of each of the cells at its ends, which
    make up one cell together. A value is reached for k whole ticks there if it is reached in k of the cells
    between, or in k - 1 of them and in both at the ends.
    """
    k, counts = _needed(time)
    first, last = (t - int(time.b), t - time.a) if past else (t + time.a, t + int(time.b))
    size = len(p)

    def value(u: int) -> Any:
        if time.dense and u >= size:
            return p[-1]
        return p[u] if 0 <= u < size else top if counts else bottom

    values = [value(u) for u in range(first, last + 1)]
    if time.dense:
        values = [min(values[0], values[-1]), *values[1:-1]]
    return sorted(values, reverse=True)[k - 1] if 0 < k <= len(values) else top if k <= 0 else bottom
