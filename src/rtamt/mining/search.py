"""Parameters without a known direction: the values with the least margin that were tried, not proven tight."""

from __future__ import annotations

from itertools import product
from math import inf
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.modules import np
from rtamt.mining.region import Spent, written

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rtamt.mining.grid import Grid
    from rtamt.mining.mine import Mined
    from rtamt.mining.region import Region

#: How many values are tried.
TRIED = 500
#: The rounds of the refined grid.
ROUNDS = 4
#: The cost of values that a recording violates, above that of any that none does.
_VIOLATED = 1e12


def search_values(bare: Mined, region: Region, grids: list[Grid], optimizer: str | None, seed: int) -> Mined:
    """Return the values with the least robustness that satisfy the template on every recording, of those tried."""
    from rtamt.mining.mine import Point

    tries = _Tries(region, grids)
    finished = True
    try:
        if optimizer is None:
            _refine(tries, len(grids))
        else:
            from rtamt.search.optimizers import optimizer as named

            named(optimizer)(tries, len(grids), seed, 8)
    except _Enough:
        pass
    except Spent:
        finished = False
    if tries.best is None:
        raise UsageError(
            f"none of the {len(tries.made)} values that were tried satisfies the specification on all recordings; "
            f"there may be others, so give narrower ranges"
        )
    return replace(
        bare,
        points=(Point(tries.best, {}, {}),),
        ranges={grid.name: (grid.value(0), grid.value(grid.last)) for grid in grids},
        resolutions={grid.name: float(grid.step) for grid in grids},
        finished=finished,
        evaluations=region.budget.made,
        tried=tuple(tries.made),
    )


class _Enough(Exception):  # noqa: N818 - no error: it ends an optimizer
    """Enough values were tried."""


class _Tries:
    """The objective of an optimizer: the margin of values that satisfy the template, above it that of the others."""

    def __init__(self, region: Region, grids: list[Grid]) -> None:
        self.made: list[tuple[dict[str, float], float]] = []
        self.best: dict[str, float] | None = None
        self._least = inf
        self._region = region
        self._grids = grids
        self._known: dict[str, float] = {}

    def __call__(self, points: NDArray[Any]) -> NDArray[np.float64]:
        return np.array([self._cost(point) for point in np.atleast_2d(points)])

    def _cost(self, point: NDArray[Any]) -> float:
        if len(self.made) >= TRIED:
            raise _Enough
        values = {
            grid.name: grid.value(round(float(part) * grid.last))
            for grid, part in zip(self._grids, point, strict=True)
        }
        key = written(values)
        if key not in self._known:
            margin, holds = self._region.margin(values)
            self.made.append((values, margin))
            if holds and (self.best is None or margin < self._least):
                self.best, self._least = values, margin
            bounded = float(np.clip(margin, -_VIOLATED / 2, _VIOLATED / 2))
            self._known[key] = bounded if holds else _VIOLATED - bounded
        return self._known[key]


def _refine(tries: _Tries, dimensions: int) -> None:
    """Evaluate a grid of the unit cube, then one around its best point, and so on."""
    per_axis = max(3, int((TRIED / ROUNDS) ** (1 / dimensions)))
    low, high = np.zeros(dimensions), np.ones(dimensions)
    for _ in range(ROUNDS):
        axes = [np.linspace(a, b, per_axis) for a, b in zip(low, high, strict=True)]
        points = np.array(list(product(*axes)))
        best = points[int(np.argmin(tries(points)))]
        reach = (high - low) / (per_axis - 1)
        low, high = np.maximum(0, best - reach), np.minimum(1, best + reach)
