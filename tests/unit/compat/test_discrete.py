"""The paper's API in discrete time: shapes, values and printing."""

from __future__ import annotations

import warnings
from math import inf

import numpy as np
import pytest

import rtamt
from tests.unit.compat import messages
from tests.unit.compat.messages import Inner, Message, declared, with_messages


def test_evaluate_gives_lists_of_floats():
    result = declared("x >= 2").evaluate({"time": np.array([0, 1]), "x": (3, 1)})
    assert result == [[0.0, 1.0], [1.0, -1.0]]
    assert {type(number) for row in result for number in row} == {float}


def test_evaluate_ignores_what_it_does_not_read():
    data = {"time": range(2), "x": [3, 1], "notes": ["good", None]}
    assert declared("x >= 2").evaluate(data) == [[0.0, 1.0], [1.0, -1.0]]


def test_evaluate_of_a_constant_and_of_one_sample():
    assert declared("out = 5").evaluate({"time": [0, 1]}) == [[0.0, 5.0], [1.0, 5.0]]
    assert declared("always(x)").evaluate({"time": [7], "x": [3]}) == [[7.0, 3.0]]


def test_evaluate_reads_fields_of_objects():
    spec = with_messages("always(req.value >= 1 and req.inner.level >= 0)")
    data = {"time": [0, 1], "req": [Message(3.0, inner=Inner(5.0)), Message(2.0, inner=Inner(0.5))]}
    assert spec.evaluate(data) == [[0.0, 0.5], [1.0, 0.5]]


def test_irregular_stamps_are_counted_and_evaluated_by_samples():
    spec = declared("once[0:1](x)")
    assert spec.evaluate({"time": [0, 1.05, 3], "x": [5, 1, 2]}) == [[0.0, 5.0], [1.05, 5.0], [3.0, 2.0]]
    assert spec.sampling_violation_counter == 1
    spec.evaluate({"time": [0, 1], "x": [5, 1]})
    assert spec.sampling_violation_counter == 0


def test_the_combined_class_does_both():
    spec = declared("once(x)")
    assert spec.update(0, [("x", 5)]) == 5.0
    assert spec.evaluate({"time": [0, 1], "x": [1, 2]}) == [[0.0, 1.0], [1.0, 2.0]]
    assert spec.get_value("x") == [1.0, 2.0]
    assert spec.update(1, [("x", 3)]) == 5.0
    assert spec.get_value("x") == 3.0


def test_values_by_name_by_canonical_text_and_by_any_text():
    spec = declared("low = x <= 3; once(prev(low) and not y)")
    assert (spec.get_value("x"), spec.get_value("out")) == (0.0, 0.0)
    spec.update(0, [("x", 1), ("y", 9)])
    spec.update(1, [("x", 5), ("y", -4)])
    for name, value in {
        "x": 5.0,
        "low": -2.0,
        "(x)<=(3.0)": -2.0,
        "x<=3": -2.0,
        "not(y)": 4.0,
        "prev(low) and not y": 2.0,
        "previous((x)<=(3.0))": 2.0,
        "out": 2.0,
        spec.spec_print(): 2.0,
        "3": 3.0,
    }.items():
        assert spec.get_value(name) == value, name


def test_a_part_that_the_result_can_do_without_has_a_value():
    spec = declared("once(x) precedes[0:0] y")
    assert [spec.update(t, [("x", x), ("y", 1)]) for t, x in enumerate([3, 5, 4])] == [1.0, 1.0, 1.0]
    assert spec.get_value("once(x)") == 5.0


def test_offline_values_are_lists():
    spec = declared("low = x <= 3; always(low)")
    spec.evaluate({"time": [0, 1], "x": [1, 5]})
    assert spec.get_value("x") == [1.0, 5.0]
    assert spec.get_value("low") == [2.0, -2.0]
    assert spec.get_value("out") == [-2.0, -2.0]


def test_spec_print_shows_what_is_monitored():
    spec = declared("eventually[0,1] (x >= y)")
    assert spec.spec_print() == "eventually[0,1]((x)>=(y))"
    spec.pastify()
    assert spec.spec_print() == "once[0,1]((x)>=(y))"


def test_a_delay_is_printed_in_the_unit_in_which_it_is_read_again():
    spec = rtamt.StlDiscreteTimeSpecification()
    spec.unit = "ms"
    spec.set_sampling_period(10, "ms")
    spec.spec = "next(x) and y"
    spec.parse()
    spec.pastify()
    assert spec.spec_print() == "(x)and(once[10ms,10ms](y))"
    spec.spec = spec.spec_print()
    spec.parse()
    assert [spec.update(10 * t, [("x", 9), ("y", y)]) for t, y in enumerate([3, 1, 2])] == [-inf, 3.0, 1.0]


def test_the_start_of_a_mean_is_printed_in_the_unit_in_which_it_is_read_again():
    spec = rtamt.StlDiscreteTimeSpecification()
    spec.unit = "h"
    spec.set_sampling_period(1, "h")
    spec.spec = "rise(mean[1:2](ahead[1](x)) >= 3)"
    spec.parse()
    spec.pastify()
    assert "rise(once[1h,1h](true))" in spec.spec_print()
    values = [spec.update(t, [("x", x)]) for t, x in enumerate([2, 0, 8, 1, 5])]
    printed = spec.spec_print()
    spec.spec = printed
    spec.parse()
    assert spec.spec_print() == printed
    assert [spec.update(t, [("x", x)]) for t, x in enumerate([2, 0, 8, 1, 5])] == values


def test_a_chain_that_rtamt_read_differently_is_warned_of_where_parse_is_called():
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        spec = declared("x >= 1 -> y >= 1 -> x >= 2")
    assert [str(w.message) for w in caught] == [
        "a chain without parentheses is read as 'x >= 1 -> y >= 1 -> x >= 2'; RTAMT read it as "
        "'(x >= 1 -> y >= 1) -> x >= 2': write the one that is meant"
    ]
    assert caught[0].filename == messages.__file__
    assert spec.evaluate({"time": [0], "x": [0], "y": [0]}) == [[0.0, 1.0]]


@pytest.mark.parametrize(
    ("text", "ours", "theirs"),
    [
        ("always(0 <= x <= 1)", "always(0 <= x and x <= 1)", "always((0 <= x) <= 1)"),
        ("0 < x < y < 2", "0 < x and x < y and y < 2", "((0 < x) < y) < 2"),
        (
            "x > 1 -> y > 1 -> 1 < x < 2",
            "x > 1 -> y > 1 -> 1 < x and x < 2",
            "(x > 1 -> y > 1) -> (1 < x) < 2",
        ),
    ],
)
def test_a_chain_of_comparisons_is_warned_of(text, ours, theirs):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        declared(text)
    assert [str(w.message) for w in caught] == [
        f"a chain without parentheses is read as '{ours}'; RTAMT read it as '{theirs}': write the one that is meant"
    ]


@pytest.mark.parametrize(
    "text",
    [
        "(x -> y) -> x",
        "x -> (y -> x)",
        "x and y and x",
        "x until y until x",
        "(x -> y) and (y -> x)",
        "0 < x and x < 1",
        "(0 < x) < 1",
        "z = x + y; 0 < z and z < 1",
    ],
)
def test_no_warning_where_nothing_is_ambiguous(text):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        spec = declared(text)
    assert spec.out_var == "out"


def test_infinite_values_are_legal():
    assert declared("x >= 1").update(0, [("x", inf)]) == inf
