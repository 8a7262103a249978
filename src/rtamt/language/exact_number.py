"""Numbers that bound intervals: doubles with the exact value that they were given as."""

from __future__ import annotations

from fractions import Fraction

from rtamt.language.units.durations import exact
from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable


class ExactNumber(float):
    """A double that knows the number it was rounded from.

    >>> third = ExactNumber(Fraction(1, 3))
    >>> third, third.exact, third == 1 / 3
    (0.3333333333333333, Fraction(1, 3), True)
    """

    __slots__ = ("exact",)

    exact: Fraction

    def __new__(cls, value: Fraction) -> ExactNumber:
        """Return the double nearest to a number."""
        made = super().__new__(cls, value)
        made.exact = value
        return made

    def __reduce__(self) -> tuple[Callable[..., ExactNumber], tuple[Any, ...]]:
        return ExactNumber, (self.exact,)


def exact_value(number: float | Fraction) -> Fraction:
    """Return the exact value of a finite number; that of a double is the decimal with which it is written.

    >>> exact_value(0.1), exact_value(Fraction(1, 3))
    (Fraction(1, 10), Fraction(1, 3))
    """
    if isinstance(number, ExactNumber):
        return number.exact
    return number if isinstance(number, Fraction) else exact(str(float(number)))


def as_double(number: Any) -> float:
    """Return a number as a double, with its exact value if that is another one.

    >>> type(as_double(Fraction(1, 2))) is type(as_double(3)) is float
    True
    """
    if isinstance(number, ExactNumber):
        return number
    double = float(number)
    if isinstance(number, Fraction) and exact_value(double) != number:
        return ExactNumber(number)
    return double


def is_same(a: float, b: float) -> bool:
    """Return whether two numbers from :func:`as_double` are equal, also exactly.

    >>> is_same(1 / 3, as_double(Fraction(1, 3))), is_same(0.1, as_double(Fraction(1, 10)))
    (False, True)
    """
    return a == b and getattr(a, "exact", None) == getattr(b, "exact", None)
