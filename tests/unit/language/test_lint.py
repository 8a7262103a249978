"""What is legal and seldom meant: every rule finds its example, and nothing in what is meant."""

import copy

import pytest
from conformance.cases import FILES, read

import rtamt
from rtamt.language.lint import CODES, RULES, warnings_of
from rtamt.language.parsing.specfile import parse_document


def found(text):
    document = parse_document(text)
    return [(each.code, text[each.span.start : each.span.end]) for each in warnings_of(document)]


def test_every_rule_finds_its_example_and_no_other_one_does():
    assert [[code for code, _ in found(rule.example)] for rule in RULES] == [[code] for code in CODES]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("always(x)", [("RT101", "x")]),
        ("not gap", [("RT101", "gap")]),
        ("input bool p  input float x  p and x > 1", []),
        ("x >= -inf", []),
        ("const float limit = 3; x > 1 or limit > 2", [("RT103", "limit > 2")]),
        ("const float none = 0; x / none > 1", [("RT104", "x / none")]),
        ("x / 2 > 0", []),
        ("sample 1s hold for 500ms; x > 3", [("RT106", "sample 1s hold for 500ms")]),
        ("sample 1s hold for 1s skip nan; x > 3", []),
        ('group cars = "car_*"  forall c in cars: c.x > 3', []),
        ("always[0:5](x + y) <= 3", [("RT105", "always[0:5](x + y) <= 3")]),
        ("not(x) > 3", [("RT105", "not(x) > 3")]),
        ("always (x + y) <= 3", []),
        ("always(x > 3) and y > 1", []),
        ("prev((x - 3) >= 2)", []),
        ("-(x) * 3 >= 2", []),
        ("abs(x) - x <= 3", []),
        ("sum = x + y; sum > 3", []),
        ("x + y", []),
        ("a = x + 1; b = y + 1", [("RT201", "a = x + 1"), ("RT201", "b = y + 1")]),
        ("speed = 30", [("RT201", "speed = 30")]),
        ("input float x  output float out  out = x + 1", []),
        ("x + 1", []),
        ("low = x > 1; require R: always(low)", []),
        ("low = x > 1; require R: y > 2", [("RT202", "low = x > 1")]),
    ],
)
def test_what_is_found(text, expected):
    assert found(text) == expected


def test_ros_outputs_are_used():
    text = "from rtamt_msgs.msg import F  input F x  output F rob  rob.value = x.value + 1; require R: x.value > 1"
    assert found(text) == []


def test_one_requirement_that_was_selected_has_the_warnings_of_the_text_and_none_about_the_others():
    spec = rtamt.parse("require A: x > 1; require B: y > 2; low = x > 3")
    assert [warning.code for warning in spec.warnings] == ["RT202"]
    for selected in (spec.select("A"), spec.select("A").select("low"), copy.deepcopy(spec.select("B"))):
        assert selected.warnings == spec.warnings


def test_the_line_is_shown():
    (warning,) = warnings_of(parse_document("x > 1 and\n  prev(x) - x <= 3"))
    assert str(warning) == (
        "RT105: 'prev' applies to all of '(x) - x <= 3'; write prev((x) - x <= 3) if that is meant\n"
        "  line 2, column 3:\n"
        "      prev(x) - x <= 3\n"
        "      ^^^^^^^^^^^^^^^^"
    )


def test_formulas_of_the_corpus_can_all_be_looked_at():
    codes = {
        each.code
        for name in FILES
        for case in read(name)
        for each in warnings_of(parse_document(case.formula))
    }
    assert {"RT101", "RT103", "RT104"} <= codes <= set(CODES)
