"""Every sentence about wrong data in dense time, in full; and what an error leaves behind."""

from __future__ import annotations

from datetime import datetime, timedelta, timezone
from typing import Any

import numpy as np
import pytest

import rtamt

NAN, INF = float("nan"), float("inf")
BACKENDS = ["cpp", "python"]

WRONG: list[tuple[Any, str]] = [
    ({"x": [[0.0, 1.0]]}, "the data has no 'y'; signals: x"),
    (
        {"x": [[0.0, 1.0]], "yy": [[0.0, 1.0]]},
        "the data has no 'y'; did you mean 'yy'? (signals: yy, x)",
    ),
    ({"x": [], "y": [[0.0, 1.0]]}, "'x' has no samples: give at least one"),
    (
        {"x": [[0.0, 1.0], [2.0, 1.0], [1.0, 1.0]], "y": [[0.0, 1.0]]},
        "the time of 'x' does not increase at sample 2: 1 s comes after 2 s; sort the samples",
    ),
    (
        {"x": [[0.0, 1.0], [0.0, 2.0]], "y": [[0.0, 1.0]]},
        "'x' has two samples at 0 s (sample 1 and the one before, with ticks of 1 ns): keep one of them",
    ),
    (
        {"x": [[0.0, 1.0], [1.0, NAN]], "y": [[0.0, 1.0]]},
        "'x' is NaN at sample 1, time 1 s: fill the gap or leave the sample out",
    ),
    (
        {"x": [[0.0, 1.0], [NAN, 1.0]], "y": [[0.0, 1.0]]},
        "the time of 'x' is nan at sample 1: give a finite time",
    ),
    (
        {"x": [[0.0, 1.0], [INF, 1.0]], "y": [[0.0, 1.0]]},
        "the time of 'x' is inf at sample 1: give a finite time",
    ),
    (
        {"x": ([0.0, 1.0], [1.0]), "y": [[0.0, 1.0]]},
        "'x' has 2 times but 1 values: give one of each for every sample",
    ),
    ({"x": [[0.0, "a"]], "y": [[0.0, 1.0]]}, "'x' is 'a' at sample 0, expected a number"),
    (
        {"x": 5, "y": [[0.0, 1.0]]},
        "'x' is no dense signal: give (times, values), or a list of [time, value] pairs",
    ),
    (
        {"x": (np.array([0], "m8[ns]"), [1.0]), "y": [[0.0, 1.0]]},
        "'y' has times in seconds, but others in timedeltas: use one of them for all",
    ),
    (
        {"x": (np.array([0], "m8"), [1.0]), "y": [[0.0, 1.0]]},
        "the time of 'x' is a timedelta64 without a unit of fixed length at sample 0: give it one, such as "
        "np.timedelta64(5, 'ms')",
    ),
    (
        {"x": [[1e30, 1.0]], "y": [[0.0, 1.0]]},
        "the time of 'x' is 1e+30 at sample 0, too large for seconds: subtract a start time",
    ),
    (
        [1, 2],
        "expected a mapping from variable to (times, values), such as {'x': ([0.0, 1.5], [3, 4])}, got list",
    ),
]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("data", "message"), WRONG)
def test_wrong_recording(data: Any, message: str, backend: str) -> None:
    with pytest.raises(rtamt.TraceError) as info:
        rtamt.parse("x >= 3 and y >= 3", backend=backend).evaluate(data, time="dense")
    assert str(info.value) == message


