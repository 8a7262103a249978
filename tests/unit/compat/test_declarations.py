"""Declarations, settings and texts of the paper's API."""

from __future__ import annotations

import sys

import pytest

import rtamt
from rtamt.exception import exception
from rtamt.spec.stl.discrete_time import specification as legacy
from tests.unit.compat.messages import Message, declared

CLASSES = (
    rtamt.StlDiscreteTimeSpecification,
    rtamt.StlDiscreteTimeSpecificationCpp,
    rtamt.StlDiscreteTimeOfflineSpecification,
    rtamt.StlDiscreteTimeOnlineSpecification,
    rtamt.StlDiscreteTimeOnlineSpecificationCpp,
)


@pytest.mark.parametrize("language", ["STL", "LTL"])
def test_exceptions_of_older_versions_are_raised(language):
    spec = rtamt.LTLSpecification()
    spec.declare_var("x", "float")
    spec.spec = "always x >="
    with pytest.raises(getattr(rtamt, f"{language}ParseException")):
        spec.parse()
    spec.spec = "always x >= 0"
    spec.parse()
    with pytest.raises(rtamt.LTLPastifyException):
        spec.pastify()
    for kind in ("", "NotImplemented", "Offline", "Specification"):
        with pytest.raises(getattr(rtamt, f"{language}{kind}Exception")):
            spec.update(0, [("x", 1.0)])


def test_old_spellings_are_the_same_classes():
    assert rtamt.STLSpecification is rtamt.StlDiscreteTimeSpecification
    assert rtamt.STLDiscreteTimeSpecification is rtamt.StlDiscreteTimeSpecification
    assert rtamt.LTLSpecification is rtamt.LTLDiscreteTimeSpecification is rtamt.StlDiscreteTimeSpecification
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
