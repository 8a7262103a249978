"""Specifications of R2U2, Breach and py-metric-temporal-logic, read and written."""

from fractions import Fraction

import pytest

import rtamt
from rtamt.errors import UsageError
from rtamt.interchange import FORMATS
from rtamt.interchange.breach import read_breach, write_breach
from rtamt.interchange.c2po import read_c2po
from rtamt.interchange.c2po_writing import write_c2po
from rtamt.interchange.mtl import read_mtl, write_mtl

C2PO = """\
-- two requests
ENUM
    Mode: {Idle, Busy: 4};
INPUT
    a, b: bool; x: float; m: Mode; values: int[10];
DEFINE
    near := abs(x - prev(22.0, x)) < 1.0; twice := G[0,2] near;
FTSPEC
    %s
PTSPEC
    O[1,3] b;
"""


def c2po(formula: str, period: str = "1/2") -> str:
    found = read_c2po(C2PO % f"R: {formula};", Fraction(period))
    assert found.rejected == ()
    spec = rtamt.parse(found.text)
    assert str(spec.requirements["spec_1"].formula) == "always(once[0.5:1.5] b)"
    return str(spec.requirements["R"].formula).removeprefix("always")


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("a -> F[0,5] (x > 3)", "(a -> eventually[0:2.5](x > 3))"),
        ("G[0,5] a && b", "(always[0:2.5] a and b)"),
        ("a -> b -> a", "((a -> b) -> a)"),
        ("a == b", "(a <-> b)"),
        ("m == Busy || m != Idle", "(m == Busy or m != Idle)"),
        ("x % 3 + x pow 2 >= 1", "(sign(x) * mod(abs(x), 3) + pow(x, 2) >= 1)"),
        ("twice", "(always[0:1](abs(x - delay[0.5](x, 22)) < 1))"),
        ("a U[0,3] b", "(a until[0:1.5] b)"),
        ("a U[1,3] b", "(eventually[0.5:0.5](a until[0:1] b))"),
        ("a R[0,3] b", "(not(not a until[0:1.5] not b))"),
        ("a => b", "(a -> b)"),
    ],
)
def test_a_formula_of_c2po(formula: str, expected: str) -> None:
    assert c2po(formula) == expected


@pytest.mark.parametrize(
    ("formula", "reason"),
    [
        ("values[3] > 1", "'values' is of the type int[10], which is not covered"),
        ("rate(x) > 1", "'rate' is a rate of change, which is not covered"),
        ("a S[1,3] b", "'S' or 'T' with a lower bound above 0 is not covered"),
        ("a &&", "expected an operand after '&&'"),
    ],
)
def test_what_is_left_out_of_c2po(formula: str, reason: str) -> None:
    found = read_c2po(C2PO % f"R: {formula};")
    assert found.converted == ("spec_1",)
    assert found.rejected[0].reason.startswith(reason)


@pytest.mark.parametrize("b", [-3, -2, 1, 2, 5])
@pytest.mark.parametrize("a", [-7, -6, -1, 0, 1, 5, 6])
def test_integers_of_c2po_divide_as_in_c(a: int, b: int) -> None:
    declared = "INPUT i, j, q, r: int; f: float; DEFINE half := i / j; near := i / 2 == 1; FTSPEC "
    text = f"A: half == q; B: i % j == r; C: i / {b} == q; D: i % {b} == r; E: near -> f / 4.0 == 0.25; F: 5 / 2 < i;"
    spec = rtamt.parse(read_c2po(declared + text).text)
    quotient = int(a / b)
    result = spec.evaluate({"i": [a], "j": [b], "q": [quotient], "r": [a - quotient * b], "f": [1.0]})
    verdicts = {name: each.satisfied for name, each in result.requirements.items()}
    assert verdicts == {**dict.fromkeys("ABCDE", True), "F": a > 2}


def test_until_of_c2po_does_not_need_its_first_operand_before_the_interval() -> None:
    text = read_c2po("INPUT a, b: bool; FTSPEC R: a U[2,3] b;").text.replace("always(", "(")
    traces = {"time": [0, 1, 2, 3], "a": [False, False, True, True], "b": [False, False, False, True]}
    assert rtamt.parse(text).evaluate(traces).satisfied is True
    traces["a"] = [True, True, False, True]
    assert rtamt.parse(text).evaluate(traces).satisfied is False


