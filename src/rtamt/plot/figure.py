"""A scene as a figure of matplotlib: signals above, robustness of the formula and its parts below."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, shown
from rtamt.language.contents import variables
from rtamt.lazy.modules import np
from rtamt.plot import style
from rtamt.plot.axes import Edges, matplotlib
from rtamt.plot.canvas import COLUMNS, DOTS, ROW, Canvas, panel_heights
from rtamt.plot.lines import Line
from rtamt.signals.sampling_period import merged

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.plot.band import Band
    from rtamt.plot.scene import Node, Panel, Scene
    from rtamt.signals.arrays import FloatArray


def new_figure() -> Any:
    """Return a figure of pyplot; in a notebook one that is closed, which a cell shows once, as its last expression.

    Of pyplot's open figures a notebook shows each at the end of its cell, and that of the last expression once more.
    It can show a figure at all once pyplot has made one, which loads the notebook's backend.
    """
    pyplot = matplotlib("pyplot")
    figure = pyplot.figure()
    if "inline" in pyplot.get_backend():
        pyplot.close(figure)
    return figure


def figure_for(figure: Any) -> Any:
    """Return the figure to draw into: the given one, or a new one; raise :class:`UsageError` if it is none."""
    if figure is None:
        return new_figure()
    if not hasattr(figure, "set_size_inches"):
        raise UsageError(
            f"figure is {shown(figure)}, expected a figure of matplotlib, such as plt.figure() or axes.figure"
        )
    return figure


def draw(scene: Scene, rows: int, figure: Any, window: tuple[float, float] | None = None) -> None:
    """Draw a scene into a figure, which is made as large as it needs to be.

    ``rows``: sub-formulas at most. ``window``: the visible positions, by default all.
    """
    _Drawing(scene, rows, figure, window).draw()


class _Drawing(Canvas):
    """One scene in one figure."""

    def __init__(self, scene: Scene, rows: int, figure: Any, window: tuple[float, float] | None) -> None:
        super().__init__(scene.x_axis, figure, window, dense=scene.dense)
        self._scene = scene
        self._chosen = scene.chosen(rows)

    def draw(self) -> None:
        scene = self._scene
        heights = panel_heights(scene.panels) + [ROW] * (len(self._chosen) + (scene.band is not None))
        satisfied = scene.explanation.satisfied
        name = f"{scene.title}: " if scene.title else ""
        verdict = f"{style.SIGNS[satisfied]} {name}{scene.verdict}"
        color = style.HOLDS if satisfied else style.FAILS
        axes = self.rows(heights, verdict, scene.explanation.formula, color)
        split = len(scene.panels)
        for panel, axis in zip(scene.panels, axes[:split], strict=True):
            self._panel(panel, axis)
        for number, axis in zip(self._chosen, axes[split:], strict=False):
            self._row(number, axis)
        if scene.band is not None:
            self._bounds(scene.band, axes[-1])
        self.finish(axes)

    # ---- signals -----------------------------------------------------------------------------------

    def _panel(self, panel: Panel, axis: Any) -> None:
        lines = [self.in_view(line).decimated(COLUMNS) for line in panel.lines]
        finite = [line.values[np.isfinite(line.values)] for line in lines]
        edges = Edges(axis, np.concatenate([*finite, panel.thresholds]), lines)
        self._draw_causes(axis, panel.because)
        for limit in panel.thresholds:
            if isfinite(limit):
                axis.axhline(edges.place(limit), color=style.QUIET, linewidth=0.9, linestyle=(0, (5, 3)))
        labels = []
        for i, line in enumerate(lines):
            color = style.SIGNALS[i % len(style.SIGNALS)]
            values = self._trace(axis, line, edges, color)
            labels.append((float(values[-1]) if len(values) else edges.middle, line.label, color))
        self.names(axis, labels)
        self._instants(axis)
        self._on_signal(panel, axis, edges)

    def _on_signal(self, panel: Panel, axis: Any, edges: Edges) -> None:
        if self._scene.critical is None or not self.sees(self._scene.critical[1]):
            return
        number, position = self._scene.critical
        critical = self._scene.nodes[number].formula
        for line in panel.lines:
            if line.name in variables(critical):
                self._diamond(axis, position, edges.place(line.at(position)))

    # ---- robustness --------------------------------------------------------------------------------

    def _row(self, number: int, axis: Any) -> None:
        node = self._scene.nodes[number]
        line = self.in_view(node.line).decimated(COLUMNS)
        finite = line.values[np.isfinite(line.values)]
        edges = Edges(axis, np.append(finite, 0.0), [line])
        self._fails(axis, node)
        self._draw_causes(axis, node.because)
        self.robustness_axis(axis)
        values = edges.shown(line.values)
        step = "post" if self.dense else None
        for end, color in ((1, style.HOLDS), (0, style.FAILS)):
            area = axis.fill_between(
                self.places(line.positions), values, 0, step=step, color=color, alpha=0.22, linewidth=0
            )
            half = matplotlib("patches").Rectangle(
                (0, 0), 1, axis.get_ylim()[end], transform=axis.get_yaxis_transform()
            )
            area.set_clip_path(half)
        self._trace(axis, line, edges, style.INK)
        title = f"{node.name} = {node.text}" if node.name else node.text
        self.row_title(axis, title, bold=number == 0)
        self._instants(axis)
        at = self._scene.shown_at(number)
        value, fails = node.line.at(at), node.fails_at(at)
        when = f"at {self.x_axis.text(at)}"
        self.annotate(
            axis,
            f"{style.SIGNS[not fails]} {style.number(value)}",
            when,
            style.FAILS if fails else style.HOLDS,
        )
        if (
            self._scene.critical is not None
            and self._scene.critical[0] == number
            and self.sees(self._scene.critical[1])
        ):
            position = self._scene.critical[1]
            self._diamond(axis, position, edges.place(node.line.at(position)))

    def _fails(self, axis: Any, node: Node) -> None:
        self.shade(axis, node.fails, "does not hold", style.FAILS)

    # ---- bounds ------------------------------------------------------------------------------------

    def _bounds(self, band: Band, axis: Any) -> None:
        """Draw what was known of the robustness at the start after each sample, and what it was in the end."""
        # They hold until the next sample, in discrete time too.
        ends = [
            Line(end, band.positions, values).between(*self.window, dense=True)
            for end, values in (("lower", band.lower), ("upper", band.upper))
        ]
        both = [line.decimated(COLUMNS) for line in ends]
        every = np.concatenate([line.values for line in both])
        edges = Edges(axis, np.append(every[np.isfinite(every)], (0.0, band.robustness)), both)
        self.robustness_axis(axis)
        places = merged([line.positions for line in both])
        chosen = np.searchsorted(ends[0].positions, places)
        lower, upper = (edges.shown(line.values[chosen]) for line in ends)
        axis.fill_between(
            self.places(places), lower, upper, step="post", color=style.BAND, alpha=0.35, linewidth=0
        )
        for values in (lower, upper):
            axis.plot(self.places(places), values, color=style.BAND, linewidth=1.2, drawstyle="steps-post")
        axis.axhline(edges.place(band.robustness), color=style.INK, linewidth=1.4)
        axis.set_title(
            "bounds of the robustness at the start, after each sample",
            loc="left",
            fontsize=8.5,
            pad=4,
            color=style.INK,
        )
        kind = style.HOLDS if self._scene.explanation.satisfied else style.FAILS
        if band.decided is not None and self.sees(band.decided):
            axis.axvline(self.place(band.decided), color=kind, linewidth=1.2)
        when = "at the end" if band.decided is None else f"at {self.x_axis.text(band.decided)}"
        self.annotate(axis, "decided", when, kind)

    # ---- marks -------------------------------------------------------------------------------------

    def _draw_causes(self, axis: Any, stretches: Sequence[tuple[float, float]]) -> None:
        for start, end in self.visible(stretches):
            patch = axis.axvspan(
                self.place(start),
                self.place(end),
                facecolor=style.BECAUSE,
                alpha=0.45,
                edgecolor="#b8a800",
                linewidth=0.8,
            )
            self.marks.setdefault("sufficient cause (implicant)", patch)

    def _instants(self, axis: Any) -> None:
        if self._scene.critical is not None and self.sees(self._scene.critical[1]):
            axis.axvline(self.place(self._scene.critical[1]), color=style.INK, linewidth=0.8, linestyle=":")

    def _diamond(self, axis: Any, position: float, value: float) -> None:
        (mark,) = axis.plot(
            [self.place(position)],
            [value],
            marker="D",
            markersize=7,
            color="white",
            markeredgecolor=style.INK,
            markeredgewidth=1.5,
            linestyle="none",
            zorder=5,
            clip_on=False,
        )
        self.marks.setdefault("critical point", mark)

    # ---- lines -------------------------------------------------------------------------------------

    def _trace(self, axis: Any, line: Line, edges: Edges, color: str) -> FloatArray:
        """Draw values; those in dense time hold, samples in discrete time have dots if there is room."""
        width = 0.7 if len(line.positions) > 2 * COLUMNS else 1.4
        values = edges.shown(line.values)
        style_of = {"drawstyle": "steps-post"} if self.dense else {}
        if len(line.positions) <= DOTS:
            style_of |= {"marker": "o", "markersize": "3.2"}
        axis.plot(self.places(line.positions), values, color=color, linewidth=width, **style_of)
        return values
