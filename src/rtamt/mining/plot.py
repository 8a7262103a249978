"""Plots of what was mined: the front of two parameters, one parameter by recording, or a search (matplotlib)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError
from rtamt.extras import library
from rtamt.lazy.modules import np
from rtamt.plot import style
from rtamt.plot.texts import literal

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.mining.classify import Classifier
    from rtamt.mining.mine import Mined

#: Room around the points of a front, as a share of their range.
_ROOM = 0.12


def plot(found: Mined, axes: Any = None) -> Any:
    """Plot the front of two parameters, one parameter by recording, or the values that a search tried."""
    if found.tried:
        return _search(found, axes)
    if len(found.roles) == 2:
        return _front(found, axes)
    if len(found.roles) == 1:
        return _by_recording(found, axes)
    names = ", ".join(role.name for role in found.roles)
    raise UsageError(
        f"there are {len(found.roles)} parameters ({names}), and a plot has room for two; mine two of them"
    )


def _front(found: Mined, axes: Any) -> Any:
    """Plot the staircase between the values that satisfy the template on all recordings, and the others."""
    first, second = found.roles
    axes = _axes(axes, (6.2, 4.2))
    points = np.array([[point.values[role.name] for role in found.roles] for point in found.points])
    low, high = _limits(points, (first.name, second.name), found)
    # From easy to hard in the first parameter the second one becomes easier.
    points = points[np.argsort(points[:, 0])]
    easy = [high[k] if role.direction == 1 else low[k] for k, role in enumerate(found.roles)]
    hard = [low[k] if role.direction == 1 else high[k] for k, role in enumerate(found.roles)]
    across = points if first.direction == 1 else points[::-1]
    x = [across[0, 0], *across[:, 0], easy[0]]
    y = [easy[1], *across[:, 1], across[-1, 1]]
    axes.fill_between(x, y, easy[1], step="post", color=style.HOLDS, alpha=0.13, linewidth=0)
    axes.step(x, y, where="post", color=style.HOLDS, linewidth=1.4)
    axes.plot(points[:, 0], points[:, 1], "o", markersize=4.5, color=style.HOLDS)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    for place, text, color in (
        (easy, "all recordings satisfy it", style.HOLDS),
        (hard, "a recording violates it", style.FAILS),
    ):
        sides = [(0.02, "left") if place[0] == low[0] else (0.98, "right")]
        at = 0.03 if place[1] == low[1] else 0.97
        axes.text(
            sides[0][0],
            at,
            text,
            transform=axes.transAxes,
            ha=sides[0][1],
            va="bottom" if at < 0.5 else "top",
            fontsize=8.5,
            color=color,
        )
    axes.set_xlabel(_label(found, 0))
    axes.set_ylabel(_label(found, 1))
    count, more = len(points), "" if not found.undecided else f"; {found.undecided:.0%} of the area undecided"
    recordings = len(found.recordings)
    axes.set_title(
        f"{count} point{'' if count == 1 else 's'}, {recordings} recording{'' if recordings == 1 else 's'}{more}",
        fontsize=9,
        color=style.QUIET,
        loc="right",
    )
    return style.apply_style(axes)


def _limits(points: Any, names: Sequence[str], found: Mined) -> tuple[list[float], list[float]]:
    low, high = [], []
    for column, name in enumerate(names):
        least, most = float(points[:, column].min()), float(points[:, column].max())
        room = _ROOM * (most - least) or max(5 * found.resolutions[name], 0.05 * abs(most))
        low.append(least - room)
        high.append(most + room)
    return low, high


def _by_recording(found: Mined, axes: Any) -> Any:
    """Plot the tight value for each recording alone, and for all of them."""
    (role,), (point,) = found.roles, found.points
    names = sorted(found.alone, key=lambda name: found.alone[name])
    axes = _axes(axes, (6.2, 1.3 + 0.22 * max(len(names), 2)))
    values = [found.alone[name] for name in names]
    tight = point.values[role.name]
    decides = [value == tight for value in values]
    axes.axvline(tight, color=style.FAILS, linewidth=1.1)
    axes.plot(values, range(len(names)), "o", markersize=5, color=style.HOLDS)
    axes.plot(
        [value for value, last in zip(values, decides, strict=True) if last],
        [place for place, last in enumerate(decides) if last],
        "o",
        markersize=6.5,
        color=style.FAILS,
    )
    axes.set_yticks(range(len(names)), [literal(name.rpartition("/")[2]) for name in names])
    axes.set_ylim(-0.7, len(names) - 0.3)
    axes.set_xlabel(_label(found, 0))
    axes.set_title(f"{literal(role.name)} = {tight:.6g}", fontsize=9, color=style.FAILS, loc="right")
    return style.apply_style(axes)


def _search(found: Mined, axes: Any) -> Any:
    """Plot the least robustness over the recordings for each value that was tried."""
    if len(found.roles) > 2:
        names = ", ".join(role.name for role in found.roles)
        raise UsageError(
            f"there are {len(found.roles)} parameters ({names}), and a plot has room for two; mine two of them"
        )
    axes = _axes(axes, (6.2, 3.4))
    (point,) = found.points
    margins = np.array([margin for _, margin in found.tried])
    columns = [np.array([values[role.name] for values, _ in found.tried]) for role in found.roles]
    best = [point.values[role.name] for role in found.roles]
    if len(columns) == 1:
        shown = np.argsort(columns[0])
        axes.axhline(0, color=style.QUIET, linewidth=0.9)
        axes.plot(columns[0][shown], margins[shown], ".-", markersize=4, linewidth=0.8, color=style.HOLDS)
        axes.axvline(best[0], color=style.FAILS, linewidth=1.1)
        axes.set_ylabel("least robustness of the recordings", fontsize=9)
    else:
        colors = np.where(margins >= 0, style.HOLDS, style.FAILS)
        axes.scatter(*columns, c=colors, s=9)
        axes.plot(*best, "X", markersize=9, color=style.INK)
        axes.set_ylabel(_label(found, 1))
    axes.set_xlabel(_label(found, 0))
    axes.set_title(
        f"{len(margins)} values tried, not proven tight", fontsize=9, color=style.QUIET, loc="right"
    )
    return style.apply_style(axes)


def strips(found: Classifier, figure: Any = None) -> Any:
    """Plot the tight value of each recording for each rule, and the threshold between them.

    Infinite values are triangles at the edges.
    """
    count = max(len(found.rules), 1)
    if figure is None:
        figure = library("matplotlib.pyplot", "a plot", "plot").figure(
            figsize=(7.0, 0.6 + 1.25 * count), layout="constrained"
        )
    panels = figure.subplots(count, 1, squeeze=False)[:, 0]
    good = np.array(list(found.recordings.values()))
    open_ = np.ones(len(good), bool)  # not decided by an earlier rule
    for place, (axes, rule) in enumerate(zip(panels, found.rules, strict=False)):
        values = found.values[:, rule.column]
        finite = np.append(values[np.isfinite(values)], rule.threshold)
        pad = 0.08 * np.ptp(finite) or 1.0
        places = np.clip(values, finite.min() - pad, finite.max() + pad)
        for label, height, color in ((True, 1, style.HOLDS), (False, 0, style.FAILS)):
            for shown, ink in ((good == label) & ~open_, style.FAINT), ((good == label) & open_, color):
                mine = np.flatnonzero(shown)
                spread = np.linspace(-0.22, 0.22, len(mine)) if len(mine) > 1 else np.zeros(len(mine))
                markers = (("o", np.isfinite(values)), ("<", values == -np.inf), (">", values == np.inf))
                for marker, kind in markers:
                    of = kind[mine]
                    x, y = places[mine][of], (height + spread)[of]
                    axes.plot(x, y, marker, markersize=4, alpha=0.75, color=ink, linestyle="none")
        open_ &= ~rule.satisfied(found.values)
        axes.axvline(rule.threshold, color=style.INK, linewidth=1.1)
        axes.set_yticks([0, 1], ["bad", "good"])
        axes.set_ylim(-0.5, 1.5)
        word = "if" if not place else "else if"
        axes.set_title(
            f"{word} {literal(rule.text)} then {'good' if rule.good else 'bad'}",
            fontsize=9,
            color=style.INK,
            loc="left",
            family="monospace",
        )
        axes.set_xlabel("threshold that the recording needs" if rule is found.rules[-1] else "")
        style.apply_style(axes)
    if not found.rules:
        panels[0].set_title("no rule is better than the majority", fontsize=9, loc="left")
        style.apply_style(panels[0])
    return figure


def _label(found: Mined, place: int) -> str:
    name = found.roles[place].name
    unit = found.specification.document.units.get(name, "")
    return literal(f"{name} [{unit}]" if unit else name)


def _axes(axes: Any, size: tuple[float, float]) -> Any:
    if axes is not None:
        return axes
    return library("matplotlib.pyplot", "a plot", "plot").subplots(figsize=size, layout="constrained")[1]
