"""Time a tool in its own process: the same signals, the same clock, the same rules for all.

An adapter's ``prepare(formula, time, mode, signals)`` parses the formula and brings the samples into the
form in which the tool takes them; none of that is timed. The clock is the processor's time of the process:
every tool computes in one thread, and what else the machine does must not count. What ``prepare`` returns
is: offline a function of nothing that evaluates all samples, online a function ``run(begin, end)`` that
feeds these samples one by one.

An adapter's ``reading(formula, time, mode, names)`` writes the formula in the tool's language, and returns a
function of nothing in which the tool reads that text and gets ready to run: so the tool's parser is timed, and
not the adapter.
"""

import random
import statistics
from functools import lru_cache
from time import perf_counter, process_time

import timescales

BASE = 100_000  # so many random numbers, over and over
#: Evaluations are timed together until they take so many seconds, but no more than so many: to read the clock takes
#: 0.6 µs, a quarter of a short evaluation.
CLOCK, MOST = 1e-4, 50


@lru_cache(maxsize=1)
def _signals(kind, names, n, time):
    if kind in timescales.FAMILIES:
        family, unit, wrong = names
        return timescales.signals(family, unit, n, wrong=wrong)
    source = random.Random(1)
    size = min(n, BASE)
    columns = {name: [source.gauss(0, 1) for _ in range(size)] * -(-n // size) for name in names}
    columns = {name: column[:n] for name, column in columns.items()}
    if time == "discrete":
        return columns
    # Eighths of a second: exact in every tool. All signals change at the same instants.
    steps, now = [], 0.0
    for _ in range(n):
        steps.append(now)
        now += source.randint(1, 15) / 8
    return {name: [[t, v] for t, v in zip(steps, column)] for name, column in columns.items()}


def signals(workload, time):
    """Return the samples: a list of numbers a variable, in dense time of [seconds, number]."""
    return _signals(workload["kind"], tuple(workload["names"]), workload["n"], time)


def _parsing(reading, formula, time, mode):
    """Return seconds from a text in the tool's language to what is ready to run."""
    read = reading(formula, time, mode, ["a"])
    costs = []
    for _ in range(5):
        start = process_time()
        read()
        costs.append(process_time() - start)
    return {"seconds": statistics.median(costs)}


def measure(prepare, reading, formula, time, mode, workload):
    """Return seconds a sample, the median of several runs offline, the mean of many samples online.

    ``workload``: which signals, ``n`` samples of them; online the first ``warm`` are not timed, and it
    ends after ``limit`` seconds, if not before.
    """
    if workload["kind"] == "parse":
        return _parsing(reading, formula, time, mode)
    samples = signals(workload, time)
    n = workload["n"]
    run = prepare(formula, time, mode, samples)
    if mode == "offline":
        costs, spent, runs = [], 0.0, [run]
        while not costs or (spent < workload["limit"] and len(costs) < 30):
            start = process_time()
            for run in runs:
                run()
            costs.append((process_time() - start) / len(runs))
            spent += costs[-1] * len(runs)
            many = min(MOST, 1 + int(CLOCK / costs[-1]))
            runs = [prepare(formula, time, mode, samples) for _ in range(many)]
        return {"seconds": statistics.median(costs) / n}
    at = workload["warm"]
    start = perf_counter()
    for begin in range(0, at, 1000):
        run(begin, min(begin + 1000, at))
        if perf_counter() - start > workload["patience"]:
            return {"unsupported": f"its window is not full after {workload['patience']:g} s"}
    spent, done, size = 0.0, 0, 1
    while at < n and spent < workload["limit"]:
        end = min(at + size, n)
        start = process_time()
        run(at, end)
        spent += process_time() - start
        done += end - at
        at, size = end, 2 * size
    return {"seconds": spent / done}
