"""Specification texts of more than one formula."""

from math import inf

import pytest

from rtamt.errors import NameInFormulaError, ParseError
from rtamt.language.document import Assertion, Declaration, Import
from rtamt.language.formula import Apply, Const, Var
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.parsing.specfile import parse_document

# The form of the paper's listing 8.
LISTING = """
// name
specification spec_x

// imports
from rtamt_msgs.msg import FloatStamped

// variable declarations
input FloatStamped req
output FloatStamped gnt
output FloatStamped rob

// annotations
@ topic(req, rtamt/req)
@ topic(gnt, /rtamt/gnt_2)
@ topic(rob, rtamt/rob)

// bfSTL property
rob.value = G[0,10]((req.value>=3)->(F[0,5](gnt.value>=3)))
"""


def test_the_form_of_the_papers_listing():
    document = parse_document(LISTING)
    assert document.name == "spec_x"
    assert document.imports == (Import("rtamt_msgs.msg", "FloatStamped"),)
    assert document.declarations == (
        Declaration("req", "FloatStamped", role="input"),
        Declaration("gnt", "FloatStamped", role="output"),
        Declaration("rob", "FloatStamped", role="output"),
    )
    assert dict(document.topics) == {"req": "rtamt/req", "gnt": "/rtamt/gnt_2", "rob": "rtamt/rob"}
    formula = parse_formula("G[0,10]((req.value>=3)->(F[0,5](gnt.value>=3)))")
    assert document.assertions == (Assertion("rob.value", formula),)
    assert document.formula == formula
    assert document.variables == ("req", "gnt", "rob")
    assert document.text == LISTING


@pytest.mark.parametrize("ending", ["", ";", " ; ", ";\n", "\n", " // done", "; /* done */ // done", ";;"])
def test_a_formula_alone_is_a_document(ending):
    document = parse_document("always(x >= 3)" + ending)
    assert document.assertions == (Assertion(None, parse_formula("always(x >= 3)")),)
    assert document.variables == ()


def test_earlier_names_are_replaced_by_their_formulas():
    document = parse_document("c = a + b; d = c >= -2; d and always(d)")
    assert [a.name for a in document.assertions] == ["c", "d", None]
    assert document.formula == parse_formula("a + b >= -2 and always(a + b >= -2)")
    assert dict(document.definitions) == {"c": parse_formula("a + b"), "d": parse_formula("a + b >= -2")}


def test_a_name_for_a_number_is_a_formula_too():
    assert parse_document("x = 3; y >= x").formula == parse_formula("y >= 3")
    assert parse_document("x = 3").assertions == (Assertion("x", Const(3.0)),)


def test_constants():
    document = parse_document(
        "const float low = -3.5; const int n = 2\nconst float top = inf; always[0:n](x >= low and x < top)"
    )
    assert document.constants == {"low": -3.5, "n": 2.0, "top": float("inf")}
    assert document.declarations[0] == Declaration("low", "float", "const", None, -3.5)
    assert document.formula == parse_formula("always[0:2](x >= -3.5 and x < inf)")
    assert document.variables == ()


def test_constants_alone_leave_the_names_free():
    assert parse_document("const float c = 1; x > c").formula == parse_formula("x > 1")


@pytest.mark.parametrize("kind", ["float", "int", "long", "complex", "bool"])
def test_types_that_need_no_import(kind):
    assert parse_document(f"{kind} x; x > 1").declarations == (Declaration("x", kind),)


def test_semicolons_after_declarations_may_be_there_or_not():
    rest = "output float y{0} const float c = 1{0} @ topic(x, a){0} x > c"
    loose, strict = (
        parse_document(("specification s{0} from m import C{0} input float x{0} " + rest).format(end))
        for end in ("", ";")
    )
    assert (loose.declarations, loose.topics, loose.formula) == (
        strict.declarations,
        strict.topics,
        strict.formula,
    )


def test_rtamts_files_with_a_definition_a_line_and_no_semicolons():
    text = """specification TTC
      float gap
      float fast
      float slow
      const float safe = 3.5

      closing = fast - slow
      near = - (gap) + safe * closing >= 0

      cond = near and fast > slow  // on one's own lane
      cond -> (gap / closing >= safe)
    """
    meant = "(-gap + 3.5 * (fast - slow) >= 0 and fast > slow) -> (gap / (fast - slow) >= 3.5)"
    assert parse_document(text).formula == parse_formula(meant)


@pytest.mark.parametrize("text", ["x >= 3\ny >= 3", "a = x >= 3 y >= 3", "x >= 3\na = y >= 3\na"])
def test_a_formula_without_a_name_is_not_passed_over_where_a_semicolon_is_missing(text):
    with pytest.raises(ParseError):
        parse_document(text)


