"""Every sentence about wrong data, in full, offline and online; and what an error leaves behind."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rtamt

NAN = float("nan")
INF = float("inf")


def check_message(error: type[Exception], call: Any, *args: Any, **kwargs: Any) -> str:
    with pytest.raises(error) as info:
        call(*args, **kwargs)
    return str(info.value)


OFFLINE = [
    ({"x": [1, 2]}, "the data has no 'y'; signals: x"),
    ({"x": [1], "yy": [2]}, "the data has no 'y'; did you mean 'yy'? (signals: yy, x)"),
    ({"x": [1, 2], "y": [1]}, "'x' has 2 and 'y' has 1 samples: give one value of each at every sample"),
    (
        {"time": [0, 1], "x": [1, 2, 3], "y": [1, 2, 3]},
        "'time' has 2 and 'x' has 3 samples: give one value of each at every sample",
    ),
    (
        {"x": [1, 2, NAN], "y": [1, 2, 3]},
        "'x' is NaN at sample 2, time 2 s: fill the gap or leave the sample out",
    ),
    ({"x": [1, "abc", 3], "y": [1, 2, 3]}, "'x' is 'abc' at sample 1, expected a number"),
    ({"x": ["1", "2"], "y": [1, 2]}, "'x' is '1' at sample 0, expected a number"),
    ({"x": 5, "y": [1]}, "'x' is 5, expected a sequence of numbers"),
    ({"x": [[1, 2], [3, 4]], "y": [1, 2]}, "'x' has 2 dimensions, expected 1: give one number a sample"),
    ({"x": [], "y": []}, "the trace is empty: give at least one sample"),
    (
        {"time": [0, 2, 1], "x": [1, 2, 3], "y": [1, 2, 3]},
        "time does not increase at sample 2: 1 s comes after 2 s; sort the samples and drop repeated timestamps",
    ),
    (
        {"time": [0, 1, 1], "x": [1, 2, 3], "y": [1, 2, 3]},
        "time does not increase at sample 2: 1 s comes after 1 s; sort the samples and drop repeated timestamps",
    ),
    (
        {"time": [0, 1, INF], "x": [1, 2, 3], "y": [1, 2, 3]},
        "time is inf at sample 2: give a finite number of seconds",
    ),
    (
        {"time": [0, 1, 2, 3.5], "x": [1, 2, 3, 4], "y": [1, 2, 3, 4]},
        "sample 3 at 3.5 s is 1.5 s after the one before, expected 1 s (within 10%): "
        "give the right period, resample the trace, or use dense time (time='dense', on the command line --time dense)",
    ),
    ([1, 2], "expected a mapping from variable to values, such as {'time': [...], 'x': [...]}, got list"),
]


@pytest.mark.parametrize(("data", "message"), OFFLINE)
def test_wrong_recording(data: Any, message: str) -> None:
    spec = rtamt.parse("x >= 3 and y >= 3")
    assert check_message(rtamt.TraceError, spec.evaluate, data) == message


def test_a_field_that_is_not_there() -> None:
    spec = rtamt.parse("x.value >= 3")
    assert check_message(rtamt.TraceError, spec.evaluate, {"x": [1.0]}) == (
        "'x' has no field 'value' at sample 0: it is a float"
    )


ONLINE = [
    ((1.0, {"x": 1}), "the data has no 'y'; signals: x"),
    ((1.0, {"x": 1, "y": 1, "zz": 0}), "the formula has no variable 'zz'; variables: x, y"),
    ((1.0, {"x": 1, "y": "abc"}), "'y' is 'abc' at sample 1, expected a number"),
    ((1.0, {"x": 1, "y": None}), "'y' is None at sample 1, expected a number"),
    ((1.0, {"x": 1, "y": NAN}), "'y' is NaN at sample 1, time 1 s: fill the gap or leave the sample out"),
    (("now", {"x": 1, "y": 1}), "time is 'now' at sample 1, expected a number of seconds"),
    ((NAN, {"x": 1, "y": 1}), "time is nan at sample 1: give a finite number of seconds"),
    (
        (0.0, {"x": 1, "y": 1}),
        "time does not increase at sample 1: 0 s comes after 0 s; sort the samples and drop repeated timestamps",
    ),
    (
        (2.0, {"x": 1, "y": 1}),
        "sample 1 at 2 s is 2 s after the one before, expected 1 s (within 10%): "
        "give the right period, resample the trace, or use dense time (time='dense', on the command line --time dense)",
    ),
]


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(("sample", "message"), ONLINE)
def test_wrong_sample_leaves_the_monitor_as_it_was(sample: Any, message: str, backend: str) -> None:
    monitor = rtamt.parse("once(x + y >= 3)", backend=backend).monitor()
    assert monitor.update(0.0, x=5, y=1) == 3
    time, values = sample
    with pytest.raises(rtamt.TraceError) as info:
        monitor.update(time, **values)
    assert str(info.value) == message
    assert monitor.samples == 1
    assert monitor.update(1.0, x=0, y=0) == 3


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_wrong_step(backend: str) -> None:
    monitor = rtamt.parse("x + y >= 3", backend=backend).monitor()
    assert check_message(rtamt.TraceError, monitor.step, 1.0) == (
        "sample 0 has the wrong number of values: expected 2 (x, y), got 1"
    )
    assert (
        check_message(rtamt.TraceError, monitor.step, 1.0, "a") == "'y' is 'a' at sample 0, expected a number"
    )
    assert monitor.step(1.0, 2.0) == 0


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_wrong_chunk_leaves_the_monitor_as_it_was(backend: str) -> None:
    monitor = rtamt.parse("once(x >= 3)", backend=backend).monitor()
    monitor.update_many({"x": [5.0, 1.0]})
    assert check_message(rtamt.TraceError, monitor.update_many, {"time": [2, 3], "x": [9, NAN]}) == (
        "'x' is NaN at sample 3, time 3 s: fill the gap or leave the sample out"
    )
    assert check_message(rtamt.TraceError, monitor.update_many, {"time": [1, 2], "x": [9, 9]}) == (
        "time does not increase at sample 2: 1 s comes after 1 s; sort the samples and drop repeated timestamps"
    )
    assert check_message(rtamt.TraceError, monitor.update_many, {"time": [2, 4], "x": [9, 9]}) == (
        "sample 3 at 4 s is 2 s after the one before, expected 1 s (within 10%): "
        "give the right period, resample the trace, or use dense time (time='dense', on the command line --time dense)"
    )
    assert check_message(rtamt.TraceError, monitor.update_many, None) == (
        "expected a mapping from variable to values, such as {'time': [...], 'x': [...]}, got NoneType"
    )
    np.testing.assert_array_equal(monitor.update_many({"x": [0.0]}).values, [2.0])


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_a_finished_monitor_takes_no_sample(backend: str) -> None:
    monitor = rtamt.parse("x >= 3", backend=backend).monitor()
    monitor.update(0.0, x=1)
    monitor.finish()
    message = "the monitor has finished its trace; call reset() before the next sample"
    assert check_message(rtamt.UsageError, monitor.update, 1.0, x=1) == message
    assert check_message(rtamt.UsageError, monitor.step, 1) == message
    assert check_message(rtamt.UsageError, monitor.update_many, {"x": [1]}) == message
    assert len(monitor.finish()) == 0
    monitor.reset()
    assert monitor.update(0.0, x=1) == -2


def test_a_value_that_does_not_exist_is_named_offline() -> None:
    spec = rtamt.parse("always(sqrt(x) >= 1)")
    assert check_message(rtamt.EvaluationError, spec.evaluate, {"time": [5, 6, 7], "x": [1, 4, -1]}) == (
        "'sqrt(x)' has no value at sample 2, time 7 s: it is 0/0, inf - inf, 0 * inf, "
        "or a function outside its domain; change the formula or the data so that this cannot happen"
    )


def test_a_value_that_does_not_exist_is_named_online() -> None:
    monitor = rtamt.parse("eventually[0:1](x / y >= 1)").monitor(period=0.5)
    assert monitor.update(3.0, x=1, y=1) is None
    assert check_message(rtamt.EvaluationError, monitor.update, 3.5, x=0, y=0) == (
        "'x / y' has no value at sample 1, time 3.5 s: it is 0/0, inf - inf, 0 * inf, "
        "or a function outside its domain; change the formula or the data so that this cannot happen"
    )
    assert check_message(rtamt.EvaluationError, monitor.update_many, {"x": [1, 0], "y": [1, 0]}) == (
        "'x / y' has no value at sample 2, time 4 s: it is 0/0, inf - inf, 0 * inf, "
        "or a function outside its domain; change the formula or the data so that this cannot happen"
    )
    assert monitor.update(3.5, x=1, y=0) is None
    assert monitor.update(4.0, x=2, y=1) == INF


def test_the_callers_data_is_never_changed() -> None:
    data = {"time": [0, 1, 2], "x": np.array([1.0, 2.0, 3.0]), "y": [3, 2, 1]}
    before = {"time": [0, 1, 2], "x": np.array([1.0, 2.0, 3.0]), "y": [3, 2, 1]}
    result = rtamt.parse("x >= y").evaluate(data)
    result.signal.values[:] = 99
    with pytest.raises(ValueError, match="read-only"):
        result.signal.times[:] = 99
    monitor = rtamt.parse("x >= y").monitor()
    monitor.update_many(data).values[:] = 99
    assert data["time"] == before["time"]
    assert data["y"] == before["y"]
    np.testing.assert_array_equal(data["x"], before["x"])


def test_the_callers_time_stamps_are_never_changed() -> None:
    times = np.array([0.0, 1.0])
    result = rtamt.parse("x >= 1").evaluate({"time": times, "x": [1, 2]})
    with pytest.raises(ValueError, match="read-only"):
        result.signal.times[:] = 99
    times[:] = [0.0, 1.0]
    np.testing.assert_array_equal(times, [0.0, 1.0])
    signal = rtamt.parse("x").monitor().update_many({"time": times, "x": np.array([1.0, 2.0])})
    signal.times[:] = 99
    signal.values[:] = 99
    np.testing.assert_array_equal(times, [0.0, 1.0])


def test_the_path_of_a_specification_given_as_its_text() -> None:
    assert check_message(rtamt.UsageError, rtamt.robustness, "speed.stl", {"x": [1]}) == (
        "'speed.stl' is the name of a file; write rtamt.load('speed.stl') (if a formula is meant, put it in "
        "parentheses)"
    )


def test_wrong_settings() -> None:
    assert check_message(rtamt.UsageError, rtamt.parse, "x", backend="c++") == (
        "unknown backend 'c++'; back ends: cpp, python"
    )
    assert check_message(rtamt.UsageError, rtamt.parse, "x", period=0) == (
        "the sampling period is 0; it must be positive"
    )
    assert check_message(rtamt.UsageError, rtamt.load, "nowhere.stl") == (
        "cannot read the specification 'nowhere.stl': No such file or directory"
    )
    assert check_message(rtamt.UsageError, rtamt.load, "x >= 3") == (
        "cannot read the specification 'x >= 3': No such file or directory; rtamt.parse takes the text of a formula"
    )
    assert check_message(rtamt.UsageError, rtamt.load, "/dev/zero") == (
        "cannot read the specification '/dev/zero': it is a device, expected a file"
    )


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize("text", ["clip(x, y, 1)", "wrap(x, y, 1)", "wrap(x, x, y)"])
def test_a_value_missing_inside_an_expansion_named_operators_that_nobody_had_written(text, time, backend):
    spec = rtamt.parse(f"always({text} > 0 and x < 9)", time=time, backend=backend)
    data = {"x": [4.0, 4.0], "y": [3.0, 3.0]}
    with pytest.raises(rtamt.EvaluationError) as error:
        spec.evaluate(data if time == "discrete" else {name: ([0, 1], each) for name, each in data.items()})
    reason = {
        "clip": "the second operand is greater than the third",
        "wrap": "the second operand is not less than the third, or one of the three is infinite",
    }[text[:4]]
    assert str(error.value) == (
        f"'{text}' has no value at {'sample 0, ' * (time == 'discrete')}time 0 s: {reason}; "
        f"change the formula or the data so that this cannot happen"
    )
