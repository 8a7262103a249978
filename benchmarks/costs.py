"""``make costs``: the cost per sample, offline and online, as medians of repeated runs and ratios to targets.

Figures depend on the machine and its load. Rows are measured in turn, round after round, so that a
drift of the machine's speed affects all of them equally.
"""

from __future__ import annotations

import resource
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from calls import CALLS
from start_up import ENV, compiled

import rtamt
from rtamt.compiler.plan import compile_program
from rtamt.engine.native import core
from rtamt.language.parsing.parser import parse_formula
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.truth import replaced, truth
from rtamt.signals.dense import Dense

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

ROUNDS = 7
WINDOWS = (10, 1_000, 100_000, 1_000_000)


@dataclass
class Row:
    """One figure: ``run`` measures it once, in ``unit``; ``target`` is the upper limit."""

    name: str
    unit: str
    target: float | None
    run: Callable[[], float]
    measured: list[float] = field(default_factory=list)

    @property
    def median(self) -> float:
        """The median of the measurements."""
        return statistics.median(self.measured)


def per(count: int, call: Callable[[], object]) -> float:
    """Return nanoseconds a piece for a call that handles ``count`` pieces."""
    start = time.perf_counter_ns()
    call()
    return (time.perf_counter_ns() - start) / count


def offline(text: str) -> Callable[[], float]:
    """Evaluate a formula over 10^6 samples through the core: ns a sample."""
    n = 1_000_000
    random = np.random.default_rng(1)
    columns = {name: random.normal(size=n) for name in ("a", "b")}
    program = compile_program((desugar(parse_formula(text)),), Fraction(1), clip=n)
    code, inputs = program.to_bytes(), [columns[name] for name in program.inputs]
    return lambda: per(n, lambda: core().evaluate(code, inputs, n))


def offline_face(text: str) -> Callable[[], float]:
    """The same through ``Specification.evaluate``, checks of the data included."""
    n = 1_000_000
    random = np.random.default_rng(1)
    data = {name: random.normal(size=n) for name in ("a", "b")}
    spec = rtamt.parse(text)
    return lambda: per(n, lambda: spec.evaluate(data))


def online_pairs(k: int) -> Callable[[], float]:
    """``update(t, [('a', x), ('b', y)])`` of the paper's API: ns a call."""
    spec = rtamt.StlDiscreteTimeOnlineSpecification()
    spec.declare_var("a", "float")
    spec.declare_var("b", "float")
    spec.spec = f"always[0,{k}](a + b >= -2)"
    spec.parse()
    spec.pastify()
    calls = 20_000
    at = [0]

    def run() -> None:
        first = at[0]
        update = spec.update
        for i in range(first, first + calls):
            update(i, [("a", 1.0), ("b", 2.0)])
        at[0] = first + calls

    return lambda: per(calls, run)


def online_named(k: int) -> Callable[[], float]:
    """``monitor.update(t, a=x, b=y)``: ns a call."""
    monitor = rtamt.parse(f"always[0:{k}](a + b >= -2)").monitor()
    calls = 20_000
    at = [0]

    def run() -> None:
        first = at[0]
        update = monitor.update
        for i in range(first, first + calls):
            update(i, a=1.0, b=2.0)
        at[0] = first + calls

    return lambda: per(calls, run)


def online_typed() -> float:
    """``monitor.update(t, mode="AUTO", p=True)``: ns a call."""
    text = "enum Mode { MANUAL, AUTO = 4 } input Mode mode input bool p always[0:10](p -> mode == AUTO)"
    update = rtamt.parse(text).monitor().update
    calls = 20_000
    at = [0]

    def run() -> None:
        first = at[0]
        for i in range(first, first + calls):
            update(i, mode="AUTO", p=True)
        at[0] = first + calls

    return per(calls, run)


