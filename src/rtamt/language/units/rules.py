"""Rules for the unit of a result, from those of its operands: the column ``units`` of the operator table.

A rule takes the measures of the operands and returns that of the result, or raises :class:`MisfitError`.
"""

from __future__ import annotations

from fractions import Fraction
from math import isclose, isfinite, pi

from rtamt.language.units.dimensions import (
    DIMENSION,
    PLAIN,
    ROUNDED,
    SCALE,
    UNCHECKED,
    MisfitError,
    Number,
    Quantity,
    agree,
    declared,
    joined,
    power,
    resolve,
    times,
)
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rtamt.language.units.dimensions import Measure

    #: From the measures of the operands to that of the result.
    UnitRule: TypeAlias = Callable[[Sequence[Measure]], Measure]

_DEG, _RAD, _SECOND = declared("deg"), declared("rad"), declared("s")


def sums(measures: Sequence[Measure]) -> Measure:
    """Return the unit of a sum or difference: 5 K may be added to a temperature in degC."""
    joint = agree(measures, zeros=False)
    return replace(joint, difference=True) if isinstance(joint, Quantity) else joint


def compared(measures: Sequence[Measure]) -> Measure:
    """Check the operands of a comparison, which itself has no unit."""
    agree(measures)
    return None


def kept(measures: Sequence[Measure]) -> Measure:
    """Return the unit of the operand."""
    return measures[0]


def differs(measures: Sequence[Measure]) -> Measure:
    """Return the unit of the change of the operand."""
    return sums(measures[:1])


def product_of(measures: Sequence[Measure]) -> Measure:
    """Return the unit of a product."""
    return times(*measures)


def quotient(measures: Sequence[Measure]) -> Measure:
    """Return the unit of a quotient."""
    above, below = measures
    if isinstance(below, Number):
        return times(above, Number(1 / below.value if below.value else None))
    return times(above, power(below, Fraction(-1)))


def root(measures: Sequence[Measure]) -> Measure:
    """Return the unit of a square root."""
    return power(measures[0], Fraction(1, 2))


def to_the_power(measures: Sequence[Measure]) -> Measure:
    """Return the unit of ``pow``: known where the exponent is a number of the text."""
    base, exponent = measures
    _expect(PLAIN, "a number without unit as its exponent", measures, 1)
    if isinstance(exponent, Number) and exponent.value is not None and isfinite(exponent.value):
        return power(base, Fraction(exponent.value))
    return base if isinstance(base, Quantity) and not base.powers else None


def per_second(measures: Sequence[Measure]) -> Measure:
    """Return the unit of a rate."""
    return times(measures[0], power(_SECOND, Fraction(-1)))


def by_seconds(measures: Sequence[Measure]) -> Measure:
    """Return the unit of an integral."""
    return times(measures[0], _SECOND)


def seconds(_measures: Sequence[Measure]) -> Measure:
    """Return the unit of a duration."""
    return _SECOND


def plain(_measures: Sequence[Measure]) -> Measure:
    """Return the unit of a count."""
    return PLAIN


def _expect(expected: Quantity, called: str, measures: Sequence[Measure], *which: int) -> None:
    """Raise :class:`MisfitError` for an operand in another unit than the expected one."""
    for k in which or range(len(measures)):
        measure = measures[k]
        if not isinstance(measure, Quantity):
            continue
        try:
            joined(k, measure, k, expected, zeros=True)
        except MisfitError as error:
            if error.kind == UNCHECKED:
                raise
            fix = "correct the declaration of its unit, or divide it by a constant of the same unit"
            if expected is _RAD and resolve(measure)[0].units.get("degree") == 1:
                fix = f"write radians({{{k}}})"
            elif error.kind == SCALE:
                fix = f"divide it by {1 / resolve(measure)[0].scale:.6g}"
            operand = f"'{{{k}}}' {measure}"
            raise MisfitError(f"{operand}, and this takes {called}; {fix}", error.kind, k) from None


def of_ratio(measures: Sequence[Measure]) -> Measure:
    """Return the unit of a function of plain numbers, such as ``exp``."""
    _expect(PLAIN, "a number without unit", measures)
    return _result(PLAIN, measures)


def of_angle(measures: Sequence[Measure]) -> Measure:
    """Return the unit of a function of angles, such as ``sin``."""
    _expect(_RAD, "an angle in radians", measures)
    return _result(PLAIN, measures)


def to_angle(measures: Sequence[Measure]) -> Measure:
    """Return the unit of a function to angles, such as ``asin``."""
    _expect(PLAIN, "a number without unit", measures)
    return _result(_RAD, measures)


def direction(measures: Sequence[Measure]) -> Measure:
    """Return the unit of ``atan2``."""
    agree(measures)
    return _result(_RAD, measures)


def signs(measures: Sequence[Measure]) -> Measure:
    """Return the unit of ``sign``."""
    return _result(PLAIN, measures)


def _result(unit: Quantity, measures: Sequence[Measure]) -> Measure:
    if any(each is None for each in measures):
        return None
    return unit if any(isinstance(each, Quantity) for each in measures) else Number(None)


def to_degrees(measures: Sequence[Measure]) -> Measure:
    """Return the unit of ``degrees``."""
    return _convert_angle(measures[0], "degree", "in degrees already", _DEG, _RAD)


def to_radians(measures: Sequence[Measure]) -> Measure:
    """Return the unit of ``radians``."""
    return _convert_angle(measures[0], "radian", "in radians already", _RAD, _DEG)


def _convert_angle(measure: Measure, wrong: str, why: str, to: Quantity, from_: Quantity) -> Measure:
    """Return an angle, or a rate of one, in the other unit of angles."""
    if not isinstance(measure, Quantity):
        return measure
    (known,) = resolve(measure)
    operand = f"'{{0}}' {measure}"
    if wrong in known.units:
        raise MisfitError(f"{operand}, which is {why}; leave out the conversion", SCALE, 0)
    if any(name != "second" for name, _ in known.bases):
        raise MisfitError(f"{operand}, which is no angle; correct the declaration of its unit", DIMENSION, 0)
    return times(measure, times(to, power(from_, Fraction(-1))))


def wrapped(measures: Sequence[Measure]) -> Measure:
    """Return the unit of ``wrap``: a full turn is 360 in degrees and 2 pi in radians."""
    measure, low, high = measures
    if (
        isinstance(low, Number)
        and isinstance(high, Number)
        and low.value is not None
        and high.value is not None
    ):
        _check_turn(measure, high.value - low.value)
    return agree(measures)


def remainder(measures: Sequence[Measure]) -> Measure:
    """Return the unit of ``mod``."""
    measure, divisor = measures
    if isinstance(divisor, Number) and divisor.value is not None:
        _check_turn(measure, divisor.value)
    return agree(measures)


def _check_turn(measure: Measure, turn: float) -> None:
    for unit, other, name in ((_RAD, 360.0, "degrees"), (_DEG, 2 * pi, "radians")):
        if not isinstance(measure, Quantity) or not isclose(turn, other, rel_tol=ROUNDED):
            continue
        known, own = resolve(measure, unit)
        if known.units == own.units and measure.factors == (1.0,):
            operand, write = f"'{{0}}' {measure}", f"{name}({{0}})"
            raise MisfitError(
                f"{operand}, and {turn:.6g} is a full turn in {name}; write {write}, "
                f"or a full turn in {unit.powers[0][0]}",
                SCALE,
                0,
            )
