"""All errors of a text: each one once, and none that follows from another."""

import itertools
from pathlib import Path

import pytest

import rtamt
from rtamt.errors import BoundError, SpecificationError
from rtamt.language.operators import STL
from rtamt.language.parsing.imports import PACKAGED, Library
from rtamt.language.parsing.lexer import tokenize
from rtamt.language.parsing.recovery import MOST_ERRORS, MOST_STATEMENTS, all_errors
from rtamt.language.parsing.specfile import parse_document
from rtamt.text_errors import errors_of


def first_error(text, folder=None):
    try:
        parse_document(text, library=Library(folder))
    except SpecificationError as error:
        return str(error)
    return None


def found_in(text):
    """Return the line and the message of each error; the first is the one that is raised."""
    found = all_errors(text)
    assert (str(found[0]) if found else None) == first_error(text)
    return [(1 + text.count("\n", 0, error.span.start), error.message) for error in found]


#: Statements of one text, each with the same one with an error. Later ones use what earlier ones declare.
STATEMENTS = [
    ('import "patterns.stl"', 'import "pattern.stl"'),
    ("enum Mode { MANUAL, AUTO = 4 }", "enum Mode { MANUAL, AUTO = four }"),
    ("input float speed [m/s] in [0, 90]", "input float speed [m/s"),
    ('float robot/arm = "arm" or "limb"', "float robot/arm = 3"),
    ("input Mode mode;", "input Modus mode;"),
    ("const float most = 30", 'const float most = "thirty"'),
    ("parameter float least = 2 [m]", "parameter float least"),
    ("table curve = {(0, 1), (10, 4)}", "table curve = {(0, 1)}"),
    ('group cars = "car_*" { float x [m]; Mode mode }', 'group cars = "car_*" { float x [m; Mode mode }'),
    ("sample 100ms hold", "sample 0ms hold"),
    ("def near(x,\n  limit = 1) = abs(x) <= limit", "def near(x,\n  limit = 1) = abs(x <= )"),
    ("fast = (speed\n  > most)", "fast = (speed\n  > )"),
    (
        "calm = near(robot/arm, limit=least) and mode == AUTO",
        "calm = near(robot/arm, limit=least) nd mode == AUTO",
    ),
    (
        'require R-1 "text" severity note: always(fast -> calm)',
        'require R-1 "text" severity: always(fast -> calm)',
    ),
    ("require R-2: response(calm, curve(speed) > 2)", "require R-2: calm and always[2:1] fast"),
    (
        "require R-3: forall car in cars: car.x > least or car.mode != mode",
        "require R-3: forall car in cats: car.x > 0",
    ),
    ("always(fast ->\n  eventually calm);", "always(fast ->\n  eventually ,);"),
    ("speed >= 0 and most > 3", "speed >= 0 and undeclared > 3"),
]


#: What may be right once the file of the first statement is imported.
IMPORTED = {4, 12, 15, 17}


@pytest.mark.parametrize(
    "wrong", [*itertools.combinations(range(len(STATEMENTS)), 2), range(len(STATEMENTS))]
)
def test_each_wrong_statement_has_one_error(wrong):
    text = "\n".join(pair[at in wrong] for at, pair in enumerate(STATEMENTS))
    lines = [line for line, _ in found_in(text)]
    begins = [0, *itertools.accumulate(1 + pair[0].count("\n") for pair in STATEMENTS)]
    found = [max(at for at, begin in enumerate(begins) if begin < line) for line in lines]
    assert found == [at for at in wrong if 0 not in wrong or at not in IMPORTED]


def test_a_right_text_has_none():
    assert found_in("\n".join(pair[0] for pair in STATEMENTS)) == []


