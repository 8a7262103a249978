"""Pastified forms, as they print."""

from fractions import Fraction

import pytest

from rtamt.language.parsing.parser import parse_formula
from rtamt.rewrite.pastify import pastify


@pytest.mark.parametrize(
    ("text", "past"),
    [
        ("x >= 3", "x >= 3"),
        ("always[0:5](x >= 3)", "historically[0:5](x >= 3)"),
        ("eventually[2:5](x >= 3)", "once[0:3](x >= 3)"),
        ("always[0:10](x -> eventually[0:5] y)", "historically[0:10](once[5:5] x -> once[0:5] y)"),
        ("x until[2:5] y", "x precedes[2:5] y"),
        ("next(x) and y", "x and once[1:1] y"),
        ("historically(eventually[0:2] x)", "historically(once[2:2] true -> once[0:2] x)"),
        ("x since next(y)", "once[1:1] x since (y and once[1:1] true)"),
        ("always[0:500ms] x", "historically[0:500ms] x"),
        ("ahead[1](x) + 2 > 0", "x + 2 > 0"),
        ("ahead[1](x) + y > 2 * 3", "(if once[1:1] true then x else 1) + delay[1](y) > 2 * 3"),
        ("sqrt(ahead[1](x)) > 2", "sqrt(if once[1:1] true then x else 1) > 2"),
        ("y / ahead[1](x) > 2", "(if once[1:1] true then delay[1](y) else 1) / x > 2"),
        ("ahead[1](x) > y", "(if once[1:1] true then x else 1) > delay[1](y)"),
        ("ahead[1](x) * sin(y) > 0", "(if once[1:1] true then x else 1) * delay[1](sin(y)) > 0"),
        ("(if x > 0 then ahead[1](x) else 1) + 2 > 3", "(if once[1:1](x > 0) then x else 1) + 2 > 3"),
        ("clip(ahead[1](x), 0, y) > 0", "clip(x, 0, if once[1:1] true then delay[1](y) else 3) > 0"),
        ("x unless[1:2] y", "historically[0:2] x or x precedes[1:2] y"),
    ],
)
def test_pastified_form(text: str, past: str) -> None:
    assert pastify(parse_formula(text)) == parse_formula(past)


def test_next_is_delayed_by_one_period() -> None:
    assert str(pastify(parse_formula("next(x) and y"), Fraction(1, 10))) == "x and once[0.1:0.1] y"
