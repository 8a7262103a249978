"""Optimizers of well-kept libraries, told the same way: points of the unit cube in, robustness out.

Each is one function ``(evaluate, dimensions, seed, batch)`` that asks for batches of points, an array of
shape (k, dimensions), and gets k numbers to make small. It returns when it has converged and is
then started anew; the budget ends it by an exception out of ``evaluate``.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from rtamt.errors import UsageError, choices
from rtamt.extras import library

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    Points: TypeAlias = NDArray[np.float64]
    Evaluate: TypeAlias = Callable[[Points], NDArray[np.float64]]
    Optimizer: TypeAlias = Callable[[Evaluate, int, int, int], None]


#: How far beyond the unit cube CMA-ES searches on each side: points there are points of the boundary.
MARGIN = 0.5


def random(evaluate: Evaluate, dimensions: int, seed: int, batch: int) -> None:
    """Points drawn evenly, independent of each other: what every optimizer must beat."""
    draw = np.random.default_rng(seed)
    while True:
        evaluate(draw.random((batch, dimensions)))


def sobol(evaluate: Evaluate, dimensions: int, seed: int, batch: int) -> None:
    """A Sobol sequence (scipy.stats.qmc): points that fill the space evenly."""
    sequence = library("scipy.stats.qmc", "this optimizer", "falsify").Sobol(dimensions, seed=seed)
    block = 2 ** int(np.ceil(np.log2(max(2, batch))))
    while True:
        points = sequence.random(block)
        for begin in range(0, block, batch):
            evaluate(points[begin : begin + batch])


def cma_es(evaluate: Evaluate, dimensions: int, seed: int, batch: int) -> None:
    """CMA-ES (package cma), the evolution strategy that adapts its covariance, in the unit cube.

    Violations like to lie in its corners (full throttle, no brake, all the time). So the search has a cube
    that is larger by :data:`MARGIN`, and what lies outside is moved to the boundary. As long as there are too
    few simulations for a whole matrix, its diagonal is adapted alone (R. Ros, N. Hansen, "A simple modification in
    CMA-ES achieving linear time and space complexity", 2008), for as long as the package suggests.
    """
    cma = library("cma", "this optimizer", "falsify")
    start = np.random.default_rng(seed).random(dimensions)
    # The package adapts a covariance matrix; one number alone has none, so it gets a companion without effect.
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


def differential_evolution(evaluate: Evaluate, dimensions: int, seed: int, batch: int) -> None:  # noqa: ARG001
    """Differential evolution (scipy), one generation a batch."""
    optimize = library("scipy.optimize", "this optimizer", "falsify")
    optimize.differential_evolution(
        lambda points: evaluate(np.clip(np.atleast_2d(points.T), 0, 1)),
        [(0, 1)] * dimensions,
        vectorized=True,
        updating="deferred",
        polish=False,
        rng=seed,
    )


def dual_annealing(evaluate: Evaluate, dimensions: int, seed: int, batch: int) -> None:  # noqa: ARG001
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
    """Return the optimizer of that name; raise :class:`UsageError` for any other."""
    found = OPTIMIZERS.get(name)
    if found is None:
        raise UsageError(f"there is no optimizer '{name}'{choices(name, OPTIMIZERS, 'optimizers')}")
    return found
