"""Laws of the dense-time definition alone, over formulas and unsynchronised signals."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rtamt.errors import EvaluationError
from rtamt.language.definitions.dense import QUARTERS, Steps, critical, lifted
from rtamt.language.formula import Apply, Const, Formula, Interval, Var, postorder
from rtamt.language.operators import STL, Bounds, Operator, Sort, Tense
from rtamt.language.shares import Share, ShareKind, is_share, rank_arguments, rank_of
from rtamt.reference import discrete_robustness as reference
from rtamt.reference.dense_robustness import DenseReferenceMonitor, StepFunction, evaluate
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.pastify import pastify
from rtamt.rewrite.truth import with_truths
from tests.laws.test_pastify_laws import formulas_over_numbers_ahead, of_numbers
from tests.oracle import dense_grid
from tests.support.strategies import dense_chunkings, dense_traces, formulas, traces

TICK = Fraction(1, 2)

# For laws that are checked for each operator by itself.
FEW = settings(max_examples=40)

# Ticks in a period, where a law is about a grid that is coarser than the clock.
THIRDS = 3

EVERY = [op for op in STL if not op.discrete_only]


def named(ops):
    return [pytest.param(op, id=op.name) for op in ops]


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
        return Interval(TICK, TICK, implied=True) if op.one_tick else None
    begin, length = draw(st.integers(0, 4)), draw(st.integers(0, 4))
    if op.bounds is Bounds.DURATION:
        begin = max(begin, op.positive)
        return Interval(begin * TICK, begin * TICK)
    bounded = Interval(begin * TICK, (begin + length) * TICK)
    if op.share:
        bounded = Interval(begin * TICK, (begin + length + 1) * TICK)
        count = Share(draw(st.integers(1, length + 1)) * TICK, ShareKind.DURATION)
        percent = Share(draw(st.fractions(1, 100, max_denominator=7)), ShareKind.PERCENT)
        return replace(bounded, share=draw(st.sampled_from((percent, count))))
    if op.bounds is Bounds.REQUIRED:
        return bounded
    return draw(st.sampled_from((bounded, Interval(begin * TICK, None), None)))


def arguments(interval: Interval | None) -> tuple[float | None, ...]:
    """Return what a dense definition takes after its operands: the bounds, and the rank of a share."""
    if interval is None:
        return 0, None
    a = int(interval.begin / TICK) * QUARTERS
    b = None if interval.end is None else int(interval.end / TICK) * QUARTERS
    return a, b, *rank_arguments(interval, TICK, continuous=True)


def dense_formulas(**more):
    return formulas(period=TICK, discrete=False, **more)


def value(formula, trace, tick=TICK) -> StepFunction:
    """Evaluate, and discard the example if something in it has no value."""
    try:
        return evaluate(formula, trace, tick)
    except EvaluationError:
        assume(False)


def same(got: StepFunction, expected: StepFunction) -> None:
    assert got.times.tolist() == expected.times.tolist()
    np.testing.assert_array_equal(got.values, expected.values)


def at(steps: StepFunction, times) -> np.ndarray:
    return steps.values[np.searchsorted(steps.times, times, side="right") - 1]


def span(trace) -> tuple[int, int]:
    return max(int(t[0]) for t, _ in trace.values()), max(int(t[-1]) for t, _ in trace.values())


def lone(node: Formula) -> bool:
    """Return whether an operator asks for φ up to an instant that is at least some a > 0 away."""
    two = isinstance(node, Apply) and node.op.tense is not Tense.NONE and len(node.args) == 2
    return two and node.op is not STL["since"] and node.interval is not None and node.interval.begin > 0


# ---- operators ----------------------------------------------------------------------------------


@pytest.mark.parametrize("op", named(op for op in EVERY if op.expansion))
@FEW
@given(data=st.data())
def test_an_expansion_means_what_the_definition_says(op, data):
    interval = data.draw(intervals(op))
    trace = data.draw(dense_traces(infinite=Sort.NUMBER not in op.operands))
    expanded = op.expansion(*with_truths(Apply(op, operands(op), interval)).args, interval)
    same(value(expanded, trace), value(Apply(op, operands(op), interval), trace))


@pytest.mark.parametrize("op", named(op for op in EVERY if op.dual))
@FEW
@given(data=st.data())
def test_negation_turns_an_operator_into_its_dual(op, data):
    interval, trace = data.draw(intervals(op)), data.draw(dense_traces())
    inside = operands(op) if Sort.NUMBER in op.operands else tuple(STL["not"](v) for v in operands(op))
    negated = STL["not"](Apply(op, operands(op), interval))
    same(value(Apply(STL[op.dual], inside, interval), trace), value(negated, trace))


@st.composite
def steps(draw) -> Steps:
    gaps = draw(st.lists(st.integers(1, 4), max_size=8))
    times = tuple(int(t) * QUARTERS for t in np.cumsum([0, *gaps]))
    return Steps(times, tuple(float(draw(st.integers(-3, 3))) for _ in times))


# At the instant at which a share ceases to be reached it is still reached: what follows is the value, by convention.
@pytest.mark.parametrize("op", named(op for op in EVERY if op.dense and not op.share))
@given(data=st.data())
def test_robustness_is_right_continuous(op, data):
    signals = tuple(data.draw(steps()) for _ in op.operands)
    interval = data.draw(intervals(op))
    formula = Apply(op, operands(op), interval)
    assume(not lone(formula))
    a, b = arguments(interval)
    whole = lifted(op.dense, signals, a, b, before=op.before)
    for instant in critical(signals, a, b, op.before):
        assert op.dense(instant, *signals, a, b) == whole.at(instant)


# On a finer grid what is per second is faster, and a pulse of a tick shorter.
@pytest.mark.parametrize("op", named(op for op in EVERY if op.dense and not op.timed and not op.before))
@given(data=st.data())
def test_between_critical_instants_nothing_changes(op, data):
    signals = tuple(data.draw(steps()) for _ in op.operands)
    bounds = arguments(data.draw(intervals(op)))
    whole = lifted(op.dense, signals, *bounds[:2], bounds[2:], past=op.tense is Tense.PAST)
    # The same on a grid ten times as fine, at instants that are not in the middle of anything.
    fine = tuple(Steps(tuple(10 * t for t in x.times), x.values) for x in signals)
    finer = tuple(None if each is None else 10 * each for each in bounds)
    # Between critical instants a share begins or ceases to be reached: the instants at which it does come on top.
    instants = sorted({*critical(fine, *finer[:2]), *(10 * t for t in whole.times)})
    for begin, end in zip(instants, [*instants[1:], instants[-1] + 40], strict=True):
        for instant in (begin + 2, begin + (end - begin) // 3 // 2 * 2, end - 2):
            assert op.dense(instant, *fine, *finer) == whole.at(begin // 10)


# ---- formulas -----------------------------------------------------------------------------------


def agrees_with_the_grid(formula, trace):
    got = value(formula, trace)
    start, expected = dense_grid.on_grid(formula, trace, TICK, truth=False)
    assert got.times[0] == start
    assert got.times[-1] <= span(trace)[1]
    ticks = start + np.arange(len(expected)) // 2
    np.testing.assert_array_equal(at(got, ticks), expected)


@pytest.mark.parametrize("op", named(op for op in EVERY if op.dense))
@given(data=st.data())
def test_an_operator_has_the_value_it_has_at_every_tick_and_in_every_gap(op, data):
    trace = data.draw(dense_traces(infinite=True))
    agrees_with_the_grid(Apply(op, operands(op), data.draw(intervals(op))), trace)


@given(dense_formulas(unbounded_future=True), dense_traces(infinite=True))
def test_a_formula_has_the_value_it_has_at_every_tick_and_in_every_gap(formula, trace):
    agrees_with_the_grid(formula, trace)


@given(dense_formulas(unbounded_future=True), dense_traces(infinite=True))
def test_sign_theorem(formula, trace):
    robustness = value(formula, trace)
    start, held = dense_grid.on_grid(formula, trace, TICK, truth=True)
    truth = np.array(held, bool)
    rho = at(robustness, start + np.arange(len(truth)) // 2)
    assert truth[rho > 0].all()
    assert not truth[rho < 0].any()


@given(dense_formulas(unbounded_future=True), dense_traces())
def test_times_increase_neighbours_differ_and_the_first_is_the_start(formula, trace):
    times, values = value(formula, trace)
    assert times[0] == span(trace)[0]
    assert (np.diff(times) > 0).all()
    assert (values[1:] != values[:-1]).all()


@given(dense_formulas(unbounded_future=True), dense_traces(), st.data())
def test_a_sample_that_repeats_the_value_changes_nothing(formula, trace, data):
    expected = value(formula, trace)
    first, last = span(trace)
    more = {}
    for name, (times, values) in trace.items():
        extra = data.draw(st.lists(st.integers(int(times[0]), last), max_size=4))
        finer = np.union1d(times, np.array(extra, np.int64))
        more[name] = (finer, at(StepFunction(times, values), finer))
    assert span(more) == (first, last)
    same(value(formula, more), expected)


def same_share(node: Formula, factor: int) -> bool:
    """Return whether a share is as long in finer ticks: a percentage is rounded up to whole ticks."""
    if not is_share(node):
        return True
    coarse, fine = (rank_of(node.interval, tick, continuous=True).k for tick in (TICK, TICK / factor))
    return fine == factor * coarse


# Of events in a window each is counted for a tick longer than the window.
@given(
    dense_formulas(unbounded_future=True, select=lambda op: not op.before), dense_traces(), st.integers(2, 7)
)
def test_a_finer_tick_changes_nothing(formula, trace, factor):
    assume(all(same_share(node, factor) for node in postorder(formula)))
    expected = value(formula, trace)
    finer = {name: (times * factor, values) for name, (times, values) in trace.items()}
    times, values = value(formula, finer, TICK / factor)
    same(StepFunction(times // factor, values), expected)
    assert not (times % factor).any()


@given(dense_formulas(unbounded_future=True), dense_traces(), st.sampled_from((-7, 10**18)))
def test_a_trace_that_comes_later_has_the_same_values_later(formula, trace, origin):
    expected = value(formula, trace)
    later = {name: (times + origin, values) for name, (times, values) in trace.items()}
    times, values = value(formula, later)
    same(StepFunction(times - origin, values), expected)


@given(dense_formulas(), dense_traces())
def test_the_pastified_formula_says_the_same_one_horizon_later(formula, trace):
    depth = int(horizon(formula) / TICK)
    expected = value(formula, trace)
    _, last = span(trace)
    # One variable repeats its value a horizon after the end, so that the trace is reported until then.
    name = next(name for name, (times, _) in trace.items() if times[-1] == last)
    times, values = trace[name]
    longer = {**trace, name: (np.append(times, last + depth + 1), np.append(values, values[-1]))}
    got = value(pastify(formula), longer)
    changes = np.union1d(expected.times, got.times[got.times - depth >= expected.times[0]] - depth)
    changes = changes[changes <= last]
    np.testing.assert_array_equal(at(got, changes + depth), at(expected, changes))


@given(
    formulas_over_numbers_ahead(dense_formulas(select=of_numbers, infinite=False, max_depth=2), TICK),
    dense_traces(),
)
def test_a_number_ahead_inside_arithmetic_is_defined_before_the_horizon_too(formula, trace):
    expected = value(formula, trace)
    got = evaluate(pastify(formula), trace, TICK)
    first, last = span(trace)
    later = np.arange(first, last - int(horizon(formula) / TICK) + 1)
    np.testing.assert_array_equal(at(got, later + int(horizon(formula) / TICK)), at(expected, later))


def grid_alike(node: Formula) -> bool:
    """Return whether SEMANTICS names this operator among those that agree on a grid."""
    return not (isinstance(node, Apply) and node.op is STL["since"]) and not lone(node)


@given(
    # A share counts the samples of a window in discrete time, and in dense time the periods, one less.
    formulas(
        period=TICK,
        discrete=False,
        select=lambda op: op is not STL["since"] and not op.share and not op.before,
    ),
    traces(),
    st.integers(-3, 20),
)
def test_dense_is_discrete_on_a_grid_where_windows_end_inside_the_trace(formula, columns, start):
    assume(all(map(grid_alike, postorder(formula))))
    n = len(columns["x"])
    ticks = start + THIRDS * np.arange(n)
    dense = value(formula, {name: (ticks, column) for name, column in columns.items()}, TICK / THIRDS)
    try:
        discrete = reference.evaluate(formula, columns, n, TICK)
    except EvaluationError:
        assume(False)
    inside = n - int(horizon(formula) / TICK)
    assume(inside > 0)
    np.testing.assert_array_equal(at(dense, ticks[:inside]), discrete[:inside])
    # Nothing changes between the samples.
    assert np.isin(dense.times[dense.times <= ticks[inside - 1]], ticks).all()


# ---- online -------------------------------------------------------------------------------------


def pushed(monitor, updates):
    return [*(monitor.push(update) for update in updates), monitor.finish()]


def joined(told, k) -> StepFunction:
    """Put together what was told of output k."""
    return StepFunction(
        np.concatenate([known[k].times for known in told]),
        np.concatenate([known[k].values for known in told]),
    )


@given(st.data())
def test_online_and_finish_give_what_offline_gives_under_any_chunking(data):
    outputs = [data.draw(dense_formulas(max_depth=3)) for _ in range(2)]
    trace = data.draw(dense_traces())
    expected = [value(formula, trace) for formula in outputs]
    told = pushed(DenseReferenceMonitor(outputs, tuple(trace), TICK), data.draw(dense_chunkings(trace)))
    for k, robustness in enumerate(expected):
        same(joined(told, k), robustness)
        assert told[-1][k].until == span(trace)[1]


@given(st.data())
def test_after_every_update_exactly_what_can_be_known_is_known(data):
    formula = data.draw(dense_formulas(max_depth=3))
    trace = data.draw(dense_traces())
    value(formula, trace)
    depth = int(horizon(formula) / TICK)
    start, _ = span(trace)
    monitor = DenseReferenceMonitor([formula], tuple(trace), TICK)
    ends: dict[str, int] = {}
    before = None
    for update in data.draw(dense_chunkings(trace)):
        ((times, _, until),) = monitor.push(update)
        ends |= {name: int(times[-1]) for name, (times, _) in update.items() if len(times)}
        reached = min(ends.values()) - depth if len(ends) == len(trace) else start - 1
        assert until == (reached if reached >= start else None)
        assert all((before is None or before < time) and time <= until for time in times)
        assert before is not None or until is None or times[0] == start
        before = until


@given(dense_formulas(max_depth=3), dense_traces(), dense_traces(), st.integers(1, 12))
def test_what_is_known_does_not_depend_on_what_comes_later(formula, trace, other, count):
    # The same first samples, another continuation.
    changed = {}
    for name, (times, values) in trace.items():
        more = times[:count][-1] + 1 + np.cumsum(np.diff(other[name][0], prepend=other[name][0][0]))
        later = other[name][1]
        changed[name] = (np.append(times[:count], more), np.append(values[:count], later))
    got, expected = value(formula, changed), value(formula, trace)
    until = min(int(times[:count][-1]) for times, _ in trace.values()) - int(horizon(formula) / TICK)
    start, _ = span(trace)
    assume(start == span(changed)[0] and until >= start)
    times = np.arange(start, until + 1)
    np.testing.assert_array_equal(at(got, times), at(expected, times))


@given(st.data())
def test_a_monitor_that_was_reset_is_a_new_one(data):
    formula = data.draw(dense_formulas(max_depth=3))
    before, trace = data.draw(dense_traces()), data.draw(dense_traces())
    value(formula, before)
    expected = value(formula, trace)
    monitor = DenseReferenceMonitor([formula], tuple(trace), TICK)
    pushed(monitor, [before])
    monitor.reset()
    same(joined(pushed(monitor, data.draw(dense_chunkings(trace))), 0), expected)


@given(st.data())
def test_a_push_that_fails_leaves_the_monitor_as_it_was(data):
    formula = STL["and"](data.draw(dense_formulas(max_depth=3)), STL["sqrt"](Var("x")))
    drawn = data.draw(dense_traces())
    trace = {name: (times, np.abs(values)) for name, (times, values) in drawn.items()}
    expected = value(formula, trace)
    monitor = DenseReferenceMonitor([formula], tuple(trace), TICK)
    _, last = span(trace)
    far = np.array([last + 1]), np.array([-1.0])
    # Far enough behind for every variable to have reached it, and for the sample of x to be read.
    bad = {"x": far, "y": (far[0], np.array([0.0]))}
    told = []
    for update in data.draw(dense_chunkings(trace)):
        with pytest.raises(EvaluationError):
            monitor.push(bad)
        told.append(monitor.push(update))
    told.append(monitor.finish())
    same(joined(told, 0), expected)


# ---- the generators -----------------------------------------------------------------------------


@given(st.data())
def test_generated_chunks_are_the_trace_in_order(data):
    trace = data.draw(dense_traces())
    updates = data.draw(dense_chunkings(trace))
    for name, columns in trace.items():
        for k, column in enumerate(columns):
            parts = [update[name][k] for update in updates if name in update]
            np.testing.assert_array_equal(np.concatenate(parts), column)
