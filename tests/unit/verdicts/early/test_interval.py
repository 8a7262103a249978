"""Monitors of bounds: what the laws do not show."""

from __future__ import annotations

import contextlib
import copy
import pickle
from math import inf

import pytest

import rtamt
from rtamt import EvaluationError, Interval
from rtamt.verdicts.early.discrete_interval import latest

SETTINGS = {"verdict": "interval", "ranges": {"x": (0, 10)}}


def interval(text="eventually[0:3](x >= 3)", **settings):
    return rtamt.parse(text).monitor(**{**SETTINGS, **settings})


def ends(monitor, *time):
    found = monitor.interval(*time)
    return found.lower, found.upper


@pytest.mark.parametrize("twin", [copy.copy, lambda monitor: pickle.loads(pickle.dumps(monitor))])
def test_copy_goes_its_own_way(twin):
    monitor = interval()
    monitor.update(0, x=4)
    other = twin(monitor)
    other.update(1, x=9)
    assert (ends(monitor), ends(other)) == ((1.0, 7.0), (6.0, 7.0))


def test_failed_update_leaves_the_monitor_as_it_was():
    monitor = interval("always[0:2](once(sqrt(x - 4)) + x >= 0)")
    monitor.update(0, x=5)
    before = monitor.interval(), monitor.samples
    with pytest.raises(rtamt.EvaluationError):
        monitor.update(1, x=3)
    assert (monitor.interval(), monitor.samples) == before
    monitor.update(1, x=5)


@pytest.mark.parametrize(
    ("text", "before", "after"),
    [
        ("always(x >= 3)", (-3, 2), (-3, -2)),
        ("eventually(x >= 3)", (2, 7), (2, 7)),
        ("not eventually(x < 3)", (-3, 2), (-3, -2)),
        ("always(x >= 3) or eventually[0:1](x >= 9)", (-3, 2), (-3, -2)),
        ("(x >= 3) until (x >= 9)", (-4, 1), (-4, -2)),
        ("(x >= 3) until[2:inf] (x >= 9)", (-9, 1), (-9, -2)),
        ("always(eventually(x >= 3))", (-3, 7), (-3, 7)),
    ],
)
def test_unbounded_future_has_bounds_at_the_start(text, before, after):
    monitor = interval(text)
    monitor.update(0, x=5)
    assert ends(monitor) == before
    monitor.update(1, x=1)
    assert ends(monitor) == after


@pytest.mark.parametrize("copied", [False, True])
@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(
    ("text", "at_end"),
    [
        ("always(s_next true) and always(x < 9)", -inf),
        ("always(s_next true) or eventually(x > 9)", -9),
        ("always(x < 9 until s_next true)", -inf),
        ("not eventually(next false) and x < 9", -inf),
        ("eventually(not s_next true) or x > 9", inf),
    ],
)
def test_after_64_samples_or_a_copy_the_end_of_the_trace_no_longer_cut_windows(text, at_end, backend, copied):
    spec = rtamt.parse(text, backend=backend)
    monitor = spec.monitor(verdict="interval", at="start")
    for t in range(70):
        monitor.update(t, x=0)
        if copied and t == 1:
            monitor = copy.copy(monitor)
    monitor.finish()
    offline = spec.evaluate({"x": [0] * 70}).robustness
    assert ends(monitor) == (offline, offline) == (at_end, at_end)


def test_correction_is_replayed_and_reported_as_a_retraction():
    monitor = interval("once[0:1](x >= 3)", lateness=2, on_correction="replay")
    for t in range(5):
        monitor.update(t, x=5)
    monitor.update(3, x=1)
    assert [change[:3] for change in monitor.changes()] == []
    monitor.update(4, x=2)
    (change,) = monitor.changes()
    assert (change.begin, change.interval, change.retracted) == (4.0, Interval(-1.0, -1.0), True)


def test_late_sample_fills_its_gap():
    monitor = interval(lateness="2s")
    for t in (0, 1, 3):
        monitor.update(t, x=3)
    assert ends(monitor) == (0.0, 7.0)
    monitor.update(2, x=9)
    assert ends(monitor) == (6.0, 6.0)