UPDATES: list[tuple[Any, dict[str, Any], str]] = [
    (1.0, {"x": 1.0}, "'x' has two samples at 1 s (sample 2 and the one before, with ticks of 1 ns): keep one of them"),
    (0.5, {"x": 1.0}, "the time of 'x' does not increase at sample 2: 0.5 s comes after 1 s; sort the samples"),
    (2.0, {"z": 1.0}, "the formula has no variable 'z'; variables: x, y"),
    (2.0, {"x": NAN}, "'x' is NaN at sample 2, time 2 s: fill the gap or leave the sample out"),
    (2.0, {"x": "a"}, "'x' is 'a' at sample 2, expected a number"),
    (NAN, {"x": 1.0}, "the time of 'x' is nan at sample 2: give a finite time"),
    (INF, {"x": 1.0}, "the time of 'x' is inf at sample 2: give a finite time"),
    (
        1e30,
        {"x": 1.0},
        "the time of 'x' is 1e+30 at sample 2, too large for seconds: subtract a start time",
    ),
]  # fmt: skip


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("time", "values", "message"), UPDATES)
def test_wrong_update_leaves_the_monitor_as_it_was(
    time: Any, values: dict[str, Any], message: str, backend: str
) -> None:
    monitor = rtamt.parse("once(x + y >= 3)", backend=backend).monitor(time="dense")
    monitor.update(0.0, x=5.0, y=1.0)
    monitor.update(1.0, x=0.0)
    with pytest.raises(rtamt.TraceError) as info:
        monitor.update(time, **values)
    assert str(info.value) == message
    told = monitor.update(2.0, y=2.0, x=9.0)
    np.testing.assert_array_equal(told.times, [2.0])
    np.testing.assert_array_equal(told.values, [8.0])


@pytest.mark.parametrize("backend", BACKENDS)
def test_nanoseconds_after_seconds(backend: str) -> None:
    monitor = rtamt.parse("x", backend=backend).monitor(time="dense")
    monitor.update(0.0, x=5.0)
    with pytest.raises(rtamt.TraceError) as info:
        monitor.update(np.timedelta64(10**9, "ns"), x=5.0)
    assert str(info.value) == "'x' has times in timedeltas, but others in seconds: use one of them for all"
    with pytest.raises(rtamt.TraceError) as info:
        monitor.update(np.int64(17 * 10**17), x=5.0)
    assert str(info.value) == (
        "the time of 'x' is 1700000000000000000 at sample 1, too large for seconds: if it counts "
        "ns since 1970, say time_unit='ns', or on the command line --time-unit ns"
    )
    assert len(monitor.update(np.float64(1.0), x=5.0)) == 1


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_variable_that_never_appears(backend: str) -> None:
    monitor = rtamt.parse("x and y", backend=backend).monitor(time="dense")
    assert len(monitor.update(0.0, x=5.0)) == 0
    with pytest.raises(rtamt.TraceError) as info:
        monitor.finish()
    assert str(info.value) == "'y' has no samples; provide one before finish()"


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_finished_monitor(backend: str) -> None:
    monitor = rtamt.parse("x", backend=backend).monitor(time="dense")
    monitor.update(0.0, x=5.0)
    assert len(monitor.finish()) == 0
    with pytest.raises(rtamt.UsageError) as info:
        monitor.update(1.0, x=1.0)
    assert str(info.value) == "the monitor has finished its trace; call reset() before the next sample"
    monitor.reset()
    np.testing.assert_array_equal(monitor.update(0.0, x=2.0).values, [2.0])


def test_operators_that_dense_time_does_not_have() -> None:
    for call in (
        lambda: rtamt.parse("once(prev x)", time="dense"),
        lambda: rtamt.parse("once(prev x)").evaluate({"x": [[0.0, 1.0]]}, time="dense"),
        lambda: rtamt.parse("once(prev x)").monitor(time="dense"),
    ):
        with pytest.raises(rtamt.SpecificationError) as info:
            call()
        assert str(info.value) == (
            "'prev' means one sample away, which dense time does not have; use a window such as once[0:1], "
            "or discrete time\n"
            "  line 1, column 6:\n"
            "    once(prev x)\n"
            "         ^^^^^^"
        )


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("sum", "adds samples, which dense time does not have; use minimum or maximum"),
        (
            "mean",
            "of a step signal is a line, not a step, and dense time has steps only; use atleast with a duration",
        ),
        (
            "integral",
            "of a step signal is a line, not a step, and dense time has steps only; use atleast with a duration",
        ),
        (
            "duration",
            "of a step signal is a line, not a step, and dense time has steps only; use atleast with a duration",
        ),
    ],
)
def test_sums_that_dense_time_does_not_have(name: str, why: str) -> None:
    text = f"{name}[0:5](x) >= 3" if name != "duration" else f"{name}[0:5](x > 1) >= 3"
    with pytest.raises(rtamt.SpecificationError) as info:
        rtamt.parse(text, time="dense")
    marks = "^" * text.index(" >= 3")
    assert str(info.value) == (
        f"'{name}' {why}, or discrete time\n  line 1, column 1:\n    {text}\n    {marks}"
    )


