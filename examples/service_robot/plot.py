"""Plots of a drive: the four robustness signals, healthy and faulty, and the scene, in stills and moving."""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from matplotlib import animation
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from monitors import COMPONENTS, NAMES
from sim import OBSTACLES, PERSON, RADIUS, REGIONS, ROOM

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from matplotlib.axes import Axes

    from run import Moment, Run

COLOURS = {"system": "#222222", "perception": "#0072b2", "planner": "#d55e00", "controller": "#009e73"}
FLOOR = -0.5  # m: robustness below it is drawn at the edge, so that the others can be seen
STILLS = 4
EVERY = 10  # moments, from frame to frame of the animation


def draw(healthy: Run, run: Run, folder: Path) -> list[Path]:
    """Write the plots of a drive, and of the healthy one beside it; return their files."""
    folder.mkdir(parents=True, exist_ok=True)
    with mpl.rc_context({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}):
        paths = [folder / "robustness.png", folder / "scene.png", folder / "scene.gif"]
        _robustness(healthy, run).savefig(paths[0], dpi=130)
        _stills(run).savefig(paths[1], dpi=130)
        _moving(run, paths[2])
    return paths


def _title(run: Run) -> str:
    if run.fault is None:
        return "healthy"
    return f"{run.fault.component} fault: {run.fault.kind}"


# ---- robustness ----------------------------------------------------------------------------------


def _robustness(healthy: Run, run: Run) -> Figure:
    """Return the four signals over time, as the paper's Fig. 11 shows them."""
    runs = [healthy] if run.fault is None else [healthy, run]
    figure = Figure(figsize=(5.5 * len(runs), 6.2), layout="constrained")
    axes = figure.subplots(len(NAMES), len(runs), sharex=True, sharey="row", squeeze=False)
    for column, one in enumerate(runs):
        axes[0, column].set_title(_title(one))
        axes[-1, column].set_xlabel("time (s)")
        for row, name in enumerate(NAMES):
            _signal(axes[row, column], one, name)
    for row, name in enumerate(NAMES):
        axes[row, 0].set_ylabel(f"{name}\nrobustness (m)")
        shown = np.concatenate([_values(run, name) for run in runs])
        low, high = min(-0.05, np.nanmin(shown)), max(0.1, np.nanmax(shown))
        axes[row, 0].set_ylim(low - 0.05 * (high - low), high + 0.1 * (high - low))
    return figure


def _values(run: Run, name: str) -> np.ndarray:
    values = [np.nan if value is None else value for value in run.monitors.robustness[name]]
    return np.maximum(values, FLOOR)


def _signal(axes: Axes, run: Run, name: str) -> None:
    times = run.monitors.times
    axes.axhspan(2 * FLOOR, 0.0, color="#cc0000", alpha=0.07, lw=0)
    axes.axhline(0.0, color="#cc0000", lw=0.8)
    axes.plot(times, _values(run, name), color=COLOURS[name], lw=1.5)
    axes.set_xlim(0.0, times[-1])
    if run.fault is not None:
        axes.axvline(run.fault.onset, color="grey", lw=0.8, ls=":")
        if name == NAMES[0]:
            axes.annotate(
                "fault begins", (run.fault.onset, 1.0), xycoords=("data", "axes fraction"), ha="center",
                va="bottom", color="grey", fontsize=8, annotation_clip=False,
            )  # fmt: skip
    fell = run.monitors.fell(name)
    if fell is None:
        return
    axes.axvline(fell, color="#cc0000", lw=0.8, ls="--")
    first = name in COMPONENTS and run.monitors.culprit() == name
    axes.annotate(
        f"violated at {fell:.1f} s" + (": the first component to fall" if first else ""),
        (fell, 0.9), xytext=(4, 0), xycoords=("data", "axes fraction"), textcoords="offset points",
        color="#cc0000", va="top", fontsize=8, weight="bold" if first else "normal",
        bbox={"fc": "white", "alpha": 0.8, "lw": 0, "pad": 1},
    )  # fmt: skip


# ---- scene ---------------------------------------------------------------------------------------


def _stills(run: Run) -> Figure:
    """Return the scene at four instants: the start, what fell, the end."""
    figure = Figure(figsize=(11.0, 6.6), layout="constrained")
    figure.suptitle(_title(run))
    for axes, moment in zip(figure.subplots(2, 2).flat, _instants(run), strict=True):
        _scene(axes, run, moment)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=6, frameon=False)
    return figure


def _instants(run: Run) -> Sequence[Moment]:
    """Return the moments worth a still."""
    end = run.moments[-1].time
    wanted = {end} if run.fault is None else {run.fault.onset, end}
    wanted |= {
        fell for name in ("system", run.monitors.culprit()) if name and (fell := run.monitors.fell(name))
    }
    for spare in (0.5, 0.25, 0.75, 0.1):
        if len(wanted) < STILLS:
            wanted.add(round(spare * end, 1))
    return [min(run.moments, key=lambda moment: abs(moment.time - time)) for time in sorted(wanted)]


def _scene(axes: Axes, run: Run, moment: Moment) -> None:
    """Draw what is true, and over it what the robot believes."""
    for left, bottom, right, top in REGIONS:
        axes.add_patch(
            Rectangle(
                (left, bottom), right - left, top - bottom, fc="#f6d5d5", ec="#cc0000", hatch="///", lw=0.5
            )
        )
    for left, bottom, right, top in OBSTACLES:
        axes.add_patch(Rectangle((left, bottom), right - left, top - bottom, fc="#8c7b6b", lw=0))
    axes.text(5.7, 3.0, "desk", ha="center", va="center", color="white")
    trail = np.array([past.truth.position for past in run.moments if past.time <= moment.time])
    axes.plot(*trail.T, color="#0072b2", lw=1.2, label="driven")
    axes.plot(*moment.waypoints.T, color="#d55e00", lw=1.2, ls="--", label="waypoints ahead")
    axes.plot(*run.goal, marker="*", color="#d55e00", ms=10, ls="none", label="goal")
    for k, centre in enumerate(moment.truth.agents):
        axes.add_patch(Circle(centre, PERSON, color="#777777", lw=0, label=None if k else "agents"))
    axes.add_patch(Circle(moment.truth.position, RADIUS, color="#0072b2", lw=0, label="robot, in truth"))
    axes.add_patch(
        Circle(moment.view.position, RADIUS, fc="none", ec="black", lw=1.0, label="robot, as perceived")
    )
    axes.set(xlim=(-0.2, ROOM[0] + 0.2), ylim=(-0.2, ROOM[1] + 0.2), aspect="equal")
    axes.spines[:].set_visible(False)
    axes.set_xticks([])
    axes.set_yticks([])
    fallen = [name for name in NAMES if (fell := run.monitors.fell(name)) is not None and fell <= moment.time]
    axes.set_title(
        f"{moment.time:.1f} s" + (f"   violated: {', '.join(fallen)}" if fallen else ""),
        loc="left", color="#cc0000" if fallen else "black", fontsize=9,
    )  # fmt: skip


def _moving(run: Run, path: Path) -> None:
    figure = Figure(figsize=(6.4, 3.6))
    axes = figure.add_axes((0.01, 0.01, 0.98, 0.91))

    def frame(moment: Moment) -> list[object]:
        axes.clear()
        _scene(axes, run, moment)
        return []

    shown = run.moments[::EVERY]
    animation.FuncAnimation(figure, frame, frames=shown, cache_frame_data=False).save(
        path, writer=animation.PillowWriter(fps=8), dpi=70
    )


__all__ = ["draw"]
