"""The figures of the report: each function draws one file from what experiments.py printed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

from experiments import PEAKS, RECORDINGS, response

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes

COLORS = {"this library": "#1f77b4", "RTAMT": "#ff7f0e"}
STYLES = ("-", "--", "-.", ":")


def draw_all(found: dict[str, dict[str, Any]], folder: Path) -> None:
    """Draw every figure into a folder."""
    responses(found["this library"]["figure 1"]).savefig(folder / "pid.png", dpi=150)
    operators(found["this library"]["figure 2"]).savefig(folder / "operators.png", dpi=150)
    interface(found["this library"]["figure 4"]).savefig(folder / "interface.png", dpi=150)
    scaling(found).savefig(folder / "scaling.png", dpi=150)
    windows(found).savefig(folder / "windows.png", dpi=150)


def responses(robustness: dict[str, float]) -> Figure:
    """Draw two behaviours of a controller against f <= 1.1."""
    figure = Figure(figsize=(9, 3), layout="constrained")
    for axes, (name, peak) in zip(figure.subplots(1, 2, sharey=True), PEAKS.items(), strict=True):
        values = response(peak)
        axes.plot([i * 0.05 for i in range(len(values))], values, color=COLORS["this library"])
        axes.axhline(1.1, color="#cc0000", lw=0.9, ls="--")
        axes.set_title(f"{name}, robustness {robustness[name]:+.3f}")
        axes.set_xlabel("time [s]")
    figure.axes[0].set_ylabel("f")
    return figure


def operators(signals: dict[str, list[Any]]) -> Figure:
    """Draw a Boolean signal, and what two windows make of it."""
    figure = Figure(figsize=(7, 3.4), layout="constrained")
    rows = figure.subplots(len(signals), 1, sharex=True)
    for axes, (name, values) in zip(rows, signals.items(), strict=True):
        holds = [float(value) > 0 for value in values]
        axes.step(range(len(holds)), holds, where="mid", marker=".", color=COLORS["this library"])
        axes.set_yticks([0, 1], ["false", "true"])
        axes.set_ylim(-0.3, 1.3)
        axes.set_title(name, loc="left", fontsize=9)
    figure.axes[-1].set_xlabel("time [s]")
    return figure


def interface(measures: dict[str, dict[str, Any]]) -> Figure:
    """Draw the four recordings of requests and grants, each with its measures."""
    figure = Figure(figsize=(10, 5), layout="constrained")
    for axes, (name, (req, gnt)) in zip(figure.subplots(2, 2).flat, RECORDINGS.items(), strict=True):
        axes.step(range(len(req)), req, where="post", label="req", color="#d62728")
        axes.step(range(len(gnt)), gnt, where="post", label="gnt", color="#2ca02c", ls="--")
        axes.axhline(3, color="#777777", lw=0.8, ls=":")
        label = ", ".join(f"{measure} {float(value):g}" for measure, value in measures[name].items())
        axes.set_title(f"({name}) {label}", fontsize=9)
        axes.set_ylim(-0.3, 6.6)
    figure.axes[-1].legend(*figure.axes[0].get_legend_handles_labels(), loc="upper right")
    return figure


def scaling(found: dict[str, dict[str, Any]]) -> Figure:
    """Draw offline monitors: time over samples, a line a formula and tool."""
    figure = Figure(figsize=(9, 3.6), layout="constrained")
    for axes, domain in zip(figure.subplots(1, 2, sharey=True), ("discrete", "dense"), strict=True):
        for tool, values in found.items():
            if isinstance(values["scaling"], dict):
                _lines(axes, domain, tool, values["scaling"])
        axes.set_title(f"{domain} time")
        axes.set_xlabel("samples")
    figure.axes[0].set_ylabel("seconds")
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside right upper", fontsize=7)
    return figure


def _lines(axes: Axes, domain: str, tool: str, took: dict[str, float]) -> None:
    lines: dict[str, list[tuple[int, float]]] = {}
    for name, seconds in took.items():
        kind, formula, size = name.split()
        if kind == domain:
            lines.setdefault(formula, []).append((int(size), seconds))
    for style, (formula, points) in zip(STYLES, lines.items(), strict=True):
        label = f"{formula}, {tool}"
        axes.loglog(*zip(*points, strict=True), style, color=COLORS[tool], marker=".", label=label)


def windows(found: dict[str, dict[str, Any]]) -> Figure:
    """Draw online monitors: time a sample over the bound."""
    figure = Figure(figsize=(5, 3.4), layout="constrained")
    axes = figure.subplots()
    for tool, values in found.items():
        if isinstance(values["windows"], dict):
            bounds, seconds = [int(k) for k in values["windows"]], list(values["windows"].values())
            axes.loglog(bounds, seconds, marker="o", color=COLORS[tool], label=tool)
    axes.set_xlabel("k")
    axes.set_ylabel("seconds a sample")
    axes.legend()
    return figure
