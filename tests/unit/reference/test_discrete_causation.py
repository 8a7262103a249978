"""Causation, calculated by hand."""

from __future__ import annotations

from math import inf

from rtamt import Causation
from rtamt.language.parsing.parser import parse_formula
from rtamt.reference.discrete_causation import causation
from tests.unit.reference.knowledge import ONE, known


def test_causation_of_a_response_by_hand():
    formula = parse_formula("always[0:1](x >= 3)")
    x = [4, 1, 2]
    # At 0 after sample 1: it alone violates by 2. Sample 2 is outside the window of 0.
    assert causation(formula, known(2, x=x), ONE, 1) == [Causation(-2, -2)]
    assert causation(formula, known(3, x=x), ONE, 1) == [Causation(inf, -inf)]
