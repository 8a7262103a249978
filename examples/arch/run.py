"""Falsify the benchmarks from ten seeds each: ``python examples/arch/run.py [NAME ...] > examples/arch/results.md``.

Prints a table in Markdown: how often each formula was falsified, after how many simulations on average, and
what others report. Options: ``--optimizers``, ``--budget``, ``--seeds``, ``--workers``.
"""

from __future__ import annotations

import argparse
import sys
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from statistics import mean

from benchmarks import BENCHMARKS, Benchmark
from rtamt.search import falsify

HEAD = """\
# Falsified benchmarks of ARCH-COMP

Written by `{command}`: at most {budget} simulations, seeds 0 to {last}. Inputs are piecewise constant, each
value held for 5 s. Each cell contains the number of runs that found a violation, and the mean number of simulations
of these runs.

| formula | {optimizers} | reported elsewhere |
|---|{lines}---|"""

TAIL = """
Reported elsewhere: the same numbers for 10 runs of FalCAuN, from the summary in its repository for the competition of
2024 (MasWag/FalCAuN-ARCH-COMP). It ran the Simulink models, and more than 300 simulations if necessary. A budget of 300
is that of FalStar's published configuration. The plants here differ from the models of the competition (see
README.md), so that the rows are comparable qualitatively, not digit by digit.

## The formulas

Each entry lists the published forms of the participants (FalStar, zlscheck, FalCAuN, ARIsTEO) and the monitored
formula.
G is always, F eventually, X next; `g1` is "gear 1 is engaged". If published forms differ, the first is used.
"""


def attempt(number: int, seed: int, optimizer: str, budget: int) -> tuple[bool, int]:
    """Search once; returns whether a violation was found, and after how many simulations."""
    found = falsify(BENCHMARKS[number].problem(), optimizer=optimizer, budget=budget, seed=seed)
    return found.falsified, len(found.evaluations)


def cell(attempts: list[tuple[bool, int]]) -> str:
    """Return how many attempts falsified, and their mean number of simulations."""
    counts = [simulations for falsified, simulations in attempts if falsified]
    return f"{len(counts)}/{len(attempts)}" + (f", {mean(counts):.1f}" if counts else "")


def formulas(benchmark: Benchmark) -> str:
    """Return what was published and what is monitored."""
    published = "\n".join(f"  - published: `{text}`" for text in benchmark.published)
    return f"- {benchmark.name}\n{published}\n  - monitored: `{benchmark.formula}`"


def main(arguments: list[str]) -> None:
    """Run what is asked for, all by default, and print each row as soon as it is known."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help="AT1, ... CCx; all by default")
    parser.add_argument("--optimizers", nargs="+", default=["cma", "dual_annealing"])
    parser.add_argument("--budget", type=int, default=300)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--workers", type=int, default=2)
    args = parser.parse_args(arguments)
    known = [benchmark.name for benchmark in BENCHMARKS]
    for name in args.names:
        if name not in known:
            parser.error(f"there is no '{name}', only {', '.join(known)}")
    chosen = [k for k, name in enumerate(known) if name in args.names or not args.names]
    command = " ".join(["python examples/arch/run.py", *arguments])
    lines = "---|" * len(args.optimizers)
    optimizers = " | ".join(args.optimizers)
    print(
        HEAD.format(
            command=command, budget=args.budget, last=args.seeds - 1, optimizers=optimizers, lines=lines
        )
    )
    with ProcessPoolExecutor(args.workers) as pool:
        for k in chosen:
            tasks = [partial(attempt, k, optimizer=name, budget=args.budget) for name in args.optimizers]
            cells = " | ".join(cell(list(pool.map(task, range(args.seeds)))) for task in tasks)
            print(f"| {known[k]} | {cells} | {BENCHMARKS[k].reported} |", flush=True)
    print(TAIL)
    for k in chosen:
        print(formulas(BENCHMARKS[k]))


if __name__ == "__main__":
    main(sys.argv[1:])
