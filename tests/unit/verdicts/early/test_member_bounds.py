"""Bounds before the horizon of quantifiers over members that come and go."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import rtamt
from rtamt import Interval
from rtamt.compiler.graph import Graph
from rtamt.errors import EvaluationError, SpecificationError, TraceError, UsageError

inf = float("inf")
CARS = 'group cars = "car_*"; '


def spec(text, **settings):
    return rtamt.parse(CARS + text, **settings)


def test_an_unbounded_requirement_is_violated_at_the_first_sample_that_decides_it():
    monitor = spec("always forall v in cars: v.x > ego").monitor(verdict="interval")
    assert monitor.at == "start"
    monitor.update(0, ego=0.0, **{"car_1.x": 3.0})
    assert monitor.interval() == Interval(-inf, 3.0)
    monitor.update(1, ego=0.0, **{"car_2.x": -1.0})
    assert monitor.interval() == Interval(-inf, -1.0)
    monitor.update(2, ego=0.0)
    assert monitor.finish() == []
    assert monitor.interval() == Interval(-1.0, -1.0)


def test_a_member_that_is_present_bounds_what_its_future_may_be():
    monitor = spec("forall v in cars: eventually[0:2](v.x > 0)").monitor(verdict="interval")
    monitor.update(0, **{"car_1.x": -4.0})
    assert monitor.interval(0) == Interval(-4.0, inf)
    monitor.update(1, **{"car_1.x": 2.0, "car_2.x": -1.0})
    assert (monitor.interval(0), monitor.interval(1)) == (Interval(2.0, inf), Interval(-1.0, inf))
    monitor.update(2)  # both are gone
    assert [(each.begin, each.interval, each.final) for each in monitor.changes()] == [
        (0, Interval(2.0, 2.0), True),
        (2, Interval(inf, inf), True),
    ]
    assert monitor.interval(1) == Interval(-1.0, inf)  # car_2 may return


def test_what_may_appear_later_is_unknown():
    later = spec("eventually[1:1](count v in cars: v.x > 0) >= 2").monitor(verdict="interval")
    later.update(0, **{"car_1.x": 1.0})
    assert later.interval(0) == Interval(-inf, inf)
    later.update(1, **{"car_1.x": 1.0, "car_2.x": 1.0})
    assert later.interval(0) == Interval(0.0, 0.0)


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_copies_pickles_and_failed_updates(backend):
    text = "always[0:3] forall v in cars: exists w in cars: eventually[0:1](v.x + 1 / w.x > ego)"
    monitor = spec(text, backend=backend).monitor(verdict="interval")
    for t in range(3):
        monitor.update(t, ego=0.0, **{"car_1.x": 1.0 + t, "car_2.x": 2.0})
        twins = [copy.copy(monitor), pickle.loads(pickle.dumps(monitor))]
        with pytest.raises(EvaluationError):
            monitor.update(t + 1, ego=0.0, **{"car_1.x": inf, "car_3.x": -0.0, "car_2.x": -inf})
        with pytest.raises(TraceError):
            monitor.update(t + 1, ego=0.0, **{"car_1.x": float("nan")})
        for twin in twins:
            assert twin.interval(0) == monitor.interval(0)
            assert twin.changes() == monitor.changes()
    for each in (monitor, *twins):
        each.update(3, ego=5.0)
    assert twins[0].finish() == twins[1].finish() == monitor.finish()


def test_a_new_member_compiles_nothing(monkeypatch):
    built = []
    original = Graph.__init__
    monkeypatch.setattr(Graph, "__init__", lambda self, *a, **k: built.append(1) or original(self, *a, **k))
    monitor = spec("forall v in cars: once[0:2](v.x > 0)").monitor(verdict="interval")
    before = len(built)
    assert before > 0
    for t in range(20):
        monitor.update(t, **{f"car_{t}.x": 1.0})
    assert len(built) == before
    assert len(monitor.members) < 6


def test_watched_requirements_have_bounds_and_dates_are_kept():
    parsed = spec("require R1: always[0:1] forall v in cars: v.x > 0\nrequire R2: ego > 0")
    monitor = parsed.monitor(verdict="interval", watch=["R1", "R2"])
    at = np.datetime64("2026-01-01T12:00:00")
    monitor.update(at, ego=2.0, **{"car_1.x": 3.0})
    assert [each.interval for each in monitor["R1"]] == [Interval(-inf, 3.0)]
    assert [(each.begin, each.interval) for each in monitor["R2"]] == [(at, Interval(2.0, 2.0))]


def test_an_unbounded_operator_inside_a_quantifier_is_one_sentence():
    with pytest.raises(
        SpecificationError,
        match=r"'eventually' without an upper bound needs the whole future of each member and cannot be monitored "
        r"online; .*, or name the members, which must be present throughout: spec.over\({'cars': \[\.\.\.\]}\)",
    ):
        spec("always forall v in cars: eventually(v.x > 0)").monitor(verdict="interval")


def test_what_bounds_of_members_do_not_have_is_rejected_with_all_groups_to_name():
    parsed = rtamt.parse("""
        group cars = "car_*"
        group bats = "bat_*"
        forall v in cars: forall w in bats: v.x > w.x""")
    with pytest.raises(UsageError, match=r"no ranges=; .*spec\.over\({'bats': \[...\], 'cars': \[...\]}\)"):
        parsed.monitor(verdict="interval", ranges={"car_1.x": (0, 1)})
