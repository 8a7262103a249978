"""What notebooks show, and traces as notebooks use them: slices, data frames, derived signals."""

from __future__ import annotations

import re

import numpy as np
import pytest
from matplotlib import pyplot as plt

import rtamt

TRACE = {"time": [0.0, 1.0, 2.0, 3.0], "x <&> [m/s]": [5, 4, 2, 6], "y": [1, 1, 1, 1]}


@pytest.fixture
def result() -> rtamt.Result:
    spec = rtamt.parse(
        'specification s require "A<b>" "text & more": always("x <&>" >= 3); require B: always(y >= 0)'
    )
    return spec.evaluate(rtamt.read(TRACE))


def test_notebooks_show_tables_in_which_no_name_is_markup(result):
    trace = rtamt.read(TRACE)
    shown = [each._repr_html_() for each in (result.specification, result, result.explain(), trace)]
    for html in shown:
        assert set(re.findall(r"</?([^\s>]+)", html)) <= {"b", "table", "tr", "th", "td", "code", "p", "pre"}
    spec, table, explanation, signals = shown
    assert "<td>A&lt;b&gt;</td>" in spec
    assert "text &amp; more" in spec
    assert "<td>-1</td><td>violated, first at 2 s</td>" in table
    assert "<td>1</td><td>satisfied</td>" in table
    assert "first violation at 2 s" in explanation
    assert "<td>x &lt;&amp;&gt;</td><td>m/s</td><td>4 samples, 0 s to 3 s</td>" in signals


def test_a_plot_as_last_expression_of_a_cell_is_shown_once(result, monkeypatch):
    plt.close("all")
    monkeypatch.setattr(plt, "get_backend", lambda: "module://matplotlib_inline.backend_inline")
    figures = [result.plot(), result.plot_tree()]
    assert plt.get_fignums() == []  # those a notebook shows by itself, at the end of the cell
    assert all(figure.axes for figure in figures)


@pytest.mark.parametrize("kind", ["M8[ns]", "m8[ns]", "f8"])
def test_times_since_1970_are_dates_and_never_raw_numbers(kind):
    timestamps = np.array([1_700_000_000_000_000_000 + i * 500_000_000 for i in range(3)])
    trace = rtamt.read(
        {"time": timestamps / 1e9 if kind == "f8" else timestamps.astype(kind), "x": [5, 1, 4]}
    )
    result = rtamt.parse("always(x >= 3)", period="500ms").evaluate(trace)
    assert "violated, first at 2023-11-14 22:13:20.5 (+0.5 s)" in result._repr_html_()
    for text in (str(trace), trace._repr_html_()):
        assert re.search("2023-11-14[ T]22:13:20 to 2023-11-14[ T]22:13:21", text)
        assert "1700000" not in text


@pytest.mark.parametrize(
    ("timestamps", "low", "high"),
    [
        ([0.0, 1.0, 2.0, 3.0], 1, 2.0),
        (np.datetime64("2026-05-01T12:00:00", "ns") + np.array([0, 1, 2, 3], "m8[s]"),
         "2026-05-01T12:00:01", np.datetime64("2026-05-01T12:00:02")),
        (np.array([0, 1, 2, 3], "m8[s]") + np.timedelta64(2**60, "ns"), 1152921505.5, 1152921507.0),
    ],
)  # fmt: skip
def test_a_slice_has_the_samples_from_one_time_to_the_other(timestamps, low, high):
    trace = rtamt.read({"time": timestamps, "x": [5, 4, 2, 6]})
    part = trace[low:high]
    assert part["x"].values.tolist() == [4, 2]
    assert (trace[:]["x"].values.tolist(), trace[low:]["x"].values.tolist()[-1]) == ([5, 4, 2, 6], 6)
    assert rtamt.parse("always(x >= 2)", period=1).evaluate(part).satisfied


def test_what_no_slice_can_be():
    trace = rtamt.read({"time": [0, 1], "x": [1, 2]})
    with pytest.raises(
        rtamt.UsageError, match=r"^'noon' cannot begin or end a slice of this trace; give a number"
    ):
        trace["noon":]
    with pytest.raises(rtamt.UsageError, match=r"takes two times; put it on another time base with resample"):
        trace[0:1:2]
    with pytest.raises(rtamt.TraceError, match="'x' has no timestamps"):
        rtamt.read({"x": [1]})[0:1]


def test_a_trace_as_a_data_frame_is_the_trace_again():
    trace = rtamt.read({"x": ([0.0, 1.0, 2.0], [1, 2, 3]), "y": ([1.0, 2.5], [4, 5])})
    frame = trace.to_pandas()
    assert frame.index.tolist() == [0.0, 1.0, 2.0, 2.5]
    again = rtamt.read(frame.reset_index(), skip_nan=["x", "y"])
    for name in trace:
        np.testing.assert_array_equal(again[name].times, trace[name].times)
        np.testing.assert_array_equal(again[name].values, trace[name].values)


def test_a_derived_signal_is_a_signal_of_the_trace_and_the_trace_before_stays():
    trace = rtamt.read({"time": [0, 1], "v [m/s]": [5, 10]})
    more = trace.extended({"kmh": rtamt.parse("v * 3.6").evaluate(trace).signal}, units={"kmh": "km/h"})
    assert (trace.names, more.names, more.units) == (("v",), ("v", "kmh"), {"v": "m/s", "kmh": "km/h"})
    assert rtamt.parse("always(kmh >= 18)").evaluate(more).robustness == 0
    with pytest.raises(rtamt.UsageError, match=r"^'w' is 3; give a signal, such as rtamt.Signal"):
        trace.extended({"w": 3})


def test_a_result_of_missing_samples_is_shown_with_the_bounds_that_are_known():
    spec = rtamt.parse("require A: always(x > 0); require B: eventually(x > 0); require C: eventually(x > 9)")
    result = spec.evaluate({"x": [1, -1, None]})
    for name, bounds, verdict in (
        ("A", "from -inf to -1", "violated"),
        ("B", "from 1 to inf", "satisfied"),
        ("C", "from -8 to inf", "open"),
    ):
        shown = result.requirements[name]._repr_html_()
        assert f"<td>{bounds}</td><td>{verdict}</td>" in shown
    assert repr(result.requirements["A"]) == "<result of A: robustness from -inf to -1.0 at 0.0>"
