"""What is legal and seldom meant: every rule finds its example, and nothing in what is meant."""

import copy

import pytest
from conformance.cases import FILES, read

import rtamt
from rtamt.language.parsing.specfile import parse_document
from rtamt.lint.report import findings
from rtamt.lint.rules import ALL, CODES


def found(text):
    document = parse_document(text)
    return [(each.code, text[each.span.start : each.span.end]) for each in findings(document)]


@pytest.mark.parametrize("rule", ALL, ids=CODES)
def test_the_bad_example_of_a_rule_has_its_finding_only_and_the_good_one_none(rule):
    assert [code for code, _ in found(rule.bad)] == [rule.code]
    assert found(rule.good) == []


def test_codes_are_unique():
    assert len(set(CODES)) == len(CODES)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("always(x)", [("RT101", "x")]),
        ("not gap", [("RT101", "gap")]),
        ("input bool p  input float x  p and x > 1", []),
        ("x >= -inf", []),
        ("const float limit = 3; float x; x > 1 or limit > 2", [("RT103", "limit > 2")]),
        ("parameter float limit = 3; float x; x > 1 or limit > 2", []),
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
        # What names and templates stand for is written elsewhere.
        ("low = x > 1; always(low and low)", [("RT501", "low and low")]),
        ("def twice(p) = p and p\nalways(twice(x > 1))", []),
        ('import "signals.stl"\nstays(x, 5, 3)', [("RT405", "stays(x, 5, 3)")]),
        ("5 <= x <= 3", [("RT405", "5 <= x <= 3")]),
        ("x >= 3 and x <= 3", []),
        ("x > 3 and x <= 3", [("RT405", "x > 3 and x <= 3")]),
        ("3 < x and x >= 1", [("RT407", "x >= 1")]),
        ("x > 3 or y > 2 or x > 5", [("RT407", "x > 5")]),
        ("x in {1, 2} and x == 3", []),
        ("float x; parameter float low = 3  x > low and x < 2", []),
        ("x > x", [("RT501", "x > x")]),
        ("x + x > x * x", []),
        ("max(x, x) > 3", []),
        ("x > 3 -> x > 3", [("RT501", "x > 3 -> x > 3")]),
        ("-(-x) > 3", [("RT503", "-(-x)")]),
        ("not (not (x > 3))", [("RT503", "not (not (x > 3))")]),
        ("once once (x > 3)", [("RT504", "once once (x > 3)")]),
        ("eventually always (x > 3)", [("RT505", "eventually always (x > 3)")]),
        ("historically once (x > 3)", []),
        ("x > 3 -> false", [("RT507", "false")]),
        ("once[2:2](true) and x > 3", []),
        ("(always x > 3) -> y > 2", []),
        ("always (x > 3) -> y > 2", []),
        ("eventually x > 3 -> y > 2", []),
        ("eventually[2:2](x > 3)", []),
        # The value of a parameter is a default.
        ("parameter float T = 0  float x  always[0:T](x > 3)", []),
        ("const float T = 0  float x  always[0:T](x > 3)", [("RT509", "always[0:T](x > 3)")]),
        ("parameter float T = 3  float x  always[0:T] eventually[0:3](x > 3)", []),
        # Ranges.
        ("float x in [0, 10]; float y; abs(x - 5) > 5.5 or y > 3", [("RT402", "abs(x - 5) > 5.5")]),
        ("float x in [0, 10]; eventually(x >= 0)", [("RT401", "eventually(x >= 0)")]),
        ("float x in [0, 10]; eventually[1:5](x >= 0)", [("RT401", "x >= 0")]),  # the trace may end before
        ("float x in [0, 10]; always[1:5](x >= 0)", [("RT401", "always[1:5](x >= 0)")]),
        ("float x in [0, 10]; delay[2](x) <= 10", [("RT401", "delay[2](x) <= 10")]),
        ("float x in [0, 10]; prev(x > 10)", [("RT402", "x > 10")]),  # at the first sample prev holds
        ("float x in [0, 10]; s_prev(x > 10)", [("RT402", "s_prev(x > 10)")]),
        ("float x in [0, 10]; sum[0:5](x) >= 0", [("RT401", "sum[0:5](x) >= 0")]),
        ("float x in [0, 10]; sum[0:5](x) <= 10", []),
        ("float x in [0, 10]; x - x > 1", []),
        # A function that has no value on a part of a range decides nothing.
        ("float x in [-1, 5]; sqrt(x) >= 0", []),
        ("float x in [0, 5]; sqrt(x) >= 0", [("RT401", "sqrt(x) >= 0")]),
        ("float x in [-1, 5]; ln(x) > 3", []),
        ("float x in [1, inf]; sqrt(x) >= 0", [("RT401", "sqrt(x) >= 0")]),
        ("float x in [0, 10]; float y; bool b; (x > 20 or y > 3) and b", [("RT402", "x > 20")]),
        ("float x in [0, 10]; float y; true or x > 20 or y > 1", [("RT507", "true"), ("RT402", "x > 20")]),
    ],
)
def test_what_is_found(text, expected):
    assert found(text) == expected


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "eventually[0:T] eventually[0:2](x > 3)",
            "'eventually' of 'eventually' is one window; add up their bounds in one",
        ),
        (
            "always[0:T] eventually[0:T](x > 3)",
            "always and eventually have the same bounds [0:T], and together reach twice as far; if one window "
            "is meant, remove one of them",
        ),
    ],
)
def test_messages_about_bounds_have_the_names_of_parameters(text, message):
    (warning,) = rtamt.parse(f"parameter float T = 3  float x  {text}").warnings
    assert (warning.message, warning.fix) == (message, None)


def test_ros_outputs_are_used():
    text = "from rtamt_msgs.msg import F  input F x  output F rob  rob.value = x.value + 1; require R: x.value > 1"
    assert found(text) == []


def test_one_requirement_that_was_selected_has_the_warnings_of_the_text_and_none_about_the_others():
    spec = rtamt.parse("require A: x > 1; require B: y > 2; low = x > 3")
    assert [warning.code for warning in spec.warnings] == ["RT202"]
    for selected in (spec.select("A"), spec.select("A").select("low"), copy.deepcopy(spec.select("B"))):
        assert selected.warnings == spec.warnings


def test_the_line_is_shown():
    (warning,) = findings(parse_document("x > 1 and\n  prev(x) - x <= 3"))
    assert str(warning) == (
        "RT105: 'prev' applies to all of '(x) - x <= 3'; write prev((x) - x <= 3) if that is meant\n"
        "  line 2, column 3:\n"
        "      prev(x) - x <= 3\n"
        "      ^^^^^^^^^^^^^^^^"
    )


def test_formulas_of_the_corpus_can_all_be_looked_at():
    codes = {
        each.code for name in FILES for case in read(name) for each in findings(parse_document(case.formula))
    }
    assert {"RT101", "RT103", "RT104"} <= codes <= set(CODES)


def test_the_default_of_a_parameter_decides_nothing():
    text = "{} float limit = 20  float x in [0, 10]  always(x <= limit)"
    assert [w.code for w in rtamt.parse(text.format("const")).warnings] == ["RT401"]
    assert rtamt.parse(text.format("parameter")).warnings == ()


def test_missing_samples_are_not_decided_by_ranges():
    assert rtamt.parse("float x in [2, 2]  valid(x)").warnings == ()


def test_comparisons_in_a_template_are_named_as_they_are_there():
    (found,) = rtamt.parse("def high(v) = v > 3 and v > 5; always(high(x))").warnings
    assert found.message == "'x > 3' changes nothing beside 'x > 5'; remove it"
