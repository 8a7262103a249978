"""Copies have the last reports, failed calls change nothing, and the end reports what was open."""

from __future__ import annotations

import copy
import pickle

import pytest

import rtamt


def _pickle_round_trip(monitor):
    return pickle.loads(pickle.dumps(monitor))


backends = pytest.mark.parametrize("backend", ["cpp", "python"])
times = pytest.mark.parametrize("time", ["discrete", "dense"])
twins = pytest.mark.parametrize("twin", [copy.copy, _pickle_round_trip])


def monitor_of(text, time, backend, **settings):
    return rtamt.parse(text, time=time, backend=backend).monitor(**settings)


@twins
@times
@backends
def test_a_copy_reports_the_changes_of_the_last_update(backend, time, twin):
    text = "require A: eventually[0:1](x >= 3)\nrequire B: x >= 1"
    monitor = monitor_of(text, time, backend, verdict="interval", watch=["A", "B"])
    for t, x in enumerate([(4, 5), 1, (0, 2)]):
        monitor.update(t, x=x)
    other = twin(monitor)
    assert monitor.changes()
    assert other.changes() == monitor.changes()
    assert [other[name] for name in ("A", "B")] == [monitor[name] for name in ("A", "B")]


@twins
@times
@backends
def test_a_copy_has_the_verdicts_of_watched_formulas_that_the_last_update_settled(backend, time, twin):
    text = "require A: eventually[0:9](x >= 3)\nrequire B: x >= 1"
    monitor = monitor_of(text, time, backend, verdict="eager", watch=["A", "B"])
    monitor.update(0, x=2)
    assert monitor["B"]
    assert [twin(monitor)[name] for name in ("A", "B")] == [monitor[name] for name in ("A", "B")]


@times
@backends
@pytest.mark.parametrize("samples", [3, 200])
def test_the_end_reports_only_bounds_that_could_still_change(samples, time, backend):
    monitor = monitor_of("eventually[0:2](x >= 3)", time, backend, verdict="interval")
    for t in range(samples):
        monitor.update(t, x=(1, 2))
    newest = samples - 1
    changes = monitor.finish()
    assert all(change.final and change.interval == rtamt.Interval(-2.0, -1.0) for change in changes)
    if time == "discrete":
        assert [change.begin for change in changes] == [newest - 1, newest]
    else:
        assert (changes[0].begin, changes[-1].end) == (newest - 2 + 1e-9, newest + 1e-9)


@backends
def test_the_end_keeps_what_the_newest_sample_caused(backend):
    monitor = monitor_of("once[0:2](x >= 3)", "discrete", backend, verdict="causation")
    monitor.update(0, x=5)
    monitor.update(1, x=1)
    before = [monitor.causation(t) for t in range(2)]
    monitor.finish()
    assert [monitor.causation(t) for t in range(2)] == before
    assert monitor.runs() == [rtamt.CausationRun(1.0, 1.0, 2.0, -2.0)]


@backends
def test_bounds_at_the_start_of_an_empty_trace_are_those_of_the_ranges(backend):
    monitor = monitor_of("x >= 3", "discrete", backend, verdict="interval", ranges={"x": (1, 4)})
    assert monitor.finish() == []
    assert monitor.interval() == rtamt.Interval(-2.0, 1.0)


@backends
def test_what_is_final_is_kept_for_one_sample_in_both_back_ends(backend):
    monitor = monitor_of("eventually[0:1](x >= 3)", "discrete", backend, verdict="interval")
    for t in range(4):
        monitor.update(t, x=t)
    assert monitor.interval(2) == rtamt.Interval(0.0, 0.0)
    with pytest.raises(rtamt.UsageError) as error:
        monitor.interval(1)
    assert str(error.value) == (
        "the bounds at 1 s are final and no longer kept; read them from changes() when they are"
    )


@backends
def test_a_watermark_that_leaves_a_value_undefined_is_rejected(backend):
    monitor = monitor_of("sqrt(x) >= 1", "discrete", backend, verdict="interval", lateness=3)
    for t, x in enumerate([4, (-2, -1), 9]):  # the second may still be made more precise
        monitor.update(t, x=x)
    for _ in range(2):  # no sample is lost
        with pytest.raises(rtamt.EvaluationError) as error:
            monitor.watermark(1)
        assert str(error.value).startswith("'sqrt(x)' has no value at sample 1, time 1 s: ")


