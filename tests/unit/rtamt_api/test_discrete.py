"""The paper's API in discrete time: names, settings, shapes, values, and objects with fields."""

from __future__ import annotations

import sys
import warnings
from dataclasses import dataclass, field
from fractions import Fraction
from math import inf
from types import ModuleType

import numpy as np
import pytest

import rtamt
from rtamt.exception import exception
from rtamt.spec.stl.discrete_time import specification as legacy

CLASSES = (
    rtamt.StlDiscreteTimeSpecification,
    rtamt.StlDiscreteTimeSpecificationCpp,
    rtamt.StlDiscreteTimeOfflineSpecification,
    rtamt.StlDiscreteTimeOnlineSpecification,
    rtamt.StlDiscreteTimeOnlineSpecificationCpp,
)


@dataclass
class Inner:
    """A message inside a message."""

    level: float = 0.0


@dataclass
class Message:
    """A message with a number, a text and a nested message."""

    value: float = 0.0
    label: str = ""
    inner: Inner = field(default_factory=Inner)

    @classmethod
    def get_fields_and_field_types(cls):
        """Return the types of the fields, as classes of messages do."""
        return {"value": "double", "label": "string", "inner": "some_msgs/Inner"}


@pytest.fixture(autouse=True)
def messages(monkeypatch):
    module = ModuleType("some_msgs")
    module.Message = Message
    monkeypatch.setitem(sys.modules, "some_msgs", module)
    monkeypatch.setitem(sys.modules, "some_msgs.msg", module)


def declared(text, names="x y", cls=rtamt.StlDiscreteTimeSpecification, **constants):
    spec = cls()
    for name in names.split():
        spec.declare_var(name, "float")
    for name, value in constants.items():
        spec.declare_const(name, "float", value)
    spec.spec = text
    spec.parse()
    return spec


def with_messages(text, names="req rob"):
    spec = rtamt.StlDiscreteTimeSpecification()
    spec.import_module("some_msgs", "Message")
    for name in names.split():
        spec.declare_var(name, "Message")
    spec.spec = text
    spec.parse()
    return spec


# ---- names -------------------------------------------------------------------------------------------


def test_old_spellings_are_the_same_classes():
    assert rtamt.STLSpecification is rtamt.StlDiscreteTimeSpecification
    assert rtamt.STLDiscreteTimeSpecification is rtamt.StlDiscreteTimeSpecification
    for cls in CLASSES:
        assert getattr(legacy, cls.__name__) is cls
    assert exception.RTAMTException is rtamt.RTAMTException


def test_options_have_rtamts_values():
    assert [str(s) for s in rtamt.Semantics] == [
        "standard",
        "output-robustness",
        "input-vacuity",
        "input-robustness",
        "output-vacuity",
    ]
    assert [str(language) for language in rtamt.Language] == ["python", "C++"]
    assert [str(time) for time in rtamt.TimeInterpretation] == ["discrete_time", "dense-time"]
    assert [io.value for io in rtamt.StlIOType] == [0, 1, 2]


def test_exceptions_are_one_family():
    assert issubclass(rtamt.STLParseException, rtamt.RTAMTException)
    assert str(rtamt.RTAMTException("no")) == "RTAMT Exception: no"


def test_offline_classes_have_no_update_and_online_ones_no_evaluate():
    assert not hasattr(rtamt.StlDiscreteTimeOfflineSpecification, "update")
    assert not hasattr(rtamt.StlDiscreteTimeOnlineSpecification, "evaluate")


@pytest.mark.parametrize("language", list(rtamt.Language))
def test_both_languages_give_the_same(language):
    spec = rtamt.StlDiscreteTimeSpecification(rtamt.Semantics.STANDARD, language)
    spec.spec = "once[0,1](x)"
    spec.parse()
    assert [spec.update(t, [("x", x)]) for t, x in enumerate([3, 1, 2])] == [3.0, 3.0, 2.0]


