"""Samples without a value, and timestamps since 1970 or that are no times."""

from __future__ import annotations

import numpy as np
import pytest

import rtamt


def test_masked_values_are_missing_values() -> None:
    x = np.ma.array([1.0, 2.0, 3.0], mask=[0, 1, 0])
    result = rtamt.parse("x >= 1").evaluate({"x": x})
    assert (result.intervals.lower.tolist(), result.intervals.upper.tolist()) == (
        [0, -np.inf, 2],
        [0, np.inf, 2],
    )
    with pytest.raises(rtamt.EvaluationError) as info:
        _ = rtamt.parse("always(x >= 1)").evaluate({"x": x}).robustness
    assert str(info.value) == (
        "the robustness at time 0 is only known to lie between -inf and 0, because samples are missing or "
        "uncertain; read result.interval or result.intervals, or evaluate without gaps: hold the values before "
        "them (hold_for= of rtamt.read), or resample (trace.resample(period=...))"
    )


def test_a_timestamp_that_is_not_a_time() -> None:
    with pytest.raises(rtamt.TraceError) as info:
        rtamt.parse("x >= 1").evaluate({"time": np.array(["NaT"], "M8[ns]"), "x": [1.0]})
    assert str(info.value) == "time is nan at sample 0: give a finite number of seconds"


def test_timestamps_that_count_from_1970_give_the_period_they_were_made_with() -> None:
    times = 1.7e9 + 0.001 * np.arange(50)
    result = rtamt.parse("always[0:5ms] x").evaluate({"time": times, "x": np.ones(50)})
    assert result.robustness == 1
    timestamps = np.datetime64("2026-01-01T00:00:00", "ms") + np.arange(50)
    assert rtamt.parse("always[0:5ms] x").evaluate({"time": timestamps, "x": np.ones(50)}).robustness == 1


@pytest.mark.parametrize(
    ("second", "value", "message"),
    [
        (0.0, 1.0, "time does not increase at sample 1: 1700000000.25 s comes after 1700000000.25 s; "),
        (0.5, 1.0, "sample 1 at 1700000000.75 s is 0.5 s after the one before, expected 1 s (within 10%): "),
        (1.0, np.nan, "'x' is NaN at sample 1, time 1700000001.25 s: "),
    ],
)
def test_errors_showed_every_timestamp_since_1970_as_17e9(second: float, value: float, message: str) -> None:
    monitor = rtamt.parse("x >= 1").monitor()
    monitor.update(1700000000.25, x=1.0)
    with pytest.raises(rtamt.TraceError) as info:
        monitor.update(1700000000.25 + second, x=value)
    assert str(info.value).startswith(message)
