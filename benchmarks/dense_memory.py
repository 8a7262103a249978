"""10^8 events through dense online monitors, chunk by chunk: memory is that of the windows, and stays flat."""

from __future__ import annotations

import resource
import sys
import time
from fractions import Fraction

import numpy as np

from rtamt.compiler.plan import compile_program
from rtamt.engine.native import core
from rtamt.language.parsing.parser import parse_formula
from rtamt.rewrite.desugar import desugar
from rtamt.signals.dense import Dense

CHUNK = 100_000
EVENTS = 100_000_000
FORMULAS = ("always[0:5](x >= 0)", "x since[0:100] y", "x until[0:100] y")


def peak() -> float:
    """Return the largest memory of this process so far, in MiB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def main() -> None:
    """Run every formula over the same events, and print state and memory after each power of ten."""
    events = int(float(sys.argv[1])) if len(sys.argv) > 1 else EVENTS
    for text in FORMULAS:
        program = compile_program((desugar(parse_formula(text)),), Fraction(1, 10**9), domain=Dense)
        monitor = core().DenseMonitor(program.to_bytes(), list(program.inputs))
        random = np.random.default_rng(1)
        gaps, values = random.integers(1, 2 * 10**8, size=CHUNK), random.normal(size=CHUNK)
        last, done, mark, spent = 0, 0, 10**6, 0.0
        while done < events:
            times = last + np.cumsum(gaps)
            last = int(times[-1])
            start = time.perf_counter()
            monitor.push([(times, values)] * len(program.inputs))
            spent += time.perf_counter() - start
            done += CHUNK
            if done >= mark:
                per_event = spent / done / len(program.inputs) * 1e9
                print(
                    f"{text:22} {done:11,} events: {per_event:5.1f} ns an event, "
                    f"state {monitor.state_bytes:9,} bytes, peak of the process {peak():6.1f} MiB"
                )
                mark *= 10


if __name__ == "__main__":
    main()
