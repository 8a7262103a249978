"""What ``rtamt lint --fix`` writes: the same requirements without the findings, comments and layout as they were."""

import pytest

from rtamt.language.operators import STL
from rtamt.language.parsing.specfile import parse_document
from rtamt.lint.fix import with_fixes


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("always(p > 1 and q > 1 and p > 1)", "always(p > 1 and q > 1)"),
        ("always((p > 1) and (p > 1)) // twice", "always((p > 1)) // twice"),
        ("x > 5 and y > 1 and x > 3", "x > 5 and y > 1"),
        ("x > 3 and y > 1 and x > 5", "y > 1 and x > 5"),
        ("x > 3 or\n  // a comment between\n  x > 5", "x > 3 or\n  // a comment between\n  x > 5"),
        ("not   not(x > 3)", "(x > 3)"),
        ("y > -(-x)", "y > (x)"),
        ("F[0:2] F[0:3](x > 3)", "F[0:5] (x > 3)"),
        ("F[0:2ms]F[1ms:3ms](x > 3)", "F[1ms:5ms](x > 3)"),
        ("F F[0:3](x > 3)", "F (x > 3)"),
        ("G[1:2] G(x > 3)", "G[1:inf] (x > 3)"),
        ("true until x > 3", "eventually(x > 3)"),
        ("true since[0:2] (x > 3)", "once[0:2]((x > 3))"),
        ("p > 1 and true", "p > 1"),
        ("false or p > 1", "p > 1"),
        ("p > 1 and false", "p > 1 and false"),
        ("G x > 3 -> y > 2", "(G x > 3) -> y > 2"),
        ("G[0:0](x > 3) and y > 1", "(x > 3) and y > 1"),
        ("not not (x > 3 and true)", "(x > 3)"),
        ("a = not not (x > 3)\r\n\r\nalways(a)   // end", "a = (x > 3)\r\n\r\nalways(a)   // end"),
        ("not not (x > 3) // lint: ignore[RT503]", "not not (x > 3) // lint: ignore[RT503]"),
    ],
)
def test_texts(text, expected):
    found = with_fixes(parse_document(text), parse_document, STL)
    assert found.text == expected
    assert with_fixes(found.document, parse_document, STL).codes == ()
