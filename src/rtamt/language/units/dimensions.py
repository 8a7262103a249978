"""The units of numbers, and whether they fit together.

=============  ===================================================================================
measure        what it is
=============  ===================================================================================
``None``       unknown: a signal or constant without a declared unit; fits everything
``Number``     a number in the text: in a sum or comparison it has the unit of its partner, in a
               product none, or it converts one unit into another, such as 3.6 in ``speed * 3.6``
``Quantity``   a product of powers of units
=============  ===================================================================================

How the unit of a result follows from those of the operands is in ``rules.py``. Radians may be left out: the
product of a radius in m and a rate in rad/s is a speed in m/s.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations, product
from math import inf, isclose, pi

from rtamt.errors import UsageError
from rtamt.extras import library
from rtamt.language.units.pint_units import UnknownUnitError, is_none, resolved, shortest_text, unit_text
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.language.units.pint_units import Powers, Resolved

#: Kinds of findings.
DIMENSION, SCALE, UNCHECKED = "dimension", "scale", "unchecked"

#: Numbers in products that may be conversions, at most; from there on any factor may have been one.
_MOST = 8
#: Units in a product, and their exponents, at most; what is beyond is unknown.
_MOST_UNITS, _GREATEST_EXPONENT = 20, 12
#: How exactly a number in a text is a conversion, such as 0.01745 from degrees to radians.
ROUNDED = 1e-3
#: Factors of units are exact but for that of angles.
_EXACT = 1e-9

_RAD_IN_DEG = 180 / pi


class MisfitError(Exception):
    """A finding of ``rtamt lint`` about units: RT301, RT302 and RT303.

    ``kind``: of the finding. ``operand``: whose fault it is, None for all. ``{0}``, ``{1}``, … in the message stand for
    the operands of these numbers.
    """

    def __init__(self, message: str, kind: str, operand: int | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.kind = kind
        self.operand = operand


class Number(NamedTuple):
    """A number in the text; None where its value is not computed."""

    value: float | None


@dataclass(frozen=True)
class Quantity:
    """A number in a unit.

    ``factors``: the numbers it may have been converted with, None for any: ``speed * 3.6`` is 3.6 times a speed in m/s,
    or a speed in km/h. ``difference``: zero means no difference, whatever the zero of the unit, such as that of degC.
    """

    powers: Powers
    factors: tuple[float, ...] | None = (1.0,)
    difference: bool = False

    def __str__(self) -> str:
        return f"is in {unit_text(self.powers)}" if self.powers else "has no unit"


Measure: TypeAlias = "Number | Quantity | None"

PLAIN = Quantity(())


def declared(unit: str) -> Quantity:
    """Return the measure of a value declared in a unit."""
    return PLAIN if is_none(unit) else Quantity(((" ".join(unit.split()), Fraction(1)),))


# ---- fitting -------------------------------------------------------------------------------------


def resolve(*quantities: Quantity) -> list[Resolved]:
    """Return the dimension of units; raise :class:`MisfitError` if it is unknown."""
    try:
        library("pint", "comparing units", "units")
        return [resolved(each.powers) for each in quantities]
    except (UsageError, UnknownUnitError) as error:
        raise MisfitError(f"the units are not checked here: {error}", UNCHECKED) from None


def _scales(quantity: Quantity, known: Resolved) -> list[tuple[float, float]] | None:
    """Return each factor and the scale of the unit if it was a conversion; None where there may have been any."""
    if quantity.factors is None:
        return None
    return [(factor, known.scale / factor) for factor in quantity.factors]


def _same_scale(first: tuple[float, float], second: tuple[float, float]) -> bool:
    converted = first[0] != 1 or second[0] != 1
    return isclose(first[1], second[1], rel_tol=ROUNDED if converted else _EXACT)


def joined(a: int, first: Quantity, b: int, second: Quantity, *, zeros: bool) -> Quantity:
    """Return what is common to both; raise :class:`MisfitError` if they do not fit. ``zeros``: they must agree, too."""
    difference = first.difference or second.difference
    if (
        first.powers == second.powers
        and 1.0 in (first.factors or (1.0,))
        and 1.0 in (second.factors or (1.0,))
    ):
        shared = first.factors if second.factors is None else second.factors
        if first.factors is not None and shared is not None:
            shared = tuple(each for each in shared if each in first.factors)
        return Quantity(first.powers, shared, difference)
    one, other = resolve(first, second)
    if one.bases != other.bases:
        raise _different(a, first, b, second)
    one, other = _in_radians(one, other), _in_radians(other, one)
    ones, others = _scales(first, one), _scales(second, other)
    if zeros and not difference and one.offset != other.offset and None not in (one.offset, other.offset):
        mine, its = f"'{{{a}}}' {first}", f"'{{{b}}}' {second}"
        raise MisfitError(
            f"{mine} and {its}, which count from different zeros; declare both in one unit", SCALE
        )
    if ones is None or others is None:
        return Quantity(first.powers, None, difference)
    fitting = [pair[0] for pair in ones if any(_same_scale(pair, each) for each in others)]
    if fitting:
        return Quantity(first.powers, tuple(fitting), difference)
    raise _scale(a, first, b, second, one, other)


def _in_radians(cycles: Resolved, other: Resolved) -> Resolved:
    """Return a frequency as an angular one, of 2 pi radians a cycle, beside a unit with an angle."""
    count = cycles.units.get("hertz")
    if not count or cycles.angle or not other.angle:
        return cycles
    return replace(cycles, scale=cycles.scale * (2 * pi) ** float(count), angle=other.angle)


def _different(a: int, first: Quantity, b: int, second: Quantity) -> MisfitError:
    ratios = [(a, times(second, power(first, Fraction(-1)))), (b, times(first, power(second, Fraction(-1))))]
    texts = [(k, shortest_text(ratio.powers)) for k, ratio in ratios if isinstance(ratio, Quantity)]
    texts.sort(key=lambda each: each[1].startswith("1/"))
    more = "".join(f", or multiply '{{{k}}}' by a constant in {text}" for k, text in texts[:1])
    one, other = f"'{{{a}}}' {first}", f"'{{{b}}}' {second}"
    return MisfitError(
        f"{one} and {other}, which are different quantities; correct a declaration{more}", DIMENSION
    )


def _scale(a: int, first: Quantity, b: int, second: Quantity, one: Resolved, other: Resolved) -> MisfitError:
    factor = one.scale / other.scale
    if isclose(factor, 1 / _RAD_IN_DEG, rel_tol=_EXACT):
        how = f", or write radians({{{a}}})"
    elif isclose(factor, _RAD_IN_DEG, rel_tol=_EXACT):
        how = f", or write radians({{{b}}})"
    elif one.angle != other.angle:
        how = ""
    elif len(f"{1 / factor:.6g}") < len(f"{factor:.6g}"):
        how = f", or divide '{{{a}}}' by {1 / factor:.6g}"
    else:
        how = f", or multiply '{{{a}}}' by {factor:.6g}"
    mine, its = f"'{{{a}}}' {first}", f"'{{{b}}}' {second}"
    return MisfitError(f"{mine} and {its}, two units of one quantity; declare both in one unit{how}", SCALE)


def agree(measures: Sequence[Measure], which: Sequence[int] | None = None, *, zeros: bool = True) -> Measure:
    """Return the measure that operands share (``which``: by default all of them): unknown if one is."""
    known = [(k, measures[k]) for k in which or range(len(measures)) if k < len(measures)]
    quantities = [(k, each) for k, each in known if isinstance(each, Quantity)]
    for (a, first), (b, second) in combinations(quantities, 2):
        joined(a, first, b, second, zeros=zeros)
    if any(each is None for _, each in known):
        return None
    if not quantities:
        return Number(None)
    (a, joint), *others = quantities
    for b, each in others:
        joint = joined(a, joint, b, each, zeros=zeros)
    return joint


# ---- products ------------------------------------------------------------------------------------


def times(first: Measure, second: Measure) -> Measure:
    """Return the measure of a product.

    >>> speed, time = declared("m/s"), declared("s")
    >>> str(times(times(speed, time), Number(3.6))), times(speed, None)
    ('is in m', None)
    """
    if first is None or second is None:
        return None
    if isinstance(first, Number):
        first, second = second, first
    if isinstance(first, Number):
        return Number(None)
    if isinstance(second, Number):
        powers = first.powers
        new: tuple[float, ...] | None = (
            None if second.value is None else tuple({1.0, abs(second.value) or 1.0})
        )
    else:
        exponents = dict(first.powers)
        for text, exponent in second.powers:
            exponents[text] = exponents.get(text, Fraction(0)) + exponent
        powers = tuple(sorted((text, exponent) for text, exponent in exponents.items() if exponent))
        if _is_beyond(powers):
            return None
        new = second.factors
    if first.factors is None or new is None:
        return Quantity(powers, None, difference=True)
    return Quantity(powers, _keep_nonzero({a * b for a, b in product(first.factors, new)}), difference=True)


def power(measure: Measure, exponent: Fraction) -> Measure:
    """Return the measure of a power."""
    if not isinstance(measure, Quantity):
        return measure if measure is None else Number(None)
    powers = tuple((text, each * exponent) for text, each in measure.powers) if exponent else ()
    if _is_beyond(powers):
        return None
    try:
        factors = {each ** float(exponent) for each in measure.factors or (inf,)}
    except OverflowError:
        factors = {inf}
    return Quantity(powers, _keep_nonzero(factors), difference=True)


def _keep_nonzero(factors: set[float]) -> tuple[float, ...] | None:
    usable = len(factors) <= _MOST and all(0 < factor < inf for factor in factors)
    return tuple(sorted(factors)) if usable else None


def _is_beyond(powers: Powers) -> bool:
    return len(powers) > _MOST_UNITS or any(
        abs(exponent) > _GREATEST_EXPONENT or exponent.denominator > _GREATEST_EXPONENT
        for _, exponent in powers
    )
