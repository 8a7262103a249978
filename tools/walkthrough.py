"""Draw docs/images/early.gif: bounds and verdicts of a formula while its samples arrive (`make images`)."""

from __future__ import annotations

from io import BytesIO
from math import nan
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from PIL import Image

import rtamt
from rtamt.plot import style

if TYPE_CHECKING:
    from pathlib import Path

FORMULA = "req >= 3 -> eventually[0:4](gnt >= 3)"
REQ = [0, 1, 5, 2, 0, 0, 1, 6, 4, 1, 0, 0, 0, 0]
GNT = [0, 0, 1, 2, 4, 3, 1, 0, 0, 1, 2, 1, 0, 0]
RANGES = {"req": (0, 6), "gnt": (0, 6)}
#: Milliseconds that an image stays, and the last one.
PACE, REST = 900, 3500
EDGE = 4.0


def draw(path: Path) -> None:
    """Write the animation."""
    spec = rtamt.parse(FORMULA)
    monitor = spec.monitor(verdict="interval", ranges=RANGES)
    known: dict[int, rtamt.Interval] = {}
    frames = []
    for now in range(len(REQ)):
        monitor.update(now, req=REQ[now], gnt=GNT[now])
        for change in monitor.changes():
            for t in range(int(change.begin), int(change.end) + 1):
                known[t] = change.interval
        frames.append(frame(now, known))
    images = [image.convert("P", palette=Image.Palette.ADAPTIVE, colors=64) for image in frames]
    durations = [PACE] * (len(images) - 1) + [REST]
    images[0].save(path, save_all=True, append_images=images[1:], duration=durations, loop=0, optimize=True)


def frame(now: int, known: dict[int, rtamt.Interval]) -> Image.Image:
    """Return the image after the sample at ``now``."""
    figure = Figure(figsize=(7.2, 4.2), facecolor="white")
    top, below = figure.subplots(2, 1, sharex=True, height_ratios=(1, 1.3))
    for axis in (top, below):
        axis.set_xlim(-0.5, len(REQ) - 0.5)
        for side in ("top", "right"):
            axis.spines[side].set_visible(False)
        axis.tick_params(labelsize=8, colors=style.QUIET)
        axis.axvline(now, color=style.INK, linewidth=0.8, linestyle=":")
    times = range(now + 1)
    for name, values, color in (("req", REQ, style.SIGNALS[0]), ("gnt", GNT, style.SIGNALS[1])):
        top.plot(times, values[: now + 1], "o-", color=color, markersize=4, linewidth=1.4, label=name)
    top.axhline(3, color=style.QUIET, linewidth=0.8, linestyle=(0, (5, 3)))
    top.set_ylim(-0.5, 6.5)
    top.legend(loc="upper right", fontsize=8, frameon=False, ncols=2)
    below.axhline(0, color=style.QUIET, linewidth=0.9)
    below.set_ylim(-EDGE, EDGE)
    line = []
    for t in times:
        each = known[t]
        color = style.HOLDS if each.lower > 0 else style.FAILS if each.upper < 0 else style.QUIET
        line.append(each.lower if each.lower == each.upper else nan)
        if each.lower != each.upper:
            below.bar(t, each.upper - each.lower, 0.8, each.lower, color=color, alpha=0.35)
        below.annotate(
            "✓" if each.lower > 0 else "✗" if each.upper < 0 else "?",
            (t, -EDGE + 0.3),
            color=color,
            ha="center",
            fontsize=9,
            fontweight="bold",
        )
    below.plot(times, line, "o-", color=style.INK, markersize=4, linewidth=1.4)
    below.set_ylabel("robustness", fontsize=8, color=style.QUIET)
    below.set_xlabel("time [s]", fontsize=8, color=style.QUIET)
    top.set_title(f"{FORMULA}      after the sample at {now} s", loc="left", fontsize=9, family="monospace")
    figure.tight_layout()
    store = BytesIO()
    figure.savefig(store, dpi=90)
    return Image.open(store).convert("RGB")
