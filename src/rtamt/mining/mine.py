"""The tight values of the parameters of a template: the hardest that every recording satisfies."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from functools import partial
from math import gcd, lcm
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, shown
from rtamt.lazy.dataclasses import dataclass, field, replace
from rtamt.mining.direction import require, roles_of
from rtamt.mining.grid import Grid, hardest
from rtamt.mining.parameter_ranges import (
    Finder,
    Timing,
    bound_grid,
    checked_ranges,
    checked_resolutions,
    impossible,
    value_grid,
)
from rtamt.mining.pareto_front import front
from rtamt.mining.region import Budget, Region, Spent, number, require_count, written
from rtamt.mining.search import search_values
from rtamt.specification import Specification

if TYPE_CHECKING:
    from collections.abc import Callable

    from typing_extensions import Unpack

    from rtamt.mining.direction import Role
    from rtamt.settings import EvaluationSettings

#: How many evaluations of a recording are made at most, where no budget is given.
EVALUATIONS = 1_000_000
#: How many points of a front are enough, where none is given.
POINTS = 25


@dataclass(frozen=True)
class Point:
    """Values with which every recording satisfies the template.

    ``harder``: for each parameter the next harder value, which a recording violates where the other values stay; the
    name of that recording is in ``violated_by``. ``hardest``: bounds of intervals without a harder value. Any
    other parameter is not tight: it is at the end of its range, or its direction is unknown, or the budget was spent.
    """

    values: Mapping[str, float]
    harder: Mapping[str, float]
    violated_by: Mapping[str, str]
    hardest: tuple[str, ...] = ()

    @property
    def tight(self) -> bool:
        """Whether no parameter can be harder by one step of its resolution."""
        return {*self.harder, *self.hardest} == set(self.values)


@dataclass(frozen=True)
class Mined:
    """The values of the parameters of a template that recordings admit.

    ``points``: one, or the Pareto front of two parameters. ``roles``: of each parameter its ``direction`` (1: larger
    values are easier to satisfy, -1: smaller ones, None: unknown) and whether it bounds an interval. ``ranges``: the
    easiest and the hardest value that were considered. ``undecided``: the share of the area between the ends of the
    front in which there may be further points. ``alone``: the tight value of a single parameter for each recording.
    ``finished``: whether the budget was enough. ``tried``: the values that a search tried, with the least robustness.
    """

    specification: Specification
    points: tuple[Point, ...]
    roles: tuple[Role, ...]
    ranges: Mapping[str, tuple[float, float]]
    resolutions: Mapping[str, float]
    recordings: tuple[str, ...]
    undecided: float = 0.0
    alone: Mapping[str, float] = field(default_factory=dict)
    finished: bool = True
    evaluations: int = 0
    tried: tuple[tuple[Mapping[str, float], float], ...] = ()

    @property
    def tight(self) -> bool:
        """Whether the values of every point are tight; a front may have further points, see ``undecided``."""
        return self.finished and all(point.tight for point in self.points)

    def with_values(self, point: int = 0) -> Specification:
        """Return the specification with the values of a point."""
        return self.specification.with_parameters(**self.points[point].values)

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain data."""
        named = {1: "larger", -1: "smaller", None: "unknown"}
        return {
            "tight": self.tight,
            "finished": self.finished,
            "undecided": self.undecided,
            "evaluations": self.evaluations,
            "parameters": [
                {
                    "name": role.name,
                    "kind": "bound" if role.bound else "threshold",
                    "easier": named[role.direction],
                    "easiest": self.ranges[role.name][0],
                    "hardest": self.ranges[role.name][1],
                    "resolution": self.resolutions[role.name],
                }
                for role in self.roles
            ],
            "points": [
                {
                    "values": dict(point.values),
                    "tight": point.tight,
                    "harder": dict(point.harder),
                    "violated_by": dict(point.violated_by),
                }
                for point in self.points
            ],
            "recordings": [{"name": name, "alone": self.alone.get(name)} for name in self.recordings],
        }

    def plot(self, axes: Any = None) -> Any:
        """Plot the front of two parameters, or one parameter by recording; returns the axes. Needs ``rtamt[plot]``."""
        from rtamt.mining.plot import plot

        return plot(self, axes)

    def __repr__(self) -> str:
        count = len(self.recordings)
        on = f"on {count} recording{'' if count == 1 else 's'}"
        if len(self.points) == 1:
            return f"<{written(self.points[0].values)} {on}>"
        return f"<front of {', '.join(role.name for role in self.roles)} with {len(self.points)} points {on}>"


