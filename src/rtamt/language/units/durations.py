"""Durations with units to exact seconds, and back to text.

====  ==================
unit  seconds
====  ==================
h     3600
min   60
s     1
ms    1/1 000
us    1/1 000 000
ns    1/1 000 000 000
====  ==================
"""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from math import isfinite
from numbers import Rational, Real
from types import MappingProxyType

from rtamt.errors import UsageError, choices, shown
from rtamt.lazy.modules import np
from rtamt.lazy.patterns import lazy_pattern
from rtamt.lazy.typing import TYPE_CHECKING, SupportsFloat, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

#: Seconds, or text with a unit, such as ``"100ms"``.
Duration: TypeAlias = str | float | Fraction


#: Seconds in each unit, the largest first.
UNITS: Mapping[str, Fraction] = MappingProxyType(
    {
        "h": Fraction(3600),
        "min": Fraction(60),
        "s": Fraction(1),
        "ms": Fraction(1, 10**3),
        "us": Fraction(1, 10**6),
        "ns": Fraction(1, 10**9),
    }
)

#: One tick of dense time, unless the caller chooses another.
NANOSECOND = UNITS["ns"]

#: Durations with more digits than this are shortened in messages.
_LONGEST = 40

_DURATION = lazy_pattern(r"\s*([^\s/A-Za-z]+(?:[eE][+-]?\d+)?)\s*(?:/\s*(\d+)\s*)?([A-Za-z]*)\s*")


#: A number in formulas and durations: decimal, ASCII digits, with single underscores between them, as in Python.
_DIGITS = r"[0-9]+(?:_[0-9]+)*"
NUMBER = rf"(?:{_DIGITS}(?:\.(?:{_DIGITS})?)?|\.{_DIGITS})(?:[eE][+-]?{_DIGITS})?"
#: Of a number: Python converts no more than 4 300 digits by default.
_MOST_CHARACTERS = 4000

_DECIMAL = lazy_pattern(f"[+-]?{NUMBER}")


@lru_cache(maxsize=1024)
def why_not_exact(literal: str) -> str:
    """Return why :func:`exact` rejects a number: the end of a sentence about it."""
    if len(literal) > _MOST_CHARACTERS:
        return f"has more than {_MOST_CHARACTERS:,} characters"
    return "is beyond the range of a double"


def exact(literal: str) -> Fraction:
    """Return the exact value of a decimal literal.

    Raises :class:`ValueError` if it is not a number, or one that :func:`why_not_exact` rejects.

    >>> exact("0.1"), exact("1e-3")
    (Fraction(1, 10), Fraction(1, 1000))
    """
    whole = literal.isascii() and literal.isdigit()  # most are, and need no regular expression
    if not whole and _DECIMAL.fullmatch(literal) is None:
        raise ValueError(f"{literal} is no decimal number")
    if len(literal) > _MOST_CHARACTERS:
        raise ValueError(f"{literal} {why_not_exact(literal)}")
    # Check the range as a double first: 1e-999999999, or 0e-999999999, would need a gigabyte as a fraction.
    nearest = float(literal)
    if nearest == 0 and not literal.lower().partition("e")[0].strip("+-0._"):
        return Fraction(0)
    if nearest == 0 or not isfinite(nearest):
        raise ValueError(f"{literal} {why_not_exact(literal)}")
    return Fraction(literal.replace("_", ""))


def is_less(one: Fraction, other: Fraction) -> bool:
    """Return whether one fraction is less than another, in a third of the time of ``<``."""
    return one.numerator * other.denominator < other.numerator * one.denominator


def check_unit(unit: str) -> str:
    """Return ``unit`` if it is a known unit; otherwise raise :class:`UsageError`.

    >>> check_unit("ms")
    'ms'
    """
    if unit not in tuple(UNITS):  # also what has no hash
        raise UsageError(f"{shown(unit)} is not a unit of time{choices(unit, UNITS, 'units')}")
    return unit


#: Durations up to here, and from one over it, are doubles too.
_EXTREME = Fraction(10) ** 290
#: Fractions of such numbers are durations at once: a trace computes its time domain often.
_PLAIN = 2**63


