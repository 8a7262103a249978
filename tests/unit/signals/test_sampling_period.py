"""The sampling period that timestamps show."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from rtamt.signals.sampling_period import _median, infer_period


@given(st.lists(st.sampled_from([0.1, 0.1000001, 1e-9, 3.0, 1e300]), min_size=1, max_size=40))
def test_the_median_is_that_of_numpy(gaps):
    assert _median(np.array(gaps)) == float(np.median(gaps))


@given(st.lists(st.integers(1, 50), min_size=1, max_size=20))
def test_the_period_is_the_median_gap_as_a_short_decimal(gaps):
    times = np.cumsum([0, *gaps]) / 1000
    assert abs(float(infer_period(times)) - np.median(gaps) / 1000) <= 1e-6 * np.median(gaps) / 1000
