"""Which formulas have bounds that may be wider than necessary."""

from fractions import Fraction

import pytest

from rtamt.language.parsing.parser import parse_formula
from rtamt.rewrite.early import loose


@pytest.mark.parametrize(
    ("text", "variable"),
    [
        ("once(x > 0) or x < 5", "x"),
        ("once(x > 0) or next(x < 5)", None),
        ("x > 0 or prev(x < 5) or eventually[1:2](x > 1)", None),
        ("x > 0 or prev(x < 5) or eventually[0:2](x < 1)", "x"),
        ("once[2:9](x > 0) or prev(x < 5) or always[0:1](x > 1)", None),
        ("once[2:9](x > 0) or once[3:4](x > 1) or once[4:5](x < 5)", "x"),
        ("once[2:9](x > 0) or once[3:4](x > 1) or prev(x < 5) or prev(x > 5)", "x"),
    ],
)
def test_uses_of_a_variable_agree_where_they_are_alike_or_read_other_instants(text, variable):
    assert loose(parse_formula(text), Fraction(1)) == variable
    assert loose(parse_formula(f"({text}) and y > 0"), Fraction(1)) == variable


@pytest.mark.timeout(60)  # quadratic in the length, it takes minutes
def test_a_long_formula_is_analysed_in_linear_time():
    alike = " and ".join(f"x >= {k}" for k in range(8000))
    assert loose(parse_formula(alike), Fraction(1)) is None
    apart = " and ".join(f"once[{k}:{k}](x {'<>'[k % 2]} 0)" for k in range(3000))
    assert loose(parse_formula(apart), Fraction(1)) is None
    assert loose(parse_formula(f"{apart} and once[7:7](x < 0)"), Fraction(1)) == "x"
