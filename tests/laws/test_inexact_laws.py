"""Offline bounds: both back ends give the same, which contain the robustness of every completed recording."""

from __future__ import annotations

from random import Random

import numpy as np
from hypothesis import assume, example, given
from hypothesis import strategies as st

import rtamt
from rtamt.engine.dense.backends import BACKENDS as DENSE_BACKENDS
from rtamt.engine.discrete.backends import BACKENDS
from rtamt.errors import EvaluationError
from rtamt.language.contents import variables
from rtamt.language.formula import Apply, postorder
from rtamt.language.printing.printer import to_text
from rtamt.reference import discrete_robustness as reference
from rtamt.signals.dense import DenseTrace
from rtamt.signals.discrete import DiscreteTrace
from rtamt.signals.ticks import TimeScale
from tests.laws.early.cases import dense_case, formula, value
from tests.laws.early.definition import PERIOD, TICK


def drawn(seed: int):
    """Draw a formula that reads a variable, a finished recording of it, and one of the traces that it may be."""
    rng = Random(seed)
    while True:
        asked = formula(rng, ("x", "y"), depth=rng.randint(1, 4), unbounded=True)
        if variables(asked):
            break
    n = rng.randint(1, 12)
    truth = {name: np.array([value(rng) for _ in range(n)]) for name in variables(asked)}
    bounds = {}
    for name, column in truth.items():
        far = np.array([rng.choice((0.0, 0.0, 0.5, 2.0, np.inf)) for _ in range(n)])
        bounds[name] = column - far, column + far
    return asked, DiscreteTrace(np.arange(n, dtype=float), truth, PERIOD, bounds=bounds), rng


def of(backend: str, asked, trace) -> list[list[float]]:
    try:
        (found,) = BACKENDS[backend].bounds((asked,), PERIOD, tuple(trace.columns))(trace)
    except EvaluationError:
        return []  # of several undefined operations each back end names the one that it meets first
    return [found.lower.tolist(), found.upper.tolist()]


@given(st.integers(0, 2**32))
def test_both_back_ends_give_the_same_bounds_to_the_last_bit(seed):
    asked, trace, _ = drawn(seed)
    assert of("cpp", asked, trace) == of("python", asked, trace)


def drawn_dense(seed: int):
    """Draw a formula and a finished recording of dense time, known in part."""
    rng = Random(seed)
    case = dense_case(rng)
    columns, bounds = {}, {}
    for name, (times, values) in case.truth.items():
        far = np.array([rng.choice((0.0, 0.0, 0.5, 2.0, np.inf)) for _ in times])
        columns[name] = np.array(times), np.array(values)
        bounds[name] = columns[name][1] - far, columns[name][1] + far
    scale = TimeScale.in_ticks(TICK)
    return case.formula, DenseTrace(columns, scale, bounds=bounds)


def dense_of(backend: str, asked, trace) -> list[list[float]]:
    try:
        (found,) = DENSE_BACKENDS[backend].bounds((asked,), TICK, tuple(trace.columns))(trace)
    except EvaluationError:
        return []
    return [found.times.tolist(), found.lower.tolist(), found.upper.tolist()]


@given(st.integers(0, 2**32))
@example(295283)  # an unbounded operator over 'fall', which changes a tick after the last sample
def test_both_back_ends_give_the_same_bounds_in_dense_time_to_the_last_bit(seed):
    asked, trace = drawn_dense(seed)
    assert dense_of("cpp", asked, trace) == dense_of("python", asked, trace)


@given(st.integers(0, 2**32))
def test_the_robustness_of_the_completed_recording_lies_within_the_bounds(seed):
    asked, trace, _ = drawn(seed)
    try:
        robustness = reference.evaluate(asked, trace.columns, len(trace), PERIOD)
        (found,) = BACKENDS["cpp"].bounds((asked,), PERIOD, tuple(trace.columns))(trace)
    except EvaluationError:
        assume(False)
    assert (found.lower <= robustness).all()
    assert (robustness <= found.upper).all()


@given(st.integers(0, 2**32), st.sampled_from(("discrete", "dense")))
def test_of_exact_samples_both_bounds_are_the_robustness(seed, time):
    asked, trace, _ = drawn(seed)
    assume(time == "discrete" or not any(op.discrete_only for op in operators(asked)))
    spec = rtamt.parse(to_text(asked), time=time, resolution=1)
    data = {"time": trace.times, **trace.columns}
    try:
        robustness = spec.evaluate(data).robustness
    except EvaluationError:
        assume(False)
    assert spec.evaluate(data).interval == rtamt.Interval(robustness, robustness)
    zero = dict.fromkeys(trace.columns, 5e-324)  # the bounds meet, and yet come from interval arithmetic
    noisy = spec.evaluate(data, uncertainty=zero).interval
    assert noisy.lower <= robustness <= noisy.upper


def operators(asked):
    return [node.op for node in postorder(asked) if isinstance(node, Apply)]
