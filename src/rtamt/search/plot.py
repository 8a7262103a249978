"""Plots of a search: the robustness over its simulations, and over its parameters (matplotlib)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError
from rtamt.extras import library
from rtamt.lazy.modules import np
from rtamt.plot import style
from rtamt.plot.texts import literal

if TYPE_CHECKING:
    from rtamt.search.falsify import Falsification
    from rtamt.search.sensitivity import Sensitivity


def descent(found: Falsification, axes: Any = None) -> Any:
    """Plot the robustness of each simulation, and the minimum so far."""
    axes = _axes(axes)
    values = np.array([evaluation.robustness for evaluation in found.evaluations])
    number = np.arange(1, len(values) + 1)
    axes.axhline(0, color=style.QUIET, linewidth=0.9)
    axes.plot(number, values, "o", markersize=4, color=style.HOLDS, label="simulation")
    axes.step(number, np.minimum.accumulate(values), where="post", color=style.INK, label="least so far")
    wrong = np.array([not evaluation.satisfied for evaluation in found.evaluations])
    if wrong.any():
        axes.plot(number[wrong], values[wrong], "X", markersize=6, color=style.FAILS, label="violation")
    axes.set_xlabel("simulation")
    axes.set_ylabel("robustness")
    axes.legend(frameon=False, fontsize=8, labelcolor=style.QUIET)
    return style.apply_style(axes)


def landscape(found: Sensitivity, axes: Any = None) -> Any:
    """Plot the robustness over one parameter (a line) or two (a heat map of a grid, else colored points)."""
    axes = _axes(axes)
    names = tuple(found.axes or found.problem.space)
    if len(names) > 2:
        raise UsageError(f"there are {len(names)} parameters ({', '.join(names)}); a plot has room for two")
    values = found.robustness
    points = {name: np.array([e.point[name] for e in found.evaluations]) for name in names}
    if len(names) == 1:
        order = np.argsort(points[names[0]])
        axes.plot(points[names[0]][order], values.ravel()[order], "o-", markersize=4, color=style.HOLDS)
        axes.axhline(0, color=style.QUIET, linewidth=0.9)
        axes.set_ylabel("robustness")
    else:
        reach = float(np.max(np.abs(values[np.isfinite(values)]), initial=0.0)) or 1.0
        colors = {"cmap": _colors(), "vmin": -reach, "vmax": reach}
        if found.axes:
            first, second = found.axes.values()
            made = axes.pcolormesh(first, second, values.T, shading="nearest", **colors)
            axes.set_xticks(first, [f"{value:.3g}" for value in first])
            axes.set_yticks(second, [f"{value:.3g}" for value in second])
            for (i, j), value in np.ndenumerate(values):
                ink = "white" if abs(value) > 0.75 * reach else style.INK
                axes.text(
                    first[i], second[j], f"{value:.3g}", ha="center", va="center", fontsize=8, color=ink
                )
        else:
            made = axes.scatter(*points.values(), c=values, **colors)
        axes.figure.colorbar(made, ax=axes, label="robustness")
        axes.set_ylabel(literal(names[1]))
    axes.set_xlabel(literal(names[0]))
    return style.apply_style(axes)


def _colors() -> Any:
    """Return the colors of robustness values: one for violations (below 0), one for satisfaction."""
    colors = library("matplotlib.colors", "a plot", "plot")
    return colors.LinearSegmentedColormap.from_list("robustness", (style.FAILS, "#f6f6f6", style.HOLDS))


def _axes(axes: Any) -> Any:
    return (
        library("matplotlib.pyplot", "a plot", "plot").subplots(layout="constrained")[1]
        if axes is None
        else axes
    )
