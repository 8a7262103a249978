"""RTAMT's spellings of operators, with its precedence; the rows are the alternatives of its grammar."""

import pytest

import rtamt

A, B, C = "(a)>=(1.0)", "(b)>=(2.0)", "(c)>=(3.0)"
CLASSES = (rtamt.StlDiscreteTimeSpecification, rtamt.StlDenseTimeSpecification)


def canonical(text: str, cls=rtamt.StlDiscreteTimeSpecification) -> str:
    spec = cls()
    for name in "abc":
        spec.declare_var(name, "float")
    spec.spec = text
    spec.parse()
    return spec.spec_print()


@pytest.mark.parametrize("cls", CLASSES)
@pytest.mark.parametrize(
    ("spellings", "written"),
    [
        (("not", "!"), f"not({A})"),
        (("always", "G"), f"always({A})"),
        (("eventually", "F"), f"eventually({A})"),
        (("historically", "H"), f"historically({A})"),
        (("once", "O"), f"once({A})"),
        (("prev", "Y"), f"previous({A})"),
        (("next", "X"), f"next({A})"),
        (("s_prev", "sY"), f"s_previous({A})"),
        (("s_next", "sX"), f"s_next({A})"),
        (("rise",), f"rise({A})"),
        (("fall",), f"fall({A})"),
    ],
)
def test_prefix_operators(cls, spellings, written) -> None:
    assert {canonical(f"{each}(a >= 1)", cls) for each in spellings} == {written}


@pytest.mark.parametrize("cls", CLASSES)
@pytest.mark.parametrize("interval", ["[0:2]", "[0,2]", "[ 0 , 2 s ]"])
@pytest.mark.parametrize(
    "spellings", [("always", "G"), ("eventually", "F"), ("historically", "H"), ("once", "O")]
)
def test_prefix_operators_with_intervals(cls, interval, spellings) -> None:
    found = {canonical(f"{each}{interval} a >= 1", cls) for each in spellings}
    assert found == {f"{spellings[0]}[0,2{'s' if 's' in interval else ''}]({A})"}


@pytest.mark.parametrize("cls", CLASSES)
@pytest.mark.parametrize(
    ("spellings", "written"),
    [
        (("and", "&"), "and"),
        (("or", "|"), "or"),
        (("implies", "->"), "->"),
        (("iff", "<->"), "<->"),
        (("xor",), "xor"),
        (("until", "U"), "until"),
        (("since", "S"), "since"),
        (("until[0:2]", "U[0,2]"), "until[0,2]"),
        (("unless[0:2]", "W[0,2]"), "unless[0,2]"),
        (("since[0:2]", "S[0,2]"), "since[0,2]"),
    ],
)
def test_infix_operators(cls, spellings, written) -> None:
    assert {canonical(f"a >= 1 {each} b >= 2", cls) for each in spellings} == {f"({A}){written}({B})"}


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("a <= 1", "(a)<=(1.0)"),
        ("a < 1", "(a)<(1.0)"),
        ("a > 1", "(a)>(1.0)"),
        ("a == 1", "(a)==(1.0)"),
        ("a !== 1", "(a)!=(1.0)"),
        ("-a + b * c / 2 >= 1", "((-(a))+(((b)*(c))/(2.0)))>=(1.0)"),
        ("abs(a) - sqrt(b) >= exp(c)", "((abs(a))-(sqrt(b)))>=(exp(c))"),
        ("pow(2, a) >= log(b, 10) + ln(c)", "(pow(2.0,a))>=((log(b,10.0))+(ln(c)))"),
        ("a >= .5e1", "(a)>=(5.0)"),
        ("a >= 5.", "(a)>=(5.0)"),
        ("a >= 1_000", "(a)>=(1000.0)"),
    ],
)
def test_numbers_and_comparisons(text, written) -> None:
    assert canonical(text) == written


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("not a >= 1 and b >= 2", f"(not({A}))and({B})"),
        ("always a >= 1 until b >= 2", f"(always({A}))until({B})"),
        ("not always a >= 1", f"not(always({A}))"),
        ("a >= 1 until b >= 2 unless[0:1] c >= 3", f"(({A})until({B}))unless[0,1]({C})"),
        ("a >= 1 unless[0:1] b >= 2 since c >= 3", f"(({A})unless[0,1]({B}))since({C})"),
        ("a >= 1 and b >= 2 since c >= 3", f"({A})and(({B})since({C}))"),
        ("a >= 1 or b >= 2 and c >= 3", f"({A})or(({B})and({C}))"),
        ("a >= 1 -> b >= 2 or c >= 3", f"({A})->(({B})or({C}))"),
        ("a >= 1 <-> b >= 2 -> c >= 3", f"({A})<->(({B})->({C}))"),
        ("a >= 1 xor b >= 2 <-> c >= 3", f"({A})xor(({B})<->({C}))"),
    ],
)
def test_the_precedence_of_operators(text, written) -> None:
    assert canonical(text) == written


def test_an_arrow_that_no_version_of_its_grammar_has_is_an_error() -> None:
    message = "'=>' is no operator; write '->' for an implication, '>=' for at least"
    with pytest.raises(rtamt.STLParseException, match=message):
        canonical("a >= 1 => b >= 2")
