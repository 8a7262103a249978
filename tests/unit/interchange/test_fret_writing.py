"""Requirements written for FRET."""

import json

import pytest

import rtamt
from rtamt.errors import UsageError
from rtamt.interchange.fret.export import write_fret
from rtamt.interchange.fret.project import read_fret


def sentence(formula: str, declared: str = "bool a\nbool b\nfloat x\nfloat y") -> str:
    found = write_fret(rtamt.parse(f"{declared}\nrequire R: {formula}"), "pump")
    assert found.rejected == ()
    return str(json.loads(found.text)["requirements"][0]["fulltext"])


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("always(x <= 3)", "The pump shall always satisfy x <= 3"),
        ("always(a -> x <= 3)", "Whenever a the pump shall immediately satisfy x <= 3"),
        ("always(rise(a) -> eventually[0:4] b)", "When a the pump shall within 4 ticks satisfy b"),
        ("always(a and not b or x < 3)", "The pump shall always satisfy a & !b | x < 3"),
        ("eventually(a and (b or x > 1e-7))", "The pump shall eventually satisfy a & (b | x > 0.0000001)"),
        ("always(not(a and b))", "The pump shall never satisfy a & b"),
        ("a unless b", "The pump shall until b satisfy a"),
        ("always((x - y) - (x - -2) > 2 * (x + 1))", "The pump shall always satisfy x - y - (x - -2) > 2 * (x + 1)"),
        ("always(once[0:3] a or historically[0:2] b)",
         "The pump shall always satisfy occurred(3, a) | !occurred(2, !b)"),
        ("always(once[2:2] true and x > 1 -> b)",
         "Whenever persisted(2, true) & x > 1 the pump shall immediately satisfy b"),
        ("always(rate[1](x) <= 3)", "The pump shall always satisfy (x - preReal(x, x)) / 1 <= 3"),
        ("always(rise(a) or fall(b))",
         "The pump shall always satisfy a & preBool(true, !a) | preBool(true, b) & !b"),
    ],
)  # fmt: skip
def test_the_sentence_of_a_formula(formula: str, expected: str) -> None:
    assert sentence(formula) == expected


@pytest.mark.parametrize(
    ("formula", "reason"),
    [
        ("always(held(x, a) > 1)", "FRETish has no 'held' inside of an expression"),
        ("always(a -> historically b)", "FRETish has no 'historically' inside of an expression"),
        ("always(x + eventually[0:3] a > 2)", None),
        ("always(a or x)", "'x' is a number that stands for a formula"),
        ("always(a == 1)", "'a' is true or false and stands for a number"),
        ("always(mode > 1)", "'mode' cannot be a variable of FRETish"),
    ],
)
def test_what_fretish_cannot_express_is_left_out(formula: str, reason: str | None) -> None:
    text = f"bool a\nbool b\nfloat x\nfloat mode\nrequire R: {formula}\nrequire S: always(x > 1)"
    if reason is None:
        with pytest.raises(rtamt.SpecificationError):
            rtamt.parse(text)
        return
    found = write_fret(rtamt.parse(text))
    assert found.converted == ("S",)
    assert found.rejected[0].name == "R"
    assert reason in found.rejected[0].reason


def test_the_variables_of_the_project() -> None:
    spec = rtamt.parse(
        "specification pump\nenum Mode { OFF, AUTO = 4 }\ninput float level\noutput Mode state\nconst float full = 9\n"
        'require R-1 "not too full": always(level < full or state == OFF)'
    )
    found = write_fret(spec)
    content = json.loads(found.text)
    (requirement,) = content["requirements"]
    assert (requirement["reqid"], requirement["rationale"], requirement["project"]) == (
        "R-1",
        "not too full",
        "pump",
    )
    stored = {v["variable_name"]: (v["idType"], v["dataType"], v["assignment"]) for v in content["variables"]}
    assert stored == {
        "level": ("Input", "double", ""), "full": ("Internal", "double", "9.0"),
        "state": ("Output", "integer", ""), "OFF": ("Internal", "integer", "0"),
    }  # fmt: skip


def test_a_window_at_the_end_of_the_trace_is_noted() -> None:
    spec = rtamt.parse("require R: always(rise(x > 1) -> eventually[0:4](y > 1))")
    assert write_fret(spec).notes[1].endswith("the requirement may be violated there: R")
    assert read_fret(write_fret(spec).text).converted == ("R",)


def test_dense_time_and_odd_components_are_rejected() -> None:
    with pytest.raises(UsageError, match="FRETish is about samples"):
        write_fret(rtamt.parse("always(x > 1)", time="dense"))
    with pytest.raises(UsageError, match="'my pump' cannot be a component of FRETish"):
        write_fret(rtamt.parse("always(x > 1)"), "my pump")


@pytest.mark.parametrize(
    ("formula", "written"),
    [
        ("pow(-3, 2) > x", "-3 ^ 2 > x"),
        ("-pow(3, 2) > x", "-(3 ^ 2) > x"),
        ("-pow(x, 2) > y", "-x ^ 2 > y"),
        ("x - -3 > -y", "x - -3 > -y"),
    ],
)
def test_the_sign_of_a_number_binds_tighter_than_a_power(formula: str, written: str) -> None:
    assert sentence(f"always({formula})") == f"The pump shall always satisfy {written}"
    again = rtamt.parse(read_fret(f"P: the pump shall always satisfy {written}").text).formula
    assert again == rtamt.parse(f"always({formula})").formula


@pytest.mark.parametrize("name", ["tick", "Seconds", "next", "previous", "mod", "hour"])
def test_keywords_of_fret_were_written_as_variables_and_components(name: str) -> None:
    spec = rtamt.parse(f"bool {name}\nrequire P: always {name}")
    assert write_fret(spec).rejected == (
        ("P", f"'{name}' cannot be a variable of FRETish, where it is a keyword"),
    )
    with pytest.raises(UsageError, match=f"'{name}' cannot be a component of FRETish, where it is a keyword"):
        write_fret(spec, name)


@pytest.mark.parametrize("text", ["x > 1 and " * 4000 + "x > 1", "x + " * 4000 + "x > 1"])
def test_thousands_of_operators_in_a_row_were_an_internal_error(text: str) -> None:
    (rejected,) = write_fret(rtamt.parse(f"require P: always({text})")).rejected
    assert (
        rejected.reason == "more than 300 operators are in a row or inside one another: split the requirement"
    )
    assert sentence("always(" + "x > 1 and " * 290 + "a)").count("&") == 290
