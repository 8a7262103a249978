"""The plot of a result whose samples are missing or uncertain: bounds of the signals and of the robustness as bands."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

from rtamt.engine import Evaluators
from rtamt.errors import UsageError
from rtamt.explain.wording import predicate_text
from rtamt.language.value_types import value_names
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.plot import style
from rtamt.plot.axes import Edges
from rtamt.plot.canvas import COLUMNS, ROW, Canvas, panel_heights
from rtamt.plot.figure import figure_for
from rtamt.plot.lines import Line, ranges
from rtamt.plot.panels import groups
from rtamt.plot.scene import Panel, sub_formulas
from rtamt.plot.x_axis import XAxis, visible
from rtamt.rewrite.truth import is_predicate
from rtamt.signals.outcomes import BoundedSignal
from rtamt.signals.sampling_period import merged
from rtamt.verdicts.robustness_and_truth import outputs_under

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from rtamt.language.formula import Formula
    from rtamt.results import Result
    from rtamt.signals.signal import Signal

#: Behind instants whose verdict the samples do not decide.
_OPEN = "#8c959f"
_SIGNS = {True: style.SIGNS[True], False: style.SIGNS[False], None: "?"}
_WORDS = {True: "satisfied", False: "violated", None: "open"}
_COLORS = {True: style.HOLDS, False: style.FAILS, None: style.QUIET}


@dataclass(frozen=True, slots=True, eq=False)
class _Bounds:
    """The bounds of a signal over positions."""

    name: str
    lower: Line
    upper: Line


@dataclass(frozen=True, slots=True, eq=False)
class _Robustness(_Bounds):
    """The bounds of a formula's robustness, and those of its verdict."""

    truth: tuple[Line, Line]

    def text_at(self, position: float, between: str = "{} to {}") -> str:
        """Return the bounds at a position as text; where they meet, the value."""
        low, high = self.lower.at(position), self.upper.at(position)
        if low == high:
            return style.number(low)
        return between.format(style.number(low, 3), style.number(high, 3))  # as there is room beside a row

    def verdict_at(self, position: float) -> bool | None:
        """Return the verdict at a position; None if the samples do not decide it."""
        holds, fails = self.truth[0].at(position) > 0, self.truth[1].at(position) < 0
        return holds if holds or fails else None


def draw_uncertain(
    result: Result,
    figure: Any,
    *,
    at: Any,
    rows: int,
    start: Any,
    end: Any,
    zoom: str | None,
    bounds: bool,
) -> Figure:
    """Draw the bounds of a result; the arguments and what is returned are those of :meth:`rtamt.Result.plot`."""
    if bounds:
        raise UsageError(
            "bounds after each sample are drawn for samples that are known exactly; leave bounds=True out"
        )
    if zoom is not None:
        raise UsageError(
            "samples are missing or uncertain, so there may be no first violation; give start and end"
        )
    trace = result.trace
    x_axis = XAxis.of(trace)
    window = visible(x_axis, start, end)
    place = 0 if at is None else trace.position(at)
    canvas: Figure = figure_for(figure)
    (position,) = x_axis.positions(trace.times_at(np.array([place]))).tolist()
    _Drawing(result, x_axis, canvas, window).draw(rows, position)
    return canvas


