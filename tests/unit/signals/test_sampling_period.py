"""The sampling period that timestamps show."""

from __future__ import annotations

import json
from fractions import Fraction
from types import MappingProxyType

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rtamt
from rtamt.cli import main
from rtamt.signals.arrays import Timestamps
from rtamt.signals.inferred_period import _median, infer_period


@given(st.lists(st.sampled_from([0.1, 0.1000001, 1e-9, 3.0, 1e300]), min_size=1, max_size=40))
def test_the_median_is_that_of_numpy(gaps):
    assert _median(np.array(gaps)) == float(np.median(gaps))


@given(st.lists(st.integers(1, 50), min_size=1, max_size=20))
def test_the_period_is_the_median_gap_as_a_short_decimal(gaps):
    times = np.cumsum([0, *gaps]) / 1000
    assert (
        abs(float(infer_period(Timestamps(times, times))) - np.median(gaps) / 1000)
        <= 1e-6 * np.median(gaps) / 1000
    )


#: Nanoseconds: 48 kHz, 60 kHz, 120 kHz, 44.1 kHz, 3 kHz, and less than the precision of a double since 1970.
PERIODS = [20_833, 16_667, 8_333, 22_676, 333_333, 250, 1]
EPOCH = 1_700_000_000 * 10**9
RATE = "next(always(rate(x) >= 995))"


@pytest.mark.parametrize("period", PERIODS)
@pytest.mark.parametrize("kind", ["ns", "datetime64[ns]", "timedelta64[ns]"])
def test_the_period_of_exact_times_since_1970_was_rounded_and_rates_with_it(period, kind):
    times = EPOCH + period * np.arange(100)
    data = {"time": times if kind == "ns" else times.astype(kind), "x": 1e-6 * period * np.arange(100)}
    unit = "ns" if kind == "ns" else None
    result = rtamt.parse(RATE).evaluate(data, time_unit=unit)
    assert result.satisfied
    assert result.trace.period * 10**9 == period
    assert [row.satisfied for row in rtamt.Suite(rtamt.parse(RATE), time_unit=unit).evaluate(data)] == [True]
    if period > 10_000:
        chunks = [{name: column[i : i + 25] for name, column in data.items()} for i in range(0, 100, 25)]
        found = rtamt.check_stream(rtamt.parse("always(x >= 0)"), chunks, time_unit=unit)
        assert found.period * 10**9 == period


@pytest.mark.parametrize("period", PERIODS)
@pytest.mark.parametrize("options", [[], ["--early"], ["--engine", "local"]], ids=["whole", "early", "many"])
def test_the_period_of_nanoseconds_in_a_file_was_rounded(tmp_path, capsys, period, options):
    rows = "".join(f"{EPOCH + period * i},{1e-6 * period * i}\n" for i in range(100))
    (tmp_path / "a.csv").write_text(f"time [ns],x\n{rows}")
    assert main(["check", RATE, str(tmp_path / "a.csv"), "--json", *options]) == 0
    assert json.loads(capsys.readouterr().out)["satisfied"]


def test_the_gap_in_an_error_is_that_of_the_timestamps():
    times = EPOCH + np.array([0, 1000, 2000, 2500, 3500])
    with pytest.raises(
        rtamt.errors.TraceError, match=r"sample 3 at 1700000000 s is 5e-07 s after the one before"
    ):
        rtamt.parse("x > 0").evaluate({"time": times, "x": np.ones(5)}, time_unit="ns")


def halves(seconds):
    """Return nanoseconds of seconds and the rest of a double, as clocks of ROS are set."""
    whole = np.floor(seconds)
    return whole.astype(np.int64) * 10**9 + ((seconds - whole) * 1e9).astype(np.int64)


@pytest.mark.parametrize("rate", [20, 100, 1000, 10_000])
@pytest.mark.parametrize(
    "made", [halves, lambda seconds: (seconds * 1e9).astype(np.int64)], ids=["parts", "product"]
)
@pytest.mark.parametrize("jitter", [0, 0.08])
def test_nanoseconds_that_were_seconds_in_doubles_have_the_period_of_these(rate, made, jitter):
    index = np.arange(100) + jitter * (np.arange(100) % 3 > 0)
    times = made(1_700_000_000 + index / rate)
    result = rtamt.parse(f"always[0:{10 / rate}](x > 0)").evaluate(
        {"time": times.astype("M8[ns]"), "x": np.ones(100)}
    )
    assert float(result.trace.period) == 1 / rate


@pytest.mark.parametrize("count", [2, 3, 50])
def test_the_period_of_hardware_clocks_is_exact_whatever_divides_it(count):
    """256 ns are the precision of a product of seconds since 1970 and 10^9."""
    times = 1_700_000_000 * 10**9 + 25_600 * np.arange(count)
    result = rtamt.parse("x > 0").evaluate({"time": times.astype("M8[ns]"), "x": np.ones(count)})
    assert result.trace.period * 10**9 == 25_600


