"""Resampling at the rate of the recording takes each sample once, whatever rounded its timestamps."""

from __future__ import annotations

from types import MappingProxyType

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import rtamt
from rtamt.cli import main
from rtamt.signals.arrays import timestamps
from rtamt.signals.inferred_period import infer_period
from rtamt.signals.sampling_period import elapsed

EPOCH = 1.7e9


def whole(seconds, unit, rounded):
    """Return times as dates that count whole units."""
    per_second = {"ms": 10**3, "us": 10**6}[unit]
    return rounded(seconds * per_second).astype(np.int64).astype(f"M8[{unit}]")


#: What clocks and files make of times since a start.
FORMATS = MappingProxyType(
    {
        "floats of 32 bits": lambda times: times.astype(np.float32),
        "floats of 32 bits from 100 s on": lambda times: (100 + times).astype(np.float32),
        "doubles": lambda times: times,
        "doubles since 1970": lambda times: EPOCH + times,
        "milliseconds": lambda times: np.round(times * 1e3) / 1e3,
        "milliseconds, cut off": lambda times: whole(EPOCH + times, "ms", np.floor),
        "microseconds": lambda times: whole(EPOCH + times, "us", np.round),
        "microseconds, cut off": lambda times: np.floor(times * 1e6) / 1e6,
        "nanoseconds of doubles": lambda times: ((EPOCH + times) * 1e9).astype(np.int64).astype("M8[ns]"),
        "nanoseconds of a sum": lambda times: (times * 1e9 + 1.7e18).astype(np.int64).astype("M8[ns]"),
        "nanoseconds since a start": lambda times: (times * 1e9).astype(np.int64).astype("m8[ns]"),
    }
)


def period_of(times):
    stamped = timestamps(times)
    return infer_period(stamped, elapsed(stamped))


@pytest.mark.parametrize("how", ["hold", "linear"])
@given(
    st.sampled_from(sorted(FORMATS)),
    st.sampled_from([1, 2, 3, 4, 7, 10, 20, 100 / 6, 1000 / 60, 25, 50, 1000 / 3, 500, 1000])
    | st.integers(1, 1000),
    st.integers(50, 3000),
)
def test_a_recording_at_its_own_rate_lost_or_repeated_samples(how, kind, period_ms, count):
    times = FORMATS[kind](np.arange(count) * (period_ms / 1e3))
    if kind.startswith("milliseconds"):
        assume(
            period_ms >= 5 and count >= 200
        )  # gaps within the tolerance, and so many that they show the unit
    assume((np.diff(times) > np.zeros(1, np.diff(times).dtype)).all())
    values = np.arange(count) ** 2 % 101.0
    resampled = rtamt.read({"time": times, "x": values}).resample(period_of(times), how)
    assert resampled["x"].values.tolist() == values.tolist()
    assert not resampled.losses


@given(st.sampled_from(sorted(FORMATS)), st.sampled_from([10, 16, 20, 50]), st.integers(2, 9))
def test_every_nth_sample_is_taken_for_n_periods(kind, period_ms, each):
    times = FORMATS[kind](np.arange(600) * (period_ms / 1e3))
    assume(kind != "floats of 32 bits from 100 s on")  # begins between two of them
    values = np.arange(600.0)
    resampled = rtamt.read({"time": times, "x": values}).resample(period_of(times) * each)
    assert resampled["x"].values.tolist() == values[::each].tolist()


@pytest.mark.parametrize("behind", [1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize("kind", ["doubles", "doubles since 1970", "nanoseconds of a sum"])
def test_a_sample_behind_an_instant_is_none_of_that_instant(kind, behind):
    """Both signals are regular, and their samples do differ by so much."""
    since = 1 + np.arange(100) / 10
    x, y = FORMATS[kind](since), FORMATS[kind](since - 0.1 + behind)
    trace = rtamt.read({"x": (x, np.arange(100.0)), "y": (y, np.arange(100.0))})
    assert trace.resample("100ms")["y"].values.tolist() == list(range(100))


@pytest.mark.parametrize("kind", ["doubles", "doubles since 1970", "nanoseconds of a sum"])
def test_a_sample_after_a_slip_of_the_clock_was_taken_before_its_time(kind):
    """Two lengths of gaps are no rounding where one of them occurs once."""
    since = np.arange(200) / 100
    since[100:] += 0.002
    trace = rtamt.read({"time": FORMATS[kind](since), "x": np.arange(200.0)})
    assert trace.resample("10ms")["x"].values.tolist() == [*range(100), *range(99, 199)]


@pytest.mark.parametrize("options", [[], ["--early"]], ids=["whole", "early"])
@pytest.mark.parametrize("rate", [100, 60, 30])
@pytest.mark.parametrize("kind", ["milliseconds", "doubles", "nanoseconds of doubles", "floats of 32 bits"])
def test_checks_lost_a_violation_at_the_rate_of_the_recording(tmp_path, options, rate, kind):
    """Of 60 Hz in whole milliseconds, one sample in three is rounded up, behind its instant."""
    times = FORMATS[kind](np.arange(300) / rate)
    period = float(period_of(times))
    for place in (100, 101, 102, 299):
        values = np.zeros(300)
        values[place] = 1
        seconds = timestamps(times).seconds
        rows = "".join(f"{time!r},{x}\n" for time, x in zip(seconds.tolist(), values.tolist(), strict=True))
        (tmp_path / "a.csv").write_text(f"time,x\n{rows}")
        command = ["check", "always(x <= 0)", str(tmp_path / "a.csv"), "--resample", f"{period:.12f}s"]
        assert main([*command, *options]) == 1
