"""The cases of bounds and early verdicts: from the definition, and held against an independent evaluator."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from random import Random

import pytest
from conformance import early

import rtamt
from rtamt import Dense, Discrete
from rtamt.language.parsing.parser import parse_formula
from rtamt.rewrite.check import unbounded_future
from tests.oracle import meaning

CASES = early.read()


@pytest.mark.parametrize("case", [pytest.param(case, id=case.id) for case in CASES])
def test_the_answers_are_those_of_the_definition(case):
    fresh = replace(case, tree={}, bounds=[], verdicts=[], causation=[])
    assert early.answered(fresh) == case


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("case", [pytest.param(case, id=case.id) for case in CASES if case.time == "dense"])
def test_the_monitors_of_dense_time_give_the_answers(case, backend):
    domain = Dense(case.seconds)
    spec = rtamt.parse(case.formula, time=domain, backend=backend)
    ranges = {name: (low, high) for name, (low, high) in case.ranges.items()}
    settings = {"time": domain, "ranges": ranges}
    every = unbounded_future(spec.formula) is None
    bounds, eager = (spec.monitor(verdict=mode, **settings) for mode in ("interval", "eager"))
    told = []
    for stage, (tick, row) in enumerate([*early.updates_of(case), (None, {})]):
        if tick is None:
            bounds.finish()
            told.append(eager.finish())
        else:
            bounds.update(_seconds(tick, case), **row)
            told.append(eager.update(_seconds(tick, case), **row))
        expected = case.bounds[stage]
        if expected is None:
            continue
        assert bounds.interval() == rtamt.Interval(*expected[0][1:])
        for begin, lower, upper in expected if every else ():
            assert bounds.interval(_seconds(begin, case)) == rtamt.Interval(lower, upper)
    runs = [[(r.begin, r.end, r.satisfied, r.decided_at) for r in news] for news in told]
    assert runs == [
        [
            (_seconds(b, case), _seconds(e, case), satisfied, _seconds(at, case))
            for b, e, satisfied, at in news
        ]
        for news in case.verdicts
    ]


CAUSED = [case for case in CASES if case.causation]


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("case", [pytest.param(case, id=case.id) for case in CAUSED])
def test_causation_is_that_of_the_monitor_and_adds_up_to_the_bounds(case, backend):
    dense = case.time == "dense"
    domain = Dense(case.seconds) if dense else Discrete(case.seconds)
    spec = rtamt.parse(case.formula, time=domain, backend=backend)
    monitor = spec.monitor(verdict="causation")
    before = spec.monitor(verdict="interval", at="start").interval()
    lower, upper = before.lower, before.upper
    for i, caused in enumerate(case.causation):
        if not dense:
            row = {name: values[i] for name, values in case.signals.items()}
            found, bounds = monitor.update(_seconds(i, case), **row), case.bounds[i][0]
        elif i < len(updates := early.updates_of(case)):
            row = {name: value for name, (value, _) in updates[i][1].items()}
            found, bounds = (
                monitor.update(_seconds(updates[i][0], case), **row),
                (case.bounds[i] or [[]])[0][1:],
            )
        else:
            found, bounds = monitor.finish(), case.bounds[i][0][1:]
        if caused is None:
            assert found == rtamt.Causation(inf, -inf)
            continue
        violation, satisfaction = caused
        assert found == rtamt.Causation(violation, satisfaction)
        lower, upper = max(lower, satisfaction), min(upper, violation)
        assert [lower, upper] == bounds


def test_the_corpus_has_causation():
    for time in ("discrete", "dense"):
        assert sum(case.time == time for case in CAUSED) >= 50


def _seconds(tick, case):
    return float(tick * case.seconds)


@pytest.mark.parametrize("case", [pytest.param(case, id=case.id) for case in CASES])
def test_the_answer_of_every_completed_trace_lies_within_the_final_bounds(case):
    rng = Random(case.id)
    formula = parse_formula(case.formula)

    def completed(name, value):
        low, high = case.pair(name, value)
        inside = [v for v in (low, high, max(low, -9.0), min(high, 9.0), 0.5) if low <= v <= high]
        return rng.choice(inside)

    for _ in range(3):
        try:
            if case.time == "discrete":
                columns = {name: [completed(name, v) for v in vs] for name, vs in case.signals.items()}
                n = len(case.bounds[-1])
                values = meaning.discrete(formula, columns, n, case.seconds)
                bounds = case.bounds[-1]
            else:
                signals = {
                    name: [(t, completed(name, v)) for t, v in vs] for name, vs in case.signals.items()
                }
                start, values = meaning.dense(formula, signals, case.seconds)
                end = max(t for samples in case.signals.values() for t, _ in samples)
                rows = case.bounds[-1]
                bounds = [[row[1:] for row in rows if row[0] <= t][-1] for t in range(start, end + 1)]
        except meaning.NoValueError:
            continue
        for (lower, upper), value in zip(bounds, values, strict=False):
            assert lower <= value <= upper
