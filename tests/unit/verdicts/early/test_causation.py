"""Monitors of causation: what the laws do not show."""

from __future__ import annotations

import copy
import pickle
from math import inf
from time import process_time

import pytest

import rtamt
from rtamt import Causation, CausationRun

BACKENDS = pytest.mark.parametrize("backend", ["cpp", "python"])
RESPONSE = "always(req >= 3 -> eventually[0:2](gnt >= 3))"


@BACKENDS
def test_each_violation_is_caused_by_the_sample_that_makes_it_certain(backend):
    monitor = rtamt.parse(RESPONSE, backend=backend).monitor(verdict="causation")
    samples = [(5, 0), (0, 0), (0, 1), (7, 0), (0, 0), (0, 3)]
    found = [monitor.update(t, req=req, gnt=gnt).violation for t, (req, gnt) in enumerate(samples)]
    # The request at 0 is not granted by 2, and the one at 3 just so at 5. Between them are ends of windows without a
    # request, which is 3 below its threshold there.
    assert found == [inf, inf, -2, 3, 3, 0]


@BACKENDS
@pytest.mark.parametrize(
    ("formula", "violations"),
    [
        ("always[0:1](ahead[2](x) >= 3)", [inf, inf, 1, -2, inf]),  # x at 2 s and at 3 s
        ("always[0:2](sum[0:1](x) <= 9)", [4, -1, 0, inf, inf]),  # the sums 5, 10 and 9
        ("eventually[1:1](held(x, x > 4) >= 6)", [inf, -1, inf, inf, inf]),
    ],
)
def test_predicate_over_several_samples_has_causation_where_its_bounds_change(formula, violations, backend):
    monitor = rtamt.parse(formula, backend=backend).monitor(verdict="causation")
    assert [monitor.update(t, x=x).violation for t, x in enumerate([5, 5, 4, 1, 9])] == violations


@BACKENDS
def test_formula_of_bounded_future_has_causation_at_every_sample(backend):
    monitor = rtamt.parse("always[0:1](x >= 3)", backend=backend).monitor(verdict="causation")
    for t, x in enumerate([4, 1, 2]):
        newest = monitor.update(t, x=x)
    assert newest == monitor.causation() == monitor.causation(0) == Causation(inf, -inf)
    assert monitor.causation(1) == Causation(-1, -2)
    assert monitor.causation(2) == Causation(-1, -inf)


@BACKENDS
def test_runs_of_a_formula_that_reads_the_past_go_on_beyond_the_newest_sample(backend):
    spec = rtamt.parse("once(x >= 3)", backend=backend)
    monitor = spec.monitor(verdict="causation", time_unit="ms", period="10ms")
    assert monitor.runs() == []
    monitor.update(100, x=4)
    monitor.update(110, x=5)
    assert monitor.runs() == [CausationRun(110, 110, 2, 2), CausationRun(120, None, inf, 2)]
    monitor.finish()
    assert monitor.runs() == [CausationRun(110, 110, 2, 2)]


@BACKENDS
@pytest.mark.parametrize("twin", [copy.copy, lambda monitor: pickle.loads(pickle.dumps(monitor))])
def test_copy_goes_its_own_way(twin, backend):
    monitor = rtamt.parse(RESPONSE, backend=backend).monitor(verdict="causation")
    monitor.update(0, req=5, gnt=0)
    first = monitor.update(1, req=4, gnt=2)
    other = twin(monitor)
    assert other.causation() == first
    assert other.update(2, req=0, gnt=2) == Causation(-1, -inf)
    assert monitor.update(2, req=0, gnt=9) == Causation(6, -inf)


@BACKENDS
def test_watched_formula_has_causation_at_the_start(backend):
    monitor = rtamt.parse("always(x >= 3)", backend=backend).monitor(
        verdict="causation", watch=["eventually[0:1](x >= 3)"]
    )
    monitor.update(0, x=1)
    assert monitor["eventually[0:1](x >= 3)"] == Causation(inf, -2)
    monitor.update(1, x=5)
    assert monitor["eventually[0:1](x >= 3)"] == Causation(2, 2)


