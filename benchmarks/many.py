"""Many formulas over one trace, one formula over many traces, and Timescales at full length.

In a process of its own, `python benchmarks/many.py [--quick]`: prints one JSON object.
"""

from __future__ import annotations

import json
import os
import resource
import sys
import time
from functools import partial
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "conformance" / "peers"))

import timescales

import rtamt

if TYPE_CHECKING:
    from collections.abc import Callable

ROUNDS = 5


def peak() -> float:
    """Return the largest memory of this process so far, in MiB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def spent(call: Callable[[], object], clock: Callable[[], float] = time.process_time) -> float:
    """Return seconds of the processor, or by another clock."""
    start = clock()
    call()
    return clock() - start


def noise(n: int) -> dict[str, Any]:
    """Return n samples of two signals."""
    random = np.random.default_rng(1)
    return {"a": random.normal(size=n), "b": random.normal(size=n)}


def one_by_one(specs: list[rtamt.Specification], data: dict[str, Any]) -> None:
    """Evaluate each by itself."""
    for spec in specs:
        spec.evaluate(data)


def programs(quick: bool) -> list[dict[str, Any]]:
    """Time 1 to 1 000 formulas over one trace: all in one program, and one after the other."""
    n = 1000 if quick else 10_000
    data = noise(n)
    rows = []
    for count in (1, 10) if quick else (1, 10, 100, 1000):
        texts = [
            f"always[0:{50 + i // 100}](a >= {i % 10} -> eventually[0:{i // 10 % 10 + 1}](b >= 3))"
            for i in range(count)
        ]
        specs = [rtamt.parse(text) for text in texts]
        together, apart = [], []
        for _ in range(ROUNDS):
            fresh = [rtamt.parse(text) for text in texts]  # nothing compiled yet
            together.append(spent(partial(rtamt.evaluate_all, specs, data)))
            apart.append(spent(partial(one_by_one, fresh, data)))
        ratio = median(a / t for a, t in zip(apart, together, strict=True))
        rows.append({"formulas": count, "samples": n, "together": median(together), "apart": median(apart),
                     "ratio": ratio, "peak": peak()})  # fmt: skip
    return rows


def batches(quick: bool) -> list[dict[str, Any]]:
    """Time one formula over 1 to 10 000 traces of a million samples altogether, by threads."""
    spec = rtamt.parse("always((a >= 3) -> eventually[0:5](b >= 3))")
    total = 10_000 if quick else 1_000_000
    rows = []
    for count in (1, 10) if quick else (1, 100, 10_000):
        traces = [noise(total // count) for _ in range(count)]
        threads = sorted({1, 2, os.cpu_count() or 1})
        costs: dict[int, list[float]] = {workers: [] for workers in threads}
        for _ in range(ROUNDS):
            for workers in threads:
                costs[workers].append(
                    spent(partial(rtamt.evaluate_batch, spec, traces, workers=workers), time.perf_counter)
                )
        rows += [
            {"traces": count, "samples": total // count, "threads": workers, "seconds": median(figures),
             "ratio": median(a / b for a, b in zip(costs[1], figures, strict=True)), "peak": peak()}
            for workers, figures in costs.items()
        ]  # fmt: skip
    return rows


def verdicts(quick: bool) -> list[dict[str, Any]]:
    """Evaluate both forms of every family over a million samples, and hold every verdict to what is known."""
    n = 10_000 if quick else 1_000_000
    rows = []
    for family in timescales.FAMILIES:
        for unit in (1,) if quick else (1, 10, 100):
            row: dict[str, Any] = {"family": family, "unit": unit, "samples": n}
            for wrong in (False, True):
                columns = timescales.signals(family, unit, n, wrong=wrong)
                data = {name: np.array(column) for name, column in columns.items()}
                expected = timescales.violated_at(family, unit, n) if wrong else n
                for form in ("past", "future"):
                    spec = rtamt.parse(timescales.formula(family, unit, form))
                    own = {name: data[name] for name in spec.input_names}
                    start = time.process_time()
                    values = spec.evaluate(own).signal.values
                    row[form] = (time.process_time() - start) / n
                    if form == "past":
                        right = (values[:expected] > 0).all() and (values[expected:] < 0).all()
                    else:
                        right = bool((values[0] < 0) == wrong)
                    if not right:
                        raise AssertionError(f"{family}, {form} form, unit {unit}, wrong: {wrong}")
            rows.append(row)
    return rows


def main() -> None:
    """Print everything as JSON."""
    quick = "--quick" in sys.argv
    json.dump(
        {"programs": programs(quick), "batches": batches(quick), "verdicts": verdicts(quick)}, sys.stdout
    )


if __name__ == "__main__":
    main()
