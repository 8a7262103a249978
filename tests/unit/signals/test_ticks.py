"""Times of every kind to ticks and back: what they mean, what comes back, on every way in."""

from __future__ import annotations

from datetime import datetime, timedelta, timezone
from fractions import Fraction
from itertools import pairwise
from math import inf, nan
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rtamt
from rtamt.errors import TraceError
from rtamt.language.units.durations import NANOSECOND
from rtamt.signals.counting import tick_of
from rtamt.signals.ticks import TimeScale

NOON = datetime(2026, 1, 1, 12)
ZONE = timezone(timedelta(hours=2))
SECOND = timedelta(seconds=1)

#: Two times a second apart in every notation, and what they are told as.
KINDS: dict[str, tuple[Any, Any]] = {
    "floats": ([0.5, 1.5], np.array([0.5, 1.5])),
    "ints": ([3, 4], np.array([3.0, 4.0])),
    "both": ([3, 4.0], np.array([3.0, 4.0])),
    "fractions": ([Fraction(1, 2), Fraction(3, 2)], np.array([0.5, 1.5])),
    "array of floats": (np.array([0.5, 1.5]), np.array([0.5, 1.5])),
    "floats of numpy": ([np.float64(0.5), np.float32(1.5)], np.array([0.5, 1.5])),
    "before 1970": ([-1.5, -0.5], np.array([-1.5, -0.5])),
    "array of integers": (np.array([5, 10**9 + 5]), np.array([5.0, 10**9 + 5.0])),
    "integers of numpy": ([np.int64(5), np.int32(10**9 + 5)], np.array([5.0, 10**9 + 5.0])),
    "unsigned": (np.array([5, 10**9 + 5], np.uint32), np.array([5.0, 10**9 + 5.0])),
    "integers of every origin": ([5, np.int64(6)], np.array([5.0, 6.0])),
    "datetimes": ([NOON, NOON + SECOND], np.array([NOON, NOON + SECOND], "M8[ns]")),
    "array of datetimes": (np.array([NOON, NOON + SECOND], "M8[us]"), np.array([NOON, NOON + SECOND], "M8[ns]")),
    "datetimes of numpy": (
        [np.datetime64("2026-01-01T12:00", "m"), np.datetime64("2026-01-01T12:00:01", "ms")],
        np.array([NOON, NOON + SECOND], "M8[ns]"),
    ),
    "zoned": (
        [NOON.replace(tzinfo=ZONE), (NOON + SECOND - 2 * 3600 * SECOND).replace(tzinfo=timezone.utc)],
        np.array([NOON, NOON + SECOND], "M8[ns]") - np.timedelta64(2, "h"),
    ),
    "timedeltas": ([-SECOND, 0 * SECOND], np.array([-(10**9), 0], "m8[ns]")),
    "array of timedeltas": (np.array([0, 1], "m8[s]"), np.array([0, 10**9], "m8[ns]")),
}  # fmt: skip


def offline(times: Any) -> rtamt.Signal:
    return rtamt.parse("x").evaluate({"x": (times, [1.0, 2.0])}, time="dense").signal


def offline_pairs(times: Any) -> rtamt.Signal:
    return rtamt.parse("x").evaluate({"x": [[times[0], 1.0], [times[1], 2.0]]}, time="dense").signal


def offline_shared(times: Any) -> rtamt.Signal:
    return rtamt.parse("x").evaluate({"time": times, "x": [1.0, 2.0]}, time="dense").signal


def online_chunk(times: Any) -> rtamt.Signal:
    return rtamt.parse("x").monitor(time="dense").update_many({"x": (times, [1.0, 2.0])})


def online_pairs(times: Any) -> rtamt.Signal:
    return rtamt.parse("x").monitor(time="dense").update_many({"x": [[times[0], 1.0], [times[1], 2.0]]})


def online_single(times: Any) -> rtamt.Signal:
    monitor = rtamt.parse("x").monitor(time="dense")
    told = [monitor.update(time, x=i + 1.0) for i, time in enumerate(times)]
    return rtamt.Signal(
        np.concatenate([signal.times for signal in told]), np.concatenate([signal.values for signal in told])
    )


WAYS = (offline, offline_pairs, offline_shared, online_chunk, online_pairs, online_single)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(("times", "expected"), KINDS.values(), ids=KINDS)
def test_times_mean_and_come_back_as_the_same_on_every_way_in(way: Any, times: Any, expected: Any) -> None:
    signal = way(times)
    np.testing.assert_array_equal(signal.times, expected)
    assert signal.times.dtype == expected.dtype
    np.testing.assert_array_equal(signal.values, [1.0, 2.0])


