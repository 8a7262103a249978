"""Formulas as py-metric-temporal-logic prints them, and the notes on where it differs."""

import pytest

import rtamt
from rtamt.interchange.mtl import read_mtl, write_mtl


@pytest.mark.parametrize(
    ("formula", "here"),
    [
        ("GFa", "always eventually a"),
        ("~XXa", "not next next a"),
        ("XG[0,1]FF(a)", "next always[0:1](eventually eventually a)"),
        ("(G[0,+2]Fa & G~GFALSE)", "always[0:2](eventually a) and always(not always false)"),
        ("(a U XTRUE)", "a until next true"),
        ("(aGF -> Ga_F)", "aGF -> always a_F"),
    ],
)
def test_operators_of_py_metric_temporal_logic_need_no_space(formula: str, here: str) -> None:
    found = rtamt.parse(read_mtl(formula).text).formula
    assert found == rtamt.parse(f"bool a\nbool aGF\nbool a_F\n{here}").formula


def test_an_error_names_the_operators_of_py_metric_temporal_logic() -> None:
    (rejected,) = read_mtl("(Ga U[0,1] Fb) Gc").rejected
    assert rejected.reason == (
        "expected an operator between ')' and 'G'\n"
        "  line 1, column 16:\n    (Ga U[0,1] Fb) Gc\n                   ^"
    )


@pytest.mark.parametrize(
    ("formula", "notes"), [("Ga", 2), ("G[1,inf]a", 2), ("F[0,3]a", 3), ("(F[0,3]a & (a W b))", 4)]
)
def test_windows_and_weak_until_of_py_metric_temporal_logic_have_notes(formula: str, notes: int) -> None:
    assert len(read_mtl(formula).notes) == notes


@pytest.mark.parametrize("character", ["\u2028", "\x85", "\f"])
def test_only_line_ends_end_a_formula(character: str) -> None:
    found = read_mtl(f"R1: a &{character}b\rR2: b")
    assert (found.converted, found.rejected) == (("R1", "R2"), ())


@pytest.mark.parametrize(
    ("formula", "here"), [("X[ ]a", "next always a"), ("G< >[1,2] a", "always eventually[1:2] a")]
)
def test_boxes_after_letters_were_read_as_one_name(formula: str, here: str) -> None:
    found = rtamt.parse(read_mtl(formula).text).formula
    assert found == rtamt.parse(f"bool a\n{here}").formula


def test_a_bound_without_a_decimal_was_written_as_none() -> None:
    found = write_mtl(rtamt.parse("bool a\nrequire P: eventually[0:1/3] a\nrequire Q: eventually[0:1/4] a"))
    assert found.text == "Q: F[0,0.25] a\n"
    assert found.rejected == (("P", "py-metric-temporal-logic has decimal bounds only, unlike 'F[0:1/3] a'"),)


def test_names_with_spaces_were_written_and_not_read() -> None:
    found = write_mtl(rtamt.parse('bool a\nrequire "P 1": a\nrequire P_1: not a\nrequire P-2.a: next a'))
    assert read_mtl(found.text).converted == ("P_1_2", "P_1", "P-2.a")
