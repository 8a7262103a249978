"""Draw the signal patterns: of each a trace that satisfies it and one that violates it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

import rtamt

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from matplotlib.axes import Axes

    Trace = Sequence[float]


@dataclass(frozen=True)
class Example:
    """A use of a pattern and two traces of it, one sample a second; p holds at the instant ``begin``.

    ``levels``: the numbers that the plot shows as horizontal lines.
    """

    call: str
    satisfied: Trace
    violated: Trace
    levels: Sequence[float] = ()

    def __str__(self) -> str:
        return self.name

    @property
    def name(self) -> str:
        """The name of the pattern."""
        return self.call.partition("(")[0]


#: When p holds in all examples.
BEGIN = 2

GROUPS: Mapping[str, Sequence[Example]] = {
    "assertions": [
        Example(
            "stays(x, 1, 5)",
            [2, 3, 4, 4.5, 4, 3, 2, 1.5, 2, 3, 4, 4.5, 4, 3, 2, 2],
            [2, 3, 4, 4.5, 4, 3, 2, 0.5, 2, 3, 4, 5.5, 4, 3, 2, 2],
            (1, 5),
        ),
        Example(
            "constant(x, 1, 4s)",
            [3, 3.4, 3.1, 3.5, 3.2, 3.7, 3.9, 4.1, 3.9, 4.3, 4.1, 4.4, 4.2, 4.6, 4.4, 4.5],
            [3, 3.4, 3.1, 3.5, 3.2, 3.7, 4.3, 4.9, 5.1, 5.3, 5.1, 5.4, 5.2, 5.6, 5.4, 5.5],
        ),
        Example(
            "increases(p, x, 8s)",
            [3, 2, 1, 1, 2, 2, 3, 3.5, 4, 5, 5, 4, 3, 3, 2, 1],
            [3, 2, 1, 1, 2, 2, 3, 2.5, 4, 5, 5, 4, 3, 3, 2, 1],
        ),
        Example(
            "decreases(p, x, 8s)",
            [3, 4, 5, 5, 4, 4, 3, 2.5, 2, 1, 1, 2, 3, 3, 4, 5],
            [3, 4, 5, 5, 4, 4, 3, 3.5, 2, 1, 1, 2, 3, 3, 4, 5],
        ),
        Example(
            "bounded_rate(x, 1, 2s)",
            [1, 1, 2, 3, 3.5, 4, 4, 4.5, 5, 4, 3, 2.5, 2, 2, 1.5, 1],
            [1, 1, 2, 3, 3.5, 4, 4, 4.5, 5, 3, 1.5, 1.5, 2, 2, 1.5, 1],
        ),
    ],
    "spikes": [
        Example(
            "spike(x, amplitude=2, width=3s)",
            [1, 1.2, 1, 1.1, 1, 1.3, 4, 3.5, 1.2, 1, 1.1, 1, 1.2, 1, 1, 1.1],
            [1, 1.2, 1, 1.1, 1, 1.3, 4, 4.1, 3.8, 4, 3.9, 1.2, 1.1, 1, 1, 1.1],
        ),
        Example(
            "no_spike(x, amplitude=2, width=3s)",
            [1, 1.2, 1, 1.1, 1, 1.3, 2.5, 2, 1.2, 1, 1.1, 1, 1.2, 1, 1, 1.1],
            [1, 1.2, 1, 1.1, 1, 1.3, 4, 3.5, 1.2, 1, 1.1, 1, 1.2, 1, 1, 1.1],
        ),
    ],
    "oscillations": [
        Example(
            "oscillates(x, level=3, amplitude=1, times=3, window=12s)",
            [3, 1, 3, 5, 3, 1, 3, 5, 3, 1, 3, 5, 3, 3, 3, 3],
            [3, 1, 3, 5, 3, 2.5, 3, 3.5, 3, 1, 3, 5, 3, 3, 3, 3],
            (2, 4),
        ),
        Example(
            "no_oscillation(x, level=3, amplitude=1, times=1, window=8s)",
            [3, 1, 3, 5, 3, 2.5, 3, 3.5, 3, 2.5, 3, 3.5, 3, 3, 3, 3],
            [3, 1, 3, 5, 3, 1, 3, 5, 3, 2.5, 3, 3.5, 3, 3, 3, 3],
            (2, 4),
        ),
        Example(
            "oscillation_period(x, 3, 1, shortest=3s, longest=5s)",
            [3, 1, 3, 5, 3, 1, 3, 5, 3, 1, 1, 3, 5, 3, 1, 3],
            [3, 1, 3, 5, 3, 1, 3, 5, 1, 5, 3, 1, 1, 3, 3, 5],
            (2, 4),
        ),
    ],
    "transients": [
        Example(
            "rise_time(x, low=1, high=5, limit=4s)",
            [0, 0, 0, 1.5, 3, 4.5, 5.5, 5, 5, 5, 5, 5, 5, 5, 5, 5],
            [0, 0, 0, 1.5, 2, 2.5, 3, 3.5, 4, 4.5, 5, 5, 5, 5, 5, 5],
            (1, 5),
        ),
        Example(
            "fall_time(x, high=5, low=1, limit=4s)",
            [6, 6, 6, 4.5, 3, 2, 0.5, 1, 1, 1, 1, 1, 1, 1, 1, 1],
            [6, 6, 6, 4.5, 4, 3.5, 3, 2.5, 2, 1.5, 1, 1, 1, 1, 1, 1],
            (1, 5),
        ),
        Example(
            "overshoot(p, x, target=4, amount=1, duration=10s)",
            [0, 0, 0, 2, 3.5, 4.5, 4.8, 4.3, 3.8, 3.9, 4.1, 4, 4, 4, 4, 4],
            [0, 0, 0, 2, 4, 5.2, 5.6, 4.6, 3.6, 3.7, 4.2, 4.1, 4, 4, 4, 4],
            (4, 5),
        ),
        Example(
            "undershoot(p, x, target=2, amount=1, duration=10s)",
            [6, 6, 6, 4, 2.5, 1.5, 1.2, 1.7, 2.2, 2.1, 1.9, 2, 2, 2, 2, 2],
            [6, 6, 6, 4, 2, 0.8, 0.4, 1.4, 2.4, 2.3, 1.8, 1.9, 2, 2, 2, 2],
            (1, 2),
        ),
    ],
    "steady": [
        Example(
            "settles(x, target=4, band=0.5, within=6s)",
            [0, 1, 3, 4.8, 4.3, 3.8, 4.1, 4, 3.9, 4, 4.1, 4, 4, 3.9, 4, 4],
            [0, 1, 3, 4.8, 4.3, 3.8, 4.1, 4, 3.9, 4, 4.1, 4.8, 4.2, 3.9, 4, 4],
            (3.5, 4.5),
        ),
        Example(
            "settles_after(p, x, target=4, band=0.5, within=4s, duration=5s)",
            [0, 0, 0, 1, 3, 4.8, 4.3, 3.8, 4.1, 4, 3.9, 4, 4, 2, 1, 0],
            [0, 0, 0, 1, 3, 4.8, 4.3, 3.8, 4.1, 4.8, 4.2, 4, 4, 2, 1, 0],
            (3.5, 4.5),
        ),
        Example(
            "tracks(x, target=4, band=0.5, within=2s)",
            [4, 4.1, 3.9, 5, 4.7, 4.2, 4, 3.9, 3, 3.8, 4, 4.1, 4, 4, 3.9, 4],
            [4, 4.1, 3.9, 5, 4.9, 4.8, 4.6, 4.2, 4, 3.8, 4, 4.1, 4, 4, 3.9, 4],
            (3.5, 4.5),
        ),
        Example(
            "steady_state_error(p, x, 4, 0.2, after=12s, window=5s)",
            [0, 0, 0, 2, 3.5, 4.5, 4.6, 4.2, 3.7, 4.3, 3.7, 4.3, 3.7, 4.3, 3.7, 4.3],
            [0, 0, 0, 2, 3.5, 4, 3.9, 3.7, 3.4, 3.9, 3.4, 3.9, 3.4, 3.9, 3.4, 3.9],
            (3.8, 4.2),
        ),
    ],
}

_COLORS = {True: "#e7f4e8", False: "#fbe9e7"}
_VERDICTS = {True: "satisfied", False: "violated"}


def specification(call: str) -> rtamt.Specification:
    """Return the specification that requires a pattern of the signal x and the Boolean p."""
    return rtamt.parse(f'import "signals.stl" bool p; float x; require R: {call}')


def signals(trace: Trace) -> dict[str, list[float]]:
    """Return the samples of x and p."""
    return {"x": [float(value) for value in trace], "p": [float(t == BEGIN) for t in range(len(trace))]}


def draw(images: Path) -> None:
    """Draw one image for each group of patterns."""
    for group, examples in GROUPS.items():
        figure = Figure(figsize=(10, 1.7 * len(examples)), layout="constrained")
        axes = figure.subplots(len(examples), 2, squeeze=False, sharey="row")
        for row, example in zip(axes, examples, strict=True):
            for ax, trace in zip(row, (example.satisfied, example.violated), strict=True):
                _panel(ax, example, trace)
        figure.savefig(images / f"signal_patterns_{group}.png", dpi=80)


def _panel(ax: Axes, example: Example, trace: Trace) -> None:
    """Draw a signal with its samples, on the colour of the verdict."""
    verdict = bool(specification(example.call).evaluate(signals(trace)).satisfied)
    ax.set_facecolor(_COLORS[verdict])
    ax.plot(range(len(trace)), trace, "-o", color="#333333", linewidth=1.3, markersize=3)
    for level in example.levels:
        ax.axhline(level, color="#4c78a8", linewidth=0.9, linestyle="--")
    if "(p, " in example.call:
        ax.axvline(BEGIN, color="#e08a2e", linewidth=1.2)
        ax.annotate("p", (BEGIN, 0.5), (3, 0), xycoords=("data", "axes fraction"), textcoords="offset points",
                    color="#e08a2e", fontsize=8)  # fmt: skip
    ax.set_xlim(0, len(trace) - 1)
    ax.margins(y=0.12)
    ax.tick_params(labelsize=7, length=2)
    ax.set_title(f"{example.call}: {_VERDICTS[verdict]}", fontsize=7, family="monospace", loc="left")
    ax.spines[["top", "right"]].set_visible(False)
