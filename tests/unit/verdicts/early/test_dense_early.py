"""Monitors of verdicts and bounds before the horizon in dense time: what the laws do not cover."""

from __future__ import annotations

import copy
import pickle
from datetime import datetime, timedelta

import numpy as np
import pytest

import rtamt
from rtamt import Interval, VerdictRun

EAGER = {"verdict": "eager", "time": "dense"}
SETTINGS = {"verdict": "interval", "time": rtamt.Dense(resolution="100ms"), "ranges": {"x": (0, 10)}}
#: One tick.
TICK = 0.1


def interval(text="eventually[0:3](x >= 3)", **settings):
    return rtamt.parse(text).monitor(**{**SETTINGS, **settings})


def ends(monitor, *time):
    found = monitor.interval(*time)
    return found.lower, found.upper


def changes(monitor):
    return [(each.begin, each.end, each.interval.lower, each.interval.upper) for each in monitor.changes()]


# ---- verdicts -----------------------------------------------------------------------------------


def test_each_instant_is_reported_once_and_at_the_first_sample_that_settles_it():
    monitor = rtamt.parse("always[0:9](x >= 3)").monitor(verdict="eager", time=rtamt.Dense(resolution="1s"))
    assert monitor.update(0, x=4) == []
    assert monitor.update(3, x=2) == [VerdictRun(0.0, 4.0, False, 3.0)]
    assert monitor.update(8, x=4) == [VerdictRun(4.0, 8.0, False, 8.0)]
    assert monitor.finish() == [VerdictRun(8.0, 9.0, True, 8.0)]
    assert monitor.finish() == []


def test_what_is_settled_before_it_is_reached_waits():
    monitor = rtamt.parse("once[0:5](x >= 3)").monitor(verdict="eager", time=rtamt.Dense(resolution="1s"))
    assert monitor.update(0, x=4) == [VerdictRun(0.0, 1.0, True, 0.0)]
    assert monitor.update(9, x=0) == [VerdictRun(1.0, 6.0, True, 0.0), VerdictRun(6.0, 10.0, True, 9.0)]


def test_lagging_variable_settles_instants_of_the_past():
    spec = rtamt.parse("x >= 3 or y >= 3")
    monitor = spec.monitor(verdict="eager", time=rtamt.Dense(resolution="1s"))
    assert monitor.update(0, x=4) == []  # the trace has not started
    assert monitor.update(5, x=1) == []
    assert monitor.update(0, y=4) == [VerdictRun(0.0, 5.0, True, 0.0)]
    assert monitor.update(9, y=1) == [VerdictRun(5.0, 9.0, True, 9.0)]


def test_unbounded_always_is_violated_up_to_its_violation():
    monitor = rtamt.parse("always(x >= 3)").monitor(verdict="eager", time=rtamt.Dense(resolution="1s"))
    assert monitor.update(0, x=4) == []
    assert monitor.update(5, x=0) == [VerdictRun(0.0, 6.0, False, 5.0)]


def test_several_requirements_start_with_their_own_variables():
    spec = rtamt.parse("require a: x >= 3\nrequire b: y >= 3")
    monitor = spec.monitor(verdict="eager", time=rtamt.Dense(resolution="1s"), watch=["a", "b"])
    assert monitor.update(0, x=4) == []
    assert monitor["a"] == [VerdictRun(0.0, 1.0, True, 0.0)]
    # The result is that of both once all variables have started; before 5, b has none.
    assert monitor.update(5, x=4, y=1) == [VerdictRun(0.0, 5.0, True, 5.0), VerdictRun(5.0, 6.0, False, 5.0)]
    assert monitor["b"] == [VerdictRun(5.0, 6.0, False, 5.0)]


def test_times_are_reported_as_they_were_given():
    start = datetime(2026, 1, 1)
    monitor = rtamt.parse("x >= 3").monitor(**EAGER)
    monitor.update(start, x=4)
    (run,) = monitor.update(start + timedelta(seconds=1.5), x=4)
    assert run.begin == np.datetime64("2026-01-01T00:00:00.000000001")
    assert run.end == np.datetime64("2026-01-01T00:00:01.500000001")
    in_ns = rtamt.parse("x >= 3").monitor(**EAGER, time_unit="ns")
    assert in_ns.update(1_700_000_000_000_000_007, x=4) == [
        VerdictRun(1_700_000_000_000_000_007, 1_700_000_000_000_000_008, True, 1_700_000_000_000_000_007)
    ]


# ---- bounds -------------------------------------------------------------------------------------