MIXED: list[tuple[Any, str]] = [
    ([0.5, NOON], "seconds at sample 0 and in datetimes at sample 1"),
    ([NOON, NOON.replace(tzinfo=ZONE)], "datetimes at sample 0 and in datetimes with a time zone at sample 1"),
    ([np.timedelta64(0, "s"), NOON], "timedeltas at sample 0 and in datetimes at sample 1"),
]  # fmt: skip


@pytest.mark.parametrize("way", [way for way in WAYS if way is not online_single])
@pytest.mark.parametrize(("times", "kinds"), MIXED)
def test_kinds_mixed_in_one_variable(way: Any, times: Any, kinds: str) -> None:
    with pytest.raises(rtamt.TraceError) as info:
        way(times)
    assert str(info.value) == f"'x' has times in {kinds}: use one of them for all"


def test_kinds_mixed_between_variables_and_between_updates() -> None:
    message = "'y' has times in datetimes, but others in seconds: use one of them for all"
    data = {"x": ([0.0, 1.0], [1, 2]), "y": ([NOON], [1])}
    with pytest.raises(rtamt.TraceError) as info:
        rtamt.parse("x + y").evaluate(data, time="dense")
    assert str(info.value) == message
    monitor = rtamt.parse("x + y").monitor(time="dense")
    monitor.update(0.0, x=1.0)
    for call in (lambda: monitor.update(NOON, y=1.0), lambda: monitor.update_many({"y": data["y"]})):
        with pytest.raises(rtamt.TraceError) as info:
            call()
        assert str(info.value) == message
    np.testing.assert_array_equal(monitor.update(0.0, y=1.0).values, [2.0])


@pytest.mark.parametrize(
    ("times", "message"),
    [
        (5, "the times of 'x' are 5, expected a sequence of times"),
        (np.float64(5), "the times of 'x' are np.float64(5.0), expected a sequence of times"),
        ([[1, 2], [3]], "the time of 'x' is [1, 2] at sample 0, expected a number of seconds or a datetime"),
        ([0, "a"], "the time of 'x' is 'a' at sample 1, expected a number of seconds or a datetime"),
        ([None, 1], "the time of 'x' is None at sample 0, expected a number of seconds or a datetime"),
        ([NOON, np.datetime64("NaT")], "the time of 'x' is NaT at sample 1: give a finite time"),
        (np.array(["2026", "NaT"], "M8[s]"), "the time of 'x' is NaT at sample 1: give a finite time"),
        (
            [1_700_000_000_000_000_000, 1_700_000_000_000_000_001],
            "the time of 'x' is 1700000000000000000 at sample 0, too large for seconds: if it counts "
            "ns since 1970, say time_unit='ns', or on the command line --time-unit ns",
        ),
        (
            np.array([5, 1_700_000_000_000_000_001]),
            "the time of 'x' is 1700000000000000001 at sample 1, too large for seconds: if it counts "
            "ns since 1970, say time_unit='ns', or on the command line --time-unit ns",
        ),
        (
            [10**400, 1.5],
            "'x' has a time too far from 0 for ticks of 1 ns: subtract a start time, or choose a coarser resolution",
        ),
        (
            [1700000000.1, 1700000000.1 + 1e-8],
            "'x' has two samples at 1700000000.1 s (sample 1 and the one before, with ticks of 1 ns): "
            "keep one of them",
        ),
        (
            [1700000000.5, 1700000000.25],
            "the time of 'x' does not increase at sample 1: 1700000000.25 s comes after 1700000000.5 s; "
            "sort the samples",
        ),
    ],
)
def test_what_is_said_of_times(times: Any, message: str) -> None:
    with pytest.raises(rtamt.TraceError) as info:
        offline(times)
    assert str(info.value) == message


def test_dates_beyond_the_reach_of_nanoseconds_with_a_coarser_resolution() -> None:
    times = [datetime(1500, 1, 1), datetime(3000, 1, 1)]
    signal = rtamt.parse("once[1ms:1ms] x").evaluate(
        {"x": (times, [1.0, 2.0])}, time="dense", resolution="1ms"
    ).signal  # fmt: skip
    expected = np.array(["1500-01-01T00:00:00", "1500-01-01T00:00:00.001", "3000-01-01T00:00:00"], "M8[ms]")
    np.testing.assert_array_equal(signal.times, expected)


