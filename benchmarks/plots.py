"""Plot the curves of ``make bench`` as small PNG files with logarithmic axes."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING

import matplotlib as mpl

mpl.use("Agg")
from matplotlib import pyplot as plt

if TYPE_CHECKING:
    from pathlib import Path

    from run import Tool

STYLES = {"this": "-", "this (step)": "-", "this (python)": ":", "RTAMT": "--"}
MARKERS = "osD^vP*X"


def file_of(group: str) -> str:
    """Return the file of a group's plot."""
    return group.replace(":", "").replace(",", "").replace(" ", "_") + ".png"


def draw(folder: Path, running: list[Tool]) -> list[str]:
    """Draw one plot per group of curves; return the names of the files."""
    folder.mkdir(exist_ok=True)
    groups: dict[str, dict[tuple[str, str], list[tuple[int, float]]]] = {}
    for tool in running:
        for case, figures in tool.figures.items():
            if case.workload["kind"] != "normal":
                continue
            offline = case.mode == "offline"
            y = median(figures) * (case.workload["n"] if offline else 1e6)
            curves = groups.setdefault(case.group, {})
            curves.setdefault((case.curve, tool.label), []).append((case.x, y))
    written = []
    for group, curves in groups.items():
        name = file_of(group)
        _draw(folder / name, group, curves)
        written.append(name)
    return written


def _draw(path: Path, group: str, curves: dict[tuple[str, str], list[tuple[int, float]]]) -> None:
    shapes = list(dict.fromkeys(shape for shape, _ in curves))
    labels = list(dict.fromkeys(label for _, label in curves))
    few = len(shapes) <= 2 or "paper" in group
    parts = [shapes] if few else [[shape] for shape in shapes]
    columns = min(len(parts), 3)
    rows = -(-len(parts) // columns)
    size = (7.0, 4.5) if few else (4.2 * columns, 3.3 * rows)
    figure, axes = plt.subplots(rows, columns, figsize=size, squeeze=False, layout="constrained")
    for axis in axes.flat[len(parts) :]:
        axis.axis("off")
    for axis, part in zip(axes.flat, parts, strict=False):
        for (shape, label), points in curves.items():
            if shape not in part:
                continue
            color = f"C{shapes.index(shape) if len(part) > 1 else labels.index(label)}"
            marker = MARKERS[labels.index(label) % len(MARKERS)]
            text = f"{shape}, {label}" if len(part) > 1 else label
            xs, ys = zip(*sorted(points), strict=True)
            axis.loglog(xs, ys, STYLES.get(label, "-."), color=color, marker=marker, markersize=4, label=text)
        axis.set_title(group if few else part[0].replace("{k}", "k"), fontsize=9)
        axis.set_xlabel("samples" if "offline" in group else "window k, samples", fontsize=8)
        axis.set_ylabel("seconds" if "offline" in group else "µs an update", fontsize=8)
        axis.tick_params(labelsize=7)
        axis.grid(visible=True, which="major", alpha=0.3)
        axis.legend(fontsize=6)
    figure.savefig(path, dpi=90)
    plt.close(figure)
