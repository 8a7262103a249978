"""Values of formulas in dense time, worked out by hand; the evaluator's and its monitor's own behaviour."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from numpy import inf

from rtamt.errors import EvaluationError, SpecificationError, UsageError
from rtamt.language.definitions import dense
from rtamt.language.definitions.dense import Steps
from rtamt.language.formula import Interval, Var
from rtamt.language.operators import STL, Bounds, Operator, Sort, Tense
from rtamt.language.parsing.parser import parse_formula
from rtamt.reference.dense_robustness import DenseReferenceMonitor, evaluate

ONE = Fraction(1)
TENTH = Fraction(1, 10)


def signal(text: str, unit: int = 1):
    """Read "0@0 6@2" as the value 0 from time 0 and 6 from time 2; a time has ``unit`` ticks."""
    pairs = [event.split("@") for event in text.split()]
    times = [Fraction(time) * unit for _, time in pairs]
    assert all(time.denominator == 1 for time in times)
    return [int(time) for time in times], [float(value) for value, _ in pairs]


def events(times, values, unit: int = 1) -> str:
    """Write the inverse of :func:`signal`."""
    return " ".join(f"{value:g}@{int(time) / unit:g}" for time, value in zip(times, values, strict=True))


def value(text: str, unit: int = 1, **signals: str) -> str:
    formula = parse_formula(text)
    got = evaluate(formula, {name: signal(said, unit) for name, said in signals.items()}, Fraction(1, unit))
    assert got.times.dtype == np.int64
    assert got.values.dtype == np.float64
    return events(*got, unit)


# ---- values -------------------------------------------------------------------------------------


def test_listing_1_of_the_paper():
    req, gnt = "0@0 6@2 0@4 0@10", "0@0 6@6 0@8 0@10"
    # Every request of [2, 4) is granted within 5: at 6. Without a request, -(0 - 3) = 3.
    assert value("G((req>=3)->(F[0,5](gnt>=3)))", req=req, gnt=gnt) == "3@0"
    assert value("F[0,5](gnt>=3)", req=req, gnt=gnt) == "-3@0 3@1 -3@8"
    assert value("G((req>=3)->(F[0,2](gnt>=3)))", req=req, gnt=gnt) == "-3@0 3@4"


LISTING_2 = "H[0,10]((O[5,5](req>=3))->(O[0,5](gnt>=3)))"


def test_listing_2_of_the_paper_is_3_from_5_on():
    req, gnt = "0@0 6@2 0@4 0@10", "0@0 6@5 0@8 0@10"
    assert value(LISTING_2, req=req, gnt=gnt) == "inf@0 3@5"


def test_listing_2_in_two_chunks_keeps_the_segment_at_the_end_of_a_chunk():
    monitor = DenseReferenceMonitor([parse_formula(LISTING_2)], ("req", "gnt"), ONE)
    (first,) = monitor.push({"req": signal("0@0 6@2"), "gnt": signal("0@0 6@5")})
    (second,) = monitor.push({"req": signal("0@4 0@10"), "gnt": signal("0@8 0@10")})
    (rest,) = monitor.finish()
    assert (events(*first[:2]), first.until) == ("inf@0", 2)
    assert (events(*second[:2]), second.until) == ("3@5", 10)
    assert (events(*rest[:2]), rest.until) == ("", 10)


def test_until_does_not_ask_for_its_first_operand_when_the_second_comes():
    assert value("x until y", x="-1@0", y="3@0") == "3@0"
    assert value("(h < 0.5) until[0:1] (h >= 0.5)", 2, h="0@0 1@0.5") == "0.5@0"


@pytest.mark.parametrize(
    ("text", "x", "expected"),
    [
        ("once[0:0] x", "1@0 2@3", "1@0 2@3"),
        ("once[0:2] x", "0@0 6@2 0@3 0@9", "0@0 6@2 0@5"),
        ("once[1:2] x", "0@0 6@2 0@3 0@9", "-inf@0 0@1 6@3 0@5"),
        ("once[2:2] x", "0@0 6@2 0@3 0@9", "-inf@0 0@2 6@4 0@5"),
        ("once x", "1@0 6@2 0@3", "1@0 6@2"),
        ("once[2:inf] x", "1@0 6@2 0@3 0@9", "-inf@0 1@2 6@4"),
        ("once[9:9] x", "1@0 0@8", "-inf@0"),
        ("historically[0:2] x", "6@0 0@2 6@3 6@9", "6@0 0@2 6@5"),
        ("historically[1:1] x", "6@0 0@2 6@3 6@9", "inf@0 6@1 0@3 6@4"),
        ("eventually[0:2] x", "0@0 6@5 0@6 0@9", "0@0 6@3 0@6"),
        ("eventually[1:2] x", "0@0 6@5 0@6 0@9", "0@0 6@3 0@5"),
        ("eventually[3:3] x", "0@0 6@5 0@6 0@9", "0@0 6@2 0@3"),
        ("eventually x", "0@0 6@5 0@6 0@9", "6@0 0@6"),
        ("always[1:2] x", "6@0 0@5 6@6 6@9", "6@0 0@3 6@5"),
        ("always[4:inf] x", "6@0 0@5 6@6 6@9", "0@0 6@2"),
        ("always[0:100] x", "6@0 0@5", "0@0"),  # the last value holds for ever
        ("eventually[100:200] x", "6@0 1@5", "1@0"),
        # A pulse of one tick, at the first instant as if the operand had not held, or had held, before.
        ("rise(x >= 1)", "3@0 -1@4 2@6 2@9", "2@0 -2@1 1@6 -1@7"),
        ("rise(x >= 1)", "-1@0 2@6 -1@7 2@8 2@9", "-2@0 1@6 -2@7 1@8 -1@9"),
        ("fall(x >= 1)", "3@0 -1@4 2@6 2@9", "-2@0 2@4 -2@5 -1@7"),
        ("fall(x >= 1)", "-1@0 2@6 2@9", "2@0 -2@1 -1@7"),
        # From the instant at which it becomes true until b and a tick later; at the start as rise.
        ("count[0:3](x >= 1)", "0@0 2@2 0@4 2@5 0@8 0@20", "0@0 1@2 2@5 1@6 0@9"),
        ("count[1:3](x >= 1)", "2@0 0@1 0@20", "0@0 1@1 0@4"),
        ("count[2:2](x >= 1)", "0@0 2@3 5@4 2@9 0@20", "0@0 1@5 0@6"),
        ("count[0:0](x >= 1)", "0@0 2@3 0@9", "0@0 1@3 0@4"),
        ("count(x >= 1)", "2@0 0@2 2@4 0@6 2@8 0@20", "1@0 2@4 3@8"),
        ("count[3:inf](x >= 1)", "2@0 0@2 2@4 0@6 0@20", "0@0 1@3 2@7"),
        ("x - 1 > 0 or -x >= 2", "0@0 -5@2 4@3", "-1@0 3@2"),
        ("x == 1", "1@0 3@1 -1@2", "-0@0 -2@1"),
        ("true", "1@2 2@3", "inf@2"),
        ("2.5", "1@2 2@3", "2.5@2"),
        ("x", "1@0 1@1 2@2 2@3 1@4", "1@0 2@2 1@4"),
    ],
)
def test_values_over_one_signal(text, x, expected):
    assert value(text, x=x) == expected


@pytest.mark.parametrize(
    ("text", "x", "y", "expected"),
    [
        # ψ is a pulse of one tick; φ may already have failed when it comes.
        ("x until[0:2] y", "1@0 -1@5", "-2@0 3@5 -2@6 -2@9", "-2@0 1@3 3@5 -2@6"),
        ("x until y", "1@0 -1@5", "-2@0 3@5 -2@6 -2@9", "1@0 3@5 -2@6"),
        ("x until[1:2] y", "2@0", "-2@0 3@5 -2@6 -2@9", "-2@0 2@3 -2@5"),
        ("x until[0:0] y", "1@0 -1@5", "-2@0 3@5", "-2@0 3@5"),
        # The value at 4 itself is 1, as φ holds on [4, 5); at every later instant it fails before t + 1.
        ("x until[1:1] y", "1@0 -1@5", "3@0 3@9", "1@0 -1@4"),
        # ψ within [t-b, t-a] and φ ever after, the rest of the segment of ψ included.
        ("x since[0:2] y", "1@0", "-2@0 3@2 -2@3 -2@9", "-2@0 3@2 1@3 -2@5"),
        ("x since y", "1@0 -5@6 1@7", "-2@0 3@2 -2@3 -2@9", "-2@0 3@2 1@3 -2@6"),
        ("x since[1:1] y", "1@0 -5@2", "3@0 3@9", "-inf@0 1@1 -5@2"),
        ("x since[0:9] y", "-1@0", "3@0 -2@4", "3@0 -1@4"),
        ("x since[0:9] y", "-1@0 1@4", "3@0 -2@4 -2@9", "3@0 -1@4"),
        ("x precedes[0:2] y", "1@0 -1@5", "-2@0 3@5 -2@6 -2@9", "-2@0 1@5 3@7 -2@8"),
        # At 0 itself nothing comes before t' = 0: the value there is 3, and at every later instant 1.
        ("x precedes[1:1] y", "1@0 -1@5", "3@0 3@9", "1@0 -1@5"),
        ("x unless[0:2] y", "1@0 -1@5 -1@9", "-2@0", "1@0 -1@3"),
        ("x unless[1:2] y", "1@0 -1@5 -1@9", "-2@0 3@4 -2@6", "1@0 -1@4"),
        ("x unless y", "1@0 -1@5 -1@9", "-2@0 3@4 -2@6", "1@0 3@4 -1@6"),
    ],
)
def test_values_over_two_signals(text, x, y, expected):
    assert value(text, x=x, y=y) == expected


def test_signals_start_at_the_latest_first_time_and_end_at_the_latest_last():
    assert value("x + y", x="1@0 2@4", y="10@3 20@9") == "11@3 12@4 22@9"
    assert value("once x", x="9@0 1@2", y="0@3 0@4") == "1@3"
    assert value("x + y", x="1@0 2@1", y="10@3") == "12@3"


def test_bounds_that_are_decimals_leave_no_sliver():
    assert value("once[0.1:0.2] x", 10, x="1@0 0@0.1 0@0.9") == "-inf@0 1@0.1 0@0.3"
    assert (
        value("x -> eventually[0.3:0.3] y", 10, x="-1@0 5@0.1 -1@0.2", y="-1@0 5@0.4 -1@0.5")
        == "1@0 5@0.1 1@0.2"
    )


def test_stamps_of_a_billion_seconds_in_nanoseconds_are_exact():
    origin = 10**18
    x = [origin, origin + 1, origin + 2], [0.0, 6.0, 0.0]
    times, values = evaluate(parse_formula("once[1ns:1ns] x"), {"x": x}, Fraction(1, 10**9))
    assert [int(t) - origin for t in times] == [0, 1, 2]
    assert values.tolist() == [-inf, 0.0, 6.0]


def test_a_point_like_window_at_the_end_of_int64_does_not_overflow():
    last = 2**63 - 1
    times, values = evaluate(parse_formula("eventually[9s:9s] x"), {"x": ([0, last], [1.0, 2.0])}, ONE)
    assert times.tolist() == [0, last - 9]
    assert values.tolist() == [1.0, 2.0]


def test_an_operator_has_a_dense_meaning_exactly_where_it_reads_other_instants():
    assert {op.name for op in STL if op.dense} == {
        op.name for op in STL if op.tense is not Tense.NONE and not op.discrete_only
    }


def test_the_instant_at_which_phi_falls_exactly_a_later_takes_the_value_that_follows():
    x, y = Steps((0, 20), (1.0, -1.0)), Steps((0,), (3.0,))
    assert [dense.until(t, x, y, 4, 4) for t in (14, 16, 18)] == [1.0, 1.0, -1.0]
    assert dense.lifted(dense.until, (x, y), 4, 4) == Steps((0, 16), (1.0, -1.0))


def test_zeros_of_both_signs_are_one_value():
    assert dense.merged((0, 4, 8), (0.0, -0.0, -0.0)) == Steps((0,), (0.0,))
    assert value("1 / x", x="0@0 -0@1") == "inf@0"
    assert value("x", x="0@0 -0@1") == "0@0"


# ---- errors -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "x", "y", "message"),
    [
        (
            "sqrt(x) >= 1",
            "4@0 -1@0.3 1@0.4",
            "0@0",
            "'sqrt(x)' has no value at time 0.3 s: it is 0/0, inf - inf, 0 * inf, "
            "or a function outside its domain; "
            "change the formula or the data so that this cannot happen",
        ),
        (
            "always[0:1](x / y)",
            "1@0 0@2.5",
            "1@0 0@1.5",
            "'x / y' has no value at time 2.5 s: it is 0/0, inf - inf, 0 * inf, "
            "or a function outside its domain; "
            "change the formula or the data so that this cannot happen",
        ),
        (  # after the last sample, where the future operator still looks
            "eventually[0:2](x / (once[0:1] y))",
            "0@0 0@5",
            "1@0 0@4.5",
            "'x / (once[0:1] y)' has no value at time 5.5 s: it is 0/0, inf - inf, 0 * inf, "
            "or a function outside its domain; "
            "change the formula or the data so that this cannot happen",
        ),
    ],
)
def test_a_sub_formula_without_a_value_is_named_with_its_time(text, x, y, message):
    with pytest.raises(EvaluationError) as caught:
        value(text, 10, x=x, y=y)
    assert str(caught.value) == message


def test_what_has_no_value_after_everything_that_is_asked_for_is_no_error():
    assert value("x / (once[0:1] y)", 10, x="0@0 0@5", y="1@0 0@4.5") == "0@0"
    assert value("eventually[0:0.4](x / (once[0:1] y))", 10, x="0@0 0@5", y="1@0 0@4.5") == "0@0"


def test_an_operator_of_samples_has_no_meaning_in_dense_time():
    with pytest.raises(SpecificationError) as caught:
        evaluate(parse_formula("prev x"), {"x": signal("1@0")}, ONE)
    assert str(caught.value) == (
        "'prev' means one sample away, which dense time does not have; "
        "use a window such as once[0:1], or discrete time"
    )


# ---- a user's operators -------------------------------------------------------------------------


def user_operator(**more):
    base = Operator(
        "lately",
        ("lately",),
        STL["once"].fixity,
        75,
        (Sort.FORMULA,),
        Sort.FORMULA,
        "Within the last two seconds.",
        "lately x",
        "",
        STL["once"].definition,
        tense=Tense.PAST,
    )
    return replace(base, **more)


def test_a_users_operator_in_time_means_what_its_expansion_means():
    lately = user_operator(
        expansion=lambda a, _i: STL["once"](a, interval=Interval(Fraction(0), Fraction(2)))
    )
    outer = user_operator(name="outer", expansion=lambda a, _i: STL["not"](lately(a)))
    trace = {"x": signal("0@0 6@2 0@3 0@9")}
    assert events(*evaluate(STL["not"](lately(Var("x"))), trace, ONE)) == "-0@0 -6@2 -0@5"
    assert events(*evaluate(outer(Var("x")), trace, ONE)) == "-0@0 -6@2 -0@5"


def test_a_users_operator_in_time_may_have_a_dense_definition():
    lately = user_operator(dense=dense.once, bounds=Bounds.OPTIONAL)
    formula = lately(Var("x"), interval=Interval(Fraction(0), Fraction(2)))
    assert events(*evaluate(formula, {"x": signal("0@0 6@2 0@3 0@9")}, ONE)) == "0@0 6@2 0@5"


def test_a_users_operator_in_time_without_a_dense_meaning_is_an_error():
    with pytest.raises(UsageError) as caught:
        evaluate(user_operator()(Var("x")), {"x": signal("0@0")}, ONE)
    assert str(caught.value) == (
        "'lately' has no meaning in dense time; give its record a dense definition (dense=...) or an expansion, "
        "or use discrete time"
    )


def test_a_users_function_that_returns_the_wrong_shape_is_an_error():
    total = user_operator(name="total", tense=Tense.NONE, definition=lambda x: x.sum())
    with pytest.raises(UsageError) as caught:
        evaluate(total(Var("x")), {"x": signal("0@0 1@1")}, ONE)
    assert str(caught.value) == (
        "the definition of 'total' returned an array of shape () for 2 instants; "
        "it must return one value an instant, shape (2,)"
    )


# ---- online -------------------------------------------------------------------------------------


def points_of(known):
    return [(events(*news[:2]), news.until) for news in known]


def test_a_value_is_known_as_far_as_the_slowest_variable_less_the_horizon():
    formulas = [parse_formula("x + y"), parse_formula("eventually[0:2] x"), parse_formula("true")]
    monitor = DenseReferenceMonitor(formulas, ("x", "y"), ONE)
    nothing = [("", None)] * 3
    assert points_of(monitor.push({})) == nothing
    assert points_of(monitor.push({"x": signal("1@0 2@3 5@9")})) == nothing
    assert points_of(monitor.push({"y": signal("10@2")})) == [("11@2", 2), ("", None), ("inf@2", 2)]
    assert points_of(monitor.push({"y": signal("20@4")})) == [("12@3 22@4", 4), ("2@2", 2), ("", 4)]
    assert points_of(monitor.push({"y": ([], [])})) == [("", 4), ("", 2), ("", 4)]
    assert points_of(monitor.push({"y": signal("20@8")})) == [("", 8), ("", 6), ("", 8)]
    assert points_of(monitor.finish()) == [("25@9", 9), ("5@7", 9), ("", 9)]
    assert points_of(monitor.finish()) == [("", 9), ("", 9), ("", 9)]


def test_a_variable_that_starts_after_the_others_have_ended_is_waited_for():
    monitor = DenseReferenceMonitor([parse_formula("x + y")], ("x", "y"), ONE)
    assert points_of(monitor.push({"x": signal("1@0 2@1"), "y": signal("10@5 20@6")})) == [("", None)]
    assert points_of(monitor.finish()) == [("12@5 22@6", 6)]


def test_a_trace_in_which_a_variable_never_appears_has_no_values():
    monitor = DenseReferenceMonitor([parse_formula("x")], ("x", "y"), ONE)
    monitor.push({"x": signal("1@0 2@1")})
    assert points_of(monitor.finish()) == [("", None)]


def test_a_finished_monitor_takes_no_more_until_it_is_reset():
    monitor = DenseReferenceMonitor([parse_formula("x")], ("x",), ONE)
    monitor.push({"x": signal("1@0 2@1")})
    assert monitor.state_bytes == 32
    monitor.finish()
    with pytest.raises(UsageError) as caught:
        monitor.push({"x": signal("1@2")})
    assert str(caught.value) == (
        "the trace is finished and takes no more samples; call reset() to begin a new one"
    )
    monitor.reset()
    assert monitor.state_bytes == 0
    assert points_of(monitor.push({"x": signal("7@0")})) == [("7@0", 0)]


def test_a_push_that_has_no_value_leaves_the_monitor_as_it_was():
    monitor = DenseReferenceMonitor([parse_formula("x"), parse_formula("sqrt(x)")], ("x",), ONE)
    monitor.push({"x": signal("4@0")})
    with pytest.raises(EvaluationError) as caught:
        monitor.push({"x": signal("9@1 -1@2")})
    assert str(caught.value) == (
        "'sqrt(x)' has no value at time 2 s: it is 0/0, inf - inf, 0 * inf, or a function outside its domain; "
        "change the formula or the data so that this cannot happen"
    )
    assert points_of(monitor.push({"x": signal("9@1")})) == [("9@1", 1), ("3@1", 1)]


def test_what_has_no_value_only_until_more_is_known_is_no_error():
    # While y lags behind, its last value is not yet its value.
    monitor = DenseReferenceMonitor([parse_formula("x / y")], ("x", "y"), ONE)
    assert points_of(monitor.push({"x": signal("1@0 0@2"), "y": signal("0@0")})) == [("inf@0", 0)]
    assert points_of(monitor.push({"y": signal("4@1 5@3")})) == [("0.25@1 0@2", 2)]
