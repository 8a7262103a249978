"""Requirements of FRET, read."""

import json
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.errors import StlError, UsageError
from rtamt.interchange import FORMATS
from rtamt.interchange.fret.project import EXACT_NOTE, UNITS_NOTE, read_fret


def formula(sentence: str, period: str | None = None) -> str:
    found = read_fret(f"R: {sentence}", None if period is None else Fraction(period))
    assert found.rejected == ()
    return str(rtamt.parse(found.text).formula)


def reason(sentence: str) -> str:
    (rejected,) = read_fret(f"R: {sentence}").rejected
    return rejected.reason


@pytest.mark.parametrize(
    ("sentence", "expected"),
    [
        ("The pump shall always satisfy level > 3.", "always(level > 3)"),
        ("Shall the pump satisfy on", "eventually on"),
        ("Upon c the pump shall immediately satisfy on", "always(rise(c) -> on)"),
        ("Whenever c & !d the pump shall never satisfy on", "always(once(c and not d) -> not on)"),
        ("if c is false, unless d the pump shall, within 3 ticks, satisfy on",
         "always(rise(not c and not d) -> eventually[0:3] on or always[3:3] false)"),
        ("when c or when d the pump shall for 2 ticks satisfy on", "always(rise(c or d) -> always[0:2] on)"),
        ("in cruise mode the car shall always satisfy v > 20", "always(cruise -> v > 20)"),
        ("when not in cruise mode, the car shall never satisfy v > 20", "always(not cruise -> not(v > 20))"),
        ("except while gear = 0 the car shall always satisfy on", "always(not(gear == 0) -> on)"),
        ("The p shall always satisfy if a & b then c | d xor e", "always(a and b -> ((c or d) xor e))"),
        ("The p shall always satisfy !x > 3 & -y^2 + 1 < 2 * z mod 3",
         "always(not(x > 3) and -pow(y, 2) + 1 < mod(2 * z, 3))"),
        ("The p shall always satisfy absReal(x) <= maxInt(y, -2)", "always(abs(x) <= max(y, -2))"),
        ("The p shall always satisfy preReal(0, x) < x", "always(delay[1](x, 0) < x)"),
        ("The p shall always satisfy preBool(a, b)", "always(s_prev b or prev false and a)"),
        ("The p shall always satisfy occurred(4, a) & persists(2, b)",
         "always(once[0:4] a and (always[0:2] b and eventually[2:2] true))"),
    ],
)  # fmt: skip
def test_the_formula_of_a_sentence(sentence: str, expected: str) -> None:
    assert formula(sentence) == str(rtamt.parse(_declared(expected)).formula)


def _declared(text: str) -> str:
    booleans = (f"bool {each}" for each in ("on", "a", "b", "c", "d", "e", "cruise"))
    return "\n".join([*booleans, *(f"float {each}" for each in ("level", "x", "y", "z", "v", "gear")), text])


def test_a_unit_of_time_is_a_sample_unless_a_period_is_given() -> None:
    sentence = "The p shall within 3 secs satisfy x > 1"
    assert formula(sentence) == "eventually[0:3](x > 1) or always[3:3] false"
    assert formula(sentence, "1/2") == "eventually[0:3](x > 1) or always[3:3] false"
    assert (
        formula("The p shall within 3 ticks satisfy x > 1", "1/2")
        == "eventually[0:1.5](x > 1) or always[1.5:1.5] false"
    )
    assert (
        formula("The p shall after 2 minutes satisfy x > 1")
        == "always[0:120](not(x > 1)) and always[180:180](x > 1)"
    )
    assert UNITS_NOTE in read_fret(f"R: {sentence}").notes
    assert read_fret("R: The p shall always satisfy x = 1").notes == (EXACT_NOTE,)


def test_durations_of_several_units_need_a_period() -> None:
    text = "A: the p shall within 3 secs satisfy x > 1\nB: the p shall for 2 minutes satisfy x > 1"
    with pytest.raises(
        UsageError, match=r"durations are in minutes, secs, .* give the sampling period, such as 100ms"
    ):
        read_fret(text)
    assert len(rtamt.parse(read_fret(text, Fraction(1)).text).requirements) == 2
    (rejected,) = read_fret("A: the p shall within 3 secs satisfy x > 1", Fraction(2)).rejected
    assert "3 secs are not a whole number of periods of 2 s" in rejected.reason


