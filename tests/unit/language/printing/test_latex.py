"""Formulas as LaTeX."""

import pytest

from rtamt.language.parsing.parser import parse_formula as parse


@pytest.mark.parametrize(
    ("text", "latex"),
    [
        ("always[0:500ms](x >= 3)", r"\mathbf{G}_{[0, 500\,\mathrm{ms}]} (x \geq 3)"),
        ("always x", r"\mathbf{G} x"),
        ("not always(x and y)", r"\neg \mathbf{G} (x \wedge y)"),
        ("a - (b - c)", "a - (b - c)"),
        ("pow(x + 1, y + 1)", "{(x + 1)}^{y + 1}"),
        ("sqrt(x + 1)", r"\sqrt{x + 1}"),
        ("abs(x + 1)", r"\left|x + 1\right|"),
        ("exp(x)", r"\mathrm{exp}(x)"),
        ("log(x, 10)", r"\log_{10}(x)"),
        ("rise(x >= 1)", r"\uparrow (x \geq 1)"),
        ("min(a, b, c)", r"\min(\min(a, b), c)"),
        ("x until[1:inf] y", r"x \mathbin{\mathbf{U}_{[1, \infty)}} y"),
        ("x since y", r"x \mathbin{\mathbf{S}} y"),
        ("req_1.value <= -2.5", r"\mathrm{req\_1.value} \leq -2.5"),
        ("x < 1e300 and x > -inf", r"x < 1 \cdot 10^{300} \wedge x > -\infty"),
        ("-(a + b)", "-(a + b)"),
        ("true -> false", r"\top \to \bot"),
    ],
)
def test_latex(text, latex):
    assert parse(text).latex() == latex
