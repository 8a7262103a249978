"""Groups and quantifiers in texts: what they mean, how they print, and what is wrong with them."""

from __future__ import annotations

import pickle

import pytest

import rtamt
from rtamt.errors import NameInFormulaError, ParseError, SpecificationError
from rtamt.language.contents import variables
from rtamt.language.formula import Var
from rtamt.language.parsing.specfile import parse_document
from rtamt.language.quantifiers import Binder, Field, Group, quantifiers
from rtamt.language.value_types import BOOLEAN

DECLARED = 'group cars = "car_*" { float x [m]; float v }\n'

PRINTED = [
    "forall v in cars: v.x > 3",
    "always(forall v in cars: eventually[0:5](v.x > ego))",
    "(exists v in cars: v.x > 3) and ego > 2",
    "ego > 2 and (exists v in cars: v.x > 3 or v.v > 2)",
    "not(exists v in cars: v.x > 3)",
    "(count v in cars: v.x > 3) >= 2",
    "2 <= (count v in cars: v.x > 3)",
    "forall v in cars: exists w in cars where v != w: v.x > w.x",
    "forall u in cars: forall v in cars where u != v: forall w in cars where u != w and v != w: u.x + v.x > w.x",
    "if (exists v in cars: v.x > 3) then ego else 2",
    "(if ego > 3 then (count v in cars: v.x > 3) else 2) > 1",
    "abs(count v in cars: v.x > 3) > 1",
    "-(count v in cars: v.x > 3) > 1",
]


@pytest.mark.parametrize("text", PRINTED)
def test_quantifiers_print_as_they_are_parsed(text):
    formula = parse_document(DECLARED + text).formula
    assert str(formula) == text
    assert parse_document(DECLARED + str(formula)).formula == formula
    assert pickle.loads(pickle.dumps(formula)) == formula


def test_what_follows_the_colon_extends_as_far_to_the_right_as_it_can():
    one = parse_document(DECLARED + "ego > 1 and forall v in cars: v.x > 1 or v.v > 2 -> ego > 3").formula
    other = parse_document(
        DECLARED + "ego > 1 and (forall v in cars: ((v.x > 1 or v.v > 2) -> ego > 3))"
    ).formula
    assert one == other


def test_a_group_has_the_fields_units_types_and_role_that_are_declared():
    document = parse_document(
        'input group cars = "/car_*/state" { float pose.x [m]; bool ok }; forall v in cars: v.ok'
    )
    fields = (Field("pose.x", "float", None, "m"), Field("ok", "bool", BOOLEAN))
    assert document.groups == {"cars": Group("cars", "/car_*/state", fields, "input")}
    assert document.groups["cars"].member("/car_7/state.pose.x") == ("/car_7/state", "pose.x")
    assert document.groups["cars"].member("/car_7/other.pose.x") is None
    assert variables(document.formula) == ()
    (quantifier,) = quantifiers(document.formula)
    assert quantifier.op.binder == Binder("v", document.groups["cars"])


def test_quantifiers_in_latex():
    formula = parse_document(DECLARED + "forall v in cars: exists w in cars where v != w: v.x > w.x").formula
    assert formula.latex() == (
        r"\forall v \in \mathrm{cars}:\ \exists w \in \mathrm{cars}, v \neq w:\ \mathrm{v.x} > \mathrm{w.x}"
    )


@pytest.mark.parametrize("word", ["forall", "exists", "count", "group", "where", "in"])
def test_the_words_of_quantifiers_are_no_reserved_words(word):
    assert parse_document(f"{word} > 3 and once({word} < 5)").formula.args[0].args[0] == Var(word)
    declared = parse_document(f"float {word}  always({word} > 3)")
    assert variables(declared.formula) == (word,)


def test_a_declared_name_is_no_quantifier():
    with pytest.raises(ParseError, match="expected an operator between 'forall' and 'v'"):
        parse_document(f"float forall {DECLARED} forall v in cars: v.x > 3")


def test_quantifiers_stand_in_templates_and_files():
    document = parse_document(DECLARED + "def near(x) = exists v in cars: v.x > x\nalways(near(ego + 1))")
    assert str(document.formula) == "always(exists v in cars: v.x > ego + 1)"


