"""Conversion from the unit of a recording to the declared one, with exact factors and offsets of pint.

Two units can be converted if they are the same product of base units. Angles are base units here: 1 rpm is 6 deg/s, but
not a number of hertz, although radians have no dimension.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from math import lcm

from rtamt.errors import TraceError
from rtamt.extras import library
from rtamt.language.units.pint_units import in_unit, parsed, registry, same_text
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rtamt.signals.arrays import FloatArray

_EXACT = 2**53


@dataclass(frozen=True, slots=True)
class Conversion:
    """``scale`` times a value plus ``offset``, both exact."""

    scale: Fraction
    offset: Fraction

    def __call__(self, values: Any) -> Any:
        """Return a number, or an array of them, in the other unit.

        Whole numbers are multiplied and divided, so that what the unit makes a round number is one: 36 km/h is 10 m/s.
        """
        below = lcm(self.scale.denominator, self.offset.denominator)
        factor, shift = int(self.scale * below), int(self.offset * below)
        if max(abs(factor), abs(shift), below) >= _EXACT:
            return values * float(self.scale) + float(self.offset)
        values = values * float(factor)
        if shift:
            values = values + float(shift)
        return values if below == 1 else values / float(below)


def converted(values: FloatArray, name: str, recorded: str, declared: str) -> FloatArray:
    """Return the values of a variable in its declared unit; the same array where nothing is to be done."""
    conversion = conversion_of(name, recorded, declared)
    if conversion is None:
        return values
    with np.errstate(over="ignore"):
        new = conversion(values)
    beyond = np.isinf(new) & ~np.isinf(values)
    if beyond.any():
        i = int(beyond.argmax())
        raise TraceError(
            f"'{name}' is {values[i]:g} {recorded} at sample {i}, beyond the range of a double in {declared}",
            variable=name,
            index=i,
        )
    return np.asarray(new, dtype=np.float64)


def conversion_of(name: str, recorded: str, declared: str) -> Conversion | None:
    """Return the conversion of a variable's values; None if they are not converted.

    Raises :class:`TraceError` for units that are unknown or differ in more than factor and offset, and
    :class:`UsageError` where the library is missing.
    """
    if same_text(recorded, declared):
        return None
    library("pint", f"converting '{name}' from {recorded} to {declared}", "units")
    kinds = {"recorded": recorded, "declared": declared}
    for kind, other in (("recorded", "declared"), ("declared", "recorded")):
        if parsed(kinds[kind]) is None:
            raise TraceError(
                f"the {kind} unit '{kinds[kind]}' of '{name}' is unknown, so that it cannot be converted ({other}: "
                f"{kinds[other]}); declare the recorded unit, or give another one to rtamt.read(units=...)",
                variable=name,
            )
    found = _conversion(recorded, declared)
    if found is None:
        raise TraceError(
            f"'{name}' is recorded in {recorded}, which cannot be converted to {declared}, its declared unit",
            variable=name,
        )
    return None if found == Conversion(Fraction(1), Fraction(0)) else found


@lru_cache(maxsize=512)
def _conversion(recorded: str, declared: str) -> Conversion | None:
    """Return the conversion between two known units; None if there is none."""
    units, first, second = registry(), parsed(recorded), parsed(declared)
    if units.get_root_units(first)[1] != units.get_root_units(second)[1]:
        return None
    found = [in_unit(Fraction(i), first, second) for i in range(3)]
    if None in found:
        return None
    at = [Fraction(value) for value in found]
    scale = at[1] - at[0]
    return Conversion(scale, at[0]) if at[2] - at[1] == scale else None