@BACKENDS
@pytest.mark.parametrize("wrong", [{"x": (4, 5)}, {"x": None}, {"x": "1"}, {"y": 1}, {}])
def test_uncertain_or_wrong_sample_leaves_the_monitor_as_it_was(wrong, backend):
    monitor = rtamt.parse("always(x >= 3)", backend=backend).monitor(verdict="causation")
    before = monitor.update(0, x=1)
    with pytest.raises(rtamt.TraceError):
        monitor.update(1, **wrong)
    assert (monitor.samples, monitor.causation()) == (1, before)
    assert monitor.update(1, x=4) == Causation(1, -inf)


@BACKENDS
def test_sample_without_a_value_leaves_the_monitor_as_it_was(backend):
    monitor = rtamt.parse("always(once(sqrt(x) >= 1))", backend=backend).monitor(verdict="causation")
    before = monitor.update(0, x=4)
    with pytest.raises(rtamt.EvaluationError):
        monitor.update(1, x=-4)
    assert (monitor.samples, monitor.causation()) == (1, before)


def test_finished_monitor_takes_samples_again_after_a_reset():
    monitor = rtamt.parse("always(x >= 3)").monitor(verdict="causation")
    monitor.update(0, x=1)
    monitor.finish()
    with pytest.raises(rtamt.UsageError, match="has finished"):
        monitor.update(1, x=1)
    monitor.reset()
    assert monitor.update(0, x=5) == Causation(2, -inf)


def test_times_are_taken_in_any_unit():
    monitor = rtamt.parse("always[0:1ms](x >= 3)", period="1ms").monitor(verdict="causation", time_unit="us")
    monitor.update(0, x=5)
    assert monitor.update(1000, x=4) == Causation(1, 1) == monitor.causation(0)


def test_many_samples_keep_little_memory():
    monitor = rtamt.parse(RESPONSE).monitor(verdict="causation")
    for t in range(1000):
        monitor.update(t, req=t % 7, gnt=t % 5)
    before = monitor.memory
    for t in range(1000, 5000):
        monitor.update(t, req=t % 7, gnt=t % 5)
    assert monitor.memory <= before + 2**12


@BACKENDS
def test_a_sample_causes_what_it_settles_by_windows_below_a_duration_later_on(backend):
    spec = rtamt.parse("duration[1:4](historically[1:4](x > 0)) > 1", backend=backend)
    monitor = spec.monitor(verdict="causation")
    monitor.update(0, x=-1)
    assert [monitor.causation(t).violation for t in range(7)] == [inf, inf, 0, 0, 0, -1, 0]


@pytest.mark.parametrize("time", ["discrete", rtamt.Dense("1s")])
def test_until_reads_hold_before_its_bound_after_many_samples(time):
    spec = rtamt.parse("x >= 0 until[5:6] y >= 0")
    monitor, bounds = (spec.monitor(verdict=verdict, time=time) for verdict in ("causation", "interval"))
    for t in range(200):
        row = {"x": (t * 7) % 11 - 2, "y": (t * 5) % 13 - 6}
        monitor.update(t, **row)
        bounds.update(t, **row)
        for k in range(max(0, t - 5), t + 1):
            assert monitor.causation(k).satisfaction <= bounds.interval(k).lower
            assert monitor.causation(k).violation >= bounds.interval(k).upper


def test_cost_under_until_follows_the_runs_of_the_result_and_not_the_bound():
    def cost(bound):
        monitor = rtamt.parse(f"eventually[0:{bound}](x > 9) until[0:{bound}] y > 9").monitor(
            verdict="causation"
        )
        rows = [((t * 37) % 101 / 10, 10.0 if t % 13 == 0 else t / 1e6) for t in range(2 * bound + 1000)]
        for t, (x, y) in enumerate(rows[:-400]):
            monitor.update(t, x=x, y=y)
        begin = process_time()
        for t, (x, y) in enumerate(rows[-400:], len(rows) - 400):
            monitor.update(t, x=x, y=y)
        return process_time() - begin

    short, long = (min(cost(bound) for _ in range(3)) for bound in (100, 1000))
    assert long < 4 * short


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_a_run_without_end_ended_where_windows_reached_beyond_it(backend):
    text = "always[2:5](historically[2:4](once[2:inf] z))"
    monitor = rtamt.parse(text, semantics="boolean", backend=backend).monitor(verdict="causation")
    for t, z in enumerate([-4.0, 0.5, 0.0, -1.0, 0.5]):
        monitor.update(t, z=z)
    assert [(run.begin, run.end) for run in monitor.runs()] == [(5.0, None)]
    assert monitor.causation(60) == rtamt.Causation(inf, inf)