def test_a_sample_holds_up_to_the_next_one_and_the_watermark_says_that_none_comes():
    monitor = interval("always[0:1](x >= 3)")
    monitor.update(0, x=5)
    assert changes(monitor) == [(0.0, 0.1, -3.0, 2.0)]
    monitor.update(1, x=4)
    assert changes(monitor) == [(0.0, 0.1, 1.0, 1.0), (0.1, 1.1, -3.0, 1.0)]
    monitor.watermark(1.5)
    assert changes(monitor) == [(0.1, 0.6, 1.0, 1.0)]
    monitor.advance(3)
    assert changes(monitor) == [(0.6, 1.1, 1.0, 1.0)]


def test_missing_sample_ends_the_one_before():
    monitor = interval("x >= 3")
    monitor.update(0, x=5)
    monitor.update(1, x=None)
    monitor.update(2, x=(6, 7))
    assert [ends(monitor, t) for t in (0.5, 1, 1.5, 2)] == [(2, 2), (-3, 7), (-3, 7), (3, 4)]
    assert [(each.begin, each.end, each.interval, each.final) for each in monitor.changes()] == [
        (1.1, 2.0, Interval(-3.0, 7.0), True),
        (2.0, 2.1, Interval(3.0, 4.0), True),
    ]
    assert monitor.finish() == []


@pytest.mark.parametrize(
    ("text", "before", "after"),
    [
        ("always(x >= 3)", (-3, 2), (-3, -2)),
        ("eventually(x >= 3)", (2, 7), (2, 7)),
        ("not eventually(x < 3)", (-3, 2), (-3, -2)),
        ("(x >= 3) until (x >= 9)", (-4, 1), (-4, -2)),
        ("always(eventually(x >= 3))", (-3, 7), (-3, 7)),
    ],
)
def test_unbounded_future_has_bounds_at_the_start(text, before, after):
    monitor = interval(text)
    monitor.update(0, x=5)
    assert ends(monitor) == before
    monitor.update(1, x=1)
    assert ends(monitor) == after


def test_late_sample_changes_what_it_holds():
    monitor = interval("x >= 3", lateness="2s")
    for t in (0, 1, 3):
        monitor.update(t, x=3)
    assert [ends(monitor, t) for t in (0.5, 1, 1.5, 3)] == [(0, 0), (0, 0), (-3, 7), (0, 0)]
    monitor.update(2, x=9)
    assert changes(monitor) == [(2.0, 2.1, 6.0, 6.0)]
    monitor.update(4.1, x=3)
    assert [ends(monitor, t) for t in (1.5, 2)] == [(0, 0), (6, 6)]


def test_the_trace_of_late_samples_starts_when_no_earlier_one_can_come():
    monitor = interval("x >= 3", lateness="2s")
    monitor.update(1, x=3)
    with pytest.raises(rtamt.UsageError) as error:
        monitor.interval(1)
    assert str(error.value) == (
        "the trace has not started: it does when every variable has a sample, and no earlier one can come"
    )
    monitor.update(0, x=9)
    monitor.update(2.1, x=3)
    assert changes(monitor) == [
        (0.0, 0.1, 6.0, 6.0),
        (0.1, 1.0, -3.0, 7.0),
        (1.0, 1.1, 0.0, 0.0),
        (1.1, 2.1, -3.0, 7.0),
        (2.1, 2.2, 0.0, 0.0),
    ]


def test_correction_is_replayed_and_reported_as_a_retraction():
    monitor = interval("x >= 3", lateness=2, on_correction="replay")
    for t in range(5):
        monitor.update(t, x=5)
    monitor.watermark(3.5)
    monitor.update(4, x=2)
    (change,) = monitor.changes()
    assert (change.begin, change.interval, change.retracted) == (4.0, Interval(-1, -1), True)
    with pytest.raises(rtamt.TraceError, match=r"everything up to 3.5 s is final"):
        monitor.update(3.5, x=1)


@pytest.mark.parametrize("twin", [copy.copy, lambda monitor: pickle.loads(pickle.dumps(monitor))])
def test_copy_goes_its_own_way(twin):
    monitor = interval()
    monitor.update(0, x=4)
    other = twin(monitor)
    other.update(1, x=9)
    assert (ends(monitor), ends(other)) == ((1.0, 7.0), (6.0, 7.0))
    eager = rtamt.parse("once[0:5](x >= 3)").monitor(**EAGER)
    eager.update(0, x=4)
    assert twin(eager).update(1, x=0) == eager.update(1, x=0) != []


