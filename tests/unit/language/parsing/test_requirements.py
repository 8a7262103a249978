"""Which formulas of a text must hold: those after ``require``, else those that nothing uses."""

import copy
import pickle

import pytest

import rtamt
from rtamt.errors import NameInFormulaError, ParseError, UsageError
from rtamt.language.document import Requirement
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.parsing.specfile import parse_document


def required(text):
    return [(requirement.name, str(requirement.formula)) for requirement in parse_document(text).requirements]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("x >= 3", [("requirement_1", "x >= 3")]),
        ("x >= 3; y >= 2", [("requirement_1", "x >= 3"), ("requirement_2", "y >= 2")]),
        ("low = x <= 3; y >= 2", [("low", "x <= 3"), ("requirement_2", "y >= 2")]),
        ("low = x <= 3; always(low)", [("requirement_1", "always(x <= 3)")]),
        ("a = x > 1; b = a; c = y > 2", [("b", "x > 1"), ("c", "y > 2")]),
        ("x > 1; sum = x + y", [("requirement_1", "x > 1")]),
        ("true; x + 1", [("requirement_1", "true")]),
        ("x + 1", [("requirement_1", "x + 1")]),
        ("low = x <= 3; low + 1", [("requirement_1", "(x <= 3) + 1")]),
        ("x > 1; requirement_1 = y > 2", [("requirement_1_", "x > 1"), ("requirement_1", "y > 2")]),
        ('a/b = x > 1; "the end" = y > 1', [("a/b", "x > 1"), ("the end", "y > 1")]),
        ("x > 1; require R: y > 1; z > 1", [("R", "y > 1")]),
        ("require R1: x > 1\nrequire R2: y > 1", [("R1", "x > 1"), ("R2", "y > 1")]),
        ("x > 0\nrequire R1: x > 1", [("R1", "x > 1")]),
        ("low = x <= 3\nrequire REQ-12.a: low", [("REQ-12.a", "x <= 3")]),
        ("require 12: x > 1; require 1e-5: y > 1", [("12", "x > 1"), ("1e-5", "y > 1")]),
        ('require "a b/c": x > 1', [("a b/c", "x > 1")]),
        ("require S: x > 1; require U-2: y > 1", [("S", "x > 1"), ("U-2", "y > 1")]),
        ('require and "text" severity note: x > 1', [("and", "x > 1")]),
        ("requirement_1 > 3", [("requirement_1_", "requirement_1 > 3")]),
        ('"requirement_1" > 3', [("requirement_1_", "requirement_1 > 3")]),
        ("def T(a) = a > requirement_1; T(x)", [("requirement_1_", "x > requirement_1")]),
    ],
)
def test_requirements_of_a_text(text, expected):
    assert required(text) == expected


def test_a_name_that_an_imported_formula_reads_is_taken(tmp_path):
    (tmp_path / "levels.stl").write_text("high = requirement_1 > 2")
    spec = rtamt.parse('import "levels.stl"\nalways(high)', folder=tmp_path)
    assert list(spec.requirements) == ["requirement_1_"]
    given = parse_document("always(high)", definitions={"high": parse_formula("requirement_1 > 2")})
    assert [requirement.name for requirement in given.requirements] == ["requirement_1_"]


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("require >= 3", '"require" >= 3'),
        ("require S x", '"require" since x'),
        ('require S "my x"', '"require" since "my x"'),
        ("require since-1 > 3", '"require" since (-1 > 3)'),
        ("require = x > 1; require", "x > 1"),
        ("float require; not require", 'not "require"'),
        ("from m import require  require x; x.a > 1", "x.a > 1"),
        ("severity >= require", '"severity" >= "require"'),
    ],
)
def test_require_is_a_name_wherever_it_could_be_one(text, meant):
    assert parse_document(text).formula == parse_formula(meant)


def test_what_is_written_about_a_requirement_is_kept():
    text = 'require REQ-1 "brakes ""in time""" severity warning: always(x > 1);'
    (requirement,) = parse_document(text).requirements
    formula = parse_formula("always(x > 1)")
    assert requirement == Requirement("REQ-1", formula, 'brakes "in time"', "warning", explicit=True)
    assert text[requirement.span.start : requirement.span.end] == text[:-1]


