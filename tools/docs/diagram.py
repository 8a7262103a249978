"""The plot of an operator: two signals, and below them the robustness of the operator's example."""

from __future__ import annotations

import io

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

import rtamt

SIGNALS = {
    "x": np.array([4, 5, 2, 1, 4, 6, 6, 4, 5, 4, 4, 1, 0.5, 2, 5, 5, 4, 1, 1, 4.0]),
    "y": np.array([1, 1, 1, 5, 5, 1, 1, 2, 5, 4, 1, 1, 4, 4, 4, 1, 1, 5, 5, 2.0]),
}
TIME = np.arange(20)
COLORS = {"x": "#1f77b4", "y": "#ff7f0e"}
GREY = "#808080"  # can be read on white and on black


def of(example: str) -> str:
    """Return the plot as transparent SVG, for light and dark pages."""
    spec = rtamt.parse(example)
    read = {name: values for name, values in SIGNALS.items() if name in spec.input_names}
    rho = spec.evaluate({"time": TIME, **read}).signal.values
    figure = Figure(figsize=(7, 2.6), layout="constrained")
    figure.patch.set_alpha(0)
    signals, robustness = figure.subplots(2, 1, sharex=True)
    for name, values in read.items():
        signals.plot(TIME, values, color=COLORS[name], drawstyle="steps-post", marker=".", label=name)
    if read:
        signals.legend(loc="lower right", bbox_to_anchor=(1, 0.97), ncols=2, frameon=False, labelcolor=GREY)
    shown = np.clip(rho, *_limits(rho))
    robustness.axhline(0, color=GREY, linewidth=0.8)
    for holds, color in ((rho > 0, "#2ca02c"), (rho < 0, "#d62728"), (rho == 0, GREY)):
        robustness.vlines(TIME[holds], 0, shown[holds], color=color, linewidth=2)
        robustness.plot(TIME[holds], shown[holds], linestyle="", marker="o", color=color, markersize=4)
    for at in np.flatnonzero(np.isinf(rho)):
        robustness.annotate("∞" if rho[at] > 0 else "-∞", (TIME[at], shown[at]), color=GREY, fontsize=7,
                            xytext=(0, 4 if rho[at] > 0 else -9), textcoords="offset points", ha="center")  # fmt: skip
    signals.set_ylabel("signals", color=GREY)
    robustness.set_ylabel("robustness", color=GREY)
    robustness.set_xlabel("s", color=GREY)
    robustness.margins(y=0.25)
    for axes in (signals, robustness):
        axes.patch.set_alpha(0)
        axes.tick_params(colors=GREY)
        axes.set_xticks(TIME[::2])
        for side in axes.spines.values():
            side.set_color(GREY)
    out = io.StringIO()
    with mpl.rc_context({"svg.hashsalt": "rtamt"}):
        figure.savefig(out, format="svg", metadata={"Date": None})
    return out.getvalue()


def _limits(rho: np.ndarray) -> tuple[float, float]:
    finite = rho[np.isfinite(rho)]
    low, high = (min(0, finite.min()), max(0, finite.max())) if len(finite) else (0, 0)
    return low - 1, high + 1