def test_a_specification_as_c2po_and_back() -> None:
    text = "bool a\nbool b\nfloat x\nrequire P: always(a -> always[0:3] b or x >= 2)\nrequire Q: once[0:4](x < 1) and a"
    written = write_c2po(rtamt.parse(text, period=1))
    assert written.text == (
        "INPUT\n    a, b: bool;\n    x: float;\n\nFTSPEC\n    P: a -> G[0,3] b || x >= 2.0;\n\n"
        "PTSPEC\n    Q: O[0,4](x < 1.0) && a;\n"
    )
    again = rtamt.parse(read_c2po(written.text).text)
    assert [str(each.formula) for each in again.requirements.values()] == [
        "always(a -> always[0:3] b or x >= 2)", "always(once[0:4](x < 1) and a)",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("formula", "reason"),
    [
        ("always(eventually(x > 1))", "C2PO has bounded operators only"),
        ("always(once[0:1](x > 1) -> eventually[0:1](x > 1))", "no formulas of both future and past"),
        ("always((x > 1) until[1:2] (x > 2))", "C2PO has another meaning for"),
        ("always(ceil(x) > 1)", "C2PO has no 'ceil'"),
        ('always("motor speed" > 1)', "'motor speed' cannot be a variable of C2PO: use letters, digits"),
        ("always(G > 1)", "'G' cannot be a variable of C2PO, where it is a keyword"),
    ],
)
def test_what_c2po_cannot_express(formula: str, reason: str) -> None:
    (rejected,) = write_c2po(rtamt.parse(f"require R: {formula}", period=1)).rejected
    assert reason in rejected.reason


def test_a_requirement_with_a_name_that_c2po_does_not_read_is_left_out_alone() -> None:
    found = write_c2po(rtamt.parse('require A: always("a b" > 1); require B: always(x > 1)', period=1))
    assert (found.converted, [each.name for each in found.rejected]) == (("B",), ["A"])
    assert "a b" not in found.text


@pytest.mark.parametrize(
    ("number", "written"),
    [
        ("1e-9", "0.000000001"),
        ("-2.5e-7", "-0.00000025"),
        ("1e20", "100000000000000000000.0"),
        ("0.1", "0.1"),
    ],
)
def test_numbers_of_c2po_have_no_exponents(number: str, written: str) -> None:
    found = write_c2po(rtamt.parse(f"require N: always(x1e5 > {number})", period=1))
    assert f"N: x1e5 > {written};" in found.text
    again = rtamt.parse(read_c2po(found.text).text)
    assert again.formula == rtamt.parse(f"float x1e5 always(x1e5 > {number})").formula


BREACH = """\
# limits
param vmax=150, t1=1
gear2 := gear[t]==2  # a part
phi_stay := alw ((not gear2) => ev_[0, t1] (gear2))
phi_speed := (alw_[0, 25] (speed[t]<vmax)) and
    alw (RPM[t] < 4000)
"""


def test_a_file_of_breach() -> None:
    found = read_breach(BREACH)
    assert (found.converted, found.rejected) == (("phi_stay", "phi_speed"), ())
    spec = rtamt.parse(found.text)
    assert (
        str(spec.requirements["phi_stay"].formula) == "always(not(gear == 2) -> eventually[0:1](gear == 2))"
    )
    assert str(spec.requirements["phi_speed"].formula) == "always[0:25](speed < 150) and always(RPM < 4000)"
    written = write_breach(spec)
    assert written.text.splitlines()[-1] == "phi_speed := alw_[0,25](speed[t] < vmax) and alw (RPM[t] < 4000)"
    assert rtamt.parse(read_breach(written.text).text).formula == spec.formula


