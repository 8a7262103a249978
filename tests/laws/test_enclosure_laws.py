"""Laws of interval extensions, for every operator that has one."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rtamt.language.definitions.enclosures import Enclosure, extended
from rtamt.language.operators import STL
from rtamt.language.parsing.parser import parse_formula
from rtamt.rewrite.truth import truth

# The truths of predicates are operators too, though the language does not have them.
EXTENDED = [op for op in STL if op.extension] + [
    truth(parse_formula(text)).op for text in ("x > 0", "x >= 0", "x == 0")
]

OPERATORS = [pytest.param(op, id=op.name) for op in EXTENDED]

NUMBERS = st.one_of(
    st.integers(-8, 8).map(lambda k: k / 2),
    st.sampled_from((-0.0, math.inf, -math.inf, 1e300, -1e300, 5e-324, 709.9)),
    st.floats(-100, 100),
)


def enclosure(*pairs: tuple[float, float]) -> list[Enclosure]:
    return [Enclosure(np.array([low]), np.array([high])) for low, high in pairs]


def value(op, points: tuple[float, ...]) -> float:
    return float(op.definition(*(np.array([x]) for x in points))[0])


def bounds(op, pairs: list[tuple[float, float]]) -> tuple[float, float]:
    with np.errstate(all="ignore"):
        found = extended(op.definition, op.extension, enclosure(*pairs))
    return float(found.lower[0]), float(found.upper[0])


@st.composite
def nested(draw) -> tuple[tuple[float, float], tuple[float, float]]:
    """Draw bounds and narrower ones in them."""
    four = draw(st.tuples(NUMBERS, NUMBERS, NUMBERS, NUMBERS))
    a, b, c, d = sorted(four, key=lambda x: (x, math.copysign(1.0, x)))
    return (a, d), draw(st.sampled_from(((b, c), (a, b), (c, d), (b, b))))


@pytest.mark.parametrize("op", OPERATORS)
@settings(max_examples=40)
@given(data=st.data())
def test_every_value_for_operands_within_their_bounds_lies_within_the_bounds(op, data):
    pairs = [data.draw(nested()) for _ in op.operands]
    lower, upper = bounds(op, [wide for wide, _ in pairs])
    for points in product(*({*wide, *narrow} for wide, narrow in pairs)):
        of_points = value(op, points)
        assert math.isnan(of_points) or lower <= of_points <= upper


@pytest.mark.parametrize("op", OPERATORS)
@settings(max_examples=40)
@given(data=st.data())
def test_narrower_operands_give_narrower_bounds(op, data):
    pairs = [data.draw(nested()) for _ in op.operands]
    lower, upper = bounds(op, [wide for wide, _ in pairs])
    inner = bounds(op, [narrow for _, narrow in pairs])
    assert math.isnan(inner[0]) or lower <= inner[0] <= inner[1] <= upper


@pytest.mark.parametrize("op", OPERATORS)
@settings(max_examples=40)
@given(data=st.data())
def test_of_known_operands_the_bounds_are_the_value(op, data):
    points = tuple(data.draw(NUMBERS) for _ in op.operands)
    lower, upper = bounds(op, [(x, x) for x in points])
    np.testing.assert_equal((lower, upper), (value(op, points),) * 2)


@pytest.mark.parametrize("op", OPERATORS)
@settings(max_examples=40)
@given(data=st.data())
def test_a_result_moves_with_its_operands_as_its_slopes_say(op, data):
    points = [data.draw(NUMBERS) for _ in op.operands]
    place = data.draw(st.integers(0, len(points) - 1))
    constants = [None if k == place or data.draw(st.booleans()) else x for k, x in enumerate(points)]
    slope = op.slopes(*constants)[place]
    other = data.draw(NUMBERS)
    assume(other > points[place])
    before, after = value(op, tuple(points)), value(op, (*points[:place], other, *points[place + 1 :]))
    if slope in (1, -1):
        assert math.isnan(before) or math.isnan(after) or (before <= after if slope == 1 else before >= after)


def test_corners_without_a_value():
    ops = {op.name: op for op in EXTENDED}
    inf = math.inf
    assert bounds(ops["sub"], [(-inf, inf), (-inf, inf)]) == (-inf, inf)
    assert bounds(ops["add"], [(0, inf), (-inf, 0)]) == (-inf, inf)
    assert bounds(ops["mul"], [(0, 0), (-inf, inf)]) == (0, 0)
    assert bounds(ops["mul"], [(0, 1), (-inf, 2)]) == (-inf, 2)
    assert bounds(ops["div"], [(1, 2), (-1, 1)]) == (-inf, inf)
    assert bounds(ops["div"], [(1, 2), (4, inf)]) == (0, 0.5)
    assert bounds(ops["sqrt"], [(-4, 4)]) == (0, 2)
    assert math.isnan(bounds(ops["sqrt"], [(-4, -1)])[0])
    assert bounds(ops["pow"], [(-2, 1), (2, 2)]) == (0.0, 4.0000000000000036)
    # Only odd powers have two limits at 0, and a narrower base may not widen the bounds.
    low, high = bounds(ops["pow"], [(-2, 4), (-0.5, -0.5)])
    assert low == pytest.approx(0.5)
    assert high == inf
    assert bounds(ops["pow"], [(0, 4), (-3, -3)]) == (-inf, inf)
    assert bounds(ops["pow"], [(-2, 4), (0, 0)]) == bounds(ops["pow"], [(0, 4), (0, 0)]) == (1, 1)
    assert bounds(ops["holds_eq"], [(1, 2), (2, 3)]) == (-inf, inf)
    assert bounds(ops["holds_gt"], [(3, 4), (1, 2)]) == (inf, inf)
