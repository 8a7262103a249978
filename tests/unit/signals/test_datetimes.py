"""Dates as times, in discrete time as in dense time, whatever the time zone of the machine."""

import time
from datetime import datetime, timedelta, timezone

import numpy as np
import pandas as pd
import pytest

import rtamt
from rtamt.signals.arrays import timestamps

NOON = datetime(2026, 3, 29, 0, 30)
ZONE = timezone(timedelta(hours=2))


@pytest.fixture
def berlin(monkeypatch):
    """A machine whose clocks go forward at 1:00 UTC on 29 March 2026."""
    monkeypatch.setenv("TZ", "CET-1CEST,M3.5.0,M10.5.0/3")
    time.tzset()
    yield
    monkeypatch.undo()
    time.tzset()


@pytest.mark.usefixtures("berlin")
@pytest.mark.parametrize("zone", [None, timezone.utc], ids=["civil", "UTC"])
def test_an_hour_is_an_hour_when_the_clocks_of_the_machine_change(zone):
    moments = [(NOON + timedelta(hours=i)).replace(tzinfo=zone) for i in range(4)]
    spec = rtamt.parse("always[0:3600](x >= 3)")
    result = spec.evaluate({"time": moments, "x": [5, 4, 3, 6]}, period=3600)
    assert np.diff(result.signal.times).tolist() == [3600 * 10**9] * 3
    dense = rtamt.read({"x": (moments, [5, 4, 3, 6])})
    assert np.diff(dense["x"].times).tolist() == [3600 * 10**9] * 3
    assert result.signal.times[0] == dense["x"].times[0]


def test_stamps_of_every_kind_are_the_same_seconds():
    moments = [NOON, NOON + timedelta(microseconds=1)]
    expected = [1774744200.0, 1774744200.000001]
    zoned = [moment.replace(tzinfo=timezone.utc).astimezone(ZONE) for moment in moments]
    frames = pd.DatetimeIndex(moments), list(map(pd.Timestamp, zoned))
    for given in (moments, zoned, np.array(moments, "M8[us]"), *frames):
        assert timestamps(given).seconds.tolist() == expected
        assert timestamps(given).original.tolist() == np.array(moments, "M8[ns]").tolist()


def test_a_date_with_a_time_zone_beside_one_without_is_an_error():
    with pytest.raises(rtamt.TraceError) as failure:
        rtamt.parse("x > 0").evaluate({"time": [NOON, NOON.replace(tzinfo=ZONE)], "x": [1, 2]})
    assert (
        str(failure.value) == "'time' has a time zone at sample 1 and none at sample 0: use one way for all"
    )


def test_a_column_of_dates_with_and_without_a_time_zone_is_an_error():
    with pytest.raises(rtamt.TraceError) as failure:
        rtamt.read({"t": ["2024-05-01T10:00:00Z", "2024-05-01T10:00:01"], "x": [1, 2]})
    assert str(failure.value) == (
        "the time column 't' of a dict is '2024-05-01T10:00:01' at sample 1, with no time zone, "
        "and those before have one; use one way for all"
    )


def test_times_since_a_start():
    trace = rtamt.read({"t": [timedelta(0), timedelta(milliseconds=100)], "x": [1, 2]}, time="t")
    assert trace["x"].times.tolist() == [0, 0.1]


def test_a_date_that_is_none_is_an_error():
    with pytest.raises(rtamt.TraceError, match=r"^time is nan at sample 1: give a finite number of seconds$"):
        rtamt.parse("x > 0").evaluate({"time": [NOON, pd.NaT], "x": [1, 2]})


def test_stamps_in_seconds_beside_nanoseconds_are_exact():
    ns = np.array([1_700_000_000_100_000_001, 1_700_000_000_300_000_000])
    trace = rtamt.read({"x": (ns.astype("m8[ns]"), [1, 2]), "y": ([1700000000.1, 1700000000.3], [3, 4])})
    assert trace["x"].times.tolist() == ns.tolist()
    assert trace["y"].times.tolist() == [1_700_000_000_100_000_000, 1_700_000_000_300_000_000]


def test_stamps_beyond_the_range_of_nanoseconds_are_an_error_and_never_wrap():
    with pytest.raises(rtamt.TraceError, match=r"^'time' of a dict has a time too far from 0 for ticks"):
        rtamt.read({"time": np.array([0, 2**62]), "x": [1, 2]}, units={"time": "us"})
