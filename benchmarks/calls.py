"""What a call costs, beside the samples that it takes: rows of ``make costs``.

Times are those of the process, because calls of microseconds are disturbed by whatever else runs.
"""

from __future__ import annotations

import time
from functools import partial
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np

import rtamt

if TYPE_CHECKING:
    from collections.abc import Callable

TEXT = "always[0:1](a + b >= -2)"
#: Samples of a short trace.
SHORT = 100
TRACES = 10_000


def each(count: int, call: Callable[[], object], pieces: int = 1, unit: float = 1e3) -> Callable[[], float]:
    """Return a function that measures ``count`` calls, by default microseconds a call, divided by ``pieces``."""

    def measure() -> float:
        start = time.process_time_ns()
        for _ in range(count):
            call()
        return (time.process_time_ns() - start) / count / pieces / unit

    return measure


def data_of(n: int, *, timed: bool, kind: str = "arrays") -> Any:
    """Return n samples of two variables as arrays, lists or a frame."""
    random = np.random.default_rng(1)
    data: dict[str, Any] = {"time": np.arange(n) * 0.1} if timed else {}
    data |= {name: random.normal(size=n) for name in ("a", "b")}
    if kind == "lists":
        return {name: column.tolist() for name, column in data.items()}
    if kind == "arrays":
        return data
    from importlib import import_module

    return import_module(kind).DataFrame(data)


def short(kind: str = "arrays", *, timed: bool = False) -> Callable[[], float]:
    """``spec.evaluate(data)`` of 100 samples: µs."""
    spec, data = rtamt.parse(TEXT), data_of(SHORT, timed=timed, kind=kind)
    return each(500, lambda: spec.evaluate(data))


def chunks() -> Callable[[], float]:
    """``monitor.update_many(data)`` with 100 samples: µs."""
    monitor, data = rtamt.parse(TEXT).monitor(), data_of(SHORT, timed=False)
    return each(500, lambda: monitor.update_many(data))


def steps() -> Callable[[], float]:
    """100 times ``monitor.step(a, b)``: µs."""
    step = rtamt.parse(TEXT).monitor().step
    rows = list(zip(*data_of(SHORT, timed=False, kind="lists").values(), strict=True))

    def call() -> None:
        for a, b in rows:
            step(a, b)

    return each(100, call)


def batch(text: str, **settings: str) -> Callable[[], float]:
    """``spec.evaluate_batch(arrays)`` of 10 000 traces of 100 samples: µs a trace."""
    spec = rtamt.parse(text)
    random = np.random.default_rng(1)
    data = {name: random.normal(size=(TRACES, SHORT)) for name in spec.input_names}
    return each(1, lambda: spec.evaluate_batch(data, **settings), TRACES)


def one_by_one() -> Callable[[], float]:
    """``rtamt.evaluate_batch(spec, traces)`` of 1 000 traces of 100 samples: µs a trace."""
    spec, data = rtamt.parse(TEXT, period="1s"), data_of(SHORT, timed=False)
    return each(1, lambda: rtamt.evaluate_batch(spec, [data] * 1000), 1000)


def all_warm() -> Callable[[], float]:
    """``evaluate_all(specs, data)`` of 10 formulas over 100 samples, again and again: µs."""
    specs = [rtamt.parse(f"always[0:10](a + b >= -{i})") for i in range(10)]
    data = data_of(SHORT, timed=False)
    return each(50, lambda: rtamt.evaluate_all(specs, data))


