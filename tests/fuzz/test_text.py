"""Any text is a specification or an error with a sentence; what was read prints as itself."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import rtamt
from rtamt.errors import StlError
from rtamt.language.operators import STL
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.printing.latex import to_latex
from rtamt.language.printing.printer import to_text
from rtamt.language.units.durations import UNITS
from tests.support.strategies import formulas

CORPUS = Path(__file__).parent / "corpus" / "text"

WORDS = [spelling for operator in STL for spelling in operator.spellings]
WORDS += [
    "specification",
    "from",
    "import",
    "input",
    "output",
    "const",
    "def",
    "sample 100ms hold for 1s skip nan",
    "hold",
    "input float z [m] =",
    '"setpoint[2]"',
    "def f(x, y = 2) =",
    "table t = {(0, 1), (2, 3)}",
    "parameter float p = 2",
    "f(",
    'import "signals.stl"',
    "stays(x, 1, y = 2)",
    "float",
    "int",
    "long",
    "complex",
    "inf",
]
WORDS += [
    *"()[],;:=.\"'#$%\\~^`?{}",
    "//",
    "/*",
    "*/",
    "\n",
    "\t",
    "\r\n",
    "x",
    "y",
    "a.b",
    "a/b",
    "/top/ic",
    "é",
    "�",
]
WORDS += [
    "0",
    "1",
    "2.5",
    "1e3",
    "1e400",
    "1e-400",
    ".5",
    "5.",
    "0x1f",
    "1_0",
    "00",
    "-0",
    "1e",
    "[0:5]",
    "[1,2]",
]
WORDS += [f"3{unit}" for unit in UNITS]

anything = st.text(max_size=40)
sentences = st.lists(st.sampled_from(WORDS) | st.text(max_size=2), max_size=30).flatmap(
    lambda words: st.sampled_from(("", " ")).map(lambda space: space.join(words))
)


@st.composite
def slips(draw: st.DrawFn) -> str:
    """Draw the text of a formula in which something was left out, doubled, moved or put in."""
    text = str(draw(formulas(unbounded_future=True)))
    for _ in range(draw(st.integers(0, 3))):
        begin = draw(st.integers(0, len(text)))
        end = draw(st.integers(begin, min(begin + 8, len(text))))
        put = draw(st.sampled_from(("", text[begin:end] * 2, *WORDS)))
        text = text[:begin] + put + text[end:]
    return text


def read(text: str) -> None:
    """Read a text, and what it prints as; nothing but an StlError may come out."""
    try:
        spec = rtamt.parse(text)
    except StlError as error:
        said = str(error)
    else:
        said = "a specification"
        for assertion in spec.document.assertions:
            printed = to_text(assertion.formula)
            assert parse_formula(printed) == assertion.formula, printed
            assert to_text(parse_formula(printed)) == printed
            to_latex(assertion.formula)
    assert said.strip()


@given(anything | sentences | slips())
def test_any_text_is_a_specification_or_an_error_with_a_sentence(text: str) -> None:
    read(text)


@pytest.mark.parametrize("path", sorted(CORPUS.iterdir()), ids=lambda path: path.name)
def test_texts_of_the_corpus(path: Path) -> None:
    read(path.read_bytes().decode("utf-8", "replace"))