@pytest.mark.parametrize("resolution", ["1us", "1ms", "1/3s", "0.3s", "10s"])
def test_at_a_chosen_resolution_bounds_that_are_multiples_of_it_are_met_exactly(resolution: str) -> None:
    tick = TimeScale(Fraction(1), "seconds").tick * rtamt.language.units.durations.duration(resolution)
    spec = rtamt.parse(f"once[{resolution}:{resolution}] x", resolution=tick, time="dense")
    times = [float(7 * tick), float(8 * tick), float(10 * tick)]
    signal = spec.evaluate({"x": (times, [1.0, 2.0, 3.0])}).signal
    np.testing.assert_array_equal(signal.times, [float(n * tick) for n in (7, 8, 9, 10)])
    np.testing.assert_array_equal(signal.values, [-np.inf, 1.0, 2.0, 2.0])
    in_ns = np.array([round(n * tick * 10**9) for n in (7, 8, 10)])
    signal = spec.evaluate({"x": (in_ns, [1.0, 2.0, 3.0])}, time_unit="ns").signal
    np.testing.assert_array_equal(signal.times, [round(n * tick * 10**9) for n in (7, 8, 9, 10)])


SIZES = st.sampled_from([NANOSECOND, Fraction(1, 10**6), Fraction(1, 3), Fraction(3, 7), Fraction(60)])


@given(st.lists(st.integers(-(2**40), 2**40), max_size=9), SIZES, SIZES)
def test_integers_are_rounded_to_the_nearest_tick_without_a_double_in_between(
    numbers: list[int], tick: Fraction, unit: Fraction
) -> None:
    scale = TimeScale(tick, "units", unit)
    expected = [round(number * unit / tick) for number in numbers]
    if max(map(abs, expected), default=0) < 2**62:
        assert scale.ticks(numbers, "x").tolist() == expected
        assert scale.ticks(np.array(numbers, np.int64), "x").tolist() == expected
        beside = [0.5, *numbers]
        assert scale.ticks(beside, "x").tolist()[1:] == expected


@given(st.integers(-(2**61), 2**61), st.sampled_from([NANOSECOND, Fraction(1, 10**6), Fraction(1, 10**3)]))
def test_integers_in_a_unit_come_back_as_they_were(number: int, unit: Fraction) -> None:
    scale = TimeScale(unit, "units", unit)
    told = scale.times(scale.ticks([number], "x")).tolist()
    assert told == [number]
    assert type(told[0]) is int


@given(st.lists(st.integers(0, 2**22 * 10**9), min_size=2, max_size=9, unique=True))
def test_seconds_keep_every_nanosecond_of_seven_weeks(numbers: list[int]) -> None:
    numbers.sort()
    scale = TimeScale(NANOSECOND, "seconds")
    seconds = [number / 10**9 for number in numbers]
    assert all(a < b for a, b in pairwise(seconds))
    assert scale.ticks(seconds, "x").tolist() == numbers
    assert scale.times(np.array(numbers)).tolist() == seconds


@pytest.mark.parametrize("unit", [Fraction(1), Fraction(1, 1000), Fraction(1, 10**6)])
@given(number=st.integers(2**52, 4 * 10**18), digits=st.sampled_from([1, 10, 1000, 10**6, 10**8]))
def test_a_double_far_from_0_means_the_shortest_decimal_that_prints_it(
    number: int, digits: int, unit: Fraction
) -> None:
    number -= number % digits
    rate = int(unit * 10**9)
    time = float(Fraction(number, rate))
    expected = round(Fraction(repr(time)) * rate)
    assert abs(expected - Fraction(time) * rate) <= 512
    assert tick_of(time, rate) == expected
    assert TimeScale(NANOSECOND, "units", unit).ticks([time, -time], "x").tolist() == [expected, -expected]


@pytest.mark.parametrize("start", [0, 1_700_000_000, -1_700_000_000])
def test_bounds_of_a_tenth_are_met_by_stamps_of_tenths_that_count_from_1970(start: int) -> None:
    # The doubles next to 1700000000.1 are 238 ns apart, so that tenths of a second are not.
    times = [start + k / 10 for k in range(40)]
    values = [float(k % 2) for k in range(40)]
    spec = rtamt.parse("once[0.1:0.1] x")
    shifted = spec.evaluate({"x": (times, values)}, time="dense").signal
    np.testing.assert_array_equal(shifted.times, times)
    np.testing.assert_array_equal(shifted.values, [-np.inf, *values[:-1]])
    monitor = spec.monitor(time="dense")
    told = [monitor.update(time, x=x) for time, x in zip(times, values, strict=True)]
    assert [float(signal.values[-1]) for signal in told] == shifted.values.tolist()
    assert [float(signal.times[-1]) for signal in told] == times


