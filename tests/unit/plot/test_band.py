"""Bounds after each sample: a band that narrows to the robustness."""

from __future__ import annotations

import numpy as np
from hypothesis import assume, given
from matplotlib.figure import Figure

import rtamt
from rtamt.errors import EvaluationError, TraceError
from rtamt.language.printing.printer import to_text
from rtamt.plot.band import band
from rtamt.rewrite.early import ends_differently
from rtamt.verdicts.early.check import holds_at_end
from tests.support.strategies import dense_traces, formulas, traces


@given(formulas(unbounded_future=True), traces(max_size=12))
def test_a_band_only_narrows_and_holds_the_robustness(formula, columns):
    spec = rtamt.parse(to_text(formula), period=1)
    assume(spec.input_names)
    try:
        result = spec.evaluate({name: columns[name] for name in spec.input_names})
        found = band(result)
    except EvaluationError:
        return
    assert (np.diff(found.lower[np.isfinite(found.lower)]) >= 0).all()
    assert (np.diff(found.upper[np.isfinite(found.upper)]) <= 0).all()
    if ends_differently(spec.formula, {}) is None:
        assert (found.lower <= found.robustness).all()
        assert (found.upper >= found.robustness).all()
    if found.decided is not None and holds_at_end(spec):
        assert (found.upper[-1] <= 0) if not result.satisfied else (found.lower[-1] >= 0)


def test_dates_and_the_sample_that_decided():
    times = np.array(["2024-05-01T12:00:00", "2024-05-01T12:00:01", "2024-05-01T12:00:02"], "M8[ns]")
    found = band(rtamt.parse("always(x >= 3)").evaluate({"time": times, "x": [4, 1, 5]}))
    assert (found.positions.tolist(), found.decided, found.upper.tolist()) == ([0, 1, 2], 1.0, [1, -2, -2])


@given(formulas(discrete=False, unbounded_future=True), dense_traces(max_size=8))
def test_a_band_in_dense_time_only_narrows_and_holds_the_robustness(formula, columns):
    spec = rtamt.parse(to_text(formula), time="dense", resolution=1)
    assume(spec.input_names)
    try:
        result = spec.evaluate({name: columns[name] for name in spec.input_names})
        found = band(result)
    except (EvaluationError, TraceError):
        return
    assert (np.diff(found.lower[np.isfinite(found.lower)]) >= 0).all()
    assert (np.diff(found.upper[np.isfinite(found.upper)]) <= 0).all()
    assert (found.lower <= found.robustness).all()
    assert (found.upper >= found.robustness).all()
    assert (np.diff(found.positions) > 0).all()
    if found.decided is not None:
        assert (found.upper[-1] <= 0) if not result.satisfied else (found.lower[-1] >= 0)


def test_dense_time_has_a_band_over_the_samples_of_all_variables():
    data = {"x": ([0, 1, 3.5], [4, 1, 9]), "y": ([0.5, 2], [0, 0])}
    result = rtamt.parse("always(x >= 3 or y >= 1)", time="dense").evaluate(data)
    found = band(result)
    assert found.positions.tolist() == [0.5, 1, 2, 3.5]
    assert (found.upper.tolist(), found.decided) == ([np.inf, 1, -1, -1], 2)
    axis = result.plot(bounds=True, figure=Figure()).axes[-1]
    assert axis.get_title(loc="left") == "bounds of the robustness at the start, after each sample"


def test_a_plot_has_a_row_with_the_band_and_says_when_the_verdict_was_decided():
    result = rtamt.parse("always(x >= 3)").evaluate({"x": [5, 4, 2, 6]})
    axis = result.plot(bounds=True, figure=Figure()).axes[-1]
    assert axis.get_title(loc="left") == "bounds of the robustness at the start, after each sample"
    assert [text.get_text() for text in axis.texts] == ["decided", "at 2 s"]
    assert len(axis.collections) == 1
