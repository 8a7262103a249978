"""Changes of bounds in discrete time: the same from both back ends, with times in the caller's form."""

from __future__ import annotations

import pickle
from random import Random

import numpy as np
import pytest

import rtamt
from rtamt.errors import EvaluationError
from tests.laws.early.cases import case
from tests.laws.early.laws import given as values_of

FORMULA = "eventually[0:2] always[0:1](x >= 0)"


def both(spec, **settings):
    return [
        rtamt.parse(spec, backend=backend).monitor(verdict="interval", at="every", **settings)
        for backend in ("cpp", "python")
    ]


@pytest.mark.parametrize("lateness", [0, 3])
def test_both_back_ends_report_the_same_changes_of_random_formulas(lateness):
    compared = 0
    for seed in range(60):
        rng = Random(seed)
        drawn = case(rng, odd=False)
        ranges = {name: limits for name, limits in drawn.ranges.items() if name in drawn.names}
        made = both(str(drawn.formula), ranges=ranges, lateness=lateness)
        order = list(range(drawn.n))
        if lateness:
            order.sort(key=lambda i: i + rng.randint(0, lateness))
        try:
            for i in order:
                row = {name: values_of(known) for name, known in drawn.samples[i].items()}
                for monitor in made:
                    monitor.update(i, **row)
                changes = [monitor.changes() for monitor in made]
                assert changes[0] == changes[1]
                compared += len(changes[0])
        except EvaluationError:
            continue
    assert compared > 60


def test_changes_hold_what_they_declare():
    for monitor in both(FORMULA):
        for t, x in enumerate((1.0, -0.0, 3.0, 4.0)):
            monitor.update(t, x=x)
        settled, *_, newest = monitor.changes()
        assert repr(settled) == (
            "Change(begin=0.0, end=0.0, interval=Interval(lower=3.0, upper=3.0), final=True, retracted=False)"
        )
        assert newest == (3.0, 3.0, rtamt.Interval(float("-inf"), float("inf")), False, False)
        assert hash(newest) == hash(tuple(newest))
        assert pickle.loads(pickle.dumps(newest)) == newest


def test_changes_have_the_times_of_the_caller():
    start = np.datetime64("2026-01-01T00:00:00")
    for monitor in both(FORMULA):
        for i, x in enumerate((1.0, 2.0, 3.0)):
            monitor.update(start + np.timedelta64(i, "s"), x=x)
        assert [(each.begin - start, each.end - start) for each in monitor.changes()] == [
            (np.timedelta64(i, "s"), np.timedelta64(k, "s")) for i, k in ((0, 0), (1, 1), (2, 2))
        ]
