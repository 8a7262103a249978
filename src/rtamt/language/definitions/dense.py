"""The dense-time meaning of temporal operators: the value at one instant, literally by the definition.

Operands are :class:`Steps`: piecewise constant, right-continuous functions on [t₀, ∞), all from the same
t₀; the last value holds forever. ``x`` stands for φ, ``y`` for ψ; ``a`` and ``b`` are the bounds of the
interval, and ``b=None`` means unbounded; ``t`` is an instant, t ≥ t₀. Every window is clipped at t₀
and nowhere else; over an empty set the supremum is -inf and the infimum +inf. Pointwise operators
(``and``, ``+``, …) have the same meaning as in discrete time, value by value.

The supremum over a window is a maximum over the finitely many values that the operands take in it: at the
points where an operand changes, and on the open intervals between them. **Times and bounds are counted in
quarters of a tick**, so that every such interval contains an instant that represents it: samples and
bounds lie at whole ticks, results are needed between them (at halves), and the windows around those are
evaluated between *their* points (at quarters). Python's integers are unbounded, so that the sum of a time
and a bound cannot overflow.

:func:`lifted` turns the values at single instants into a step function, which can be an operand again.

>>> from rtamt.language.definitions.dense import Steps, lifted, once
>>> pulse = Steps((0, 8, 12), (0.0, 6.0, 0.0))  # 6 from tick 2 to tick 3
>>> once(20, pulse, 8, 12), once(24, pulse, 8, 12)
(6.0, 0.0)
>>> lifted(once, (pulse,), 8, 12)
Steps(times=(0, 8, 16, 24), values=(-inf, 0.0, 6.0, 0.0))
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from fractions import Fraction
from itertools import pairwise
from math import inf

from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

#: Times and bounds in these functions are counted in quarters of a tick.
QUARTERS = 4


class Steps(NamedTuple):
    """A step function: constant from each of ``times`` (strictly increasing) up to the next, and after the last."""

    times: tuple[int, ...]
    values: tuple[float, ...]

    def at(self, t: int) -> float:
        """Return the value at an instant ``t``, which must not precede the first of ``times``."""
        return self.values[bisect_right(self.times, t) - 1]

    def over(self, instants: Iterable[int]) -> list[float]:
        """Return the values at several instants.

        >>> Steps((0, 8), (1.0, 2.0)).over([0, 7, 8])
        [1.0, 1.0, 2.0]
        """
        times, values = self.times, self.values
        return [values[bisect_right(times, t) - 1] for t in instants]


def merged(times: Iterable[int], values: Iterable[float]) -> Steps:
    """Return the same function without the times at which its value does not change."""
    kept_times: list[int] = []
    kept: list[float] = []
    before: float | None = None
    for time, value in zip(times, values, strict=True):
        if value != before:
            kept_times.append(time)
            kept.append(value)
            before = value
    return Steps(tuple(kept_times), tuple(kept))


def critical(operands: Iterable[Steps], a: int, b: int | None, before: int = 0) -> list[int]:
    """Return all instants, from t₀ on, at which an operator's value can change.

    The value at t depends only on the position of t, t ± a, t ± b and t - b + a among the times at which an
    operand changes. It is therefore constant between adjacent instants of this set, and after the last. ``before``:
    how many ticks an operator compares besides; instants so much earlier and later are among them.
    """
    operands = tuple(operands)
    shifts = {0, a, -a} if b is None else {0, a, -a, b, -b, b - a, a - b}
    if before:
        shifts = {shift + by * QUARTERS for shift in shifts for by in (-before, 0, before)}
    start = operands[0].times[0]
    changes = {c for operand in operands for c in operand.times}
    return sorted({c + shift for c in changes for shift in shifts if c + shift >= start})


def lifted(
    at: Callable[..., float],
    operands: tuple[Steps, ...],
    a: int,
    b: int | None,
    rank: tuple[int, float] | tuple[()] = (),
    *,
    past: bool = True,
    before: int = 0,
) -> Steps:
    """Return an operator's values at all instants, from ``at(t, *operands, a, b)``, its value at one.

    Robustness is right-continuous: at each critical instant it has the value that it has strictly between
    that instant and the next. The definitions give the same value at the critical instant itself, except for
    until[a,b] and precedes[a,b] with a > 0, which may differ there (φ falls exactly a later); by convention
    such an instant takes the value that follows. ``rank``: what an operator of a share takes after its bounds;
    ``past``: whether its window lies behind; ``before``: how many ticks it reads besides.
    """
    instants = critical(operands, a, b, before)
    if rank:
        assert b is not None
        windows = [(t - b, t - a) if past else (t + a, t + b) for t in instants]
        instants = sorted({*instants, *crossings(instants, operands[0], windows, *rank)})
    between = [(c + d) // 2 for c, d in pairwise(instants)] + [instants[-1] + QUARTERS // 2]
    return merged(instants, [at(t, *operands, a, b, *rank) for t in between])


def pieces(
    begin: int, end: int | None, operands: tuple[Steps, ...], cut: int | None = None
) -> list[tuple[int, bool]]:
    """Return one instant for each piece of [begin, end] on which nothing changes, in order.

    The pieces are points (False) and the open intervals between adjacent points (True). The points are
    both ends, the changes of the operands, and ``cut`` if it lies inside. ``end=None`` is infinity.
    """
    if end is not None and end < begin:
        return []
    points = {begin} if end is None else {begin, end}
    for operand in operands:
        times = operand.times
        last = len(times) if end is None else bisect_left(times, end)
        points.update(times[bisect_right(times, begin) : last])
    if cut is not None and begin < cut and (end is None or cut < end):
        points.add(cut)
    ordered = sorted(points)
    pieces = [(ordered[0], False)]
    for c, d in pairwise(ordered):
        pieces += [((c + d) // 2, True), (d, False)]
    return pieces if end is not None else [*pieces, (ordered[-1] + 1, True)]


# ---- windows ------------------------------------------------------------------------------------


def _ahead(t: int, x: Steps, a: int, b: int | None) -> list[float]:
    """Return the values of φ on [t+a, t+b], which is not clipped at the end of the trace."""
    return [x.at(u) for u, _ in pieces(t + a, None if b is None else t + b, (x,))]


def _behind(t: int, x: Steps, a: int, b: int | None) -> list[float]:
    """Return the values of φ on [t-b, t-a] ∩ [t₀, ∞)."""
    start = x.times[0]
    return [x.at(u) for u, _ in pieces(start if b is None else max(t - b, start), t - a, (x,))]


def eventually(t: int, x: Steps, a: int, b: int | None) -> float:
    """``eventually[a,b] φ``: sup of φ over [t+a, t+b]."""
    return max(_ahead(t, x, a, b))


def always(t: int, x: Steps, a: int, b: int | None) -> float:
    """``always[a,b] φ``: inf of φ over [t+a, t+b]."""
    return min(_ahead(t, x, a, b))


def once(t: int, x: Steps, a: int, b: int | None) -> float:
    """``once[a,b] φ``: sup of φ over [t-b, t-a] ∩ [t₀, ∞)."""
    return max(_behind(t, x, a, b), default=-inf)


def historically(t: int, x: Steps, a: int, b: int | None) -> float:
    """``historically[a,b] φ``: inf of φ over [t-b, t-a] ∩ [t₀, ∞)."""
    return min(_behind(t, x, a, b), default=inf)


# ---- numbers at other instants ------------------------------------------------------------------


def held(t: int, x: Steps, truth: Steps, *rest: Any) -> float:
    """``held(x, φ)``: x where φ is true, else just before φ ended last, else ``init``, or x(t₀)."""
    *init, _a, _b = rest
    last = bisect_right(truth.times, t) - 1
    if truth.values[last] > 0:
        return x.at(t)
    while last >= 0 and not truth.values[last] > 0:
        last -= 1
    if last < 0:
        return init[0].at(t) if init else x.values[0]
    return x.at(truth.times[last + 1] - 1)


def delay(t: int, x: Steps, *rest: Any) -> float:
    """``delay[d](x)``: x(t-d); where that is before t₀ ``init``, or x(t₀)."""
    *init, a, _b = rest
    if t - a >= x.times[0]:
        return x.at(t - a)
    return init[0].at(t) if init else x.values[0]


def ahead(t: int, x: Steps, a: int, _b: int | None) -> float:
    """``ahead[d](x)``: x(t+d), the last value being held."""
    return x.at(t + a)


def diff(t: int, x: Steps, a: int, b: int | None) -> float:
    """``diff[d](x)``: x - delay[d](x)."""
    return x.at(t) - delay(t, x, a, b)


def rate(t: int, x: Steps, a: int, b: int | None, period: Fraction = Fraction(1, QUARTERS)) -> float:
    """``rate[d](x)``: diff[d](x) / d; ``period`` is the length of a quarter of a tick in seconds."""
    return diff(t, x, a, b) / float(a * period)


# ---- shares of a window -------------------------------------------------------------------------


def _held(x: Steps, first: int, last: int, value: float, outside: float) -> int:
    """Return for how long φ is at least ``value`` within [first, last]; before t₀ it is ``outside``."""
    total = min(last, x.times[0]) - first if outside >= value and first < x.times[0] else 0
    ends = (*x.times[1:], max(last, x.times[-1]))
    for begin, end, v in zip(x.times, ends, x.values, strict=True):
        if v >= value:
            total += max(0, min(end, last) - max(begin, first))
    return total


def _share(x: Steps, first: int, last: int, k: int, outside: float) -> float:
    """The greatest value that φ has, or exceeds, for k ticks within [first, last]."""
    return max(
        v
        for v in (*x.values, outside, -inf)
        if v == -inf or _held(x, first, last, v, outside) >= k * QUARTERS
    )


def atleast(t: int, x: Steps, a: int, b: int, k: int, outside: float) -> float:
    """``atleast[a,b](share, φ)``: the greatest value that φ reaches for k ticks within [t+a, t+b]."""
    return _share(x, t + a, t + b, k, outside)


def wasatleast(t: int, x: Steps, a: int, b: int, k: int, outside: float) -> float:
    """``wasatleast[a,b](share, φ)``: the greatest value that φ reaches for k ticks within [t-b, t-a]."""
    return _share(x, t - b, t - a, k, outside)


def crossings(
    instants: list[int], x: Steps, windows: list[tuple[int, int]], k: int, outside: float
) -> set[int]:
    """Return where between adjacent instants φ begins or ceases to reach a value for k ticks of the window.

    ``windows``: that of each instant. Between adjacent ones the time for which a value is reached is a line of slope
    1, 0 or -1.
    """
    found = set()
    for value in {*x.values, outside}:
        missing = [k * QUARTERS - _held(x, *window, value, outside) for window in windows]
        found |= {
            c + abs(m)
            for (c, d), (m, n) in zip(pairwise(instants), pairwise(missing), strict=True)
            if m * n < 0
        }
    return found


# ---- events in a window -------------------------------------------------------------------------


def count(t: int, truth: Steps, a: int, b: int | None) -> float:
    """``count[a,b](φ)``: how many ticks with which φ becomes true meet [t-b, t-a] ∩ [t₀, ∞)."""
    first = -inf if b is None else t - b
    before = (-inf, *truth.values)
    return float(
        sum(
            value > 0 and not earlier > 0 and begin <= t - a and begin + QUARTERS > first
            for begin, value, earlier in zip(truth.times, truth.values, before, strict=False)
        )
    )


def pulses(t: int, x: Steps, a: int, b: int | None) -> float:
    """Return how many ticks in which x is positive meet [t-b, t-a]; several of one stretch are infinitely many."""
    start = x.times[0]
    first, last = start if b is None else max(t - b, start), t - a
    total, ends = 0.0, (*x.times[1:], None)
    for begin, end, value in zip(x.times, ends, x.values, strict=True):
        if not value > 0 or begin > last or (end is not None and end <= first):
            continue
        met = min(last, last if end is None else end - 1) // QUARTERS - max(begin, first) // QUARTERS
        total += inf if met else 1.0
    return total


# ---- edges --------------------------------------------------------------------------------------


def _before(t: int, x: Steps, tick: int) -> float | None:
    """Return the value of φ one tick ago; None where that is before t₀."""
    return x.at(t - tick) if t - tick >= x.times[0] else None


def rise(t: int, x: Steps, tick: int, _: int | None) -> float:
    """``rise φ``: φ(t) and not φ(t - 1 tick), hence φ within the first tick."""
    before = _before(t, x, tick)
    return x.at(t) if before is None else min(-before, x.at(t))


def fall(t: int, x: Steps, tick: int, _: int | None) -> float:
    """``fall φ``: φ(t - 1 tick) and not φ(t), hence -φ within the first tick."""
    before = _before(t, x, tick)
    return -x.at(t) if before is None else min(before, -x.at(t))


# ---- two operands in time -----------------------------------------------------------------------


def _reached(begin: int, first: int, last: int | None, x: Steps, y: Steps) -> float:
    """Sup over t' ∈ [first, last] of min(ψ(t'), inf of φ over [begin, t')); begin ≤ first ≤ last."""
    best, held = -inf, inf
    for u, interval in pieces(begin, last, (x, y), cut=first):
        if interval:  # part of the interval precedes each t' inside it
            held = min(held, x.at(u))
        if u >= first:
            best = max(best, min(y.at(u), held))
        if not interval:
            held = min(held, x.at(u))
    return best


def until(t: int, x: Steps, y: Steps, a: int, b: int | None) -> float:
    """``φ until[a,b] ψ``: sup over t' ∈ [t+a, t+b] of min(ψ(t'), inf of φ over [t, t'))."""
    return _reached(t, t + a, None if b is None else t + b, x, y)


def precedes(t: int, x: Steps, y: Steps, a: int, b: int) -> float:
    """``φ precedes[a,b] ψ``: sup over t' ∈ [t-b+a, t] of min(ψ(t'), inf of φ over [t-b, t')), from t₀ on."""
    start = x.times[0]
    return _reached(max(t - b, start), max(t - b + a, start), t, x, y)


def since(t: int, x: Steps, y: Steps, a: int, b: int | None) -> float:
    """``φ since[a,b] ψ``: sup over t' ∈ [t-b, t-a] ∩ [t₀, ∞) of min(ψ(t'), inf of φ over (t', t])."""
    start = x.times[0]
    begin = start if b is None else max(t - b, start)
    best, held = -inf, inf
    for u, interval in reversed(pieces(begin, t, (x, y), cut=t - a)):
        if interval:  # part of the interval follows each t' inside it
            held = min(held, x.at(u))
        if u <= t - a:
            best = max(best, min(y.at(u), held))
        if not interval:
            held = min(held, x.at(u))
    return best


def unless(t: int, x: Steps, y: Steps, a: int, b: int | None) -> float:
    """``φ unless[a,b] ψ``: max(always[0,b] φ, φ until[a,b] ψ)."""
    return max(always(t, x, 0, b), until(t, x, y, a, b))
