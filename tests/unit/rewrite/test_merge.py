"""Equal parts of formulas become one node, and what differs in meaning does not."""

from dataclasses import replace
from fractions import Fraction

import pytest

import rtamt
from rtamt.language.formula import Apply, Const, Interval, Parameter, Span, Var, postorder
from rtamt.language.operators import STL, Bounds
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.shares import Share, ShareKind
from rtamt.language.unwritten import UNWRITTEN
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.ground import ground
from rtamt.rewrite.merge import merged


def count(*formulas):
    return len(postorder(*formulas))


@pytest.mark.parametrize(
    ("text", "nodes"),
    [
        ("always[0:5](x > 3) and eventually[0:5](x > 3)", 6),
        ("always[0:5](x > 3) or always[0:5000ms](x > 3)", 5),
        ("always[0:5](x > 3) or always[0:6](x > 3)", 6),
        ("always[0:5](x > 3) or always(0:5](x > 3)", 6),
        ("always[0:5](x > 3) or always[0:5)(x > 3)", 6),
        ("always[0:5](x > 3) or always(x > 3)", 6),
        ("atleast[0:5](50%, x > 3) or atleast[0:5](60%, x > 3)", 6),
        ("x > 3 and y > 3", 6),
        ("x > 3 and x >= 3", 4),
        ("x > 3 and 3 > x", 5),
        ("x > 3 -> not(x > 3)", 5),
        ("x == 1 or x != 1", 6),
        ("not(true) or not(true)", 3),
    ],
)
def test_equal_parts_are_one_node(text, nodes):
    formula = parse_formula(text)
    (one,) = merged([formula])
    assert one == desugar(formula)
    assert count(one) == nodes
    assert merged([one])[0] is one


@pytest.mark.parametrize(
    "op", [op for op in (*STL, *UNWRITTEN.values()) if op.binder is None], ids=lambda op: op.name
)
def test_operators_are_expanded_as_desugar_does_with_their_position(op):
    interval = None if op.bounds is Bounds.NONE else Interval(Fraction(1), Fraction(2))
    if op.bounds is Bounds.DURATION:
        interval = Interval(Fraction(1), Fraction(1))
    if op.share:
        interval = replace(interval, share=Share(Fraction(50), ShareKind.PERCENT))
    for count_of in range(len(op.operands) - op.optional, len(op.operands) + 1):
        operands = tuple(STL["mul"](Var(name), Var(name)) for name in "xyz"[:count_of])
        if op.presence:
            operands = (Var("x"),)
        formula = Apply(op, operands, interval, Span(3, 7))
        (one,) = merged([formula])
        expected = desugar(formula)
        assert one == expected
        own = [node for node in postorder(one) if isinstance(node, Apply) and node not in operands]
        assert {node.span for node in own} <= {Span(3, 7), None}
        assert len({id(node) for node in postorder(one)}) == len(set(postorder(one)))


def test_an_operator_without_an_interval_in_the_text_has_one_in_dense_time():
    (one,) = merged([ground(parse_formula("rise(x > 3)"), Fraction(1, 10), continuous=True)])
    assert str(one) == "historically[100ms:100ms](-(x - 3)) and x - 3"


def test_operands_that_an_expansion_leaves_out_are_no_part_of_the_result():
    first = replace(STL["and"], name="first", definition=None, kernel=None, expansion=lambda a, _b, _i: a)
    (one,) = merged([STL["not"](first(Var("x"), Var("y")))])
    assert postorder(one) == (Var("x"), STL["neg"](Var("x")))


def test_an_expansion_by_its_operands_is_made_anew_for_each():
    doubled = replace(
        STL["neg"],
        name="doubled",
        definition=None,
        kernel=None,
        expansion=lambda a, _i: Const(2 * a.value) if isinstance(a, Const) else STL["add"](a, a),
    )
    one, other = merged([doubled(Const(3.0)), doubled(Var("x"))])
    assert (one, other) == (Const(6.0), STL["add"](Var("x"), Var("x")))


def test_the_first_of_equal_parts_stands_for_all_with_its_position():
    formula = parse_formula("always(x > 3) and eventually(x > 3)")
    (one,) = merged([formula])
    assert one.args[0].args[0].span == formula.args[0].args[0].span
    assert one.args[1].args[0] is one.args[0].args[0]


def test_zeros_of_different_sign_parameters_and_constants_are_different():
    leaves = [
        Const(0.0),
        Const(-0.0),
        Const(0.0, name="zero"),
        Parameter(0.0, name="p"),
        Parameter(0.0, name="q"),
        Parameter(1.0, name="p"),
        Var("zero"),
    ]
    assert [*map(id, merged(leaves))] == [*map(id, leaves)]


def test_formulas_share_equal_parts():
    one, other = merged([parse_formula("x - 3"), parse_formula("-(x - 3)")])
    assert isinstance(other, Apply)
    assert other.args == (one,)
    assert other.args[0] is one


def test_graphs_are_walked_node_by_node():
    formula = Var("x")
    for _ in range(60):
        formula = STL["and"](formula, formula)
    (one,) = merged([formula])
    assert count(one) == count(formula) == 61


def test_errors_of_repeated_parts_point_at_the_first():
    with pytest.raises(rtamt.BoundError) as found:
        rtamt.parse("x > 0 and always[0:1](x > 3) or always[0:1](x > 3)").monitor(period="2s")
    assert (found.value.span.start, found.value.span.end) == (16, 21)
    with pytest.raises(rtamt.EvaluationError, match=r"sqrt\(x\)"):
        rtamt.parse("sqrt(x) > 0 and y > 0 or sqrt(x) > 0").monitor().update(0, x=-1, y=1)
