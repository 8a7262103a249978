"""Sums over past windows: the same bits on every way to a result, and inf - inf inside a window."""

from __future__ import annotations

import copy
import pickle
from math import inf

import numpy as np
import pytest

import rtamt
from rtamt.language.definitions.discrete import sum_

#: Numbers whose sums depend on the order of additions.
X = np.random.default_rng(3).normal(size=700) * 10.0 ** np.random.default_rng(4).integers(-3, 9, size=700)
FORMULAS = [
    "sum[0:6](x) >= 0",
    "sum[3:99](x) >= 0",
    "sum(x) >= 0",
    "mean[2:300](x) >= 0",
    "integral[0:12](mean[1:4](x)) + sum[0:4](x) >= 0",
    "duration[0:6](x >= 0) - count[1:9](x >= 0) >= 0",
]


@pytest.mark.parametrize("text", FORMULAS)
def test_every_chunking_gives_the_same_bits(text):
    spec = rtamt.parse(text)
    expected = spec.evaluate({"x": X}).signal.values
    for size in (1, 5, 64, 257):
        monitor = spec.monitor()
        known = []
        for begin in range(0, len(X), size):
            chunk = X[begin : begin + size]
            known.append(
                monitor.update_many({"x": chunk, "time": np.arange(begin, begin + len(chunk))}).values
            )
            if begin == 5 * size:
                monitor = pickle.loads(pickle.dumps(copy.deepcopy(monitor)))
        np.testing.assert_array_equal(np.concatenate(known), expected)


@pytest.mark.parametrize("text", FORMULAS)
def test_both_back_ends_give_the_same_bits(text):
    x = X[:330]
    expected = rtamt.parse(text).evaluate({"x": x}).signal.values
    slow = rtamt.parse(text, backend="python")
    np.testing.assert_array_equal(slow.evaluate({"x": x}).signal.values, expected)
    monitor = slow.monitor()
    got = [monitor.update(float(i), x=value) for i, value in enumerate(x[:130])]
    np.testing.assert_array_equal(got, expected[:130])


@pytest.mark.parametrize("text", FORMULAS)
def test_bounds_of_exact_samples_are_the_values_to_the_bit(text):
    x = X[:120]
    expected = rtamt.parse(text).evaluate({"x": x}).signal.values
    monitor = rtamt.parse(text).monitor(verdict="interval", at="every")
    for i, value in enumerate(x):
        monitor.update(float(i), x=value)
        assert monitor.interval(float(i)) == rtamt.Interval(expected[i], expected[i])


def test_a_long_sum_does_not_drift():
    x = np.full(100_000, 0.1)
    x[50_000] = 1e16
    sums = rtamt.parse("sum[0:9](x) >= 0").evaluate({"x": x}).signal.values
    np.testing.assert_allclose(sums[50_010:], 1.0, rtol=1e-15)
    np.testing.assert_array_equal(sums[60_009::10], sum_(x[:10], 0, 9)[-1])


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_a_failed_update_with_both_infinities_leaves_the_sum_as_it_was(backend):
    monitor = rtamt.parse("sum[0:2](x) >= 0", backend=backend).monitor()
    values = [1.0, inf, 3.0]
    assert [monitor.update(float(i), x=value) for i, value in enumerate(values)] == [1, inf, inf]
    with pytest.raises(rtamt.EvaluationError) as info:
        monitor.update(3.0, x=-inf)
    assert str(info.value).startswith(
        "'sum[0:2](x)' has no value at sample 3, time 3 s: it is 0/0, inf - inf"
    )
    assert [monitor.update(3.0 + i, x=value) for i, value in enumerate((4.0, 5.0, -inf))] == [inf, 12, -inf]


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("window", ["[1:2]", "[1:inf]"])
def test_infinities_that_meet_in_a_window_after_the_last_sample_are_no_error(backend, window):
    spec = rtamt.parse(f"sum{window}(x) >= 0", backend=backend)
    values = [0.5, -inf, inf]
    assert spec.evaluate({"x": values}).signal.values.tolist() == [0, 0.5, -inf]
    told = f"'sum{window}(x)' has no value at sample 3, time 3 s"
    monitor = spec.monitor()
    assert [monitor.update(float(i), x=value) for i, value in enumerate(values)] == [0, 0.5, -inf]
    with pytest.raises(rtamt.EvaluationError) as info:
        monitor.update(3.0, x=1.0)
    assert str(info.value).startswith(told)
    assert len(monitor.finish()) == 0
    bounds = spec.monitor(verdict="interval", at="every")
    for i, value in enumerate(values):
        bounds.update(float(i), x=value)
    for _ in range(2):
        with pytest.raises(rtamt.EvaluationError) as info:
            bounds.update(3.0, x=1.0)
        assert str(info.value).startswith(told)
    bounds.finish()
    assert bounds.interval(2.0) == rtamt.Interval(-inf, -inf)


def test_the_python_monitor_keeps_no_more_than_it_needs():
    monitor = rtamt.parse("sum[0:9](x) >= 0", backend="python").monitor()
    for i in range(500):
        monitor.update(float(i), x=0.1)
    assert monitor.memory <= 8 * 4 * 10


def test_nested_counts_read_the_sample_before_each_window():
    spec = rtamt.parse("count[0:2](count[0:2](count[0:1](x > 0) >= 1) >= 1) >= 0", backend="python")
    x = np.where(X[:100] > 0, 1.0, -1.0)
    monitor = spec.monitor()
    got = [monitor.update(float(i), x=value) for i, value in enumerate(x)]
    np.testing.assert_array_equal(got, spec.evaluate({"x": x}).signal.values)


def test_what_a_count_rests_on_begins_one_sample_before_its_window():
    result = rtamt.parse("count[0:2](x > 0) <= 0").evaluate({"x": [-1, -1, 1, 1, 1]})
    assert str(result.explain(4)).endswith("fails at 4 s (-1), reading x from 1 s to 3 s")
    result = rtamt.parse("sum[0:2](x) <= 0").evaluate({"x": [-1, -1, -1, -1, 3]})
    assert str(result.explain(4)).endswith("fails at 4 s (-1), reading x from 2 s to 4 s")
