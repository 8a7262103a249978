"""The plot of a mutation: a matrix of mutants and recordings (matplotlib)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.extras import library
from rtamt.lazy.modules import np
from rtamt.plot import style
from rtamt.plot.texts import literal, shorten

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.mutation.mutate import Mutation

#: The maximum length of the label of a change.
_LONGEST = 64


def matrix(found: Mutation, axes: Any = None) -> Any:
    """Plot which recording distinguishes which mutant; survivors are marked."""
    rows, columns = found.killed.shape
    if axes is None:
        size = (4.6 + 0.34 * columns, 1.3 + 0.19 * max(rows, 1))
        axes = library("matplotlib.pyplot", "a plot", "plot").subplots(figsize=size, layout="constrained")[1]
    colors = library("matplotlib.colors", "a plot", "plot").ListedColormap([style.FAINT, style.HOLDS])
    shown = found.killed if rows else np.zeros((1, max(columns, 1)), bool)
    axes.pcolormesh(shown, cmap=colors, vmin=0, vmax=1, edgecolors="white", linewidth=1.5)
    axes.invert_yaxis()
    dead: list[bool] = [bool(row.any()) for row in found.killed]
    axes.set_yticks(np.arange(rows) + 0.5, [_label(each.name, each.change) for each in found.mutants])
    for tick, killed in zip(axes.get_yticklabels(), dead, strict=True):
        tick.set(fontsize=7, family="monospace", color=style.QUIET if killed else style.FAILS)
    for row in (number for number, each in enumerate(dead) if not each):
        axes.plot(columns + 0.25, row + 0.5, "X", markersize=5, color=style.FAILS, clip_on=False)
    axes.set_xticks(
        np.arange(columns) + 0.5, _short(found.recordings), rotation=90, fontsize=7, color=style.QUIET
    )
    axes.tick_params(length=0)
    for side in axes.spines.values():
        side.set_visible(False)
    axes.set_title(
        f"{sum(dead)} of {rows} mutants killed ({found.score:.0%}); ✗ survives",
        fontsize=9,
        color=style.INK,
        loc="right",
    )
    return axes


def _short(names: Sequence[str]) -> list[str]:
    """Return the names of recordings, without folders where they are distinct without."""
    short = [name.rpartition("/")[2] for name in names]
    return list(map(literal, short if len(set(short)) == len(names) else names))


def _label(name: str, change: str) -> str:
    return f"{literal(shorten(change, _LONGEST))}  {literal(name)}"
