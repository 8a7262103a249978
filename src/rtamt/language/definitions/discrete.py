"""The discrete-time meaning of operators over time: one pure function per operator, the reference for every engine.

Arrays hold the values at samples 0 … n-1 as float64. Inputs contain no NaN; every function returns a
new array of n values. ``x`` stands for φ (or a number), ``y`` for ψ. ``a`` and ``b`` are the bounds of
the interval in whole samples; ``b=None`` means unbounded. T is the set of samples. Every window is clipped
to T; over an empty set the supremum is -inf and the infimum +inf. Operators of one instant are in
``pointwise.py``.

Slow on purpose: each function is the formula of the definition (the paper's Definition 2) and nothing more.

>>> import numpy as np
>>> from rtamt.language.definitions.discrete import once
>>> once(np.array([1.0, 3.0, 2.0, 0.0]), 1, 2)
array([-inf,   1.,   3.,   3.])
"""

from __future__ import annotations

import math
from fractions import Fraction

from rtamt.language.definitions.pointwise import div, mul, sub
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array: TypeAlias = NDArray[np.float64]

inf = math.inf

# ---- windows ------------------------------------------------------------------------------------


def _ahead(t: int, a: int, b: int | None, n: int) -> range:
    """[t+a, t+b] ∩ T."""
    return range(t + a, n if b is None else min(t + b + 1, n))


def _behind(t: int, a: int, b: int | None) -> range:
    """[t-b, t-a] ∩ T, for t in T."""
    return range(0 if b is None else max(t - b, 0), t - a + 1)


def _sup(x: Array, window: range) -> float:
    return float(np.maximum.reduce(x[window.start : window.stop], initial=-inf)) if window else -inf


def _inf(x: Array, window: range) -> float:
    return float(np.minimum.reduce(x[window.start : window.stop], initial=inf)) if window else inf


def eventually(x: Array, a: int, b: int | None) -> Array:
    """``eventually[a,b] φ``: sup of φ over [t+a, t+b] ∩ T."""
    return np.array([_sup(x, _ahead(t, a, b, len(x))) for t in range(len(x))], float)


def always(x: Array, a: int, b: int | None) -> Array:
    """``always[a,b] φ``: inf of φ over [t+a, t+b] ∩ T."""
    return np.array([_inf(x, _ahead(t, a, b, len(x))) for t in range(len(x))], float)


def once(x: Array, a: int, b: int | None) -> Array:
    """``once[a,b] φ``: sup of φ over [t-b, t-a] ∩ T."""
    return np.array([_sup(x, _behind(t, a, b)) for t in range(len(x))], float)


def historically(x: Array, a: int, b: int | None) -> Array:
    """``historically[a,b] φ``: inf of φ over [t-b, t-a] ∩ T."""
    return np.array([_inf(x, _behind(t, a, b)) for t in range(len(x))], float)


# ---- sums over the past --------------------------------------------------------------------------


def _added(values: list[float]) -> float:
    total = 0.0
    for value in values:
        total += value
    return total


def _sum(x: list[float], window: range, width: int | None) -> float:
    """Sum over a window of ``width`` samples (None: all so far), of which those before the trace are missing.

    Doubles round, so that their order matters: the samples are cut into blocks of ``width``. A window is the end of
    one, added backwards, and the begin of the next, added forwards.
    """
    block = 0 if width is None else (window.stop - 1) // width * width
    ending, beginning = x[window.start : block], x[max(block, window.start) : window.stop]
    return _added(ending[::-1]) + _added(beginning)


def sum_(x: Array, a: int, b: int | None) -> Array:
    """``sum[a,b](x)``: the sum of x over [t-b, t-a] ∩ T, NaN if it holds both infinities."""
    xs, width = x.tolist(), None if b is None else b - a + 1
    return np.array([_sum(xs, _behind(t, a, b), width) if t >= a else 0.0 for t in range(len(xs))], float)


def mean(x: Array, *rest: Any) -> Array:
    """``mean[a,b](x, init)``: the mean of x over [t-b, t-a] ∩ T; init where that is empty.

    It is called with x, init if there is one, a and b; by default, init is x at the first sample.
    """
    *init, a, b = rest
    counts = np.array([len(_behind(t, a, b)) for t in range(len(x))])
    with np.errstate(all="ignore"):
        return np.where(counts > 0, sum_(x, a, b) / np.maximum(counts, 1), *(init or (x[:1],)))


def integral(x: Array, a: int, b: int | None, period: Fraction = Fraction(1)) -> Array:
    """``integral[a,b](x)``: the sum times the period n/d: one product if n/d is a double, else sum · n / d."""
    sums = sum_(x, a, b)
    if Fraction(float(period)) == period:
        return mul(sums, np.array(float(period)))
    return div(mul(sums, np.array(float(period.numerator))), np.array(float(period.denominator)))


def duration(truth: Array, a: int, b: int | None, period: Fraction = Fraction(1)) -> Array:
    """``duration[a,b](φ)``: how many samples of [t-b, t-a] ∩ T φ holds at, times the period; ``truth`` is ±inf."""
    return integral(np.where(truth > 0, 1.0, 0.0), a, b, period)


def count(truth: Array, a: int, b: int | None) -> Array:
    """``count[a,b](φ)``: how many samples of [t-b, t-a] ∩ T φ begins to hold at; ``truth`` is ±inf."""
    return sum_(np.where(rise(truth) > 0, 1.0, 0.0), a, b)


# ---- numbers at other instants ------------------------------------------------------------------


