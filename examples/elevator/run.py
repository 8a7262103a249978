"""Sensitivity and falsification of the elevators (the paper's Fig. 12): ``python examples/elevator/run.py``.

Writes ``sensitivity.png`` (16 simulations without a fault, and 16 in which the first hydraulic circuit fails
after 2 s) and ``falsification.png`` (with that fault) into the folder given as argument, by default
``build/elevator``, and prints what they show.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt

import rtamt
from elevator import Elevators
from rtamt.search import Falsification, Problem, Pulse, Range, Sensitivity, falsify, sensitivity

HERE = Path(__file__).parent
OUT = HERE.parents[1] / "build" / "elevator"
DURATION = 10
STEPS = Pulse(frequency=Range(0.2, 1), amplitude=Range(1, 1.75), delay=0.5)


def problem(side: str, **faults: float) -> Problem:
    """Return the requirement on a side ("left" or "right") for a system with these faults."""
    spec = rtamt.load(HERE / f"{side}.stl", period="20ms", semantics="output_robustness")
    return Problem(spec, Elevators(DURATION, faults), {"pc": STEPS}, DURATION)


def study(side: str = "left", **faults: float) -> Sensitivity:
    """Return the robustness at the 16 points of the paper."""
    return sensitivity(problem(side, **faults), grid={"pc.frequency": 4, "pc.amplitude": 4})


def search(side: str = "left", *, seed: int = 1, **faults: float) -> Falsification:
    """Look for commands that an elevator does not follow, also after the first one: the plot shows them all."""
    return falsify(problem(side, **faults), optimizer="cma", budget=60, seed=seed, stop=False)


def table(landscape: Sensitivity) -> str:
    """Return the robustness over frequency (down) and amplitude (across)."""
    lines = ["      " + "".join(f"{amplitude:8.2f}" for amplitude in landscape.axes["pc.amplitude"])]
    for frequency, row in zip(landscape.axes["pc.frequency"], landscape.robustness, strict=True):
        lines.append(f"{frequency:6.2f}" + "".join(f"{value:8.3f}" for value in row))
    return "\n".join(lines)


def main(folder: Path) -> None:
    """Draw both plots, and print their data."""
    folder.mkdir(parents=True, exist_ok=True)
    figure, pair = plt.subplots(1, 2, figsize=(12, 4.8), layout="constrained")
    for axes, (what, faults) in zip(
        pair, {"no fault": {}, "H1 fails at 2 s": {"H1": 2.0}}.items(), strict=True
    ):
        landscape = study(**faults)
        print(f"left, {what}: robustness over frequency (down) and amplitude (across)\n{table(landscape)}")
        landscape.plot(axes).set(title=f"left elevator, {what}", xlabel="frequency (Hz)", ylabel="amplitude")
    figure.savefig(folder / "sensitivity.png", dpi=120)
    print(
        f"right, no fault: robustness over frequency (down) and amplitude (across)\n{table(study('right'))}"
    )
    found = search(H1=2.0)
    print(f"left, H1 fails at 2 s: {found}")
    axes = found.plot()
    axes.set(title="left elevator, H1 fails at 2 s: the search with CMA-ES")
    axes.figure.savefig(folder / "falsification.png", dpi=120)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else OUT)
