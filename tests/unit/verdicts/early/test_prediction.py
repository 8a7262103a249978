"""Predictions of later samples: bounds under them, and their radius."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import inf
from random import Random

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import rtamt
from rtamt import Interval
from rtamt.compiler.graph import NEVER
from rtamt.errors import EvaluationError
from rtamt.reference import dense_robustness
from rtamt.rewrite.horizon import horizon
from rtamt.signals.dense import Dense
from rtamt.signals.discrete import DISCRETE
from rtamt.verdicts.early.dense_interval import DenseIntervalMonitor
from rtamt.verdicts.early.discrete_interval import DiscreteIntervalMonitor
from tests.laws.early.cases import case, dense_case
from tests.laws.early.laws import NothingToCheck, rho

BACKENDS = ("cpp", "python")


def draw(rng, drawn, i):
    """Draw a prediction from sample i on that the truth fulfils, or None for some variables."""
    prediction = {}
    for name in drawn.names:
        ahead = drawn.truth[name][i:]
        margin = rng.randint(0, 2) / 2
        kind = rng.choice(["none", "constant", "arrays", "array and number"])
        if kind == "constant":
            prediction[name] = (min(ahead) - margin, max(ahead) + margin)
        elif kind == "arrays":
            known = np.array(ahead[: rng.randint(0, len(ahead))])
            prediction[name] = (known - margin, known + margin)
        elif kind == "array and number":
            known = ahead[: rng.randint(0, len(ahead))]
            prediction[name] = ([v - margin for v in known], max(ahead))
    return prediction


@given(seed=st.integers(0, 2**32), late=st.booleans())
def test_robustness_lies_within_the_bounds_under_a_prediction_that_comes_true(seed, late):
    rng = Random(seed)
    drawn = case(rng, odd=False)
    assume(horizon(drawn.formula) is not None)
    monitors = [
        DiscreteIntervalMonitor(
            drawn.formula,
            DISCRETE.online,
            ranges={name: limits for name, limits in drawn.ranges.items() if name in drawn.names},
            backend=backend,
            **({"on_correction": "replay"} if late else {}),
        )
        for backend in BACKENDS
    ]
    try:
        expected = rho(drawn.formula, drawn.truth, len(next(iter(drawn.truth.values()))))
        for i, row in enumerate(drawn.samples):
            for monitor in monitors:
                monitor.update(i, **row)
            if late and monitors[0]._early:
                continue
            prediction = draw(rng, drawn, i + 1)
            t = i
            before = [monitor.interval() for monitor in monitors]
            found = [
                (m.interval(prediction=prediction), m.interval(t, prediction=prediction)) for m in monitors
            ]
            assert found[0] == found[1]
            assert [monitor.interval() for monitor in monitors] == before
            for bounds, at in zip(found[0], (0, t), strict=True):
                assert bounds.lower <= expected[at] <= bounds.upper
            assert before[0].lower <= found[0][0].lower <= found[0][0].upper <= before[0].upper
    except (EvaluationError, NothingToCheck):
        assume(False)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("text", "x", "y", "bounds"),
    [
        ("eventually[0:2](x + y >= 1)", [inf], [-inf], Interval(1.0, inf)),
        ("eventually[0:2](sqrt(minimum[0:1](x)) + y >= 1)", [-9, -3], [1, 1], Interval(1.0, inf)),
    ],
)
def test_an_operation_without_a_value_under_a_prediction_is_no_error(backend, text, x, y, bounds):
    monitor = rtamt.parse(text, backend=backend).monitor(verdict="interval", at="every")
    monitor.update(0, x=1, y=1)
    assert monitor.interval(0, prediction={"x": (x, x), "y": (y, y)}) == bounds
    with pytest.raises(EvaluationError, match="has no value at sample 1"):
        monitor.update(1, x=x[0], y=y[0])


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("lateness", [None, "1s"])
def test_a_sum_since_the_start_takes_in_predicted_samples(backend, lateness):
    spec = rtamt.parse("always[0:3](sum(x) <= 10)", backend=backend)
    monitor = spec.monitor(verdict="interval", lateness=lateness)
    for t, x in enumerate([2, 1]):
        monitor.update(t, x=x)
    monitor.watermark(1)
    before = monitor.interval(), monitor.interval(1)
    assert before[0] == Interval(-inf, 7.0)
    predicted = {"x": ([1, -5, 2], [3, 4, 2.5])}
    # The sums are 2, 3, [4, 6], [-1, 10] and [1, 12.5].
    assert monitor.interval(prediction=predicted) == Interval(0.0, 6.0)
    assert monitor.interval(1, prediction=predicted) == Interval(-2.5, 6.0)
    # The sample after the predicted ones may be anything.
    assert monitor.interval(1, prediction={"x": ([1, -5], [3, 4])}) == Interval(-inf, 6.0)
    assert (monitor.interval(), monitor.interval(1)) == before
    monitor.update(2, x=9)
    assert monitor.interval() == Interval(-inf, -2.0)


def dense_draw(rng, drawn, came):
    """Draw a prediction that the signals fulfil behind the newest samples, or None for some variables."""
    prediction = {}
    for name in drawn.names:
        times, values = drawn.truth[name]
        newest = max((t for t, row in came if name in row), default=times[0])
        i = times.index(newest)
        margin = rng.randint(0, 2) / 2
        kind = rng.choice(["none", "constant", "arrays"])
        if kind == "constant":
            prediction[name] = (min(values[i:]) - margin, max(values[i:]) + margin)
        elif kind == "arrays":
            later = np.array(values[i + 1 :])
            prediction[name] = (times[i + 1 :], later - margin, later + margin)
    return prediction


@given(seed=st.integers(0, 2**32), late=st.booleans())
def test_dense_robustness_lies_within_the_bounds_under_a_prediction_that_comes_true(seed, late):
    rng = Random(seed)
    drawn = dense_case(rng, ordered=True)
    if late:  # what has not come by its lateness never will
        came, last = {(t, name) for t, row in drawn.updates for name in row}, drawn.updates[-1][0]
        truth = {}
        for name, (times, values) in drawn.truth.items():
            kept = [k for k, t in enumerate(times) if (t, name) in came or t > last]
            truth[name] = [times[k] for k in kept], [values[k] for k in kept]
        drawn = replace(drawn, truth=truth)
    monitors = [
        DenseIntervalMonitor(
            drawn.formula,
            Dense("1s"),
            ranges={name: limits for name, limits in drawn.ranges.items() if name in drawn.names},
            backend=backend,
            **({"lateness": 5} if late else {}),
        )
        for backend in BACKENDS
    ]
    start = max(times[0] for times, _ in drawn.truth.values())
    try:
        expected = dense_robustness.evaluate(drawn.formula, drawn.truth, Fraction(1))
        for k, (t, row) in enumerate(drawn.updates, 1):
            for monitor in monitors:
                monitor.update(t, **row)
            if monitors[0]._backend.complete == NEVER:
                continue
            prediction = dense_draw(rng, drawn, drawn.updates[:k])
            at = [*([] if monitors[0].at == "start" else [{"time": start}, {"time": t}]), {}]
            before = [[monitor.interval(**when) for when in at] for monitor in monitors]
            found = [[m.interval(**when, prediction=prediction) for when in at] for m in monitors]
            assert found[0] == found[1]
            assert [[monitor.interval(**when) for when in at] for monitor in monitors] == before
            for bounds, was, when in zip(found[0], before[0], at, strict=True):
                place = np.searchsorted(expected.times, when.get("time", start), side="right") - 1
                assert bounds.lower <= expected.values[place] <= bounds.upper
                assert was.lower <= bounds.lower <= bounds.upper <= was.upper
    except EvaluationError:
        assume(False)


@pytest.mark.parametrize("backend", BACKENDS)
def test_dense_prediction_bounds_the_rest_of_a_window(backend):
    spec = rtamt.parse("always[0:3](x <= 10)", backend=backend)
    monitor = spec.monitor(verdict="interval", time=rtamt.Dense("100ms"))
    monitor.update(0, x=4)
    assert monitor.interval(prediction={"x": (3, 8)}) == Interval(2, 6)
    assert monitor.interval(prediction={"x": ([0, 1, 2], [5, 6, 7], [6, 8, 11])}) == Interval(-1, 3)
    assert monitor.interval(0, prediction={"x": ([0, 1, 3.1], [5, 6, 7], [6, 8, 11])}) == Interval(2, 4)
    assert monitor.interval(prediction={"x": ([1], [6], [8])}) == Interval(-inf, 4)
    assert monitor.interval() == Interval(-inf, 6)
    monitor.update(1, x=9)
    assert monitor.interval() == Interval(-inf, 1)


@pytest.mark.parametrize("backend", BACKENDS)
def test_prediction_bounds_the_rest_of_a_window(backend):
    monitor = rtamt.parse("always[0:3](x <= 10)", backend=backend).monitor(verdict="interval")
    monitor.update(0, x=4)
    assert monitor.interval(prediction={"x": (3, 8)}) == Interval(2, 6)
    assert monitor.interval(prediction={"x": ([5, 6, 7], [6, 8, 11])}) == Interval(-1, 3)
    assert monitor.interval(prediction={"x": ([5, 6], [6, 8])}) == Interval(-inf, 4)
    assert monitor.interval() == Interval(-inf, 6)
    monitor.update(1, x=9)
    assert monitor.interval() == Interval(-inf, 1)


@pytest.mark.parametrize("backend", BACKENDS)
def test_prediction_of_all_later_samples_bounds_unbounded_future(backend):
    monitor = rtamt.parse("always(x <= 10)", backend=backend).monitor(verdict="interval")
    for t in range(200):
        monitor.update(t, x=4 + t % 2)
    assert monitor.interval(prediction={"x": (3, 8)}) == Interval(2, 5)
    assert monitor.interval(prediction={"x": (6, 8)}) == Interval(2, 4)
    assert monitor.interval() == Interval(-inf, 5)


@pytest.mark.parametrize(
    ("prediction", "message"),
    [
        ({"y": (1, 2)}, "prediction has 'y', which the formula does not read"),
        (
            {"x": 3},
            "the prediction of 'x' is 3; give (lower, upper), two numbers or two arrays of numbers of the same length",
        ),
        ({"x": (3, 1)}, "the prediction of 'x' is (3, 1), reversed; give (lower, upper)"),
        ({"x": ([1, 3], [2, 1])}, "the prediction of 'x' at step 2 is (3, 1), reversed; give (lower, upper)"),
        (
            {"x": ([1, 3], [2, 1, 4])},
            "the prediction of 'x' is ([1, 3], [2, 1, 4]); give (lower, upper), two numbers or two arrays of numbers "
            "of the same length",
        ),
        (
            {"x": (float("nan"), 3)},
            "the prediction of 'x' is NaN; leave out what is not predicted",
        ),
        (
            {"x": (20, 30)},
            "the prediction of 'x' is (20, 30), outside its declared range [0, 9]: correct it, or declare a "
            "wider range",
        ),
    ],
)
def test_wrong_prediction_is_rejected_with_one_sentence(prediction, message):
    monitor = rtamt.parse("always(x <= 10)").monitor(verdict="interval", ranges={"x": (0, 9)})
    monitor.update(0, x=4)
    with pytest.raises(rtamt.UsageError) as error:
        monitor.interval(prediction=prediction)
    assert str(error.value) == message
    assert monitor.interval() == Interval(1, 6)


@pytest.mark.parametrize(
    ("prediction", "message"),
    [
        (
            {"x": ([1, 2], [3, 4])},
            "the prediction of 'x' is ([1, 2], [3, 4]); give (lower, upper), two numbers or (times, lower, upper), "
            "three arrays of the same length",
        ),
        ({"y": (1, 2)}, "prediction has 'y', which the formula does not read"),
        (
            {"x": (20, 30)},
            "the prediction of 'x' is (20, 30), outside its declared range [0, 9]: correct it, or declare a "
            "wider range",
        ),
        (
            {"x": ([2, 1], [3, 4], [5, 6])},
            "the time of 'x' does not increase at sample 1: 1 s comes after 2 s; sort the samples",
        ),
    ],
)
def test_wrong_dense_prediction_is_rejected_with_one_sentence(prediction, message):
    spec = rtamt.parse("always(x <= 10)")
    monitor = spec.monitor(verdict="interval", ranges={"x": (0, 9)}, time="dense")
    with pytest.raises(rtamt.UsageError) as error:
        monitor.interval(prediction={"x": (1, 2)})
    assert str(error.value) == (
        "the trace has not started: it does when every variable has a sample, and no earlier one can come; "
        "predictions follow the newest"
    )
    monitor.update(0, x=4)
    with pytest.raises(rtamt.StlError) as error:
        monitor.interval(prediction=prediction)
    assert str(error.value) == message
    assert monitor.interval() == Interval(1, 6)


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_prediction_after_the_end_is_rejected(time):
    monitor = rtamt.parse("always(x <= 10)").monitor(verdict="interval", time=time)
    monitor.update(0, x=4)
    monitor.finish()
    with pytest.raises(rtamt.UsageError, match=r"^the trace has ended, so that there is nothing to predict$"):
        monitor.interval(prediction={"x": (1, 2)})


# ---- the radius ---------------------------------------------------------------------------------


@given(
    residuals=st.lists(st.floats(0, 10), max_size=40),
    delta=st.integers(1, 99).map(lambda percent: percent / 100),
)
def test_radius_is_the_smallest_residual_of_sufficient_rank(residuals, delta):
    radius = rtamt.calibrate(residuals, delta)
    percent = round(100 * delta)

    def covers(r):
        return 100 * sum(each <= r for each in residuals) >= (len(residuals) + 1) * (100 - percent)

    if radius == inf:
        assert not covers(10)
    else:
        assert covers(radius)
        assert all(not covers(each) for each in residuals if each < radius)


@pytest.mark.parametrize(("n", "delta"), [(19, 0.05), (50, 0.1), (30, 0.3)])
def test_new_error_is_within_the_radius_as_often_as_promised(n, delta):
    rng = np.random.default_rng(5)
    tries = 4000
    errors = np.abs(rng.standard_normal((tries, n + 1)))
    covered = sum(each[-1] <= rtamt.calibrate(each[:-1], delta) for each in errors)
    # The true share is between 1 - delta and that plus 1/(n + 1); five standard deviations of the estimate.
    slack = 5 * np.sqrt(delta * (1 - delta) / tries)
    assert 1 - delta - slack <= covered / tries <= 1 - delta + 1 / (n + 1) + slack


@pytest.mark.parametrize(
    ("residuals", "delta", "message"),
    [
        ([1.0], 0, "delta is 0; give a probability between 0 and 1, such as 0.05"),
        ([1.0], "0.1", "delta is '0.1'; give a probability between 0 and 1, such as 0.05"),
        (["a"], 0.1, "the residuals are ['a']; give a list of numbers"),
        ([[1.0]], 0.1, "the residuals have 2 dimensions; give one number for each recording"),
        ([1.0, float("nan")], 0.1, "residual 1 is NaN; leave the recording out"),
        (
            [0.2, -0.9, 0.1],
            0.5,
            "the least residual is -0.9; give the size of each error, such as abs(actual - predicted)",
        ),
    ],
)
def test_wrong_calibration_is_rejected_with_one_sentence(residuals, delta, message):
    with pytest.raises(rtamt.UsageError) as error:
        rtamt.calibrate(residuals, delta)
    assert str(error.value) == message