def test_wrong_settings() -> None:
    with pytest.raises(rtamt.UsageError) as info:
        rtamt.parse("x", time="dens")
    assert (
        str(info.value) == "unknown time domain 'dens'; did you mean 'dense'? (time domains: dense, discrete)"
    )
    with pytest.raises(rtamt.UsageError) as info:
        rtamt.parse("3 >= 2").evaluate({}, time="dense")
    assert str(info.value) == (
        "the formula reads no variable, so that it has no instants in dense time: let it read a variable, or "
        "evaluate it in discrete time"
    )
    with pytest.raises(rtamt.BoundError) as bound:
        rtamt.parse("once[0:1/3] x").monitor(time="dense")
    assert bound.value.message == (
        "The operator bound must be a multiple of the resolution: 1/3 s is not a whole number of ticks of 1 ns; "
        "change the bound or the tick"
    )


@pytest.mark.parametrize("verdict", ["delayed", "eager", "interval", "causation"])
@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_a_monitor_of_a_formula_without_variables(backend: str, verdict: str) -> None:
    spec = rtamt.parse("float x\n3 >= 2", backend=backend)
    with pytest.raises(rtamt.UsageError) as info:
        spec.monitor(time="dense", verdict=verdict)
    assert str(info.value) == (
        "the formula reads no variable, so that it has no instants in dense time: let it read a variable, or "
        "evaluate it in discrete time"
    )


def test_a_value_that_does_not_exist_leaves_the_monitor_as_it_was() -> None:
    monitor = rtamt.parse("once(x / y >= 1)").monitor(time="dense")
    monitor.update(0.0, x=4.0, y=1.0)
    for _ in range(2):
        with pytest.raises(rtamt.EvaluationError) as info:
            monitor.update(1.5, x=0.0, y=0.0)
        assert str(info.value) == (
            "'x / y' has no value at time 1.5 s: it is 0/0, inf - inf, 0 * inf, "
            "or a function outside its domain; change the formula or the data so that this cannot happen"
        )
    np.testing.assert_array_equal(monitor.update(1.5, x=1.0, y=1.0).values, [3.0])


def test_exact_at_stamps_of_a_billion_seconds() -> None:
    start = 10**18
    x = (np.array([start, start + 1, start + 100_000_001]), [1.0, 0.0, 1.0])
    result = rtamt.parse("once[100ms:100ms] x").evaluate({"x": x}, time="dense", time_unit="ns")
    np.testing.assert_array_equal(result.signal.times, start + np.array([0, 100_000_000, 100_000_001]))
    np.testing.assert_array_equal(result.signal.values, [-INF, 1.0, 0.0])


@pytest.mark.parametrize("backend", BACKENDS)
def test_no_sliver_where_tenths_meet(backend: str) -> None:
    # In doubles 0.3 - 0.1 misses 0.2 by a hair, and a window of exactly 0.2 s would see the dip.
    times = [0.1 * k for k in range(10)]
    values = [1.0 if k % 3 else -1.0 for k in range(10)]
    result = rtamt.parse("eventually[0:0.2] x", backend=backend).evaluate(
        {"x": (times, values)}, time="dense"
    )
    np.testing.assert_array_equal(result.signal.values, [1.0, -1.0])
    np.testing.assert_array_equal(result.signal.times, [0.0, 0.9])


