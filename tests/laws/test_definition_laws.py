"""Laws of the definition alone, over formulas generated from the table."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rtamt.errors import EvaluationError
from rtamt.language.formula import Apply, Const, Formula, Interval, Var, children, fold, postorder
from rtamt.language.operators import STL, Bounds, Operator, Sort, Tense
from rtamt.language.shares import Share, ShareKind
from rtamt.reference.discrete_robustness import ReferenceMonitor, evaluate, evaluate_all, history
from rtamt.rewrite.desugar import spelled_out
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.truth import with_truths
from tests.oracle import boolean
from tests.support.strategies import chunkings, formulas, traces

PERIOD = Fraction(1, 2)

# For laws that are checked for each operator by itself.
FEW = settings(max_examples=50)


def value(formula, trace, period=PERIOD):
    """Evaluate, and discard the example if something in it has no value."""
    try:
        return evaluate(formula, trace, len(trace["x"]), period)
    except EvaluationError:
        assume(False)


def operands(op: Operator) -> tuple[Formula, ...]:
    if Sort.CONDITION in op.operands:
        names = iter("xyx")
        condition = STL["gt"](Var("y"), Const(0.0))
        return tuple(condition if sort is Sort.CONDITION else Var(next(names)) for sort in op.operands)
    if len(op.operands) > 2:  # limits that are not reversed
        return (Var("x"), Const(-1.0), Const(1.5))
    return tuple(Var(name) for name, _ in zip("xy", op.operands, strict=False))


@st.composite
def intervals(draw, op: Operator) -> Interval | None:
    if op.bounds is Bounds.NONE:
        return None
    begin, length = draw(st.integers(0, 4)), draw(st.integers(0, 4))
    if op.bounds is Bounds.DURATION:
        begin = max(begin, op.positive)
        return Interval(begin * PERIOD, begin * PERIOD)
    bounded = Interval(begin * PERIOD, (begin + length) * PERIOD)
    if op.share:
        count = Fraction(draw(st.integers(1, length + 1)))
        percent = Share(draw(st.fractions(1, 100, max_denominator=7)), ShareKind.PERCENT)
        return replace(bounded, share=draw(st.sampled_from((percent, Share(count, ShareKind.SAMPLES)))))
    if op.bounds is Bounds.REQUIRED:
        return bounded
    return draw(st.sampled_from((bounded, Interval(begin * PERIOD, None), None)))


def named(ops):
    return [pytest.param(op, id=op.name) for op in ops]


@pytest.mark.parametrize("op", named(op for op in STL if op.expansion))
@FEW
@given(data=st.data())
def test_an_expansion_means_what_the_definition_says(op, data):
    interval = data.draw(intervals(op))
    trace = data.draw(traces(infinite=Sort.NUMBER not in op.operands))
    expanded = op.expansion(*with_truths(Apply(op, operands(op), interval)).args, interval)
    np.testing.assert_array_equal(value(Apply(op, operands(op), interval), trace), value(expanded, trace))


@pytest.mark.parametrize("op", named(op for op in STL if op.dual))
@FEW
@given(data=st.data())
def test_negation_turns_an_operator_into_its_dual(op, data):
    interval, trace = data.draw(intervals(op)), data.draw(traces())
    inside = operands(op) if Sort.NUMBER in op.operands else tuple(STL["not"](v) for v in operands(op))
    negated = STL["not"](Apply(op, operands(op), interval))
    dual = Apply(STL[op.dual], inside, interval)
    np.testing.assert_array_equal(value(negated, trace), value(dual, trace))


@pytest.mark.parametrize("op", named(op for op in STL if op.dual))
def test_duality_goes_both_ways(op):
    assert STL[STL[op.dual].dual] is op


@pytest.mark.parametrize("op", named(op for op in STL if op.truth))
@FEW
@given(trace=traces())
def test_the_truth_of_a_predicate_is_infinite_where_it_holds(op, trace):
    formula = Apply(op, operands(op))
    truth = boolean.satisfied(formula, trace, len(trace["x"]), PERIOD)
    expected = np.where(truth, np.inf, -np.inf)
    np.testing.assert_array_equal(value(op.truth(*operands(op), None), trace), expected)


def test_the_boolean_oracle_covers_every_operator_that_makes_a_formula():
    assert {op.name for op in STL if op.result is Sort.FORMULA} <= boolean.COVERED


@given(formulas(period=PERIOD, unbounded_future=True), traces(infinite=True))
def test_sign_theorem(formula, trace):
    robustness = value(formula, trace)
    truth = np.array(boolean.satisfied(formula, trace, len(trace["x"]), PERIOD))
    assert truth[robustness > 0].all()
    assert not truth[robustness < 0].any()


@given(formulas(period=PERIOD, unbounded_future=True), traces())
def test_every_sub_formula_has_the_value_it_has_alone(formula, trace):
    value(formula, trace)
    n = len(trace["x"])
    every = evaluate_all(formula, trace, n, PERIOD)
    assert set(every) == set(postorder(spelled_out(formula)))  # conditions are true or false
    for sub, values in every.items():
        np.testing.assert_array_equal(values, evaluate(sub, trace, n, PERIOD))


def pushed(monitor, trace, sizes):
    """Push a trace in chunks; return what became known at each, and at the end."""
    told, begin = [], 0
    for size in sizes:
        told.append(monitor.push([trace[name][begin : begin + size] for name in ("x", "y")]))
        begin += size
    told.append(monitor.finish())
    return told


def monitor_of(*outputs):
    horizons = [int(horizon(f, PERIOD) / PERIOD) for f in outputs]
    histories = [history(f, PERIOD) for f in outputs]
    reach = None if None in histories else max(histories)
    return ReferenceMonitor(outputs, ("x", "y"), PERIOD, horizons, reach), horizons


@given(st.data())
def test_online_and_finish_give_what_offline_gives_under_any_chunking(data):
    bounded_past = data.draw(st.booleans())
    drawn = formulas(period=PERIOD, unbounded_past=not bounded_past)
    outputs = [data.draw(drawn), data.draw(drawn)]
    trace = data.draw(traces(min_size=0))
    n = len(trace["x"])
    expected = [value(f, trace) for f in outputs]
    monitor, horizons = monitor_of(*outputs)
    sizes = data.draw(chunkings(n))
    told = pushed(monitor, trace, sizes)
    assert monitor.samples == n
    for k, (robustness, ahead) in enumerate(zip(expected, horizons, strict=True)):
        known = np.cumsum([0, *(len(values[k]) for values in told)])
        assert known[1:-1].tolist() == [max(0, int(s) - ahead) for s in np.cumsum(sizes)]
        np.testing.assert_array_equal(np.concatenate([values[k] for values in told]), robustness)


@given(st.data())
def test_a_monitor_that_was_reset_is_a_new_one(data):
    formula = data.draw(formulas(period=PERIOD))
    before, trace = data.draw(traces()), data.draw(traces())
    value(formula, before)
    expected = value(formula, trace)
    monitor, _ = monitor_of(formula)
    pushed(monitor, before, [len(before["x"])])
    monitor.reset()
    told = pushed(monitor, trace, data.draw(chunkings(len(trace["x"]))))
    np.testing.assert_array_equal(np.concatenate([values[0] for values in told]), expected)


@given(st.data())
def test_a_push_that_fails_leaves_the_monitor_as_it_was(data):
    formula = data.draw(formulas(period=PERIOD))
    trace = data.draw(traces())
    monitor, _ = monitor_of(STL["and"](formula, STL["sqrt"](Var("x"))))
    told, bad = [], [np.array([-1.0]), np.array([0.0])]
    absolute = np.abs(trace["x"])
    expected = value(STL["and"](formula, STL["sqrt"](Var("x"))), {"x": absolute, "y": trace["y"]})
    begin = 0
    for size in data.draw(chunkings(len(absolute))):
        with pytest.raises(EvaluationError):
            monitor.push(bad)
        told.append(monitor.push([absolute[begin : begin + size], trace["y"][begin : begin + size]])[0])
        begin += size
    told.append(monitor.finish()[0])
    np.testing.assert_array_equal(np.concatenate(told), expected)


@given(st.data())
def test_samples_older_than_the_history_change_nothing(data):
    formula = data.draw(formulas(period=PERIOD, unbounded_past=False))
    trace = data.draw(traces(min_size=2))
    n = len(trace["x"])
    old = data.draw(st.integers(1, n - 1))
    other = data.draw(traces(min_size=old, max_size=old))
    changed = {name: np.concatenate((other[name], trace[name][old:])) for name in trace}
    begin = old + history(formula, PERIOD)
    np.testing.assert_array_equal(value(formula, trace)[begin:], value(formula, changed)[begin:])


@given(formulas(period=PERIOD, unbounded_future=True))
def test_history_is_unbounded_exactly_where_a_past_operator_is(formula):
    def unbounded(node):
        return (
            isinstance(node, Apply)
            and node.op.tense is Tense.PAST
            and (node.interval is None or node.interval.end is None)
            and (node.op.bounds is not Bounds.NONE or node.op.reach is None)
        )

    assert (history(formula, PERIOD) is None) is any(unbounded(node) for node in postorder(formula))


@given(formulas(max_depth=3, period=PERIOD))
def test_generated_formulas_are_no_deeper_than_asked(formula):
    def depth(node, below):
        return max(below, default=0) + isinstance(node, Apply)

    assert fold(formula, depth) <= 3


@given(formulas(past=False, discrete=False, arithmetic=False))
def test_generated_formulas_keep_to_what_was_asked(formula):
    for node in postorder(formula):
        if isinstance(node, Apply):
            assert node.op.tense is not Tense.PAST
            assert not node.op.discrete_only
            assert node.op.result is Sort.FORMULA
            for operand, sort in zip(children(node), node.op.operands, strict=True):
                assert sort is Sort.FORMULA or not isinstance(operand, Apply)


def test_generated_formulas_reach_every_operator():
    seen = set()

    @settings(max_examples=1000, derandomize=True, database=None, deadline=None)
    @given(formulas())
    def look(formula):
        seen.update(node.op.name for node in postorder(formula) if isinstance(node, Apply))

    look()
    assert seen == {op.name for op in STL if not op.presence}


@given(st.integers(0, 10).flatmap(lambda n: st.tuples(st.just(n), chunkings(n))))
def test_generated_chunks_add_up(drawn):
    n, sizes = drawn
    assert sum(sizes) == n
    assert min(sizes) >= 0