def _told(monitor):
    return monitor.interval(), monitor.changes(), [monitor.interval(t) for t in range(3)], monitor.samples


@backends
@pytest.mark.parametrize("end", [lambda each: each.watermark(2), lambda each: each.finish()])
def test_a_failing_watermark_or_end_fills_no_missing_sample_in(end, backend):
    text = "input float x\ninput float y\n(valid(x) -> y >= 1) and sqrt(y) >= 1"
    monitor = monitor_of(text, "discrete", backend, verdict="interval", lateness=3)
    for t, y in enumerate([4, 2, (-2, -1), 1, 1]):
        monitor.update(t, y=y)  # of x it is open whether it comes
    before = _told(monitor)
    for _ in range(2):
        with pytest.raises(rtamt.EvaluationError, match=r"^'sqrt\(y\)' has no value at sample 2, time 2 s: "):
            end(monitor)
        assert _told(monitor) == before
    monitor.update(1, x=1)  # it may still come
    assert monitor.interval(1) == rtamt.Interval(2**0.5 - 1, 2**0.5 - 1)


@backends
def test_a_failing_watermark_does_not_start_the_trace(backend):
    monitor = monitor_of("sqrt(x) >= 1", "discrete", backend, verdict="interval", lateness=3)
    monitor.update(1, x=(-2, -1))
    for _ in range(2):
        with pytest.raises(rtamt.EvaluationError, match=r"^'sqrt\(x\)' has no value at sample 0, time 1 s: "):
            monitor.watermark(1)
        assert monitor.samples == 0
    monitor.update(0, x=4)
    monitor.watermark(0)
    assert monitor.interval(0) == rtamt.Interval(1.0, 1.0)


@backends
def test_what_precedes_a_trace_keeps_no_other_requirement_open(backend):
    text = "require A: always[0:0.002](z >= 0)\nrequire B: z < y\nrequire C: x <= 0.5"
    monitor = monitor_of(text, rtamt.Dense("1ms"), backend, verdict="interval")
    for t, x in [(0, (-3.5, -3)), (0.002, -1), (0.004, 4)]:
        monitor.update(t, x=x)
    monitor.update(0.001, y=1)
    monitor.update(0.004, z=1)  # A and B start here, whatever y may be before
    first = monitor.changes()[0]
    assert (first.begin, first.end, first.final) == (0.0, 0.002, True)


@times
@backends
@pytest.mark.parametrize(
    "formula", ["min(sqrt(x), y) >= 1", "eventually[0:1](sqrt(delay[1](x, 0)) + y >= 1)"]
)
def test_bounds_do_not_widen_where_an_operation_will_have_no_value(formula, time, backend):
    ranges = {"x": (-1, 4), "y": (0, 9)}
    monitor = monitor_of(formula, time, backend, verdict="interval", ranges=ranges, lateness=3)
    for t, sample in [(0, {"x": 1, "y": 1}), (1, {"y": 2}), (4, {"x": 1, "y": 1})]:
        monitor.update(t, **sample)
    assert monitor.interval(2) == rtamt.Interval(-1.0, 1.0 if "min" in formula else 10.0)
    before = [monitor.interval(t) for t in (1, 2, 3)]
    monitor.update(2, x=(-1, -0.5))  # an error once nothing better can come
    assert [monitor.interval(t) for t in (1, 2, 3)] == before
    with pytest.raises(rtamt.EvaluationError):
        monitor.watermark(3)
    assert [monitor.interval(t) for t in (1, 2, 3)] == before


@twins
@backends
def test_first_samples_are_reported_with_their_times_whatever_is_kept(backend, twin):
    monitor = monitor_of("x >= 0", "discrete", backend, verdict="interval", lateness=70)
    times = [t + 0.01 * (t % 3) for t in range(60)]
    for t, time in enumerate([*times, 120.0]):  # after which the first 49 are final
        monitor.update(time, x=t)
    for each in (monitor, twin(monitor)):
        assert [change.begin for change in each.changes()][:60] == times
