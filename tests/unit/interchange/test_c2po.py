"""Specifications of R2U2: contracts, short intervals, and the types of their expressions."""

import math

import pytest

import rtamt
from rtamt.interchange.c2po import read_c2po
from rtamt.interchange.c2po_writing import write_c2po

_DECLARED = """\
ENUM Mode: {Idle, Busy: 4};
INPUT a, b, c: bool; i, j: int; x, y: float; m: Mode;
DEFINE h := 7/2; half := i/2; lim := 7.0; two := 2; deep := half %% two;
FTSPEC R: %s;
"""


def read(formula: str) -> str:
    """Return the formula that a specification becomes."""
    found = read_c2po(_DECLARED % formula)
    assert found.rejected == ()
    return str(rtamt.parse(found.text).formula).removeprefix("always")


def reason(formula: str) -> str:
    """Return why a specification is left out."""
    (rejected,) = read_c2po(_DECLARED % formula).rejected
    return rejected.reason.splitlines()[0]


@pytest.mark.parametrize(
    ("contract", "here"),
    [
        ("a => b -> c", "(a -> b -> c)"),
        ("a -> b => c", "((a -> b) -> c)"),
        ("a => b <-> c", "(a -> (b <-> c))"),
        ("a <-> b => c xor a", "((a <-> b) -> (c xor a))"),
        ("(a) => (b) && F[3] c", "(a -> b and eventually[0:3] c)"),
    ],
)
def test_the_arrow_of_a_contract_of_c2po_was_an_implication_among_others(contract: str, here: str) -> None:
    assert read(contract) == here


@pytest.mark.parametrize("contract", ["a => b => c", "(a => b)", "a && (b => c)"])
def test_a_contract_of_c2po_has_one_arrow(contract: str) -> None:
    assert reason(contract) == (
        "C2PO has one '=>' in a contract, between its assumption and its guarantee; write '->' inside of these"
    )


def test_a_contract_of_c2po_is_no_operand() -> None:
    found = read_c2po("INPUT a, b: bool; FTSPEC C: a => b; R: C && a;")
    assert found.converted == ("C",)
    assert found.rejected[0].reason.startswith("'C' is a contract, which is not covered")


@pytest.mark.parametrize(
    ("formula", "here"),
    [
        ("F[5] a", "(eventually[0:5] a)"),
        ("G[ 2 ] F[1,3] a", "(always[0:2](eventually[1:3] a))"),
        ("a U[4] b", "(a until[0:4] b)"),
    ],
)
def test_an_interval_of_c2po_may_have_its_upper_bound_only(formula: str, here: str) -> None:
    assert read(formula) == here


def test_a_missing_bound_of_c2po_was_reported_with_the_colon_of_this_language() -> None:
    assert reason("F[5") == "expected ',' and an upper bound, got the end of the text"


@pytest.mark.parametrize(
    ("formula", "here"),
    [
        ("i > 7/2*2", "(i > 3 * 2)"),
        ("h == i", "(3 == i)"),
        ("h == 3", "(3 == 3)"),
        ("i > -7/2", "(i > -3)"),
        ("i > 7/-2", "(i > -3)"),
        ("x > 7.0/2", "(x > 7 / 2)"),
        ("x > lim/two", "(x > 7 / 2)"),
        ("x > y/2", "(x > y / 2)"),
        ("sqrt(i) > 2", "(floor(sqrt(i)) > 2)"),
        ("sqrt(5) == i", "(floor(sqrt(5)) == i)"),
        ("sqrt(x) > 2", "(sqrt(x) > 2)"),
        ("half == j", "(sign(i) * floor(abs(i) / 2) == j)"),
        ("(i > 2) == (x > 2)", "(i > 2 <-> x > 2)"),
        ("(a && b) != (x > 1)", "(a and b xor x > 1)"),
        ("prev(1, x) > 1.5", "(delay[1](x, 1) > 1.5)"),
        ("x pow 2 > 1", "(pow(x, 2) > 1)"),
    ],
)
def test_the_types_of_operands_in_c2po_decide_what_operators_mean(formula: str, here: str) -> None:
    assert read(formula) == here


def _c(a: int, b: int) -> int:
    return math.trunc(a / b)