def test_watermark_closes_what_is_missing():
    monitor = interval("x >= 3", lateness=5)
    monitor.update(0, x=5)
    monitor.update(1, x=None)
    monitor.advance(7)
    with pytest.raises(rtamt.TraceError, match="later than the lateness"):
        monitor.update(1, x=4)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            {"x": 11},
            "'x' is 11 at sample 1, time 1 s, outside its declared range [0, 10]: "
            "correct the value, or declare a wider range",
        ),
        ({"x": (5, 4)}, "'x' is (5, 4) at sample 1, time 1 s, reversed: give the lower bound first"),
        (
            {"x": "4"},
            "'x' is '4' at sample 1, time 1 s; expected a number, bounds (lower, upper), or None if it is missing",
        ),
        ({"y": 4}, "the formula has no variable 'y'; variables: x"),
        ({}, "the data has no 'x'; signals: none"),
    ],
)
def test_wrong_sample_is_rejected_with_one_sentence(values, message):
    monitor = interval()
    monitor.update(0, x=4)
    before = monitor.interval()
    with pytest.raises(rtamt.TraceError) as error:
        monitor.update(1, **values)
    assert str(error.value) == message
    assert (monitor.interval(), monitor.samples) == (before, 1)


def test_sample_later_than_the_lateness_is_rejected_with_one_sentence():
    monitor = interval(lateness=2)
    for t in range(4):
        monitor.update(t, x=4)
    with pytest.raises(rtamt.TraceError) as error:
        monitor.update(0, x=4)
    assert str(error.value) == (
        "sample 4, at 0 s, is later than the lateness of 2 s allows: everything up to 0 s is final; "
        "leave it out, or allow for more lateness"
    )


def test_bounds_of_every_sample_are_reported_when_old_ones_are_dropped():
    # Every 64th sample was reported as open, because it had been dropped with those before it.
    monitor = interval("x >= 3", at="every")
    for t in range(200):
        monitor.update(t, x=t % 10)
        exact = Interval(t % 10 - 3, t % 10 - 3)
        assert monitor.interval(t) == exact
        assert [change[:3] for change in monitor.changes()] == [(t, t, exact)]


@pytest.mark.parametrize("copied", [False, True])
def test_a_value_that_does_not_exist_is_an_error_also_once_the_start_is_decided_and_the_monitor_copied(
    copied,
):
    spec = rtamt.parse("delay[1](y) / sin(y) >= x", period=1)
    monitor = spec.monitor(verdict="interval", at="start")
    monitor.update(0, x=0, y=0.5)
    monitor.update(1, x=0, y=0.5)
    if copied:
        monitor = copy.deepcopy(monitor)
    monitor.update(2, x=0, y=0)
    with pytest.raises(EvaluationError, match="has no value at sample 3"):
        monitor.update(3, x=0, y=0)


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("verdict", ["interval", "eager", "delayed"])
def test_samples_whose_later_values_do_not_exist_are_accepted_until_the_trace_is_as_long(backend, verdict):
    monitor = rtamt.parse("sqrt(delay[1](y, 0)) < 9", period=0.5, backend=backend).monitor(verdict=verdict)
    monitor.update(10, y=-2.0)
    monitor.update(10.5, y=1.0)
    for _ in range(2):
        with pytest.raises(EvaluationError, match="has no value at sample 2, time 11 s"):
            monitor.update(11, y=1.0)
    monitor.finish()


