"""Pictures: what is drawn, read from the figure."""

from io import BytesIO
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

import rtamt

CASES = {
    "past": ("historically[0:2](x >= 3) and once(y < 1)", {"x": [5, 4, 2, 6], "y": [0, 1, 2, 3]}),
    "until": ("(x >= 3) until[0:2] (y >= 3)", {"x": [5, 4, 2, 6], "y": [0, 1, 5, 3]}),
    "one sample": ("always(x >= 3)", {"x": [5]}),
    "infinite": ("always[5:9](x >= y)", {"x": [5, 4], "y": [np.inf, -np.inf]}),
    "no predicate": ("always(true)", {"time": [0, 1]}),
    "arithmetic": ("abs(x) + 2 * y <= 4 -> next(x > y)", {"x": [5, 4, 2, 6], "y": [0, 1, 5, 3]}),
}


def titles(figure):
    return [axis.get_title(loc="left") for axis in figure.axes]


@pytest.mark.parametrize("name", CASES)
def test_every_kind_of_result_is_drawn(name):
    text, data = CASES[name]
    result = rtamt.parse(text).evaluate(data)
    figure = result.plot(figure=Figure())
    assert text in titles(figure)
    figure.canvas.draw()
    result.plot_tree(figure=Figure()).canvas.draw()


def test_infinities_are_at_the_edge_with_a_sign():
    figure = rtamt.parse("always[3:5](x >= 3)").evaluate({"x": [5, 1]}).plot(figure=Figure())
    row = figure.axes[1]
    assert [label.get_text() for label in row.get_yticklabels()][-1] == "+∞"
    drawn = next(line for line in row.lines if len(line.get_xdata()) == 2 and line.get_marker() == "o")
    assert np.isfinite(drawn.get_ydata()).all()
    assert drawn.get_ydata()[0] == row.get_yticks()[-1]


def test_values_of_dense_time_hold_and_violations_are_shaded():
    spec = rtamt.parse("x >= 3", time="dense")
    row = spec.evaluate({"x": [[0, 5], [1.5, 1], [4, 6]]}).plot(figure=Figure()).axes[1]
    drawn = next(line for line in row.lines if line.get_drawstyle() == "steps-post")
    assert drawn.get_xdata().tolist() == [0, 1.5, 4]
    assert (1.5, 4.0) in {(p.get_x(), p.get_x() + p.get_width()) for p in row.patches}


def test_a_large_recording_is_drawn_with_few_points_and_all_peaks():
    x = np.zeros(200_000)
    x[77_777] = -9
    row = rtamt.parse("x >= 0").evaluate({"x": x}).plot(figure=Figure()).axes[1]
    drawn = max(row.lines, key=lambda line: len(line.get_xdata()))
    assert len(drawn.get_xdata()) <= 12_000
    assert drawn.get_ydata().min() == -9


def test_rows_limit_the_formulas_and_the_named_ones_come_first():
    spec = rtamt.parse("low = x <= 9; always(eventually[0:1](x >= 3) and once(low))")
    figure = spec.evaluate({"x": [5, 1, 4]}).plot(rows=2, figure=Figure())
    assert titles(figure)[1:] == ["always(eventually[0:1](x >= 3) and once(low))", "low = x <= 9"]


def test_a_figure_of_pyplot_is_made_where_none_is_given():
    pyplot = pytest.importorskip("matplotlib.pyplot")
    figure = rtamt.parse("x >= 0").evaluate({"x": [1]}).plot()
    assert pyplot.fignum_exists(figure.number)
    pyplot.close(figure)


def drawn(axis):
    return max(axis.lines, key=lambda line: len(line.get_xdata()))


def test_a_part_of_the_time_is_drawn_with_its_own_values():
    x = np.where(np.arange(2000) == 900, 50.0, np.sin(np.arange(2000) / 50))
    result = rtamt.parse("always(x <= 0.99)").evaluate({"x": x})
    panel = result.plot(start=100, end=140, figure=Figure()).axes[0]
    assert drawn(panel).get_xdata().tolist() == list(range(100, 141))
    assert panel.get_ylim()[1] < 2
    panel = result.plot(zoom="violation", figure=Figure()).axes[0]
    low, high = panel.get_xlim()
    assert low < 72 < high < 120  # sin(i / 50) exceeds 0.99 from 72 s on
    assert drawn(panel).get_marker() == "o"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"start": 5, "end": 2}, "there is nothing to plot from 5 s to 2 s; the trace lasts from 0 s to 9 s"),
        ({"start": 20}, "there is nothing to plot from 20 s to 9 s; the trace lasts from 0 s to 9 s"),
        ({"zoom": "violation"}, "cannot zoom to the violation: the formula is satisfied, robustness 0"),
        ({"zoom": "all"}, "cannot zoom to 'all'; the only choice is 'violation'"),
    ],
)
def test_what_cannot_be_seen_is_one_sentence(options, message):
    result = rtamt.parse("always(x >= 0)").evaluate({"x": range(10)})
    with pytest.raises(rtamt.UsageError, match=f"^{message}$"):
        result.plot(figure=Figure(), **options)