# ---- settings ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("cls", CLASSES)
def test_settings_read_back(cls):
    spec = cls()
    assert (spec.sampling_tolerance, spec.sampling_violation_counter, spec.unit) == (0.1, 0, "s")
    assert spec.get_sampling_frequency() == 1.0
    spec.set_sampling_period(100, "ms", 0.5)
    assert (spec.get_sampling_frequency(), spec.sampling_tolerance) == (10.0, 0.5)
    spec.name, spec.spec, spec.unit = "N", "x >= 1", "ms"
    assert (spec.name, spec.spec, spec.unit) == ("N", "x >= 1", "ms")


def test_names_before_and_after_parse():
    spec = rtamt.StlDiscreteTimeSpecification()
    assert (spec.out_var, spec.out_var_field, spec.free_vars, spec.modules) == (None, "", set(), {})
    spec.declare_var("x", "float")
    spec.declare_var("unread", "int")
    spec.declare_var("late", "float")
    spec.set_var_topic("x", "a/b")
    spec.add_sub_spec("late = prev(x)")
    spec.spec = "late >= 2"
    spec.parse()
    assert (spec.out_var, spec.out_var_field) == ("out", "")
    assert spec.free_vars == {"x", "unread"}
    assert spec.var_topic_dict == {
        "x": "a/b",
        "unread": "rtamt/unread",
        "late": "rtamt/late",
        "out": "rtamt/out",
    }
    assert spec.var_object_dict == {"x": 0.0, "unread": 0, "late": 0.0, "out": 0.0}


def test_a_text_declares_what_calls_would(tmp_path):
    path = tmp_path / "s.stl"
    path.write_text(
        "specification named\nfrom some_msgs.msg import Message\n"
        "input Message req\nconst float c = 2\n@ topic(req, in/req)\nreq.value >= c\n"
    )
    spec = rtamt.StlDiscreteTimeSpecification()
    spec.spec = spec.get_spec_from_file(str(path))
    spec.parse()
    assert (spec.name, spec.modules) == ("named", {"Message": sys.modules["some_msgs.msg"]})
    assert spec.var_topic_dict["req"] == "in/req"
    assert spec.update(0, [("req", Message(5.0))]) == 3.0


def test_sides_of_the_interface_can_be_read():
    spec = rtamt.StlDiscreteTimeSpecification()
    for name in ("req", "gnt", "late"):
        spec.declare_var(name, "float")
    assert spec.var_io_dict == {"req": "output", "gnt": "output", "late": "output"}
    spec.set_var_io_type("req", "input")
    spec.spec = "input float late req >= late"
    spec.parse()
    assert spec.var_io_dict == {"req": "input", "gnt": "output", "late": "input"}


def test_constants_are_numbers_and_bounds():
    for value in (2, 2.0, "2"):
        assert declared("once[0:c](x >= c)", c=value).spec_print() == "once[0,2]((x)>=(2.0))"


def test_the_period_may_be_set_after_parse_and_survives_pastify():
    spec = declared("eventually[0:1](x)")
    spec.pastify()
    spec.set_sampling_period(500, "ms")
    assert [spec.update(t / 2, [("x", x)]) for t, x in enumerate([5, 1, 2, 3])] == [5.0, 5.0, 5.0, 3.0]
    assert spec.sampling_violation_counter == 0


def test_a_setting_that_does_not_fit_changes_nothing():
    spec = declared("once[0:1](x)")
    message = (
        "RTAMT Exception: The operator bound must be a multiple of the sampling period: {} is not a whole "
        "number of periods of {}; change the bound or the period\n"
        "  line 1, column 5:\n    once[0:1](x)\n        ^^^^^"
    )
    with pytest.raises(rtamt.STLParseException) as info:
        spec.set_sampling_period(3, "s", 0.4)
    assert str(info.value) == message.format("1 s", "3 s")
    assert (spec.get_sampling_frequency(), spec.sampling_tolerance) == (1.0, 0.1)
    with pytest.raises(rtamt.STLParseException) as info:
        spec.unit = "ms"
    assert str(info.value) == message.format("1 ms", "1 s")
    assert spec.unit == "s"
    assert [spec.update(t, [("x", x)]) for t, x in enumerate([5, 1, 2])] == [5.0, 5.0, 2.0]


