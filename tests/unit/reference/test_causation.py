"""Causation, calculated by hand."""

from __future__ import annotations

from math import inf

import pytest

from rtamt.errors import SpecificationError
from rtamt.language.parser import parse_formula
from rtamt.reference.causation import causation
from tests.unit.reference.knowledge import ONE, known


def test_causation_of_a_response_by_hand():
    formula = parse_formula("always[0:1](x >= 3)")
    x = [4, 1, 2]
    # At 0 after sample 1: it alone violates by 2. Sample 2 is outside the window of 0.
    assert causation(formula, known(2, x=x), ONE, 1) == [(-2, -2)]
    assert causation(formula, known(3, x=x), ONE, 1) == [(inf, -inf)]


def test_arithmetic_on_formulas_in_time_has_no_causation():
    with pytest.raises(SpecificationError, match=r"^'\(once x\) \+ 1' is arithmetic on a formula in time"):
        causation(parse_formula("(once x) + 1 >= 0"), known(x=[1]), ONE, 1)