@pytest.mark.parametrize(
    ("sentence", "message"),
    [
        (
            "the pump shall satisfy",
            "expected a variable, a number or an expression, found the end of the sentence",
        ),
        ("the pump shall always x > 3", "expected 'satisfy' before the response, found 'x'"),
        ("the pump always satisfy x > 3", "expected 'shall' after the component, found 'always'"),
        ("the pump shall with probability > 0.9 satisfy x > 3", "probabilities are not covered"),
        ("the pump shall within 3 parsecs satisfy x > 3", "expected a unit of time (ticks, microsecs"),
        ("the pump shall always satisfy 1 < x < 3", "'<' cannot follow '<': join two comparisons by '&'"),
        ("the pump shall always satisfy x + 1", "this is a number, where a formula is needed"),
        ("the pump shall always satisfy (a & b) + 1 > x", "this is true or false, where a number is needed"),
        ("the pump shall always satisfy f(x) > 3", "'f' is no function here"),
        ("the pump shall always satisfy absReal(x, y) > 3", "'absReal' takes 1 arguments, not 2"),
        ("the pump shall always satisfy occurred(n, a)", "'occurred' takes a whole number of samples first"),
        ("the pump shall always satisfy x > 3 § 4", "'§' is not part of FRETish"),
        ('"a text of one\'s own"', "a text in quotes is not FRETish: it has no formula"),
        ("whenever a and when b the pump shall always satisfy x > 3", "'whenever' cannot be joined"),
        ("the pump shall always satisfy " + "(" * 200 + "x > 3", "expressions may nest 100 deep"),
        (
            "the pump shall always satisfy " + "a & " * 30_000 + "a",
            "a sentence may have 500 operators: split the requirement",
        ),
    ],
)
def test_what_is_no_sentence_is_left_out_with_the_reason_and_its_place(sentence: str, message: str) -> None:
    found = reason(sentence)
    assert found.startswith(message) or message in found.splitlines()[0]
    assert "^" in found


def test_the_json_of_a_project_with_its_variables() -> None:
    text = json.dumps({
        "requirements": [
            {"reqid": "R-1", "fulltext": "in cruise mode C shall satisfy gear = fifth", "rationale": 'so "fast"'},
            {"reqid": "R-2", "fulltext": "the car shall always satisfy next = ready", "rationale": ""},
            {"reqid": "R-2", "fulltext": "the car shall always satisfy x > 1"},
        ],
        "variables": [
            {"variable_name": "fifth", "idType": "Internal", "dataType": "integer", "assignment": "5"},
            {"variable_name": "gear", "idType": "Input", "dataType": "integer", "assignment": ""},
            {"variable_name": "ready", "idType": "Output", "dataType": "boolean", "assignment": ""},
            {"variable_name": "cruise", "idType": "Mode", "dataType": "boolean", "assignment": ""},
        ],
    })  # fmt: skip
    found = read_fret(text)
    assert found.converted == ("R-1", "R-2")
    assert found.rejected == (("R-2", "there are two requirements of this name"),)
    spec = rtamt.parse(found.text)
    assert (
        str(spec.requirements["R-1"].formula) == "always(rise(cruise) -> cruise until (cruise and gear == 5))"
    )
    assert spec.document.requirements[0].description == 'so "fast"'
    assert str(spec.requirements["R-2"].formula) == 'always("next" <-> ready)'
    roles = {each.name: (each.role, each.type) for each in spec.document.declarations if each.kind == "var"}
    assert roles == {
        "gear": ("input", "float"), "ready": ("output", "bool"), "cruise": (None, "bool"), "next": (None, "bool"),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "there is no sentence"),
        ("[1]", "expected FRET's JSON"),
        ("{", "the text is no JSON"),
        ("{}", "expected FRET"),
    ],
)
def test_a_text_that_is_nothing_of_fret(text: str, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        read_fret(text)


WORDS = (
    "when if in mode m the p shall within 3 ticks satisfy x > ( ) & ! occurred , until only before -".split()
)


@settings(max_examples=200)
@given(st.lists(st.sampled_from(WORDS), max_size=14).map(" ".join) | st.text(max_size=20))
def test_any_text_is_converted_or_rejected_in_a_sentence(sentence: str) -> None:
    try:
        found = FORMATS["fret"].read(f"R: {sentence}", None)
    except StlError:
        return
    if found.converted:
        rtamt.parse(found.text)


@pytest.mark.parametrize("character", ["\u2028", "\x85", "\f"])
def test_only_line_ends_end_a_sentence(character: str) -> None:
    found = read_fret(
        f"R1: the pump shall{character}always satisfy x > 3\rR2: the pump shall always satisfy x > 4"
    )
    assert (found.converted, found.rejected) == (("R1", "R2"), ())


def test_what_fret_defines_by_an_expression_was_a_signal_without_a_note() -> None:
    variables = [
        {"variable_name": "cruise", "idType": "Mode", "dataType": "boolean", "modeRequirement": "state = 4"},
        {"variable_name": "total", "idType": "Internal", "dataType": "double", "assignment": "x + y"},
        {"variable_name": "k", "idType": "Internal", "dataType": "double", "assignment": "2.5"},
        {"variable_name": "other", "idType": "Internal", "dataType": "double", "assignment": "x"},
    ]
    requirement = {"reqid": "P", "fulltext": "in cruise mode the car shall always satisfy total > k"}
    found = read_fret(json.dumps({"requirements": [requirement], "variables": variables}))
    assert found.notes == (
        "'cruise' is read from the trace; FRET defines it as 'state = 4'",
        "'total' is read from the trace; FRET defines it as 'x + y'",
    )


def test_a_negative_number_of_samples_is_rejected() -> None:
    assert "'persisted' takes a whole number of samples first" in reason(
        "the pump shall always satisfy persisted(-3, a)"
    )


def test_a_sentence_with_as_many_operators_as_it_may_have_is_read() -> None:
    found = read_fret("P: the pump shall always satisfy " + "a & " * 500 + "a")
    assert found.converted == ("P",)
