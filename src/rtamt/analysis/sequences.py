"""Temporal operators over the values of a trace: windows, since, until, sums, and the end of the trace.

A sequence has a value for each of N instants. ``inside`` marks the instants of the trace: the solver chooses its
length, and future windows ignore instants after its end.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, TypeAlias

from rtamt.analysis.values import NotLinear, Number, Value, Values, Verdict

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rtamt.analysis.solver import Real, Truth

    Join: TypeAlias = Callable[[Sequence[Value]], Value]

#: Sums of more values than this share partial sums.
_FEW = 6


class Sequences:
    """The temporal operators, over one trace of unknown length."""

    def __init__(self, values: Values, inside: Sequence[Truth]) -> None:
        self.values = values
        self.inside = inside

    def join(self, reduce: str) -> Join:
        """Return the join of the values of a window: ``"min"`` or ``"max"``."""
        return self.values.least if reduce == "min" else self.values.greatest

    def within(self, xs: Sequence[Value], reduce: str) -> list[Value]:
        """Return values that do not count after the end of the trace."""
        absent = self.values.constant(float("inf") if reduce == "min" else -float("inf"))
        return [self.values.choose(here, x, absent) for here, x in zip(self.inside, xs, strict=True)]

    def past(self, xs: Sequence[Value], reduce: str, a: int, b: int | None) -> list[Value]:
        """Return the minima or maxima over [t-b, t-a]."""
        join, n = self.join(reduce), len(xs)
        found = _windows(xs, join, None if b is None else b - a + 1)
        return [*[join(())] * min(a, n), *found[: max(0, n - a)]]

    def future(self, xs: Sequence[Value], reduce: str, a: int, b: int | None) -> list[Value]:
        """Return the minima or maxima over [t+a, t+b], up to the end of the trace."""
        return self.past(self.within(xs, reduce)[::-1], reduce, a, b)[::-1]

    def shift(self, xs: Sequence[Value], fill: float, *, past: bool) -> list[Value]:
        """Return the value one sample ago or ahead, ``fill`` where there is none."""
        reduce = "min" if fill > 0 else "max"
        return self.past(xs, reduce, 1, 1) if past else self.future(xs, reduce, 1, 1)

    def since(self, xs: Sequence[Value], ys: Sequence[Value], a: int, b: int | None) -> list[Value]:
        """``x since[a,b] y``: once[a,b] y, and historically[0,a) x, and once[a,a](x since y)."""
        least, greatest = self.values.least, self.values.greatest
        reached: list[Value] = []
        for x, y in zip(xs, ys, strict=True):
            reached.append(greatest((y, least((x, reached[-1])))) if reached else y)
        if a == 0 and b is None:
            return reached
        found = [self.past(ys, "max", a, b), self.past(reached, "max", a, a)]
        if a > 0:
            found.append(self.past(xs, "min", 0, a - 1))
        return [least(each) for each in zip(*found, strict=True)]

    def until(self, xs: Sequence[Value], ys: Sequence[Value], a: int, b: int | None) -> list[Value]:
        """``x until[a,b] y``, up to the end of the trace: read backwards it is since."""
        return self.since(self.within(xs, "min")[::-1], self.within(ys, "max")[::-1], a, b)[::-1]

    def precedes(self, xs: Sequence[Value], ys: Sequence[Value], a: int, b: int) -> list[Value]:
        """``x until[a,b] y``, read from b ago, or from the start of the trace."""
        n, least = len(xs), self.values.least
        complete = self.since(xs[::-1], ys[::-1], a, b)[::-1][: max(0, n - b)]
        before = [least(()), *_windows(xs, least, None)]
        reached = [least((y, x)) for y, x in zip(ys, before, strict=False)]
        return [*self.past(reached, "max", 0, b - a)[: min(b, n)], *complete]

    def ahead(self, xs: Sequence[Value], d: int) -> list[Value]:
        """Return the value d samples ahead, or the last one."""
        held: list[Value] = []
        for here, x in zip(self.inside, xs, strict=True):
            held.append(self.values.choose(here, x, held[-1]) if held else x)
        return [held[min(t + d, len(held) - 1)] for t in range(len(held))]

    def rank(self, xs: Sequence[Value], a: int, b: int, k: int, outside: float, *, past: bool) -> list[Value]:
        """Return the k-th largest value of each window; those outside the trace are ``outside``."""
        if not all(isinstance(x, Verdict) for x in xs):
            raise NotLinear("it ranks numbers")
        count, n, solver = b - a + 1, len(xs), self.values.solver
        missing = Verdict(outside > 0, outside < 0)
        inside = xs if past else self.within(xs, "min" if outside > 0 else "max")
        found: list[Value] = []
        for t in range(n):
            steps = range(t - b, t - a + 1) if past else range(t + a, t + b + 1)
            window = [inside[u] if 0 <= u < n else missing for u in steps]
            verdicts = [each for each in window if isinstance(each, Verdict)]
            yes = solver.at_least(k, [each.yes for each in verdicts])
            found.append(Verdict(yes, solver.at_least(count - k + 1, [each.no for each in verdicts])))
        return found

    def sums(self, xs: Sequence[Value], a: int, b: int | None, factor: Fraction) -> list[Value]:
        """Return the sums over [t-b, t-a] times a factor."""
        numbers = [self.values.number(x) for x in xs]
        if not all(x.finite for x in numbers):
            raise NotLinear("it may add infinities")
        solver, n = self.values.solver, len(xs)
        width = n if b is None else min(b - a + 1, n)
        if width <= _FEW:
            found = [solver.total([x.real for x in numbers[max(0, t - width + 1) : t + 1]]) for t in range(n)]
        else:
            partial: list[Real] = [Fraction(0)]
            for x in numbers:
                partial.append(self._name_number(solver.total((partial[-1], x.real))))
            found = [
                solver.total((partial[t + 1], solver.times(Fraction(-1), partial[max(0, t + 1 - width)])))
                for t in range(n)
            ]
        nothing: list[Real] = [Fraction(0)] * min(a, n)
        reals = [*nothing, *found[: max(0, n - a)]]
        return [
            Number(each, cases=((each, True),) if isinstance(each, Fraction) else ())
            for each in (solver.times(factor, real) for real in reals)
        ]

    def _name_number(self, number: Real) -> Real:
        """Return a new number that is equal to one: a sum of sums would be written out."""
        if isinstance(number, Fraction):
            return number
        new = self.values.solver.real()
        self.values.solver.require(self.values.solver.equal(new, number))
        return new


def _windows(xs: Sequence[Value], join: Join, width: int | None) -> list[Value]:
    """Return the join of the last ``width`` values at each instant, None for all, in O(1) joins each.

    Of two neighbouring blocks of as many values, a window is the end of the first and the begin of the second.
    """
    n = len(xs)
    if width is None or width >= n:
        width = max(n, 1)
    begins: list[Value] = []
    for t, x in enumerate(xs):
        begins.append(join((begins[-1], x)) if t % width else x)
    ends: list[Value] = list(xs)
    for t in range(n - 2, -1, -1):
        if (t + 1) % width:
            ends[t] = join((xs[t], ends[t + 1]))
    found = []
    for t in range(n):
        start = t - width + 1
        found.append(begins[t] if start <= 0 or start % width == 0 else join((ends[start], begins[t])))
    return found
