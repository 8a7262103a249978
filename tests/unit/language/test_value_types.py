"""Declared Booleans and enumerations: what they mean in formulas, and that new words are not reserved."""

from __future__ import annotations

import pickle

import pytest

from rtamt.language.contents import types_of
from rtamt.language.formula import Apply, Const, fold
from rtamt.language.operators import STL
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.parsing.specfile import parse_document
from rtamt.language.value_types import BOOLEAN, Enumeration

MODES = "enum Mode { MANUAL, AUTO = 4, RTL, } input Mode mode enum Phase { AUTO, STOP } Phase phase bool p float x "

PRINTED = [
    ("always(p)", "always p"),
    ("p and x > 3", "p and x > 3"),
    ("p == 1 or not p", "p == 1 or not p"),
    ("p -> eventually[0:3] p", "p -> eventually[0:3] p"),
    ("mode == RTL and RTL != mode", "mode == RTL and RTL != mode"),
    ("mode == AUTO or phase == AUTO", "mode == AUTO or phase == AUTO"),
    ("mode in {AUTO, Mode.RTL}", "mode == AUTO or mode == Mode.RTL"),
    ("not mode in {AUTO}", "not(mode == AUTO)"),
    ("x in {1, 2 * x} and p", "(x == 1 or x == 2 * x) and p"),
    ("alias = mode; flag = p; always(alias == RTL and flag and flag == 1)", "always(mode == RTL and p and p == 1)"),
    ("(if p then mode else RTL) == AUTO", "(if p then mode else RTL) == AUTO"),
    ("always(if x > 3 then p else p)", "always(if x > 3 then p else p)"),
    ("delay[1](p, false) and held(p, x > 3, true)", "delay[1](p, false) and held(p, x > 3, true)"),
    ("if x > 3 then p else false", "if x > 3 then p else false"),
    ("held(mode, p, AUTO) == RTL", "held(mode, p, AUTO) == RTL"),
    ("def past(f, first) = delay[1](f, first); past(p, true)", "delay[1](p, true)"),
    ("require R1: p", "p"),
    ("def at(m, f = p) = m == AUTO and f; at(mode) or at(phase, x > 1)",
     "mode == AUTO and p or phase == AUTO and x > 1"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "printed"), PRINTED)
def test_the_printed_text_of_typed_formulas_has_their_names_and_parses_back(text, printed):
    document = parse_document(MODES + text)
    formula = document.formula
    assert str(formula) == printed
    again = parse_formula(
        printed, variables=document.variables, types=document.types, enumerations=document.enumerations
    )
    assert again == formula == pickle.loads(pickle.dumps(formula))
    assert types_of(again) == types_of(formula)


def test_members_count_on_from_the_one_before_them():
    document = parse_document('enum E { A = -3, B, "the C" = 7, D } E e e == D')
    assert document.enumerations["E"].members == (("A", -3), ("B", -2), ("the C", 7), ("D", 8))
    assert document.types == {"e": document.enumerations["E"]}
    assert str(parse_document('enum E { "the C" } E e e == "the C"').formula) == 'e == "the C"'


def test_constants_of_an_enumeration_and_of_bool():
    document = parse_document(MODES + "const Mode home = RTL const bool on = true mode == home and on")
    assert str(document.formula) == "mode == RTL and true"
    assert document.constants == {"home": 5.0, "on": 1.0}


def test_a_declared_name_wins_over_a_member():
    document = parse_document("enum E { A, B } E e float A  e == E.A and A > 3 and e == B")
    assert str(document.formula) == "e == E.A and A > 3 and e == B"


def test_latex_shows_members_and_booleans_by_name():
    formula = parse_document(MODES + "p and mode == RTL").formula
    assert formula.latex() == r"p \wedge \mathrm{mode} = \mathrm{RTL}"
    assert parse_document(MODES + "delay[1](p, false)").formula.latex().endswith(r"(p, \bot)")


def test_in_rtamt_files_a_bool_stays_a_number():
    assert types_of(parse_document("bool p always(p)", truths=False).formula) == {}
    assert types_of(parse_document("bool p always(p)").formula) == {"p": BOOLEAN}


WORDS = ("in", "enum", "bool", "Mode", "valid")
TEXTS = [op.example for op in STL if "x" in op.example]


@pytest.mark.parametrize("word", WORDS)
def test_no_word_of_types_is_reserved(word):
    """The examples of the table mean the same over a variable that is called like the word."""
    for text in TEXTS:
        plain = parse_formula(text, variables=["x", "y", word])
        renamed = fold(
            plain,
            lambda node, args: (
                Apply(node.op, args, node.interval)
                if isinstance(node, Apply)
                else node
                if isinstance(node, Const)
                else type(node)(word if node.name == "x" else node.name)
            ),
        )
        assert parse_formula(str(renamed)) == renamed


def test_a_member_of_an_enumeration_is_found_by_code_and_by_name():
    one = Enumeration("E", (("A", 0), ("B", 2)))
    assert (one.code("B"), one.code("C"), one.member(2.0), one.member(1.0)) == (2, None, "B", None)
