"""Long texts of every shape are read in time proportional to their length, or rejected in a sentence."""

from __future__ import annotations

from math import inf

import pytest

import rtamt
from rtamt.errors import StlError

#: Where reading takes time quadratic in the length, each of these takes minutes.
pytestmark = pytest.mark.timeout(20)

LENGTH = 120_000


def repeated(piece: str) -> str:
    return piece * (LENGTH // len(piece))


def numbered(line: str, length: int = LENGTH) -> str:
    return "".join(line.format(i, i - 1) for i in range(1, length // len(line) + 1))


READ = {
    "closed comments": repeated("/* a */ ") + "x",
    "comments of a line each": repeated("// a\n") + "x",
    "one long comment": "//" + repeated("a") + "\nx",
    "blank lines": repeated("\n") + "x",
    "a long name": repeated("a"),
    "fields": repeated("a.") + "a",
    "conjunction": repeated("x and ") + "x",
    "words that are operators and names": repeated("G U "),
    "topics": repeated(" /a"),
    "definitions": "a0 = x; " + numbered("a{0} = a{1} and x; ") + "x",
    "definitions without semicolons": "a0 = x\n" + numbered("a{0} = a{1} and x\n") + "x",
    "quotients of definitions": "a0 = x; " + numbered("a{0} = a{1}/2; ") + "x >= 0",
    "requirements": numbered("require R{0}: x >= {0};\n"),
    "formulas": numbered("x >= {0};\n"),
    "declarations": numbered("float v{0} ") + "v1",
    "constants and formulas": numbered("const float c{0} = {0} [m] ", LENGTH // 2)
    + numbered("a{0} = x >= c{0}\n", LENGTH // 2),
    "imports": "".join(f"from a import C{i}\n" for i in range(3000))
    + "".join(f"C{i} v{i}\n" for i in range(3000))
    + "v1.y",
    "annotations": numbered("float v{0} ", LENGTH // 2) + numbered("@topic(v{0}, a/b) ", LENGTH // 2) + "v1",
    "a variable called if, and no choice": repeated("if - ") + "1",
    "members": "enum E { "
    + numbered("M{0}, ")
    + "M } input E e  "
    + numbered("e == M{0} or ", LENGTH // 4)
    + "e == M",
    "names of paths": "float a/b/c/d " + repeated("a/b/c/d + ") + "a/b/c/d >= 0",
}
REJECTED = {
    "templates without a formula": repeated("def f(x) = \n"),
    "comments that are opened again and again": repeated("/* "),
    "a quote and no other": 'x >= "' + repeated("a"),
    "quotes, one too many": repeated('"') + '"',
    "slashes": repeated("/ "),
    "parentheses": repeated("("),
    "negations": repeated("not "),
    "brackets": repeated("G["),
    "minimum in minimum": repeated("min("),
    "a long number": repeated("1"),
    "a long share": f"atleast[0:5]({repeated('1')}%, x)",
    "a long code": f"enum E {{ A = {repeated('1')} }} x",
    "a long bound": f"G[0:{repeated('1')}] x",
    "a name that is not declared": f"float y {repeated('a')} >= 0",
    "names side by side": repeated("a b "),
    "an error at the end of a line": repeated("x and ") + "x )",
    "an error in the last line": repeated("x and\n") + "x )",
    "unknown characters": repeated("#"),
    "definitions in the wrong order": numbered("a{1} = a{0}; ") + "x",
}


@pytest.mark.parametrize("shape", READ)
def test_a_long_text_is_read(shape: str) -> None:
    spec = rtamt.parse(READ[shape])
    assert spec.input_names
    assert isinstance(spec.warnings, tuple)


@pytest.mark.parametrize("shape", REJECTED)
def test_a_long_text_that_is_wrong_is_rejected_in_a_sentence_of_normal_length(shape: str) -> None:
    with pytest.raises(StlError) as caught:
        rtamt.parse(REJECTED[shape])
    assert len(str(caught.value)) < 1000


def test_the_limit_of_nesting_is_in_the_message() -> None:
    with pytest.raises(
        StlError, match=r"^nested too deeply: at most 200 formulas may stand inside one another"
    ):
        rtamt.parse(repeated("("))


def test_the_parentheses_of_a_prefix_operator_are_no_level_of_their_own() -> None:
    before = [
        f"(x == {'prev(' * k}x{')' * k})" for k in range(1, 100)
    ]  # a published monitor of frozen signals
    monitor = rtamt.parse(f"historically(not ({' and '.join(before)}))").monitor()
    robustness = [monitor.update(t, x=1.0) for t in range(101)]
    assert robustness == [inf] * 99 + [0, 0]


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_a_comment_ends_where_its_line_does_also_on_old_macs(end: str) -> None:
    lines = ["// the limit", "low = x <= 3 // metres", "always(low)"]
    assert str(rtamt.parse(end.join(lines))) == "always(x <= 3)"


@pytest.mark.parametrize("inside", ["\u2028", "\u2029", "\x85", "\x0b", "\x0c"])
def test_a_comment_does_not_end_at_other_characters_that_some_editors_break_lines_at(inside: str) -> None:
    assert str(rtamt.parse(f"x >= 3 // a{inside} and y")) == "x >= 3"


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_line_and_column_of_an_error_are_those_of_its_line(end: str) -> None:
    with pytest.raises(StlError) as caught:
        rtamt.parse(end.join(["// one", "low = x <= 3;", "always(low) )", "// four"]))
    assert str(caught.value).splitlines()[1:] == [
        "  line 3, column 13:",
        "    always(low) )",
        "                ^",
    ]
