"""What an update costs before the horizon: eager verdicts and bounds, by the length of the bounds.

    python benchmarks/early.py [SAMPLES [dense]]

Microseconds of processor time an update from Python, the verdicts in it included, beside the delayed mode.
The aims: eager 0.3 µs for three operators; bounds at the start 0.3 µs; at every sample 1 µs for
one window, 3 µs for two nested. Each flat from bounds of 10 to 100 000.
"""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING

import numpy as np

import rtamt

if TYPE_CHECKING:
    from collections.abc import Mapping

FORMULAS = (
    "always[0:{k}](x >= -2)",
    "eventually[0:{k}] always[0:{k}](x >= -2)",
    "always[0:{k}](x >= 1 -> eventually[0:{k}](y >= 1))",
    "(x >= -2) until[0:{k}] (y >= 1)",
    "(x >= -2) since[0:{k}] (y >= 1)",
)
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


def main() -> None:
    """Print a row for each formula and length."""
    samples = int(sys.argv[1]) if len(sys.argv) > 1 else 300_000
    domain = {"time": sys.argv[2]} if len(sys.argv) > 2 else {}
    print(f"{'formula':<52} {'k':>7}", *(f"{mode:>8}" for mode in MODES))
    for formula in FORMULAS:
        for k in LENGTHS:
            row = [cost(formula.format(k=k), {**settings, **domain}, samples) for settings in MODES.values()]
            print(f"{formula:<52} {k:>7}", *(f"{each:8.2f}" for each in row), flush=True)
    for formula in ("always(x >= -2)", "eventually(x >= 5)", "(x >= -2) until (y >= 5)"):
        print(
            f"{formula:<52} {'':>7} {'':>8} {'':>8} {cost(formula, {**MODES['start'], **domain}, samples):8.2f}"
        )


if __name__ == "__main__":
    main()
