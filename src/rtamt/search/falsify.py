"""Falsification: search for inputs that violate a requirement by minimising the robustness."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.language.printing.printer import to_text
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.search.executor import Enough, Runs
from rtamt.search.log import Evaluation, Record
from rtamt.search.optimizers import optimizer as named_optimizer

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from numpy.typing import NDArray

    from rtamt.search.problem import Problem

#: The value that optimizers get for infinite robustness, since they need finite numbers.
HUGE = 1e12


@dataclass(frozen=True, eq=False)
class Falsification:
    """The result of a search: every evaluation in order."""

    problem: Problem
    evaluations: tuple[Evaluation, ...]

    @property
    def best(self) -> Evaluation:
        """The first evaluation that violates the requirement, or else the one with the least robustness."""
        for evaluation in self.evaluations:
            if not evaluation.satisfied:
                return evaluation
        return min(self.evaluations, key=lambda evaluation: evaluation.robustness)

    @property
    def falsified(self) -> bool:
        """Whether a violation was found."""
        return not self.best.satisfied

    def plot(self, axes: Any = None) -> Any:
        """Plot the robustness over the simulations, as in the paper's Fig. 12b; return the matplotlib axes."""
        from rtamt.search.plot import descent

        return descent(self, axes)

    def __str__(self) -> str:
        best = self.best
        where = ", ".join(f"{name} = {value:.6g}" for name, value in best.point.items())
        made = len(self.evaluations)
        if self.falsified:
            when = f", settled at {best.stopped:g} s" if best.stopped is not None else ""
            return (
                f"violated in simulation {best.number + 1}, robustness {best.robustness:.6g}{when}: {where}"
            )
        return f"no violation in {made} simulations; the least robustness is {best.robustness:.6g}: {where}"


def falsify(
    problem: Problem,
    *,
    optimizer: str = "cma",
    budget: int = 300,
    seed: int = 0,
    workers: int = 1,
    record: str | os.PathLike[str] | None = None,
    stop: bool = True,
    progress: Callable[[Evaluation], None] | None = None,
) -> Falsification:
    """Search for a violation.

    ``optimizer``: cma, differential_evolution, dual_annealing, optuna, sobol or random. ``budget``: the
    maximum number of simulations. ``workers``: the number of parallel processes. ``record``: a log file
    of every evaluation; the same call with the same file resumes an interrupted
    search. ``stop``: end at the first violation. ``progress`` is called after each simulation.
    The search is deterministic for a given seed and number of workers.

    >>> import rtamt
    >>> from rtamt.search import Problem, Range, falsify
    >>> def throw(speed):
    ...     time = [k / 10 for k in range(21)]
    ...     return {"time": time, "height": [speed * t - 4.9 * t * t for t in time]}
    >>> problem = Problem(rtamt.parse("always(height <= 6)"), throw, {"speed": Range(1, 12)})
    >>> found = falsify(problem, optimizer="random", budget=50, seed=1)
    >>> found.falsified, found.best.point["speed"] > 10.8
    (True, True)
    """
    search = named_optimizer(optimizer)
    names = tuple(problem.space)
    about = {
        "formula": to_text(problem.spec.formula, problem.spec.language),
        "space": {name: [part.low, part.high] for name, part in problem.space.items()},
        "duration": problem.duration,
        "optimizer": optimizer,
        "seed": seed,
        "workers": workers,
    }
    with Runs(problem, Record(record, about), budget, workers=workers, stop=stop, progress=progress) as runs:

        def evaluate(points: NDArray[np.float64]) -> NDArray[np.float64]:
            batch = [
                {name: problem.space[name].at(float(x)) for name, x in zip(names, point, strict=True)}
                for point in points
            ]
            return np.clip([found.robustness for found in runs.batch(batch)], -HUGE, HUGE)

        try:
            while True:  # restart a converged optimizer with another seed
                search(evaluate, len(names), seed + len(runs.made), workers)
        except Enough:
            return Falsification(problem, tuple(runs.made))