def duration(value: str | SupportsFloat, unit: str = "s") -> Fraction:
    """Return a duration in seconds, exact.

    ``value``: text with or without a unit (``"100ms"``, ``"0.1 s"``, ``"1/3s"``) or a number; a float
    means the shortest decimal that prints it, so 0.1 is one tenth. ``unit``: the unit if the value
    has none. Raises :class:`UsageError` if it is not a duration, negative, or infinite.

    >>> duration("100ms"), duration(0.1), duration(5, "us")
    (Fraction(1, 10), Fraction(1, 10), Fraction(1, 200000))
    """
    if value.__class__ is Fraction and unit == "s" and 0 < value.numerator < _PLAIN > value.denominator:
        return value
    check_unit(unit)
    try:
        if isinstance(value, str):
            match = _DURATION.fullmatch(value)
            if match is None:
                raise ValueError(value)
            number = exact(match[1]) / exact(match[2] or "1")
            unit = check_unit(match[3] or unit)
        elif isinstance(value, bool):
            raise TypeError(value)
        elif isinstance(value, Rational):
            number = Fraction(int(value.numerator), int(value.denominator))
        elif isinstance(value, Real):
            # str and not repr: the repr of a numpy scalar contains its type.
            number = exact(str(value))
        else:
            raise TypeError(value)
    except (ValueError, TypeError, ZeroDivisionError):
        raise UsageError(
            f"{shown(value)} is not a duration; write for example '100ms', '1/3s' or 5"
        ) from None
    if number < 0:
        raise UsageError(f"a duration may not be negative, got {shown(value)}")
    if number > _EXTREME or 0 < number < 1 / _EXTREME:
        raise UsageError(
            f"the duration {shown(value)} is beyond what can be counted in seconds; check its unit"
        )
    return number * UNITS[unit]


def positive_period(period: Duration, what: str = "sampling period") -> Fraction:
    """Return a sampling period (or ``what``) in exact seconds; raise :class:`UsageError` for 0."""
    exact_period = duration(period)
    if exact_period <= 0:
        raise UsageError(f"the {what} is {shown(period)}; it must be positive")
    return exact_period


def in_seconds(numbers: NDArray[np.float64], unit: Fraction) -> NDArray[np.float64]:
    """Return doubles in seconds, each rounded once: by a whole number, where a product with 0.001 would round twice."""
    with np.errstate(over="ignore"):  # the caller rejects infinite times
        return numbers * float(unit) if unit >= 1 else numbers / float(1 / unit)


def decimal(number: Fraction) -> str | None:
    """Return the exact decimal text of a number, or None if it has no finite one.

    >>> decimal(Fraction(5, 2)), decimal(Fraction(4)), decimal(Fraction(1, 3))
    ('2.5', '4', None)
    """
    rest, twos, fives = number.denominator, 0, 0
    while rest % 2 == 0:
        rest, twos = rest // 2, twos + 1
    while rest % 5 == 0:
        rest, fives = rest // 5, fives + 1
    if rest != 1:
        return None
    places = max(twos, fives)
    if places == 0:
        return str(number.numerator)
    digits = str(abs(number.numerator) * 10**places // number.denominator).rjust(places + 1, "0")
    return f"{'-' if number < 0 else ''}{digits[:-places]}.{digits[-places:]}"


def format_duration(seconds: Fraction) -> str:
    """Return a readable duration: in seconds, or in the largest smaller unit of which it is at least one.

    >>> format_duration(Fraction(1, 10)), format_duration(Fraction(5)), format_duration(Fraction(1, 3))
    ('100 ms', '5 s', '1/3 s')
    >>> format_duration(Fraction(1, 2 * 10**9))
    '0.5 ns'
    """
    if seconds != 0 and decimal(seconds) is not None:
        unit, size = next(
            ((u, size) for u, size in UNITS.items() if size <= min(UNITS["s"], abs(seconds))),
            ("ns", UNITS["ns"]),
        )
        return f"{_short(seconds / size)} {unit}"
    return f"{decimal(seconds) or seconds} s"


def _short(number: Fraction) -> str:
    """Return a decimal as it is, or rounded to six digits if it has too many."""
    text = str(decimal(number))
    return text if len(text) <= _LONGEST else f"{Decimal(number.numerator) / Decimal(number.denominator):.6g}"
