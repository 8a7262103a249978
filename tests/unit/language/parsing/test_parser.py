"""Text to formula: which tree, which spans, which names."""

import json
import re
from dataclasses import replace
from fractions import Fraction
from math import copysign, inf
from pathlib import Path

import pytest

from rtamt.errors import ParseError
from rtamt.language.formula import Apply, Const, Interval, Span, Var, fold, postorder
from rtamt.language.operators import STL, Bounds, Fixity, Sort
from rtamt.language.parsing.parser import parse_formula as parse
from rtamt.language.shares import Share, ShareKind

X, Y, Z = Var("x"), Var("y"), Var("z")


def op(name, *args, interval=None):
    return STL[name](*args, interval=interval)


CORPUS = Path(__file__).parents[4] / "conformance" / "corpus" / "discrete.jsonl"


def seconds(begin, end):
    return Interval(Fraction(begin), None if end is None else Fraction(end))


@pytest.mark.parametrize("operator", STL.operators, ids=lambda o: o.name)
def test_the_example_of_every_operator(operator):
    found = {n.op for n in postorder(parse(operator.example)) if isinstance(n, Apply)}
    assert operator in found


@pytest.mark.parametrize("operator", STL.operators, ids=lambda o: o.name)
def test_every_spelling_of_every_operator(operator):
    interval = seconds(0, 5) if operator.bounds is Bounds.REQUIRED else None
    bounds = "" if interval is None else "[0:5]"
    share = ""
    if operator.share:
        interval, share = replace(interval, share=Share(Fraction(80), ShareKind.PERCENT)), "80%, "
    names = [
        STL["gt"](Var(f"v{k}"), Const(0)) if sort is Sort.CONDITION else Var(f"v{k}")
        for k, sort in enumerate(operator.operands)
    ]
    for spelling in operator.spellings:
        text = {
            Fixity.ATOM: spelling,
            Fixity.FUNCTION: f"{spelling}{bounds}({share}{', '.join(map(str, names))})",
            Fixity.PREFIX: f"{spelling}{bounds} v0",
            Fixity.CONDITIONAL: f"{spelling} v0 > 0 then v1 else v2",
        }.get(operator.fixity, f"v0 {spelling}{bounds} v1")
        assert parse(text) == operator(*names, interval=interval)


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("x + y * z", "x + (y * z)"),
        ("x - y - z", "(x - y) - z"),
        ("x -> y -> z", "x -> (y -> z)"),
        ("x <-> y <-> z", "(x <-> y) <-> z"),
        ("not x >= 1", "not (x >= 1)"),
        ("not x and y", "(not x) and y"),
        ("always x >= 1 and y", "(always (x >= 1)) and y"),
        ("x or y and z", "x or (y and z)"),
        ("x since y and z", "(x since y) and z"),
        ("x until y since z", "(x until y) since z"),
        ("not always x", "not (always x)"),
        ("always not x", "always (not x)"),
        ("prev always x", "prev (always x)"),
        ("if p > 0 then x else y + 1 > 2", "(if (p > 0) then (x) else (y + 1)) > 2"),
        ("if a > 0 then x else if b > 0 then y else z", "if a > 0 then x else (if b > 0 then y else z)"),
        ("if -x > 1 then X else Y", '(if ((-x) > 1) then ("X") else "Y")'),
        ("if -x > 1 and true then x else y", "if ((-x) > 1 and true) then x else y"),
        ("if -x in {1} then x else y", "if ((-x) in {1}) then x else y"),
        ("if -x > abs then x else y", "if ((-x) > abs) then x else y"),
        ("if > 3 and then - else > if", '"if" > 3 and "then" - "else" > "if"'),
        ("if - then > 3", '"if" - "then" > 3'),
        ("x + y >= once[0:2] z", "(x + y) >= (once[0:2] z)"),
        ("x >= once y + z and x", "(x >= once(y + z)) and x"),
        ("x - prev y", "x - (prev y)"),
        ("not prev x >= 1 until y", "(not (prev (x >= 1))) until y"),
        ("x and not y", "x and (not y)"),
        ("x until always y", "x until (always y)"),
        ("-x * y", "(-x) * y"),
        ("x * -y", "x * (-y)"),
        ("- - x", "-(-x)"),
        ("min(x, y, z)", "min(min(x, y), z)"),
        ("G x & y | z", "((always x) and y) or z"),
        ("a/b/c", "(a / b) / c"),
    ],
)
def test_what_binds_tighter(text, same):
    assert parse(text) == parse(same)


