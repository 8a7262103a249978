"""Every sentence of the paper's API about wrong calls, settings and texts, in full."""

from __future__ import annotations

import sys

import pytest

import rtamt
from tests.errors.rtamt_classes import fresh, message_of, provide


@pytest.fixture(autouse=True)
def messages(monkeypatch):
    provide(monkeypatch)


SETTINGS = {
    "unknown type": (
        lambda s: s.declare_var("q", "Sensr"),
        "the type 'Sensr' of 'q' is neither built in (float, int, long, complex, bool) nor imported; "
        "did you mean 'Sensor'?; import it with import_module(module, 'Sensr') first",
    ),
    "class with arguments": (
        lambda s: (s.import_module("some_msgs", "Picky"), s.declare_var("q", "Picky")),
        "'q' cannot start as a Picky without arguments: "
        "Picky.__init__() missing 1 required positional argument: 'size'",
    ),
    "name is no text": (
        lambda s: s.declare_var(3, "float"),
        "the name of a variable is 3, expected text",
    ),
    "constant's name is no text": (
        lambda s: s.declare_const(None, "float", 1),
        "the name of a constant is None, expected text",
    ),
    "sub-specification is no text": (
        lambda s: s.add_sub_spec(3),
        "a sub-specification is 3, expected text",
    ),
    "variable that is a constant": (
        lambda s: (s.declare_const("c", "float", 1), s.declare_var("c", "float")),
        "'c' is a constant already; give the variable another name",
    ),
    "constant twice": (
        lambda s: s.declare_const("x", "float", 1),
        "'x' is declared already; give the constant another name",
    ),
    "constant of a class": (
        lambda s: s.declare_const("c", "Sensor", 1),
        "the constant 'c' cannot be a Sensor; its type is float or int",
    ),
    "constant without number": (
        lambda s: s.declare_const("c", "float", "five"),
        "the constant 'c' is 'five', expected a number",
    ),
    "io type of nothing": (
        lambda s: s.set_var_io_type("xx", "input"),
        "the variable 'xx' is not declared; did you mean 'x'?; call declare_var('xx', ...) first",
    ),
    "io type": (
        lambda s: s.set_var_io_type("x", "in"),
        "the io type of 'x' is 'in'; choose 'input' or 'output'",
    ),
    "topic of nothing": (
        lambda s: s.set_var_topic("q", "a/q"),
        "the variable 'q' is not declared; call declare_var('q', ...) first",
    ),
    "module": (
        lambda s: s.import_module("no_such_module", "A"),
        "the module 'no_such_module' cannot be imported: No module named 'no_such_module'",
    ),
    "class of module": (
        lambda s: s.import_module("some_msgs", "Sensors"),
        "the module 'some_msgs' has no 'Sensors'; did you mean 'Sensor'?",
    ),
    "unit": (
        lambda s: setattr(s, "unit", "day"),
        "'day' is not a unit of time; units: h, min, s, ms, us, ns",
    ),
    "unit of the period": (
        lambda s: s.set_sampling_period(1, "d"),
        "'d' is not a unit of time; units: h, min, s, ms, us, ns",
    ),
    "period": (lambda s: s.set_sampling_period(0, "ms"), "the sampling period is 0 ms; it must be positive"),
    "tolerance": (
        lambda s: s.set_sampling_period(1, "s", 1.5),
        "the sampling tolerance is 1.5; it is a fraction of the period, from 0 to 1",
    ),
    "file": (lambda s: s.get_spec_from_file("no/such.stl"), "The file no/such.stl does not exist."),
    "no text": (
        lambda s: s.parse(),
        "spec is None; set it to the text of the requirement first",
    ),
    "evaluate before parse": (
        lambda s: s.evaluate({"time": [0], "x": [1]}),
        "no specification has been read; set spec and call parse() first",
    ),
    "update before parse": (
        lambda s: s.update(0, [("x", 1)]),
        "no specification has been read; set spec and call parse() first",
    ),
    "pastify before parse": (
        lambda s: s.pastify(),
        "no specification has been read; set spec and call parse() first",
    ),
    "value before parse": (
        lambda s: s.get_value("xx"),
        "'xx' has no value yet; did you mean 'x'?; call update() or evaluate() first",
    ),
}


