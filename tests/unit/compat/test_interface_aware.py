"""Semantics in the paper's API: where they are set, what declares the interface, values of parts."""

from __future__ import annotations

import copy
import pickle
from math import inf

import pytest

import rtamt

DISCRETE = {"time": [0, 1], "u": [5, 1], "y": [4, 2]}
DENSE = (["u", [[0, 5], [1, 1]]], ["y", [[0, 4], [1, 2]]])


def declared(cls, text, **settings):
    spec = cls(**settings)
    spec.declare_var("u", "float")
    spec.declare_var("y", "float")
    spec.set_var_io_type("u", "input")
    spec.spec = text
    spec.parse()
    return spec


def test_the_semantics_can_be_set_after_the_specification_was_made_and_read():
    spec = rtamt.StlDiscreteTimeSpecification()
    assert spec.semantics is rtamt.Semantics.STANDARD
    spec.semantics = rtamt.Semantics.OUTPUT_ROBUSTNESS
    spec.spec = "input float u; output float y; u >= 3 -> y >= 3"
    spec.parse()
    assert spec.evaluate(DISCRETE) == [[0, 1], [1, inf]]
    spec.semantics = rtamt.Semantics.INPUT_VACUITY
    assert spec.evaluate(DISCRETE) == [[0, 0], [1, 2]]


def test_a_change_of_the_semantics_or_of_a_role_starts_the_stream_over():
    spec = declared(rtamt.StlDiscreteTimeOnlineSpecification, "once(u >= 3)")
    assert spec.update(0, [("u", 9), ("y", 0)]) == 6
    spec.semantics = "boolean"
    assert spec.update(0, [("u", 1), ("y", 0)]) == -inf
    spec.semantics = rtamt.Semantics.OUTPUT_ROBUSTNESS
    assert spec.update(0, [("u", 4), ("y", 0)]) == inf
    spec.set_var_io_type("u", "output")
    assert spec.update(0, [("u", 4), ("y", 0)]) == 1
    dense = declared(rtamt.StlDenseTimeOnlineSpecification, "once(u >= 3)")
    dense.update(["u", [[0, 9]]], ["y", [[0, 0]]])
    dense.semantics = "boolean"
    assert dense.update(["u", [[0, 1]]]) == [[0, -inf]]


def test_dense_offline_output_robustness_is_not_always_infinite():
    spec = declared(rtamt.IAStlOutputRobustnessDenseTimeOfflineSpecification, "(u >= 3) -> (y >= 3)")
    assert spec.evaluate(*DENSE) == [[0, 1], [1, inf]]
    spec = declared(rtamt.StlDenseTimeSpecification, "y >= 3", semantics=rtamt.Semantics.OUTPUT_ROBUSTNESS)
    assert spec.evaluate(*DENSE) == [[0, 1], [1, -1]]


@pytest.mark.parametrize("pastified", [False, True])
def test_boolean_semantics_gives_a_verdict_where_the_robustness_is_zero(pastified):
    for text, expected in (("y >= 4", inf), ("y > 4", -inf)):
        spec = declared(rtamt.StlDiscreteTimeSpecification, text, semantics="boolean")
        if pastified:
            spec.pastify()
        assert spec.evaluate(DISCRETE)[0] == [0, expected]
        assert spec.update(0, [("u", 5), ("y", 4)]) == expected


def test_values_of_parts_are_under_the_semantics_and_numbers_are_numbers():
    text = "sum = u + y; asked = u >= 3; out = asked -> sum >= 6"
    spec = declared(rtamt.StlDiscreteTimeSpecification, text, semantics=rtamt.Semantics.INPUT_VACUITY)
    expected = {"sum": [9, 3], "asked": [2, -2], "out": [0, 2], "u": [5, 1], "(u)>=(3.0)": [2, -2]}
    expected |= {"(u)+(y)": [9, 3], "((u)+(y))>=(6.0)": [0, 0]}
    assert [value for _, value in spec.evaluate(DISCRETE)] == expected["out"]
    assert {name: spec.get_value(name) for name in expected if name != "u"} == {
        name: values for name, values in expected.items() if name != "u"
    }
    for i in range(2):
        spec.update(i, [("u", DISCRETE["u"][i]), ("y", DISCRETE["y"][i])])
        assert {name: spec.get_value(name) for name in expected} == {k: v[i] for k, v in expected.items()}
    dense = declared(rtamt.StlDenseTimeSpecification, text, semantics=rtamt.Semantics.INPUT_VACUITY)
    assert dense.evaluate(*DENSE) == [[0, 0], [1, 2]]
    assert dense.get_value("asked") == [[0, 2], [1, -2]]
    assert dense.get_value("sum") == [[0, 9], [1, 3]]


def test_a_number_as_the_result_is_judged_and_a_formula_below_a_comparison_is_a_number():
    spec = declared(rtamt.StlDiscreteTimeSpecification, "out = (u >= 3) + y", semantics="boolean")
    assert spec.evaluate(DISCRETE) == [[0, inf], [1, -inf]]
    assert spec.update(0, [("u", 5), ("y", 4)]) == inf
    assert spec.get_value("out") == spec.var_object_dict["out"] == inf
    assert spec.get_value("(u)>=(3.0)") == 2


@pytest.mark.parametrize("mode", ["DiscreteTimeOnline", "DenseTimeOffline"])
def test_a_specification_can_be_copied_and_pickled_and_says_what_it_is(mode):
    cls = getattr(rtamt, f"IAStlInputVacuity{mode}Specification")
    spec = cls()
    spec.declare_var("u", "float")
    spec.set_var_io_type("u", "input")
    for again in (copy.deepcopy(spec), pickle.loads(pickle.dumps(spec))):
        assert type(again) is cls
        assert again.semantics is rtamt.Semantics.INPUT_VACUITY
        assert again.var_io_dict == {"u": "input"}
    assert cls.__name__ in repr(spec)