def online_watched() -> float:
    """A step with two formulas watched, and their values asked for: ns for the three."""
    monitor = rtamt.parse("always[0:1000](a + b >= -2)").monitor(watch=("a + b >= -2", "a"))
    calls = 20_000

    def run() -> None:
        for _ in range(calls):
            monitor.step(1.0, 2.0)
            monitor["a + b >= -2"]
            monitor["a"]

    return per(calls, run)


def online_positional(k: int) -> Callable[[], float]:
    """``monitor.step(x, y)``: ns a call."""
    monitor = rtamt.parse(f"always[0:{k}](a + b >= -2)").monitor()
    calls = 20_000

    def run() -> None:
        step = monitor.step
        for _ in range(calls):
            step(1.0, 2.0)

    return lambda: per(calls, run)


def dense_offline(text: str) -> Callable[[], float]:
    """Evaluate a formula over 10^6 events a variable, 100 ms apart on average, through the core: ns an event."""
    n = 1_000_000
    random = np.random.default_rng(1)
    tick = Fraction(1, 10**9)
    program = compile_program((desugar(parse_formula(text)),), tick, domain=Dense)
    code = program.to_bytes()
    columns = [
        (np.cumsum(random.integers(1, 2 * 10**8, size=n)), random.normal(size=n)) for _ in program.inputs
    ]
    return lambda: per(n * len(columns), lambda: core().dense_evaluate(code, columns))


def against_minimum(name: str, window: str) -> Callable[[], float]:
    """Evaluate an aggregate over 10^6 samples, and the minimum of the same window: the ratio."""
    aggregate, minimum = (offline(f"{each}{window}(a) + b >= 0") for each in (name, "minimum"))
    return lambda: aggregate() / minimum()


def dense_online(text: str) -> Callable[[], float]:
    """``monitor.update(t, a=v)`` in dense time, one event an update: ns a call."""
    monitor = rtamt.parse(text).monitor(time="dense")
    for other in monitor.input_names:  # the others hold a value far ahead
        if other != "a":
            monitor.update(1e9, **{other: 1.0})
    calls = 20_000
    at = [0]

    def run() -> float:
        first = at[0]
        at[0] = first + calls
        # The caller's numbers are created before timing starts.
        samples = [(i * 0.1, float(i % 17)) for i in range(first, first + calls)]

        def updates() -> None:
            update = monitor.update
            for t, v in samples:
                update(t, a=v)

        return per(calls, updates)

    return run


#: A conjunction of 1 141 characters, in which no two parts are equal.
LONG = " and ".join(
    f"always[0:{5 + k}]((req{k} >= {k}.5) -> eventually[0:{3 + k}](gnt{k % 5} >= {k}))" for k in range(18)
)


def of_processor(call: Callable[[], object], count: int) -> Callable[[], float]:
    """Call something ``count`` times: ms of processor time a call."""

    def run() -> float:
        start = time.process_time_ns()
        for _ in range(count):
            call()
        return (time.process_time_ns() - start) / count / 1e6

    return run


