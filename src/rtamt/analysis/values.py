"""The values of formulas as terms of a solver: extended real numbers, and their lattice.

A value is a :class:`Number`, or a :class:`Verdict`, which is +inf where something holds and -inf where it does not: a
minimum of verdicts is a conjunction, and no number is compared.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, TypeAlias

from rtamt.lazy.dataclasses import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rtamt.analysis.solver import Real, Solver, Truth

#: The most values that a number has if products with it are written as cases.
_MOST_CASES = 12


@dataclass(frozen=True, slots=True)
class Verdict:
    """+inf where ``yes``, -inf where ``no``.

    The two exclude each other. With a margin neither may be true: ``yes`` is then that the robustness is at least the
    margin, and ``no`` that it is at most minus the margin.
    """

    yes: Truth
    no: Truth


@dataclass(frozen=True, slots=True)
class Number:
    """A number: +inf where ``high``, -inf where ``low``, else ``real``.

    ``cases``: if it has few values, each of them and where it has it; the conditions exclude each other, and one of
    them is true.
    """

    real: Real
    high: Truth = False
    low: Truth = False
    cases: tuple[tuple[Fraction, Truth], ...] = ()

    @property
    def finite(self) -> bool:
        """Whether it is never infinite."""
        return self.high is False and self.low is False


Value: TypeAlias = "Verdict | Number"


class NotLinear(Exception):  # noqa: N818 - no error: the encoder reports what is not covered
    """An operation is not covered; the argument completes ``'x * y' is not covered by the analysis:``."""


class Values:
    """Operations on values, over the terms of a solver.

    ``defined``: what must be true of a trace where a formula has a value, collected while values are built.
    """

    def __init__(self, solver: Solver) -> None:
        self.solver = solver
        self.defined: list[Truth] = []

    def constant(self, number: float) -> Value:
        """Return a constant."""
        if number in (float("inf"), float("-inf")):
            return Verdict(number > 0, number < 0)
        exact = Fraction(number)
        return Number(exact, cases=((exact, True),))

    def verdict(self, truth: Truth) -> Verdict:
        """Return the verdict that is +inf where a truth value is true."""
        return Verdict(truth, self.solver.no(truth))

    def of_cases(self, cases: Sequence[tuple[Fraction, Truth]]) -> Number:
        """Return the number with these values."""
        joined: dict[Fraction, list[Truth]] = {}
        for value, where in cases:
            if where is not False:
                joined.setdefault(value, []).append(where)
        kept = [(value, self.solver.some(where)) for value, where in joined.items()]
        (real, _), *others = reversed(kept)
        found: Real = real
        for value, where in others:
            found = self.solver.choose(where, value, found)
        return Number(found, cases=tuple(kept) if len(kept) <= _MOST_CASES else ())

    # ---- lattice ---------------------------------------------------------------------------------

    def number(self, value: Value) -> Number:
        """Return a value as a number, +inf and -inf where it is a verdict."""
        return value if isinstance(value, Number) else Number(Fraction(0), value.yes, value.no)

    def minus(self, value: Value) -> Value:
        """Return the negation."""
        if isinstance(value, Verdict):
            return Verdict(value.no, value.yes)
        cases = tuple((-each, where) for each, where in value.cases)
        return Number(self.solver.times(Fraction(-1), value.real), value.low, value.high, cases)

    def least(self, parts: Sequence[Value]) -> Value:
        """Return the minimum; of nothing +inf."""
        verdicts = [part for part in parts if isinstance(part, Verdict)]
        numbers = [part for part in parts if isinstance(part, Number)]
        every, some = self.solver.every, self.solver.some
        verdict = Verdict(every([part.yes for part in verdicts]), some([part.no for part in verdicts]))
        if not numbers or verdict.no is True:
            return verdict
        found, *others = numbers if verdict.yes is True else [self.number(verdict), *numbers]
        for other in others:
            found = self._lesser(found, other)
        return found

    def greatest(self, parts: Sequence[Value]) -> Value:
        """Return the maximum; of nothing -inf."""
        if all(isinstance(part, Verdict) for part in parts):
            verdicts = [part for part in parts if isinstance(part, Verdict)]
            every, some = self.solver.every, self.solver.some
            return Verdict(some([part.yes for part in verdicts]), every([part.no for part in verdicts]))
        return self.minus(self.least([self.minus(part) for part in parts]))

    def _lesser(self, a: Number, b: Number) -> Number:
        solver = self.solver
        smaller = solver.choose(solver.at_most(a.real, b.real), a.real, b.real)
        real = solver.choose(a.high, b.real, solver.choose(b.high, a.real, smaller))
        return Number(real, solver.every((a.high, b.high)), solver.some((a.low, b.low)))

    def choose(self, condition: Truth, a: Value, b: Value) -> Value:
        """Return a where the condition is true, else b."""
        if isinstance(condition, bool):
            return a if condition else b
        solver, no = self.solver, self.solver.no(condition)

        def either(x: Truth, y: Truth) -> Truth:
            if x is y:
                return x
            return solver.some((solver.every((condition, x)), solver.every((no, y))))

        if isinstance(a, Verdict) and isinstance(b, Verdict):
            return Verdict(either(a.yes, b.yes), either(a.no, b.no))
        a, b = self.number(a), self.number(b)
        if a.cases and b.cases:
            first = [(value, solver.every((condition, where))) for value, where in a.cases]
            return self.of_cases([*first, *((value, solver.every((no, where))) for value, where in b.cases)])
        real = solver.choose(condition, a.real, b.real)
        return Number(real, either(a.high, b.high), either(a.low, b.low))

    # ---- comparisons -----------------------------------------------------------------------------

    def exceeds(self, a: Value, b: Value) -> Truth:
        """Return whether a > b."""
        return self.solver.no(self.reaches(b, a))

    def reaches(self, a: Value, b: Value) -> Truth:
        """Return whether a >= b."""
        a, b, solver = self.number(a), self.number(b), self.solver
        if a.cases and b.cases and len(a.cases) * len(b.cases) <= _MOST_CASES * 4:
            return solver.some(solver.every((x, y)) for v, x in a.cases for w, y in b.cases if v >= w)
        finite = solver.every((solver.no(a.low), solver.no(b.high), solver.at_most(b.real, a.real)))
        return solver.some((a.high, b.low, finite))

    def equals(self, a: Value, b: Value) -> Truth:
        """Return whether a = b."""
        a, b, solver = self.number(a), self.number(b), self.solver
        if a.cases and b.cases:
            return solver.some(solver.every((x, y)) for v, x in a.cases for w, y in b.cases if v == w)
        return solver.every((self.reaches(a, b), self.reaches(b, a)))

    # ---- arithmetic ------------------------------------------------------------------------------

    def plus(self, a: Value, b: Value) -> Value:
        """Return the sum."""
        a, b = self.number(a), self.number(b)
        if (a.high is not False and b.low is not False) or (a.low is not False and b.high is not False):
            raise NotLinear("it may be inf - inf")
        if a.cases and b.cases and len(a.cases) * len(b.cases) <= _MOST_CASES:
            every = self.solver.every
            return self.of_cases([(v + w, every((x, y))) for v, x in a.cases for w, y in b.cases])
        some = self.solver.some
        return Number(self.solver.total((a.real, b.real)), some((a.high, b.high)), some((a.low, b.low)))

    def times(self, a: Value, b: Value) -> Value:
        """Return the product, of which one factor has few values."""
        a, b = self.number(a), self.number(b)
        if not a.cases or (b.cases and len(b.cases) < len(a.cases)):
            a, b = b, a
        if not a.cases:
            raise NotLinear("a product of two signals is nonlinear")
        if not b.finite:
            raise NotLinear("a factor may be infinite")
        return self._by_cases(a, lambda factor: self._scale(factor, b))

    def over(self, a: Value, b: Value) -> Value:
        """Return the quotient, of which the divisor has few values and is never zero."""
        a, b = self.number(a), self.number(b)
        if not b.cases:
            raise NotLinear("a division by a signal is nonlinear")
        if not a.finite or any(value == 0 for value, _ in b.cases):
            raise NotLinear("it may divide by zero, or infinity")
        return self._by_cases(b, lambda divisor: self._scale(1 / divisor, a))

    def _scale(self, factor: Fraction, a: Number) -> Number:
        if a.cases:
            return self.of_cases([(factor * value, where) for value, where in a.cases])
        return Number(self.solver.times(factor, a.real))

    def _by_cases(self, of: Number, then: Callable[[Fraction], Number]) -> Value:
        (value, _), *others = of.cases
        found: Value = then(value)
        for other, where in others:
            found = self.choose(where, then(other), found)
        return found

    def floor(self, a: Value) -> Number:
        """Return the greatest whole number that is not above a."""
        a = self._finite(a)
        if a.cases:
            return self.of_cases([(Fraction(value.__floor__()), where) for value, where in a.cases])
        return Number(self.solver.floor(a.real))

    def _finite(self, a: Value) -> Number:
        a = self.number(a)
        if not a.finite:
            raise NotLinear("its operand may be infinite")
        return a
