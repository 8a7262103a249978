"""A figure of rows above one another over the same time: what all plots of results draw alike."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.lazy.modules import np
from rtamt.plot import style
from rtamt.plot.axes import matplotlib
from rtamt.plot.texts import in_lines, label_width, literal, names_height, shorten, wrap_formula

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.plot.lines import Line, Range
    from rtamt.plot.scene import Panel
    from rtamt.plot.x_axis import XAxis
    from rtamt.signals.arrays import FloatArray

#: Inches.
WIDTH, HEAD, FOOT = 10.0, 0.55, 0.8
LEFT, RIGHT, GAP = 0.75, 1.55, 0.34
#: Inches of a panel with signals if there are few, and of a row.
PANEL, ROW = 1.2, 0.9
#: Panels that are drawn larger than rows.
FEW = 4

#: Points across that are drawn, and up to which each sample has a dot.
COLUMNS, DOTS = 1200, 50


def panel_heights(panels: Sequence[Panel]) -> list[float]:
    """Return the height of each panel in inches: many are as low as rows, unless their names need more."""
    least = ROW if len(panels) > FEW else PANEL
    return [max(least, names_height(panel)) for panel in panels]


class Canvas:
    """A figure with a heading, rows and a legend, over the visible positions ``window``, by default all."""

    def __init__(
        self, x_axis: XAxis, figure: Any, window: tuple[float, float] | None = None, *, dense: bool
    ) -> None:
        self.x_axis = x_axis
        self.figure = figure
        self.dense = dense
        self.window = window or (x_axis.start, x_axis.end)
        self.marks: dict[str, Any] = {}
        margin = 0.015 * (self.window[1] - self.window[0]) or 1.0
        self.limits = (self.window[0] - margin, self.window[1] + margin)

    # ---- around ------------------------------------------------------------------------------------

    def rows(self, heights: Sequence[float], verdict: str, formula: str, color: str) -> list[Any]:
        """Make the figure as large as its rows need, write the heading, and return the axes of the rows."""
        lines = wrap_formula(formula)
        head = HEAD + 0.19 * len(lines) + 0.2
        total = head + sum(heights) + GAP * (len(heights) - 1) + FOOT
        self.figure.set_size_inches(WIDTH, total)
        self.figure.set_facecolor("white")
        top = total - head
        axes: list[Any] = []
        for height in heights:
            box = (LEFT / WIDTH, (top - height) / total, 1 - (LEFT + RIGHT) / WIDTH, height / total)
            axes.append(self.figure.add_axes(box, sharex=axes[0] if axes else None))
            top -= height + GAP
        for axis in axes:
            self.frame(axis)
        left, y = LEFT / WIDTH, total - 0.3
        self.figure.text(
            left, y / total, literal(verdict), color=color, fontsize=13, fontweight="bold", va="center"
        )
        text = literal("\n".join(lines))
        self.figure.text(
            left, (y - 0.2) / total, text, fontsize=9, family="monospace", va="top", color=style.INK
        )
        return axes

    def finish(self, axes: Sequence[Any]) -> None:
        """Label the time below the last row, and draw the legend."""
        for axis in axes[:-1]:
            axis.tick_params(labelbottom=False)
        self.time_axis(axes[-1])
        self.legend()

    def frame(self, axis: Any) -> None:
        """Draw the axes of a row."""
        axis.set_xlim(*(self.place(limit) for limit in self.limits))
        for side in ("top", "right"):
            axis.spines[side].set_visible(False)
        for side in ("left", "bottom"):
            axis.spines[side].set_color(style.FAINT)
        axis.tick_params(labelsize=8, color=style.FAINT, labelcolor=style.QUIET, length=3)
        axis.grid(axis="x", color=style.FAINT, linewidth=0.4)
        axis.set_axisbelow(True)

    def time_axis(self, axis: Any) -> None:
        """Label the time."""
        axis.set_xlabel(self.x_axis.label, fontsize=8, color=style.QUIET)
        if isinstance(self.x_axis.origin, np.datetime64):
            dates = matplotlib("dates")
            locator = dates.AutoDateLocator(minticks=3, maxticks=9)
            axis.xaxis.set_major_locator(locator)
            axis.xaxis.set_major_formatter(dates.ConciseDateFormatter(locator))

    def legend(self) -> None:
        """Draw the legend of what is marked."""
        if self.marks:
            self.figure.legend(
                self.marks.values(),
                self.marks.keys(),
                loc="lower left",
                ncols=len(self.marks),
                bbox_to_anchor=(LEFT / WIDTH - 0.01, 0.0),
                frameon=False,
                fontsize=8,
                labelcolor=style.QUIET,
            )

    # ---- texts -------------------------------------------------------------------------------------

    def names(self, axis: Any, labels: Sequence[tuple[float, str, str]]) -> None:
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
                literal(name),
                (1.012, (y - shift - low) / (high - low)),
                xycoords="axes fraction",
                color=color,
                fontsize=7 if "\n" in name else 9,
                fontweight="bold",
                va="center",
                annotation_clip=False,
            )

    @staticmethod
    def row_title(axis: Any, text: str, *, bold: bool) -> None:
        """Write the formula of a row above it."""
        axis.set_title(
            literal(shorten(text, 92)),
            loc="left",
            fontsize=8.5,
            family="monospace",
            pad=4,
            color=style.INK,
            fontweight="bold" if bold else "normal",
        )

    @staticmethod
    def robustness_axis(axis: Any) -> None:
        """Draw the line of zero and label the values."""
        axis.axhline(0.0, color=style.QUIET, linewidth=0.9)
        axis.set_ylabel("ρ", rotation=0, fontsize=9, color=style.QUIET, va="center")
        axis.yaxis.set_label_coords(-0.068, 0.5)

    def annotate(self, axis: Any, text: str, moment: str, color: str) -> None:
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

    def shade(self, axis: Any, stretches: Sequence[Range], label: str, color: str) -> None:
        """Shade stretches of a row; the legend has the label."""
        for start, end in self.visible(stretches):
            patch = axis.axvspan(self.place(start), self.place(end), facecolor=color, alpha=0.13, linewidth=0)
            self.marks.setdefault(label, patch)

    # ---- positions ---------------------------------------------------------------------------------

    def in_view(self, line: Line) -> Line:
        """Return the visible part of a line."""
        return line.between(*self.window, dense=self.dense)

    def sees(self, position: float) -> bool:
        """Return whether a position is visible."""
        return self.limits[0] <= position <= self.limits[1]

    def places(self, positions: FloatArray) -> Any:
        """Return positions as matplotlib takes them: dates where the recording has dates."""
        origin = self.x_axis.origin
        if isinstance(origin, np.datetime64):
            return origin + np.rint(np.asarray(positions) * 1e9).astype("timedelta64[ns]")
        return positions

    def place(self, position: float) -> Any:
        """Return a position as matplotlib takes it."""
        return self.places(np.array([position]))[0]

    def visible(self, stretches: Sequence[Range]) -> list[Range]:
        """Return stretches wide enough to be visible, joined where the gap between them is not."""
        pixel = (self.limits[1] - self.limits[0]) / 1000
        low, high = self.limits
        starts, ends = np.array(sorted(stretches), dtype=float).reshape(-1, 2).T
        seen = (starts <= high) & (ends >= low)
        starts, ends = np.maximum(starts[seen], low), np.minimum(ends[seen], high)
        # There may be very many, most of them closer to their neighbours than a pixel.
        ends = np.maximum.accumulate(ends)
        apart = starts[1:] - ends[:-1] >= pixel
        first, last = (np.r_[each][: len(starts)] for each in ((True, apart), (apart, True)))
        found: list[Range] = []
        for start, end in zip(starts[first].tolist(), ends[last].tolist(), strict=True):
            if found and start - found[-1][1] < pixel:
                found[-1] = (found[-1][0], max(end, found[-1][1]))
            else:
                found.append((start, max(end, start + pixel)))
        return found
