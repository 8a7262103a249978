"""Formatting keeps the meaning, the tokens and the comments of a text, and changes nothing when it is repeated."""

from __future__ import annotations

from hypothesis import assume, given
from hypothesis import strategies as st

from rtamt.errors import SpecificationError
from rtamt.language.contents import variables
from rtamt.language.operators import STL
from rtamt.language.parsing.grammar import is_number
from rtamt.language.parsing.lexer import comments, quoted, tokenize
from rtamt.language.parsing.specfile import parse_document
from rtamt.language.printing.printer import to_text
from rtamt.layout import _meaning, formatted
from tests.support.strategies import formulas

HEADS = ["", "specification s\n", 'import "patterns.stl"\n', "sample 100ms hold for 1s\n"]
DECLARED = [
    "const float c = -3 [m/s ^2];",
    "parameter int count_ = 2",
    "enum Mode { MANUAL, AUTO = -4 };",
    "table curve = {(0, 1), (10, -4.5)}",
    'input group cars = "car_*" { float x [m]; bool in_lane }',
    'optional input float z1 [ m / s ] in [-1, 60] rate [-2, 2] = "a b" or "c-d"',
    "@ topic(z1, a/b-c)",
]
SPACES = ["", " ", "  ", "\t", " /* c\n c */ ", "/**/", "\n", "\n\n\n", " // note\n", "\r\n", "\r"]


@st.composite
def files(draw):
    """Draw a specification file: declarations, named formulas, templates and requirements, with odd white space."""
    parts = [draw(st.sampled_from(HEADS))]
    bodies = draw(
        st.lists(formulas(max_depth=2).filter(lambda each: not is_number(each)), min_size=1, max_size=2)
    )
    names = sorted(set(variables(*bodies)))
    if draw(st.booleans()):
        parts += [f"float {quoted(name)};\n" for name in names]
        parts += [f"{each}\n" for each in DECLARED if draw(st.booleans())]
    if draw(st.booleans()):
        parts.append("def near(p, limit = 3) = abs(p)-limit<=0;\n")
    for number, body in enumerate(bodies):
        text = to_text(body)
        parts.append(
            draw(
                st.sampled_from(
                    [
                        f"{text};\n",
                        f"f{number} = {text}\n",
                        f'require REQ-{number}.a "text, such as a-b" severity note: {text}\n',
                    ]
                )
            )
        )
    return spaced(draw, "".join(parts))


def spaced(draw, text):
    """Return a text with white space and comments put in at some gaps between tokens."""
    tokens = tokenize(text, STL)
    found, at = [], 0
    for start, end in zip(tokens.starts[:-1], tokens.ends, strict=False):
        gap = text[at:start]
        if draw(st.integers(0, 3)) == 0:
            gap = (
                draw(st.sampled_from(SPACES)) + gap
                if draw(st.booleans())
                else gap + draw(st.sampled_from(SPACES))
            )
        found += [gap, text[start:end]]
        at = end
    return "".join([*found, text[at:]])


def comments_of(text):
    return [text[span.start : span.end] for span in comments(text, STL)]


@given(files())
def test_formatting_keeps_the_meaning_and_is_final(text):
    try:
        before = parse_document(text)
    except SpecificationError:
        assume(False)
    new = formatted(text, parse_document, STL)
    assert _meaning(parse_document(new)) == _meaning(before)
    assert tokenize(new, STL).texts == tokenize(text, STL).texts
    assert comments_of(new) == comments_of(text)
    assert formatted(new, parse_document, STL) == new
