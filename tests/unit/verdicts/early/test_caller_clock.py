"""Times of early monitors in the forms that callers have: the answers are those of seconds, in the caller's form."""

from __future__ import annotations

import copy
import pickle
from datetime import datetime, timedelta, timezone

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rtamt
from rtamt import Interval, TraceError

_START = np.datetime64("2024-05-01T12:00:00.1", "ns")
#: Of each form: settings, the time of a number of milliseconds as it is given, and as it is reported.
FORMS = {
    "ms": ({"time_unit": "ms"}, int, int),
    "fractions of s": ({"time_unit": "s"}, lambda ms: ms / 1000, lambda ms: ms / 1000),
    "datetime64": ({}, *(2 * [lambda ms: _START + np.timedelta64(ms, "ms")])),
    "timedelta64": ({}, *(2 * [lambda ms: np.timedelta64(ms, "ms").astype("m8[ns]")])),
    "datetime": (
        {},
        lambda ms: datetime(2024, 5, 1, 12, tzinfo=timezone.utc) + timedelta(milliseconds=ms),
        lambda ms: np.datetime64("2024-05-01T12", "ns") + np.timedelta64(ms, "ms"),
    ),
}

_SAMPLES = st.lists(st.tuples(st.integers(-8, 8), st.integers(0, 2)), min_size=1, max_size=30)


def _continued(monitor, how):
    if how == "pickle":
        return pickle.loads(pickle.dumps(monitor))
    return copy.copy(monitor) if how == "copy" else monitor


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("backend", ["cpp", "python"])
@settings(max_examples=25)
@given(
    samples=_SAMPLES,
    how=st.sampled_from(["", "copy", "pickle"]),
    text=st.sampled_from(["x > 0", "always[0:0.3](x > 0)", "eventually[0.1:0.4](x > 5)", "always(x > -8)"]),
)
def test_verdicts_are_those_of_seconds_in_the_form_of_the_caller(form, backend, samples, how, text):
    more, given_as, reported = FORMS[form]
    spec = rtamt.parse(text, period="100ms", backend=backend)
    monitor, expected = spec.monitor(verdict="eager", **more), spec.monitor(verdict="eager")
    milliseconds = [100 * i + late for i, (_, late) in enumerate(samples)]
    found, wanted = [], []
    for ms, (x, _) in zip(milliseconds, samples, strict=True):
        monitor = _continued(monitor, how)
        found.append(monitor.update(given_as(ms), x=x))
        wanted.append(expected.update(ms / 1000, x=x))
    found.append(monitor.finish())
    wanted.append(expected.finish())
    for verdicts, seconds in zip(found, wanted, strict=True):
        assert [(v.time, v.satisfied, v.decided_at) for v in verdicts] == [
            (reported(round(1000 * v.time)), v.satisfied, reported(round(1000 * v.decided_at)))
            for v in seconds
        ]


# A missing time in fractions is a sum, which may miss the last digit.
@pytest.mark.parametrize("form", sorted(FORMS.keys() - {"fractions of s"}))
@settings(max_examples=25)
@given(
    samples=st.lists(st.tuples(st.integers(-8, 8), st.integers(0, 3)), min_size=1, max_size=20),
    how=st.sampled_from(["", "copy", "pickle"]),
)
def test_late_bounds_are_those_of_seconds_in_the_form_of_the_caller(form, samples, how):
    more, given_as, reported = FORMS[form]
    spec = rtamt.parse("eventually[0:0.3](x > 0)", period="100ms")
    monitor, expected = (
        spec.monitor(verdict="interval", lateness="300ms", ranges={"x": (-8, 8)}, **each)
        for each in (more, {})
    )
    order = sorted(range(len(samples)), key=lambda i: i + samples[i][1])
    for i in order:
        monitor = _continued(monitor, how)
        for each, time in ((monitor, given_as(100 * i)), (expected, i / 10)):
            each.update(time, x=samples[i][0])
    for changes, seconds in ((monitor.changes(), expected.changes()), (monitor.finish(), expected.finish())):
        assert [(c.begin, c.end, c.interval, c.final) for c in changes] == [
            (reported(round(1000 * c.begin)), reported(round(1000 * c.end)), c.interval, c.final)
            for c in seconds
        ]
    last = max(order)
    assert monitor.interval(given_as(100 * last)) == expected.interval(last / 10)


def test_a_missing_sample_has_the_time_that_follows_from_those_before_it():
    monitor = rtamt.parse("x > 0").monitor(verdict="interval", period="1ms", time_unit="us", lateness="2ms")
    for time in (1000, 2000, 3000, 4000, 7000):
        monitor.update(time, x=time)
    assert [(c.begin, c.end) for c in monitor.changes()] == [(5000, 6000), (7000, 7000)]


def test_watermark_and_clock_take_dates_as_samples_do():
    monitor = rtamt.parse("eventually[0:1](x > 0)").monitor(verdict="interval", lateness=2)
    noon = np.datetime64("2024-05-01T12:00:00")
    monitor.update(noon, x=3)
    assert monitor.interval() == Interval(float("-inf"), float("inf"))
    monitor.advance(noon + np.timedelta64(5, "s"))
    assert monitor.interval() == Interval(3.0, float("inf"))
    monitor.watermark(noon + np.timedelta64(4, "s"))
    with pytest.raises(TraceError, match="later than the lateness"):
        monitor.update(noon + np.timedelta64(1, "s"), x=1)


def test_first_samples_survive_a_pickle_before_it_is_known_where_the_trace_starts():
    monitor = rtamt.parse("x > 0").monitor(verdict="interval", lateness=2)
    monitor.update(1, x=3)
    monitor = pickle.loads(pickle.dumps(monitor))
    monitor.finish()
    assert monitor.interval() == Interval(3.0, 3.0)


@pytest.mark.parametrize("verdict", ["eager", "interval"])
@pytest.mark.parametrize(
    ("more", "first", "second", "message"),
    [
        ({}, np.datetime64("2024-01-01"), 5.0, "'time' is in seconds at sample 1, but before in datetimes"),
        ({}, 0.0, np.datetime64("2024-01-01"), "expected a number of seconds"),
        ({"time_unit": "ms"}, 0, np.datetime64("2024-01-01"), "expected a number of ms"),
        ({}, np.datetime64("2024-01-01"), np.datetime64("NaT"), "give a finite number of seconds"),
    ],
)
def test_mixed_forms_of_time_are_rejected_and_change_nothing(verdict, more, first, second, message):
    monitor = rtamt.parse("x > 0").monitor(verdict=verdict, **more)
    monitor.update(first, x=1)
    with pytest.raises(TraceError, match=message):
        monitor.update(second, x=1)
    assert monitor.samples == 1


def test_times_that_nobody_can_ask_for_are_forgotten():
    monitor = rtamt.parse("always[0:3ms](x > 0)", period="1ms").monitor(verdict="eager", time_unit="ms")
    for i in range(3000):
        monitor.update(i + (i % 7) / 100, x=1)
    assert len(monitor._clock._seconds) < 600
