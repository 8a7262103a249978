"""A scene as a figure of matplotlib: signals above, robustness of the formula and its parts below."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

from rtamt.language.contents import variables
from rtamt.lazy.modules import np
from rtamt.plot import style
from rtamt.plot.axes import Edges, matplotlib
from rtamt.plot.lines import Line
from rtamt.plot.texts import in_lines, label_width, names_height, shorten, wrap_formula
from rtamt.signals.sampling_period import merged

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.plot.band import Band
    from rtamt.plot.scene import Node, Panel, Scene
    from rtamt.signals.arrays import FloatArray

#: Inches.
_WIDTH, _PANEL, _ROW, _HEAD, _FOOT = 10.0, 1.2, 0.9, 0.55, 0.8
_LEFT, _RIGHT, _GAP = 0.75, 1.55, 0.34

#: Points across that are drawn, and up to which each sample has a dot.
_COLUMNS, _DOTS = 1200, 50

#: Panels that are drawn larger than rows.
_FEW = 4


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


def draw(scene: Scene, rows: int, figure: Any, window: tuple[float, float] | None = None) -> None:
    """Draw a scene into a figure, which is made as large as it needs to be.

    ``rows``: sub-formulas at most. ``window``: the visible positions, by default all.
    """
    _Drawing(scene, rows, figure, window or (scene.x_axis.start, scene.x_axis.end)).draw()


class _Drawing:
    """One scene in one figure."""

    def __init__(self, scene: Scene, rows: int, figure: Any, window: tuple[float, float]) -> None:
        self._scene = scene
        self._figure = figure
        self._chosen = scene.chosen(rows)
        self._title = wrap_formula(scene.explanation.formula)
        self._marks: dict[str, Any] = {}
        margin = 0.015 * (window[1] - window[0]) or 1.0
        self._window = window
        self._limits = (window[0] - margin, window[1] + margin)

    def draw(self) -> None:
        least = _ROW if len(self._scene.panels) > _FEW else _PANEL
        heights = [max(least, names_height(panel)) for panel in self._scene.panels] + [_ROW] * (
            len(self._chosen) + (self._scene.band is not None)
        )
        head = _HEAD + 0.19 * len(self._title) + 0.2
        total = head + sum(heights) + _GAP * (len(heights) - 1) + _FOOT
        self._figure.set_size_inches(_WIDTH, total)
        self._figure.set_facecolor("white")
        top = total - head
        axes: list[Any] = []
        for height in heights:
            box = (_LEFT / _WIDTH, (top - height) / total, 1 - (_LEFT + _RIGHT) / _WIDTH, height / total)
            axes.append(self._figure.add_axes(box, sharex=axes[0] if axes else None))
            top -= height + _GAP
        split = len(self._scene.panels)
        for axis in axes:
            self._frame(axis)
        for panel, axis in zip(self._scene.panels, axes[:split], strict=True):
            self._panel(panel, axis)
        for number, axis in zip(self._chosen, axes[split:], strict=False):
            self._row(number, axis)
        if self._scene.band is not None:
            self._bounds(self._scene.band, axes[-1])
        for axis in axes[:-1]:
            axis.tick_params(labelbottom=False)
        self._time_axis(axes[-1])
        self._header(total)
        self._legend()

    # ---- around ------------------------------------------------------------------------------------

    def _frame(self, axis: Any) -> None:
        axis.set_xlim(*(self._place(limit) for limit in self._limits))
        for side in ("top", "right"):
            axis.spines[side].set_visible(False)
        for side in ("left", "bottom"):
            axis.spines[side].set_color(style.FAINT)
        axis.tick_params(labelsize=8, color=style.FAINT, labelcolor=style.QUIET, length=3)
        axis.grid(axis="x", color=style.FAINT, linewidth=0.4)
        axis.set_axisbelow(True)

    def _header(self, total: float) -> None:
        explanation = self._scene.explanation
        kind = style.HOLDS if explanation.satisfied else style.FAILS
        left, y = _LEFT / _WIDTH, total - 0.3
        name = f"{self._scene.title}: " if self._scene.title else ""
        self._figure.text(
            left,
            y / total,
            f"{style.SIGNS[explanation.satisfied]} {name}{self._scene.verdict}",
            color=kind,
            fontsize=13,
            fontweight="bold",
            va="center",
        )
        text = "\n".join(self._title)
        self._figure.text(
            left, (y - 0.2) / total, text, fontsize=9, family="monospace", va="top", color=style.INK
        )

    def _legend(self) -> None:
        if self._marks:
            self._figure.legend(
                self._marks.values(),
                self._marks.keys(),
                loc="lower left",
                ncols=len(self._marks),
                bbox_to_anchor=(_LEFT / _WIDTH - 0.01, 0.0),
                frameon=False,
                fontsize=8,
                labelcolor=style.QUIET,
            )

    def _time_axis(self, axis: Any) -> None:
        axis.set_xlabel(self._scene.x_axis.label, fontsize=8, color=style.QUIET)
        if isinstance(self._scene.x_axis.origin, np.datetime64):
            dates = matplotlib("dates")
            locator = dates.AutoDateLocator(minticks=3, maxticks=9)
            axis.xaxis.set_major_locator(locator)
            axis.xaxis.set_major_formatter(dates.ConciseDateFormatter(locator))

    # ---- signals -----------------------------------------------------------------------------------

    def _panel(self, panel: Panel, axis: Any) -> None:
        lines = [self._in_view(line).decimated(_COLUMNS) for line in panel.lines]
        finite = [line.values[np.isfinite(line.values)] for line in lines]
        edges = Edges(axis, np.concatenate([*finite, panel.thresholds]), lines)
        self._draw_causes(axis, panel.because)
        for limit in panel.thresholds:
            if isfinite(limit):
                axis.axhline(limit, color=style.QUIET, linewidth=0.9, linestyle=(0, (5, 3)))
        labels = []
        for i, line in enumerate(lines):
            color = style.SIGNALS[i % len(style.SIGNALS)]
            values = self._trace(axis, line, edges, color)
            labels.append((float(values[-1]) if len(values) else edges.middle, line.label, color))
        self._names(axis, labels)
        self._instants(axis)
        self._on_signal(panel, axis, edges)

    def _names(self, axis: Any, labels: Sequence[tuple[float, str, str]]) -> None:
        """Write each signal's name at its end, the names apart from each other."""
        low, high = axis.get_ylim()
        names = [in_lines(name) for _, name, _ in labels]
        tall = axis.figure.get_size_inches()[1] * axis.get_position().height
        space = label_width(names) / tall * (high - low)
        y = low - space
        places = []
        for (value, _, color), name in sorted(zip(labels, names, strict=True)):
            y = max(value, y + space)
            places.append((y, name, color))
        shift = max(places[-1][0] - high, 0.0)
        for y, name, color in places:
            axis.annotate(
                name,
                (1.012, (y - shift - low) / (high - low)),
                xycoords="axes fraction",
                color=color,
                fontsize=7 if "\n" in name else 9,
                fontweight="bold",
                va="center",
                annotation_clip=False,
            )

    def _on_signal(self, panel: Panel, axis: Any, edges: Edges) -> None:
        if self._scene.critical is None or not self._sees(self._scene.critical[1]):
            return
        number, position = self._scene.critical
        critical = self._scene.nodes[number].formula
        for line in panel.lines:
            if line.name in variables(critical):
                self._diamond(axis, position, float(edges.shown(np.array([line.at(position)]))[0]))

    # ---- robustness --------------------------------------------------------------------------------

    def _row(self, number: int, axis: Any) -> None:
        node = self._scene.nodes[number]
        line = self._in_view(node.line).decimated(_COLUMNS)
        finite = line.values[np.isfinite(line.values)]
        edges = Edges(axis, np.append(finite, 0.0), [line])
        self._fails(axis, node)
        self._draw_causes(axis, node.because)
        axis.axhline(0.0, color=style.QUIET, linewidth=0.9)
        values = edges.shown(line.values)
        step = "post" if self._scene.dense else None
        for end, color in ((1, style.HOLDS), (0, style.FAILS)):
            area = axis.fill_between(
                self._places(line.positions), values, 0, step=step, color=color, alpha=0.22, linewidth=0
            )
            half = matplotlib("patches").Rectangle(
                (0, 0), 1, axis.get_ylim()[end], transform=axis.get_yaxis_transform()
            )
            area.set_clip_path(half)
        self._trace(axis, line, edges, style.INK)
        title = f"{node.name} = {node.text}" if node.name else node.text
        axis.set_title(
            shorten(title, 92),
            loc="left",
            fontsize=8.5,
            family="monospace",
            pad=4,
            color=style.INK,
            fontweight="normal" if number else "bold",
        )
        axis.set_ylabel("ρ", rotation=0, fontsize=9, color=style.QUIET, va="center")
        axis.yaxis.set_label_coords(-0.068, 0.5)
        self._instants(axis)
        at = self._scene.shown_at(number)
        value, fails = node.line.at(at), node.fails_at(at)
        when = f"at {self._scene.x_axis.text(at)}"
        self._annotate(
            axis,
            f"{style.SIGNS[not fails]} {style.number(value)}",
            when,
            style.FAILS if fails else style.HOLDS,
        )
        if (
            self._scene.critical is not None
            and self._scene.critical[0] == number
            and self._sees(self._scene.critical[1])
        ):
            position = self._scene.critical[1]
            self._diamond(axis, position, float(edges.shown(np.array([node.line.at(position)]))[0]))

    def _annotate(self, axis: Any, text: str, moment: str, color: str) -> None:
        """Annotate a row with what holds, and when."""
        axis.annotate(
            text,
            (1.012, 0.5),
            xycoords="axes fraction",
            fontsize=9,
            fontweight="bold",
            va="bottom",
            color=color,
        )
        axis.annotate(
            moment.replace(" (+", "\n(+"),
            (1.012, 0.44),
            xycoords="axes fraction",
            fontsize=7.5,
            va="top",
            color=style.QUIET,
        )

    def _fails(self, axis: Any, node: Node) -> None:
        for start, end in self._visible(node.fails):
            patch = axis.axvspan(
                self._place(start), self._place(end), facecolor=style.FAILS, alpha=0.13, linewidth=0
            )
            self._marks.setdefault("does not hold", patch)

    # ---- bounds ------------------------------------------------------------------------------------

    def _bounds(self, band: Band, axis: Any) -> None:
        """Draw what was known of the robustness at the start after each sample, and what it was in the end."""
        both = [
            self._in_view(Line(end, band.positions, values)).decimated(_COLUMNS)
            for end, values in (("lower", band.lower), ("upper", band.upper))
        ]
        every = np.concatenate([line.values for line in both])
        edges = Edges(axis, np.append(every[np.isfinite(every)], (0.0, band.robustness)), both)
        axis.axhline(0.0, color=style.QUIET, linewidth=0.9)
        places = merged([line.positions for line in both])
        lower, upper = (
            edges.shown(values[np.searchsorted(band.positions, places)])
            for values in (band.lower, band.upper)
        )
        axis.fill_between(
            self._places(places), lower, upper, step="post", color=style.BAND, alpha=0.35, linewidth=0
        )
        for values in (lower, upper):
            axis.plot(self._places(places), values, color=style.BAND, linewidth=1.2, drawstyle="steps-post")
        axis.axhline(float(edges.shown(np.array([band.robustness]))[0]), color=style.INK, linewidth=1.4)
        axis.set_title(
            "bounds of the robustness at the start, after each sample",
            loc="left",
            fontsize=8.5,
            pad=4,
            color=style.INK,
        )
        axis.set_ylabel("ρ", rotation=0, fontsize=9, color=style.QUIET, va="center")
        axis.yaxis.set_label_coords(-0.068, 0.5)
        kind = style.HOLDS if self._scene.explanation.satisfied else style.FAILS
        if band.decided is not None and self._sees(band.decided):
            axis.axvline(self._place(band.decided), color=kind, linewidth=1.2)
        when = "at the end" if band.decided is None else f"at {self._scene.x_axis.text(band.decided)}"
        self._annotate(axis, "decided", when, kind)

    # ---- marks -------------------------------------------------------------------------------------

    def _draw_causes(self, axis: Any, stretches: Sequence[tuple[float, float]]) -> None:
        for start, end in self._visible(stretches):
            patch = axis.axvspan(
                self._place(start),
                self._place(end),
                facecolor=style.BECAUSE,
                alpha=0.45,
                edgecolor="#b8a800",
                linewidth=0.8,
            )
            self._marks.setdefault("sufficient cause (implicant)", patch)

    def _instants(self, axis: Any) -> None:
        if self._scene.critical is not None and self._sees(self._scene.critical[1]):
            axis.axvline(self._place(self._scene.critical[1]), color=style.INK, linewidth=0.8, linestyle=":")

    def _diamond(self, axis: Any, position: float, value: float) -> None:
        (mark,) = axis.plot(
            [self._place(position)],
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
        self._marks.setdefault("critical point", mark)

    def _visible(self, stretches: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
        """Return stretches wide enough to be visible, joined where the gap between them is not."""
        pixel = (self._limits[1] - self._limits[0]) / 1000
        low, high = self._limits
        starts, ends = np.array(sorted(stretches), dtype=float).reshape(-1, 2).T
        seen = (starts <= high) & (ends >= low)
        starts, ends = np.maximum(starts[seen], low), np.minimum(ends[seen], high)
        # There may be very many, most of them closer to their neighbours than a pixel.
        ends = np.maximum.accumulate(ends)
        apart = starts[1:] - ends[:-1] >= pixel
        first, last = (np.r_[each][: len(starts)] for each in ((True, apart), (apart, True)))
        found: list[tuple[float, float]] = []
        for start, end in zip(starts[first].tolist(), ends[last].tolist(), strict=True):
            if found and start - found[-1][1] < pixel:
                found[-1] = (found[-1][0], max(end, found[-1][1]))
            else:
                found.append((start, max(end, start + pixel)))
        return found

    # ---- lines -------------------------------------------------------------------------------------

    def _trace(self, axis: Any, line: Line, edges: Edges, color: str) -> FloatArray:
        """Draw values; those in dense time hold, samples in discrete time have dots if there is room."""
        width = 0.7 if len(line.positions) > 2 * _COLUMNS else 1.4
        values = edges.shown(line.values)
        style_of = {"drawstyle": "steps-post"} if self._scene.dense else {}
        if len(line.positions) <= _DOTS:
            style_of |= {"marker": "o", "markersize": "3.2"}
        axis.plot(self._places(line.positions), values, color=color, linewidth=width, **style_of)
        return values

    def _in_view(self, line: Line) -> Line:
        return line.between(*self._window, dense=self._scene.dense)

    def _sees(self, position: float) -> bool:
        return self._limits[0] <= position <= self._limits[1]

    def _places(self, positions: FloatArray) -> Any:
        """Return positions as matplotlib takes them: dates where the recording has dates."""
        origin = self._scene.x_axis.origin
        if isinstance(origin, np.datetime64):
            return origin + np.rint(np.asarray(positions) * 1e9).astype("timedelta64[ns]")
        return positions

    def _place(self, position: float) -> Any:
        return self._places(np.array([position]))[0]