def held(x: Array, truth: Array, *init: Array) -> Array:
    """``held(x, φ)``: x at the last sample where φ is true, by its truth; before the first ``init``, or x(0)."""
    values = []
    for t in range(len(x)):
        true = [u for u in range(t + 1) if truth[u] > 0]
        values.append(x[true[-1]] if true else init[0][t] if init else x[0])
    return np.array(values, float)


def delay(x: Array, *rest: Any) -> Array:
    """``delay[d](x)``: x(t-d); where that is before sample 0 ``init``, or x(0)."""
    *init, a, b = rest
    d = 1 if b is None else a
    return np.array([x[t - d] if t >= d else init[0][t] if init else x[0] for t in range(len(x))], float)


def ahead(x: Array, a: int, b: int | None) -> Array:
    """``ahead[d](x)``: x(t+d), or at the last sample."""
    d = 1 if b is None else a
    return np.array([x[min(t + d, len(x) - 1)] for t in range(len(x))], float)


def diff(x: Array, a: int, b: int | None) -> Array:
    """``diff[d](x)``: x - delay[d](x)."""
    return sub(x, delay(x, a, b))


def rate(x: Array, a: int, b: int | None, period: Fraction = Fraction(1)) -> Array:
    """``rate[d](x)``: diff[d](x) / d, d in seconds."""
    d = 1 if b is None else a
    return div(diff(x, a, b), np.array(float(d * period)))


# ---- shares of a window -------------------------------------------------------------------------


def _share(x: Array, windows: list[range], k: int, outside: float) -> Array:
    """The k-th largest value of each window, values outside the trace being ``outside``."""
    n = len(x)
    values = [sorted((x[u] if 0 <= u < n else outside for u in window), reverse=True) for window in windows]
    return np.array([each[k - 1] if k <= len(each) else -inf for each in values], float)


def atleast(x: Array, a: int, b: int, k: int, outside: float) -> Array:
    """``atleast[a,b](share, φ)``: the k-th largest φ over [t+a, t+b]."""
    return _share(x, [range(t + a, t + b + 1) for t in range(len(x))], k, outside)


def wasatleast(x: Array, a: int, b: int, k: int, outside: float) -> Array:
    """``wasatleast[a,b](share, φ)``: the k-th largest φ over [t-b, t-a]."""
    return _share(x, [range(t - b, t - a + 1) for t in range(len(x))], k, outside)


# ---- one-sample shifts --------------------------------------------------------------------------


def prev(x: Array) -> Array:
    """``prev φ``: φ(t-1); weak: +inf at the first sample."""
    return np.array([x[t - 1] if t > 0 else inf for t in range(len(x))], float)


def s_prev(x: Array) -> Array:
    """``s_prev φ``: φ(t-1); strong: -inf at the first sample."""
    return np.array([x[t - 1] if t > 0 else -inf for t in range(len(x))], float)


def next_(x: Array) -> Array:
    """``next φ``: φ(t+1); weak: +inf at the last sample."""
    return np.array([x[t + 1] if t + 1 < len(x) else inf for t in range(len(x))], float)


def s_next(x: Array) -> Array:
    """``s_next φ``: φ(t+1); strong: -inf at the last sample."""
    return np.array([x[t + 1] if t + 1 < len(x) else -inf for t in range(len(x))], float)


def rise(x: Array) -> Array:
    """``rise φ``: prev(not φ) and φ, hence φ at the first sample."""
    return np.array([min(-x[t - 1] if t > 0 else inf, x[t]) for t in range(len(x))], float)


def fall(x: Array) -> Array:
    """``fall φ``: prev φ and not φ, hence -φ at the first sample."""
    return np.array([min(x[t - 1] if t > 0 else inf, -x[t]) for t in range(len(x))], float)


# ---- two operands in time -----------------------------------------------------------------------


def _reached(steps: range, window: range, x: list[float], y: list[float]) -> float:
    """Sup over t' in ``window`` of min(ψ(t'), inf of φ over the steps that come before t')."""
    best, held = -inf, inf
    for u in steps:
        if u in window:
            best = max(best, min(y[u], held))
        held = min(held, x[u])
    return best


def until(x: Array, y: Array, a: int, b: int | None) -> Array:
    """``φ until[a,b] ψ``: sup over t' ∈ [t+a, t+b] ∩ T of min(ψ(t'), inf of φ over [t, t'))."""
    n, xs, ys = len(x), x.tolist(), y.tolist()
    return np.array([_reached(_ahead(t, 0, b, n), _ahead(t, a, b, n), xs, ys) for t in range(n)], float)


def since(x: Array, y: Array, a: int, b: int | None) -> Array:
    """``φ since[a,b] ψ``: sup over t' ∈ [t-b, t-a] ∩ T of min(ψ(t'), inf of φ over (t', t])."""
    n, xs, ys = len(x), x.tolist(), y.tolist()
    # The steps run backwards from t: those before t' are (t', t].
    return np.array([_reached(_behind(t, 0, b)[::-1], _behind(t, a, b), xs, ys) for t in range(n)], float)


def precedes(x: Array, y: Array, a: int, b: int) -> Array:
    """``φ precedes[a,b] ψ``: sup over t' ∈ [t-b+a, t] ∩ T of min(ψ(t'), inf of φ over [t-b, t') ∩ T)."""
    n, xs, ys = len(x), x.tolist(), y.tolist()
    return np.array([_reached(_behind(t, 0, b), _behind(t, 0, b - a), xs, ys) for t in range(n)], float)


def unless(x: Array, y: Array, a: int, b: int | None) -> Array:
    """``φ unless[a,b] ψ``: max(always[0,b] φ, φ until[a,b] ψ)."""
    return np.maximum(always(x, 0, b), until(x, y, a, b))
