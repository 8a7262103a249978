"""The hot paths whose instructions are counted; each is prepared once and returns a function that repeats it."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

import rtamt
from rtamt.compiler.plan import compile_program
from rtamt.engine.native import core
from rtamt.language.parsing.parser import parse_formula
from rtamt.rewrite.desugar import desugar
from rtamt.signals.dense import Dense

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

#: How the names of paths begin that run in the core alone.
CORE = "core,"

TWO = "always[0:1000](a + b >= -2)"
#: 900 characters, as a requirement of a large project may have.
LONG = " and ".join(["always[0:5]((req >= 3) -> eventually[0:5](gnt >= 3))"] * 16)
#: 1 200 characters, in which no two parts are equal.
DIFFERENT = " and ".join(
    f"always[0:{k + 5}]((req{k} >= {k + 1}) -> eventually[0:{k + 3}](gnt{k} >= {k + 30}))" for k in range(20)
)


def noise(n: int, names: str = "ab") -> dict[str, np.ndarray]:
    """Return n samples of each signal, the same in every run."""
    random = np.random.default_rng(1)
    return {name: random.normal(size=n) for name in names}


def keyword_update() -> Callable[[int], None]:
    """``monitor.update(t, a=x, b=y)``."""
    update = rtamt.parse(TWO).monitor().update
    time = iter(range(10**9))

    def run(n: int) -> None:
        for _ in range(n):
            update(next(time), a=1.0, b=2.0)

    return run


def typed_update() -> Callable[[int], None]:
    """``monitor.update(t, mode="AUTO", p=True)``."""
    text = "enum Mode { MANUAL, AUTO = 4 } input Mode mode input bool p always[0:10](p -> mode == AUTO)"
    update = rtamt.parse(text).monitor().update
    time = iter(range(10**9))

    def run(n: int) -> None:
        for _ in range(n):
            update(next(time), mode="AUTO", p=True)

    return run


def step() -> Callable[[int], None]:
    """``monitor.step(x, y)``."""
    method = rtamt.parse(TWO).monitor().step

    def run(n: int) -> None:
        for _ in range(n):
            method(1.0, 2.0)

    return run


def paper_update() -> Callable[[int], None]:
    """``update(t, [('a', x), ('b', y)])`` of the class of RTAMT's API."""
    spec = rtamt.StlDiscreteTimeOnlineSpecification()
    spec.declare_var("a", "float")
    spec.declare_var("b", "float")
    spec.spec = TWO
    spec.parse()
    spec.pastify()
    update = spec.update
    time = iter(range(10**9))

    def run(n: int) -> None:
        for _ in range(n):
            update(next(time), [("a", 1.0), ("b", 2.0)])

    return run


def watched_update(*, shuffled: bool = False, **settings: str) -> Callable[[], Callable[[int], None]]:
    """``update(t, x=v)`` of a mode or time domain, over noise; ``shuffled``: samples up to 8 s late."""

    def prepare() -> Callable[[int], None]:
        update = rtamt.parse("always[0:100](x >= 2 -> eventually[0:100](x >= 1))").monitor(**settings).update
        values = np.tile(noise(2000, "x")["x"], 10).tolist()
        delays = (
            np.random.default_rng(1).uniform(0, 8, size=len(values)) if shuffled else np.zeros(len(values))
        )
        order = (np.arange(len(values)) + delays).argsort(kind="stable").tolist()
        samples = iter([(t, values[t]) for t in order])

        def run(n: int) -> None:
            for _ in range(n):
                time, value = next(samples)
                update(time, x=value)

        return run

    return prepare


def dense_points(signals: int) -> Callable[[], Callable[[int], None]]:
    """``update(t, x0=v).points()`` in dense time, of a monitor of so many signals; the others do not change."""

    def prepare() -> Callable[[int], None]:
        text = " and ".join(f"x{i} >= 0" for i in range(signals))
        update = rtamt.parse(text).monitor(time="dense").update
        update(-1.0, **{f"x{i}": 1.0 for i in range(signals)})
        samples = enumerate(np.tile(noise(2000, "x")["x"], 10).tolist())

        def run(n: int) -> None:
            for _ in range(n):
                time, value = next(samples)
                update(0.1 * time, x0=value).points()

        return run

    return prepare