@pytest.mark.parametrize("case", SETTINGS)
def test_a_wrong_setting_or_call(case):
    call, message = SETTINGS[case]
    spec = fresh()
    assert message_of(lambda: call(spec)) == message


def test_a_file_that_is_no_text(tmp_path):
    path = tmp_path / "binary.stl"
    path.write_bytes(b"x >= \xff")
    assert (
        message_of(lambda: fresh().get_spec_from_file(path)) == f"The file {path} is not UTF-8 text (byte 5)."
    )
    assert message_of(lambda: fresh().get_spec_from_file(tmp_path)) == (
        f"The file {tmp_path} cannot be read: Is a directory."
    )


def test_wrong_options_of_the_combined_class():
    cls = rtamt.StlDiscreteTimeSpecification
    assert (
        message_of(lambda: cls(language="C")) == "the language is 'C'; choose Language.PYTHON or Language.CPP"
    )
    names = "standard, output_robustness, input_vacuity, input_robustness, output_vacuity, boolean"
    assert message_of(lambda: cls("output")) == (
        "unknown semantics 'output'; did you mean 'output_vacuity'? (semantics: output_vacuity, standard, "
        "output_robustness, input_vacuity, input_robustness, boolean)"
    )
    assert message_of(lambda: setattr(cls(), "semantics", rtamt.Language.CPP)) == (
        f"unknown semantics <Language.CPP: 'C++'>; semantics: {names}"
    )


@pytest.mark.parametrize(
    ("make", "what", "instead"),
    [
        (
            rtamt.StlDiscreteTimeOnlineSpecificationCpp,
            "StlDiscreteTimeOnlineSpecificationCpp",
            "StlDiscreteTimeOnlineSpecification",
        ),
        (
            rtamt.StlDiscreteTimeSpecificationCpp,
            "StlDiscreteTimeSpecificationCpp",
            "StlDiscreteTimeSpecification",
        ),
        (
            lambda: rtamt.StlDiscreteTimeSpecification(language=rtamt.Language.CPP),
            "Language.CPP",
            "Language.PYTHON",
        ),
    ],
)
def test_what_names_the_core_says_that_it_is_not_there(monkeypatch, make, what, instead):
    monkeypatch.setitem(sys.modules, "rtamt.engine._core", None)
    monkeypatch.delattr("rtamt.engine._core", raising=False)
    assert message_of(make) == (
        f"{what} needs the compiled core, which cannot be loaded; install the package with a C++ compiler at "
        f"hand, or use {instead}, which gives the same results more slowly"
    )


def test_a_monitor_that_does_not_fit_into_memory():
    spec = fresh("once[0:10000000000000](x)")
    assert message_of(lambda: spec.update(0, [("x", 1)])) == (
        "the monitor needs 7.45e+04 GiB of memory, which this machine does not give; shorten the longest bound "
        "or lengthen the period"
    )


def test_a_monitor_whose_times_do_not_fit_into_memory():
    spec = rtamt.parse("eventually[10000000000000:10000000000000](x)")
    with pytest.raises(rtamt.UsageError) as caught:
        spec.monitor()
    assert str(caught.value) == (
        "the monitor needs 7.45e+04 GiB of memory, which this machine does not give; shorten the longest bound "
        "or lengthen the period"
    )