def test_failed_update_leaves_the_monitor_as_it_was():
    monitor = interval("always[0:2](once(sqrt(x - 4)) + x >= 0)")
    monitor.update(0, x=5)
    before = monitor.interval(), monitor.samples, changes(monitor)
    with pytest.raises(rtamt.EvaluationError, match="'sqrt\\(x - 4\\)' has no value at time 1 s"):
        monitor.update(1, x=3)
    assert (monitor.interval(), monitor.samples, changes(monitor)) == before
    monitor.update(1, x=5)


@pytest.mark.parametrize(
    ("time", "values", "message"),
    [
        (
            1,
            {"x": 11},
            "'x' is 11 at sample 1, time 1 s, outside its declared range [0, 10]: "
            "correct the value, or declare a wider range",
        ),
        (1, {"x": (5, 4)}, "'x' is (5, 4) at sample 1, time 1 s, reversed: give the lower bound first"),
        (
            1,
            {"x": "4"},
            "'x' is '4' at sample 1, time 1 s; expected a number, bounds (lower, upper), or None if it is missing",
        ),
        (1, {"x": float("nan")}, "'x' is NaN at sample 1, time 1 s: fill the gap or leave the sample out"),
        (1, {"y": 4}, "the formula has no variable 'y'; variables: x"),
        (
            0,
            {"x": 4},
            "'x' has two samples at 0 s (sample 1 and the one before, with ticks of 100 ms): keep one of them, or "
            "choose a finer resolution",
        ),
        ("now", {"x": 4}, "the time of 'x' is 'now' at sample 1, expected a number of seconds or a datetime"),
    ],
)
def test_wrong_sample_is_rejected_with_one_sentence(time, values, message):
    monitor = interval()
    monitor.update(0, x=4)
    before = monitor.interval()
    with pytest.raises(rtamt.TraceError) as error:
        monitor.update(time, **values)
    assert str(error.value) == message
    assert (monitor.interval(), monitor.samples) == (before, 1)


def test_sample_later_than_the_lateness_is_rejected_with_one_sentence():
    monitor = interval(lateness=2)
    for t in range(4):
        monitor.update(t, x=4)
    with pytest.raises(rtamt.TraceError) as error:
        monitor.update(0.5, x=4)
    assert str(error.value) == (
        "the sample at 0.5 s is later than the lateness of 2 s allows: everything up to 0.9 s is final; "
        "leave it out, or allow for more lateness"
    )


def test_sample_before_the_watermark_is_rejected_with_one_sentence():
    monitor = interval()
    monitor.update(0, x=4)
    monitor.watermark(3)
    with pytest.raises(rtamt.TraceError) as error:
        monitor.update(2, x=4)
    assert str(error.value) == (
        "the sample at 2 s comes too late: everything up to 3 s is final; leave it out, or set the watermark later"
    )


def test_end_without_a_sample_of_a_variable_is_an_error_that_names_it():
    monitor = interval("x >= 3 or y >= 3")
    monitor.update(0, x=4)
    with pytest.raises(rtamt.TraceError, match=r"^'y' has no samples; provide one before finish\(\)$"):
        monitor.finish()
    monitor.update(0, y=4)
    monitor.finish()


def test_watched_formulas_report_their_own_changes():
    spec = rtamt.parse("always[0:5](x >= 3)")
    bounds = spec.monitor(**SETTINGS, watch=["x >= 3", spec.formula])
    bounds.update(0, x=4)
    bounds.update(1, x=5)
    assert [(c.begin, c.end, c.interval.lower) for c in bounds["x >= 3"]] == [
        (0.1, 1.0, 1.0),
        (1.0, 1.1, 2.0),
    ]
    assert bounds[spec.formula] == bounds.changes()
    eager = spec.monitor(**EAGER, watch=["x >= 3"])
    assert eager.update(0, x=4) == []
    assert eager["x >= 3"] == [VerdictRun(0.0, 1e-9, True, 0.0)]


# ---- requirements with traces of their own ------------------------------------------------------


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_requirement_that_starts_later_and_is_violated_is_not_left_out_at_the_start(backend):
    spec = rtamt.parse("require A: always(x >= 0); require B: always(y >= 0)", backend=backend)
    monitor = spec.monitor(verdict="interval", time="dense")
    monitor.update(0, x=1)
    assert ends(monitor) == (-np.inf, 1)
    monitor.update(1, x=1, y=-1)
    assert ends(monitor) == (-np.inf, -1)
    monitor.finish()
    data = {"x": ([0, 1], [1, 1]), "y": ([1], [-1])}
    assert ends(monitor) == (-1, -1) == (spec.evaluate(data, time="dense").robustness,) * 2


