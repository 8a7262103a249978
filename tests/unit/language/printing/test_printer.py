"""Formula to text and back, canonical text, LaTeX."""

from fractions import Fraction
from math import copysign

import pytest

from rtamt.language.formula import Const, Interval, Var
from rtamt.language.operators import STL
from rtamt.language.parsing.parser import parse_formula as parse
from rtamt.language.printing.latex import to_latex
from rtamt.language.printing.printer import canonical, to_text


@pytest.mark.parametrize(
    "text",
    [
        "always(req >= 3 -> eventually[0:5](gnt >= 3))",
        "a - (b - c)",
        "a - b - c",
        "(a -> b) -> c",
        "a -> b -> c",
        "(a >= b) >= c",
        "x - (prev x)",
        "not(always x)",
        "-(2)",
        "-(-2)",
        "x - -2",
        "-2 * x",
        "pow(-x, 2)",
        "min(a, b, c)",
        "min(a, min(b, c))",
        "x >= 1 since S >= 2",
        "(G) - 3",
        "G >= 3",
        "x until U",
        "always(U)",
        "always G",
        "x >= inf and -inf <= x or true",
        'x >= "always"',
        '"inf" >= "my col"',
        "x until[100ms:0.5s] y",
        "x until[0:500ms] y",
        "x until[1/3:2] y",
        "always[0:inf] x",
        "x precedes[0:5] y",
        "1e+300 * 1e-05 > 1e+16",
    ],
)
def test_text_that_is_printed_as_it_was_written(text):
    assert str(parse(text)) == text


@pytest.mark.parametrize(
    ("text", "printed"),
    [
        ("((x)) >= (3.0)", "x >= 3"),
        ("G[0,5] x & !y", "always[0:5] x and not y"),
        ("x until[0ms:0ms] y", "x until[0:0ms] y"),
        ("x until[.25, 2.50] y", "x until[0.25:2.5] y"),
        ("always x >= 1", "always(x >= 1)"),
        ("x > 1 -> y !== 2 || z", "x > 1 -> y != 2 or z"),
    ],
)
def test_what_is_printed_for_other_spellings(text, printed):
    assert str(parse(text)) == printed


def test_units_survive_another_default():
    assert str(parse("always[1:2] x", unit="ms")) == "always[1ms:2ms] x"
    assert str(parse("always[1:inf] x", unit="us")) == "always[1us:inf] x"


def test_a_lower_bound_in_seconds_says_so_beside_another_unit():
    interval = Interval(Fraction(1), Fraction(2), "", "ms")
    assert to_text(STL["always"](Var("x"), interval=interval)) == "always[1s:2000ms] x"


def test_minus_zero_keeps_its_sign():
    assert to_text(Const(-0.0)) == "-0"
    assert copysign(1.0, parse("-0").value) == -1.0


def test_a_topic_prints_bare_and_a_path_in_quotes():
    assert to_text(Var("/ns/req")) == "/ns/req"
    assert to_text(Var("a/b")) == '"a/b"'


@pytest.mark.parametrize(
    "printed",
    [
        "(if -x > 1 and true then x else y) > 0",
        "(if -x > abs then x else y) > 0",
        "(if (-x > G) then x else G) > 0",
        "(if (-1 > x until y > S) then x else y) > 0",
        "(if (S > U) then x else y) > 0",
        "(if x > G then x else G) > 0",
    ],
)
def test_a_condition_that_begins_with_a_minus_is_read_as_one(printed):
    assert str(parse(printed)) == printed


def test_long_chains_print_without_recursion():
    text = " and ".join(["x >= 1"] * 10_000)
    assert str(parse(text)) == text
    nested = Var("x")
    for _ in range(10_000):
        nested = STL["prev"](nested)
    assert to_text(nested).count("prev") == 10_000


def test_a_long_minimum_stays_flat():
    text = "min(" + ", ".join(["x"] * 5_000) + ")"
    assert str(parse(text)) == text


def test_what_is_no_formula():
    for write in (to_text, to_latex, canonical):
        with pytest.raises(TypeError, match=r"^int is not a formula$"):
            write(STL["not"](3))


# RTAMT's names for its nodes.
@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("a >= 2", "(a)>=(2.0)"),
        ("a !== 2", "(a)!=(2.0)"),
        ("a and b", "(a)and(b)"),
        ("a | b", "(a)or(b)"),
        ("a implies b", "(a)->(b)"),
        ("a iff b", "(a)<->(b)"),
        ("a xor b", "(a)xor(b)"),
        ("!a", "not(a)"),
        ("-a", "-(a)"),
        ("G[0:5] a", "always[0,5](a)"),
        ("F a", "eventually(a)"),
        ("O[0:500ms] a", "once[0,500ms](a)"),
        ("H[0.5:1] a", "historically[1/2,1](a)"),
        ("a until[0:3] b", "(a)until[0,3](b)"),
        ("a S b", "(a)since(b)"),
        ("Y a", "previous(a)"),
        ("sX a", "s_next(a)"),
        ("rise(a)", "rise(a)"),
        ("pow(a, 2)", "pow(a,2.0)"),
        ("req.value + /ns/x", "(req.value)+(/ns/x)"),
    ],
)
def test_canonical(text, name):
    assert canonical(parse(text)) == name
    assert parse(name) == parse(text)


def test_canonical_names_may_hold_slashes():
    assert canonical(Var("rtamt/req")) == "rtamt/req"