def test_pandas_series_and_timestamps() -> None:
    pandas = pytest.importorskip("pandas")
    naive = pandas.Series(
        pandas.to_datetime(["2026-01-01T12:00:00.000000001", "2026-01-01T12:00:01"], format="ISO8601")
    )
    zoned = naive.dt.tz_localize("Europe/Berlin")
    in_utc = zoned.dt.tz_convert(None).to_numpy()
    for way in WAYS:
        np.testing.assert_array_equal(way(naive).times, naive.to_numpy())
        np.testing.assert_array_equal(way(list(naive)).times, naive.to_numpy())
        np.testing.assert_array_equal(way(zoned).times, in_utc)
        np.testing.assert_array_equal(way(list(zoned)).times, in_utc)
        np.testing.assert_array_equal(way(pandas.Series([5, 10**9 + 5])).times, [5.0, 10**9 + 5.0])
    durations = pandas.Series(pandas.to_timedelta([0, 1], unit="s"))
    np.testing.assert_array_equal(offline(durations).times, durations.to_numpy())
    frame = pandas.DataFrame({"time": [0.0, 0.5], "x": [1.0, 2.0]})
    np.testing.assert_array_equal(
        rtamt.parse("x").evaluate(frame, time="dense").signal.times, [0.0, 0.5]
    )  # fmt: skip


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "times",
    [
        [0.0, 0.1, 0.3],
        [-(2.0**21), -0.3, 2.0**21],
        [0.5e-9, 1.5e-9, 2.5e-9],  # halves go to the even tick
        [0.3, 0.1, 0.2],
        [0.1, 0.1],
        [1700000000.1, 1700000000.2],
        [0.0, 1e6, 1e7],
        [7.25],
        [],
    ],
)
def test_doubles_in_an_array_become_the_ticks_that_they_become_in_a_list(times: list[float]) -> None:
    scale = TimeScale(NANOSECOND, "seconds")
    assert scale.ticks(np.array(times), "x").tolist() == scale.ticks(times, "x").tolist()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("times", [[0.0, nan, 1.0], [0.0, inf], [-inf, 0.0], [0.0, 1e308, 2.0]])
def test_doubles_that_no_tick_holds_are_refused_alike(times: list[float]) -> None:
    scale = TimeScale(NANOSECOND, "seconds")
    said = []
    for told in (times, np.array(times)):
        with pytest.raises(TraceError) as caught:
            scale.ticks(told, "x")
        said.append(str(caught.value))
    assert said[0] == said[1]


@pytest.mark.parametrize("later", [2.5, 3 * 10**9, np.int64(4), datetime(2026, 3, 1), timedelta(seconds=3)])
@pytest.mark.parametrize("resolution", ["1ns", "1/3s"])
def test_points_are_the_pairs_of_times_and_values(later: Any, resolution: str) -> None:
    zero = later - later
    first = datetime(1970, 1, 1) if isinstance(later, datetime) else zero
    monitor = rtamt.parse("historically[0:2](x >= 3)").monitor(time="dense", resolution=resolution)
    answers = [monitor.update(first, x=5.0), monitor.update(later, x=1.0), monitor.finish()]
    for told in answers:
        assert told.points() == list(zip(told.times, told.values, strict=True))
    assert [len(told) for told in answers[:2]] == [1, 1]


@pytest.mark.parametrize(
    ("begin", "unit", "resolution"),
    [
        (0.0, None, "1ns"),
        (1.7e9, None, "1ns"),  # doubles are further apart than ticks
        (-1.7e9, None, "1ns"),
        (1.7e9, None, "1us"),
        (1.7e12, "ms", "1ns"),  # too large for seconds
        (4.5e15, "us", "1ns"),
        (1.7e9, None, "1/3s"),
        (0.0, "ms", "1/7s"),
    ],
)
def test_points_of_several_instants_are_the_pairs_of_times_and_values(
    begin: float, unit: str | None, resolution: str
) -> None:
    window = "[0:10000000003ns]" if resolution == "1ns" else "[0:10]"
    spec = rtamt.parse(f"always{window}(x >= 3)")
    monitor = spec.monitor(time="dense", resolution=resolution, time_unit=unit)
    random = np.random.default_rng(1)
    in_1 = 1 if unit is None else {"ms": 1e3, "us": 1e6}[unit]
    now, counts = begin, set()
    for value in random.integers(0, 6, size=300).tolist():
        now += float(random.uniform(0.5, 4)) * in_1
        told = monitor.update(now, x=float(value))
        assert told.points() == list(zip(told.times.tolist(), told.values.tolist(), strict=True))
        counts.add(len(told))
    assert {0, 1, 2, 3} <= counts
