"""Quantifiers over members: a formula over a member means what it means on the trace of that member alone."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.errors import EvaluationError
from rtamt.language.formula import Apply, Const, Formula, Var, postorder
from rtamt.language.operators import STL
from rtamt.testing.members import HEAD, dense_scenes, quantified_formulas, quantify, scenes
from rtamt.testing.strategies import dense_chunkings, dense_traces, formulas, traces

COMBINED = {"forall": np.min, "exists": np.max, "count": lambda truths, axis: np.sum(truths > 0, axis=axis)}
SUMS = ("sum", "mean", "integral")
EMPTY = {"forall": np.inf, "exists": -np.inf, "count": 0.0}


def values_of(formula: Formula, data: dict[str, object], backend: str = "cpp") -> np.ndarray | None:
    """Return the robustness at each sample, None where an operation has no value."""
    try:
        spec = rtamt.parse('group cars = "car_*"; true', backend=backend).with_formula(formula)
        return spec.evaluate(data).signal.values
    except EvaluationError:
        return None


@pytest.mark.parametrize("word", COMBINED)
@given(data=st.data())
def test_a_quantifier_means_each_member_on_its_own_trace(word, data):
    body = data.draw(formulas(3, unbounded_future=True))
    # A window that lies behind reads +inf and -inf also when the member has left: their sum has no value then.
    added = any(isinstance(node, Apply) and node.op.name in SUMS for node in postorder(body))
    trace = data.draw(traces(("a", "b", "y"), min_size=2, max_size=12, infinite=not added))
    n = len(trace["y"])
    columns: dict[str, object] = {"y": trace["y"]}
    each = np.full((2, n), EMPTY[word] if word != "count" else -np.inf)
    defined = True
    for k, name in enumerate("ab"):
        begin = data.draw(st.integers(0, n - 1))
        end = data.draw(st.integers(begin + 1, n))
        inside = range(begin, end)
        columns[f"car_{name}.x"] = [x if i in inside else None for i, x in enumerate(trace[name].tolist())]
        own = {"x": trace[name][begin:end], "y": trace["y"][begin:end]}
        try:
            spec = rtamt.parse("true").with_formula(body)
            semantics = "boolean" if word == "count" else "standard"
            each[k, begin:end] = spec.evaluate(own, semantics=semantics).signal.values
        except EvaluationError:
            defined = False
    found = values_of(quantify(word, body), columns)
    if not defined:
        return
    assert found is not None, "the error lies at an instant at which the member is absent"
    np.testing.assert_array_equal(found, COMBINED[word](each, axis=0))


@given(data=st.data())
def test_a_stream_of_members_gives_what_the_whole_recording_gives(data):
    formula = data.draw(quantified_formulas())
    n = data.draw(st.integers(1, 9))
    y = data.draw(traces(("y",), min_size=n, max_size=n))["y"].tolist()
    columns = {"y": y, **data.draw(scenes(n))}
    spec = rtamt.parse('group cars = "car_*"; true').with_formula(formula)
    expected = values_of(formula, columns)
    monitor = spec.monitor()
    found: list[float] = []
    try:
        for t in range(n):
            present = {name: xs[t] for name, xs in columns.items() if xs[t] is not None}
            robustness = monitor.update(float(t), **present)
            if robustness is not None:
                found.append(robustness)
        found += monitor.finish().values.tolist()
    except EvaluationError:
        assert expected is None
        return
    if expected is not None:
        np.testing.assert_array_equal(found, expected)
        chunks = spec.monitor()
        cut = data.draw(st.integers(0, n))
        parts = [
            {name: xs[:cut] for name, xs in columns.items()},
            {name: xs[cut:] for name, xs in columns.items()},
        ]
        signals = [*map(chunks.update_many, parts), chunks.finish()]
        np.testing.assert_array_equal(np.concatenate([signal.values for signal in signals]), expected)
        np.testing.assert_array_equal(np.concatenate([signal.times for signal in signals]), np.arange(n))


@st.composite
def arrivals(draw, own, cars):
    """Draw a split of ordinary signals and cars into updates, in which no sample of a car comes too late."""
    updates = [dict(each) for each in draw(dense_chunkings(own))]
    lasts: dict[str, int] = {}
    known = []
    for update in updates:
        lasts |= {name: int(ticks[-1]) for name, (ticks, _) in update.items() if len(ticks)}
        known.append(min(lasts.values()) if len(lasts) == len(own) else -1)
    for name, samples in cars.items():
        at = 0
        for tick, x in samples:
            latest = next((k for k, until in enumerate(known) if until >= tick), len(updates) - 1)
            at = draw(st.integers(at, latest))
            ticks, values = updates[at].get(name, ([], []))
            updates[at][name] = [*ticks, tick], [*values, x]
    return updates


@pytest.mark.parametrize("backend", ["cpp", "python"])
@given(data=st.data())
def test_a_dense_stream_of_members_gives_what_the_whole_recording_gives(backend, data):
    formula = STL["and"](data.draw(quantified_formulas(discrete=False)), STL["le"](Var("z"), Const(9.0)))
    own = data.draw(dense_traces(("y", "z"), max_size=6))
    cars = data.draw(dense_scenes(int(min(ticks[-1] for ticks, _ in own.values()))))
    if not cars:
        return
    spec = rtamt.parse('group cars = "car_*"; true', time="dense", resolution="1s", backend=backend)
    spec = spec.with_formula(formula)
    whole = {**own, **{name: tuple(zip(*samples, strict=True)) for name, samples in cars.items()}}
    try:
        expected = spec.evaluate(whole).signal.points()
        monitor, found = spec.monitor(), []
        for update in data.draw(arrivals(own, cars)):
            known = monitor.update_many(update).points()
            if known:
                assert known[-1][0] == min(monitor._inputs.last[name] for name in own) - monitor.horizon
            found += known
        found += monitor.finish().points()
    except EvaluationError:
        return
    times = [t for t, _ in found]
    assert times == sorted(set(times))
    assert times[-1] == expected[-1][0]
    assert changes_of(found) == changes_of(expected)


def changes_of(points):
    """Return the points at which a step function changes."""
    return [each for k, each in enumerate(points) if k == 0 or each[1] != points[k - 1][1]]


def bounds_law(spec, columns, expected):
    """Check the bounds of every instant after every sample, and at the end, against those of the whole trace."""
    n, horizon = len(columns["y"]), int(spec.horizon)
    monitor = spec.monitor(verdict="interval")
    bounds: dict[int, tuple[float, float]] = {}
    for t in range(n):
        monitor.update(float(t), **{name: xs[t] for name, xs in columns.items() if xs[t] is not None})
        for change in monitor.changes():
            for place in range(int(change.begin), int(change.end) + 1):
                now, before = change.interval, bounds.get(place, (-np.inf, np.inf))
                assert before[0] <= now.lower <= now.upper <= before[1]
                bounds[place] = now.lower, now.upper
        for place in range(n - horizon):  # what the end of the trace does not cut
            low, high = bounds.get(place, (-np.inf, np.inf))
            assert low <= expected[place] <= high
            assert place + horizon > t or low == high == expected[place]
    for change in monitor.finish():
        for place in range(int(change.begin), int(change.end) + 1):
            bounds[place] = change.interval.lower, change.interval.upper
    for place in range(n):
        assert bounds[place] == (expected[place], expected[place])
    start = spec.monitor(verdict="interval", at="start")
    for t in range(n):
        start.update(float(t), **{name: xs[t] for name, xs in columns.items() if xs[t] is not None})
    start.finish()
    assert start.interval() == rtamt.Interval(expected[0], expected[0])


@given(data=st.data())
def test_bounds_of_members_contain_the_robustness_and_meet_it_at_the_horizon(data):
    formula = data.draw(quantified_formulas(2))
    n = data.draw(st.integers(1, 7))
    columns = {"y": data.draw(traces(("y",), min_size=n, max_size=n))["y"].tolist(), **data.draw(scenes(n))}
    spec = rtamt.parse('group cars = "car_*"; true').with_formula(formula)
    expected = values_of(formula, columns)
    if expected is not None:
        try:
            bounds_law(spec, columns, expected)
        except EvaluationError:
            return


@given(quantified_formulas(), scenes(3), traces(("y",), min_size=3, max_size=3))
def test_an_error_of_an_evaluation_contains_no_internal_names(formula, cars, own):
    spec = rtamt.parse(HEAD + str(formula))
    data = {"y": own["y"].tolist(), **cars}
    for evaluate in (spec.evaluate, spec.monitor().update_many):
        message = error_of(evaluate, data)
        assert "#" not in message
        assert '"valid(' not in message


def error_of(evaluate, data) -> str:
    try:
        evaluate(data)
    except EvaluationError as error:
        return str(error)
    return ""


@given(quantified_formulas(unbounded_future=True))
def test_a_quantified_formula_prints_and_comes_back_from_a_pickle(formula):
    again = rtamt.parse(HEAD + str(formula)).formula
    assert again == formula, str(formula)
    assert pickle.loads(pickle.dumps(formula)) == formula
    assert formula.latex().count("{") == formula.latex().count("}")


@given(data=st.data())
@settings(max_examples=40)
def test_back_ends_agree_on_members_and_their_monitors_come_back_from_pickles(data):
    formula = data.draw(quantified_formulas(2))
    n = data.draw(st.integers(1, 6))
    columns = {"y": data.draw(traces(("y",), min_size=n, max_size=n))["y"].tolist(), **data.draw(scenes(n))}
    found = []
    for backend in ("cpp", "python"):
        expected = values_of(formula, columns, backend)
        found.append(expected)
        if expected is None:
            continue
        monitor = rtamt.parse(HEAD + "true", backend=backend).with_formula(formula).monitor()
        values: list[float] = []
        try:
            for t in range(n):
                if t == n // 2:
                    monitor = pickle.loads(pickle.dumps(monitor))
                known = monitor.update(
                    t, **{name: xs[t] for name, xs in columns.items() if xs[t] is not None}
                )
                values += [] if known is None else [known]
            values += monitor.finish().values.tolist()
        except EvaluationError:
            continue
        np.testing.assert_array_equal(values, expected)
    if all(each is not None for each in found):
        np.testing.assert_array_equal(*found)
