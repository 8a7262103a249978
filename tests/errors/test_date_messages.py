"""Messages have dates where the caller's times are dates, in every verdict mode, and of recordings and fleets too."""

from __future__ import annotations

import datetime as dt

import numpy as np
import pytest

import rtamt

START = np.datetime64("2024-03-01T12:00:00", "ns")
MODES = {
    "delayed": {},
    "worst case": {"worst_case": True},
    "episodes": {"episodes": True},
    "eager": {"verdict": "eager"},
    "interval": {"verdict": "interval"},
    "late": {"verdict": "interval", "lateness": "1s"},
    "causation": {"verdict": "causation"},
}
#: The time of the wrong sample, the third one, in seconds after the start, its value, and part of the message.
WRONG = {
    "NaN": (2, float("nan"), "time 2024-03-01T12:00:02"),
    "undefined": (2, -1.0, "time 2024-03-01T12:00:02"),
    "gap": (2.5, 4.0, "sample 2 at 2024-03-01T12:00:02.5 is 1.5 s after the one before"),
    "backward": (0, 4.0, "2024-03-01T12:00:00 comes after 2024-03-01T12:00:01"),
}


def error_of(act):
    with pytest.raises(rtamt.StlError) as caught:
        act()
    return str(caught.value)


def at(seconds):
    return START + np.timedelta64(round(seconds * 1000), "ms")


@pytest.mark.parametrize(
    ("backend", "mode"),
    [
        (backend, mode)
        for backend in ("cpp", "python")
        for mode in MODES
        if (backend, mode) != ("python", "worst case")
    ],
)
@pytest.mark.parametrize("kind", WRONG)
def test_of_a_monitor(mode, kind, backend):
    monitor = rtamt.parse("always[0:1](sqrt(x) >= 1)", backend=backend).monitor(**MODES[mode])
    for t in range(2):
        monitor.update(at(t), x=4.0)
    time, value, expected = WRONG[kind]
    if mode == "late" and kind == "gap":
        expected = "sample 2 at 2024-03-01T12:00:02.5 is"
    if mode == "late" and kind == "backward":
        time, expected = -1, "sample 2, at 2024-03-01T11:59:59, is later than the lateness of 1 s allows"
    assert expected in error_of(lambda: (monitor.update(at(time), x=value), monitor.finish()))


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("kind", WRONG)
@pytest.mark.parametrize("way", ["evaluate", "update_many", "first chunk", "bounds"])
def test_of_samples_at_once(way, kind, backend):
    time, value, expected = WRONG[kind]
    spec = rtamt.parse("always[0:1](sqrt(x) >= 1)", period="1s", backend=backend)
    data = {"time": [at(t) for t in (0, 1, time)], "x": [4.0, 4.0, value]}
    if way == "evaluate":
        assert expected in error_of(lambda: spec.evaluate(data))
    elif way == "bounds":
        assert expected in error_of(lambda: spec.evaluate(data, uncertainty={"x": 0.0}))
    else:
        monitor = spec.monitor()
        if way == "update_many":
            monitor.update_many({name: column[:2] for name, column in data.items()})
            data = {name: column[2:] for name, column in data.items()}
        assert expected in error_of(lambda: monitor.update_many(data))


@pytest.mark.parametrize(
    ("settings", "key"),
    [({}, "key 'car'"), ({"lateness": 0}, "key 'car'"), ({"verdict": "eager"}, "key 'car'")],
    ids=str,
)
def test_of_a_fleet(settings, key):
    fleet = rtamt.Fleet(rtamt.parse("always[0:1](sqrt(x) >= 1)"), 10, **settings)
    fleet.update_many(["car"], [START], {"x": [4.0]})
    with pytest.raises(rtamt.TraceError, match=rf"^{key}.*'x' is NaN.* 2024-03-01T12:00:01: fill the gap"):
        fleet.update_many(["car"], [at(1)], {"x": [float("nan")]})


@pytest.mark.parametrize("settings", [{}, {"worst_case": True}, {"episodes": True}], ids=str)
@pytest.mark.parametrize(
    "start", [START, dt.datetime(2024, 3, 1, 12), dt.timedelta(hours=1), np.timedelta64(5, "ms")], ids=repr
)
def test_the_first_sample_of_a_monitor_may_have_a_date_or_a_duration(start, settings):
    spec = rtamt.parse("always[0:1](x >= 3)")
    second = (
        dt.timedelta(seconds=1) if isinstance(start, dt.datetime | dt.timedelta) else np.timedelta64(1, "s")
    )
    times = [start + t * second for t in range(3)]
    monitor = spec.monitor(**settings)
    assert [monitor.update(time, x=x) for time, x in zip(times, [5.0, 4.0, 6.0], strict=True)] == [
        None,
        1.0,
        1.0,
    ]
    rest, whole = monitor.finish(), spec.evaluate({"time": times, "x": [5.0, 4.0, 6.0]}).signal
    assert rest.times.tolist() == whole.times[2:].tolist()
    assert rest.values.tolist() == [3.0]
    monitor.reset()
    assert monitor.update(0.0, x=1.0) is None


def test_a_wrong_first_sample_leaves_the_form_of_times_open():
    monitor = rtamt.parse("sqrt(x) >= 3").monitor()
    with pytest.raises(rtamt.EvaluationError, match="time 2024-03-01T12:00:00: "):
        monitor.update(START, x=-1.0)
    assert monitor.update(0.0, x=16.0) == 1.0


def test_a_later_chunk_counts_samples_from_the_start():
    monitor = rtamt.parse("x >= 3").monitor()
    monitor.update_many({"x": [5.0, 5.0, 5.0]})
    with pytest.raises(rtamt.TraceError, match=r"^'x' is 'a' at sample 4, expected a number$"):
        monitor.update_many({"x": [5.0, "a"]})
    with pytest.raises(rtamt.TraceError, match=r"^'time' is 'b' at sample 4, expected a number$"):
        monitor.update_many({"time": [3, "b"], "x": [5.0, 5.0]})


@pytest.mark.parametrize("inner", ["v.x > 3", "eventually[0:1](v.x > 3)"])
def test_members_over_dates(inner):
    spec = rtamt.parse(f'group cars = "car_*"; always[0:1] forall v in cars: {inner}')
    data = {"time": [at(t) for t in range(5)], "car_1.x": [5.0, 6.0, 2.0, 8.0, 9.0]}
    whole = spec.evaluate(data).signal
    monitor, found = spec.monitor(), []
    for first, last in ((0, 2), (2, 4)):
        found.append(monitor.update_many({name: column[first:last] for name, column in data.items()}))
    found.append(monitor.update_many({"car_1.x": [9.0]}))
    found.append(monitor.finish())
    times = np.concatenate([each.times for each in found if len(each.times)])
    assert times.tolist() == whole.times.tolist()
    assert np.concatenate([each.values for each in found]).tolist() == whole.values.tolist()
    with pytest.raises(rtamt.TraceError, match="NaN at sample 0, time 2024-03-01T12:00:00"):
        spec.monitor().update(START, **{"car_1.x": float("nan")})
