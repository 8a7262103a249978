"""Templates: ``def settles(x, target) = ...`` and their uses."""

import pickle
import time

import pytest
from hypothesis import example, given

import rtamt
from rtamt.errors import BoundError, NameInFormulaError, ParseError
from rtamt.language.formula import children, postorder
from rtamt.language.parsing import templates
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.parsing.specfile import parse_document
from rtamt.language.printing.printer import to_text
from tests.support.strategies import formulas

SETTLES = "def settles(x, target, band, within) = eventually[0:within] always(abs(x - target) <= band)\n"


@pytest.mark.parametrize(
    ("use", "meant"),
    [
        ("settles(v, 10, 0.5, 5)", "eventually[0:5] always(abs(v - 10) <= 0.5)"),
        ("settles(v, target=10, band=0.5, within=5s)", "eventually[0:5s] always(abs(v - 10) <= 0.5)"),
        ("settles(within=1/3s, band=w, target=-z, x=v)", "eventually[0:1/3s] always(abs(v - (-z)) <= w)"),
        ("settles(v - w, 10, 0.5, inf)", "eventually[0:inf] always(abs(v - w - 10) <= 0.5)"),
        ("settles(v, 10, 1, 20ms) or v > 3", "eventually[0:20ms] always(abs(v - 10) <= 1) or v > 3"),
    ],
)
def test_a_use_stands_for_the_formula(use, meant):
    document = parse_document(SETTLES + use)
    assert document.formula == parse_formula(meant)
    assert parse_formula(to_text(document.formula)) == document.formula
    assert len(document.requirements) == 1


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("def f(x, w = 5s) = always[0:w] x\ndef g(y, w) = f(y, w) and f(y)\ng(v > 3, 2)",
         "always[0:2](v > 3) and always[0:5s](v > 3)"),
        ("const float far = 30; def f(x,\n limit = far\n) = x <= limit\nalways(f(v,\n limit = 7) and f(v))",
         "always(v <= 7 and v <= 30)"),
        ("near = d <= 30; def f(x) = near -> x\nf(b >= 1)", "d <= 30 -> b >= 1"),
        ("input float odom; def f(o) = o.x > 3; f(odom)", "odom.x > 3"),
        ("def = y > 3; def f(x) = def and x; f(def)", "y > 3 and y > 3"),
        ("def > 3", '"def" > 3'),
        ("def = x > 3; always(def)", "always(x > 3)"),
        ("def U x", '"def" until x'),
        ("x > 3\ndef f(y) = y > 4\nf(x)", "x > 3 and x > 4"),
    ],
)  # fmt: skip
def test_meaning_of_texts_with_templates(text, meant):
    assert parse_document(text).formula == parse_formula(meant)


MESSAGES = [
    ("settles(v, 10, 0.5)", ParseError, "^" * 19, "'within' of settles(x, target, band, within) is not given"),
    ("settles(v)", ParseError, "^" * 10,
     "'target' and 'band' and 'within' of settles(x, target, band, within) are not given"),
    ("settles(v, withn=5s)", NameInFormulaError, "           ^^^^^",
     "'settles' has no parameter 'withn'; did you mean 'within'?"),
    ("settles(v, q=5s)", NameInFormulaError, "           ^",
     "'settles' has no parameter 'q'; its parameters are x, target, band, within"),
    ("settles(v, 1, 2, 3, 4)", ParseError, "                    ^",
     "'settles' takes 4 arguments, got more; write settles(x, target, band, within)"),
    ("settles(v, 1, 2, x=3)", ParseError, "                 ^",
     "'x' of settles(x, target, band, within) is given twice"),
    ("settles(v, target=1, 2)", ParseError, "                     ^",
     "arguments without a name stand before those with one; write settles(x, target, band, within)"),
    ("settles(v, 1, 2, w)", BoundError, "^" * 19,
     "in 'settles': 'within' bounds an interval; give it a number or a duration, such as 5s"),
    ("settles(v, 1, 2, -3)", BoundError, "^" * 20,
     "in 'settles': a bound may not be negative; for the past use a past operator"),
    ("settles(v, 5s, 2, 3)", ParseError, "^" * 20,
     "in 'settles': 'target' is a duration, which only bounds an interval, such as [0:target]"),
    ("settles", ParseError, "^" * 7, "'settles' is a template; give it arguments: settles(x, target, band, within)"),
    ("setles(v)", NameInFormulaError, "^" * 6, "'setles' is not a function; did you mean 'settles'?"),
    ("settles(v", ParseError, "       ^", "this '(' is never closed"),
    ("settles(v; w)", ParseError, "         ^", "expected ',' or ')', got ';'"),
    ("def outer(y) = settles(y, 1, 2, y); outer(v)", BoundError, "                                    ^^^^^^^^",
     "in 'settles', which 'outer' uses: 'within' bounds an interval; give it a number or a duration, such as 5s"),
    ("def f(x) = f(x); f(v)", NameInFormulaError, "           ^",
     "'f' uses itself; templates cannot be recursive"),
    ("def f(x) = g(x)\ndef g(x) = h(x)\ndef h(x) = f(x)\nf(v)", NameInFormulaError, "           ^",
     "templates cannot be recursive, but f -> g -> h -> f"),
    ("def f(x) = g(x)\ndef g(x) = x > 3\nf(v)", NameInFormulaError, "           ^",
     "'g' is only defined further down; move its definition up"),
    ("def f(x, a, b) = always[a:b] x; f(v, 5, 2)", BoundError, "                                ^^^^^^^^^^",
     "in 'f': the interval [a:b] is reversed: it ends before it begins"),
    ("def f(x, a) = always[0:a ms] x; f(v, 5s)", BoundError, "                                ^^^^^^^^",
     "in 'f': 'a' has a unit already, s; leave out the unit here"),
    ("def f(o) = o.x > 3; f(v + 1)", ParseError, "                    ^^^^^^^^",
     "in 'f': 'o' is no signal here, and only signals have fields, such as o.x"),
    ("def f(x, x) = x > 3", ParseError, "         ^", "'f' has two parameters called 'x'"),
    ("def f() = x > 3", ParseError, "      ^", "expected the name of a parameter of 'f', got ')'"),
    ("def f(x = 1, y) = x > y", ParseError, "             ^",
     "the parameter 'y' has no default, but one before it has; move it up"),
    ("def max(x) = x > 3", ParseError, "    ^^^", "'max' is an operator; give the template another name"),
    ("def f(x) = x > 3; def f(x) = x > 4", ParseError, "                      ^", "'f' is defined twice"),
    ("def f(x) x > 3", ParseError, "         ^", "expected '=' and the formula of 'f', got 'x'"),
    ("def f(x, w) = always[0:w](x); f(v, 1/0s)", BoundError, "                                   ^",
     "this is no duration; write for example 5s or 1/3s"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "kind", "under", "message"), MESSAGES)
