"""Monitors of causation in dense time: what the laws do not show."""

from __future__ import annotations

import copy
import pickle
from datetime import datetime, timedelta
from math import inf

import pytest

import rtamt
from rtamt import Causation, CausationRun, Dense

BACKENDS = pytest.mark.parametrize("backend", ["cpp", "python"])
SECONDS = Dense("1s")
NOTHING = Causation(inf, -inf)


def opened(formula, backend="cpp", **settings):
    return rtamt.parse(formula, backend=backend).monitor(verdict="causation", **{"time": SECONDS, **settings})


@BACKENDS
def test_sample_causes_what_its_variable_has_held_before_it(backend):
    monitor = opened("always[0:2](x >= 3)", backend)
    assert monitor.update(0, x=1) == Causation(-2, -inf)
    # At seconds 1 to 3 the robustness of the predicate is -2, and at second 4 it is 2.
    assert monitor.update(4, x=5) == Causation(-2, -2)
    assert monitor.runs() == [
        CausationRun(0, 3, -2, -2),
        CausationRun(3, 4, -2, -inf),
        CausationRun(4, 5, 2, -inf),
    ]


@BACKENDS
def test_watermark_and_end_cause_what_variables_hold(backend):
    monitor = opened("always[0:2](x >= 3)", backend)
    monitor.update(0, x=4)
    assert monitor.watermark(1) == Causation(1, -inf)
    assert monitor.finish() == Causation(1, 1)
    assert monitor.runs() == [CausationRun(0, 1, 1, 1)]
    assert monitor.finish() == NOTHING
    assert monitor.causation() == Causation(1, 1)


@BACKENDS
def test_variable_that_comes_later_causes_the_predicate_over_both(backend):
    monitor = opened("always[0:2](x >= y and x <= 9)", backend)
    assert monitor.update(0, x=4) == NOTHING
    assert monitor.runs() == []
    assert monitor.update(0, y=1) == Causation(3, -inf)
    assert monitor.update(5, x=4) == Causation(5, -inf)  # x <= 9 alone
    assert monitor.update(5, y=1) == Causation(3, 3)


@BACKENDS
def test_runs_that_read_the_past_never_end(backend):
    monitor = opened("once(x >= 3)", backend, watch=["historically(x >= 3)"])
    monitor.update(2, x=5)
    assert monitor.runs() == [CausationRun(2, 3, 2, 2), CausationRun(3, None, inf, 2)]
    assert monitor["historically(x >= 3)"] == Causation(2, 2)
    assert monitor.causation(100) == Causation(inf, 2)


@BACKENDS
@pytest.mark.parametrize("twin", [copy.copy, lambda monitor: pickle.loads(pickle.dumps(monitor))])
def test_copy_goes_its_own_way(twin, backend):
    monitor = opened("x >= 0 until[0:3] y >= 3", backend)
    for name, value in (("x", 1), ("y", 1)):
        monitor.update(0, **{name: value})
    monitor.update(2, x=1)
    other = twin(monitor)
    assert (other.causation(), other.runs()) == (monitor.causation(), monitor.runs())
    assert other.update(2, y=5) == Causation(1, 1)
    assert monitor.update(2, y=1) == Causation(1, -2)


@BACKENDS
@pytest.mark.parametrize(
    "wrong", [(0, {"x": 4}), (1, {"x": (4, 5)}), (1, {"x": None}), (1, {"y": 1}), (1, {"x": -1})]
)
def test_wrong_sample_leaves_the_monitor_as_it_was(wrong, backend):
    monitor = opened("always(once(sqrt(x) >= 1))", backend)
    before = monitor.update(0, x=4)
    with pytest.raises((rtamt.TraceError, rtamt.EvaluationError)):
        monitor.update(wrong[0], **wrong[1])
    assert (monitor.samples, monitor.causation()) == (1, before)
    assert monitor.update(1, x=9) == Causation(2, 1)


@BACKENDS
def test_sample_at_or_before_the_watermark_is_rejected(backend):
    monitor = opened("x >= 3", backend)
    monitor.update(0, x=4)
    monitor.watermark(5)
    with pytest.raises(rtamt.TraceError, match=r"everything up to .*5.* is final; leave it out"):
        monitor.update(5, x=4)
    assert monitor.update(6, x=4) == NOTHING


@BACKENDS
def test_times_are_reported_as_they_were_given(backend):
    noon = datetime(2026, 1, 1, 12)
    monitor = opened("eventually[0:1](x >= 3)", backend, time="dense")
    monitor.update(noon, x=4)
    monitor.update(noon + timedelta(seconds=2), x=4)
    assert str(monitor.runs()[0].begin) == "2026-01-01T12:00:00.000000000"


@BACKENDS
def test_requirements_start_with_their_own_variables(backend):
    monitor = opened("require A: x >= 3\nrequire B: y >= 3", backend)
    assert monitor.update(0, x=5) == NOTHING
    assert monitor.update(4, y=4) == Causation(1, 1)  # of A at 0 s, of B at 4 s
    assert monitor.causation(0) == Causation(2, 2)  # where there is A alone
    assert monitor.causation(4) == Causation(1, -inf)  # B, while A is not known
    monitor.update(5, x=5)
    assert monitor.causation(4) == Causation(2, 1)


@pytest.mark.parametrize(
    "formula",
    [
        "(x >= 0 until[0:5] y >= 3) or historically[0:4](x <= 5)",
        "not (x >= 0 and y >= 3)",  # at one instant, whose parts are pruned like all others
        "always[0:3](x >= 0 -> y >= 3)",
    ],
)
def test_many_samples_keep_little_memory_and_the_identity(formula):
    monitor, bounds = (
        rtamt.parse(formula).monitor(verdict=verdict, time=SECONDS) for verdict in ("causation", "interval")
    )
    upper: dict[int, float] = {}
    before = 0
    for t in range(0, 3000, 3):
        row = {"x": (t * 7) % 11 - 2, "y": (t * 5) % 13 - 6}
        monitor.update(t, **row)
        bounds.update(t, **row)
        for run in monitor.runs():
            for k in range(int(run.begin), int(run.end)):
                upper[k] = min(upper.get(k, inf), run.violation)
        for k in range(max(0, t - 5), t + 1):
            assert upper[k] == bounds.interval(k).upper
        before = monitor.memory if t == 1500 else before
    assert monitor.memory <= before + 2**12


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_requirements_over_different_variables_caused_nothing_behind_the_end(backend):
    spec = rtamt.parse("require A: z >= 1\nrequire B: x >= 2", time=rtamt.Dense("1ms"), backend=backend)
    monitor = spec.monitor(verdict="causation", time_unit="ms")
    for t in (1, 2):
        monitor.update(t, z=-1.0, x=1.5)
    monitor.finish()
    assert monitor.causation(3) == rtamt.Causation(-2.0, -2.0)