WRONG = [
    (
        "forall v in carz: v.x > 3",
        "            ^^^^",
        NameInFormulaError,
        "there is no group 'carz'; did you mean 'cars'? (groups: cars)",
    ),
    (
        "forall v in cars: v.speed > 3",
        "                  ^^^^^^^",
        NameInFormulaError,
        "'speed' is not a field of 'cars'; fields: x, v",
    ),
    (
        "forall v in cars: v > 3",
        "                  ^",
        ParseError,
        "'v' is a member of 'cars'; name one of its fields, such as v.x",
    ),
    ("cars > 3", "^^^^", ParseError, "'cars' is a group; quantify over it: forall v in cars: ..."),
    (
        "forall v in cars v.x > 3",
        "                 ^^^",
        ParseError,
        "expected ':' or 'where' after 'forall v in cars', got 'v.x'",
    ),
    (
        "forall v in cars: exists v in cars: v.x > 3",
        "                         ^",
        ParseError,
        "'v' has a meaning already; choose another word for the member of 'cars'",
    ),
    (
        "forall v in cars where v.x > 3: v.x > 3",
        "                       ^^^^^^^",
        ParseError,
        "'where' takes two variables of quantifiers that stand for different members, such as where v != w; put any "
        "other condition into the formula: v in ...: condition -> ...",
    ),
    (
        "forall w in cars where w == v: w.x > 3",
        "                       ^^^^^^",
        ParseError,
        "'where' takes two variables of quantifiers that stand for different members, such as where w != v; put any "
        "other condition into the formula: w in ...: condition -> ...",
    ),
    (
        "forall w in cars: forall a in cars where a == w: w.x > 3",
        "                                         ^^^^^^",
        ParseError,
        "'where' takes two variables of quantifiers that stand for different members, such as where a != w; put any "
        "other condition into the formula: a in ...: condition -> ...",
    ),
    (
        "forall v, w in cars: v.x > w.x",
        "       ^^^^",
        ParseError,
        "'forall' takes one variable; nest the quantifiers: forall v in cars: forall w in cars: ...",
    ),
    (
        "always(exists v in cars, w in cars: v.x > w.x)",
        "              ^^^^^^^^^^^^",
        ParseError,
        "'exists' takes one variable; nest the quantifiers: exists v in cars: exists w in cars: ...",
    ),
    (
        "forall v in cars where v != w: v.x > 3",
        "                            ^",
        ParseError,
        "'w' is not the variable of a quantifier; 'where' takes two of them, such as where v != w",
    ),
    (
        "forall v in cars where v != v: v.x > 3",
        "                       ^^^^^^",
        ParseError,
        "'where' compares 'v' with the variable of a quantifier around this one, such as where v != w",
    ),
    (
        "count v in cars: v.x",
        "                 ^^^",
        ParseError,
        "'v.x' is a number, and 'count' needs a condition, which is true or false; compare it, such as v.x > 0",
    ),
]


@pytest.mark.parametrize(("text", "caret", "kind", "message"), WRONG)
def test_what_is_wrong_with_a_quantifier_is_one_sentence(text, caret, kind, message):
    with pytest.raises(kind) as error:
        parse_document(DECLARED + text)
    assert error.value.message == message
    assert str(error.value).splitlines()[-1] == f"    {caret}"


DECLARATIONS = [
    (
        'group cars = "car"; x > 3',
        'the pattern of a group has one star, which stands for the name of a member, such as "cars_*"; '
        "got '\"car\"'",
    ),
    (
        'group cars = "car_*" {}; x > 3',
        "the braces of 'cars' are empty; declare its fields, such as { float x [m] }, or leave them out: its fields "
        "are then those that formulas read",
    ),
    ("group cars = car_*; x > 3", 'the pattern of a group is written in double quotes: "car_*"'),
    (
        "input group cars = car_* { float x } x > 3",
        'the pattern of a group is written in double quotes: "car_*"',
    ),
    (
        "group cars = status[*].a; x > 3",
        'the pattern of a group is written in double quotes: "status[*].a"',
    ),
    (
        'group cars = "car_*" { float "the speed" } forall c in cars: c > 3',
        "'c' is a member of 'cars'; name one of its fields, such as \"c.the speed\"",
    ),
    ('group cars = "car_*" { float x; float x }; x > 3', "'cars' has two fields called 'x'"),
    (
        'group cars = "car_*" { flaot x }; x > 3',
        "expected the type of a field of 'cars', got 'flaot'; did you mean 'float'? "
        "(types: float, int, long, complex, bool)",
    ),
    ('group cars = "car_*" group cars = "c_*"; x > 3', "'cars' is declared twice"),
    ('float cars group cars = "c_*"; x > 3', "'cars' is declared twice"),
    (
        "forall v in cars: v.x > 3",
        "there is no group 'cars'; declare it before the formulas: group cars = \"cars_*\"",
    ),
    ('x > 3; group cars = "c_*"; x > 3', "declarations and annotations stand before the first formula"),
]


@pytest.mark.parametrize(("text", "message"), DECLARATIONS)
def test_what_is_wrong_with_a_group_is_one_sentence(text, message):
    with pytest.raises(SpecificationError) as error:
        parse_document(text)
    assert error.value.message == message


def test_a_field_may_be_recorded_under_another_name():
    head = 'group cars = "car_*" { float x [m] = "pose.x"; bool on }; '
    spec = rtamt.parse(head + "always forall v in cars: v.on -> v.x > 3")
    assert str(spec) == "always(forall v in cars: v.on -> v.x > 3)"
    assert rtamt.parse(head + str(spec)).formula == spec.formula
    data = {"car_1.pose.x": [5.0, 4.0], "car_1.on": [True, True]}
    assert spec.evaluate(data).robustness == 1
    bounded = rtamt.parse(head + "forall v in cars: v.on -> v.x > 3").monitor()
    assert bounded.update(0.0, **{"car_1.pose.x": 5.0, "car_1.on": True}) == 2
    (finding,) = rtamt.parse(head + "input float t [s] forall v in cars: v.x > t").warnings
    assert finding.code == "RT301"


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        (
            "float x = 3",
            "expected the recorded name of 'x', what follows the member of 'cars', in double quotes, "
            "such as \"pose.x\"; got '3'",
        ),
        ('float x = "a" float y = "a"', "two fields of 'cars' are recorded as 'a'"),
        ('float x = "a"', "'a' is not a field of 'cars'; fields: x"),
    ],
)
def test_what_is_wrong_with_the_recorded_name_of_a_field_is_one_sentence(fields, message):
    with pytest.raises(SpecificationError) as error:
        rtamt.parse(f'group cars = "car_*" {{ {fields} }}; forall v in cars: v.a > 3')
    assert error.value.message == message
