"""Pastification is exact: ρ(φ, w, t) = ρ(Π(φ), w, t + H(φ)) for every formula with bounded future."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rtamt.language.formula import Apply, Const, Formula, Interval, Var, fold, postorder
from rtamt.language.operators import STL, Operator, Sort, Tense
from rtamt.language.parsing.parser import parse_formula
from rtamt.rewrite.check import has_future
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.pastify import pastify
from tests.laws.test_engine_laws import by_definition, by_engine
from tests.support.strategies import formulas, traces

SUMS = {"sum", "mean", "integral"}

#: Operators whose numbers are multiples of a power of two where those of their operands are.
DYADIC = {
    "abs", "min", "max", "neg", "add", "sub", "mul", "floor", "ceil", "round", "sign", "clip", "if", "sum", "integral",
    "minimum", "maximum", "duration", "count", "delay", "ahead", "diff", "held",
}  # fmt: skip


def sums_round(node: Formula) -> bool:
    """Return whether a node adds numbers whose sum depends on the order of additions."""
    if not isinstance(node, Apply) or node.op.name not in SUMS:
        return False
    return any(
        isinstance(part, Apply) and part.op.result is Sort.NUMBER and part.op.name not in DYADIC
        for part in postorder(node.args[0])
    )


@pytest.mark.parametrize("evaluate", [by_definition, by_engine])
@given(data=st.data(), period=st.sampled_from([Fraction(1), Fraction(1, 4)]))
def test_the_pastified_formula_says_the_same_one_horizon_later(
    evaluate: Any, data: st.DataObject, period: Fraction
) -> None:
    formula = data.draw(formulas(period=period))
    columns = data.draw(traces())
    assume(not any(map(sums_round, postorder(formula))))  # pastified, blocks begin at other samples
    depth = horizon(formula, period)
    assert depth is not None
    delay = int(depth / period)
    assume(delay < len(columns["x"]))
    expected = by_definition(formula, columns, period)
    assume(expected is not None)
    past = pastify(formula, period)
    assert not has_future(past)
    got = evaluate(past, columns, period)
    assert expected is not None
    assert got is not None, past
    np.testing.assert_array_equal(got[delay:], expected[: len(expected) - delay])


def of_numbers(op: Operator) -> bool:
    return op.result is Sort.NUMBER or op.tense is Tense.NONE


def partial_numbers(x: Formula, y: Formula) -> list[Formula]:
    """Return numbers that have no value for some values of x and y."""
    windows = [Interval(Fraction(0), Fraction(1)), Interval(Fraction(1), Fraction(3))]
    least = [STL["minimum"](x, interval=window) for window in windows]
    return [
        *(STL[name](x, y) for name in ("add", "sub", "mul", "div", "pow", "log", "mod")),
        *(STL[name](x) for name in ("sqrt", "ln", "asin", "acos", "tan")),
        *(STL[name](y, x, Const(1.0)) for name in ("clip", "wrap")),
        STL["sub"](*least),
        STL["sub"](STL["if"](STL["eventually"](STL["lt"](x, y), interval=windows[0]), x, y), y),
        STL["sqrt"](STL["sub"](STL["sqrt"](x), STL["sqrt"](y))),
    ]


@st.composite
def formulas_over_numbers_ahead(draw: Any, formulas: Any, period: Fraction = Fraction(1)) -> Formula:
    """Draw a formula with variables read ahead, in functions that have no value everywhere, too."""

    def ahead(number: Formula, least: int = 0) -> Formula:
        distance = draw(st.integers(least, 2)) * period
        return STL["ahead"](number, interval=Interval(distance, distance))

    def step(node: Formula, below: tuple[Formula, ...]) -> Formula:
        if isinstance(node, Var):
            return ahead(node)
        if not isinstance(node, Apply):
            return node
        return Apply(node.op, below, node.interval)

    other = draw(st.sampled_from((Const(2.0), Var("y"), STL["sin"](Var("y")), ahead(Var("y")))))
    number = draw(st.sampled_from(partial_numbers(ahead(Var("x"), 1), other)))
    compared = STL[draw(st.sampled_from(("ge", "lt", "eq")))](
        number, draw(st.sampled_from((Const(1.0), Var("y"))))
    )
    return STL["and"](fold(draw(formulas), step), compared)


@pytest.mark.parametrize("evaluate", [by_definition, by_engine])
@given(
    formula=formulas_over_numbers_ahead(formulas(select=of_numbers)),
    columns=traces(min_size=4, infinite=True),
)
def test_a_number_ahead_inside_arithmetic_is_defined_before_the_horizon_too(
    evaluate: Any, formula: Formula, columns: dict[str, Any]
) -> None:
    assume(not any(map(sums_round, postorder(formula))))
    expected = by_definition(formula, columns)
    assume(expected is not None)
    assert expected is not None
    got = evaluate(pastify(formula), columns)
    assert got is not None, pastify(formula)
    delay = int(horizon(formula) or 0)
    np.testing.assert_array_equal(got[delay:], expected[: max(0, len(expected) - delay)])


@given(formulas(future=False))
def test_a_past_formula_is_its_own_pastification(formula: Formula) -> None:
    assert pastify(formula) == formula


@given(formulas())
def test_a_pastified_formula_can_be_printed_and_read_again(formula: Formula) -> None:
    past = pastify(formula)
    assert parse_formula(str(past)) == past


def test_a_deep_chain_needs_no_recursion() -> None:
    formula: Formula = parse_formula("next(x)")
    for _ in range(3000):
        formula = Apply(STL["and"], (formula, formula))
    assert horizon(pastify(formula)) == 0
