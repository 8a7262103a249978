"""Seconds since 1970 as doubles, which are further apart than ticks of dense time: reports are runs of such times."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import rtamt

START = 1_700_000_000.1
TIMES = [START + 0.1 * k for k in range(4)]
VALUES = [1.0, 2.0, -3.0, 2.0]

backends = pytest.mark.parametrize("backend", ["cpp", "python"])


def after(time):
    return float(np.nextafter(time, np.inf))


def monitor_of(text, backend, **settings):
    return rtamt.parse(text, time="dense", backend=backend).monitor(**settings)


@backends
def test_changes_of_bounds_are_runs_of_different_times_that_hold_what_they_report(backend):
    monitor = monitor_of("x >= 0", backend, verdict="interval")
    for k, (t, x) in enumerate(zip(TIMES, VALUES, strict=True)):
        monitor.update(t, x=x)
        changes = monitor.changes()
        assert [(each.begin, each.end) for each in changes[-1:]] == [(t, after(t))]
        if k:
            assert [(each.begin, each.end) for each in changes[:-1]] == [(after(TIMES[k - 1]), t)]
        for each in changes:
            assert monitor.interval(each.begin) == each.interval


@backends
def test_verdicts_cover_every_time_once(backend):
    monitor = monitor_of("x >= 0", backend, verdict="eager")
    runs = [run for t, x in zip(TIMES, VALUES, strict=True) for run in monitor.update(t, x=x)]
    runs += monitor.finish()
    assert (runs[0].begin, runs[-1].end) == (TIMES[0], after(TIMES[-1]))
    assert all(before.end == run.begin < run.end for before, run in pairwise(runs))
    held = [run.satisfied for t in TIMES for run in runs if run.begin <= t < run.end]
    assert held == [True, True, False, True]
    assert {run.decided_at for run in runs} == set(TIMES)


@backends
def test_causation_has_runs_of_different_times(backend):
    monitor = monitor_of("x >= 0", backend, verdict="causation")
    for t, x in zip(TIMES[:2], VALUES, strict=False):
        monitor.update(t, x=x)
    first, second = TIMES[:2]
    found = [(run.begin, run.end) for run in monitor.runs()]
    assert found == [(after(first), second), (second, after(second))]


@backends
def test_a_pulse_of_one_tick_is_at_the_time_of_its_sample_alone(backend):
    expected = [(TIMES[0], -1.0), (TIMES[1], 1.0), (after(TIMES[1]), -1.0), (TIMES[2], -1.0)]
    values = [-1.0, 1.0, 2.0]
    spec = rtamt.parse("rise(x >= 0)", time="dense", backend=backend)
    assert spec.evaluate({"x": (TIMES[:3], values)}).signal.points() == expected
    monitor = spec.monitor()
    points = [p for t, x in zip(TIMES, values, strict=False) for p in monitor.update(t, x=x).points()]
    assert points + monitor.finish().points() == expected


@backends
def test_runs_within_which_there_is_no_time_are_left_out(backend):
    text = "eventually[0:1ns](x >= 0)"
    bounds = monitor_of(text, backend, verdict="interval")
    verdicts = monitor_of(text, backend, verdict="eager")
    runs = []
    for t, x in zip(TIMES, VALUES, strict=True):
        bounds.update(t, x=x)
        assert all(each.begin < each.end for each in bounds.changes())
        runs += verdicts.update(t, x=x)
    runs += verdicts.finish()
    assert all(before.end == run.begin < run.end for before, run in pairwise(runs))


def test_times_that_are_their_own_ticks_are_returned_as_they_were_given():
    spec = rtamt.parse("x >= 0", time="dense")
    rng = np.random.default_rng(3)
    for digits in (1, 3, 6, 9):
        times = np.unique(np.round(1.7e9 + np.sort(rng.uniform(0, 100, size=500)), digits))
        result = spec.evaluate({"x": (times, rng.normal(size=len(times)))})
        assert result.signal.times.tolist() == times.tolist()
