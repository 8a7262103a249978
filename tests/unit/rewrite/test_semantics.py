"""Semantics and roles in the modern face: worked values, overrides, sub-formulas, verdicts."""

from __future__ import annotations

import pickle
from dataclasses import replace
from math import copysign, inf

import pytest

import rtamt
from rtamt.language.contents import variables
from rtamt.language.formula import Const
from rtamt.rewrite.semantics import SEMANTICS, Relative
from rtamt.rewrite.truth import truth

IA = ("output_robustness", "input_vacuity", "input_robustness", "output_vacuity")
ROLES = {"u": "input"}  # y is an output


def worth(text, data, roles=ROLES, **settings):
    """Return the value at the first sample under every interface-aware semantics."""
    read = rtamt.parse(text).input_names
    spec = rtamt.parse(text, roles={k: role for k, role in roles.items() if k in read}, **settings)
    data = {name: column for name, column in data.items() if name in (*read, "time")}
    return [spec.evaluate(data, semantics=name).robustness for name in IA]


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("u >= 3", [inf, 2, 2, 0]),  # u = 5, y = 4
        ("y >= 3", [1, 0, inf, 1]),
        ("u + y >= 3", [6, 0, 6, 0]),  # mixed: of both sides, so that neither alone is all it reads
        ("u - y < 0", [-1, 0, -1, 0]),
        ("3 >= 2", [inf, inf, inf, inf]),  # no variables: a subset of whatever is fixed
        ("2 > 3", [-inf, -inf, -inf, -inf]),
        ("3 > 3", [-inf, -inf, -inf, -inf]),
        ("true", [inf, inf, inf, inf]),
        ("u", [inf, 5, 5, 0]),  # a number is a predicate too
        ("u - y", [1, 0, 1, 0]),
        ("1", [inf, inf, inf, inf]),
        ("-1", [-inf, -inf, -inf, -inf]),
        ("(u >= 3) + y >= 2", [4, 0, 4, 0]),  # one predicate over u and y; in it, u >= 3 is the number 2
        ("(u >= 3) + 1 >= 2", [inf, 1, 1, 0]),
        ("min(u >= 3, y >= 3)", [1, 0, 1, 0]),
        ("(u >= 3) and (y >= 3)", [1, 0, 2, 0]),
        ("(u >= 3) -> (y >= 3)", [1, 0, inf, 1]),
        ("u == 5", [inf, 0, 0, 0]),
        ("u != 5", [-inf, 0, 0, 0]),
    ],
)
def test_worked_values(text, values, backend):
    assert worth(text, {"time": [0], "u": [5], "y": [4]}, backend=backend) == values


@pytest.mark.parametrize("semantics", SEMANTICS)
def test_standard_is_robustness_and_every_other_semantics_fixes_what_has_no_variables(semantics):
    expected = 1 if semantics == "standard" else inf
    assert rtamt.robustness("3 >= 2", {"time": [0]}, semantics=semantics) == expected


def test_a_variable_without_a_role_is_an_output():
    data = {"a": [5]}
    assert (
        worth("a >= 3", data, roles={}) == worth("output float a; a >= 3", data, roles={}) == [2, 0, inf, 2]
    )
    assert worth("input float a; a >= 3", data, roles={}) == [inf, 2, 2, 0]


def test_a_role_that_is_given_comes_before_one_that_is_declared():
    spec = rtamt.parse("output float a; a >= 3", roles={"a": "input"}, semantics="output_robustness")
    assert spec.evaluate({"a": [5]}).robustness == inf


def test_a_field_has_the_role_of_its_variable_unless_it_has_its_own():
    text = "req.level + req.grant >= 3"
    spec = rtamt.parse(text, roles={"req": "input"}, semantics="output_robustness")
    assert spec.evaluate({"req.level": [5], "req.grant": [1]}).robustness == inf
    spec = rtamt.parse(text, roles={"req": "input", "req.grant": "output"}, semantics="output_robustness")
    assert spec.evaluate({"req.level": [5], "req.grant": [1]}).robustness == 3


def test_names_with_dashes_and_members_of_the_papers_enumeration_are_names_too():
    for semantics in rtamt.Semantics:
        name = semantics.value.replace("-", "_")
        assert rtamt.parse("x", semantics=semantics).semantics == name
        assert rtamt.parse("x", semantics=semantics.value).semantics == name


def test_zero_robustness_has_a_verdict_online():
    for text, expected in (("x >= 3", inf), ("x > 3", -inf), ("x <= 3", inf), ("x < 3", -inf)):
        spec = rtamt.parse(text)
        assert spec.monitor().update(0, x=3) == 0
        assert spec.monitor(semantics="boolean").update(0, x=3) == expected
        assert spec.monitor(time="dense", semantics="boolean").update(0, x=3).values.tolist() == [expected]


