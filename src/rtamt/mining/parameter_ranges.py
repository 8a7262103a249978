"""The range of each parameter: as given, by its kind, or by what the recordings satisfy."""

from __future__ import annotations

from fractions import Fraction
from math import ceil, floor
from typing import TYPE_CHECKING

from rtamt.errors import UsageError, choices, shown
from rtamt.language.units.durations import exact
from rtamt.lazy.tuples import NamedTuple
from rtamt.mining.grid import Grid, digits, hardest
from rtamt.mining.region import number, written
from rtamt.signals.arrays import is_number

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.mining.direction import Role
    from rtamt.mining.region import Region

#: How far values are looked for where no range is given.
FARTHEST = 1e15
#: Significant digits of values where no resolution is given.
SIGNIFICANT = 5
#: How often a bracket is divided to find the size of a value.
_ROUNDS = 3


def checked_ranges(
    given: Mapping[str, Sequence[float]], known: Sequence[str]
) -> dict[str, tuple[float, float]]:
    """Return the ranges of parameters that are mined; raise :class:`UsageError` for anything else."""
    found = {}
    for name, pair in given.items():
        if name not in known:
            raise UsageError(
                f"there is a range of '{name}', which is not mined{choices(name, known, 'parameters')}"
            )
        ends = tuple(pair) if isinstance(pair, (tuple, list)) else ()
        if len(ends) != 2 or not all(is_number(end) and abs(end) < float("inf") for end in ends):
            raise UsageError(f"the range of '{name}' is {shown(pair)}; give two numbers, such as (0, 60)")
        low, high = map(float, ends)
        if low >= high:
            raise UsageError(
                f"the range of '{name}' ends at {number(high)}, where it should begin; exchange its ends"
            )
        found[name] = (low, high)
    return found


def checked_resolutions(given: Mapping[str, float], known: Sequence[str]) -> dict[str, Fraction]:
    """Return the resolutions of parameters that are mined; raise :class:`UsageError` for anything else."""
    found = {}
    for name, value in given.items():
        if name not in known:
            raise UsageError(
                f"there is a resolution of '{name}', which is not mined{choices(name, known, 'parameters')}"
            )
        if not is_number(value) or not 0 < value < float("inf"):
            raise UsageError(f"the resolution of '{name}' is {shown(value)}; give a number above 0")
        found[name] = exact(str(float(value)))
    return found


class Timing(NamedTuple):
    """The time of recordings, in seconds: the common sampling period, None in dense time.

    ``longest``: the duration of the longest recording. ``tick``: how far the next instant is from an excluded bound.
    """

    period: Fraction | None
    longest: Fraction
    tick: Fraction


def bound_grid(
    role: Role,
    given: tuple[float, float] | None,
    resolution: Fraction | None,
    timing: Timing,
) -> Grid:
    """Return the values of a parameter that bounds an interval: multiples of the sampling period."""
    step, longest = timing.period, timing.longest / role.seconds
    shortest, limit = role.least(timing.tick), role.most(timing.tick)
    least, most = shortest, longest if limit is None else min(limit, longest)
    unit = resolution
    if step is not None:
        period = step / role.seconds
        unit = resolution or period
        if (unit / period).denominator != 1:
            raise UsageError(
                f"the resolution of '{role.name}' is {number(float(unit))}, and bounds are multiples of the sampling "
                f"period, {number(float(period))}; give a multiple of it"
            )
    if given is not None:
        low, high = (exact(str(end)) for end in given)
        if low < least or (limit is not None and high > limit):
            raise UsageError(
                f"the range of '{role.name}' is {number(given[0])} to {number(given[1])}, in which an interval would "
                f"end before it begins, or begin before 0; begin it at {number(float(least))} or later"
                + ("" if limit is None else f" and end it at {number(float(limit))} or earlier")
            )
        least, most = low, high
    if role.whole:
        unit = _common(unit or Fraction(1))
    if unit is None:
        unit = digits(max(most, Fraction(1, 10**6)), SIGNIFICANT)
    low, high = Fraction(ceil(least / unit)) * unit, Fraction(floor(most / unit)) * unit
    if (
        given is None and not role.ends
    ):  # a window has all samples if it ends at the last one, or next after it
        after = max((out for _, out in role.begins), default=0) * timing.tick / role.seconds
        high = Fraction(ceil((longest + after) / unit)) * unit
    if high < low:
        raise UsageError(
            f"no value of '{role.name}' from {number(float(least))} to {number(float(most))} is a multiple of "
            f"{number(float(unit))}; give a wider range"
        )
    if role.direction == 1:
        return Grid(role.name, high, low, unit, closed=low - unit < shortest)
    return Grid(role.name, low, high, unit, closed=limit is not None and high + unit > limit)


def _common(unit: Fraction) -> Fraction:
    """Return the least whole number that is a multiple of a unit."""
    return Fraction(unit.numerator)


