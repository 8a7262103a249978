"""Draw the pattern library: of each pattern a trace that satisfies it and one that violates it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from matplotlib.figure import Figure
from tools.pattern_examples import EXAMPLES

import rtamt

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from matplotlib.axes import Axes

Time = Literal["discrete", "dense"]

_COLORS = {"q": "#4c78a8", "r": "#b279a2", "p": "#333333", "s": "#e08a2e", "t": "#54a24b"}
_VERDICTS = {True: ("satisfied", "#e7f4e8"), False: ("violated", "#fbe9e7")}


def specification(*calls: str, time: Time = "discrete") -> rtamt.Specification:
    """Return the specification that requires patterns of the Booleans p, q, r, s and t."""
    requirements = "".join(f"\nrequire R{number}: {call}" for number, call in enumerate(calls))
    return rtamt.parse(
        f'import "patterns.stl" bool p; bool q; bool r; bool s; bool t;{requirements}', time=time
    )


def signals(trace: Mapping[str, str], time: Time = "discrete") -> dict[str, Sequence[object]]:
    """Return the samples of a trace; a signal that it does not have is false."""
    size = max(map(len, trace.values()))
    values = {name: [value == "1" for value in trace.get(name, "0" * size)] for name in "pqrst"}
    return {name: list(enumerate(each)) if time == "dense" else each for name, each in values.items()}


def draw(images: Path) -> None:
    """Draw one image for each group of patterns."""
    for group, patterns in EXAMPLES.items():
        figure = Figure(figsize=(10, 1.35 * len(patterns)), layout="constrained")
        axes = figure.subplots(len(patterns), 2, squeeze=False)
        for row, (call, (shared, *different)) in zip(axes, patterns.items(), strict=True):
            for ax, own in zip(row, different, strict=True):
                _panel(
                    ax, call, {name: {**shared, **own}[name] for name in "qrpst" if name in {**shared, **own}}
                )
        figure.savefig(images / f"patterns_{group}.png", dpi=80)


def _panel(ax: Axes, call: str, trace: Mapping[str, str]) -> None:
    """Draw Booleans as steps above each other, on the colour of the verdict."""
    verdict, background = _VERDICTS[bool(specification(call).evaluate(signals(trace)).satisfied)]
    ax.set_facecolor(background)
    for level, (name, values) in enumerate(reversed(trace.items())):
        samples = [int(value) for value in values]
        heights = [level + 0.7 * value for value in (*samples, samples[-1])]
        ax.step(range(len(heights)), heights, where="post", color=_COLORS[name], linewidth=1.6)
    ax.set_yticks([level + 0.3 for level in range(len(trace))], [*reversed(trace)], fontsize=8)
    ax.set_xticks(range(0, 11, 2))
    ax.set_xlim(0, 10)
    ax.set_ylim(-0.25, len(trace))
    ax.tick_params(labelsize=7, length=2)
    ax.set_title(f"{call}: {verdict}", fontsize=8, family="monospace", loc="left")
    ax.spines[["top", "right"]].set_visible(False)