# ---- words that are operators only where an operator can stand -----------------------------------


@pytest.mark.parametrize(
    ("text", "formula"),
    [
        ("G >= 3", op("ge", Var("G"), Const(3.0))),
        ("G(G >= 3)", op("always", op("ge", Var("G"), Const(3.0)))),
        ("F[0,5] F > 1", op("eventually", op("gt", Var("F"), Const(1.0)), interval=seconds(0, 5))),
        ("s >= 1", op("ge", Var("s"), Const(1.0))),
        ("x S S", op("since", X, Var("S"))),
        ("S S S", op("since", Var("S"), Var("S"))),
        ("G U x", op("until", Var("G"), X)),
        ("G U U", op("until", Var("G"), Var("U"))),
        ("G U", op("always", Var("U"))),
        ("G F", op("always", Var("F"))),
        ("G F x", op("always", op("eventually", X))),
        ("G and F", op("and", Var("G"), Var("F"))),
        ("always U >= 3", op("always", op("ge", Var("U"), Const(3.0)))),
        ("G U[0:5] x", op("until", Var("G"), X, interval=seconds(0, 5))),
        ("min + abs(abs)", op("add", Var("min"), op("abs", Var("abs")))),
        ("next >= 3", op("ge", Var("next"), Const(3.0))),
        ("G - 3", op("always", Const(-3.0))),
        ("G", Var("G")),
        ("X(Y)", op("next", Var("Y"))),
        ('"always"', Var("always")),
        ('G "always"', op("always", Var("always"))),
        ("(G) - 3", op("sub", Var("G"), Const(3.0))),
        ("G /ns/x", op("always", Var("/ns/x"))),
        ("G / ns", op("div", Var("G"), Var("ns"))),
    ],
)
def test_words_are_operators_only_where_one_can_stand(text, formula):
    assert parse(text) == formula


def test_a_declared_name_before_a_minus_is_a_variable():
    assert parse("G - 3", variables=["G"]) == op("sub", Var("G"), Const(3.0))
    assert parse("G (x)", variables=["G", "x"]) == op("always", X)


# ---- names ---------------------------------------------------------------------------------------


def test_fields_are_declared_with_their_signal():
    assert parse("req.header.stamp", variables=["req"]) == Var("req.header.stamp")
    assert parse("req.value", variables=["req.value"]) == Var("req.value")


@pytest.mark.parametrize(
    ("text", "declared", "formula"),
    [
        ("a/b", None, op("div", Var("a"), Var("b"))),
        ("a/b", ["a", "b"], op("div", Var("a"), Var("b"))),
        ("a/b", ["a/b"], Var("a/b")),
        ("a/b", ["a", "b", "a/b"], Var("a/b")),
        ("a / b", ["a", "b", "a/b"], op("div", Var("a"), Var("b"))),
        ("a/b/a", ["a", "a/b"], op("div", Var("a/b"), Var("a"))),
        ("a/b.value", ["a/b"], Var("a/b.value")),
        ("/ns/req.value", None, Var("/ns/req.value")),
        ("/ns/req", ["/ns/req"], Var("/ns/req")),
        ("x/ /ns/req", None, op("div", X, Var("/ns/req"))),
        ('"a/b" / "my col"', None, op("div", Var("a/b"), Var("my col"))),
    ],
)
def test_topics_and_divisions(text, declared, formula):
    assert parse(text, variables=declared) == formula


