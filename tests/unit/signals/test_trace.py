"""``Trace``: names, time bases, renaming, and time bases that are chosen openly."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rtamt
from rtamt.cli import main
from tests.support import strategies


def two_time_bases():
    return rtamt.read({"req": ([0.0, 2.5], [5, 0]), "gnt": ([0.0, 1.0, 4.0], [0, 4, 0])})


def test_dense_time_reads_each_signal_on_its_own_clock():
    spec = rtamt.parse("always(req >= 3 -> eventually[0:2](gnt >= 3))")
    data = {"req": ([0.0, 2.5], [5, 0]), "gnt": ([0.0, 1.0, 4.0], [0, 4, 0])}
    ours, given_ = spec.evaluate(two_time_bases(), time="dense"), spec.evaluate(data, time="dense")
    assert ours.signal.times.tolist() == given_.signal.times.tolist()
    assert ours.signal.values.tolist() == given_.signal.values.tolist()


def test_discrete_time_needs_one_time_base_and_says_what_to_do():
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.parse("req >= gnt").evaluate(two_time_bases())
    assert str(error.value) == (
        "'req' and 'gnt' have different time bases (2 samples, 0 s to 2.5 s; 3 samples, 0 s to 4 s): "
        "evaluate in dense time, or put them on one time base with trace.resample(period=...) or trace.hold(), "
        "on the command line with --resample PERIOD"
    )
    # Of one signal alone the clock is the clock.
    assert rtamt.parse("req >= 3").evaluate(two_time_bases()).signal.values.tolist() == [2, -3]


def test_what_discrete_time_reads_after_resampling():
    trace = two_time_bases().resample("500ms")
    assert trace["gnt"].times.tolist() == [0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5, 4]
    assert trace["req"].values.tolist() == [5, 5, 5, 5, 5, 0, 0, 0, 0]
    assert rtamt.parse("always(req >= 3 -> eventually[0:2](gnt >= 3))").evaluate(trace).robustness == 1


def test_a_line_ends_where_the_first_signal_ends_and_hold_where_the_last_one_does():
    assert two_time_bases().resample(0.5, how="linear").end == 2.5
    assert two_time_bases().resample(0.5, how="linear")["gnt"].values.tolist() == [
        0, 2, 4, 4 - 4 / 6, 4 - 8 / 6, 2,
    ]  # fmt: skip
    assert two_time_bases().resample(0.5).end == 4


def test_signals_begin_where_all_of_them_have_begun():
    trace = rtamt.read({"x": ([0.0, 3.0], [1, 2]), "y": ([1.0, 2.0], [5, 6])})
    assert trace.hold()["x"].times.tolist() == [1, 2, 3]
    assert trace.resample(1)["y"].values.tolist() == [5, 6, 6]


def test_nanoseconds_since_1970_stay_exact():
    epoch = 1_700_000_000_123_456_789
    trace = rtamt.read({"x": (np.array([epoch, epoch + 10, epoch + 20]), [0, 1, 2])}, time_unit="ns")
    assert trace["x"].times.tolist() == [epoch, epoch + 10, epoch + 20]
    assert trace["x"].times.dtype == "m8[ns]"
    fine = trace.resample("5ns", how="linear")
    assert fine["x"].times.tolist() == [epoch + 5 * i for i in range(5)]
    assert fine["x"].values.tolist() == [0, 0.5, 1, 1.5, 2]
    assert rtamt.parse("eventually[0:20ns](x >= 2)").evaluate(trace, time="dense").satisfied


def test_a_monitor_takes_traces_as_chunks():
    monitor = rtamt.parse("always[0:1](x >= 3)").monitor()
    assert monitor.update_many(rtamt.read({"time": [0, 1, 2], "x": [5, 4, 6]})).values.tolist() == [1, 1]
    dense = rtamt.parse("x >= 3").monitor(time="dense")
    assert dense.update_many(rtamt.read({"time": [0, 2], "x": [5, 4]})).times.tolist() == [0, 2]


def test_rename_gives_names_that_formulas_can_say():
    trace = rtamt.read({"battery_status[1].voltage_v": [12.1, 12.0], "v": [1, 2]})
    assert trace.rename({"u": "battery_status[1].voltage_v"}).names == ("u", "v")
    with pytest.raises(rtamt.UsageError, match=r"^a dict has a 'v' already; choose another name$"):
        trace.rename({"v": "battery_status[1].voltage_v"})
    with pytest.raises(
        rtamt.TraceError, match=r"^a dict has no 'w'; signals: battery_status\[1\].voltage_v, v"
    ):
        trace.rename({"x": "w"})


def test_without_stamps_samples_are_one_period_apart_and_dense_time_says_what_it_needs():
    trace = rtamt.read({"x": [1, 2, 3]})
    assert rtamt.parse("eventually[0:200ms](x >= 3)", period="100ms").evaluate(trace).robustness == 0
    assert (trace.start, trace["x"].times.tolist()) == (None, [0, 1, 2])
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.parse("x >= 3").evaluate(trace, time="dense")
    assert str(error.value) == (
        "a dict has no timestamps, which dense time needs: name their column with time=, "
        "or on the command line --time-column"
    )


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda t: t.resample("0s"), "the sampling period is '0s'; it must be positive"),
        (lambda t: t.resample(1, how="line"), "cannot resample by 'line'; did you mean 'linear'? "
         "(methods: linear, hold)"),
        (lambda _: rtamt.read({"x": [1]}).hold(),
         "'x' has no timestamps, so that it cannot be put on another time base"),
        (lambda _: rtamt.read({"x": ([0.0], [1]), "y": ([5.0], [1])}).resample(1, how="linear"),
         "the signals have no instant in common"),
        (lambda _: rtamt.read({"x": (np.array([2**60]), [1])}, time_unit="ns").resample(Fraction(1, 3)),
         "the period 1/3 s is no whole number of nanoseconds, in which the timestamps are counted"),
    ],
)  # fmt: skip
def test_messages(call, message):
    with pytest.raises(rtamt.StlError) as error:
        call(two_time_bases())
    assert str(error.value) == message


@given(strategies.dense_traces(), st.sampled_from((1, 2, 3)))
def test_law_a_resampled_or_held_signal_is_the_dense_one_at_those_instants(trace, step):
    """``hold`` is what dense time means by a signal: the value of the last sample."""
    read = rtamt.read(trace, time_unit="ns")
    spec = rtamt.parse("x + y")
    dense = spec.evaluate(trace, time="dense", time_unit="ns").signal
    for held in (read.resample(Fraction(step, 10**9)), read.hold()):
        result = spec.evaluate(held, period="1ns", tolerance=1e9).signal.values
        times = np.rint(held["x"].times * 1e9)
        at = np.searchsorted(dense.times, times, side="right") - 1
        assert result.tolist() == dense.values[at].tolist()


def test_resampling_says_how_many_samples_it_passed_over():
    trace = rtamt.read({"x": ([0.0, 1.0, 1.25, 1.5, 2.0], [0, 1, 9, 9, 2]), "y": ([1.0, 2.0], [0, 0])})
    assert trace.resample(1).losses == ("resampling left out 2 of 5 samples of x, between those it took",)
    assert trace.resample(1, "linear").losses == trace.resample(1).losses
    assert trace.resample("400ms", "linear").losses == ()
    assert trace.resample("250ms").losses == trace.hold().losses == ()


@pytest.mark.parametrize("how", ["hold", "linear"])
@pytest.mark.parametrize(
    ("times", "since", "until"),
    [
        ([0.0, 1.0, 1e9], "0 s", "2001-09-09 01:46:40"),
        (np.array([0, 10**18], "m8[ns]"), "0 ns", "2001-09-09 01:46:40"),
        (np.array([0, 10**18], "M8[ns]"), "1970-01-01T00:00:00", "2001-09-09T01:46:40"),
    ],
    ids=["seconds", "nanoseconds", "dates"],
)
def test_resampling_over_a_huge_gap_is_an_error_and_no_lack_of_memory(times, since, until, how):
    """Such as after messages recorded before the clock was set; numpy had a MemoryError."""
    trace = rtamt.read({"time": times, "x": np.arange(len(times))})
    with pytest.raises(rtamt.TraceError) as caught:
        trace.resample("1ms", how=how)
    assert str(caught.value) == (
        f"resampling every 1 ms from {since} to {until} makes 1,000,000,000,001 samples, more than 268,435,456: divide "
        f"the recording at its gaps, or choose a longer period"
    )
    assert len(trace.resample("1000h", how=how)["x"].values) == 278


@pytest.mark.parametrize("early", [(), ("--early",)])
def test_commands_resample_no_huge_gap(tmp_path, capsys, early):
    (tmp_path / "log.csv").write_text("time,x\n0,1\n1,2\n1e9,3\n", encoding="utf-8")
    assert main(["check", "always(x <= 2)", str(tmp_path / "log.csv"), "--resample", "1ms", *early]) == 2
    assert "makes 1,000,000,000,001 samples, more than 268,435,456" in capsys.readouterr().err


@pytest.mark.parametrize("rate", [100, 1000, 2000, 48_000])
@pytest.mark.parametrize("rounded", [lambda ns: ns / 1e9, lambda ns: ns // 10**9 + ns % 10**9 * 1e-9])
def test_resampling_at_the_rate_of_a_recording_since_1970_left_out_samples(rate, rounded):
    """Seconds since 1970 are rounded to 0.2 µs, and further where they are a sum of seconds and nanoseconds."""
    step = 10**9 // rate
    values = np.arange(3000.0)
    trace = rtamt.read({"time": rounded(1_700_000_000 * 10**9 + step * np.arange(3000)), "x": values})
    found = trace.resample(f"{step}ns")
    assert found["x"].values.tolist() == values.tolist()
    assert found.losses == ()