def mine(
    spec: Specification,
    recordings: Mapping[str, Any] | Iterable[Any],
    *,
    parameters: Iterable[str] | None = None,
    ranges: Mapping[str, tuple[float, float]] | None = None,
    resolutions: Mapping[str, float] | None = None,
    order: bool = False,
    points: int = POINTS,
    optimizer: str | None = None,
    seed: int = 0,
    evaluations: int = EVALUATIONS,
    timeout: float | None = None,
    progress: Callable[[int], None] | None = None,
    **reading: Unpack[EvaluationSettings],
) -> Mined:
    """Return the hardest values of parameters with which every recording satisfies a template.

    ``parameters``: those to mine, by default all in the formula; the others keep their values. Whether larger or
    smaller values are harder follows from the formula (:func:`directions`). One parameter is found by bisection; of
    two, the Pareto front of at most ``points`` points; of more, or with ``order=True``, the first parameter is as hard
    as possible, then the second one, and so on. If the direction of a parameter is unknown, all are searched: on a grid
    that is refined, or by an ``optimizer`` of :mod:`rtamt.search`, with ``seed``. Then thresholds need a range, and the
    values are those with the least robustness of those that were tried, not proven tight.

    ``ranges``: from a parameter to its least and greatest value. ``resolutions``: the steps of its values, by default
    five significant digits, and for the bound of an interval the sampling period. ``evaluations`` and ``timeout`` (in
    seconds) limit the work: evaluations of one recording. ``progress`` is called with their number. The other
    settings are those of :meth:`Specification.evaluate`, as are recordings: a mapping from names, or a list.

    Every value is confirmed by evaluation: the recordings satisfy the template with it, and one recording violates it
    with the next harder value.

    Raises :class:`UsageError` if no value satisfies the template on all recordings, and :class:`TraceError`, with
    the name of the recording, where the template cannot be evaluated.

    >>> import rtamt
    >>> spec = rtamt.parse('''
    ...     parameter float level = 3  parameter float within = 1
    ...     eventually[0:within](always(x >= level))''', period=1)
    >>> found = mine(spec, [{"x": [0, 1, 2, 4, 5]}])
    >>> [dict(point.values) for point in found.points]
    [{'level': 0.0, 'within': 0.0}, {'level': 1.0, 'within': 1.0}, {'level': 2.0, 'within': 2.0}, \
{'level': 4.0, 'within': 3.0}, {'level': 5.0, 'within': 4.0}]
    """
    if not isinstance(spec, Specification):
        raise UsageError(f"mine takes a specification, got {shown(spec)}; rtamt.parse reads text")
    named = named_recordings(recordings)
    if spec.groups:
        raise UsageError(
            "templates over the members of groups cannot be mined; name the variables of the members"
        )
    names = require(spec, parameters)
    given, steps = checked_ranges(ranges or {}, names), checked_resolutions(resolutions or {}, names)
    require_count("points", points, 2)
    region = Region(spec, named, reading, Budget(evaluations, timeout, progress))
    roles = roles_of(spec, names, given)
    work = _Work(region, roles, tuple(named), given, steps)
    bare = Mined(spec, (), tuple(roles), {}, {}, tuple(named))
    try:
        if any(role.direction is None for role in roles):
            return search_values(bare, region, work.all_grids(), optimizer, seed)
        grids = work.grids()
        bare = replace(
            bare,
            ranges={grid.name: (grid.value(0), grid.value(grid.last)) for grid in grids},
            resolutions={grid.name: float(grid.step) for grid in grids},
        )
        found = (
            _front(bare, region, grids, points)
            if len(grids) == 2 and not order
            else _one(bare, region, grids)
        )
    except Spent:
        raise UsageError(
            f"the budget of {_budget(evaluations, timeout)} was spent before any values were found; give a larger one"
        ) from None
    return replace(found, evaluations=region.budget.made)


def _budget(evaluations: int, timeout: float | None) -> str:
    return f"{evaluations} evaluations" + ("" if timeout is None else f" or {number(timeout)} s")


def named_recordings(recordings: Any, what: str = "recordings") -> dict[str, Any]:
    """Return recordings by name; without names they are called by their numbers, from 0."""
    if isinstance(recordings, Mapping):
        named = {str(name): data for name, data in recordings.items()}
    elif isinstance(recordings, Iterable) and not isinstance(recordings, str):
        named = {str(place): data for place, data in enumerate(recordings)}
    else:
        raise UsageError(f"{what} is {shown(recordings)}; give a list of recordings, or a mapping from names")
    if not named:
        raise UsageError(f"{what} is empty; give one recording or more")
    return named


