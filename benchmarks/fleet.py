"""What a sample of a fleet costs: rows of ``make costs``; alone, beside one monitor for each key.

Each round takes one sample of each of 100 000 keys, in random order, from arrays of numpy. Times are those of the
process.
"""

from __future__ import annotations

import statistics
import time
from itertools import count
from typing import TYPE_CHECKING, Any

import numpy as np

import rtamt

if TYPE_CHECKING:
    from collections.abc import Callable

KEYS = 100_000
#: Formulas with their targets in ns a sample: one and a half times what a prototype took.
FORMULAS = {
    "a >= 3": 8.25,
    "always[0:99](a >= 3)": 150.0,
    "always[0:99](a >= 3 -> eventually[0:49](b >= 2))": 393.0,
}


def batches(
    text: str,
) -> tuple[rtamt.Specification, Callable[[], tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]]]:
    """Return a specification, and a function that returns the next sample of each key."""
    spec = rtamt.parse(text)
    random = np.random.default_rng(1)
    columns = {name: random.normal(size=KEYS) for name in spec.input_names}
    times = count()
    return spec, lambda: (random.permutation(KEYS), np.full(KEYS, float(next(times))), columns)


def of_fleet(text: str, rounds: int = 5) -> Callable[[], float]:
    """Return a function that measures nanoseconds a sample of a fleet."""
    spec, batch = batches(text)
    fleet = rtamt.Fleet(spec, KEYS)
    fleet.update_many(*batch())

    def measure() -> float:
        spent = []
        for _ in range(rounds):
            given = batch()
            start = time.process_time_ns()
            fleet.update_many(*given)
            spent.append((time.process_time_ns() - start) / KEYS)
        return statistics.median(spent)

    return measure


def of_stream(text: str, rounds: int = 6) -> float:
    """Return nanoseconds a sample of a fleet with a lateness of two periods, every other key out of order."""
    spec, batch = batches(text)
    fleet = rtamt.Fleet(spec, KEYS, lateness=2)
    spent = []
    for number in range(8 + rounds):
        keys, times, columns = batch()
        swapped = np.maximum(times + np.where(keys % 2 == 0, 0, 1 if number % 2 == 0 else -1), 0.0)
        start = time.process_time_ns()
        fleet.update_many(keys, swapped, columns)
        spent.append((time.process_time_ns() - start) / KEYS)
    return statistics.median(spent[8:])


def of_verdicts(text: str, samples: int, rounds: int = 3, keys: int = 10_000, **settings: Any) -> float:
    """Return nanoseconds a sample of a fleet with a monitor for each key, in batches of some samples of each key."""
    spec, random = rtamt.parse(text), np.random.default_rng(1)
    fleet = rtamt.Fleet(spec, keys, **settings)
    columns = {name: random.normal(size=keys * samples) for name in spec.input_names}
    spent = []
    for number in range(1 + rounds):
        order = random.permutation(keys)
        times = np.repeat(np.arange(samples) + float(number * samples), keys)
        start = time.process_time_ns()
        fleet.update_many(np.tile(order, samples), times, columns)
        spent.append((time.process_time_ns() - start) / (keys * samples))
    return statistics.median(spent[1:])


def of_monitors(text: str) -> Callable[[], float]:
    """Return a function that measures the same with one monitor for each key, fed by position."""
    spec, batch = batches(text)
    monitors = [spec.monitor() for _ in range(KEYS)]

    def measure() -> float:
        keys, _, columns = batch()
        rows = list(zip(*(columns[name].tolist() for name in monitors[0].input_names), strict=True))
        order = keys.tolist()
        start = time.process_time_ns()
        for key, row in zip(order, rows, strict=True):
            monitors[key].step(*row)
        return (time.process_time_ns() - start) / KEYS

    return measure


def main() -> None:
    """Print the median of each, measured in turn; then that of fleets whose samples wait."""
    print(f"{'':50} {'fleet':>9} {'monitors':>9} {'target':>9}  ns a sample")
    for text, target in FORMULAS.items():
        fleet, monitors = of_fleet(text), of_monitors(text)
        pairs = [(fleet(), monitors()) for _ in range(7)][1:]
        a, b = (statistics.median(each) for each in zip(*pairs, strict=True))
        print(f"{text:50} {a:9.1f} {b:9.1f} {target:9.1f}")
    for text in FORMULAS:
        print(f"{text:50} {of_stream(text):9.1f}  with lateness")


if __name__ == "__main__":
    main()
