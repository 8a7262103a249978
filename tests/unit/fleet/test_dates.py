"""Dates and durations as times of a fleet, and errors of a batch before the core has seen it."""

import numpy as np
import pytest

import rtamt
from rtamt.errors import TraceError


@pytest.mark.parametrize(
    "settings", [{}, {"lateness": "0s"}, {"gaps": "restart"}, {"worst_case": True}], ids=str
)
def test_dates_are_times_of_a_fleet(settings) -> None:
    fleet = rtamt.Fleet(rtamt.parse("always[0:1](x >= 3)"), 10, **settings)
    start = np.datetime64("2026-11-22T10:00:00.123456", "ns")
    second = np.timedelta64(1, "s")
    update = fleet.update_many([1, 1, 2], [start, start + second, start], {"x": [5, 2, 4]})
    expected = np.array(["NaT", start, "NaT"], "M8[ns]")
    assert update.times.dtype == expected.dtype
    assert np.array_equal(update.times, expected, equal_nan=True)
    with pytest.raises(
        rtamt.TraceError, match=r"is in seconds.*, but before in datetimes: use one of them for all"
    ):
        fleet.update_many([1], [1_795_341_602.123456], {"x": [5]})
    durations = rtamt.Fleet(rtamt.parse("x >= 3"), 10, **settings)
    assert durations.update_many([1], [second], {"x": [5]}).times == second


def test_released_samples_have_dates() -> None:
    fleet = rtamt.Fleet(rtamt.parse("x >= 3"), 10, lateness="1s")
    start = np.datetime64("2026-11-22T10:00:00", "ns")
    fleet.update_many([1], [start], {"x": [5]})
    assert fleet.watermark(start).released.times.tolist() == [start.astype(int)]
    fleet.update_many([1], [start + np.timedelta64(1, "s")], {"x": [np.inf]})
    again = rtamt.Fleet.restore(rtamt.parse("x >= 3"), fleet.snapshot())
    (time,) = again.watermark(start + np.timedelta64(1, "s")).released.times
    assert time == start + np.timedelta64(1, "s")


def test_a_value_that_is_no_number_has_key_and_index() -> None:
    fleet = rtamt.Fleet(rtamt.parse("x >= 3"), 10)
    fleet.update_many([7], [0], {"x": [5]})
    with pytest.raises(
        rtamt.TraceError, match=r"^key 7 at index 1 of the batch: 'x' is 'a', expected a number$"
    ) as error:
        fleet.update_many([8, 7], [0, 1], {"x": [5, "a"]})
    assert (error.value.index, error.value.variable) == (1, "x")


def test_a_watermark_does_not_decide_the_kind_of_times() -> None:
    fleet = rtamt.Fleet(rtamt.parse("x >= 3"), 10, lateness="1s")
    fleet.advance(np.datetime64("1970-01-01T00:00:01", "ns"))
    assert fleet.update_many([1, 1], [1.0, 3.0], {"x": [5, 4]}).times.tolist()[0] == 1.0


@pytest.mark.parametrize("settings", [{}, {"lateness": "0s"}], ids=str)
@pytest.mark.parametrize("dated", [True, False])
def test_the_rounding_of_times_since_1970_began_traces_again_and_forgot_a_violation(settings, dated):
    """Doubles are 0.24 us apart there, so that a gap of 1 us is 1.19 us now and then."""
    spec = rtamt.parse("historically(x >= 3)", period="1us")
    fleet = rtamt.Fleet(spec, capacity=1, gaps="restart", **settings)
    times = np.datetime64("2023-11-14T22:13:20", "us") + np.arange(6)
    if not dated:
        times = times.astype(np.int64) / 1e6
    data = {"x": np.array([5.0, 1, 5, 5, 5, 5])}
    with pytest.raises(TraceError, match=r"1\.19209e-06 s after the one before, expected 1 us"):
        fleet.update_many(["a"] * 6, times, data)
    fresh = rtamt.Fleet(spec, capacity=1, gaps="restart")
    assert fresh.update_many(["a"] * 6, np.arange(6) * 1e-6, data).values.tolist() == [2, -2, -2, -2, -2, -2]
    assert fresh.update_many(["a"], np.array([9e-6]), {"x": np.array([7.0])}).values.tolist() == [4]
