"""Physical units by pint, with exact factors: parse units, and compute products of units.

Angles are base units here, as in pint: radians have no dimension, but one rpm is 6 deg/s and no number of hertz.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from math import inf

from rtamt.errors import StlError
from rtamt.extras import library
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.patterns import lazy_pattern
from rtamt.lazy.typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Mapping

#: Products of powers of units: nothing that a library of units would have to compute for long.
_UNIT = lazy_pattern(r"(?:[^\W\d]|[°%µμΩ_])+")
_POWER = r"(?:(?:\^|\*\*)?-?\d|[⁻]?[⁰¹²³⁴-⁹])?"
_TEXT = lazy_pattern(
    rf"\(*(?:1|{_UNIT.pattern}){_POWER}\)*(?:\s*[*/·⋅ ]\s*\(*(?:1|{_UNIT.pattern}){_POWER}\)*)*"
)
#: The longest unit that is looked up.
_LONGEST = 60
#: Ways of writing that a number has no unit.
_NONE = ("-", "1", "[-]", "none")

#: A product of powers of units, each as it is written in a text.
Powers: TypeAlias = "tuple[tuple[str, Fraction], ...]"


class UnknownUnitError(StlError):
    """A text is no unit; ``unit``: the text."""

    def __init__(self, unit: str) -> None:
        super().__init__(f"pint does not know the unit '{unit}'; correct its spelling, such as km/h or m/s^2")
        self.unit = unit


@dataclass(frozen=True)
class Resolved:
    """A product of units in terms of base units: ``scale`` times them, where angles are left out.

    ``bases``: the exponents of the base units. ``angle``: that of radians. ``units``: the exponents of the units
    themselves, by their names. ``offset``: where zero lies, in base units; None of units that have no scale of their
    own, such as dB.
    """

    bases: frozenset[tuple[str, Fraction]]
    angle: Fraction
    scale: float
    offset: float | None
    units: Mapping[str, Fraction]


def same_text(first: str, second: str) -> bool:
    """Return whether two units are spelled the same, apart from spaces."""
    return "".join(first.split()) == "".join(second.split())


def is_none(unit: str) -> bool:
    """Return whether a text declares that a number has no unit."""
    return unit.strip().lower() in _NONE


@lru_cache(maxsize=1)
def registry() -> Any:
    """Return the units of pint, with exact factors."""
    units = library("pint", "converting units", "units").UnitRegistry(non_int_type=Fraction)
    units.define("@alias kilometer_per_hour = kmph")  # pint would read kmph as 1000 mph
    return units


@lru_cache(maxsize=512)
def parsed(unit: str) -> Any:
    """Return a unit of the library; None for a text that is no unit."""
    units = registry()
    text = "" if is_none(unit) else unit.strip()
    if len(text) > _LONGEST or (text and _TEXT.fullmatch(text) is None):
        return None
    try:
        unit = units.parse_units(text)
        units.get_root_units(unit)  # a product with decibels is parsed, but its unit is undefined
    except Exception:  # noqa: BLE001 - pint asserts, and raises errors of Python's tokenizer and of arithmetic
        return None
    return unit


def product(powers: Powers) -> Any:
    """Return a product of units; raise :class:`UnknownUnitError` for any other text."""
    found = registry().parse_units("")
    for text, exponent in powers:
        unit = parsed(text)
        if unit is None:
            raise UnknownUnitError(text)
        found = found * unit**exponent
    return found


@lru_cache(maxsize=512)
def resolved(powers: Powers) -> Resolved:
    """Return the value of a product of units; raise :class:`UnknownUnitError` for a text that is not a unit.

    >>> kmh = resolved((("km/h", Fraction(1)), ("rad", Fraction(1))))
    >>> sorted(kmh.bases), round(kmh.scale, 6)
    ([('meter', Fraction(1, 1)), ('second', Fraction(-1, 1))], 0.277778)
    """
    unit = product(powers)
    try:
        factor, root = registry().get_root_units(unit)
        scale = float(factor)
    except (OverflowError, TypeError):  # TypeError: the root of a negative constant is complex
        scale = inf
    if not 0 < scale < inf:
        raise UnknownUnitError("*".join(text for text, _ in powers))
    bases = _exponents(root)
    angle = bases.pop("radian", Fraction(0))
    zero = in_unit(Fraction(0), unit, root)
    offset = None if zero is None else float(zero)
    return Resolved(frozenset(bases.items()), angle, scale, offset, _exponents(unit))


def in_unit(value: Fraction, unit: Any, to: Any) -> Any:
    """Return a value in another unit of the library; None where that is undefined.

    That is so of different quantities, logarithms and, inside a product, of a temperature that is no difference.
    """
    units = registry()
    try:
        return units.Quantity(value, unit).to(to).magnitude
    except (library("pint", "converting units", "units").PintError, TypeError):
        return None


def unit_text(powers: Powers) -> str:
    """Return a product of units as it is written after a declaration.

    >>> unit_text((("m/s", Fraction(2)), ("s", Fraction(1))))
    'm^2/s'
    """
    if len(powers) == 1 and powers[0][1] == 1:
        return powers[0][0]
    return _format_product(_exponents(product(powers)))


def shortest_text(powers: Powers) -> str:
    """Return a product of units in base units if that is shorter and exact, else as :func:`unit_text` does.

    >>> shortest_text((("J", Fraction(1)), ("s", Fraction(2)), ("N*m", Fraction(-1))))
    's^2'
    """
    unit, known = product(powers), resolved(powers)
    bases = dict(known.bases) | ({"radian": known.angle} if known.angle else {})
    return (
        _format_product(bases)
        if known.scale == 1 and len(bases) < len(_exponents(unit))
        else unit_text(powers)
    )


def _format_product(exponents: Mapping[str, Fraction]) -> str:
    """Return a product of units of the library in symbols."""
    above, below = (
        [
            registry().get_symbol(name) + (f"^{abs(exponent)}" if abs(exponent) != 1 else "")
            for name, exponent in exponents.items()
            if exponent * sign > 0
        ]
        for sign in (1, -1)
    )
    return "/".join(["*".join(above) or "1", *below])


def _exponents(unit: Any) -> dict[str, Fraction]:
    return {name: Fraction(exponent) for name, exponent in unit._units.items()}