def test_a_text_that_cannot_be_read_leaves_the_one_before():
    spec = declared("once(x)")
    spec.spec = "once[0:1(x)"
    with pytest.raises(rtamt.STLParseException) as info:
        spec.parse()
    assert str(info.value) == (
        "RTAMT Exception: expected ']' after the bounds, got '('\n"
        "  line 1, column 9:\n    once[0:1(x)\n            ^"
    )
    assert spec.spec_print() == "once(x)"


# ---- evaluate ----------------------------------------------------------------------------------------


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


# ---- update ------------------------------------------------------------------------------------------


def test_a_variable_left_out_keeps_its_value():
    spec = declared("x + y")
    assert spec.update(0, [("x", 1), ("y", 2)]) == 3.0
    assert spec.update(1, [("x", 10)]) == 12.0
    assert spec.update(2, []) == 12.0


def test_a_declared_variable_that_is_not_read_may_be_given():
    spec = declared("x >= 1")
    assert spec.update(0, [("y", "anything"), ("x", 3)]) == 2.0


@pytest.mark.parametrize(
    "pairs",
    [
        [("x", 3.0), ("y", 1.0)],
        [["x", 3], ["y", True]],
        (("x", np.float32(3)), ("y", np.int64(1))),
        {"x": 3.0, "y": 1.0}.items(),
        zip("xy", [Fraction(3), 1.0], strict=True),
    ],
)
def test_pairs_may_come_in_any_form(pairs):
    result = declared("x - y").update(0, pairs)
    assert (result, type(result)) == (2.0, float)


def test_every_update_gives_a_number_after_pastify():
    spec = declared("always[0,2](x)")
    spec.pastify()
    assert [spec.update(t, [("x", x)]) for t, x in enumerate([5, 4, 6, 7])] == [5.0, 4.0, 4.0, 4.0]


def test_online_violations_are_counted_from_reset_to_reset():
    spec = declared("x")
    for time in (0, 1, 3):
        spec.update(time, [("x", 1)])
    assert spec.sampling_violation_counter == 1
    spec.reset()
    assert spec.sampling_violation_counter == 0


@pytest.mark.parametrize(
    ("time", "pairs", "message"),
    [
        (
            2,
            [("x", float("nan"))],
            "'x' is NaN at sample 2, time 2 s: fill the gap or leave the sample out",
        ),
        (2, [("x", "text")], "'x' is 'text' at sample 2, expected a number"),
        (2, [("z", 1.0)], "the formula has no variable 'z'; variables: x, y"),
        (
            0,
            [("x", 50.0)],
            "time does not increase at sample 2: 0 s comes after 1 s; sort the samples and drop repeated stamps",
        ),
        (
            2,
            [("x", 0.0), ("y", 0.0)],
            "'x / y' has no value at sample 2, time 2 s: it is 0/0, inf - inf, 0 * inf, or a root or "
            "logarithm of a negative number; change the formula or the data so that this cannot happen",
        ),
    ],
    ids=["NaN", "text", "unknown name", "time goes back", "0/0"],
)
def test_an_update_that_fails_leaves_the_monitor_as_it_was(time, pairs, message):
    spec = declared("once(x / y >= 1)")
    assert spec.update(0, [("x", 4), ("y", 2)]) == 1.0
    assert spec.update(1, [("x", 1)]) == 1.0
    with pytest.raises(rtamt.RTAMTException) as info:
        spec.update(time, pairs)
    assert str(info.value) == f"RTAMT Exception: {message}"
    assert (spec.get_value("x"), spec.get_value("y"), spec.get_value("out")) == (1.0, 2.0, 1.0)
    assert spec.sampling_violation_counter == 0
    assert spec.update(2, []) == 1.0
    assert spec.update(3, [("x", 8)]) == 3.0


