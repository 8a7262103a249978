"""Colours: the lexer for Pygments, and the grammar for editors, which is held to the table."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from pygments.lexers import get_lexer_by_name, get_lexer_for_filename
from pygments.token import Comment, Error, Keyword, Name, Number, Operator

from rtamt.highlight import StlLexer
from rtamt.language.operators import STL
from tests.support.strategies import formulas

ROOT = Path(__file__).parents[2]
SPEC = """\
specification response  // asked and granted
input float req
const int limit = 3
@ topic(req, /plant/req)
granted = F[0:500ms](gnt.value >= limit);
always(req >= 3 -> granted until G)
"""


def kinds(text):
    return {(value, kind) for kind, value in StlLexer().get_tokens(text) if value.strip()}


def test_pygments_finds_the_lexer():
    assert isinstance(get_lexer_by_name("stl"), StlLexer)
    assert isinstance(get_lexer_for_filename("spec.stl", "x >= 3"), StlLexer)


def test_the_words_of_a_file_have_their_kinds():
    found = kinds(SPEC)
    assert {
        ("specification", Keyword.Declaration),
        ("// asked and granted", Comment.Single),
        ("input", Keyword.Declaration),
        ("float", Keyword.Type),
        ("F", Keyword),
        ("500", Number),
        ("ms", Keyword.Type),
        ("gnt.value", Name.Variable),
        ("->", Operator),
        ("until", Keyword),
        ("G", Name.Variable),  # a variable: no interval, no parenthesis
    } <= found
    assert Error not in {kind for _, kind in found}


def test_a_share_in_percent_has_its_unit():
    found = kinds("atleast[0:4s](87.5 %, x >= 3)")
    assert {("87.5", Number), ("%", Keyword.Type)} <= found
    assert Error not in {kind for _, kind in found}


@given(formulas())
def test_every_formula_that_is_printed_has_a_colour_for_each_character(formula):
    assert Error not in {kind for kind, _ in StlLexer().get_tokens(str(formula))}


@pytest.mark.parametrize("op", list(STL), ids=lambda op: op.name)
def test_no_operator_is_taken_for_a_variable(op):
    for spelling in op.spellings:
        text = op.example.replace(op.spellings[0], spelling, 1)
        names = {value for value, kind in kinds(text) if kind is Name.Variable}
        assert names <= {"x", "y"}, text


# ---- editors ----------------------------------------------------------------------------------------


def test_the_grammar_for_editors_is_that_of_the_table():
    done = subprocess.run(
        [sys.executable, "-c", "import textmate; print(textmate.text(), end='')"],
        cwd=ROOT / "tools", capture_output=True, text=True, check=True,
    )  # fmt: skip
    committed = (ROOT / "editors/stl.tmLanguage.json").read_text(encoding="utf-8")
    assert committed == done.stdout, "run: python tools/textmate.py"


@pytest.mark.parametrize("op", list(STL), ids=lambda op: op.name)
def test_the_grammar_for_editors_knows_every_operator(op):
    grammar = json.loads((ROOT / "editors/stl.tmLanguage.json").read_text(encoding="utf-8"))
    place = op.example.index(op.spellings[0])
    for pattern in grammar["patterns"]:  # the first that matches at a place has it
        found = re.compile(pattern.get("match") or pattern["begin"]).match(op.example, place)
        if found:
            assert re.match(r"keyword|support|constant", pattern.get("name", "unit"))
            assert found[0].startswith(op.spellings[0])
            return
    pytest.fail(f"no pattern for {op.spellings[0]}")


def test_enumerations_and_sets_have_no_error_tokens():
    text = "enum Mode { MANUAL, AUTO = 4 } input Mode mode  mode in {AUTO} and in > 3"
    tokens = list(StlLexer().get_tokens(text))
    assert not [value for kind, value in tokens if kind is Error]
    assert [kind for kind, value in tokens if value in ("enum", "in")] == [
        Keyword.Declaration,
        Operator.Word,
        Name.Variable,
    ]
