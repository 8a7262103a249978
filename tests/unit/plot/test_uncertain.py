"""Plots of results whose samples are missing or uncertain: bounds as bands."""

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

import rtamt
from rtamt.errors import UsageError

TEXT = "always[0:2](x >= 3) or y >= 1"
X, Y = [5, None, 4, 2, 6], [0.5, 0.0, 3.0, 0.0, 0.0]


@pytest.fixture(params=["discrete", "dense"])
def result(request):
    data = {"time": range(5), "x": X, "y": Y}
    options = {"ranges": {"x": (0, 10)}, "uncertainty": {"y": 0.25}}
    return rtamt.parse(TEXT, time=request.param).evaluate(data, **options)


def band_of(axis):
    """Return the lowest and the highest value between the bounds that a row shows, by its colour."""
    (area,) = (each for each in axis.collections if isinstance(each, PolyCollection))
    vertices = area.get_paths()[0].vertices
    return vertices[:, 1].min(), vertices[:, 1].max()


def test_each_row_shows_the_bounds_of_its_formula(result):
    figure = result.plot(figure=Figure())
    rows = {axis.get_title(loc="left"): axis for axis in figure.axes}
    assert list(rows)[1:] == [TEXT, "always[0:2](x >= 3)", "y >= 1", "x >= 3"]
    for title in list(rows)[1:]:
        bounds = result[title]
        shown = bounds.times >= 0
        assert band_of(rows[title]) == (bounds.lower[shown].min(), bounds.upper[shown].max())


def test_verdict_and_bounds_are_those_of_the_instant(result):
    figure = result.plot(figure=Figure())
    assert result.interval == rtamt.Interval(-0.75, 1.0)
    assert figure.texts[0].get_text() == "? open, robustness from −0.75 to 1"
    assert "? −0.75 to 1" in [text.get_text() for text in figure.axes[2].texts]
    later = result.plot(at=2, figure=Figure())
    assert later.texts[0].get_text() == "✓ satisfied, robustness from 1.75 to 2.25"


def test_missing_samples_of_any_value_reach_the_edges():
    result = rtamt.parse("x >= 3").evaluate({"x": [5, None, 4]})
    figure = result.plot(figure=Figure())
    assert [label.get_text() for label in figure.axes[1].get_yticklabels()][-2:] == ["−∞", "+∞"]
    line = figure.axes[0].lines[-1].get_ydata()
    assert np.isnan(line).tolist() == [False, True, False]


def test_long_traces_of_dates_are_drawn():
    n = 20_000
    values = np.sin(np.arange(n) / 50)
    times = np.datetime64("2026-05-01") + np.arange(n) * np.timedelta64(1, "s")
    spec = rtamt.parse("near = x <= 0.9; always[0:10](near)")
    result = spec.evaluate({"time": times, "x": values}, uncertainty={"x": 0.05})
    figure = result.plot(start=times[500], end=times[15_000], figure=Figure())
    assert figure.texts[0].get_text().startswith("✓ satisfied, robustness from 0.")
    assert len(figure.axes[0].lines[-1].get_xdata()) < n / 2


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"bounds": True}, "bounds after each sample are drawn for samples that are known exactly"),
        ({"zoom": "violation"}, "samples are missing or uncertain, so there may be no first violation"),
        ({"at": 9}, r"(there is no sample at 9;|9 is no instant of) the recording.* from 0 s to 4 s"),
        ({"start": 7}, "there is nothing to plot from 7 s to 4 s; the trace lasts from 0 s to 4 s"),
    ],
)
def test_what_cannot_be_drawn_is_an_error(result, options, message):
    with pytest.raises(UsageError, match=f"^{message}"):
        result.plot(figure=Figure(), **options)


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize("semantics", ["standard", "output_robustness"])
def test_untimed_formulas_without_predicates_are_drawn(time, semantics):
    spec = rtamt.parse("input float x; output float y; y >= 1", time=time)
    result = spec.evaluate(
        {"time": [0, 1], "x": [1, None], "y": [2, 3]}, semantics=semantics, uncertainty={"y": 1}
    )
    assert result.plot(figure=Figure()).axes


def test_values_of_an_enumeration_have_their_names():
    spec = rtamt.parse("enum Mode { idle, ready, busy }\ninput Mode mode\nalways[0:1](mode == ready)")
    result = spec.evaluate({"mode": ["idle", None, "ready", "busy"]})
    figure = result.plot(figure=Figure())
    assert {"idle", "ready", "busy"} <= {label.get_text() for label in figure.axes[0].get_yticklabels()}


def test_many_short_stretches_are_joined():
    n = 100_000
    result = rtamt.parse("x >= 0").evaluate({"x": np.tile([-1.0, 0.0, 1.0], n)}, uncertainty={"x": 0.5})
    assert len(result.plot(figure=Figure()).axes[-1].patches) <= 2000


def test_each_signal_of_a_panel_has_a_band_of_its_colour():
    data = {"x": [5, None, 4], "y": [1, 2, None]}
    figure = rtamt.parse("x >= y").evaluate(data, ranges={"x": (0, 9), "y": (0, 9)}).plot(figure=Figure())
    areas = [each for each in figure.axes[0].collections if isinstance(each, PolyCollection)]
    assert len({tuple(area.get_facecolor()[0]) for area in areas}) == 2