def test_error_that_a_late_sample_causes_has_the_time_of_the_sample_without_a_value():
    monitor = rtamt.parse("sqrt(delay[1](y, 0)) < 9", period=0.5).monitor(verdict="interval", lateness=2)
    for time, y in ((10, 1.0), (11, 1.0), (12, 1.0)):
        monitor.update(time, y=y)
    with pytest.raises(EvaluationError, match=r"has no value at sample 3, time 11\.5 s"):
        monitor.update(10.5, y=-2.0)


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_error_names_the_earliest_of_several_instants_that_one_late_sample_leaves_without_a_value(backend):
    spec = rtamt.parse("sqrt(delay[1](x, 9) + ahead[1](x)) < 1", period=1, backend=backend)
    monitor = spec.monitor(verdict="interval", lateness="4s")
    for time, x in ((0, 5.0), (1, -3.0), (5, -3.0)):
        monitor.update(time, x=x)
    with pytest.raises(EvaluationError, match="has no value at sample 2, time 2 s"):
        monitor.update(3, x=-1.0)  # which is read at 2 s and at 4 s


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("verdict", ["interval", "eager", "delayed"])
def test_values_that_do_not_exist_behind_the_end_in_dense_time_are_errors_where_a_window_reads_them(
    backend, verdict
):
    for text, fails in (
        ("sqrt(delay[2](y, 0)) < 9 and eventually[0:5](y > 0)", False),
        ("eventually[0:1](sqrt(delay[2](y, 0)) < 9)", True),
        ("(sqrt(delay[2](y, 0)) < 9) until[0:1] (y > 0)", True),
        ("(y > 0) until[0:1] (sqrt(delay[3](y, 0)) < 9)", False),
    ):
        spec = rtamt.parse(text, time=rtamt.Dense("1s"), backend=backend)
        monitor = spec.monitor(verdict=verdict)
        monitor.update(0, y=-2.0)
        monitor.update(1, y=1.0)
        with pytest.raises(EvaluationError, match="at time 2 s") if fails else contextlib.nullcontext():
            monitor.finish()
        with pytest.raises(EvaluationError, match="at time 2 s") if fails else contextlib.nullcontext():
            spec.evaluate({"y": ([0, 1], [-2.0, 1.0])})


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("mark", [3, 4, 5, 9])
def test_watermark_behind_the_newest_sample_leaves_what_the_end_of_the_trace_cuts(mark, backend):
    spec = rtamt.parse("always[0:2](x >= 3)", backend=backend)
    monitor = spec.monitor(verdict="interval", lateness="2s")
    for t in range(4):
        monitor.update(t, x=6)
    monitor.watermark(mark)
    assert [(each.begin, each.interval) for each in monitor.finish()] == [
        (2, rtamt.Interval(3, 3)),
        (3, rtamt.Interval(3, 3)),
    ]


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_uncertain_sample_outside_the_domain_below_a_delay_is_an_error_once_the_trace_is_there(time, backend):
    spec = rtamt.parse("sqrt(delay[2](y, 0)) >= 0", backend=backend)
    monitor = spec.monitor(verdict="interval", time=time)
    monitor.update(0, y=(-3, -2))
    monitor.update(1, y=1)
    with pytest.raises(rtamt.EvaluationError, match="time 2 s"):
        monitor.update(2, y=1)
    assert monitor.samples == 2


def test_each_sample_has_the_bounds_of_its_last_run():
    runs = [
        (0, 9, 0.0, 9.0),
        (3, 4, 1.0, 2.0),
        (4, 4, 2.0, 2.0),
        (20, 20, 5.0, 5.0),
        (8, 12, 0.0, 9.0),
        (0, 0, 1.0, 1.0),
    ]
    last = {sample: bounds for begin, end, *bounds in runs for sample in range(begin, end + 1)}
    assert [(t, bounds) for begin, end, *bounds in latest(runs) for t in range(begin, end + 1)] == sorted(
        last.items()
    )
    assert [run[:2] for run in latest(runs)] == [(0, 0), (1, 2), (3, 3), (4, 4), (5, 12), (20, 20)]


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("watch", [[], ["A"], ["B"], ["A", "B"]])
def test_bounds_at_the_start_never_narrow_beside_watched_requirements(watch, backend):
    text = "require A: eventually[1:3](y <= 1)\nrequire B: always[0:3](x > -2)"
    monitor = rtamt.parse(text, backend=backend).monitor(verdict="interval", at="start", watch=watch)
    found = []
    for t, (x, y) in enumerate([(-0.5, 2.5), (1.0, 1.0), (2.0, -0.5), (2.0, -0.5)]):
        monitor.update(t, x=x, y=y)
        found.append(monitor.interval())
    assert found == [rtamt.Interval(-inf, 1.5)] * 3 + [rtamt.Interval(1.5, 1.5)]


@pytest.mark.parametrize("lateness", [None, "1s", "3s"])
@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_a_constant_without_a_value_has_none_at_the_first_sample(lateness, backend):
    spec = rtamt.parse("always[0:1](x <= sqrt(-1))", backend=backend)
    monitor = spec.monitor(verdict="interval", lateness=lateness)
    with pytest.raises(rtamt.EvaluationError, match=r"'sqrt\(-1\)' has no value at sample 0, time 5 s"):
        monitor.update(5.0, x=None)