def long(n: int) -> Callable[[], float]:
    """``evaluate(a >= 3)`` of n samples: ns a sample."""
    spec, data = rtamt.parse("a >= 3"), {"a": np.random.default_rng(1).normal(size=n)}
    return each(max(1, 10**6 // n), lambda: spec.evaluate(data), n, 1.0)


def dense_points(signals: int) -> Callable[[], float]:
    """``monitor.update(t, x0=v).points()`` of a monitor of so many signals, the others unchanged: ns."""
    spec = rtamt.parse(" and ".join(f"x{i} >= 0" for i in range(signals)), time="dense")
    monitor = spec.monitor()
    monitor.update(0.0, **{f"x{i}": 1.0 for i in range(signals)})
    ticks = iter(range(1, 10**9))

    def measure() -> float:
        rows = [(tick * 0.1, float(tick % 17)) for tick in islice(ticks, 1000)]
        update = monitor.update
        start = time.process_time_ns()
        for now, value in rows:  # the loop itself takes some 10 ns
            update(now, x0=value).points()
        return (time.process_time_ns() - start) / len(rows)

    return measure


def explained(text: str, time: str) -> Callable[[], float]:
    """``explain`` over 10^6 samples: s."""
    random = np.random.default_rng(1)
    a, b = random.normal(size=(2, 10**6))
    stamps = np.arange(10.0**6)
    data = {"a": (stamps, a), "b": (stamps, b)} if time == "dense" else {"a": a, "b": b}
    result = rtamt.parse(text).evaluate(data, time=time)
    return each(1, result.explain, unit=1e9)


#: Formulas whose verdicts are explained, the shares with one and with thousands of causes.
EXPLAINED = (
    "always(a >= 1 -> eventually[0:20](b >= 1))",
    "atleast[0:1000](90%, a >= 1)",
    "always(atleast[0:10](10%, a >= 1))",
    "eventually(atleast[0:1000](90%, a >= 1))",
)

#: Name, unit, upper limit, and what prepares the measurement.
CALLS: tuple[tuple[str, str, float | None, Callable[[], Callable[[], float]]], ...] = (
    ("evaluate, 100 samples", "µs/call", 3, short),
    ("evaluate, 100 samples with 'time'", "µs/call", 3, lambda: short(timed=True)),
    ("evaluate, 100 samples with 'time', lists", "µs/call", None, lambda: short("lists", timed=True)),
    ("evaluate, 100 samples with 'time', pandas", "µs/call", 6, lambda: short("pandas", timed=True)),
    ("evaluate, 100 samples with 'time', polars", "µs/call", 6, lambda: short("polars", timed=True)),
    ("update_many, 100 samples", "µs/call", 3, chunks),
    ("100 steps", "µs", None, steps),
    ("evaluate_batch, arrays 10 000 x 100, a >= 0", "µs/trace", 0.7, lambda: batch("a >= 0")),
    (f"evaluate_batch, arrays 10 000 x 100, {TEXT}", "µs/trace", None, lambda: batch(TEXT)),
    (
        f"evaluate_batch, arrays 10 000 x 100, Boolean, {TEXT}",
        "µs/trace",
        None,
        lambda: batch(TEXT, semantics="boolean"),
    ),
    ("rtamt.evaluate_batch, 1 000 recordings", "µs/trace", None, one_by_one),
    ("evaluate_all, 10 formulas, 100 samples, warm", "µs/call", None, all_warm),
    ("evaluate(a >= 3), 10^6 samples", "ns/sample", 2, lambda: long(10**6)),
    ("evaluate(a >= 3), 10^7 samples", "ns/sample", 4, lambda: long(10**7)),
    ("dense online update(t, x=v).points()", "ns/call", 300, lambda: dense_points(1)),
    ("dense online update(t, x0=v).points(), 64 signals", "ns/call", None, lambda: dense_points(64)),
    *(
        (f"explain, 10^6 samples, {time}, {text}", "s", 0.3, partial(explained, text, time))
        for text in EXPLAINED
        for time in ("discrete", "dense")
    ),
)


if __name__ == "__main__":  # these rows alone
    import statistics

    prepared = [(name, unit, target, prepare()) for name, unit, target, prepare in CALLS]
    measured: list[list[float]] = [[] for _ in prepared]
    for _ in range(7):
        for row, (*_, run) in zip(measured, prepared, strict=True):
            row.append(run())
    for (name, unit, target, _), row in zip(prepared, measured, strict=True):
        print(f"{name:55} {statistics.median(row):9.3g} {unit:10} {target or ''}")