def test_the_combined_class_does_both():
    spec = declared("once(x)")
    assert spec.update(0, [("x", 5)]) == 5.0
    assert spec.evaluate({"time": [0, 1], "x": [1, 2]}) == [[0.0, 1.0], [1.0, 2.0]]
    assert spec.get_value("x") == [1.0, 2.0]
    assert spec.update(1, [("x", 3)]) == 5.0
    assert spec.get_value("x") == 3.0


# ---- objects -----------------------------------------------------------------------------------------


def test_a_result_with_a_field_is_written_into_the_declared_object():
    spec = with_messages("rob.value = once(req.value >= 3)")
    declared_object = spec.get_value("rob")
    given = Message(5.0)
    assert spec.update(0, [("req", given)]) is declared_object
    assert declared_object.value == 2.0
    assert spec.get_value("req") is given
    assert spec.get_value("req.value") == 5.0
    assert spec.get_value("rob.value") == 2.0
    with pytest.raises(rtamt.RTAMTException) as info:
        spec.update(1, [("req", Message(float("nan")))])
    assert str(info.value) == (
        "RTAMT Exception: 'req.value' is NaN at sample 1, time 1 s: fill the gap or leave the sample out"
    )
    assert declared_object.value == 2.0


def test_a_result_may_be_a_field_of_a_field():
    spec = with_messages("rob.inner.level = req.value")
    assert spec.update(0, [("req", Message(5.0))]).inner == Inner(5.0)


def test_objects_are_read_again_at_each_update():
    spec = with_messages("req.value")
    assert spec.update(0, []) == 0.0
    spec.get_value("req").value = 4.0
    assert spec.update(1, []) == 4.0
    spec.var_object_dict["req"] = Message(7.0)
    assert spec.update(2, []) == 7.0


def test_numbers_can_be_assigned_to_var_object_dict_between_updates():
    spec = declared("low = x <= 3; x + y", "x y low")
    assert spec.update(0, [("x", 1.0), ("y", 2.0)]) == 3.0
    assert spec.update(1, [("x", 2.0)]) == 4.0
    values = spec.var_object_dict
    assert values == {"x": 2.0, "y": 2.0, "low": 1.0, "out": 4.0}
    values["x"] = 10.0
    assert spec.get_value("x") == 10.0
    assert spec.update(2, [("y", 0.5)]) == 10.5
    assert (values["out"], values["low"], spec.get_value("low")) == (10.5, -7.0, -7.0)
    values["x"] = float("nan")
    with pytest.raises(rtamt.RTAMTException) as info:
        spec.update(3, [])
    assert str(info.value) == (
        "RTAMT Exception: 'x' is NaN at sample 3, time 3 s: fill the gap or leave the sample out"
    )
    values["x"] = 1.0
    assert spec.update(3, []) == 1.5


# ---- values ------------------------------------------------------------------------------------------


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


# ---- chains ------------------------------------------------------------------------------------------


def test_a_chain_that_rtamt_read_differently_is_warned_of_where_parse_is_called():
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        spec = declared("x >= 1 -> y >= 1 -> x >= 2")
    assert [str(w.message) for w in caught] == [
        "a chain without parentheses is read as 'x >= 1 -> y >= 1 -> x >= 2'; RTAMT read it as "
        "'(x >= 1 -> y >= 1) -> x >= 2': add parentheses to say which one is meant"
    ]
    assert caught[0].filename == __file__
    assert spec.evaluate({"time": [0], "x": [0], "y": [0]}) == [[0.0, 1.0]]


@pytest.mark.parametrize(
    "text", ["(x -> y) -> x", "x -> (y -> x)", "x and y and x", "x until y until x", "(x -> y) and (y -> x)"]
)
def test_no_warning_where_nothing_is_ambiguous(text):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        spec = declared(text)
    assert spec.out_var == "out"


def test_infinite_values_are_legal():
    assert declared("x >= 1").update(0, [("x", inf)]) == inf