def update_many() -> Callable[[int], None]:
    """``monitor.update_many`` of chunks of 100 samples."""
    method = rtamt.parse(TWO).monitor().update_many
    data = noise(100)
    time = iter(range(0, 10**9, 100))

    def run(n: int) -> None:
        for _ in range(n):
            first = next(time)
            method({**data, "time": np.arange(first, first + 100.0)})

    return run


def evaluate(
    samples: int, *, start: float | None = None, period: float = 1.0
) -> Callable[[], Callable[[int], None]]:
    """``spec.evaluate`` of arrays, with timestamps from a start on or without."""

    def prepare() -> Callable[[int], None]:
        spec, data = rtamt.parse(TWO), noise(samples)
        if start is not None:
            data["time"] = start + period * np.arange(samples)

        def run(n: int) -> None:
            for _ in range(n):
                spec.evaluate(data)

        return run

    return prepare


def dense_evaluate() -> Callable[[int], None]:
    """``spec.evaluate`` of 100 samples in dense time, times and values as arrays."""
    spec = rtamt.parse(TWO, time="dense")
    times = np.arange(100) * 1.0
    data = {name: (times, values) for name, values in noise(100).items()}

    def run(n: int) -> None:
        for _ in range(n):
            spec.evaluate(data)

    return run


def verdict() -> Callable[[int], None]:
    """``spec.evaluate(data).satisfied`` of 100 samples."""
    spec, data = rtamt.parse(TWO), noise(100)

    def run(n: int) -> None:
        for _ in range(n):
            _ = spec.evaluate(data).satisfied

    return run


def fleet_update() -> Callable[[int], None]:
    """``fleet.update_many`` of a sample of each of 16 keys."""
    fleet = rtamt.Fleet(rtamt.parse(TWO), 16)
    keys, data = np.arange(16), noise(16)
    time = iter(range(10**9))

    def run(n: int) -> None:
        for _ in range(n):
            fleet.update_many(keys, np.full(16, float(next(time))), data)

    return run


