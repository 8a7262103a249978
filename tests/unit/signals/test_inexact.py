"""Offline evaluation of samples that are missing or uncertain: bounds instead of a number."""

from __future__ import annotations

import math
import re

import numpy as np
import pyarrow as pa
import pytest

import rtamt
from rtamt import Interval
from rtamt.errors import EvaluationError, TraceError, UsageError

pandas = pytest.importorskip("pandas")
polars = pytest.importorskip("polars")


def test_a_noisy_recording_has_bounds():
    result = rtamt.parse("always(x >= 3)").evaluate({"x": [5, 4, 6]}, uncertainty={"x": 0.5})
    assert result.interval == Interval(0.5, 1.5)
    assert result.intervals.upper.tolist() == [1.5, 1.5, 3.5]
    assert result.satisfied is True


def test_exact_samples_have_equal_bounds():
    result = rtamt.parse("always(x >= 3)").evaluate({"x": [5, 4, 6]}, ranges={"x": (0, 10)})
    assert result.interval == Interval(1.0, 1.0)
    assert result.robustness == 1.0


GAPS = {
    "None": [5.0, None, 4.0],
    "masked": np.ma.masked_array([5.0, 0.0, 4.0], [False, True, False]),
    "Arrow": pa.array([5, None, 4]),
    "chunks of Arrow": pa.chunked_array([[5.0, None], [4.0]]),
    "pandas integers": pandas.array([5, None, 4], dtype="Int64"),
    "pandas series": pandas.Series([5, pandas.NA, 4], dtype="Float64"),
    "objects of pandas": pandas.Series([5, pandas.NA, 4], dtype=object),
    "polars": polars.Series([5, None, 4]),
}


@pytest.mark.parametrize("x", [pytest.param(x, id=name) for name, x in GAPS.items()])
def test_a_missing_sample_is_known_to_lie_in_its_range(x):
    result = rtamt.parse("always(x >= 3)").evaluate({"x": x}, ranges={"x": (2, 9)})
    assert result.interval == Interval(-1.0, 1.0)
    assert rtamt.parse("always(x >= 3)").evaluate({"x": x}).interval == Interval(-math.inf, 1.0)


def test_columns_of_frames_may_have_gaps():
    for frame in (
        pandas.DataFrame({"time": [0.0, 1.0], "x": pandas.array([4, None], dtype="Int64")}),
        polars.DataFrame({"time": [0.0, 1.0], "x": [4, None]}),
    ):
        assert rtamt.parse("x >= 3").evaluate(frame).robustness == 1.0


def test_the_data_is_left_as_it_is():
    x = [5.0, None, 4.0]
    rtamt.parse("always(x >= 3)").evaluate({"x": x})
    assert x == [5.0, None, 4.0]


def test_a_number_is_returned_where_the_samples_determine_it():
    result = rtamt.parse("eventually[0:1](x >= 3) or y >= 0").evaluate(
        {"x": [1, None], "y": [7, -1]}, ranges={"x": (0, 5)}
    )
    assert result.robustness == 7.0
    assert result.satisfied is True
    message = (
        "the robustness at time 1 is only known to lie between -1 and 2, because samples are missing or uncertain; "
        "read result.interval or result.intervals, or evaluate without gaps: hold the values before them "
        "(hold_for= of rtamt.read), or resample (trace.resample(period=...))"
    )
    with pytest.raises(EvaluationError, match=f"^{re.escape(message)}$"):
        _ = result.signal.values


@pytest.mark.parametrize(
    "filled",
    [lambda data: rtamt.read(data, hold_for="1s"), lambda data: rtamt.read(data).resample(period="1s")],
    ids=["hold_for", "resample"],
)
def test_gaps_filled_as_the_error_of_the_robustness_suggests_leave_a_number(filled):
    data = {"time": [0, 1, 2, 3], "x": [1, None, 2, 4]}
    spec = rtamt.parse("always[0:1](x > 0)")
    with pytest.raises(EvaluationError, match=r"hold_for= of rtamt\.read.*trace\.resample\(period=\.\.\.\)"):
        _ = spec.evaluate(data).robustness
    assert spec.evaluate(filled(data)).robustness == 1.0