class _Work:
    """The grids of parameters, for which recordings may be evaluated."""

    def __init__(
        self,
        region: Region,
        roles: list[Role],
        recordings: tuple[str, ...],
        ranges: Mapping[str, tuple[float, float]],
        resolutions: Mapping[str, Fraction],
    ) -> None:
        self._region = region
        self._roles = roles
        self._recordings = recordings
        self._ranges = ranges
        self._resolutions = resolutions

    def grids(self) -> list[Grid]:
        """Return the grids of parameters whose directions are known."""
        found = self._known()
        found |= Finder(self._region, self._roles, found).grids(self._resolutions)
        return [found[role.name] for role in self._roles]

    def all_grids(self) -> list[Grid]:
        """Return the grids of parameters of which some directions are unknown; thresholds need a range."""
        found = self._known()
        for role in self._roles:
            if role.name not in found:
                why = (
                    f"the formula does not decide whether larger or smaller values of '{role.name}' are harder"
                    if role.direction is None
                    else f"'{role.name}' is searched together with a parameter without a known direction"
                )
                raise UsageError(f"{why}; give its range")
        return [found[role.name] for role in self._roles]

    def _known(self) -> dict[str, Grid]:
        found = {}
        timing = self._timing() if any(role.bound for role in self._roles) else None
        for role in self._roles:
            given, resolution = self._ranges.get(role.name), self._resolutions.get(role.name)
            if timing is not None and role.bound:
                found[role.name] = bound_grid(role, given, resolution, timing)
            elif given is not None:
                found[role.name] = value_grid(role, given, resolution)
        return found

    def _timing(self) -> Timing:
        traces = [self._region.trace(name) for name in self._recordings]
        longest = max(trace.last * trace.step for trace in traces)
        periods = [trace.domain.period for trace in traces if trace.domain.period is not None]
        return Timing(_multiple(periods) if periods else None, longest, max(trace.step for trace in traces))


def _multiple(periods: list[Fraction]) -> Fraction:
    """Return the least duration that is a multiple of each sampling period."""
    return Fraction(lcm(*(p.numerator for p in periods)), gcd(*(p.denominator for p in periods)))


def _values(grids: list[Grid], places: Iterable[int]) -> dict[str, float]:
    return {grid.name: grid.value(k) for grid, k in zip(grids, places, strict=True)}


def _one(bare: Mined, region: Region, grids: list[Grid]) -> Mined:
    """Return one point: each parameter in turn as tight as the recordings allow."""
    places = [0] * len(grids)
    _require_some(region, grids)
    finished = True
    try:
        for place, grid in enumerate(grids):

            def holds(k: int, place: int = place) -> bool:
                return region.holds(_values(grids, [*places[:place], k, *places[place + 1 :]]))

            places[place] = hardest(holds, grid.last)
        alone = _tight_alone(bare, region, grids[0]) if len(grids) == 1 else {}
        point = _point(region, grids, places)
    except Spent:
        finished, alone, point = False, {}, Point(_values(grids, places), {}, {})
    return replace(bare, points=(point,), alone=alone, finished=finished)


def _tight_alone(bare: Mined, region: Region, grid: Grid) -> dict[str, float]:
    """Return the tight value for each recording alone."""
    found = {}
    for name in bare.recordings:
        own = region.alone(name)
        found[name] = grid.value(hardest(partial(_holds_at, own, grid), grid.last))
    return found


def _holds_at(region: Region, grid: Grid, k: int) -> bool:
    return region.holds(_values([grid], [k]))


def _front(bare: Mined, region: Region, grids: list[Grid], points: int) -> Mined:
    _require_some(region, grids)
    first, second = grids
    found, undecided = front(
        lambda x, y: region.holds(_values(grids, (x, y))), (first.last, second.last), points
    )
    try:
        every = [_point(region, grids, place) for place in found]
    except Spent:
        every = [Point(_values(grids, place), {}, {}) for place in found]
    if not every:
        raise Spent
    every.sort(key=lambda point: tuple(point.values.values()))
    return replace(
        bare, points=tuple(every), undecided=undecided, finished=len(found) >= points or not undecided
    )


def _require_some(region: Region, grids: list[Grid]) -> None:
    values = _values(grids, [0] * len(grids))
    violator = region.violator(values)
    if violator is not None:
        raise UsageError(impossible(violator, values))


def _point(region: Region, grids: list[Grid], places: Iterable[int]) -> Point:
    """Return a point, with the recording that violates each next harder value."""
    at = list(places)
    harder, by = {}, {}
    for place, grid in enumerate(grids):
        if at[place] < grid.last:
            beyond = _values(grids, [k + (n == place) for n, k in enumerate(at)])
            violator = region.violator(beyond)
            assert violator is not None
            harder[grid.name], by[grid.name] = beyond[grid.name], violator
    ends = tuple(grid.name for grid, k in zip(grids, at, strict=True) if grid.closed and k == grid.last)
    return Point(_values(grids, at), harder, by, ends)
