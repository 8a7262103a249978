"""Every sentence about a specification file that cannot be read, in full, with its caret."""

import pytest

from rtamt.errors import BoundError, NameInFormulaError, ParseError, SpecificationError
from rtamt.language.parsing.specfile import parse_document
from tests.errors.carets import with_carets

# Text, what stands under the line in which the error is, class, sentence.
DOCUMENTS = [
    ("", "^", ParseError, "the text is empty"),
    ("// c", "^", ParseError, "the text is empty"),
    (";", "^", ParseError, "expected a formula, got ';'"),
    ("= x", "^", ParseError, "expected a formula, got '='"),
    ("x = ", "   ^", ParseError, "expected an operand after '=', got the end of the text"),
    ("float x", "       ^", ParseError, "the text has declarations but no formula"),
    ("x y >= 1", "  ^", ParseError, "expected an operator between 'x' and 'y'"),
    ("foo x;", "    ^", ParseError, "expected an operator between 'foo' and 'x'"),
    (
        "bool p  rise p",
        "        ^^^^",
        NameInFormulaError,
        "'rise' is not declared; the operator is written rise(...)",
    ),
    ("flaot x float y x > 1", "^^^^^", ParseError, "'flaot' is not a type; did you mean 'float'?"),
    (
        "enum Mode { A, B }  input Mod m  m == A",
        "                          ^^^",
        ParseError,
        "'Mod' is not a type; did you mean 'Mode'?",
    ),
    (
        "enum Mode { A, B }  Mod m;  m == A",
        "                    ^^^",
        ParseError,
        "'Mod' is not a type; did you mean 'Mode'?",
    ),
    (
        "input Mod m  enum Mode { A, B }  m == A",
        "      ^^^",
        ParseError,
        "'Mod' is not a type; did you mean 'Mode'?",
    ),
    (
        "input Mode m  enum Mode { A, B }  m == A",
        "      ^^^^",
        ParseError,
        "'Mode' is declared further on; declare an enumeration before its variables",
    ),
    (
        "enum Mode { A, B }  Mode m  bool p  (if p then m else C) == A",
        "                                                      ^",
        NameInFormulaError,
        "'C' is no member of Mode; its members are A, B",
    ),
    (
        "enum Mode { A, B }  Mode m  held(m, m == A, C) == A",
        "                                            ^",
        NameInFormulaError,
        "'C' is no member of Mode; its members are A, B",
    ),
    (
        "parameter int most = 2.5  float x  x < most",
        "                     ^^^",
        ParseError,
        "'most' is 2.5, and declared as a whole number; declare it as float",
    ),
    (
        "input Foo x x > 1",
        "      ^^^",
        ParseError,
        "'Foo' is not a type; types are float, int, long, complex, bool, and classes that are imported",
    ),
    (
        "const float c x > 1",
        "            ^",
        ParseError,
        "the constant 'c' has no value; write const float c = ...",
    ),
    ("const float c = y", "                ^", ParseError, "expected a number, got 'y'"),
    (
        "table c = {(0, 1)} c(x) > 1",
        "          ^^^^^^^^",
        ParseError,
        "a table has at least 2 points, such as {(0, 1), (10, 4)}",
    ),
    (
        "table c = {(0, 1), (0, 2)} c(x) > 1",
        "                   ^^^^^^",
        ParseError,
        "the points of a table are in the order of increasing x, and 0 is not after 0",
    ),
    (
        "table c = {(0, 1e308), (3, -1e308)} c(x) > 1",
        "                       ^^^^^^^^^^^",
        ParseError,
        "this point is so far from the one before that no double holds the distance",
    ),
    (
        "table c = {(0, 1), (3, inf)} c(x)",
        "                       ^^^",
        ParseError,
        "expected a number, got 'inf'",
    ),
    (
        "table c = {(0, 1), 3} c(x)",
        "                   ^",
        ParseError,
        "expected a point of 'c', such as (0, 1), got '3'",
    ),
    ("table c = {(0, 1), (3, 4)", "          ^", ParseError, "this '{' is never closed"),
    (
        "table c = {(0, 1), (3, 4) c(x)",
        "                          ^",
        ParseError,
        "expected ',' or '}' after the point, got 'c'",
    ),
    (
        "table sin = {(0, 1), (3, 4)} sin(x)",
        "      ^^^",
        ParseError,
        "'sin' is an operator; give the table another name",
    ),
    (
        "table c = {(0, 1), (3, 4)} c > 1",
        "                           ^",
        ParseError,
        "'c' is a table; give it an operand: c(x)",
    ),
    (
        "table c = {(0, 1), (3, 4)} const int c = 1 x",
        "                                     ^",
        ParseError,
        "'c' is declared twice",
    ),
    ("float c; table c = {(0, 1), (3, 4)} c", "               ^", ParseError, "'c' is declared twice"),
    (
        "parameter float c x > 1",
        "                ^",
        ParseError,
        "the parameter 'c' has no value; write parameter float c = ...",
    ),
    (
        "parameter complex c = 1 x > 1",
        "          ^^^^^^^",
        ParseError,
        "a parameter is a number, a Boolean or a member of an enumeration, not 'complex'; "
        "choose from float, int, long, bool",
    ),
    (
        "float x = 3; x > 1",
        "        ^",
        ParseError,
        "a variable has no value of its own; define it after the declarations: x = ..., "
        'or give its recorded name in quotes: x = "..."',
    ),
    ("float x input int x x > 1", "                  ^", ParseError, "'x' is declared twice"),
    ("float x; const float x = 1; x > 1", "                     ^", ParseError, "'x' is declared twice"),
    (
        "float req; float req.value; x",
        "                 ^^^^^^^^^",
        ParseError,
        "'req.value' is a field of 'req', which is declared",
    ),
    (
        "input float position[2]; x",
        "            ^^^^^^^^^^^",
        ParseError,
        "'2' is not a unit; a name with brackets is written in quotes: \"position[2]\"",
    ),
    (
        "float x [; x",
        "        ^",
        ParseError,
        "expected a unit and ']' after 'x [', such as [m/s]",
    ),
    (
        "float x in [3, 1]; x",
        "        ^^^^^^^^^",
        ParseError,
        "the range of 'x' ends before it begins; exchange its ends",
    ),
    (
        "float x [m] in [3; x",
        "                 ^",
        ParseError,
        "expected the range of 'x', such as in [0, 60], got ';'",
    ),
    (
        "bool x in [0, 1]; x",
        "       ^^^^^^^^^",
        ParseError,
        "'x' is no number, so it has no range; leave out the range",
    ),
    (
        "float x in [0, 3] rate [2, 1]; x",
        "                  ^^^^^^^^^^^",
        ParseError,
        "the rate of 'x' ends before it begins; exchange its ends",
    ),
    (
        "float x rate [-1, 3; x",
        "                   ^",
        ParseError,
        "expected the rate of 'x', such as rate [-8, 3], got ';'",
    ),
    (
        "bool x rate [0, 1]; x",
        "       ^^^^^^^^^^^",
        ParseError,
        "'x' is no number, so it has no rate; leave out the rate",
    ),
    ("float true; x", "      ^^^^", ParseError, "'true' is a word of the language and cannot be a name"),
    ("true = x", "^^^^", ParseError, "'true' is a word of the language and cannot be a name"),
    ("from a.b", "        ^", ParseError, "expected 'import' after 'from a.b', got the end of the text"),
    (
        "from a import C from b import C x",
        "                              ^",
        ParseError,
        "'C' is imported twice",
    ),
    (
        "@ topic(x, a/b) x > 1",
        "        ^",
        NameInFormulaError,
        "'x' is not a declared variable; declare it before its topic",
    ),
    (
        "float req @ topic(rq, a) req",
        "                  ^^",
        NameInFormulaError,
        "'rq' is not a declared variable; did you mean 'req'?",
    ),
    (
        "float x @ topic(x, a) @ topic(x, b) x",
        "                              ^",
        ParseError,
        "'x' has two topics",
    ),
    (
        "float x @ frequency(x, a) x",
        "          ^^^^^^^^^",
        ParseError,
        "expected 'topic' after '@', got 'frequency'",
    ),
    ("float x @ topic x", "                ^", ParseError, "expected '(' after '@ topic', got 'x'"),
    ("float x @ topic(x a) x", "                  ^", ParseError, "expected ',' after 'x', got 'a'"),
    ("float x @ topic(x,) x", "                  ^", ParseError, "expected the name of a topic, got ')'"),
    (
        "float x @ topic(x, a",
        "                    ^",
        ParseError,
        "expected ')' after the topic, got the end of the text",
    ),
    (
        "x > 1; float y; y > 1",
        "       ^^^^^",
        ParseError,
        "declarations and annotations stand before the first formula",
    ),
    ("float x; y > 1", "         ^", NameInFormulaError, "'y' is not declared; declared names: x"),
    (
        "float gnt; gmt > 1",
        "           ^^^",
        NameInFormulaError,
        "'gmt' is not declared; did you mean 'gnt'?",
    ),
    (
        "c = d > 1; d = x",
        "    ^",
        NameInFormulaError,
        "'d' is only defined further down; move its definition up",
    ),
    ("c = c + 1", "    ^", NameInFormulaError, "'c' is used in its own definition"),
    ("c = x; c = y", "       ^", ParseError, "'c' is defined twice"),
    ("const float c = 1; c = x > 2", "                   ^", ParseError, "'c' is a constant already"),
    ("x > 1 d = x > 2", "      ^", ParseError, "expected ';' before the definition of 'd'"),
    ("x > 1 y > 2", "      ^", ParseError, "expected an operator between '1' and 'y'"),
    (
        "const float T = -1; always[0:T] x",
        "                             ^",
        BoundError,
        "a bound may not be negative; for the past use a past operator",
    ),
    (
        "const float T = inf; always[T:T] x",
        "                            ^",
        BoundError,
        "the lower bound of an interval may not be infinite",
    ),
    (
        "const float T = 1; always[0:t] x",
        "                            ^",
        NameInFormulaError,
        "'t' is not a declared constant; a bound is a number, a constant or inf",
    ),
]


@pytest.mark.parametrize(("text", "marks", "kind", "sentence"), DOCUMENTS)
def test_document(text, marks, kind, sentence):
    with pytest.raises(SpecificationError) as info:
        parse_document(text)
    assert type(info.value) is kind
    assert str(info.value) == with_carets(text, marks, sentence)
