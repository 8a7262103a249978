"""Messages about Booleans and enumerations, in full: in texts and in data."""

from __future__ import annotations

import numpy as np
import pytest

import rtamt
from rtamt.errors import BoundError, NameInFormulaError, ParseError

DECLARED = "enum Mode { MANUAL, AUTO = 4 } enum Phase { AUTO, STOP } Mode mode Phase phase bool p float x\n"

NO_ARITHMETIC = (
    "'mode' is of the enumeration Mode, which has neither arithmetic nor order; "
    "compare it with == or !=, such as mode == MANUAL"
)
NO_FORMULA = (
    "'mode' is of the enumeration Mode, and a formula is expected here; compare it, such as mode == MANUAL"
)

TEXTS = [
    ("const Mode home = AUTO  always[0:home](p)", "                                 ^^^^", BoundError,
     "'home' is of the enumeration Mode, and a bound is a number; declare it as float, such as const float home = 5"),
    ("parameter bool on = true  always[on:5](p)", "                                 ^^", BoundError,
     "'on' is a Boolean, and a bound is a number; declare it as float, such as const float on = 5"),
    ("mode + 1 > 2", "^^^^", ParseError, NO_ARITHMETIC),
    ("x > mode", "    ^^^^", ParseError, NO_ARITHMETIC),
    ("max(x, mode) > 3", "       ^^^^", ParseError, NO_ARITHMETIC),
    ("always mode", "       ^^^^", ParseError, NO_FORMULA),
    ("require R1: mode", "            ^^^^", ParseError, NO_FORMULA),
    ("(if x then 1 else 2) > 1", "    ^", ParseError,
     "'x' is a number, and 'if' needs a condition, which is true or false; compare it, such as x > 0"),
    ("duration[0:1](x + 1) > 1", "              ^^^^^", ParseError,
     "'x + 1' is a number, and 'duration' needs a condition, which is true or false; compare it, such as x + 1 > 0"),
    ("minimum(x > 3) > 1", "        ^^^^^", ParseError,
     "'minimum' takes a number, and 'x > 3' is a formula, true or false; write a signal or arithmetic, such as "
     "(if x > 3 then 1 else 0), or duration(x > 3) for how long it holds"),
    ("(if mode then 1 else 2) > 1", "    ^^^^", ParseError, NO_FORMULA),
    ("(if p then mode else 3) == AUTO", " ^^^^^^^^^^^^^^^^^^^^^", ParseError,
     "'mode' is of the enumeration Mode, and '3' is none of its members; write one of them: MANUAL, AUTO"),
    ("valid(x + 1)", "      ^^^^^", ParseError,
     "'valid' takes a variable, whose samples may be missing; 'x + 1' is none"),
    ("valid(p and p)", "      ^^^^^^^", ParseError,
     "'valid' takes a variable, whose samples may be missing; 'p and p' is none"),
    ("mode == 4", "^^^^^^^^^", ParseError,
     "'mode' is of the enumeration Mode, and '4' is none of its members; write one of them: MANUAL, AUTO"),
    ("x == MANUAL", "^^^^^^^^^^^", ParseError,
     "'MANUAL' is a member of Mode, and 'x' is none of its values; declare the variable, such as input Mode x"),
    ("mode == phase", "^^^^^^^^^^^^^", ParseError,
     "'mode' is of the enumeration Mode, and 'phase' is of the enumeration Phase; compare values of one enumeration"),
    ("mode != p", "^^^^^^^^^", ParseError,
     "'mode' is of the enumeration Mode, and 'p' is a Boolean; compare values of one enumeration"),
    ("AUTO == AUTO", "^^^^^^^^^^^^", ParseError,
     "'AUTO' is a member of Mode and of Phase; write Mode.AUTO or Phase.AUTO"),
    ("mode == AUT", "        ^^^", NameInFormulaError, "'AUT' is no member of Mode; did you mean 'AUTO'?"),
    ("mode in {AUTO, Loiter}", "               ^^^^^^", NameInFormulaError,
     "'Loiter' is no member of Mode; its members are MANUAL, AUTO"),
    ("Mode.OUTO == mode", "^^^^^^^^^", NameInFormulaError, "'OUTO' is no member of Mode; did you mean 'AUTO'?"),
    ("MANUEL == mode", "^^^^^^", NameInFormulaError, "'MANUEL' is not declared; did you mean 'MANUAL'?"),
    ("p == true", "^^^^^^^^^", ParseError,
     "'true' is a formula, and == compares numbers; write p <-> true, or p alone"),
    ("x in {}", "      ^", ParseError, "expected a value between the braces, such as in {1, 2}"),
    ("x in {1", "     ^", ParseError, "this '{' is never closed"),
    ("x in {1 2}", "        ^", ParseError, "expected ',' or '}' after a value, got '2'"),
    ("1 <= x in {2}", "^^^^^^^^^", ParseError,
     "'in' compares a value, and '1 <= x' is a formula; put parentheses around what is compared"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "marks", "kind", "sentence"), TEXTS)
def test_formula(text, marks, kind, sentence):
    with pytest.raises(rtamt.SpecificationError) as info:
        rtamt.parse(DECLARED + text)
    assert type(info.value) is kind
    assert (
        str(info.value)
        == f"{sentence}\n  line 2, column {len(marks) - len(marks.strip()) + 1}:\n    {text}\n    {marks}"
    )


