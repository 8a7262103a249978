"""Monitors of eager verdicts: what the laws do not show."""

from __future__ import annotations

import pytest

import rtamt
from rtamt import Verdict
from rtamt.rewrite.semantics import SEMANTICS


def test_each_sample_is_reported_once_and_at_the_first_that_settles_it():
    monitor = rtamt.parse("always[0:9](x >= 3)").monitor(verdict="eager")
    assert monitor.update(0, x=4) == []
    assert monitor.update(1, x=2) == [Verdict(0.0, False, 1.0), Verdict(1.0, False, 1.0)]
    assert monitor.update(2, x=4) == []
    assert monitor.finish() == [Verdict(2.0, True, 2.0)]
    assert monitor.finish() == []


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("semantics", SEMANTICS)
def test_whether_a_formula_holds_is_the_same_under_every_semantics(semantics, backend):
    text = "input float x; output float y; x >= 3 -> eventually[0:2](y >= 1)"
    monitor = rtamt.parse(text, semantics=semantics, backend=backend).monitor(verdict="eager")
    found = [v for k, x in enumerate([5, 4, 3, 2]) for v in monitor.update(k, x=x, y=0)] + monitor.finish()
    assert sorted((v.time, v.satisfied) for v in found) == [(0, False), (1, False), (2, False), (3, True)]


class Stamp(float):
    """A time that is no plain float."""


@pytest.mark.parametrize("given", [-0.0, 0, Stamp(7.5), 7.5, True])
def test_times_are_reported_as_plain_floats_without_the_sign_of_zero(given):
    [verdict] = rtamt.parse("x >= 3").monitor(verdict="eager").update(given, x=4)
    for time in (verdict.time, verdict.decided_at):
        assert (type(time), str(time)) == (float, str(float(given) + 0.0))


def test_what_is_settled_before_it_is_reached_waits():
    monitor = rtamt.parse("once(x >= 3)").monitor(verdict="eager")
    assert monitor.update(0, x=4) == [Verdict(0.0, True, 0.0)]
    assert monitor.update(1, x=0) == [Verdict(1.0, True, 0.0)]


def test_equality_satisfies_at_least_and_not_more_than():
    assert rtamt.parse("x >= 3").monitor(verdict="eager").update(0, x=3) == [Verdict(0.0, True, 0.0)]
    assert rtamt.parse("x > 3").monitor(verdict="eager").update(0, x=3) == [Verdict(0.0, False, 0.0)]


def test_unbounded_always_is_violated_up_to_its_violation():
    monitor = rtamt.parse("always(x >= 3)").monitor(verdict="eager")
    assert monitor.update(0, x=4) == []
    assert monitor.update(1, x=0) == [Verdict(0.0, False, 1.0), Verdict(1.0, False, 1.0)]


def test_watched_formula_has_verdicts_of_its_own():
    monitor = rtamt.parse("always[0:5](x >= 3)").monitor(verdict="eager", watch=["x >= 3"])
    assert monitor.update(0, x=4) == []
    assert monitor["x >= 3"] == [Verdict(0.0, True, 0.0)]


@pytest.mark.parametrize("text", ["once(x >= 1)", "historically(x < 1)", "historically(x < 1) or x > 3"])
def test_verdicts_of_an_unbounded_past_ended_after_sixty_four_samples(text):
    times = [float(t) for t in range(200)]
    monitor = rtamt.parse(text).monitor(verdict="eager")
    assert [[each.time for each in monitor.update(t, x=0.0)] for t in times] == [[t] for t in times]
    dense = rtamt.parse(text, time="dense").monitor(verdict="eager")
    runs = [run for t in times for run in dense.update(t, x=0.0)]
    assert sum(run.end - run.begin for run in runs) == pytest.approx(199.0)