def evaluate_batch() -> Callable[[int], None]:
    """``rtamt.evaluate_batch`` of 100 traces of 100 samples, a trace."""
    spec, traces = rtamt.parse(TWO), [noise(100)] * 100

    def run(n: int) -> None:
        for _ in range(n // 100):
            rtamt.evaluate_batch(spec, traces, workers=1)

    return run


def evaluate_arrays(**settings: str) -> Callable[[], Callable[[int], None]]:
    """``spec.evaluate_batch`` of an array with 128 traces of 100 samples: a trace."""

    def prepare() -> Callable[[int], None]:
        spec = rtamt.parse(TWO)
        data = {name: column.reshape(128, 100) for name, column in noise(12_800).items()}

        def run(n: int) -> None:
            for _ in range(n // 128):
                spec.evaluate_batch(data, **settings)

        return run

    return prepare


def parse_and_monitor(text: str) -> Callable[[], Callable[[int], None]]:
    """``rtamt.parse(text).monitor()``."""

    def prepare() -> Callable[[int], None]:
        def run(n: int) -> None:
            for _ in range(n):
                rtamt.parse(text).monitor()

        return run

    return prepare


def parse() -> Callable[[int], None]:
    """Parse a formula of 900 characters."""

    def run(n: int) -> None:
        for _ in range(n):
            parse_formula(LONG)

    return run


def offline(text: str) -> Callable[[], Callable[[int], None]]:
    """Evaluate a formula in the core over n samples: a sample."""

    def prepare() -> Callable[[int], None]:
        data = noise(10_000)
        program = compile_program((desugar(parse_formula(text)),), Fraction(1), clip=10_000)
        code, inputs = program.to_bytes(), [data[name] for name in program.inputs]
        call = core().evaluate

        def run(n: int) -> None:
            for _ in range(n // 10_000):
                call(code, inputs, 10_000)

        return run

    return prepare


def dense_offline(text: str) -> Callable[[], Callable[[int], None]]:
    """Evaluate a formula in dense time in the core over n events a variable: an event of all variables."""

    def prepare() -> Callable[[int], None]:
        random = np.random.default_rng(1)
        program = compile_program((desugar(parse_formula(text)),), Fraction(1, 10**9), domain=Dense)
        code = program.to_bytes()
        columns = [
            (np.cumsum(random.integers(1, 2 * 10**8, size=10_000)), random.normal(size=10_000))
            for _ in program.inputs
        ]
        call = core().dense_evaluate

        def run(n: int) -> None:
            for _ in range(n // 10_000):
                call(code, columns)

        return run

    return prepare


#: Each path by its name: how many repetitions are counted, and what prepares it.
PATHS: Mapping[str, tuple[int, Callable[[], Callable[[int], None]]]] = {
    "update(t, a=x, b=y)": (400, keyword_update),
    "update(t, mode='AUTO', p=True)": (400, typed_update),
    "step(x, y)": (400, step),
    "update(t, pairs), paper's API": (400, paper_update),
    "update(t, x=v), dense time": (400, watched_update(time="dense")),
    "update(t, x=v).points(), dense time": (400, dense_points(1)),
    "update(t, x0=v).points(), dense time, 64 signals": (400, dense_points(64)),
    "update(t, x=v), eager": (400, watched_update(verdict="eager")),
    "update(t, x=v), interval at start": (400, watched_update(verdict="interval", at="start")),
    "update(t, x=v), interval at every sample": (400, watched_update(verdict="interval", at="every")),
    "update(t, x=v), interval at every sample, lateness": (
        400,
        watched_update(verdict="interval", at="every", lateness="10s"),
    ),
    "update(t, x=v), interval at every sample, late": (
        400,
        watched_update(verdict="interval", at="every", lateness="10s", shuffled=True),
    ),
    "update_many, 100 samples": (20, update_many),
    "evaluate, 100 samples": (20, evaluate(100)),
    "evaluate, 100 samples with timestamps": (20, evaluate(100, start=0.0)),
    "evaluate, 100 samples at 1 kHz since 1970": (20, evaluate(100, start=1.7e9, period=1e-3)),
    "evaluate, 10000 samples": (4, evaluate(10_000)),
    "evaluate, 100 samples in dense time": (20, dense_evaluate),
    "evaluate(data).satisfied, 100 samples": (20, verdict),
    "Fleet.update_many, 16 keys": (20, fleet_update),
    "evaluate_batch, a trace of 100 samples": (100, evaluate_batch),
    "evaluate_batch, an array, a trace of 100 samples": (1280, evaluate_arrays()),
    "evaluate_batch, an array, Boolean, a trace of 100 samples": (
        1280,
        evaluate_arrays(semantics="boolean"),
    ),
    "parse and monitor": (4, parse_and_monitor(TWO)),
    "parse 900 characters and monitor": (2, parse_and_monitor(LONG)),
    "parse 20 different clauses and monitor": (2, parse_and_monitor(DIFFERENT)),
    "parse 900 characters": (2, parse),
    **{
        f"{CORE} a sample: {text}": (10_000, offline(text))
        for text in (
            "a + b >= -2 and a - b <= 3",
            "always[0:10](a + b >= -2)",
            "always[0:1000](a + b >= -2)",
            "a until[0:100] b",
            "a since[1:100] b",
            "sum[0:100](a) >= b",
        )
    },
    **{
        f"{CORE} dense, an event: {text}": (10_000, dense_offline(text))
        for text in ("a >= 0", "always[0:5](a >= 0)", "a since[0:100] b", "a until[0:100] b")
    },
}
