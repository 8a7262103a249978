"""Sensitivity analysis: the robustness at many points of the inputs, on a grid or quasi-random."""

from __future__ import annotations

from itertools import product
from math import prod
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, did_you_mean
from rtamt.extras import library
from rtamt.language.printing.printer import to_text
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.search.executor import Enough, Runs, count
from rtamt.search.log import Evaluation, Record

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.search.problem import Problem


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """The robustness over the inputs; ``axes`` holds the values of each parameter of a grid, and is empty otherwise."""

    problem: Problem
    evaluations: tuple[Evaluation, ...]
    axes: Mapping[str, NDArray[np.float64]]

    @property
    def robustness(self) -> NDArray[np.float64]:
        """The robustness: for a grid, an array with one dimension per axis; otherwise one number per point."""
        values = np.array([evaluation.robustness for evaluation in self.evaluations])
        return values.reshape([len(axis) for axis in self.axes.values()]) if self.axes else values

    @property
    def best(self) -> Evaluation:
        """The evaluation with the least robustness."""
        return min(self.evaluations, key=lambda evaluation: evaluation.robustness)

    def plot(self, axes: Any = None) -> Any:
        """Plot the robustness over two parameters (a heat map) or one; return the matplotlib axes."""
        from rtamt.search.plot import landscape

        return landscape(self, axes)


def sensitivity(
    problem: Problem,
    *,
    grid: Mapping[str, int | Sequence[float]] | None = None,
    samples: int | None = None,
    seed: int = 0,
    workers: int = 1,
    record: str | os.PathLike[str] | None = None,
    progress: Callable[[Evaluation], None] | None = None,
) -> Sensitivity:
    """Evaluate the requirement at many points, each simulation run to its end.

    Either ``grid``: for every parameter the number of values, spread evenly over its range including both ends,
    or the values themselves; or ``samples``: the number of points of a Sobol sequence (drawn with ``seed``).
    ``workers``, ``record`` and ``progress`` as for :func:`falsify`.

    >>> import rtamt
    >>> from rtamt.search import Problem, Range, sensitivity
    >>> def line(slope, start):
    ...     return {"x": [start + slope * k for k in range(3)]}
    >>> problem = Problem(rtamt.parse("always(x <= 3)"), line, {"slope": Range(0, 1), "start": Range(0, 2)})
    >>> sensitivity(problem, grid={"slope": 2, "start": 3}).robustness
    array([[ 3.,  2.,  1.],
           [ 1.,  0., -1.]])
    """
    if (grid is None) == (samples is None):
        raise UsageError("give either grid= or samples=")
    axes = {} if grid is None else _axes(problem, grid)
    names = tuple(axes or problem.space)
    if axes:
        points = [dict(zip(names, map(float, point), strict=True)) for point in product(*axes.values())]
    else:
        points = _spread(problem, samples, seed)
    about = {
        "formula": to_text(problem.spec.formula, problem.spec.language),
        "duration": problem.duration,
        "points": len(points),
        "first": points[0],
        "last": points[-1],
    }
    with Runs(
        problem, Record(record, about), len(points), workers=workers, whole=True, progress=progress
    ) as runs:
        try:
            while True:
                runs.batch(points[len(runs.made) : len(runs.made) + workers])
        except Enough:
            return Sensitivity(problem, tuple(runs.made), axes)


def _axes(problem: Problem, grid: Mapping[str, int | Sequence[float]]) -> dict[str, NDArray[np.float64]]:
    for name in grid:
        if name not in problem.space:
            raise UsageError(f"there is no parameter '{name}'{did_you_mean(name, tuple(problem.space))}")
    for name in problem.space:
        if name not in grid:
            raise UsageError(
                f"the grid does not contain the parameter '{name}': how many values shall it take?"
            )
    axes = {}
    for name, given in grid.items():  # in the given order, which determines the axes of the plot
        if isinstance(given, int):
            if given < 2:
                raise UsageError(
                    f"the grid has {given} values of '{name}'; give 2 or more, or the values themselves"
                )
            axes[name] = np.linspace(problem.space[name].low, problem.space[name].high, given)
        else:
            axes[name] = np.asarray(given, float)
    assert prod(map(len, axes.values()))
    return axes


def _spread(problem: Problem, samples: int | None, seed: int) -> list[dict[str, float]]:
    count("the number of samples", samples)
    assert samples is not None
    sequence = library("scipy.stats.qmc", "this optimizer", "falsify").Sobol(len(problem.space), seed=seed)
    unit = sequence.random_base2(max(0, samples - 1).bit_length())[:samples]
    return [
        {name: part.at(float(x)) for (name, part), x in zip(problem.space.items(), point, strict=True)}
        for point in unit
    ]
