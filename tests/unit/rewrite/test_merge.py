"""Equal parts of formulas become one node, and what differs in meaning does not."""

import pytest

import rtamt
from rtamt.language.formula import Apply, Const, Parameter, Var, postorder
from rtamt.language.operators import STL
from rtamt.language.parsing.parser import parse_formula
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
        ("always[0:5](x > 3) or always(x > 3)", 6),
        ("atleast[0:5](50%, x > 3) or atleast[0:5](60%, x > 3)", 6),
        ("x > 3 and y > 3", 6),
        ("x > 3 and x >= 3", 5),
        ("x > 3 and 3 > x", 5),
    ],
)
def test_equal_parts_are_one_node(text, nodes):
    formula = parse_formula(text)
    (one,) = merged([formula])
    assert one == formula
    assert count(one) == nodes
    assert merged([one])[0] is one


def test_the_first_of_equal_parts_stands_for_all_with_its_position():
    formula = parse_formula("always(x > 3) and eventually(x > 3)")
    (one,) = merged([formula])
    assert one.args[0] is formula.args[0]
    assert one.args[1].args[0].span == formula.args[0].args[0].span


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
    one, other = merged([parse_formula("x > 3"), parse_formula("not(x > 3)")])
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