def test_what_is_left_out_of_breach() -> None:
    (rejected,) = read_breach("a := x[t] > 1\nb := x[t+1] - x[t] > 1").rejected
    assert rejected.reason.startswith("'x[t+1]' is a signal at another time, which is not covered")
    (written,) = write_breach(rtamt.parse("bool a\nalways a")).rejected
    assert written.reason == "Breach has signals of numbers only, and 'a' is of the type bool"
    with pytest.raises(UsageError, match="is no parameter with a number"):
        read_breach("param a = b\nphi := x[t] > 1")
    with pytest.raises(UsageError, match="there is no formula"):
        read_breach("param a = 1")


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("G(a -> F[0, 2] b)", "always(a -> eventually[0:2] b)"),
        ("(a & ~b)", "a and not b"),
        ("< > [ ] a", "eventually(always a)"),
        ("@a", "next a"),
        ("(a W b)", "a unless b"),
        ("(a U b)", "a until b"),
        ("(a U[1,3] b)", "always[0:1] a and a until[1:3] b"),
        ("(a ^ TRUE)", "a xor true"),
    ],
)
def test_a_formula_of_py_metric_temporal_logic(formula: str, expected: str) -> None:
    found = read_mtl(f"R: {formula}")
    spec = rtamt.parse(found.text)
    assert str(spec.formula) == str(rtamt.parse(f"bool a\nbool b\n{expected}").formula)
    written = write_mtl(spec)
    if "[1,3]" in formula:
        assert "has another meaning for" in written.rejected[0].reason
    else:
        assert rtamt.parse(read_mtl(written.text).text).formula == spec.formula


def test_what_py_metric_temporal_logic_cannot_express() -> None:
    (rejected,) = write_mtl(rtamt.parse("always(x > 1)")).rejected
    assert rejected.reason == "'x' is no Boolean whose name begins with a small letter"


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize(
    "text", ["", "{" * 2000, "(" * 5000, "a := " + "-" * 5000, "INPUT " + "{ a" * 3000 + ";"]
)
def test_any_text_is_converted_or_rejected_at_once(name: str, text: str) -> None:
    try:
        found = FORMATS[name].read(text, None)
    except UsageError:
        return
    assert found.rejected


@pytest.mark.parametrize("name", ["alw", "ev", "t", "until_"])
def test_keywords_of_breach_are_no_signals(name: str) -> None:
    found = write_breach(rtamt.parse(f"require R: always({name} > 1 and x < 2); require S: not_ > 1"))
    (rejected,) = found.rejected
    assert rejected.reason == f"'{name}' cannot be a name of Breach, where it is a keyword"
    assert "S := not_[t] > 1" in found.text


@pytest.mark.parametrize(
    ("read", "text", "bound"),
    [
        (read_breach, "R := alw_[0, 0.5] (x[t] > 1)\nS := ev_[0, 0.75] (x[t] > 1)", "eventually[0:0.75](x > 1)"),
        (read_mtl, "R: G[0, 0.5] a\nS: F[0, 0.75] a", "eventually[0:0.75] a"),
    ],
)  # fmt: skip
def test_a_period_is_declared_and_its_multiples_are_bounds(read, text: str, bound: str) -> None:
    found = read(text, Fraction(1, 2))
    spec = rtamt.parse(found.text)
    assert (spec.period, list(spec.requirements)) == (0.5, ["R"])
    (rejected,) = found.rejected
    assert (rejected.name, rejected.reason) == (
        "S",
        f"0.75 s in '{bound}' is not a whole number of periods of 0.5 s",
    )
    assert rtamt.parse(read(text).text).period is None


@pytest.mark.parametrize(
    ("breach", "here"),
    [
        ("{a} or {b} => {c}", "{a} or ({b} -> {c})"),
        ("({a} or {b}) => {c}", "({a} or {b}) -> {c}"),
        ("{a} => {b} or {c}", "({a} -> {b}) or {c}"),
        ("{a} and {b} => {c}", "{a} and {b} -> {c}"),
        ("{a} => {b} => {c}", "{a} -> ({b} -> {c})"),
        ("{a} until {b} until {c}", "{a} until ({b} until {c})"),
    ],
)
def test_operators_of_breach_bind_as_in_its_parser(breach: str, here: str) -> None:
    found = read_breach("R := " + breach.format(**{name: f"({name}[t] > 0)" for name in "abc"}))
    formula = rtamt.parse(found.text).formula
    assert formula == rtamt.parse(here.format(a="(a > 0)", b="(b > 0)", c="(c > 0)")).formula
    written = write_breach(rtamt.parse(found.text))
    assert rtamt.parse(read_breach(written.text).text).formula == formula


