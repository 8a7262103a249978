"""The minimisation of sufficient causes."""

from __future__ import annotations

import numpy as np

import rtamt
from rtamt.explain.intervals import Groups
from rtamt.signals.instants import Cells


def test_shares_of_long_traces_in_dense_time_are_explained_without_work_for_each_interval(monkeypatch):
    """At 10^6 samples a share that is nowhere reached took minutes: each of its intervals was looked up by itself."""
    samples = 2000
    values = np.random.default_rng(1).normal(size=samples)
    result = rtamt.parse("eventually(atleast[0:10](90%, a >= 1))").evaluate(
        {"a": (np.arange(samples), values)}, time="dense"
    )
    assert result.satisfied is False
    intersections = []
    intersect = Cells.__and__
    monkeypatch.setattr(Cells, "__and__", lambda one, other: intersections.append(1) or intersect(one, other))
    assert result.explain().satisfied is False
    assert len(intersections) < 60


def test_groups_are_split_and_numbered():
    groups = Groups(np.array([0, 5]), np.array([5, 6])).split(2)
    assert groups.first.tolist() == [0, 2, 4, 5]
    assert groups.stop.tolist() == [2, 4, 5, 6]
    assert groups.group_of().tolist() == [0, 0, 1, 1, 2, 3]
    assert groups.largest(np.array([3, 1, 4, 1, 5, 9])).tolist() == [3, 4, 5, 9]
    left = groups.take(np.array([False, True, False, True]))
    assert left.members().tolist() == [2, 3, 5]
    assert len(Groups.none().members()) == 0
