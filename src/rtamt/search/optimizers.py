"""Optimizers of established libraries behind one interface: points of the unit cube in, robustness out.

Each is one function ``(evaluate, dimensions, seed, batch)``. It calls ``evaluate`` with batches of points, an
array of shape (k, dimensions), and receives k numbers to minimise. It returns when it has converged and is
then restarted; at the end of the budget, ``evaluate`` raises an exception that ends it.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, TypeAlias

from rtamt.errors import UsageError, choices
from rtamt.extras import library
from rtamt.lazy.modules import np

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    Points: TypeAlias = NDArray[np.float64]
    Evaluate: TypeAlias = Callable[[Points], NDArray[np.float64]]
    Optimizer: TypeAlias = Callable[[Evaluate, int, int, int], None]


#: The margin around the unit cube that CMA-ES searches; points in it are projected to the boundary.
MARGIN = 0.5


def random(evaluate: Evaluate, dimensions: int, seed: int, batch: int) -> None:
    """Independent, uniformly distributed points: the baseline for every optimizer."""
    draw = np.random.default_rng(seed)
    while True:
        evaluate(draw.random((batch, dimensions)))


def sobol(evaluate: Evaluate, dimensions: int, seed: int, batch: int) -> None:
    """A Sobol sequence (scipy.stats.qmc): points that cover the space evenly."""
    sequence = library("scipy.stats.qmc", "this optimizer", "falsify").Sobol(dimensions, seed=seed)
    block = 2 ** int(np.ceil(np.log2(max(2, batch))))
    while True:
        points = sequence.random(block)
        for begin in range(0, block, batch):
            evaluate(points[begin : begin + batch])


def cma_es(evaluate: Evaluate, dimensions: int, seed: int, batch: int) -> None:
    """CMA-ES (package cma), the evolution strategy that adapts its covariance, in the unit cube.

    Violations are often in the corners of the cube (full throttle, no brake, all the time). The search cube is
    therefore larger by :data:`MARGIN`, and points outside are projected to the boundary. While there are too
    few simulations for a full matrix, only its diagonal is adapted (R. Ros, N. Hansen, "A simple modification in
    CMA-ES achieving linear time and space complexity", 2008), for as long as the package suggests.
    """
    cma = library("cma", "this optimizer", "falsify")
    start = np.random.default_rng(seed).random(dimensions)
    # The package needs at least two dimensions, so a single number gets a second one without effect.
    idle = 1 if dimensions == 1 else 0
    options = {
        "bounds": [-MARGIN, 1 + MARGIN],
        "CMA_diagonal": "100 * N / popsize**0.5",
        "seed": seed + 1,
        "verbose": -9,
        "popsize": max(batch, 4 + int(3 * np.log(dimensions + 1))),
    }
    strategy = cma.CMAEvolutionStrategy([*start, *[0.5] * idle], 0.3, options)
    while not strategy.stop():
        points = strategy.ask()
        values = evaluate(np.clip(np.asarray(points)[:, :dimensions], 0, 1))
        strategy.tell(points, list(values))


def differential_evolution(evaluate: Evaluate, dimensions: int, seed: int, batch: int) -> None:  # noqa: ARG001 - its own
    """Differential evolution (scipy), one generation per batch."""
    optimize = library("scipy.optimize", "this optimizer", "falsify")
    optimize.differential_evolution(
        lambda points: evaluate(np.clip(np.atleast_2d(points.T), 0, 1)),
        [(0, 1)] * dimensions,
        vectorized=True,
        updating="deferred",
        polish=False,
        rng=seed,
    )


def dual_annealing(evaluate: Evaluate, dimensions: int, seed: int, batch: int) -> None:  # noqa: ARG001 - it has none
    """Dual annealing (scipy), one point at a time."""
    optimize = library("scipy.optimize", "this optimizer", "falsify")
    optimize.dual_annealing(
        lambda point: float(evaluate(np.clip(np.atleast_2d(point), 0, 1))[0]), [(0, 1)] * dimensions, rng=seed
    )


def optuna_tpe(evaluate: Evaluate, dimensions: int, seed: int, batch: int) -> None:
    """Tree-structured Parzen estimator (package optuna)."""
    optuna = library("optuna", "this optimizer", "falsify")
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=seed))
    while True:
        trials = [study.ask() for _ in range(batch)]
        points = [[trial.suggest_float(str(k), 0.0, 1.0) for k in range(dimensions)] for trial in trials]
        for trial, value in zip(trials, evaluate(np.asarray(points)), strict=True):
            study.tell(trial, float(value))


OPTIMIZERS: Mapping[str, Optimizer] = MappingProxyType({
    "cma": cma_es,
    "differential_evolution": differential_evolution,
    "dual_annealing": dual_annealing,
    "optuna": optuna_tpe,
    "sobol": sobol,
    "random": random,
})  # fmt: skip


def optimizer(name: str) -> Optimizer:
    """Return the optimizer of this name; raise :class:`UsageError` if there is none."""
    found = OPTIMIZERS.get(name)
    if found is None:
        raise UsageError(f"there is no optimizer '{name}'{choices(name, OPTIMIZERS, 'optimizers')}")
    return found