def test_chains_of_until_with_and_without_an_interval_need_parentheses_in_breach() -> None:
    (rejected,) = read_breach("R := x[t] > 1 until_[0,1] y[t] > 1 until z[t] > 1").rejected
    assert rejected.reason.splitlines()[0] == (
        "Breach splits a formula at 'until' before 'until_': put one of them in parentheses"
    )
    found = read_breach("R := x[t] > 1 until_[0,1] (y[t] > 1 until z[t] > 1)")
    assert str(rtamt.parse(found.text).formula) == "x > 1 until[0:1] (y > 1 until z > 1)"
    assert not read_breach("R := x[t] > 1 until_[0,1] y[t] > 1 and z[t] > 1 until x[t] > 2").rejected
    (rejected,) = write_breach(rtamt.parse("x > 1 until[0:1] (y > 1 until z > 1)")).rejected
    assert rejected.reason == "Breach reads 'until' and 'until_' in one chain in another order"


def test_implications_of_py_metric_temporal_logic_associate_to_the_left() -> None:
    bools = "bool a\nbool b\nbool c\n"
    formula = rtamt.parse(bools + "(a -> b) -> c").formula
    assert rtamt.parse(read_mtl("(a -> b -> c)").text).formula == formula
    assert write_mtl(rtamt.parse(bools + "require R: a -> b -> c")).text.strip() == "R: (a -> (b -> c))"


def test_weak_until_of_py_metric_temporal_logic_has_a_note_and_no_interval() -> None:
    note = "its evaluator takes 'a W b' as true where b never holds from then on; here a has to hold then"
    assert note in read_mtl("(a W b)").notes
    assert note not in read_mtl("(a U b)").notes
    text = "bool a\nbool b\nrequire R: a unless b\nrequire S: a unless[0:2] b"
    found = write_mtl(rtamt.parse(text))
    assert (found.text.strip(), found.notes[-1]) == ("R: (a W b)", note)
    (rejected,) = found.rejected
    assert rejected.reason == (
        "py-metric-temporal-logic has no 'W' with an interval, as in 'a unless[0:2] b'"
    )


_FTSPEC = "INPUT a, b: bool; x: float; FTSPEC R: %s;"


@pytest.mark.parametrize(
    ("read", "text", "reason"),
    [
        (read_mtl, "3", "'3' is a number, and a formula is needed"),
        (read_mtl, "G(3)", "'3' is a number, and a formula is needed in 'G 3'"),
        (read_mtl, "(a & 3)", "'3' is a number, and a formula is needed in 'a & 3'"),
        (read_mtl, "G[0,2s] a", "py-metric-temporal-logic has no '2s'"),
        (read_mtl, "G[0,2 s] a",
         "'2 s' is no bound of py-metric-temporal-logic, whose bounds are numbers of seconds or inf"),
        (read_mtl, "G[0:2] a", "py-metric-temporal-logic has no ':'"),
        (read_mtl, "G(0,2) a", "py-metric-temporal-logic has closed intervals only, unlike 'G(0:2) a'"),
        (read_mtl, "(a & b) // c", "py-metric-temporal-logic has no '/'"),
        (read_mtl, '"a"', "py-metric-temporal-logic has no '\"'"),
        (read_c2po, _FTSPEC % "3", "'3' is a number, and a formula is needed"),
        (read_c2po, _FTSPEC % "x", "'x' is a number, and a formula is needed"),
        (read_c2po, _FTSPEC % "a && x", "'x' is a number, and a formula is needed in 'a && x'"),
        (read_c2po, _FTSPEC % "F[0,.5] a", "'.5' is no bound of C2PO, whose bounds are whole numbers of samples"),
        (read_c2po, _FTSPEC % "F[0,5.0] a", "'5.0' is no bound of C2PO, whose bounds are whole numbers of samples"),
        (read_c2po, _FTSPEC % "F[0,inf] a", "'inf' is no bound of C2PO, whose bounds are whole numbers of samples"),
        (read_c2po, _FTSPEC % "F[0,5s] a", "C2PO has no '5s'"),
        (read_c2po, _FTSPEC % "F[0,5) a", "C2PO has closed intervals only, unlike 'F[0:5) a'"),
        (read_c2po, _FTSPEC % "x > 1_0", "C2PO has no '1_0'"),
        (read_c2po, _FTSPEC % "a /* b */ && a", "C2PO has no '/'"),
        (read_breach, "R := 3", "'3' is a number, and a formula is needed"),
        (read_breach, "R := not x[t]", "'x' is a number, and a formula is needed in 'not x'"),
        (read_breach, "R := alw_[0,2s] (x[t] > 3)", "Breach has no '2s'"),
        (read_breach, "R := alw_[0:2] (x[t] > 3)", "Breach has no ':'"),
        (read_breach, "R := alw_[0,2) (x[t] > 3)", "Breach has closed intervals only, unlike 'alw_[0:2)(x > 3)'"),
        (read_breach, "R := x[t] > 1 -> x[t] > 2", "Breach has no '-'"),
        (read_breach, "R := x[t] > 1 // 2", "Breach has no '/'"),
    ],
)  # fmt: skip
def test_what_only_this_language_has_is_rejected(read, text: str, reason: str) -> None:
    found = read(text)
    assert found.converted == ()
    assert found.rejected[0].reason.splitlines()[0] == reason


