"""Pictures: what is drawn, read from the figure."""

import numpy as np
import pytest
from matplotlib.figure import Figure

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
