"""Every sentence about a formula that cannot be read, in full, with its caret."""

import sys

import pytest

from rtamt.errors import BoundError, NameInFormulaError, ParseError, SpecificationError, UsageError
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.parsing.specfile import parse_document
from tests.errors.carets import with_carets

# Text, what stands under the line in which the error is, class, sentence.
FORMULAS = [
    ("", "^", ParseError, "the text is empty"),
    ("   // nothing", "^", ParseError, "the text is empty"),
    ("x >= ", "    ^", ParseError, "expected an operand after '>=', got the end of the text"),
    ("and x", "^^^", ParseError, "expected a formula, got 'and'"),
    ("x and and y", "      ^^^", ParseError, "expected an operand after 'and', got 'and'"),
    ("x + * y", "    ^", ParseError, "expected an operand after '+', got '*'"),
    ("()", " ^", ParseError, "expected an operand after '(', got ')'"),
    ("(x", "^", ParseError, "this '(' is never closed"),
    ("(x and (y or z)", "^", ParseError, "this '(' is never closed"),
    ("pow(x, 2", "   ^", ParseError, "this '(' is never closed"),
    ("(x y", "   ^", ParseError, "expected an operator between 'x' and 'y'"),
    ("(x]", "  ^", ParseError, "expected an operator or ')', got ']', which no '[' opens"),
    ("x)", " ^", ParseError, "expected an operator or the end, got ')', which no '(' opens"),
    ("x y", "  ^", ParseError, "expected an operator between 'x' and 'y'"),
    ("x adn y", "  ^^^", ParseError, "expected an operator between 'x' and 'adn'; did you mean 'and'?"),
    ("alway x", "^^^^^", ParseError, "expected an operator between 'alway' and 'x'; did you mean 'always'?"),
    ("rise p", "     ^", ParseError, "expected '(' after 'rise', got 'p'; write rise(...)"),
    ("abs 2 > 1", "    ^", ParseError, "expected '(' after 'abs', got '2'; write abs(...)"),
    ("2x", " ^", ParseError, "expected an operator between '2' and 'x'"),
    ("x !y", "  ^", ParseError, "expected an operator between 'x' and '!'"),
    ("x, y", " ^", ParseError, "expected an operator or the end, got ','"),
    ("x >= 1;", "      ^", ParseError, "expected an operator or the end, got ';'"),
    (
        "gap => 5",
        "    ^^",
        ParseError,
        "'=>' is no operator; write '->' for an implication, '>=' for at least",
    ),
    ("x = 3", "  ^", ParseError, "'=' gives a name to a formula; use == for equality"),
    ("x**2 > 3", " ^^", ParseError, "'**' is no operator; write pow(x, 2) for a power"),
    ("|x| > 3", "^", ParseError, "expected a formula, got '|'; write abs(x) for an absolute value"),
    (
        "p and |x| > 3",
        "      ^",
        ParseError,
        "expected an operand after 'and', got '|'; write abs(x) for an absolute value",
    ),
    ("~p", "^", ParseError, "unexpected character '~'; write not"),
    ("[]p", "^^", ParseError, "'[]' is no operator; write always"),
    ("p -> <>q", "     ^^", ParseError, "'<>' is no operator; write eventually"),
    ("x <> 3", "  ^^", ParseError, "'<>' is no operator; write !="),
    ("p ==> q", "  ^^^", ParseError, "'==>' is no operator; write ->"),
    ("x < > 3", "    ^", ParseError, "expected an operand after '<', got '>'"),
    (
        "x[0:1]",
        " ^",
        ParseError,
        "expected an operator or the end, got '['; intervals follow temporal operators",
    ),
    (
        "always(setpoint.position[2] > 0)",
        "       ^^^^^^^^^^^^^^^^^^",
        ParseError,
        "expected an operator or ')', got '['; if setpoint.position[2] is the name of a signal, write it in quotes: "
        '"setpoint.position[2]"',
    ),
    (
        "battery[1].v > 0",
        "^^^^^^^^",
        ParseError,
        "expected an operator or the end, got '['; if battery[1].v is the name of a signal, write it in quotes: "
        '"battery[1].v"',
    ),
    ("x ≥ 3", "  ^", ParseError, "unexpected character '≥'; write >="),
    ("x > 3 # fast", "      ^", ParseError, "unexpected character '#'; a comment begins with //"),
    ("[0:5]", "^", ParseError, "expected a formula, got '['"),
    (
        "zigzag(x)",
        "^^^^^^",
        ParseError,
        "'zigzag' is not a function; functions: abs, sqrt, exp, pow, log, ln, min, max, sin, cos, tan, asin, acos, "
        "atan, atan2, hypot and 29 more",
    ),
    (
        "abz(x)",
        "^^^",
        ParseError,
        "'abz' is not a function; did you mean 'abs'? (functions: abs, sqrt, exp, pow, log, ln, min, max, sin, cos, "
        "tan, asin, acos, atan, atan2, hypot and 29 more)",
    ),
    (
        "wrap(x, 0, y > 3) > 1",
        "           ^^^^^",
        ParseError,
        "'wrap' takes a number, and 'y > 3' is a formula, true or false; write a signal or arithmetic, "
        "such as (if y > 3 then 1 else 0)",
    ),
    (
        "minimum[0:2](once x) > 1",
        "             ^^^^^^",
        ParseError,
        "'minimum' takes a number, and 'once x' is a formula, true or false; write a signal or arithmetic, "
        "such as (if once x then 1 else 0), or duration(once x) for how long it holds",
    ),
    (
        "if x > 3",
        "        ^",
        ParseError,
        "expected 'then' after '3', got the end of the text; a choice is written if x > 3 then 1 else 0, "
        'and a variable with this name "if"',
    ),
    (
        "(if x > 3 then y) > 2",
        "                ^",
        ParseError,
        "expected 'else' after 'y', got ')'; a choice is written if x > 3 then 1 else 0, "
        'and a variable with this name "if"',
    ),
    (
        "if x > 3 then y > 2 else 3",
        "              ^^^^^",
        ParseError,
        "'if' takes a number, and 'y > 2' is a formula, true or false; write a signal or arithmetic, "
        "such as (if y > 2 then 1 else 0)",
    ),
    (
        "x + if x > 3 then y else 3",
        "    ^^",
        ParseError,
        "'if' binds more weakly than the '+' before it; put parentheses around it: + (if ...)",
    ),
    (
        "sum[0:2](x >= 3) > 1",
        "         ^^^^^^",
        ParseError,
        "'sum' takes a number, and 'x >= 3' is a formula, true or false; write a signal or arithmetic, "
        "such as (if x >= 3 then 1 else 0), or duration(x >= 3) for how long it holds",
    ),
    (
        "delay[1:2](x) > 1",
        "       ^",
        ParseError,
        "'delay' takes one duration, such as delay[5], got ':'",
    ),
    (
        "delay[1](x > 2) > 1",
        "         ^^^^^",
        ParseError,
        "'delay' takes a number, and 'x > 2' is a formula, true or false; write a signal or arithmetic, "
        "such as (if x > 2 then 1 else 0), or duration(x > 2) for how long it holds",
    ),
    ("held(x) > 1", "^^^^^^^", ParseError, "'held' takes 2 or 3 operands, got 1"),
    (
        "rate[0](x) > 1",
        "     ^",
        BoundError,
        "'rate' divides by its duration, which may not be 0; write one such as rate[1]",
    ),
    ("ahead[inf](x) > 1", "      ^^^", BoundError, "a duration may not be infinite"),
    ("min(x)", "^^^^^^", ParseError, "'min' takes 2 or more operands, got 1"),
    ("abs(x, y)", "^^^^^^^^^", ParseError, "'abs' takes 1 operand, got 2"),
    ("abs[0:1](x)", "   ^", ParseError, "'abs' takes no interval"),
    ("x ^ 2", "  ^", ParseError, "unexpected character '^'; write pow(x, 2) for a power"),
    ("x /* y", "  ^^", ParseError, "this comment is never closed"),
    ('"x >= 1', "^", ParseError, "this quoted name is never closed"),
    (
        "1 <= x >= 3",
        "^^^^^^^^^^^",
        ParseError,
        "only comparisons in one direction chain; write 1 <= x and x >= 3, or use parentheses",
    ),
    (
        "x > 1 == y > 2",
        "^^^^^^^^^^",
        ParseError,
        "only comparisons in one direction chain; write x > 1 and 1 == y, or use parentheses",
    ),
    (
        "x - prev(x) >= 1",
        "    ^^^^",
        ParseError,
        "'prev' binds more weakly than the '-' before it; put parentheses around it: - (prev ...)",
    ),
    (
        "-always x >= 1",
        " ^^^^^^",
        ParseError,
        "'always' binds more weakly than the '-' before it; put parentheses around it: - (always ...)",
    ),
    (
        "x >= not y > 1",
        "     ^^^",
        ParseError,
        "'not' binds more weakly than the '>=' before it; put parentheses around it: >= (not ...)",
    ),
    (
        "always",
        "^^^^^^",
        ParseError,
        "expected an operand after 'always', got the end of the text; if it is a variable, write \"always\"",
    ),
    (
        "x and always",
        "      ^^^^^^",
        ParseError,
        "expected an operand after 'always', got the end of the text; if it is a variable, write \"always\"",
    ),
    (
        "always until x",
        "^^^^^^",
        ParseError,
        "expected an operand after 'always', got 'until'; if it is a variable, write \"always\"",
    ),
    (
        "x >= 1 until",
        "            ^",
        ParseError,
        "expected an operand after 'until', got the end of the text",
    ),
    ("until", "^^^^^", ParseError, "expected a formula, got 'until'"),
    ("1e999", "^^^^^", ParseError, "1e999 is larger than every double; for infinity write inf"),
    (
        "x precedes y",
        "  ^^^^^^^^",
        BoundError,
        "'precedes' needs an interval with an upper bound, such as precedes[0:5]",
    ),
    (
        "x precedes[0:inf] y",
        "             ^^^",
        BoundError,
        "'precedes' needs an interval with an upper bound, such as precedes[0:5]",
    ),
    ("always[5:1] x", "      ^^^^^", BoundError, "the interval [5:1] is reversed: it ends before it begins"),
    (
        "always[500ms:0.1s] x",
        "      ^^^^^^^^^^^^",
        BoundError,
        "the interval [500ms:0.1s] is reversed: it ends before it begins",
    ),
    (
        "always[-1:1] x",
        "       ^^",
        BoundError,
        "a bound may not be negative; for the past use a past operator",
    ),
    ("always[inf:inf] x", "       ^^^", BoundError, "the lower bound of an interval may not be infinite"),
    ("always[0:1e-999] x", "         ^^^^^^", BoundError, "the bound is beyond the range of a double"),
    ("always[0:1/0] x", "         ^^^", BoundError, "a bound may not be divided by zero"),
    ("always[0;5] x", "        ^", ParseError, "expected ':' or ',' and an upper bound, got ';'"),
    ("always[5] x", "        ^", ParseError, "expected ':' or ',' and an upper bound, got ']'"),
    ("always[0 5] x", "         ^", ParseError, "expected ':' or ',' and an upper bound, got '5'"),
    ("always[0:5 x", "           ^", ParseError, "expected ']' after the bounds, got 'x'"),
    ("always[0:5", "          ^", ParseError, "expected ']' after the bounds, got the end of the text"),
    ("always(0:5 x", "        ^", ParseError, "expected an operator or ')', got ':'"),
    (
        "always(0,5)",
        "        ^",
        ParseError,
        "expected an operator or ')', got ','; intervals are in brackets, such as always[0:5]",
    ),
    (
        "x >= 0,5",
        "      ^",
        ParseError,
        "expected an operator or the end, got ','; write 0.5 with a decimal point",
    ),
    ("x >= 0, 5", "      ^", ParseError, "expected an operator or the end, got ','"),
    (
        "(x >= 50%)",
        "        ^",
        ParseError,
        "expected an operator or ')', got '%'; percentages are shares of a window, such as "
        "atleast[0:10](95%, x >= 1)",
    ),
    (
        "x <= 36 km/h",
        "        ^^",
        ParseError,
        "expected an operator between '36' and 'km'; numbers have no unit: declare that of the signal, such as "
        "float speed [m/s]",
    ),
    (
        "always(5,5] x",
        "      ^^^^^",
        BoundError,
        "the interval (5,5] is empty: it excludes its only instant; close both bounds, or move one",
    ),
    (
        "x until[2s:2s) y",
        "       ^^^^^^^",
        BoundError,
        "the interval [2s:2s) is empty: it excludes its only instant; close both bounds, or move one",
    ),
    (
        "precedes_ and x precedes(0, inf) y",
        "                            ^^^",
        BoundError,
        "'precedes' needs an interval with an upper bound, such as precedes[0:5]",
    ),
    ("always[:5] x", "       ^", ParseError, "expected a bound (a number or a constant), got ':'"),
    ("always[0:1/x] x", "           ^", ParseError, "expected a number after '/', got 'x'"),
    (
        "always[0:5day] x",
        "          ^^^",
        ParseError,
        "'day' is not a unit of time; units: h, min, s, ms, us, ns",
    ),
    ("always[0:inf s] x", "             ^", ParseError, "an infinite bound has no unit; leave out 's'"),
    (
        "always[0:T] x",
        "         ^",
        NameInFormulaError,
        "'T' is not a declared constant; a bound is a number, a constant or inf",
    ),
    ("not[0:5] x", "   ^", ParseError, "'not' takes no interval"),
    ("x +[0:1] y", "   ^", ParseError, "'+' takes no interval"),
    ("\tx >= )", "\t     ^", ParseError, "expected an operand after '>=', got ')'"),
]