def period_of(times, **given):
    """Return the period that each way of giving timestamps shows, which is one."""
    data = {"time": times, "x": np.ones(len(times))}
    spec = rtamt.parse("always(x >= 0)")
    found = {spec.evaluate(each, **given).trace.period for each in (data, MappingProxyType(data))}
    found.add(rtamt.check_stream(spec, [data], **given).period)
    (period,) = found
    return period


@pytest.mark.parametrize("start", [0, 100, 1000, 1500])
@pytest.mark.parametrize("rate", [1000, 100, 50])
def test_the_period_of_floats_of_32_bits_was_one_of_their_gaps(start, rate):
    """At 1000 s they are 61 µs apart, so that the gaps at 1 kHz are 0.977 and 1.038 ms, within the tolerance."""
    times = (start + np.arange(3000) / rate).astype(np.float32)
    assert period_of(times) == Fraction(1, rate)
    assert period_of(times.astype(float)) == Fraction(1, rate)
    assert period_of(
        (1000 * (start + np.arange(3000) / rate)).astype(np.float32), time_unit="ms"
    ) == Fraction(1, rate)


@pytest.mark.parametrize("period", [20.833e-6, 1 / 1024, 50e-6])
def test_the_period_of_doubles_since_1970_was_rounded_to_their_precision(period):
    found = period_of(1.7e9 + period * np.arange(50_000))
    assert abs(float(found) - period) <= 1.1e-6 * period


def test_a_period_that_rounding_leaves_uncertain_is_rejected():
    times = (1000 + np.arange(5) / 1000).astype(np.float32)
    message = (
        r"the sampling period is about 0.001 s, but the timestamps resolve only 6.1e-05 s at 1000.00402832031 s: "
        r"give the period \(period=, --period\), or timestamps of a higher precision"
    )
    with pytest.raises(rtamt.errors.TraceError, match=message):
        period_of(times)
    assert period_of(times, time=rtamt.Discrete("1ms")) == Fraction(1, 1000)


def test_whole_seconds_with_jitter_are_no_floats_of_32_bits():
    times = 10.0**7 + np.cumsum([0, 10, 11, 9, 10, 10, 11, 9, 10])
    assert period_of(times) == 10


def test_streams_ignored_the_settings_of_a_time_domain():
    chunk = {"time": [0.0, 0.1, 0.25], "x": [1.0, 1.0, 1.0]}
    rough = rtamt.Discrete("100ms", tolerance=0.6)
    spec = rtamt.parse("always(x >= 0)")
    assert rtamt.check_stream(spec, [chunk], time=rough).satisfied
    assert rtamt.check_stream(rtamt.parse("always(x >= 0)", time=rough), [chunk]).satisfied
    with pytest.raises(rtamt.errors.TraceError, match=r"expected 100 ms \(within 10%\)"):
        rtamt.check_stream(spec, [chunk], period="100ms")


@pytest.mark.parametrize("rate", [24, 30, 48, 60, 70, 75])
@pytest.mark.parametrize("rounded", [np.round, np.floor])
def test_the_period_of_whole_milliseconds_was_a_whole_number_of_them(rate, rounded):
    times = rounded(np.arange(1000) * 1000 / rate)
    for seconds, options in [
        (times / 1000, {}),
        (times, {"time_unit": "ms"}),
        (times.astype(np.int64).astype("M8[ms]"), {}),
    ]:
        assert abs(period_of(seconds, **options) * rate - 1) < 5e-5


@pytest.mark.parametrize("count", [2000, 20_000])
@pytest.mark.parametrize("rate", [48_000, 44_100, 22_050, 16_000, 8000])
def test_the_period_of_nanoseconds_made_of_doubles_since_1970_was_the_most_frequent_gap(rate, count):
    times = ((1.7e9 + np.arange(count) / rate) * 1e9).astype(np.int64)
    assert abs(period_of(times, time_unit="ns") * rate - 1) < 2e-5


@pytest.mark.parametrize("options", [[], ["--early"]], ids=["whole", "early"])
def test_a_first_chunk_had_another_period_than_the_recording(tmp_path, options):
    """16 kHz in whole microseconds: gaps of 62 and 63 in turn, of which a chunk has more of the first."""
    index = np.arange(40_001)
    rows = "\n".join(f"{time},{x}" for time, x in zip(index * 125 // 2, index * 62.5e-3, strict=True))
    (tmp_path / "a.csv").write_text(f"time [us],x\n{rows}\n")
    assert main(["check", "always[0:1550ms](x <= 1560)", str(tmp_path / "a.csv"), *options]) == 0


def test_the_gap_between_chunks_is_one_of_the_recording():
    """A last chunk of one sample has no other gap, and others may have one more of the first chunk's period."""
    times = np.cumsum([0, *[62, 63] * 100])[:201] / 1e6
    chunks = [{"time": times[i : i + 40], "x": np.ones(len(times[i : i + 40]))} for i in range(0, 201, 40)]
    result = rtamt.check_stream(rtamt.parse("always(x >= 0)"), chunks)
    whole = rtamt.parse("always(x >= 0)").evaluate({"time": times, "x": np.ones(201)})
    assert not result.steady or result.period == whole.trace.period