def test_constants_become_numbers_at_once():
    constants = {"low": -2.0, "a/b": 0.5}
    assert parse("low + a/b", constants=constants) == op("add", Const(-2.0), Const(0.5))
    assert parse("-low", constants=constants) == op("neg", Const(-2.0))


def test_definitions_are_shared_and_not_copied():
    inner = parse("x >= 3")
    formula = parse("always(ok) and ok", definitions={"ok": inner})
    assert formula == parse("always(x >= 3) and x >= 3")
    assert formula.args[1] is inner


def test_infinity_is_a_number_unless_it_is_a_name():
    assert parse("inf") == Const(inf)
    assert parse("-inf") == Const(-inf)
    assert parse("inf", variables=["inf"]) == Var("inf")
    assert parse("-inf", constants={"inf": 3.0}) == op("neg", Const(3.0))
    assert parse("true") == op("true")


@pytest.mark.parametrize(
    ("text", "formula"),
    [
        ("-2", Const(-2.0)),
        ("-(2)", op("neg", Const(2.0))),
        ("(-2)", Const(-2.0)),
        ("--2", op("neg", Const(-2.0))),
        ("x - 2", op("sub", X, Const(2.0))),
        ("x - -2", op("sub", X, Const(-2.0))),
        ("x -2", op("sub", X, Const(2.0))),
        ("-2 * x", op("mul", Const(-2.0), X)),
    ],
)
def test_a_negative_literal_keeps_its_sign(text, formula):
    assert parse(text) == formula


def test_minus_zero():
    assert copysign(1.0, parse("-0").value) == -1.0


# ---- intervals -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("bounds", "unit", "interval", "units"),
    [
        ("[0:5]", "s", seconds(0, 5), ("", "")),
        ("[0,5]", "s", seconds(0, 5), ("", "")),
        ("[ 0 : 5 ]", "s", seconds(0, 5), ("", "")),
        ("[.5:1e3]", "s", seconds(Fraction(1, 2), 1000), ("", "")),
        ("[0.1:0.3]", "s", seconds(Fraction(1, 10), Fraction(3, 10)), ("", "")),
        ("[1/3:2/3]", "s", seconds(Fraction(1, 3), Fraction(2, 3)), ("", "")),
        ("[0:500ms]", "s", seconds(0, Fraction(1, 2)), ("ms", "ms")),
        ("[100:500 ms]", "s", seconds(Fraction(1, 10), Fraction(1, 2)), ("ms", "ms")),
        ("[100ms:1]", "s", seconds(Fraction(1, 10), 1), ("ms", "")),
        ("[1ns:1us]", "s", seconds(Fraction(1, 10**9), Fraction(1, 10**6)), ("ns", "us")),
        ("[1:2]", "ms", seconds(Fraction(1, 1000), Fraction(1, 500)), ("ms", "ms")),
        ("[1:2s]", "ms", seconds(1, 2), ("s", "s")),
        ("[1:inf]", "ms", seconds(Fraction(1, 1000), None), ("ms", "")),
        ("[T:W]", "s", seconds(Fraction(1, 10), 2), ("", "")),
        ("[T ms:W s]", "s", seconds(Fraction(1, 10000), 2), ("ms", "s")),
        ("[0:never]", "s", seconds(0, None), ("", "")),
    ],
)
def test_intervals(bounds, unit, interval, units):
    constants = {"T": 0.1, "W": 2, "never": inf}
    found = parse(f"always{bounds} x", unit=unit, constants=constants).interval
    assert found == interval
    assert (found.begin_unit, found.end_unit) == units


def test_a_zero_with_a_huge_exponent_is_zero_at_once():
    assert parse("always[0e-999999999:0e999999999] x").interval == seconds(0, 0)


def test_milliseconds_are_not_inverted():
    assert parse("always[0:500ms] x").interval == seconds(0, Fraction(1, 2))


# ---- spans ---------------------------------------------------------------------------------------