def test_a_signal_that_starts_early_left_marks_beside_the_axis():
    spec = rtamt.parse("always(x <= y)", time="dense")
    panel = (
        spec.evaluate({"x": (np.arange(0, 10, 0.5), np.zeros(20)), "y": ([5.25, 9], [1, 2])})
        .plot(figure=Figure())
        .axes[0]
    )
    for line in panel.lines:
        if len(line.get_xdata()) > 2:
            assert min(line.get_xdata()) == 5.25
        assert line.get_clip_on() or line.get_marker() == "D"


def test_names_of_many_signals_do_not_overlap():
    names = [f"vehicle_attitude_setpoint.roll_{i}" for i in range(8)]
    formula = " and ".join(f'"{a}" <= "{b}" + 5' for a, b in pairwise(names))
    figure = rtamt.parse(formula).evaluate({name: [0, 1] for name in names}).plot(figure=Figure())
    figure.canvas.draw()
    boxes = sorted(
        (t.get_window_extent().extents[[1, 3]] for t in figure.axes[0].texts), key=lambda box: box[0]
    )
    assert len(boxes) == 8
    assert all(below[1] <= above[0] + 1 for below, above in pairwise(boxes))
    assert boxes[0][0] > figure.axes[1].get_window_extent().y1


def test_a_dense_line_with_few_other_lines_had_a_band_of_markers():
    times = np.arange(5000) / 100
    spec = rtamt.parse("always(x <= 2)", time="dense")
    figure = spec.evaluate({"x": (times, np.sin(times))}).plot(figure=Figure())
    markers = {axis.get_title(loc="left"): drawn(axis).get_marker() for axis in figure.axes}
    assert markers["x <= 2"] == "None"
    assert drawn(figure.axes[0]).get_marker() == "None"


def test_values_of_parts_are_those_at_the_first_violation():
    figure = (
        rtamt.parse("always(x >= 3 -> y >= 3)").evaluate({"x": [0, 5], "y": [9, 1]}).plot(figure=Figure())
    )
    told = {axis.get_title(loc="left"): [text.get_text() for text in axis.texts] for axis in figure.axes[2:]}
    assert told["always(x >= 3 -> y >= 3)"] == ["✗ −2", "at 0 s"]
    assert told["y >= 3"] == ["✗ −2", "at 1 s"]


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_band_of_a_visible_part_begins_with_the_bounds_known_before(time):
    spec = rtamt.parse("eventually[0:4](x >= 3)", time=time)
    result = spec.evaluate({"time": [0, 1, 2, 3, 4], "x": [1, 2, 7, 5, 5]})
    figure = result.plot(start=1.5, bounds=True, figure=Figure())
    lower, _ = (line for line in figure.axes[-1].lines if line.get_drawstyle() == "steps-post")
    assert lower.get_xdata()[:2].tolist() == [1.5, 2.0]
    assert lower.get_ydata()[:2].tolist() == [-1.0, 4.0]


@pytest.mark.parametrize("name", ["$x^{2$", "$x$", "a\\$b", "cost $", "a\x07b"])
def test_dollars_and_control_characters_of_a_name_are_drawn_as_they_are(name):
    spec = rtamt.parse(f'always("{name}" >= 2)')
    result = spec.evaluate({name: [1.0, 3.0]})
    for figure in (result.plot(figure=Figure()), result.plot_tree(figure=Figure())):
        drawn = [text._preprocess_math(text.get_text()) for text in figure.findobj(Text)]
        assert not any(mathematics for _, mathematics in drawn)
        shown = name.replace("\x07", r"\x07")
        assert any(shown in text for text, _ in drawn)
        figure.savefig(BytesIO())


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("time", "last"), [("discrete", 0), ("dense", 0), ("discrete", None)])
def test_values_near_the_largest_double_are_drawn(time, last):
    data = {"time": range(4), "x": [1e308, -1e308, 1e308, last]}
    figure = rtamt.parse("always(x >= -1e307)").evaluate(data, time=time).plot(figure=Figure())
    figure.savefig(BytesIO())
    assert "8e+307" in [label.get_text() for label in figure.axes[0].get_yticklabels()]