MESSAGES = [
    ("require R1 x > 1", "           ^", "expected ':' after 'require R1', got 'x'"),
    ("require R1", "          ^", "expected ':' after 'require R1', got the end of the text"),
    (
        "require R severity minor: x > 1",
        "                   ^^^^^",
        "expected a severity (error, warning, note), got 'minor'",
    ),
    (
        "require R: x + 1",
        "           ^^^^^",
        "'R' requires a number, which neither holds nor fails; compare it, such as x >= 0",
    ),
    (
        "require R: x > 1; require R: y > 1",
        "                          ^",
        "'R' is the name of another requirement or definition",
    ),
    (
        "low = x > 1; require low: low",
        "                     ^^^",
        "'low' is the name of another requirement or definition",
    ),
    (
        "float x; require x: x > 1",
        "                 ^",
        "'x' is the name of a variable; give the requirement another one",
    ),
    (
        "require R: x => 3",
        "             ^^",
        "'=>' is no operator; write '->' for an implication, '>=' for at least",
    ),
    ("require R: x = 3", "             ^", "'=' gives a name to a formula; use == for equality"),
    (
        'require "": x > 1',
        "        ^^",
        "the name of a requirement is one line of visible characters, such as REQ-12",
    ),
    (
        "const int c = 2; require c: x > c",
        "                         ^",
        "'c' is the name of a constant; give the requirement another one",
    ),
    ("require low: x > 1; low = x > 1", "                    ^^^", "'low' is defined twice"),
    (
        "require R1 = 3",
        "^^^^^^^",
        "'require' is not a type; types are float, int, long, complex, bool, and classes that are imported",
    ),
]


@pytest.mark.parametrize(("text", "marks", "sentence"), MESSAGES)
def test_messages(text, marks, sentence):
    with pytest.raises(ParseError) as caught:
        parse_document(text)
    column = marks.index("^") + 1
    assert str(caught.value) == f"{sentence}\n  line 1, column {column}:\n    {text}\n    {marks}"


def test_a_formula_cannot_read_a_requirement():
    text = "{}require R1: y > 1; R1 and x > 1"
    for declared in ("", "float x; float y; "):
        with pytest.raises(NameInFormulaError) as caught:
            parse_document(text.format(declared))
        assert caught.value.message == (
            "'R1' is the name of a requirement, which formulas cannot read; give its formula a name before it, such as "
            "holds = ..., and use that in both"
        )


def test_one_of_several_is_a_specification_of_its_own_also_after_pickling():
    spec = rtamt.parse("specification s; low = x <= 3; require A: always(low); require B: y > 1", period=2)
    one = spec.requirements["A"]
    for again in (one, pickle.loads(pickle.dumps(one)), copy.deepcopy(one)):
        assert (str(again.formula), again.name, again.input_names) == ("always(x <= 3)", "A", ("x",))
        assert again.period == 2
        assert list(again.requirements) == ["A"]
    assert (spec.name, spec.input_names) == ("s", ("x", "y"))
    assert str(spec.select("low")) == "x <= 3"
    with pytest.raises(UsageError, match="there is no requirement 'C'; requirements: low, A, B"):
        spec.select("C")


def test_a_requirement_is_a_signal_of_the_result_and_can_be_watched():
    spec = rtamt.parse("require A: always(x <= 3); require B: x >= 1")
    result = spec.evaluate({"x": [1, 2]})
    assert (result["A"].values.tolist(), result["B"].values.tolist()) == ([1, 1], [0, 1])
    monitor = rtamt.parse("require A: x <= 3; require B: x >= 1").monitor(watch=["A", "B"])
    assert (monitor.update(0.0, x=0), monitor["A"], monitor["B"]) == (-1, 3, -1)


def test_requirements_over_dense_signals_that_begin_at_different_times_have_traces_of_their_own():
    spec = rtamt.parse("require A: x >= 1; require B: y >= 2", time="dense")
    result = spec.evaluate({"x": ([0, 5], [0, 9]), "y": ([3, 6], [4, 0])})
    assert {name: part.signal.times[0] for name, part in result.requirements.items()} == {"A": 0, "B": 3}
    assert (result.robustness, result.requirements["A"].robustness) == (-1, -1)
    assert "first violation at 0 s" in str(result.requirements["A"].explain())


def test_the_classes_of_rtamt_take_the_last_assertion():
    spec = rtamt.StlDiscreteTimeSpecification()
    for name in ("a", "b"):
        spec.declare_var(name, "float")
    spec.spec = "require first: a >= 3; b >= 1"
    spec.parse()
    assert spec.evaluate({"time": [0, 1], "a": [0, 0], "b": [5, 6]}) == [[0, 4], [1, 5]]