def test_error_in_one_of_several_requirements_leaves_all_as_they_were():
    text = "require A: always[0:1](x >= 0); require B: always[0:1](sqrt(y) >= 0)"
    monitor, other = (rtamt.parse(text).monitor(**SETTINGS | {"ranges": None}) for _ in range(2))
    for each in (monitor, other):
        each.update(0, x=1, y=4)
        each.update(2, x=3)
    with pytest.raises(rtamt.EvaluationError, match=r"sqrt\(y\)"):
        monitor.update(3, x=-5, y=-1)
    for each in (monitor, other):
        each.update(4, x=2, y=9)
    assert changes(monitor) == changes(other)
    assert monitor.finish() == other.finish()


def test_requirements_over_different_variables_keep_no_more_than_their_windows():
    text = (
        "require A: always[0:1](x >= 0); require B: eventually[0:2](y >= 0); require C: once[0:1](x + y >= 0)"
    )
    monitor = rtamt.parse(text).monitor(**SETTINGS | {"ranges": None})
    sizes = []
    for i in range(4000):
        monitor.update(i / 10, **({"x": i % 7 - 3} if i % 2 else {"y": i % 5 - 2}))
        sizes.append(monitor.memory)
    assert max(sizes[2000:]) <= max(sizes[:2000])


@pytest.mark.parametrize("verdict", ["eager", "interval"])
@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_no_value_is_an_error_before_the_traces_of_other_requirements_have_started(backend, verdict):
    spec = rtamt.parse("require A: y > 1; require B: z > z - z", time="dense", backend=backend)
    monitor = spec.monitor(verdict=verdict)
    with pytest.raises(rtamt.EvaluationError, match="'z - z' has no value at time 0 s"):
        monitor.update(0, z=np.inf)
    assert monitor.update(1, z=3, y=2) or verdict == "interval"
    monitor.finish()


@pytest.mark.parametrize("verdict", ["eager", "interval", "causation"])
def test_a_requirement_may_read_the_presence_of_a_variable_alone(verdict):
    text = "input float x\ninput float z\nrequire A: x >= 0\nrequire B: once[0:2](valid(z))"
    reports = []
    for backend in ("cpp", "python"):
        monitor = rtamt.parse(text, time="dense", backend=backend).monitor(verdict=verdict, watch=["B"])
        monitor.update(0, x=1)
        monitor.update(1, z=3, x=2)
        monitor.update(2, z=4 if verdict == "causation" else None)
        reports.append((monitor["B"], monitor.finish(), monitor["B"]))
    assert reports[0] == reports[1]


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_every_requirement_is_read_up_to_the_end_of_the_whole_trace(backend):
    text = "require A: eventually[0:1](sqrt(delay[2](x, 1)) < 1)\nrequire B: y > 0"
    spec = rtamt.parse(text, time=rtamt.Dense("1s"), backend=backend)
    with pytest.raises(rtamt.EvaluationError, match=r"^'sqrt\("):
        spec.evaluate({"x": ([0, 1], [1, -2]), "y": ([0, 2], [1, 1])})
    monitor = spec.monitor(verdict="eager")
    monitor.update(0, x=1, y=1)
    monitor.update(1, x=-2)
    monitor.update(2, y=1)
    with pytest.raises(rtamt.EvaluationError, match=r"^'sqrt\("):  # read a second after the last sample of y
        monitor.finish()


@pytest.mark.parametrize("verdict", ["eager", "interval", "causation"])
@pytest.mark.parametrize("first", [0, -600_000_000.0])
def test_a_trace_from_1970_to_now_is_not_called_a_monitor_in_use(verdict, first):
    monitor = rtamt.parse("always[0:5](x >= 1)").monitor(verdict=verdict, time="dense")
    monitor.update(first, x=1.0)
    for x in (2.0, 2):
        with pytest.raises(rtamt.TraceError) as caught:
            monitor.update(1.7e9, x=x)
        assert str(caught.value) == (
            "the trace spans more than 2^60 ticks of 1 ns, too many for early verdicts, bounds and causation: leave "
            "out samples from before the clock was set, or choose a coarser resolution"
        )
    monitor.update(first + 1, x=2.0)
    coarse = rtamt.parse("always[0:5](x >= 1)").monitor(verdict=verdict, time=rtamt.Dense(resolution="1us"))
    coarse.update(first, x=1.0)
    coarse.update(1.7e9, x=2.0)
