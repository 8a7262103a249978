"""The values that a parameter takes, numbered from the easiest to the hardest to satisfy."""

from __future__ import annotations

from fractions import Fraction
from math import ceil, floor, log10
from typing import TYPE_CHECKING

from rtamt.lazy.dataclasses import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable


@dataclass(frozen=True, slots=True)
class Grid:
    """The ends of a range and the multiples of ``step`` between them; value 0 is ``easy``, value ``last`` is ``hard``.

    >>> grid = Grid("limit", Fraction(5, 2), Fraction(0), Fraction(1))
    >>> [grid.value(k) for k in range(grid.last + 1)]
    [2.5, 2.0, 1.0, 0.0]
    """

    name: str
    easy: Fraction
    hard: Fraction
    step: Fraction
    #: Whether there is no harder value than ``hard`` at all: the bound of an interval that cannot be shorter or longer.
    closed: bool = False

    @property
    def last(self) -> int:
        """The number of the hardest value."""
        if self.easy == self.hard:
            return 0
        first, end = self._multiples
        return max(0, (end - first) * self._sign + 1) + 1

    def value(self, k: int) -> float:
        """Return a value by its number."""
        if k <= 0:
            return float(self.easy)
        if k >= self.last:
            return float(self.hard)
        return float((self._multiples[0] + self._sign * (k - 1)) * self.step)

    @property
    def _sign(self) -> int:
        return 1 if self.hard > self.easy else -1

    @property
    def _multiples(self) -> tuple[int, int]:
        """The factors of the first and the last multiple between the ends, which do not count."""
        low, high = floor(self.easy / self.step), floor(self.hard / self.step)
        if self._sign > 0:
            return low + 1, ceil(self.hard / self.step) - 1
        return ceil(self.easy / self.step) - 1, high + 1


def hardest(holds: Callable[[int], bool], last: int) -> int:
    """Return the number of the hardest value that holds, where 0 holds and harder values hold less.

    >>> hardest(lambda k: k <= 7, 100)
    7
    """
    if last == 0 or holds(last):
        return last
    low, high = 0, last
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def digits(size: Fraction, significant: int) -> Fraction:
    """Return the power of ten of the last significant digit of a number, for a given number of digits.

    >>> digits(Fraction(4850), 5), digits(Fraction(1, 3), 2)
    (Fraction(1, 10), Fraction(1, 100))
    """
    exponent = floor(log10(abs(size))) - significant + 1
    return Fraction(10) ** exponent