@pytest.mark.parametrize("backend", BACKENDS)
def test_datetimes_come_back_as_datetimes(backend: str) -> None:
    noon = np.datetime64("2026-01-01T12:00:00", "ns")
    times = noon + np.array([0, 1, 2], "m8[s]")
    signal = rtamt.parse("x", backend=backend).evaluate({"x": (times, [1, 2, 2])}, time="dense").signal
    np.testing.assert_array_equal(signal.times, times)
    stamp = datetime(2026, 1, 1, 12, tzinfo=timezone.utc).replace(tzinfo=None)
    monitor = rtamt.parse("x", backend=backend).monitor(time="dense")
    np.testing.assert_array_equal(monitor.update(stamp, x=1.0).times, [noon])


def test_a_coarser_resolution_rounds_stamps_to_it() -> None:
    result = rtamt.parse("x").evaluate({"x": [[0.0, 1.0], [0.0149, 2.0]]}, time="dense", resolution="10ms")
    np.testing.assert_array_equal(result.signal.times, [0.0, 0.01])


@pytest.mark.parametrize(
    "times",
    [
        [datetime(3000, 1, 1), datetime(3000, 1, 2)],
        np.array(["1500-01-01", "1600-01-02"], "M8[D]"),
        np.array([2**63, 2**63 + 5], np.uint64),
        np.array([2**62, 2**63 - 1], np.int64),
        np.array([-(2**63), 0], np.int64),
    ],
    ids=str,
)
def test_times_that_ticks_cannot_hold_do_not_wrap(times: Any) -> None:
    message = "'x' has a time too far from 0 for ticks of 1 ns: subtract a start time, or choose a coarser resolution"
    spec = rtamt.parse("always[0:1](x >= 3)")
    unit = "ns" if getattr(times, "dtype", np.dtype(object)).kind in "iu" else None
    for call in (
        lambda: spec.evaluate({"x": (times, [5.0, 4.0])}, time="dense", time_unit=unit),
        lambda: spec.monitor(time="dense", time_unit=unit).update_many({"x": (times, [5.0, 4.0])}),
    ):
        with pytest.raises(rtamt.TraceError) as info:
            call()
        assert str(info.value) == message


def test_the_limit_of_time_is_the_same_on_every_path() -> None:
    monitor = rtamt.parse("x").monitor(time="dense")
    monitor.update(0.0, x=1.0)
    with pytest.raises(rtamt.TraceError) as info:
        monitor.update(4.7e9, x=1.0)
    assert str(info.value) == (
        "'x' has a time too far from 0 for ticks of 1 ns: subtract a start time, or choose a coarser resolution"
    )


def test_a_value_without_a_time() -> None:
    monitor = rtamt.parse("x and y").monitor(time="dense")
    with pytest.raises(rtamt.TraceError) as info:
        monitor.update_many({"x": ([], [1.0]), "y": [[0.0, 1.0]]})
    assert str(info.value) == "'x' has 0 times but 1 values: give one of each for every sample"


@pytest.mark.parametrize(
    "times",
    [
        [0, 0.5, 2],
        np.array([0, 0.5, 2]),
        [0, 1, 2],
        [timedelta(0), timedelta(seconds=1), timedelta(seconds=2)],
    ],
)
@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_times_in_one_tick_were_set(backend: str, times: Any) -> None:
    message = (
        "'x' has two samples at 0 s (sample 1 and the one before, with ticks of 3600 s): keep one of them, or choose a "
        "finer resolution"
    )
    spec = rtamt.parse("x >= 1", time=rtamt.Dense(resolution="1h"), backend=backend)
    for call in (
        lambda: spec.evaluate({"x": (times, [1.0] * len(times))}),
        lambda: spec.evaluate({"time": times, "x": [1.0] * len(times)}),
        lambda: spec.monitor().update_many({"x": (times, [1.0] * len(times))}),
    ):
        with pytest.raises(rtamt.TraceError) as caught:
            call()
        assert str(caught.value) == message
    with pytest.raises(
        rtamt.TraceError, match=r"^all 3 timestamps of 'x' are 3600 s, so they were never set"
    ):
        spec.evaluate({"x": ([3600, 3600, 3600], [1.0, 1.0, 1.0])})
