"""Plot learning curves that ``train.py`` wrote: ``python plot.py curves.csv curves.png``."""

from __future__ import annotations

import csv
import sys
from collections import defaultdict

from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

COLORS = {"own reward": "#6b7280", "with shaping": "#0072b2", "interval as reward": "#d55e00"}


def main() -> None:
    """Draw a curve for each seed, and the mean of each variant."""
    curves: dict[str, dict[str, list[tuple[int, float]]]] = defaultdict(lambda: defaultdict(list))
    with open(sys.argv[1], encoding="utf-8") as file:
        for row in csv.DictReader(file):
            curves[row["variant"]][row["seed"]].append((int(row["steps"]), float(row["satisfied"])))
    figure = Figure(figsize=(9, 3), layout="constrained")
    for axes, (variant, seeds) in zip(
        figure.subplots(1, len(curves), sharey=True), curves.items(), strict=True
    ):
        color = COLORS[variant]
        for points in seeds.values():
            axes.plot(*zip(*points, strict=True), color=color, linewidth=0.8, alpha=0.5)
        columns = list(zip(*seeds.values(), strict=True))
        means = [(points[0][0], sum(share for _, share in points) / len(points)) for points in columns]
        axes.plot(*zip(*means, strict=True), color=color, linewidth=2.4)
        axes.set(title=f"{variant}: {len(seeds)} seeds, mean", xlabel="steps", ylim=(-0.03, 1.03))
        axes.yaxis.set_major_formatter(PercentFormatter(1.0))
        axes.spines[["top", "right"]].set_visible(False)
    figure.axes[0].set_ylabel("requirement satisfied")
    figure.savefig(sys.argv[2], dpi=110)


if __name__ == "__main__":
    main()
