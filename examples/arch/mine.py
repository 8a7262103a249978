"""Mine the parameters of published templates from simulations of the automatic transmission; prints `mining.md`.

The templates are those of X. Jin, A. Donzé, J. Deshmukh, S. Seshia, "Mining requirements from closed-loop control
models" (HSCC 2013), as the toolbox Breach has them among its examples: the greatest speeds of car and engine, how
long the second gear stays in, and how soon the car is faster than 100 mph while the engine stays slow. The recordings
are ours: full throttle for 20 s and then brakes, as there, and inputs that are drawn at random.

    python examples/arch/mine.py > examples/arch/mining.md
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

import rtamt
import transmission
from rtamt.mining import Mined, directions, mine

if TYPE_CHECKING:
    from collections.abc import Callable

DURATION, EVERY, SEED, RUNS = 50.0, 5.0, 1, 30

#: The ranges of the published scripts; the limits of ARCH-COMP have none.
RANGES = {"vmax": (0, 200), "rpm_max": (0, 6000), "t1": (0, 50), "rpm_min": (0, 6000)}
RESOLUTIONS = {"vmax": 0.1, "rpm_max": 1, "rpm_min": 1, "v": 0.1, "n": 1, "t1": 0.1}

TEMPLATES = (
    (
        "greatest speeds",
        "parameter float vmax = 150  parameter float rpm_max = 5000\n"
        "always(speed < vmax) and always(rpm < rpm_max)",
    ),
    (
        "stay in gear 2",
        "parameter float t1 = 1\n"
        "always(not (gear == 2) and eventually[10ms:20ms](gear == 2)\n"
        "    -> eventually[0:40ms](always[0:t1](gear == 2)))",
    ),
    (
        "100 mph with a slow engine",
        "parameter float t1 = 1  parameter float rpm_min = 4000\n"
        "not (eventually[0:t1](speed > 100) and always(rpm < rpm_min))",
    ),
    ("AT1 of ARCH-COMP", "parameter float v = 120\nalways[0:20](speed < v)"),
    ("AT2 of ARCH-COMP", "parameter float n = 4750\nalways[0:10](rpm < n)"),
)


def recordings() -> dict[str, dict[str, list[float]]]:
    """Return simulations of 50 s: one with full throttle and then brakes, and some with random inputs."""
    found = {"full": transmission.drive(_held([100.0, 0.0], 20.0), _held([0.0, 325.0], 20.0), DURATION)}
    draw = np.random.default_rng(SEED)
    for run in range(RUNS):
        throttle = draw.uniform(0, 100, round(DURATION / EVERY)).tolist()
        brake = np.where(draw.random(round(DURATION / EVERY)) < 0.5, 0, draw.uniform(0, 325)).tolist()
        found[f"random {run + 1}"] = transmission.drive(_held(throttle, EVERY), _held(brake, EVERY), DURATION)
    return found


def _held(values: list[float], every: float) -> Callable[[float], float]:
    """Return an input that holds each value for the same time, and the last one from then on."""
    return lambda time: values[min(int(time / every), len(values) - 1)]


def mined() -> dict[str, Mined]:
    """Return what the recordings give for each template."""
    runs = recordings()
    found = {}
    for name, text in TEMPLATES:
        spec = rtamt.parse(text, period="10ms")
        ranges = {each: RANGES[each] for each in spec.parameters if each in RANGES}
        steps = {each: RESOLUTIONS[each] for each in spec.parameters}
        found[name] = mine(spec, runs, ranges=ranges, resolutions=steps, points=8)
    return found


def table() -> str:
    """Return the report."""
    lines = [
        "# Mined parameters of the automatic transmission",
        "",
        f"From {RUNS + 1} simulations of {DURATION:g} s: `python examples/arch/mine.py`.",
        "",
        "| template | easier values | tight values on every recording | decided by |",
        "|---|---|---|---|",
    ]
    for name, found in mined().items():
        easier = ", ".join(f"{each}: {way}" for each, way in directions(found.specification).items())
        points = "; ".join(
            ", ".join(f"{each} = {value:g}" for each, value in point.values.items()) for point in found.points
        )
        by = dict.fromkeys(by for point in found.points for by in point.violated_by.values())
        lines.append(f"| {name} | {easier} | {points} | {', '.join(by)} |")
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    print(table(), end="")
