"""Values of every operator's definition, worked out by hand or by the formula word for word."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy import inf, nan

import rtamt
from rtamt.language.definitions import discrete as d
from rtamt.language.definitions import pointwise as p
from rtamt.language.formula import Const, Interval, Var
from rtamt.language.operators import STL, Bounds, Sort, Tense
from rtamt.reference.discrete_robustness import evaluate

X = [1.0, 4.0, 2.0, -3.0, 0.0]
Y = [-1.0, 2.0, 5.0, 0.0, 1.0]

# name of the operator, operands, bounds in samples, values
CASES = [
    ("true", 3, (), [inf, inf, inf]),
    ("false", 3, (), [-inf, -inf, -inf]),
    ("abs", [X], (), [1, 4, 2, 3, 0]),
    ("sqrt", [[0, 4, 2, inf, -1]], (), [0, 2, math.sqrt(2), inf, nan]),
    ("exp", [[0, 1, -inf, inf, 1000, -1000]], (), [1, math.e, 0, inf, inf, 0]),
    ("pow", [[2, 2, 0, -0.0, -0.0, 10], [3, -1, -1, -1, -2, 400]], (), [8, 0.5, inf, inf, inf, inf]),
    (
        "pow",
        [[-10, -10, -8, nan, 1, 0, -2], [309, 310, 1 / 3, 0, nan, -inf, 3]],
        (),
        [-inf, inf, nan, 1, 1, inf, -8],
    ),
    ("log", [[8, 100, 1, 2, 1], [2, 10, 7, 1, 1]], (), [3, 2, 0, inf, nan]),
    ("ln", [[1, 0, -0.0, -1, inf, -inf]], (), [0, -inf, -inf, nan, inf, nan]),
    ("min", [X, Y], (), [-1, 2, 2, -3, 0]),
    ("max", [X, Y], (), [1, 4, 5, 0, 1]),
    ("sin", [[0, math.pi / 2, -1, inf, -inf]], (), [0, 1, -math.sin(1), nan, nan]),
    ("cos", [[0, math.pi, 1, inf]], (), [1, -1, math.cos(1), nan]),
    ("tan", [[0, 1, -1, inf]], (), [0, math.tan(1), -math.tan(1), nan]),
    ("asin", [[0, 1, -1, 1.5, inf]], (), [0, math.pi / 2, -math.pi / 2, nan, nan]),
    ("acos", [[1, 0, -1, -1.5]], (), [0, math.pi / 2, math.pi, nan]),
    ("atan", [[0, 1, inf, -inf]], (), [0, math.pi / 4, math.pi / 2, -math.pi / 2]),
    ("atan2", [[0, 1, -0.0, 0, inf], [1, 0, -1, 0, inf]], (), [0, math.pi / 2, math.pi, 0, math.pi / 4]),
    ("hypot", [[3, -6, inf, 1e300, 0], [4, 8, 1, 1e300, 0]], (), [5, 10, inf, math.hypot(1e300, 1e300), 0]),
    ("sinh", [[0, 1, 1000, -1000, -inf]], (), [0, math.sinh(1), inf, -inf, -inf]),
    ("cosh", [[0, 1, 1000, -inf]], (), [1, math.cosh(1), inf, inf]),
    ("tanh", [[0, 1, inf, -inf]], (), [0, math.tanh(1), 1, -1]),
    ("degrees", [[0, math.pi, inf, 1e308]], (), [0, 180, inf, inf]),
    ("radians", [[0, 180, -inf]], (), [0, math.pi, -inf]),
    ("floor", [[1.5, -1.5, 2, inf, 1e300]], (), [1, -2, 2, inf, 1e300]),
    ("ceil", [[1.5, -1.5, 2, -inf]], (), [2, -1, 2, -inf]),
    ("round", [[0.5, -0.5, 2.5, -2.5, 1.4, inf, 0.49999999999999994]], (), [1, -1, 3, -3, 1, inf, 0]),
    ("sign", [[-3, 0, -0.0, 5e-324, inf]], (), [-1, 0, 0, 1, 1]),
    (
        "mod",
        [[7, -7, 7, -7, -5, 5, inf, 1], [3, 3, -3, -3, inf, inf, 3, 0]],
        (),
        [1, 2, -2, -1, inf, 5, nan, nan],
    ),
    ("clip", [[5, -5, 0, 7, inf], [-1, -1, -1, 2, 0], [1, 1, 1, 1, inf]], (), [1, -1, 0, nan, inf]),
    (
        "wrap",
        [[190, -190, 10, 180, 5, inf], [-180, -180, -180, -180, 3, 0], [180, 180, 180, 180, 3, 1]],
        (),
        [-170, 170, 10, -180, nan, nan],
    ),
    ("wrap", [[-1e-17, 1e300, 3.5], [0, 0, -1e308], [1, 1, 1e308]], (), [0, 0, 3.5]),
    ("wrap", [[0, -5, 1e308, -1], [-inf, -inf, -1e308, 0], [0, 0, 0, inf]], (), [nan, -5, nan, 0]),
    ("if", [[inf, -inf, inf, -inf, inf], X, Y], (), [1, 2, 2, 0, 0]),
    ("neg", [X], (), [-1, -4, -2, 3, 0]),
    ("mul", [[*X, 0], [*Y, inf]], (), [-1, 8, 10, 0, 0, nan]),
    ("div", [[1, -1, 0, 6, inf, 1], [0, 0, 0, 4, inf, -0.0]], (), [inf, -inf, nan, 1.5, nan, inf]),
    ("add", [[*X, inf], [*Y, -inf]], (), [0, 6, 7, -3, 1, nan]),
    ("sub", [[*X, inf], [*Y, inf]], (), [2, 2, -3, -3, -1, nan]),
    ("ge", [X, Y], (), [2, 2, -3, -3, -1]),
    ("gt", [X, Y], (), [2, 2, -3, -3, -1]),
    ("le", [X, Y], (), [-2, -2, 3, 3, 1]),
    ("lt", [X, Y], (), [-2, -2, 3, 3, 1]),
    ("eq", [[*X, 7], [*Y, 7]], (), [-2, -2, -3, -3, -1, 0]),
    ("ne", [[*X, 7], [*Y, 7]], (), [2, 2, 3, 3, 1, 0]),
    ("not", [X], (), [-1, -4, -2, 3, 0]),
    ("and", [X, Y], (), [-1, 2, 2, -3, 0]),
    ("or", [X, Y], (), [1, 4, 5, 0, 1]),
    ("implies", [X, Y], (), [-1, 2, 5, 3, 1]),
    ("iff", [X, Y], (), [-1, 2, 2, 0, 0]),
    ("xor", [X, Y], (), [1, -2, -2, 0, 0]),
    ("always", [X], (0, 1), [1, 2, -3, -3, 0]),
    ("always", [X], (1, 2), [2, -3, -3, 0, inf]),
    ("always", [X], (0, None), [-3, -3, -3, -3, 0]),
    ("always", [X], (5, 9), [inf] * 5),
    ("eventually", [X], (0, 1), [4, 4, 2, 0, 0]),
    ("eventually", [X], (1, 2), [4, 2, 0, 0, -inf]),
    ("eventually", [X], (1, None), [4, 2, 0, 0, -inf]),
    ("eventually", [X], (5, 9), [-inf] * 5),
    ("historically", [X], (0, 1), [1, 1, 2, -3, -3]),
    ("historically", [X], (1, 2), [inf, 1, 1, 2, -3]),
    ("valid", [X], (), [inf] * 5),
    ("historically", [X], (0, None), [1, 1, 1, -3, -3]),
    ("historically", [X], (5, 9), [inf] * 5),
    ("atleast", [X], (0, 2, 2, inf), [2, 2, 0, 0, inf]),
    ("wasatleast", [X], (1, 2, 1, -inf), [-inf, 1, 4, 4, 2]),
    ("once", [X], (0, 1), [1, 4, 4, 2, 0]),
    ("once", [X], (2, 2), [-inf, -inf, 1, 4, 2]),
    ("once", [X], (1, None), [-inf, 1, 4, 4, 4]),
    ("once", [X], (5, 9), [-inf] * 5),
    ("minimum", [X], (0, 1), [1, 1, 2, -3, -3]),
    ("held", [X, [-inf, inf, -inf, -inf, inf]], (), [1, 4, 4, 4, 0]),
    ("held", [X, [-inf, inf, -inf, -inf, inf], Y], (), [-1, 4, 4, 4, 0]),
    ("delay", [X], (2, 2), [1, 1, 1, 4, 2]),
    ("delay", [X, Y], (2, 2), [-1, 2, 1, 4, 2]),
    ("rate", [X], (2, 2), [0, 1.5, 0.5, -3.5, -1]),
    ("ahead", [X], (2, 2), [2, -3, 0, 0, 0]),
    ("diff", [X], (2, 2), [0, 3, 1, -7, -2]),
    ("minimum", [X], (2, 3), [inf, inf, 1, 1, 2]),
    ("maximum", [X], (0, None), [1, 4, 4, 4, 4]),
    ("maximum", [X], (5, 9), [-inf] * 5),
    ("sum", [X], (0, 1), [1, 5, 6, -1, -3]),
    ("sum", [X], (2, 3), [0, 0, 1, 5, 6]),
    ("sum", [X], (1, None), [0, 1, 5, 7, 4]),
    ("sum", [[inf, 1, -inf, 1]], (0, 1), [inf, inf, -inf, -inf]),
    ("sum", [[inf, 1, -inf, 1]], (0, 2), [inf, inf, nan, -inf]),
    # blocks of three: (1, -1e16, 1e16), (1, 1, ...); a window is the end of one, backwards, and the begin of the next
    ("sum", [[1, -1e16, 1e16, 1, 1]], (0, 2), [1, -1e16, 0, 1, 1e16 + 2]),
    ("mean", [X], (0, 1), [1, 2.5, 3, -0.5, -1.5]),
    ("mean", [X], (2, 3), [1, 1, 1, 2.5, 3]),
    ("mean", [X], (0, None), [1, 2.5, 7 / 3, 1, 0.8]),
    ("mean", [X, Y], (2, 3), [-1, 2, 1, 2.5, 3]),
    ("mean", [X, Y], (0, 1), [1, 2.5, 3, -0.5, -1.5]),
    ("duration", [[inf, inf, -inf, inf, inf]], (0, 2, Fraction(1, 10)), [0.1, 0.2, 0.2, 0.2, 0.2]),
    ("duration", [[inf, inf, -inf, inf, inf]], (1, None), [0, 1, 2, 2, 3]),
    ("count", [[inf, inf, -inf, inf, -inf]], (0, 2), [1, 1, 1, 1, 1]),
    ("count", [[inf, -inf, inf, -inf, inf]], (1, None), [0, 1, 1, 2, 2]),
    ("count", [[-inf, inf, inf, inf, inf]], (0, 1), [0, 1, 1, 0, 0]),
    ("integral", [X], (0, 1, Fraction(1, 10)), [0.1, 0.5, 0.6, -0.1, -0.3]),
    ("integral", [X], (1, None, Fraction(1, 2)), [0, 0.5, 2.5, 3.5, 2]),
    ("integral", [X], (0, 0), X),
    ("prev", [X], (), [inf, 1, 4, 2, -3]),
    ("next", [X], (), [4, 2, -3, 0, inf]),
    ("s_prev", [X], (), [-inf, 1, 4, 2, -3]),
    ("s_next", [X], (), [4, 2, -3, 0, -inf]),
    ("rise", [X], (), [1, -1, -4, -3, 0]),
    ("fall", [X], (), [-1, -4, -2, 2, -3]),
    # until at sample 0: max(-1, min(2, 1), min(5, 1, 4))
    ("until", [X, Y], (0, 2), [1, 4, 5, 0, 1]),
    ("until", [X, Y], (1, 1), [1, 4, 0, -3, -inf]),
    ("until", [X, Y], (2, None), [1, 0, -3, -inf, -inf]),
    ("until", [X, Y], (5, 6), [-inf] * 5),
    # since at sample 3: max(0, min(5, -3), min(2, -3, 2), ...)
    ("since", [X, Y], (0, 2), [-1, 2, 5, 0, 1]),
    ("since", [X, Y], (1, 1), [-inf, -1, 2, -3, 0]),
    ("since", [X, Y], (2, None), [-inf, -inf, -1, -3, -3]),
    ("since", [X, Y], (5, 6), [-inf] * 5),
    # precedes at sample 2: from sample 1, max(min(2, inf), min(5, 4)); cut at sample 0 before that
    ("precedes", [X, Y], (0, 1), [-1, 1, 4, 5, 0]),
    ("precedes", [X, Y], (1, 1), [-1, 1, 4, 0, -3]),
    ("precedes", [X, Y], (0, 0), Y),
    ("precedes", [X, Y], (1, 3), [-1, 1, 1, 1, 4]),
    ("unless", [X, Y], (1, 1), [1, 4, 0, -3, 0]),
    ("unless", [X, Y], (5, 9), [-3, -3, -3, -3, 0]),
    ("unless", [X, Y], (0, None), [1, 4, 5, 0, 1]),
]


@pytest.mark.parametrize(("name", "operands", "bounds", "expected"), CASES)
def test_worked_values(name, operands, bounds, expected):
    arguments = [operands] if isinstance(operands, int) else [np.array(o, float) for o in operands]
    np.testing.assert_array_equal(STL[name].definition(*arguments, *bounds), expected)


def test_every_operator_has_a_worked_value():
    assert {case[0] for case in CASES} == {op.name for op in STL}


def test_the_rate_is_a_change_a_second():
    rate = STL["rate"](Var("x"), interval=Interval(Fraction(1, 2), Fraction(1, 2)))
    values = evaluate(rate, {"x": np.array(X)}, len(X), Fraction(1, 4))
    assert values.tolist() == [0, 6, 2, -14, -4]


def test_truth_of_predicates():
    x, y = np.array([1.0, 2.0, 3.0, inf]), np.array([2.0, 2.0, 2.0, inf])
    assert p.holds_gt(x, y).tolist() == [-inf, -inf, inf, -inf]
    assert p.holds_ge(x, y).tolist() == [-inf, inf, inf, inf]
    assert p.holds_eq(x, y).tolist() == [-inf, inf, -inf, inf]


@pytest.mark.parametrize("op", [pytest.param(op, id=op.name) for op in STL])
@pytest.mark.parametrize("n", [0, 1, 2])
def test_short_traces_give_new_arrays_and_leave_the_operands_alone(op, n):
    operands = [np.full(n, k + 1.0) for k, _ in enumerate(op.operands)]
    bounds = () if op.bounds is Bounds.NONE else (1, 1, 1, inf) if op.share else (1, 1)
    result = op.definition(*(operands or [n]), *bounds)
    assert result.shape == (n,)
    assert result.dtype == np.float64
    for k, operand in enumerate(operands):
        assert result is not operand
        assert not np.shares_memory(result, operand)
        assert (operand == k + 1.0).all()


# ---- two operands in time: the definition word for word -----------------------------------------


def until_verbatim(x, y, t, a, b):
    n = len(x)
    return max(
        (
            min(y[u], min((x[v] for v in range(n) if t <= v < u), default=inf))
            for u in range(n)
            if t + a <= u <= t + b
        ),
        default=-inf,
    )


def since_verbatim(x, y, t, a, b):
    n = len(x)
    return max(
        (
            min(y[u], min((x[v] for v in range(n) if u < v <= t), default=inf))
            for u in range(n)
            if t - b <= u <= t - a
        ),
        default=-inf,
    )


def precedes_verbatim(x, y, t, a, b):
    n = len(x)
    return max(
        (
            min(y[u], min((x[v] for v in range(n) if t - b <= v < u), default=inf))
            for u in range(n)
            if t - b + a <= u <= t
        ),
        default=-inf,
    )


SIGNALS = st.lists(st.tuples(st.integers(-4, 4), st.integers(-4, 4)), min_size=1, max_size=12)


@pytest.mark.parametrize(
    ("definition", "verbatim"),
    [(d.until, until_verbatim), (d.since, since_verbatim), (d.precedes, precedes_verbatim)],
)
@given(signals=SIGNALS, a=st.integers(0, 4), length=st.integers(0, 4), bounded=st.booleans())
def test_operators_of_two_operands_in_time_are_their_formula(
    definition, verbatim, signals, a, length, bounded
):
    x, y = np.array(signals, float).T
    b = a + length if bounded or definition is d.precedes else None
    expected = [verbatim(x, y, t, a, inf if b is None else b) for t in range(len(x))]
    assert definition(x, y, a, b).tolist() == expected


# ---- the worked values of the definition that are discrete --------------------------------------


def interval(begin, end):
    return Interval(Fraction(begin), None if end is None else Fraction(end))


def values(formula, **columns):
    arrays = {name: np.array(column, float) for name, column in columns.items()}
    return evaluate(formula, arrays, len(next(iter(arrays.values()))), Fraction(1)).tolist()


def test_until_does_not_ask_for_its_first_operand_where_the_second_holds():
    assert values(STL["until"](Var("x"), Var("y")), x=[-1] * 4, y=[3] * 4) == [3, 3, 3, 3]


def test_equal_sub_formulas_are_never_one_state_stepped_twice():
    positive = STL["gt"](Var("x"), Const(0.0))
    once = STL["once"](positive, interval=interval(2, 2))
    assert values(STL["or"](once, once), x=[1, 2, 3, 4, 5]) == [-inf, -inf, 1, 2, 3]


def test_past_over_future_reads_nothing_from_before_the_trace():
    inner = STL["eventually"](Var("x"), interval=interval(0, 2))
    assert values(STL["historically"](inner), x=[0, 0, 5, 5, 5, 5, 5]) == [5] * 7


NUMBERS = [pytest.param(op, id=op.name) for op in STL if op.result is Sort.NUMBER and op.tense is Tense.NONE]


@pytest.mark.parametrize("op", NUMBERS)
@settings(max_examples=50)
@given(data=st.data())
def test_arithmetic_is_that_of_the_c_library_and_silent(op, data):
    number = st.sampled_from((0.0, -0.0, 1.0, -1.0, 0.5, -2.0, 3.0, 710.0, 1e308, -1e308, 5e-324, inf, -inf))
    operands = [np.array([data.draw(number)]) for _ in op.operands]
    with np.errstate(all="raise"):
        together = op.definition(*operands)
        apart = op.definition(*(np.repeat(o, 9) for o in operands))
    # One at a time or many at once: the same bits, whatever vector unit there is.
    np.testing.assert_array_equal(apart, np.repeat(together, 9))


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(
    "divisor", ["min(x, y)", "max(y, x)", "once(x) * y", "always(y) - x", "x until y", "-x * y"]
)
@pytest.mark.parametrize("function", ["1 / ({})", "pow({}, -1)"])
def test_the_sign_of_a_zero_does_not_decide_between_plus_and_minus_infinity(
    function: str, divisor: str, backend: str
) -> None:
    spec = rtamt.parse(f"({function.format(divisor)}) >= 0", backend=backend)
    x, y = [0.0, -0.0, 0.0, -0.0], [-0.0, 0.0, 0.0, -0.0]
    discrete = spec.evaluate({"time": [0, 1, 2, 3], "x": x, "y": y}).signal
    assert discrete.values.tolist() == [inf] * 4
    for first in range(4):
        dense = spec.evaluate({"x": ([0.0], x[first:][:1]), "y": ([0.0], y[first:][:1])}, time="dense")
        assert dense.robustness == inf