@BACKENDS
@pytest.mark.parametrize("samples", [3, 130])
def test_causation_of_since_does_not_depend_on_goals_that_are_kept(samples, backend):
    monitor = rtamt.parse("(y >= 0) since (x >= 2)", backend=backend).monitor(verdict="causation")
    for t in range(samples):
        caused = monitor.update(t, x=-3 if t else 2, y=1)
        if t == 1:
            monitor = copy.copy(monitor)
    assert caused == monitor.causation(0)
    newest = samples - 1
    assert monitor.runs() == [CausationRun(newest, newest, 0.0, 0.0)]


@BACKENDS
def test_causation_of_since_over_a_future_operator_is_that_of_its_copy(backend):
    text = "s_next(y <= y) since[0:2] not(x >= y)"
    monitor = rtamt.parse(text, backend=backend).monitor(verdict="causation")
    for t, (x, y) in enumerate([(3, 1.5), (-1.5, -3), (3.5, 0.5), (-4, -4), (-0.5, -2)]):
        monitor = copy.copy(monitor)
        monitor.update(t, x=x, y=y)
    assert monitor.runs() == [CausationRun(3.0, 4.0, 0.0, -1.5)]


@BACKENDS
def test_no_goal_of_since_is_before_the_start(backend):
    monitor = rtamt.parse("s_next(0.5 > y) since rise(x < y)", backend=backend).monitor(verdict="causation")
    for t, (x, y) in enumerate([(3, -2), (3.5, 2)]):
        monitor = copy.copy(monitor)
        monitor.update(t, x=x, y=y)
    assert monitor.causation(0) == rtamt.Causation(inf, -inf)
    assert monitor.causation(1) == rtamt.Causation(-1.5, -1.5)


@BACKENDS
def test_causation_of_since_ends_where_its_first_samples_are_forgotten(backend):
    monitor = rtamt.parse("eventually[2:3](1.5 since[2:inf] y)", backend=backend).monitor(verdict="causation")
    for t, y in enumerate([0, -2.5, 1, 3]):
        monitor = copy.copy(monitor)
        monitor.update(t, y=y)
    assert monitor.runs() == [
        CausationRun(0.0, 0.0, 1.5, 0.0),
        CausationRun(1.0, 1.0, 1.5, 1.0),
        CausationRun(2.0, None, 1.5, 1.5),
    ]


@BACKENDS
@pytest.mark.parametrize("domain", [rtamt.Discrete(), rtamt.Dense("1s")], ids=["discrete", "dense"])
def test_what_was_known_of_an_operation_that_will_have_no_value_limits_causation(domain, backend):
    either = rtamt.parse("eventually[1:2](sqrt(delay[1](x, 1)) < 1) or x > 0", time=domain, backend=backend)
    # The root at 1 s will have no value, but it is known not to be negative: 1 - sqrt(...) is 1 at most.
    assert either.monitor(verdict="causation").update(0, x=-1) == Causation(1, -1)


@BACKENDS
def test_causation_of_until_ends_where_its_operands_are_not_kept(backend):
    text = "eventually[2:2] ((eventually[1:4] 1 > x) until[0:1] x >= y)"
    whole = rtamt.parse(text, backend=backend).monitor(verdict="causation")
    copied = copy.copy(whole)
    for t, (x, y) in enumerate([(4, 1), (2, -0.5), (3, 0), (4, -2.5), (-3, -2), (0.5, 1.5), (3, 3.5)]):
        copied = copy.copy(copied)  # which forgets what nobody reads any more
        assert copied.update(t, x=x, y=y) == whole.update(t, x=x, y=y)
        assert copied.runs() == whole.runs()
    assert copied.causation(0) == rtamt.Causation(4.0, -2.0)