def test_every_node_knows_its_place():
    text = "always[0:5](x >= 3) and (y + -2 > min(x, y))"
    places = {text[n.span.start : n.span.end] for n in postorder(parse(text))}
    assert places == {
        text,
        "always[0:5](x >= 3)",
        "x >= 3",
        "x",
        "3",
        "y + -2 > min(x, y)",
        "y + -2",
        "y",
        "-2",
        "min(x, y)",
    }
    interval = parse(text).args[0].interval
    assert interval.span == Span(6, 11)


def test_a_place_includes_the_parentheses_of_the_operands():
    assert parse("(x) >= (3)").span == Span(0, 10)


# ---- size, extension -----------------------------------------------------------------------------


def test_ten_thousand_conjuncts():
    formula = parse(" and ".join(["x >= 1"] * 10_000))
    assert sum(1 for n in postorder(formula) if isinstance(n, Apply) and n.op.name == "and") == 9_999


def test_depth_up_to_the_limit():
    assert parse("(" * 199 + "x" + ")" * 199) == X


def test_an_extended_language_is_read_by_its_own_table():
    language = STL.extend(
        replace(STL["always"], name="box", spellings=("[]>", "box")),
        replace(STL["until"], name="weak", spellings=("~~>", "weak")),
        replace(STL["min"], name="least", spellings=("least",)),
        replace(STL["mul"], name="power", spellings=("^",), power=130, fixity=Fixity.RIGHT),
    )
    box, weak = language["box"], language["weak"]
    assert parse("[]>[0:5] x ~~> y", language=language) == weak(box(X, interval=seconds(0, 5)), Y)
    assert parse("box x weak y", language=language) == weak(box(X), Y)
    assert parse("least(x, y) and box >= least", language=language) == op(
        "and", language["least"](X, Y), op("ge", Var("box"), Var("least"))
    )
    assert parse("-2 ^ x", language=language) == op("neg", language["power"](Const(2.0), X))
    assert parse("box >= 1") == op("ge", Var("box"), Const(1.0))
    with pytest.raises(ParseError) as info:
        parse("box x")
    assert str(info.value) == (
        "expected an operator between 'box' and 'x'\n  line 1, column 5:\n    box x\n        ^"
    )


def test_parsing_changes_nothing_of_the_callers():
    constants, definitions, names = {"c": 1.0}, {"d": X}, ["x"]
    parse("x > c and d", constants=constants, definitions=definitions, variables=names)
    assert (constants, definitions, names) == ({"c": 1.0}, {"d": X}, ["x"])


@pytest.mark.parametrize(
    ("chain", "meaning"),
    [
        ("1 <= x <= 3", "1 <= x and x <= 3"),
        ("3 > x >= y > -1", "(3 > x and x >= y) and y > -1"),
        ("not 1 <= x + y < 2 * z", "not (1 <= x + y and x + y < 2 * z)"),
        (
            "0 < x < y until[0:2] 1 >= y >= 0 or z > 1",
            "(0 < x and x < y) until[0:2] (1 >= y and y >= 0) or z > 1",
        ),
    ],
)
def test_comparisons_in_one_direction_chain(chain, meaning):
    assert parse(chain) == parse(meaning)


def test_a_variable_called_if_stays_a_variable_where_it_is_declared():
    assert parse("if > then", variables=["if", "then"]) == STL["gt"](Var("if"), Var("then"))
    with pytest.raises(ParseError, match="expected an operator between 'if' and 'x'"):
        parse("if x > 3 then 1 else 2", variables=["if", "x"])


@pytest.mark.parametrize("word", ["if", "then", "else", "held", "delay", "ahead", "diff", "rate"])
def test_formulas_over_a_variable_with_a_new_word_read_as_before(word):
    for line in CORPUS.read_text(encoding="utf-8").splitlines()[::40]:
        formula = parse(json.loads(line)["formula"])
        renamed = fold(formula, lambda node, args: _renamed(node, args, word))
        written = re.sub(r"\bx\b", word, str(formula))
        assert parse(written) == renamed == parse(str(renamed))


def _renamed(node, args, word):
    if isinstance(node, Var):
        return Var(word) if node.name == "x" else node
    return Apply(node.op, args, node.interval) if isinstance(node, Apply) else node