def test_a_verdict_that_the_samples_do_not_decide_is_an_error():
    result = rtamt.parse("always(x >= 3)").evaluate({"x": [5, None]})
    message = (
        "the samples do not decide whether the formula holds, because some are missing or uncertain; "
        "read result.interval"
    )
    with pytest.raises(EvaluationError, match=f"^{re.escape(message)}$"):
        _ = result.satisfied
    assert rtamt.parse("always(x >= 3)").evaluate({"x": [1, None]}).satisfied is False


def test_in_dense_time_a_missing_sample_is_open_until_the_next():
    spec = rtamt.parse("x >= 3", time="dense", resolution="1s")
    result = spec.evaluate({"x": [[0, 4], [2, None], [5, 3]]}, ranges={"x": (0, 9)})
    assert result.intervals.times.tolist() == [0, 2, 5]
    assert result.intervals.lower.tolist() == [1, -3, 0]
    assert result.intervals.upper.tolist() == [1, 6, 0]
    shared = spec.evaluate({"time": [0, 2, 5], "x": [4, None, 3]}, ranges={"x": (0, 9)})
    assert shared.intervals.upper.tolist() == [1, 6, 0]


def test_each_requirement_has_its_own_bounds():
    spec = rtamt.parse("require low: always(x <= 3); require high: always(y >= 1)")
    result = spec.evaluate({"x": [1, None], "y": [2, 5]})
    assert result.interval == Interval(-math.inf, 1.0)
    assert result.requirements["high"].robustness == 1.0
    assert result.requirements["low"].interval == Interval(-math.inf, 2.0)


REJECTED = {
    "NaN": (
        {"x": [1.0, math.nan, None]},
        {},
        "'x' is NaN at sample 1, time 1 s: fill the gap or leave the sample out",
    ),
    "text": ({"x": [1.0, "high", None]}, {}, "'x' is 'high' at sample 1, expected a number"),
    "outside": (
        {"x": [1.0, 7.0]},
        {"ranges": {"x": (0, 5)}},
        "'x' is 7 at sample 1, outside its declared range [0, 5]: correct the value, or declare a wider range",
    ),
    "reversed": (
        {"x": [1.0]},
        {"ranges": {"x": (5, 0)}},
        "the range of 'x' is reversed: 5 is greater than 0; give (lowest, highest)",
    ),
    "no range": (
        {"x": [1.0]},
        {"ranges": {"x": 5}},
        "the range of 'x' is 5; give (lowest, highest), such as (0, 120)",
    ),
    "negative": (
        {"x": [1.0]},
        {"uncertainty": {"x": -1}},
        "the uncertainty of 'x' is -1; give a number that is not negative",
    ),
    "a number for all": (
        {"x": [1.0]},
        {"uncertainty": 0.1},
        "uncertainty=0.1 is no mapping from variables; give for example {'x': 0.1}",
    ),
    "unknown": (
        {"x": [1.0]},
        {"uncertainty": {"xs": 1}},
        "uncertainty= has 'xs', and the formula reads x; did you mean 'x'?",
    ),
}


@pytest.mark.parametrize(
    ("data", "options", "message"), [pytest.param(*row, id=name) for name, row in REJECTED.items()]
)
def test_wrong_input_is_rejected_with_one_sentence(data, options, message):
    with pytest.raises((TraceError, UsageError), match=f"^{re.escape(message)}$"):
        rtamt.parse("always(x >= 3)").evaluate(data, **options)


@pytest.mark.parametrize(("method", "what"), [("explain", "explain"), ("plot_tree", "draw the tree of")])
def test_bounds_have_no_explanation(method, what):
    result = rtamt.parse("x >= 3").evaluate({"x": [None]})
    message = (
        f"cannot {what} a result of missing or uncertain samples; read result.interval, or evaluate samples that are "
        f"known exactly"
    )
    with pytest.raises(UsageError, match=f"^{re.escape(message)}$"):
        getattr(result, method)()


def test_verdict_of_a_result_at_robustness_zero_is_that_of_satisfied():
    result = rtamt.parse("eventually(x >= 3)").evaluate({"x": [3, None]}, ranges={"x": (0, 3)})
    assert (result.interval, result.satisfied) == (rtamt.Interval(0.0, 0.0), True)
    assert "<td>satisfied</td>" in result._repr_html_()
