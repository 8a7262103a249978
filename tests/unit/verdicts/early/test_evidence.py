"""Which samples decided an eager verdict: enough of them, and none too many, in both time domains."""

from __future__ import annotations

import copy
import pickle
from datetime import datetime, timedelta
from random import Random

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt import Cause
from rtamt.errors import EvaluationError
from rtamt.language.printing.printer import to_text
from tests.laws.early.cases import case, dense_case
from tests.laws.early.laws import given as values_of

BACKENDS = ("cpp", "python")


def replay(spec, updates, causes, verdict, **declared):
    """Return the verdicts of a monitor that is given nothing but the causes, up to the verdict and its report."""
    kept = {(cause.time, cause.variable) for cause in causes}
    monitor = spec.monitor(verdict="eager", **declared)
    found = []
    for t, row in updates:
        found += monitor.update(
            t, **{name: value if (t, name) in kept else None for name, value in row.items()}
        )
    return [each for each in found if each.satisfied == verdict.satisfied]


def settings_of(drawn):
    ranges = {name: limits for name, limits in drawn.ranges.items() if name in drawn.names}
    return {"ranges": ranges} if ranges else {}


@settings(max_examples=25)
@given(seed=st.integers(0, 2**32), backend=st.sampled_from(BACKENDS))
def test_causes_decide_the_verdict_alone_and_none_can_be_left_out(seed, backend):
    rng = Random(seed)
    drawn = case(rng, odd=False)
    spec = rtamt.parse(to_text(drawn.formula), period=1, backend=backend)
    assume(spec.input_names == drawn.names)
    declared = settings_of(drawn)
    updates = [
        (i, {name: values_of(known) for name, known in row.items()}) for i, row in enumerate(drawn.samples)
    ]
    monitor = spec.monitor(verdict="eager", explain=True, **declared)
    try:
        for i, (t, row) in enumerate(updates):
            for verdict in monitor.update(t, **row)[:2]:
                causes = monitor.explain(verdict)
                came = updates[: i + 1]
                assert all(cause.value == dict(came)[cause.time][cause.variable] for cause in causes)
                assert all(cause.time <= verdict.decided_at for cause in causes)
                told = replay(spec, came, causes, verdict, **declared)
                assert verdict.time in [each.time for each in told]
                assert not causes or max(cause.time for cause in causes) == verdict.decided_at
                for k in range(len(causes)):
                    fewer = causes[:k] + causes[k + 1 :]
                    told = replay(spec, came, fewer, verdict, **declared)
                    assert verdict.time not in [each.time for each in told]
    except EvaluationError:
        assume(False)


@settings(max_examples=25)
@given(seed=st.integers(0, 2**32), backend=st.sampled_from(BACKENDS))
def test_causes_in_dense_time_decide_the_run_alone(seed, backend):
    rng = Random(seed)
    drawn = dense_case(rng, odd=False)
    spec = rtamt.parse(to_text(drawn.formula), time="dense", resolution=1, backend=backend)
    assume(spec.input_names == drawn.names)
    declared = settings_of(drawn)
    updates = [(t, {name: values_of(known) for name, known in row.items()}) for t, row in drawn.updates]
    monitor = spec.monitor(verdict="eager", explain=True, **declared)
    try:
        for i, (t, row) in enumerate(updates):
            for verdict in monitor.update(t, **row)[:1]:
                causes = monitor.explain(verdict)
                told = replay(spec, updates[: i + 1], causes, verdict, **declared)
                decided = {k for each in told for k in range(int(each.begin), int(each.end))}
                assert decided >= set(range(int(verdict.begin), int(verdict.end)))
    except EvaluationError:
        assume(False)


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_request_and_the_missing_grants_decide_a_violation(backend):
    spec = rtamt.parse("always(req >= 3 -> eventually[0:2](gnt >= 3))", backend=backend)
    monitor = spec.monitor(verdict="eager", explain=True)
    found = []
    for t, (req, gnt) in enumerate([(0, 0), (5, 1), (4, 0), (0, 2), (0, 0)]):
        found += monitor.update(t, req=req, gnt=gnt)
    first = found[0]
    assert (first.time, first.satisfied, first.decided_at) == (0, False, 3)
    assert monitor.explain(first) == [
        Cause("req", 1, 5),
        Cause("gnt", 1, 1),
        Cause("gnt", 2, 0),
        Cause("gnt", 3, 2),
    ]


