"""The temporal depth of formulas (the paper's Definition 3)."""

from fractions import Fraction

import pytest

from rtamt.language.parsing.parser import parse_formula
from rtamt.rewrite.horizon import horizon


@pytest.mark.parametrize(
    ("text", "depth"),
    [
        ("x >= 3", 0),
        ("once[0:5] x", 0),
        ("eventually[2:5] x", 5),
        ("always[0:10](x -> eventually[0:5] y)", 15),
        ("historically(eventually[0:2] x)", 2),
        ("once[3:4](next(next(x)))", 2),
        ("x until[1:7] next(y)", 8),
        ("x unless[1:7] y", 7),
        ("x precedes[1:7] y", 0),
        ("always[0:500ms] x", Fraction(1, 2)),
        ("eventually x", None),
        ("x until[2:inf] y", None),
        ("once(always(x))", None),
    ],
)
def test_horizon(text: str, depth: Fraction | int | None) -> None:
    assert horizon(parse_formula(text)) == depth


def test_next_counts_one_period() -> None:
    assert horizon(parse_formula("next(eventually[0:1] x)"), Fraction(1, 10)) == Fraction(11, 10)
