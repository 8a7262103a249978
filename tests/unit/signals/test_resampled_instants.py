"""Resampling takes the last value at or before each instant by the timestamps as recorded, but for rounded doubles."""

from __future__ import annotations

from types import MappingProxyType

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rtamt

EPOCH = 1.7e9

FORMATS = MappingProxyType(
    {
        "doubles": lambda times: times,
        "doubles since 1970": lambda times: EPOCH + times,
        "nanoseconds": lambda times: np.round(times * 1e9).astype(np.int64).astype("M8[ns]"),
    }
)


@pytest.mark.parametrize("how", ["hold", "linear"])
@given(st.sampled_from(sorted(FORMATS)), st.integers(1, 1000), st.integers(2, 3000))
def test_a_recording_at_its_own_rate_keeps_each_sample(how, kind, period_ms, count):
    times = FORMATS[kind](np.arange(count) * (period_ms / 1e3))
    values = np.arange(count) ** 2 % 101.0
    resampled = rtamt.read({"time": times, "x": values}).resample(f"{period_ms}ms", how)
    assert np.allclose(resampled["x"].values, values, rtol=0, atol=0 if how == "hold" else 0.5)
    assert not resampled.losses


@pytest.mark.parametrize("behind", [1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize("kind", FORMATS)
def test_a_sample_behind_an_instant_is_none_of_that_instant(kind, behind):
    since = 1 + np.arange(100) / 10
    x, y = FORMATS[kind](since), FORMATS[kind](since - 0.1 + behind)
    trace = rtamt.read({"x": (x, np.arange(100.0)), "y": (y, np.arange(100.0))})
    assert trace.resample("100ms")["y"].values.tolist() == list(range(100))


@pytest.mark.parametrize("kind", FORMATS)
def test_a_sample_after_a_slip_of_the_clock_is_not_taken_before_its_time(kind):
    """Two lengths of gaps may be timestamps that were rounded to a unit, and may be a clock that slipped."""
    since = np.arange(200) / 100
    since[100:] += 0.002
    trace = rtamt.read({"time": FORMATS[kind](since), "x": np.arange(200.0)})
    assert trace.resample("10ms")["x"].values.tolist() == [*range(100), *range(99, 199)]