@pytest.mark.parametrize("i", [-9, -5, -1, 0, 1, 5, 8])
def test_ints_of_c2po_were_numbers_with_a_fraction(i: int) -> None:
    values = {
        "-i / 2": _c(-i, 2),
        "-(i / 2)": -_c(i, 2),
        "abs(i) / 2": _c(abs(i), 2),
        "(i + 1) / 2 * 2": _c(i + 1, 2) * 2,
        "i pow 2 / 3": _c(i * i, 3),
        "sqrt(abs(i))": math.isqrt(abs(i)),
        "sqrt(abs(i)) / 2": _c(math.isqrt(abs(i)), 2),
        "i % 3 / 2": _c(i - 3 * _c(i, 3), 2),
        "deep": _c(i, 2) - 2 * _c(_c(i, 2), 2),
        "i / 2 / 2": _c(_c(i, 2), 2),
        "7 / 2 + i": 3 + i,
        "-7 / two - h": -6,
    }
    for expression, value in values.items():
        spec = rtamt.parse(read_c2po(_DECLARED % f"{expression} == j").text)
        assert spec.evaluate({"i": [i], "j": [value]}).satisfied is True, expression


@pytest.mark.parametrize(
    ("formula", "message"),
    [
        ("i == true", "'true' is a bool, and a number is needed in 'i == true'"),
        ("a == i", "'a' is a bool, and a number is needed in 'a == i'"),
        ("i + true > 2", "'true' is a bool, and a number is needed in 'i + true'"),
        ("(i > 2) > 1", "'i > 2' is a bool, and a number is needed in '(i > 2) > 1'"),
        ("a > b", "'a' is a bool, and a number is needed in 'a > b'"),
        ("abs(a) > 1", "'a' is a bool, and a number is needed in 'abs(a)'"),
        ("i > x", "'i' is an int and 'x' is a float in 'i > x', and C2PO has no operators for both"),
        ("i > lim", "'i' is an int and '7.0' is a float in 'i > 7', and C2PO has no operators for both"),
        ("i / 0 > 1", "'i / 0' divides by zero"),
        ("i % 0 > 1", "'mod(abs(i), 0)' divides by zero"),
        ("i pow -1 > 1", "the exponent in 'pow(i, -1)' is negative, which C2PO does not have for ints"),
        ("i pow j > 1", "the exponent in 'pow(i, j)' is not constant, as C2PO needs it for ints"),
        (f"i{'/2' * 40} > 1", "with its definitions written out it has more than 20 000 operators"),
    ],
)
def test_operands_of_other_types_in_c2po_are_rejected(formula: str, message: str) -> None:
    assert reason(formula) == message


@pytest.mark.parametrize(
    ("formula", "here"),
    [
        ("a ∧ ¬b → c", "(a and not b -> c)"),
        ("a ↔ b ∨ c", "(a <-> b or c)"),
        ("x ≥ y ∧ x ≤ 3.0 ∧ x ≠ 2.0", "(x >= y and x <= 3 and x != 2)"),
        ("x • 2.0 > y ÷ 2.0", "(x * 2 > y / 2)"),
        ("a T[3] b", "(not(not a since[0:3] not b))"),
    ],
)
def test_operators_of_c2po_were_rejected_as_unknown(formula: str, here: str) -> None:
    assert read(formula) == here


@pytest.mark.parametrize(
    ("formula", "message"),
    [
        (
            "1.0 < x < 3.0",
            "C2PO has no chains of comparisons: use parentheses, or join two of them with '&&'",
        ),
        ("a == x < 3.0", "C2PO has no chains of comparisons: use parentheses, or join two of them with '&&'"),
        ("TAU > 3", "'TAU' is the time of a sample, which is not covered"),
        ("G[0,M] a", "'M' is the mission time, which is not covered"),
        ("foreach(q: s)(q)", "'foreach' is an aggregation over a set, which is not covered"),
        ("i & 2 == j", "'&' is a bitwise operator, which is not covered"),
        ("i << 2 > j", "'<<' is a bitwise operator, which is not covered"),
        ("a T[1,3] b", "'S' or 'T' with a lower bound above 0 is not covered: write 'O' and 'H'"),
    ],
)
def test_what_c2po_has_is_rejected_in_a_sentence_about_it(formula: str, message: str) -> None:
    assert reason(formula) == message


def test_specifications_of_c2po_had_labels_that_it_does_not_read() -> None:
    text = 'bool a\nrequire "P 1": a\nrequire P_1: not a\nrequire "1st": a\nrequire R: a\nrequire %s: a' % (
        "q" * 60
    )
    found = write_c2po(rtamt.parse(text, period=1))
    labels = ("P_1", "P_1_2", "R_1st", "R_2", "q" * 40)
    assert [line.strip().partition(":")[0] for line in found.text.splitlines()[4:]] == list(labels)
    assert read_c2po(found.text).converted == labels


def test_a_definition_that_is_compared_twice_is_no_chain() -> None:
    text = "INPUT x: float; DEFINE m := x + 1.0; FTSPEC Q: 0.0 < m && m < 3.0;"
    assert str(rtamt.parse(read_c2po(text).text).formula) == "always(0 < x + 1 and x + 1 < 3)"
