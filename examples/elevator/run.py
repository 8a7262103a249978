"""Sensitivity and falsification of the elevators (the paper's Fig. 12): ``python examples/elevator/run.py``.

Writes ``sensitivity.png`` (16 simulations without a fault) and ``falsification.png`` (the first
hydraulic circuit fails after 2 s) into the folder given as argument, by default ``build/elevator``, and prints
what they show.
"""

from __future__ import annotations

import sys
from pathlib import Path

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
    """Look for a command that an elevator does not follow."""
    return falsify(problem(side, **faults), optimizer="cma", budget=60, seed=seed)


def main(folder: Path) -> None:
    """Draw both pictures, and print the table of the first."""
    folder.mkdir(parents=True, exist_ok=True)
    for side in ("left", "right"):
        landscape = study(side)
        print(f"{side}: robustness over frequency (down) and amplitude (across), no fault")
        amplitudes = landscape.axes["pc.amplitude"]
        print("      " + "".join(f"{amplitude:8.2f}" for amplitude in amplitudes))
        for frequency, row in zip(landscape.axes["pc.frequency"], landscape.robustness, strict=True):
            print(f"{frequency:6.2f}" + "".join(f"{value:8.3f}" for value in row))
        if side == "left":
            landscape.plot().figure.savefig(folder / "sensitivity.png", dpi=120)
    found = search(H1=2.0)
    print(f"left, H1 fails at 2 s: {found}")
    found.plot().figure.savefig(folder / "falsification.png", dpi=120)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else OUT)