@pytest.mark.parametrize(("text", "marks", "kind", "sentence"), FORMULAS)
def test_formula(text, marks, kind, sentence):
    with pytest.raises(SpecificationError) as info:
        parse_formula(text)
    assert type(info.value) is kind
    assert str(info.value) == with_carets(text, marks, sentence)
    assert info.value.message == sentence
    assert info.value.text == text


def test_the_caret_stands_in_the_right_line():
    with pytest.raises(ParseError) as info:
        parse_formula("x >= 1 and\n  y >== 2\n  or z")
    assert str(info.value) == (
        "expected an operand after '>=', got '='\n  line 2, column 7:\n      y >== 2\n          ^"
    )


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("gmt", "'gmt' is not declared; did you mean 'gnt'?"),
        ("speed", "'speed' is not declared; declared names: gnt, req"),
        ("/ns/gnt", "'/ns/gnt' is not declared; did you mean 'gnt'?"),
        ("inf.value", "'inf.value' is not declared; declared names: gnt, req"),
    ],
)
def test_a_name_that_is_not_declared(name, sentence):
    text = f"req >= 3 -> {name} >= 3"
    with pytest.raises(NameInFormulaError) as info:
        parse_formula(text, variables=["req", "gnt"])
    assert str(info.value) == with_carets(text, " " * 12 + "^" * len(name), sentence)