DECLARATIONS = [
    ("enum E { A, B = 0 } E e e == A", "'B' and 'A' of E have the same code, 0"),
    ("enum E { A, A } E e e == A", "'A' is twice in E"),
    ("enum E { } E e e == A", "the enumeration 'E' has no members"),
    (
        "enum E { A = 9007199254740992, B } E e e == A",
        "the code of 'B' would be 9007199254740993, more than 9007199254740992; give it one",
    ),
    ("enum E { A = 1.5 } E e e == A", "the code of a member is a whole number, such as AUTO = 4; got '1.5'"),
    ("enum E { A B } E e e == A", "expected ',' or '}' after the member 'A', got 'B'"),
    ("enum E { A", "this '{' is never closed"),
    ("enum E { A } enum E { B } E e e == A", "there is a type 'E' already"),
    ("enum float { A } float e e == A", "there is a type 'float' already"),
    ("enum E { A } const E c = B  x > 3", "'B' is no member of E; its members are A"),
    ("const bool c = 2  x > 3", "a bool is true or false (1 or 0), got '2'"),
]


@pytest.mark.parametrize(("text", "sentence"), DECLARATIONS)
def test_declaration(text, sentence):
    with pytest.raises(rtamt.SpecificationError) as info:
        rtamt.parse(text)
    assert info.value.message == sentence


SPEC = rtamt.parse("enum Mode { MANUAL, AUTO = 4 } Mode mode bool p always(p -> mode == AUTO)")
STRANGER = "which is no member of Mode; did you mean 'AUTO'?"
HALF = "and declared as bool, which is 1 or 0 (true or false): declare it as float, and compare it"

DATA = [
    ({"mode": ["AUTO", "Auto"], "p": [1, 0]}, f"'mode' is 'Auto' at sample 1, {STRANGER}", 1),
    ({"mode": np.array(["AUTO", "Auto"]), "p": [1, 0]}, f"'mode' is 'Auto' at sample 1, {STRANGER}", 1),
    ({"time": [0, 2], "mode": [4, 4], "p": [1, 0.5]}, f"'p' is 0.5 at sample 1, time 2 s, {HALF}", 1),
]


@pytest.mark.parametrize(("data", "sentence", "index"), DATA)
def test_recorded_value_of_another_type(data, sentence, index):
    with pytest.raises(rtamt.TraceError) as info:
        SPEC.evaluate(data)
    assert (str(info.value), info.value.index) == (sentence, index)


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize("verdict", ["delayed", "eager", "interval"])
def test_a_sample_of_another_type_leaves_the_monitor_as_it_was(verdict, time):
    spec = rtamt.parse(SPEC.text.replace("always", "historically"))
    monitor = spec.monitor(verdict=verdict, time=time)
    monitor.update(0, p=True, mode="AUTO")
    for wrong, message in (
        ({"p": 2}, f"'p' is 2 at sample 1, time 1 s, {HALF}"),
        ({"mode": "Auto"}, STRANGER),
    ):
        with pytest.raises(rtamt.TraceError) as info:
            monitor.update(1, **{"p": 1, "mode": "AUTO", **wrong})
        assert str(info.value).endswith(message)
    monitor.update(1, p=1, mode="MANUAL")
    assert monitor.samples == (2 if time == "discrete" else 4)


@pytest.mark.parametrize("text", ["delay[1](x, false) > 1", "(if p then x else false) > 1"])
def test_a_number_has_no_boolean_in_its_place(text):
    with pytest.raises(ParseError) as caught:
        rtamt.parse(f"bool p float x {text}")
    assert caught.value.message == "'x' is a number, and 'false' is true or false; write a number, such as 0"
    assert text[caught.value.span.start - 15 :].startswith("false")


@pytest.mark.parametrize("declared", ["", "bool p float x ", "def f(a) = p or a > 0\n"])
@pytest.mark.parametrize(
    ("text", "operator", "literal"),
    [
        ("delay(true)", "delay", "true"),
        ("(if x > 0 then true else false) and x > 1", "if", "true"),
    ],
)
def test_true_and_false_are_no_numbers_unless_beside_a_boolean(declared, text, operator, literal):
    with pytest.raises(ParseError) as caught:
        rtamt.parse(declared + text)
    assert caught.value.message.startswith(
        f"'{operator}' takes a number, and '{literal}' is a formula, true or false"
    )


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(
    ("text", "holds"),
    [
        ("delay[1](p, false)", [False, True, False]),
        ("delay[1](p, true)", [True, True, False]),
        ("held(p, x > 0, true)", [True, False, True]),
        ("if x > 0 then true else p", [True, True, True]),
    ],
)
def test_a_boolean_before_the_start_is_written_as_true_or_false(text, holds, backend):
    spec = rtamt.parse(f"bool p float x {text}", backend=backend)
    result = spec.evaluate({"p": [True, False, True], "x": [-1, 1, 1]})
    assert [value > 0 for value in result.signal.values] == holds


@pytest.mark.parametrize(
    ("text", "advice"),
    [
        ("m == A", "'A' is none of its members; write one of them: M.A, B"),
        ("m == 3", "'3' is none of its members; write one of them: M.A, B"),
        ("always m", "a formula is expected here; compare it, such as m == M.A"),
        ("m > 3", "compare it with == or !=, such as m == M.A"),
    ],
)
def test_advice_names_the_type_of_a_member_whose_name_is_a_variable(text, advice):
    declared = "enum M { A, B }  input M m  input float A\n"
    with pytest.raises(ParseError) as caught:
        rtamt.parse(declared + text)
    assert caught.value.message.endswith(advice)
    rtamt.parse(declared + "m == M.A and m == B and A > 3")