@pytest.mark.parametrize(
    ("read", "text"), [(read_mtl, "R: a\nR: b"), (read_c2po, "INPUT a, b: bool; FTSPEC R: a; R: b;")]
)
def test_a_second_formula_of_one_name_is_left_out(read, text: str) -> None:
    found = read(text)
    assert (found.converted, list(rtamt.parse(found.text).requirements)) == (("R",), ["R"])
    assert found.rejected == (("R", "there are two requirements of this name"),)


@pytest.mark.parametrize(
    ("read", "text", "message"),
    [
        (read_c2po, "INPUT a bool; FTSPEC a;", "'a bool' declares no inputs, such as a, b: bool"),
        (read_c2po, "INPUT a: bool; a: float; FTSPEC a;", "the input 'a' is declared twice"),
        (read_c2po, "INPUT a: bool; DEFINE a := 3; FTSPEC a;", "'a' is defined twice"),
        (read_c2po, "DEFINE c 3; FTSPEC true;", "'c 3' is no definition, such as near := x < 1"),
        (read_c2po, "ENUM e {A}; FTSPEC true;", "'e {A}' is no enumeration, such as Mode: {Idle, Busy: 4}"),
        (read_c2po, "ENUM e: {A: x}; FTSPEC true;",
         "'A: x' is no member of the enumeration e, such as Idle or Busy: 4"),
        (read_c2po, "ENUM e: {A, A}; FTSPEC true;", "the enumeration e has the member 'A' twice"),
        (read_breach, "signal x, 3\nR := x[t] > 3", "'3' is no name of a signal: use letters, digits and underscores"),
        (read_breach, "R := x[t] > 3\nR := x[t] > 4", "'R' is the name of two formulas: rename one of them"),
    ],
)  # fmt: skip
def test_a_malformed_statement_is_an_error(read, text: str, message: str) -> None:
    with pytest.raises(UsageError) as error:
        read(text)
    assert str(error.value) == message


@pytest.mark.parametrize(
    ("formula", "here"), [("(a ∧ b)", "a and b"), ("(a ∨ b)", "a or b"), ("(a ⇔ b)", "a <-> b"), ("(a ⊕ b)", "a xor b")]
)  # fmt: skip
def test_symbols_of_py_metric_temporal_logic(formula: str, here: str) -> None:
    assert rtamt.parse(read_mtl(formula).text).formula == rtamt.parse(f"bool a\nbool b\n{here}").formula


@pytest.mark.parametrize(
    ("formula", "here"),
    [
        ("prev(true, a)", "delay[1](a, true)"),
        ("!prev(false, a) && b", "not delay[1](a, false) and b"),
        ("F[0,2] prev(a, prev(true, b))", "eventually[0:2] delay[1](delay[1](b, true), a)"),
        ("prev(0, x) > 1", "delay[1](x, 0) > 1"),
    ],
)
def test_the_previous_value_in_c2po_is_a_boolean_or_a_number(formula: str, here: str) -> None:
    found = read_c2po(_FTSPEC % formula)
    declared = "input bool a\ninput bool b\ninput float x\n"
    assert rtamt.parse(found.text).formula == rtamt.parse(f"{declared}always({here})").formula