@pytest.mark.parametrize(
    ("text", "found"),
    [
        pytest.param(
            "x >= ; y <= ; always(x > 3); (z",
            [
                (1, "expected an operand after '>=', got ';'"),
                (1, "expected an operand after '<=', got ';'"),
                (1, "this '(' is never closed"),
            ],
            id="several on a line",
        ),
        pytest.param(
            "x > 3\ny > 4\n",
            [(2, "expected an operator between '3' and 'y'")],
            id="a semicolon that is missing",
        ),
        pytest.param(
            "float x\nfast = (x > 3\nslow = x < 2 and nope\nrequire R: fast\n  -> slow\nrequire S: x <\n",
            [
                (3, "expected an operator between '3' and 'slow'"),
                (3, "'nope' is not declared; declared names: fast, x"),
                (6, "expected an operand after '<', got the end of the text"),
            ],
            id="a parenthesis that is never closed",
        ),
        pytest.param(
            "flaot speed [m/s]\nfloat brake;\nrequire R: speed > 3 and brake > nope",
            [
                (1, "'flaot' is not a type; did you mean 'float'?"),
                (3, "'nope' is not declared; declared names: brake, speed"),
            ],
            id="a misspelled type",
        ),
        pytest.param(
            "float x\na = x > 2\nfloat y\nfloat z\nrequire R: y > z and q > 2",
            [
                (3, "declarations and annotations stand before the first formula"),
                (5, "'q' is not declared; declared names: a, x, y, z"),
            ],
            id="declarations after formulas",
        ),
        pytest.param(
            'import "nope.stl"\nfloat x\nMode m;\nrequire A: response(x, y > 3)\nrequire B: x > [',
            [
                (
                    1,
                    "there is no file 'nope.stl' in the package (patterns.stl, signals.stl), and a text has no folder "
                    "of its own: to import from a folder, load a file with rtamt.load, or name the folder: "
                    "rtamt.parse(text, folder=...)",
                ),
                (5, "'>' takes no interval"),
            ],
            id="a file that is not there may define any name",
        ),
        pytest.param(
            "def f(x) = always x >\ndef g(x) = f(x) and x\nrequire R: g(s > 2) and s >\nrequire S: x or",
            [
                (2, "expected an operand after '>', got 'def'"),
                (4, "expected an operand after '>', got 'require'"),
                (4, "expected an operand after 'or', got the end of the text"),
            ],
            id="formulas that end too early",
        ),
        pytest.param(
            'float x\nalways("x > 3)\nrequire R: x >\n',
            [(2, "this quoted name is never closed")],
            id="a quote",
        ),
        pytest.param(
            "float x; float y; require x: x > 1; require y: y > 2",
            [
                (1, "'x' is the name of a variable; give the requirement another one"),
                (1, "'y' is the name of a variable; give the requirement another one"),
            ],
            id="errors of the text as a whole",
        ),
    ],
)
def test_errors(text, found):
    assert found_in(text) == found


def test_a_text_with_a_token_more_or_less_has_the_first_error_and_no_other_failure():
    """The invariants hold wherever the text is damaged."""
    text = (Path(PACKAGED) / "packs" / "driving.stl").read_text(encoding="utf-8")
    tokens = tokenize(text, STL)
    for at in range(0, len(tokens) - 1, 23):
        begin, end = tokens.starts[at], tokens.ends[at]
        for new in ("", "( " + text[begin:end], "require " + text[begin:end]):
            damaged = text[:begin] + new + text[end:]
            found = all_errors(damaged)
            assert (str(found[0]) if found else None) == first_error(damaged)
            assert len({error.span for error in found}) == len(found)


def test_there_is_a_limit():
    assert len(all_errors("x >= ;" * (MOST_ERRORS + 1))) == MOST_ERRORS
    # Errors that follow from another one, too: the last statement is not read.
    assert len(all_errors("enum A {\n" * MOST_STATEMENTS + "require R: x >")) == 1


def test_every_bound_that_the_period_does_not_allow_is_an_error():
    text = "a = once[0:0.25] x\nb = a and once[0:1] x\nrequire R: always[0:0.15](b and not a)"
    with pytest.raises(BoundError) as first:
        rtamt.parse(text, period="100ms")
    found = errors_of(text, first.value, period="100ms")
    assert [(error.span.start, error.message.split(": ")[1].split(" is ")[0]) for error in found] == [
        (8, "250 ms"),
        (text.index("[0:0.15]"), "150 ms"),
    ]