def test_messages(text, kind, under, message):
    with pytest.raises(rtamt.StlError) as caught:
        parse_document(SETTLES + text)
    assert type(caught.value) is kind
    said, _, line, carets = str(caught.value).split("\n")
    assert (said, carets[4:]) == (message, under), line


def test_an_error_found_later_points_at_the_use():
    with pytest.raises(BoundError) as caught:
        rtamt.parse(SETTLES + "v > 0; settles(v, 1, 2, 150ms)", period="100ms")
    assert "settles(v, 1, 2, 150ms)\n           ^^^^^^^^^^^^^^^^^^^^^^^" in str(caught.value)


def test_equal_uses_share_their_formula_and_arguments_are_not_copied():
    text = (
        "def twice(x) = x > 1 and x > 2\n"
        + SETTLES
        + "a = settles(v, 1, 2, 3); b = settles(v, 1, 2, 3); a and b"
    )
    document = parse_document(text)
    assert document.definitions["a"] is document.definitions["b"]
    chain = "".join(f"def f{i + 1}(x) = f{i}(x + x)\n" for i in range(60))
    shared = parse_document(f"def f0(x) = x > 0\n{chain}f60(v)").formula
    assert len(list(postorder(shared))) < 200


def test_a_hostile_file_is_rejected_in_seconds():
    doubled = "".join(f"def f{i + 1}(x) = f{i}(x + 1) and f{i}(x + 2)\n" for i in range(40))
    begin = time.perf_counter()
    with pytest.raises(ParseError, match="the templates of this text make more than 100,000 words of it"):
        parse_document(f"def f0(x) = x > 0\n{doubled}f40(v)")
    deep = "".join(f"def f{i + 1}(x{i}) = f{i}(x{i})\n" for i in range(3000))
    with pytest.raises(ParseError, match="nested too deeply"):
        parse_document(f"def f0(x) = x > 0\n{deep}f3000(v)")
    assert time.perf_counter() - begin < 30


def test_templates_are_no_requirements_and_survive_pickling():
    spec = rtamt.parse(SETTLES + "require R: settles(v, 1, 2, 3)")
    assert list(spec.requirements) == ["R"]
    again = pickle.loads(pickle.dumps(spec))
    assert again.formula == spec.formula
    monitor = again.monitor(time="discrete", watch=["settles(v, 1, 2, 3)"], verdict="interval")
    assert monitor is not None
    document = pickle.loads(pickle.dumps(spec.document))
    assert document.templates["settles"].signature == "settles(x, target, band, within)"


def test_a_parameter_that_bounds_an_interval_is_no_parameter_of_a_program():
    spec = rtamt.parse(
        "const int wait = 2; const int limit = 3\ndef f(x, w, l) = historically[0:w](x <= l)\nf(v, wait, limit)"
    )
    assert list(spec.compile().metadata.parameters) == ["limit"]


def test_nested_uses_search_a_long_argument_once(monkeypatch):
    searched = []
    monkeypatch.setattr(templates, "children", lambda node: searched.append(node) or children(node))
    nested = "".join(f"def f{i}(a) = f{i - 1}(a + {i})\n" for i in range(1, 20))
    argument = " + ".join(f"x{i}" for i in range(1000))
    uses = " and ".join(f"f19(b + {i})" for i in range(5))
    document = parse_document(f"def f0(a) = a >= 1\n{nested}def u(b) = {uses}\nu({argument})")
    assert len(postorder(document.formula)) > 1999
    assert (
        len(searched) < 5000
    )  # each use searched it, in the definition and here: 20 000 for each of the five


@given(formulas(variables=("x", "y"), max_depth=3), formulas(variables=("v", "w"), max_depth=2))
@example(parse_formula("sin(delay[0](x, y)) >= 0"), parse_formula("true"))
def test_a_use_is_the_formula_with_its_arguments_in_place_of_the_parameters(body, argument):
    text = f"def f(x, y) = {to_text(body)}\nf({to_text(argument)}, y=v + 2 * w)"
    try:
        meant = parse_formula(to_text(body), definitions={"x": argument, "y": parse_formula("v + 2 * w")})
    except ParseError as error:  # functions of numbers take no formula
        wrong = f"in 'f': {error.message}"
    else:
        assert parse_document(text).formula == meant
        return
    with pytest.raises(ParseError) as caught:
        parse_document(text)
    if to_text(argument) in ("true", "false"):  # they are Booleans beside a number, unless they have a name
        assert caught.value.message.startswith("in 'f': ")
    else:
        assert caught.value.message == wrong