def of_command(*argv: str) -> Callable[[], float]:
    """Run the command line in a process of its own: seconds of processor time, Python's start included."""

    def run() -> float:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([*ENV, sys.executable, "-m", "rtamt", *argv], check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    return run


def small_check() -> Callable[[], float]:
    """``rtamt check`` of a CSV file of 100 rows."""
    folder = tempfile.TemporaryDirectory()
    spec, trace = Path(folder.name, "limit.stl"), Path(folder.name, "x.csv")
    spec.write_text("always(x <= 4)\n")
    trace.write_text("time,x\n" + "".join(f"{t},{t % 3}\n" for t in range(100)))
    command = of_command("check", str(spec), str(trace))

    def run() -> float:
        assert folder.name, "kept until the last run"
        return command()

    return run


def importing() -> float:
    """``import rtamt`` beyond numpy's own import: seconds."""
    code = "import time, numpy; start = time.perf_counter(); import rtamt; print(time.perf_counter() - start)"
    done = subprocess.run([*ENV, sys.executable, "-c", code], check=True, capture_output=True, text=True)
    return float(done.stdout)


def memory(text: str) -> float:
    """State of an online monitor: doubles a sample of its window of 10^5 samples."""
    program = compile_program((desugar(parse_formula(text)),), Fraction(1))
    return float(core().memory(program.to_bytes())) / 8 / 100_000


def registers(texts: Sequence[str]) -> float:
    """Registers of one program for formulas, while it runs over blocks of samples: KB."""
    program = compile_program(tuple(desugar(parse_formula(text)) for text in texts), Fraction(1))
    rows = {row for _, row in core().layout(program.to_bytes()) if row is not None}
    return len(rows) * 264 * 8 / 1000


def together(texts: Sequence[str]) -> Callable[[], float]:
    """Evaluate formulas in one program over 10^4 samples through the core: ns a formula and sample."""
    n = 10_000
    data = dict(zip("ab", np.random.default_rng(1).normal(size=(2, n)), strict=True))
    program = compile_program(tuple(desugar(parse_formula(text)) for text in texts), Fraction(1), clip=n)
    evaluator, inputs = core().Evaluator(program.code()), [data[name] for name in program.inputs]
    return lambda: per(n * len(texts), lambda: evaluator.run(inputs, n))


def predicate(n: int) -> Callable[[], float]:
    """``evaluate`` of ``a >= 3`` over n samples: ns a sample."""
    data, spec = {"a": np.random.default_rng(1).normal(size=n)}, rtamt.parse("a >= 3")
    return lambda: per(n, lambda: spec.evaluate(data))


def on_two_threads(text: str) -> Callable[[], float]:
    """Evaluate a formula over 4 * 10^6 samples on one thread and on two: how many times as fast two are."""
    n = 4_000_000
    data = dict(zip("ab", np.random.default_rng(1).normal(size=(2, n)), strict=True))
    program = compile_program((desugar(parse_formula(text)),), Fraction(1), clip=n)
    evaluator, inputs = core().Evaluator(program.code()), [data[name] for name in program.inputs]
    one, two = (lambda count=count: evaluator.run(inputs, n, lambda: count) for count in (1, 2))
    return lambda: per(n, one) / per(n, two)


def of_conditions(text: str) -> float:
    """State of an online monitor of conditions: bytes a sample of its window of 10^5 samples."""
    formula = replaced(desugar(parse_formula(text)), truth)
    return float(core().memory(compile_program((formula,), Fraction(1)).to_bytes())) / 100_000


def rows() -> list[Row]:
    """Return everything that is measured."""
    shifted = [f"always[0:20](a >= {i / 100}) and b <= {3 + i / 50}" for i in range(1000)]
    predicates = [" and ".join(f"a >= {i}" if i % 2 else f"b <= {i}" for i in range(20))]
    always = "always[0:{}](a + b >= -2)"
    memories = (
        "always[0:99999](x)",
        "a until[0:99999] b",
        "a until[1:99999] b",
        "a since[1:99999] b",
        "a unless[0:99999] b",
        "a or (b until[0:99999] a)",
    )
    return [
        *(Row(f"offline {always.format(k)}", "ns/sample", 15, offline(always.format(k))) for k in WINDOWS),
        *(Row(f"offline a until[0:{k}] b", "ns/sample", 30, offline(f"a until[0:{k}] b")) for k in WINDOWS),
        *(
            Row(
                f"offline {name}[0:1000](a) to minimum[0:1000](a)",
                "ratio",
                2,
                against_minimum(name, "[0:1000]"),
            )
            for name in ("sum", "mean")
        ),
        Row("1 000 formulas always[0:20](a >= c) and b <= d", "ns/each", 1.17, together(shifted)),
        Row("evaluate a >= 3, 10^6 samples", "ns/sample", 2.0, predicate(10**6)),
        Row("evaluate a >= 3, 10^7 samples", "ns/sample", 4.0, predicate(10**7)),
        Row(
            "two threads, always[0:100](a + b >= -2)",
            "times as fast",
            None,
            on_two_threads(always.format(100)),
        ),
        Row("registers of 20 predicates", "KB", 58, partial(registers, predicates)),
        Row("registers of 1 000 formulas", "KB", 10_000, partial(registers, shifted)),
        *(
            Row(f"memory of conditions, {text}", "bytes/sample", 0.125, partial(of_conditions, text))
            for text in (
                "always[0:99999](a >= 0)",
                "once[99999:99999](a >= 0)",
                "a >= 0 until[0:99999] b >= 0",
            )
        ),
        Row("the first, data checked and copied", "ns/sample", None, offline_face(always.format(10))),
        *(
            Row(f"online update(t, pairs), paper's API, k={k}", "ns/call", 250, online_pairs(k))
            for k in WINDOWS
        ),
        *(Row(f"online update(t, a=x, b=y), k={k}", "ns/call", 250, online_named(k)) for k in WINDOWS),
        Row("online update(t, mode='AUTO', p=True), members and Booleans", "ns/call", 250, online_typed),
        *(Row(f"online step(x, y), k={k}", "ns/call", 150, online_positional(k)) for k in WINDOWS),
        Row("online step(x, y), and two watched formulas read", "ns/call", None, online_watched),
        *(
            Row(f"dense offline {text}", "ns/event", target, dense_offline(text))
            for text, target in (
                ("a >= 0", 30),
                ("always[0:5](a >= 0)", 80),
                ("once[0:5](a >= 0)", 80),
                ("a since[0:100] b", 150),
                ("a until[0:100] b", 150),
            )
        ),
        *(
            Row(f"dense online update(t, a=x), {text}", "ns/call", 600, dense_online(text))
            for text in ("always[0:5](a >= 0)", "always[0:1000](a >= 0)", "b until[0:100] a")
        ),
        *(Row(name, unit, target, prepare()) for name, unit, target, prepare in CALLS),
        *(Row(f"memory {text}", "doubles/sample", 2.5, partial(memory, text)) for text in memories),
        *(
            Row(f"parse {name}", "ms", target, of_processor(partial(rtamt.parse, text), count))
            for name, text, target, count in (
                ("a >= 3", "a >= 3", None, 500),
                ("always[0:5](a >= 3)", "always[0:5](a >= 3)", None, 500),
                ("1 100 characters", LONG, 0.5, 50),
            )
        ),
        Row(
            "parse 1 100 characters and monitor",
            "ms",
            1,
            of_processor(lambda: rtamt.parse(LONG).monitor(), 20),
        ),
        Row("rtamt --help", "s of CPU", 0.1, of_command("--help")),
        Row("rtamt lint", "s of CPU", 0.1, of_command("lint", "examples/request_grant/spec.stl")),
        Row("rtamt check of a CSV file of 100 rows", "s of CPU", 0.2, small_check()),
        Row("import rtamt beyond numpy", "s", 0.02, importing),
    ]


def main() -> None:
    """Measure every row in turn, several rounds, and print the table."""
    compiled(sys.executable)
    table = rows()
    for number in range(ROUNDS + 1):
        print(f"round {number} of {ROUNDS}", end="\r", file=sys.stderr, flush=True)
        for row in table:
            value = row.run()
            if number:  # the first round warms up
                row.measured.append(value)
    print(f"{'':46} {'median':>9} {'min':>9} {'max':>9}  {'unit':14} {'target':>7} {'of target':>9}")
    for row in table:
        ratio = "" if row.target is None else f"{row.median / row.target:9.2f}"
        print(
            f"{row.name:46} {row.median:9.3g} {min(row.measured):9.3g} {max(row.measured):9.3g}"
            f"  {row.unit:14} {row.target or '':>7} {ratio}"
        )


if __name__ == "__main__":
    main()
