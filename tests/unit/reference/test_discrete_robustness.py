"""The evaluator of definitions and its online monitor: errors in full, what is kept, other languages."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from numpy import inf

from rtamt.errors import EvaluationError, UsageError
from rtamt.language.formula import Const, Interval, Var
from rtamt.language.operators import STL, Fixity, Operator, Sort, Tense
from rtamt.reference.discrete_robustness import ReferenceMonitor, evaluate, evaluate_all, history

ONE = Fraction(1)
TENTH = Fraction(1, 10)
X, Y = Var("x"), Var("y")


def window(begin, end):
    return Interval(Fraction(begin), None if end is None else Fraction(end))


def array(*values):
    return np.array(values, float)


# ---- sub-formulas without a value ---------------------------------------------------------------


@pytest.mark.parametrize(
    ("formula", "columns", "start", "message"),
    [
        (
            STL["ge"](STL["sqrt"](X), Const(1.0)),
            {"x": array(4, 1, 0, -1)},
            0.0,
            "'sqrt(x)' has no value at sample 3, time 0.3 s: it is 0/0, inf - inf, 0 * inf, "
            "or a function outside its domain; "
            "change the formula or the data so that this cannot happen",
        ),
        (
            STL["always"](STL["div"](X, Y), interval=window(0, 1)),
            {"x": array(1, 0), "y": array(0, 0)},
            2.5,
            "'x / y' has no value at sample 1, time 2.6 s: it is 0/0, inf - inf, 0 * inf, "
            "or a function outside its domain; "
            "change the formula or the data so that this cannot happen",
        ),
        (
            STL["ge"](X, Y),
            {"x": array(inf), "y": array(inf)},
            1.0,
            "'x >= y' has no value at sample 0, time 1 s: it is 0/0, inf - inf, 0 * inf, "
            "or a function outside its domain; "
            "change the formula or the data so that this cannot happen",
        ),
        (
            STL["not"](STL["pow"](X, Const(0.5))),
            {"x": array(0.25, -0.25)},
            0.0,
            "'pow(x, 0.5)' has no value at sample 1, time 0.1 s: it is 0/0, inf - inf, 0 * inf, "
            "or a function outside its domain; "
            "change the formula or the data so that this cannot happen",
        ),
    ],
)
def test_an_operation_without_a_value_is_an_error_that_names_it(formula, columns, start, message):
    n = len(columns["x"])
    with pytest.raises(EvaluationError) as error:
        evaluate(formula, columns, n, TENTH, start)
    assert str(error.value) == message
    with pytest.raises(EvaluationError) as error:
        evaluate_all(formula, columns, n, TENTH, start)
    assert str(error.value) == message


def monitor_of(formula, horizon, behind, start=0.0, inputs=("x",)):
    return ReferenceMonitor([formula], inputs, TENTH, [horizon], behind, start)


def test_online_the_index_and_time_are_those_of_the_whole_trace():
    monitor = monitor_of(STL["sqrt"](X), 0, 0, start=7.0)
    monitor.push([array(*range(12))])
    with pytest.raises(EvaluationError) as error:
        monitor.push([array(1, -4)])
    assert str(error.value) == (
        "'sqrt(x)' has no value at sample 13, time 8.3 s: it is 0/0, inf - inf, 0 * inf, "
        "or a function outside its domain; "
        "change the formula or the data so that this cannot happen"
    )
    assert monitor.samples == 12
    assert monitor.push([array(9)])[0].tolist() == [3]


def test_what_is_not_known_yet_is_no_error():
    # At the last sample so far both windows are empty, and -inf - -inf has no value; it is not known there.
    ahead = STL["eventually"](X, interval=window(TENTH, TENTH))
    monitor = monitor_of(STL["sub"](ahead, ahead), 1, 0)
    assert monitor.push([array(1, 2, 3)])[0].tolist() == [0, 0]
    with pytest.raises(EvaluationError) as error:
        monitor.finish()
    assert str(error.value) == (
        "'(eventually[0.1:0.1] x) - (eventually[0.1:0.1] x)' has no value at sample 2, time 0.2 s: "
        "it is 0/0, inf - inf, 0 * inf, or a function outside its domain; "
        "change the formula or the data so that this cannot happen"
    )
    assert monitor.push([array(4)])[0].tolist() == [0]


def test_what_the_stretch_forgot_is_no_error():
    # prev is infinite where the kept stretch begins, and inf · 0 has no value; in the whole trace it is 1.
    monitor = monitor_of(STL["mul"](STL["prev"](X), Y), 0, 1, inputs=("x", "y"))
    told = [monitor.push([array(1), array(y)])[0].tolist() for y in (1, 0, 0, 0)]
    assert told == [[inf], [0], [0], [0]]


# ---- the monitor --------------------------------------------------------------------------------


def test_a_finished_monitor_refuses_samples_until_it_is_reset():
    monitor = monitor_of(STL["next"](X), 1, 0)
    assert monitor.push([array(1, 2)])[0].tolist() == [2]
    assert monitor.finish()[0].tolist() == [inf]
    assert monitor.finish()[0].tolist() == []
    with pytest.raises(UsageError) as error:
        monitor.push([array(3)])
    assert str(error.value) == (
        "the trace is finished and takes no more samples; call reset() to begin a new one"
    )
    monitor.reset()
    assert monitor.samples == 0
    assert monitor.push([array(5, 6, 7)])[0].tolist() == [6, 7]


def test_an_empty_trace_has_no_values():
    monitor = monitor_of(STL["once"](X), 0, None)
    assert monitor.push([array()])[0].tolist() == []
    assert monitor.finish()[0].tolist() == []


@pytest.mark.parametrize(
    ("formula", "horizon", "kept"),
    [
        (X, 0, 0),
        (STL["once"](X, interval=window(ONE, 2 * ONE)), 0, 20),
        (STL["eventually"](STL["once"](X, interval=window(0, TENTH)), interval=window(0, TENTH)), 1, 2),
    ],
)
def test_with_a_bounded_past_only_what_is_needed_is_kept(formula, horizon, kept):
    monitor = monitor_of(formula, horizon, history(formula, TENTH))
    for _ in range(30):
        monitor.push([np.ones(7)])
    assert monitor.state_bytes == 8 * kept


def test_with_an_unbounded_past_the_whole_trace_is_kept():
    monitor = monitor_of(STL["once"](X), 0, None)
    for _ in range(30):
        monitor.push([np.ones(7)])
    assert monitor.state_bytes == 8 * 210


def test_several_outputs_each_have_their_own_horizon():
    outputs = [STL["next"](STL["next"](X)), STL["add"](X, Y), STL["s_next"](Y)]
    monitor = ReferenceMonitor(outputs, ("x", "y"), ONE, [2, 0, 1], 0)
    told = monitor.push([array(1, 2, 3), array(10, 20, 30)])
    assert [values.tolist() for values in told] == [[3], [11, 22, 33], [20, 30]]
    assert [values.tolist() for values in monitor.finish()] == [[inf, inf], [], [-inf]]


def test_nothing_told_is_the_callers_array():
    column = array(1, 2, 3)
    told = [evaluate(X, {"x": column}, 3, ONE), *monitor_of(X, 0, 0).push([column])]
    for values in told:
        assert values.tolist() == [1, 2, 3]
        values[:] = 0
    assert column.tolist() == [1, 2, 3]


# ---- histories ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        (X, 0),
        (STL["prev"](STL["rise"](X)), 2),
        (STL["once"](X, interval=window(1, 2)), 20),
        (
            STL["always"](
                STL["since"](X, STL["once"](Y, interval=window(0, 1)), interval=window(0, 3)),
                interval=window(0, 5),
            ),
            40,
        ),
        (STL["precedes"](STL["prev"](X), Y, interval=window(0, 3)), 31),
        (STL["next"](X), 0),
        (STL["eventually"](X), 0),
        (STL["and"](STL["prev"](X), STL["once"](Y)), None),
        (STL["since"](X, Y, interval=window(1, None)), None),
    ],
)
def test_history_in_samples(formula, expected):
    assert history(formula, TENTH) == expected


# ---- other languages ----------------------------------------------------------------------------

TWICE = Operator(
    "twice", ("twice",), Fixity.FUNCTION, 200, (Sort.NUMBER,), Sort.NUMBER, "Twice its operand.", "twice(x)",
    r"2{0}", definition=lambda x: 2 * x,
)  # fmt: skip
WAS = replace(
    TWICE,
    name="was",
    spellings=("was",),
    tense=Tense.PAST,
    reach=1,
    definition=lambda x: np.append(0.0, x[:-1]),
)
BROKEN = replace(TWICE, name="broken", spellings=("broken",), definition=lambda x: x[:1])


def test_an_operator_with_nothing_but_a_definition_is_evaluated_and_monitored():
    formula = STL["ge"](TWICE(WAS(X)), Const(1.0))
    assert evaluate(formula, {"x": array(1, 2, 3)}, 3, ONE).tolist() == [-1, 1, 3]
    monitor = monitor_of(formula, 0, history(formula, TENTH))
    assert [monitor.push([array(v)])[0].tolist() for v in (1, 2, 3)] == [[-1], [1], [3]]


def test_a_definition_that_returns_the_wrong_shape_is_refused():
    with pytest.raises(UsageError) as error:
        evaluate(BROKEN(X), {"x": array(1, 2, 3)}, 3, ONE)
    assert str(error.value) == (
        "the definition of 'broken' returned an array of shape (1,) for 3 samples; "
        "it must return one value a sample, shape (3,)"
    )


def test_a_conjunction_of_ten_thousand_terms_is_evaluated():
    formula = X
    for _ in range(10_000):
        formula = STL["and"](formula, Y)
    assert evaluate(formula, {"x": array(1), "y": array(2)}, 1, ONE).tolist() == [1]


def test_zeros_of_both_signs_are_one_divisor():
    one = Const(1.0)
    formula = STL["min"](STL["div"](one, Const(0.0)), STL["div"](one, Const(-0.0)))
    assert evaluate(formula, {}, 1, ONE).tolist() == [inf]
