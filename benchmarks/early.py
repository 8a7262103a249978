"""What an update costs before the horizon: eager verdicts and bounds, by the length of the bounds.

    python benchmarks/early.py [SAMPLES [dense]]

Microseconds of processor time an update from Python, the verdicts in it included, beside the delayed mode; and
those of mstlo's verdicts and intervals (``pip install mstlo-python``) for lengths up to 1000.
The aims: eager 0.3 µs for three operators; bounds at the start 0.3 µs; at every sample 1 µs for
one window, 3 µs for two nested. Each flat from bounds of 10 to 100 000.
"""

from __future__ import annotations

import sys
import time
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np

import rtamt

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any

FORMULAS = (
    "always[0:{k}](x >= -2)",
    "eventually[0:{k}] always[0:{k}](x >= -2)",
    "always[0:{k}](x >= 1 -> eventually[0:{k}](y >= 1))",
    "(x >= -2) until[0:{k}] (y >= 1)",
    "(x >= -2) since[0:{k}] (y >= 1)",
)
#: The same in the language of mstlo, as far as it has them.
IN_MSTLO = {
    FORMULAS[0]: "G[0, {k}](x >= -2)",
    FORMULAS[1]: "F[0, {k}](G[0, {k}](x >= -2))",
    FORMULAS[2]: "G[0, {k}]((x >= 1) -> (F[0, {k}](y >= 1)))",
    FORMULAS[3]: "(x >= -2) U[0, {k}] (y >= 1)",
}
LENGTHS = (10, 100, 1_000, 10_000, 100_000)
MODES: Mapping[str, dict[str, str]] = {
    "delayed": {},
    "eager": {"verdict": "eager"},
    "start": {"verdict": "interval", "at": "start"},
    "every": {"verdict": "interval", "at": "every"},
}


def cost(formula: str, settings: Mapping[str, str], samples: int) -> float:
    """Return the microseconds of an update, the least of three runs."""
    random = np.random.default_rng(1)
    spec = rtamt.parse(formula)
    names = spec.input_names
    columns = [random.normal(size=samples).tolist() for _ in names]
    times = [float(t) for t in range(samples)]
    best = float("inf")
    for _ in range(3):
        update = spec.monitor(**settings).update
        begin = time.process_time()
        if len(names) == 1:
            for t, x in zip(times, columns[0], strict=True):
                update(t, x=x)
        else:
            for t, x, y in zip(times, *columns, strict=True):
                update(t, x=x, y=y)
        best = min(best, time.process_time() - begin)
    return best / samples * 1e6


def mstlo_cost(formula: str, k: int, semantics: str, samples: int) -> float:
    """Return the microseconds of a sample of all variables: one run, its windows full for the second half at least."""
    module = import_module("mstlo_python")
    update: Callable[..., Any] = module.Monitor(module.parse_formula(formula), semantics=semantics).update
    names = [name for name in "xy" if name in formula]
    rows = np.random.default_rng(1).normal(size=(min(samples, max(3_000, 2 * k)), len(names))).tolist()
    begin = time.process_time()
    for i, row in enumerate(rows):
        t = float(i)
        for name, value in zip(names, row, strict=True):
            update(name, value, t).verdicts()
    return (time.process_time() - begin) / len(rows) * 1e6


def main() -> None:
    """Print a row for each formula and length."""
    samples = int(sys.argv[1]) if len(sys.argv) > 1 else 300_000
    domain = {"time": sys.argv[2]} if len(sys.argv) > 2 else {}
    peer = ("EagerQualitative", "Rosi") if find_spec("mstlo_python") else ()
    print(f"{'formula':<52} {'k':>7}", *(f"{mode:>8}" for mode in MODES), *(f"{each:>16}" for each in peer))
    for formula in FORMULAS:
        for k in LENGTHS:
            row = [cost(formula.format(k=k), {**settings, **domain}, samples) for settings in MODES.values()]
            text = IN_MSTLO.get(formula) if k <= 1_000 else None
            theirs = [mstlo_cost(text.format(k=k), k, each, samples) for each in peer if text]
            cells = [*(f"{each:8.2f}" for each in row), *(f"{each:16.2f}" for each in theirs)]
            print(f"{formula:<52} {k:>7}", *cells, flush=True)
    for formula in ("always(x >= -2)", "eventually(x >= 5)", "(x >= -2) until (y >= 5)"):
        print(
            f"{formula:<52} {'':>7} {'':>8} {'':>8} {cost(formula, {**MODES['start'], **domain}, samples):8.2f}"
        )


if __name__ == "__main__":
    main()