def test_declared_elsewhere():
    document = parse_document(
        "ok and x > c; ", variables=["x"], constants={"c": 2.0}, definitions={"ok": Var("y")}, unit="ms"
    )
    assert document.formula == parse_formula("y and x > 2")
    assert (document.variables, dict(document.constants)) == (("x",), {"c": 2.0})
    with pytest.raises(NameInFormulaError) as info:
        parse_document("x > y", variables=["x"])
    assert str(info.value) == (
        "'y' is not declared; declared names: x\n  line 1, column 5:\n    x > y\n        ^"
    )
    assert parse_document("x > y", variables=[]).formula == parse_formula("x > y")


def test_the_unit_is_that_of_bounds_without_one():
    assert parse_document("always[0:5] x", unit="ms").formula == parse_formula("always[0:5ms] x")


@pytest.mark.parametrize(
    "text",
    [
        "input >= 3 and output < 2",
        "specification and x",
        "from > 1 and import < 2",
        "const -> float",
        "float >= 1 or topic >= 2",
        "int",
    ],
)
def test_no_word_is_reserved(text):
    assert parse_document(text).formula == parse_formula(text)


def test_variables_spelled_like_operators():
    document = parse_document(
        "float S; input float G; float always; G(S > 1) and x S always", variables=["x"]
    )
    assert document.formula == parse_formula('(always(S > 1)) and (x since "always")')


def test_names_in_quotes_and_paths():
    document = parse_document('float "my col"; a/b = "my col" > 1; "the end" = always(a/b); "the end"')
    assert [a.name for a in document.assertions] == ["a/b", "the end", None]
    assert document.formula == parse_formula('always("my col" > 1)')


def test_spans_are_places_in_the_whole_text():
    text = "float x;\nc = x > 1;\nalways(c)"
    document = parse_document(text)
    spans = [document.declarations[0].span, *(a.span for a in document.assertions)]
    assert [text[s.start : s.end] for s in spans] == ["x", "c = x > 1", "always(c)"]
    inner = document.formula.args[0].span
    assert text[inner.start : inner.end] == "x > 1"


def test_an_empty_document_is_an_error():
    with pytest.raises(ParseError) as info:
        parse_document("// nothing here\n")
    assert str(info.value) == "the text is empty\n  line 1, column 1:\n    // nothing here\n    ^"


def test_a_document_cannot_be_changed_through_its_tables():
    document = parse_document("float x; @topic(x, a); c = x; c")
    for table in (document.topics, document.constants, document.definitions):
        with pytest.raises(TypeError):
            table["x"] = None


def test_a_declared_name_may_hold_slashes_and_only_an_undeclared_one_divides():
    document = parse_document("input float robot/speed; input float limit; robot/speed >= limit / 2")
    assert document.variables == ("robot/speed", "limit")
    assert str(document.formula) == '"robot/speed" >= limit / 2'
    assert str(parse_document("input float a; input float b; a/b >= 2").formula) == "a / b >= 2"


def test_ranges_of_variables():
    document = parse_document(
        'input float v [m/s] in [0, 60] = "speed" or "v"  int n in [-inf, 3]; float in in [0.5, 1]; always(v + n > in)'
    )
    assert [(each.name, each.range) for each in document.declarations] == [
        ("v", (0.0, 60.0)),
        ("n", (-inf, 3.0)),
        ("in", (0.5, 1.0)),
    ]
    assert document.declarations[0].columns == ("speed", "v")


def test_rates_of_variables():
    document = parse_document(
        'float v [m/s] in [0, 60] rate [-8, 3] = "speed"  float rate rate [-inf, 0.5]  float w  rate[1](w) <= rate + v'
    )
    assert [(each.name, each.rate) for each in document.declarations] == [
        ("v", (-8.0, 3.0)),
        ("rate", (-inf, 0.5)),
        ("w", None),
    ]
    assert str(document.formula) == "rate[1](w) <= rate + v"


def test_a_variable_called_in_is_no_range():
    assert parse_document("float v; float in  in >= v").declarations[0].range is None


def test_a_text_with_groups_may_import_files():
    text = 'import "patterns.stl"\ngroup cars = "car_*"\nfloat gap\nrequire R: forall c in cars: absence(c.x > gap)'
    assert [each.name for each in parse_document(text).requirements] == ["R"]


@pytest.mark.parametrize("rest", ["\nfloat y [m]; x > y", "; float y [m]; x > y", " = 3]", ""])
def test_a_unit_ends_before_the_next_declaration(rest):
    with pytest.raises(ParseError) as caught:
        parse_document("float x [m/s" + rest)
    assert caught.value.message == "expected a unit and ']' after 'x [', such as [m/s]"


@pytest.mark.parametrize("text", ["if x > y then require else y", "if def then (x) else def"])
def test_words_of_statements_are_variables_beside_then_and_else(text):
    declared = "input bool def; input bool x; " if "def" in text else ""
    assert isinstance(parse_document(f"{declared}low = {text}; low").formula, Apply)