TEXTS = {
    "syntax": (
        "always(x >= 3",
        "this '(' is never closed\n  line 1, column 7:\n    always(x >= 3\n          ^",
    ),
    "unknown name": (
        "xx >= 3",
        "'xx' is not declared; did you mean 'x'?\n  line 1, column 1:\n    xx >= 3\n    ^^",
    ),
    "no multiple of the period": (
        "once[0:0.5] x",
        "The operator bound must be a multiple of the sampling period: 500 ms is not a whole number of "
        "periods of 1 s; change the bound or the period\n"
        "  line 1, column 5:\n    once[0:0.5] x\n        ^^^^^^^",
    ),
    "object for a number": (
        "once(sensor >= 3)",
        "'sensor' is a Sensor and no number; name one of its fields, such as sensor.value\n"
        "  line 1, column 6:\n    once(sensor >= 3)\n         ^^^^^^",
    ),
    "field that is not there": (
        "once(sensor.valu >= 3)",
        "'sensor' is a Sensor and has no field 'valu'; did you mean 'value'?\n"
        "  line 1, column 6:\n    once(sensor.valu >= 3)\n         ^^^^^^^^^^^",
    ),
    "field of a number": (
        "x.value >= 3",
        "'x' is a float and has no field 'value'\n  line 1, column 1:\n    x.value >= 3\n    ^^^^^^^",
    ),
}


@pytest.mark.parametrize("case", TEXTS)
def test_a_text_that_is_wrong(case):
    text, message = TEXTS[case]
    assert message_of(lambda: fresh(text), rtamt.STLParseException) == message


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "rob.value = x",
            "the result 'rob.value' is a field of 'rob', which is not declared; "
            "import its class and declare it",
        ),
        ("sensor = x", "'sensor' is a Sensor and no number; name one of its fields, such as sensor.value"),
        ("sensor.val = x", "'sensor' is a Sensor and has no field 'val'; did you mean 'value'?"),
    ],
)
def test_a_result_that_has_no_place(text, message):
    assert message_of(lambda: fresh(text)) == message


def test_the_caret_points_into_the_subspecification_that_is_wrong():
    spec = fresh()
    spec.add_sub_spec("low = x <= 3")
    spec.add_sub_spec("late = once[0:0.5](low);")
    spec.spec = "always(late)"
    assert message_of(spec.parse, rtamt.STLParseException) == (
        "The operator bound must be a multiple of the sampling period: 500 ms is not a whole number of "
        "periods of 1 s; change the bound or the period\n"
        "  line 2, column 12:\n    late = once[0:0.5](low);\n               ^^^^^^^"
    )


@pytest.mark.parametrize(
    ("text", "operator", "place"),
    [
        ("always(x)", "Always", "line 1, column 1:\n    always(x)\n    ^^^^^^^^^"),
        ("y and F[0,2](x)", "Eventually", "line 1, column 7:\n    y and F[0,2](x)\n          ^^^^^^^^^"),
        ("x until[0,1] y", "Until", "line 1, column 1:\n    x until[0,1] y\n    ^^^^^^^^^^^^^^"),
        ("once(next(x))", "Next", "line 1, column 6:\n    once(next(x))\n         ^^^^^^^"),
    ],
)
def test_future_online_is_refused_before_the_data_is_looked_at(text, operator, place):
    spec = fresh(text)
    assert message_of(lambda: spec.update("nonsense", None)) == (
        f"{operator} operator is not implemented in the STL online monitor. "
        f"Call pastify() after parse(), or evaluate the finished trace offline\n  {place}"
    )


@pytest.mark.parametrize("operator", ["always", "eventually"])
def test_unbounded_future_cannot_be_pastified(operator):
    spec = fresh(f"{operator}(x)")
    assert message_of(spec.pastify, rtamt.STLParseException) == (
        f"Cannot pastify an unbounded {operator}. Give it an upper bound, such as {operator}[0:10]\n"
        f"  line 1, column 1:\n    {operator}(x)\n    {'^' * (len(operator) + 3)}"
    )


def test_a_sampling_rule_of_the_text_is_not_ignored():
    spec = rtamt.StlDiscreteTimeSpecification()
    spec.declare_var("x", "float")
    spec.spec = "sample 100ms hold; out = x >= 3"
    with pytest.raises(rtamt.RTAMTException) as caught:
        spec.parse()
    assert str(caught.value) == (
        "RTAMT Exception: 'sample 100ms hold' is read by rtamt.load and rtamt.parse; here the period is set with "
        "set_sampling_period(), and data are samples as they are"
    )
    spec.spec = "sample 100ms; out = x >= 3"
    spec.set_sampling_period(100, "ms", 0.1)
    spec.parse()
    assert spec.update(0, [("x", 5.0)]) == 2.0