def test_a_copied_and_a_pickled_monitor_explain_on_their_own():
    spec = rtamt.parse("once[0:3](x >= 3)")
    monitor = spec.monitor(verdict="eager", explain=True)
    monitor.update(0, x=5)
    twins = [copy.copy(monitor), pickle.loads(pickle.dumps(monitor))]
    for k, each in enumerate([*twins, monitor]):
        (verdict,) = each.update(1, x=k)
        assert each.explain(verdict) == [Cause("x", 0, 5)]


def test_causes_have_the_times_of_the_samples():
    monitor = rtamt.parse("historically(x >= 3)").monitor(verdict="eager", explain=True)
    start = datetime(2024, 5, 1, 12)
    for k, x in enumerate([4, 2, 5]):
        found = monitor.update(start + timedelta(seconds=k), x=x)
    assert monitor.explain(found[0]) == [Cause("x", start + timedelta(seconds=1), 2)]
    assert found[0].decided_at == np.datetime64(start + timedelta(seconds=1))


def test_what_is_not_remembered_is_reported_with_one_sentence():
    monitor = rtamt.parse("x >= 3").monitor(verdict="eager")
    (verdict,) = monitor.update(0, x=5)
    with pytest.raises(rtamt.UsageError) as error:
        monitor.explain(verdict)
    assert str(error.value) == (
        "the monitor does not remember its samples; make it with monitor(verdict='eager', explain=True)"
    )
    monitor = rtamt.parse("x >= 3").monitor(verdict="eager", explain=True)
    (verdict,) = monitor.update(0, x=5)
    for t in range(1, 200):
        monitor.update(t, x=4)
    with pytest.raises(rtamt.UsageError) as error:
        monitor.explain(verdict)
    assert str(error.value) == (
        "the samples that decided Verdict(time=0.0, satisfied=True, decided_at=0.0) are not remembered any more, or "
        "it is not of this monitor"
    )
    with pytest.raises(rtamt.UsageError) as error:
        rtamt.parse("x >= 3").monitor(explain=True)
    assert str(error.value) == "explain= belongs to verdict='eager', and this is verdict='delayed'"


@pytest.mark.parametrize(
    ("text", "rows", "causes"),
    [
        ("always[0:9](maximum[0:2](x) <= 3)", [{"x": 1}, {"x": 5}], [("x", 1)]),
        (
            "always[0:9]((if y > 0 then x else delay(x)) <= 3)",
            [{"x": 1, "y": 1}, {"x": 5, "y": 0}, {"x": 1, "y": 0}],
            [("x", 1), ("y", 2)],
        ),
        ("always[2:9](held(x, y > 0) <= 3)", [{"x": 5, "y": 1}, {"x": 1, "y": 0}, {"x": 1, "y": 0}],
         [("x", 0), ("y", 1), ("y", 2)]),  # whether y > 0 at 0 or not: x then
        ("atleast[0:4](60%, x > 3)", [{"x": x} for x in (1, 5, 4, 0, 9)], [("x", 1), ("x", 2), ("x", 4)]),
        ("always[0:9](count[0:3](x > 0) <= 1)", [{"x": x} for x in (1, 0, 1)], [("x", 0), ("x", 1), ("x", 2)]),
    ],
)  # fmt: skip
def test_numbers_over_time_rest_on_the_samples_that_they_read(text, rows, causes):
    monitor = rtamt.parse(text, period=1).monitor(verdict="eager", explain=True)
    found = [verdict for t, row in enumerate(rows) for verdict in monitor.update(t, **row)]
    assert [(cause.variable, cause.time) for cause in monitor.explain(found[0])] == causes
