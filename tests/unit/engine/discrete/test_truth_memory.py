"""Truth values of wide windows, which monitors keep in bits."""

from __future__ import annotations

import copy
import re

import numpy as np
import pytest

import rtamt

#: Windows and delays of at least 1024 samples, and the bytes a sample that a monitor of their verdicts needs at most.
WIDE = {
    "always[0:1500](x >= -2.9)": 0.3,
    "eventually[0:1300](x >= 2.9)": 0.3,
    "once[1100:2500](x > 3)": 0.3,
    "(x <= 2.9) until[0:1500] (y >= 2.9)": 0.3,
    "(x <= 2.9) until[1100:3000] (y >= 2.9)": 0.6,
    "(x < 2) since[1030:3000] (y > 2)": 0.6,
    "historically[0:1024](x < 3) -> eventually[5:1300](y > 2.5)": 0.6,
}


@pytest.mark.parametrize("text", WIDE)
@pytest.mark.parametrize("n", [1000, 4000])
def test_verdicts_are_the_signs_of_the_robustness_offline_and_online(text: str, n: int) -> None:
    random = np.random.default_rng(n)
    spec = rtamt.parse(text)
    data = {name: random.normal(size=n) for name in spec.input_names}
    robustness = spec.evaluate(data).signal.values
    assert robustness.all()  # where it is 0, it has no sign
    expected = np.copysign(np.inf, robustness)
    assert np.array_equal(spec.evaluate(data, semantics="boolean").signal.values, expected)
    monitor = spec.monitor(semantics="boolean")
    known = []
    for begin in range(0, n, 300):
        chunk = {name: column[begin : begin + 300] for name, column in data.items()}
        abandoned = copy.copy(monitor)
        abandoned.update_many(chunk)
        known.append(monitor.update_many(chunk).values)
        monitor = copy.copy(monitor)
    known.append(monitor.finish().values)
    assert np.array_equal(np.concatenate(known), expected)


@pytest.mark.parametrize(("text", "most"), WIDE.items())
def test_verdicts_need_a_bit_a_sample_where_robustness_needs_a_number(text: str, most: float) -> None:
    spec = rtamt.parse(text)
    longest = max(map(int, re.findall(r":(\d+)\]", text)))
    assert spec.monitor(semantics="boolean").memory < most * longest
    assert spec.monitor().memory > 7 * 1024


def test_an_update_that_fails_leaves_truth_values_as_they_were() -> None:
    spec = rtamt.parse("sqrt(if once[1100:1100](x > 0) then y else 1) >= 0")
    monitor, undisturbed = spec.monitor(), spec.monitor()
    values = np.random.default_rng(1).normal(size=3000).tolist()
    failures = 0
    for t, x in enumerate(values):
        if t > 1100 and values[t - 1100] > 0:
            with pytest.raises(rtamt.EvaluationError):
                monitor.update(t, x=-x, y=-1.0)
            failures += 1
        assert monitor.update(t, x=x, y=4.0) == undisturbed.update(t, x=x, y=4.0)
    assert failures > 500