def test_sub_formulas_are_under_the_semantics_of_the_evaluation_and_numbers_are_numbers():
    text = "input float u; output float y; asked = u >= 3; sum = u + y; always(asked -> y >= 3)"
    spec = rtamt.parse(text, semantics="output_robustness")
    data = {"u": [5, 1], "y": [4, 2]}
    result = spec.evaluate(data)
    assert result["asked"].values.tolist() == [inf, -inf]
    assert result["once asked"].values.tolist() == [inf, inf]
    assert result["y >= 3"].values.tolist() == [1, -1]
    assert result["sum"].values.tolist() == [9, 3]
    vacuity = spec.evaluate(data, semantics="input_vacuity")
    assert vacuity["asked"].values.tolist() == [2, -2]
    assert vacuity["y >= 3"].values.tolist() == [0, 0]
    assert (spec.semantics, result.semantics, vacuity.semantics) == (
        "output_robustness",
        "output_robustness",
        "input_vacuity",
    )
    dense = spec.evaluate({"u": ([0, 1], [5, 1]), "y": ([0, 1], [4, 2])}, time="dense")
    assert dense["asked"].values.tolist() == [inf, -inf]


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize("semantics", SEMANTICS)
def test_a_monitor_reads_every_variable_in_the_order_of_the_formula(semantics, time):
    spec = rtamt.parse("(a <= b) and (c < d) and once(e >= 3)", roles={"a": "input"}, semantics=semantics)
    assert spec.monitor(time=time).input_names == spec.input_names == ("a", "b", "c", "d", "e")


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("semantics", SEMANTICS)
def test_an_operand_without_value_is_an_error_under_every_semantics(semantics, backend):
    spec = rtamt.parse("x / y >= 1", roles={"x": "input"}, semantics=semantics, backend=backend)
    with pytest.raises(rtamt.EvaluationError, match=r"^'x / y' has no value at sample 1, time 1 s"):
        spec.evaluate({"x": [1, 0], "y": [1, 0]})


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_a_difference_that_nobody_asks_for_need_not_exist(backend):
    data = {"u": [inf], "y": [inf]}  # inf - inf has no value, but inf >= inf holds
    spec = rtamt.parse("u >= y", backend=backend)
    with pytest.raises(rtamt.EvaluationError):
        spec.evaluate(data)
    assert spec.evaluate(data, semantics="boolean").robustness == inf
    mixed = rtamt.parse("u >= y", roles=ROLES, backend=backend)
    assert mixed.evaluate(data, semantics="input_vacuity").robustness == 0


def test_the_zero_of_what_cannot_be_known_is_shown_without_a_minus():
    result = rtamt.parse("not (y >= 3)", semantics="input_vacuity").evaluate({"y": [5]})
    assert copysign(1, result.robustness) == 1


# ---- a semantics of one's own ---------------------------------------------------------------------


def outputs_alone(predicate, roles):
    """IA-STL's output robustness, told again in three lines."""
    read = {roles[name] for name in variables(predicate)}
    return predicate if "output" in read else truth(predicate)


def at_most_ten(predicate, _roles):
    return rtamt.STL["min"](predicate, Const(10.0))


def test_a_function_judges_predicates():
    spec = rtamt.parse("always(u >= 3 -> y >= 3)", roles=ROLES, semantics=outputs_alone)
    assert spec.evaluate({"u": [5, 1], "y": [4, 0]}).robustness == 1
    assert spec.evaluate({"u": [-99, -99], "y": [0, 0]}, semantics=at_most_ten).robustness == 102


def test_a_function_is_watched_with_too():
    monitor = rtamt.parse("u >= 3 or y >= 3").monitor(semantics=at_most_ten)
    assert [monitor.update(0, u=99, y=0), monitor.update(1, u=5, y=0)] == [10, 2]


def test_a_semantics_survives_pickling():
    spec = rtamt.parse("u >= 3", roles=ROLES, semantics="output-robustness")
    again = pickle.loads(pickle.dumps(spec))
    assert (again.semantics, dict(again.roles)) == ("output_robustness", ROLES)
    own = pickle.loads(pickle.dumps(rtamt.parse("u >= 3", semantics=outputs_alone)))
    assert own.semantics is outputs_alone


def test_what_a_function_leaves_unread_is_still_read_and_spans_the_trace():
    nothing = Relative()  # nothing is measured and nothing fixed: every predicate is worth 0
    spec = rtamt.parse("once[0:1](x >= 3) or y >= 3", semantics=nothing)
    signal = spec.evaluate({"x": ([0, 2, 7], [1, 2, 3]), "y": ([1, 4], [1, 2])}, time="dense").signal
    assert (signal.times.tolist(), signal.values.tolist()) == ([1, 7], [0, 0])
    monitor = spec.monitor(time="dense")
    assert monitor.input_names == ("x", "y")
    assert len(monitor.update(0, x=1)) == 0  # y may still come
    with pytest.raises(rtamt.TraceError):
        spec.evaluate({"x": [float("nan")], "y": [1]})


NEAR = replace(
    rtamt.STL["ge"],
    name="near",
    spellings=("~~",),
    definition=lambda a, b: 1 - abs(a - b),
    expansion=None,
    truth=None,
    dual=None,
)


def test_a_comparison_of_ones_own_holds_where_it_is_positive_unless_its_record_says_more():
    language = rtamt.STL.extend(NEAR)
    spec = rtamt.parse("x ~~ 3", language=language, backend="python", roles={"x": "input"})
    values = [spec.evaluate({"x": [3.5, 4, 5]}, semantics=name).signal.values.tolist() for name in SEMANTICS]
    holds = [inf, -inf, -inf]
    assert values == [[0.5, 0, -1], holds, [0.5, 0, -1], [0.5, 0, -1], [0, 0, 0], holds]
