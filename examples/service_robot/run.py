"""Drive the robot once, or, with --table, many times: which component's specification falls first?"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from controller import Controller
from faults import FAULTS, draw
from monitors import COMPONENTS, NAMES, Monitors
from perception import Perception
from planner import Planner
from sim import PERIOD, World

if TYPE_CHECKING:
    import numpy as np

    from faults import Fault
    from sim import State

DURATION = 60.0  # s
SEEDS = range(20)


@dataclass(frozen=True)
class Moment:
    """The scene at a time (s): what is true, what is perceived, and the waypoints ahead."""

    time: float
    truth: State
    view: State
    waypoints: np.ndarray


@dataclass(frozen=True)
class Run:
    """A drive: its fault, its scene, moment by moment, and its monitors."""

    fault: Fault | None
    goal: np.ndarray
    moments: list[Moment]
    monitors: Monitors


def drive(component: str | None, seed: int, duration: float = DURATION) -> Run:
    """Drive for a while (s), with a fault in a component or without."""
    fault = draw(component, seed)
    world = World(seed, fault)
    perception = Perception(seed, fault)
    planner = Planner(world.goal, perception.obstacles, perception.regions, seed, fault)
    controller = Controller(world.start, fault)
    monitors = Monitors()
    moments = []
    for _ in range(round(duration / PERIOD) + 1):
        time, truth = world.time, world.truth
        view = perception.observe(time, truth)
        plan = planner.plan(time, view, controller.reference)
        command = controller.follow(time, view, plan)
        signals = world.signals() | perception.signals(truth, view)
        monitors.update(time, signals | planner.signals(view) | controller.signals())
        moments.append(Moment(time, truth, view, plan.waypoints))
        world.step(command)
    return Run(fault, world.goal, moments, monitors)


def summary(run: Run) -> str:
    """Return what happened in a drive."""
    fault, monitors = run.fault, run.monitors
    lines = [f"fault: {fault.component}, {fault.kind}, at {fault.onset:.1f} s" if fault else "fault: none"]
    for name in NAMES:
        fell = monitors.fell(name)
        least = min(value for value in monitors.robustness[name] if value is not None)
        lines.append(
            f"{name + ':':12} least robustness {least:6.3f}, "
            + ("satisfied" if fell is None else f"violated at {fell:.1f} s")
        )
    lines.append(f"violated first: {monitors.culprit() or 'none'}")
    return "\n".join(lines)


def table() -> bool:
    """Drive every seed without a fault and with each, print the table; return whether every answer is right."""
    print("| fault in | runs | none | perception | planner | controller | system violated | earlier by (s) |")
    print("|---|---|---|---|---|---|---|---|")
    rows = [_row(component) for component in (None, *FAULTS)]
    return all(rows)


def _row(component: str | None) -> bool:
    named: list[str | None] = []
    falls = 0  # of the system
    earlier = []  # s, by which a component fell before the system
    for seed in SEEDS:
        monitors = drive(component, seed).monitors
        named.append(monitors.culprit())
        system = monitors.fell("system")
        first = monitors.fell(named[-1]) if named[-1] else None
        falls += system is not None
        if system is not None and first is not None:
            earlier.append(system - first)
    counts = " | ".join(str(named.count(name)) for name in (None, *COMPONENTS))
    span = f"{min(earlier):.1f} to {max(earlier):.1f}" if earlier else ""
    print(f"| {component or 'none'} | {len(named)} | {counts} | {falls} | {span} |", flush=True)
    return all(name == component for name in named) and not (component is None and falls)


def main() -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fault", choices=FAULTS, help="the component that has a fault (default: none)")
    parser.add_argument("--seed", type=int, default=0, help="of everything random (default: 0)")
    parser.add_argument("--table", action="store_true", help="20 seeds, healthy and with each fault")
    parser.add_argument(
        "--plots", type=Path, metavar="FOLDER", help="draw robustness and scene; needs matplotlib"
    )
    arguments = parser.parse_args()
    if arguments.table:
        return 0 if table() else 1
    run = drive(arguments.fault, arguments.seed)
    print(summary(run))
    if arguments.plots:
        import plot

        healthy = drive(None, arguments.seed)
        for path in plot.draw(healthy, run, arguments.plots):
            print(path)
    return 0


if __name__ == "__main__":
    sys.exit(main())