def value_grid(role: Role, given: tuple[float, float], resolution: Fraction | None) -> Grid:
    """Return the values of a threshold in a given range."""
    low, high = (exact(str(end)) for end in given)
    step = resolution or digits(high - low, SIGNIFICANT)
    if role.whole:
        step = max(Fraction(1), Fraction(floor(step)))
        low, high = Fraction(ceil(low)), Fraction(floor(high))
    return Grid(role.name, high, low, step) if role.direction == 1 else Grid(role.name, low, high, step)


class Finder:
    """Finds the ends of thresholds without a range: one that every recording satisfies, and one that none needs."""

    def __init__(self, region: Region, roles: Sequence[Role], grids: Mapping[str, Grid]) -> None:
        self._region = region
        self._free = [role for role in roles if role.name not in grids]
        self._order = [role.name for role in roles]
        self._start = {role.name: region.spec.parameters[role.name] for role in self._free}
        self._easiest = {name: grid.value(0) for name, grid in grids.items()}

    def grids(self, resolutions: Mapping[str, Fraction]) -> dict[str, Grid]:
        """Return the grid of each threshold without a range."""
        if not self._free:
            return {}
        # With others, the easiest value decides which values of theirs count: none that matters is left out.
        others = FARTHEST if len(self._order) > 1 else 0.0
        found = {}
        for role in self._free:
            easy = next((far for far in _distances() if self._holds(role, far, others)), None)
            if easy is None:
                values = self._at(role, FARTHEST, others)
                raise UsageError(impossible(self._region.violator(values), values))
            hard = next((far for far in _distances() if not self._holds(role, -far, others)), None)
            if hard is None:
                raise UsageError(
                    f"no recording restricts '{role.name}': the hardest value that was tried, "
                    f"{number(self._move(role, -FARTHEST))}, satisfies the specification; "
                    f"give a range, or leave it out"
                )
            step = resolutions.get(role.name) or self._step(role, easy, hard, others)
            if role.whole:
                step = max(Fraction(1), Fraction(floor(step)))
            found[role.name] = self._grid(role, max(easy, others), hard, step)
        return found

    def _step(self, role: Role, easy: float, hard: float, others: float) -> Fraction:
        """Return the last significant digit of the tight value, from a bracket that is 2^-14 of the range.

        Where the value is far smaller than the range, the bracket is divided in the same way; a value that is then
        still no larger than its bracket counts as 0.
        """
        ends, parts = (Fraction(self._move(role, easy)), Fraction(self._move(role, -hard))), 2**14
        values = self._at(role, easy, others)

        def value(k: int) -> float:
            near = _between(*ends, k, parts)
            return float(round(near)) if role.whole else near

        sizes = []
        for _ in range(_ROUNDS):
            k = hardest(lambda k: self._region.holds({**values, role.name: value(k)}), parts)
            low, high = _between(*ends, k, parts), _between(*ends, min(k + 1, parts), parts)
            size = max(abs(low), abs(high))
            sizes.append(digits(Fraction(size) if size else abs(ends[0] - ends[1]) / parts, SIGNIFICANT))
            if role.whole or abs(high - low) < size / 4:
                return sizes[-1]
            ends = Fraction(low), Fraction(high)
        return sizes[0]

    def _grid(self, role: Role, easy: float, hard: float, step: Fraction) -> Grid:
        ends = Fraction(self._move(role, easy)), Fraction(self._move(role, -hard))
        low, high = Fraction(floor(min(ends) / step)) * step, Fraction(ceil(max(ends) / step)) * step
        return Grid(role.name, high, low, step) if role.direction == 1 else Grid(role.name, low, high, step)

    def _move(self, role: Role, distance: float) -> float:
        """Return a value easier than the current one by a distance in units of its magnitude."""
        start = self._start[role.name]
        assert role.direction is not None
        moved = start + role.direction * distance * max(1.0, abs(start))
        return float(round(moved)) if role.whole else moved

    def _holds(self, role: Role, distance: float, others: float) -> bool:
        return self._region.holds(self._at(role, distance, others))

    def _at(self, role: Role, distance: float, others: float) -> dict[str, float]:
        """Return an easier value for one role, and easy values for the others."""
        values = {**self._easiest, **{each.name: self._move(each, others) for each in self._free}}
        values[role.name] = self._move(role, distance)
        return {name: values[name] for name in self._order}


def impossible(violator: str | None, values: Mapping[str, float]) -> str:
    """Return the sentence for recordings that violate a template whatever the values."""
    return (
        f"no values in their ranges satisfy the specification on all recordings: '{violator}' violates it with the "
        f"easiest ones, {written(values)}; leave the recording out, or widen a range"
    )


def _distances() -> list[float]:
    found, distance = [0.0], 1.0
    while distance < FARTHEST:
        found.append(distance)
        distance *= 4
    return [*found, FARTHEST]


def _between(first: Fraction, last: Fraction, k: int, parts: int) -> float:
    return float(first + (last - first) * k / parts)