@pytest.mark.parametrize("text", ["x >= 1 and and y", "x and and >= y"])
def test_a_missing_operand_is_not_an_undeclared_name(text):
    with pytest.raises(ParseError) as info:
        parse_formula(text, variables=["x", "y"])
    assert info.value.message == "expected an operand after 'and', got 'and'"


def test_an_operator_without_operand_is_not_an_undeclared_name():
    with pytest.raises(ParseError) as info:
        parse_formula("next >= 3", variables=["x"])
    assert info.value.message == (
        "expected an operand after 'next', got '>='; if it is a variable, write \"next\""
    )


TOO_DEEP = (
    "nested too deeply: at most 200 formulas may stand inside one another; "
    "give an inner one a name and use the name"
)


@pytest.mark.parametrize(
    "text",
    [
        "(" * 100_000,
        "(" * 201 + "x" + ")" * 201,
        "not " * 10_000 + "x",
        "-" * 10_000 + "x",
        "abs(" * 10_000,
        "x -> " * 10_000 + "x",
        "always[0:5] " * 10_000 + "x",
        "G" + " G" * 10_000 + " >= 1",
    ],
)
def test_nesting_too_deep_is_a_sentence_and_no_recursion_error(text):
    with pytest.raises(ParseError) as info:
        parse_formula(text)
    assert info.value.message == TOO_DEEP


def test_nesting_too_deep_for_the_stack_of_the_caller():
    def descend(depth):
        if depth:
            return descend(depth - 1)
        return parse_formula("(" * 150 + "x" + ")" * 150)

    room = sys.getrecursionlimit() - 250
    with pytest.raises(ParseError) as info:
        descend(room)
    assert info.value.message == TOO_DEEP


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: parse_formula(3), "a formula is text, got int"),
        (lambda: parse_formula("x", unit="d"), "'d' is not a unit of time; units: h, min, s, ms, us, ns"),
        (lambda: parse_document(None), "a formula is text, got NoneType"),
    ],
)
def test_arguments_that_do_not_fit(call, sentence):
    with pytest.raises(UsageError) as info:
        call()
    assert str(info.value) == sentence