class _Drawing(Canvas):
    """The bounds of one result in one figure."""

    def __init__(self, result: Result, x_axis: XAxis, figure: Any, window: tuple[float, float]) -> None:
        super().__init__(x_axis, figure, window, dense=result.trace.domain.continuous)
        self._result = result
        self._spec = result.specification

    def draw(self, rows: int, position: float) -> None:
        formulas = sub_formulas(self._spec.formula)
        trace = self._result.trace
        recorded = {name: self._recorded(name) for name in trace.columns}
        found = groups(recorded, filter(is_predicate, formulas), trace.units)
        panels = [
            Panel(tuple(recorded[name].lower for name in group.names), group.thresholds, ())
            for group in found
        ]
        shown = self._robustness(formulas[:rows])
        satisfied = shown[0].verdict_at(position)
        title = f"{self._spec.name}: " if self._spec.name else ""
        bounds = shown[0].text_at(position, "from {} to {}")
        verdict = f"{_SIGNS[satisfied]} {title}{_WORDS[satisfied]}, robustness {bounds}"
        heights = panel_heights(panels) + [ROW] * len(shown)
        axes = self.rows(
            heights, verdict, predicate_text(self._spec.formula, self._spec.text), _COLORS[satisfied]
        )
        for group, axis in zip(found, axes[: len(found)], strict=True):
            self._panel([recorded[name] for name in group.names], group.thresholds, axis)
        for number, (each, axis) in enumerate(zip(shown, axes[len(found) :], strict=True)):
            self._row(each, axis, position, bold=number == 0)
        self.finish(axes)

    # ---- what is drawn -----------------------------------------------------------------------------

    def _recorded(self, name: str) -> _Bounds:
        """Return the bounds of the samples of a variable."""
        trace = self._result.trace
        positions, values = self.x_axis.recorded(name)
        lower, upper = trace.bounds.get(name, (values, values))
        unit, names = trace.units.get(name, ""), value_names(self._spec.types.get(name))
        return _Bounds(name, *(Line(name, positions, values, unit, names) for values in (lower, upper)))

    def _robustness(self, formulas: tuple[Formula, ...]) -> list[_Robustness]:
        """Return the bounds of the robustness of formulas and of their verdicts, all from one program."""
        result, spec = self._result, self._spec
        outputs = [outputs_under(formula, result.semantics, spec.roles) for formula in formulas]
        every = tuple(output for both in outputs for output in both)
        signals = iter(Evaluators(spec.backend)(every, result.trace))
        found = []
        for formula, robustness, truth in zip(formulas, signals, signals, strict=True):
            text, name = predicate_text(formula, spec.text), spec.document.names_of.get(formula)
            both = self._lines(robustness)
            found.append(_Robustness(f"{name} = {text}" if name else text, *both, self._lines(truth)))
        return found

    def _lines(self, signal: Signal) -> tuple[Line, Line]:
        """Return the lower and the upper bounds of a signal as lines."""
        positions = self.x_axis.positions(signal.times)
        if isinstance(signal, BoundedSignal):
            return Line("", positions, signal.lower), Line("", positions, signal.upper)
        return Line("", positions, signal.values), Line("", positions, signal.values)

    # ---- rows --------------------------------------------------------------------------------------

    def _panel(self, signals: list[_Bounds], thresholds: tuple[float, ...], axis: Any) -> None:
        ends = [
            self.in_view(line).decimated(COLUMNS) for each in signals for line in (each.lower, each.upper)
        ]
        finite = [line.values[np.isfinite(line.values)] for line in ends]
        edges = Edges(axis, np.concatenate([*finite, thresholds]), ends)
        for limit in thresholds:
            if isfinite(limit):
                axis.axhline(edges.place(limit), color=style.QUIET, linewidth=0.9, linestyle=(0, (5, 3)))
        labels = []
        for i, each in enumerate(signals):
            color = style.SIGNALS[i % len(style.SIGNALS)]
            self._band(each, axis, edges, color, color)
            known = each.lower.values[np.isfinite(each.lower.values)]
            labels.append((edges.place(known[-1]) if len(known) else edges.middle, each.lower.label, color))
        self.names(axis, labels)

    def _row(self, bounds: _Robustness, axis: Any, position: float, *, bold: bool) -> None:
        ends = [self.in_view(line).decimated(COLUMNS) for line in (bounds.lower, bounds.upper)]
        finite = np.concatenate([line.values[np.isfinite(line.values)] for line in ends])
        edges = Edges(axis, np.append(finite, 0.0), ends)
        holds, fails = bounds.truth[0].values > 0, bounds.truth[1].values < 0
        for label, wanted, color in (
            ("does not hold", fails, style.FAILS),
            ("open: the samples do not decide", ~(holds | fails), _OPEN),
        ):
            stretches = ranges(bounds.truth[0], wanted, dense=self.dense, end=self.x_axis.end)
            self.shade(axis, stretches, label, color)
        self.robustness_axis(axis)
        area = self._band(bounds, axis, edges, style.INK, style.BAND)
        self.marks.setdefault("between the bounds", area)
        self.row_title(axis, bounds.name, bold=bold)
        satisfied = bounds.verdict_at(position)
        text = f"{_SIGNS[satisfied]} {bounds.text_at(position)}"
        self.annotate(axis, text, f"at {self.x_axis.text(position)}", _COLORS[satisfied])

    def _band(self, bounds: _Bounds, axis: Any, edges: Edges, color: str, between: str) -> Any:
        """Draw the area between bounds, in a colour of its own, and the value where they meet; return the area."""
        both = [self.in_view(line) for line in (bounds.lower, bounds.upper)]
        kept = merged([line.decimated(COLUMNS).positions for line in both])
        chosen = np.searchsorted(both[0].positions, kept)
        lower, upper = (line.values[chosen] for line in both)
        places = self.places(kept)
        step = "post" if self.dense else "mid"
        area = axis.fill_between(
            places,
            edges.shown(lower),
            edges.shown(upper),
            step=step,
            color=between,
            alpha=0.35,
            linewidth=0,
        )
        exact = np.where(lower == upper, edges.shown(lower), np.nan)
        drawn: dict[str, Any] = (
            {"drawstyle": "steps-post"} if self.dense else {"marker": "o", "markersize": 3.2}
        )
        if len(kept) > COLUMNS / 2:
            drawn.pop("marker", None)
        axis.plot(places, exact, color=color, linewidth=1.4, **drawn)
        return area
