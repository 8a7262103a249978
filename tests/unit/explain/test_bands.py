"""Bands of values: explanations are the same with them, and with the robustness that is known."""

from __future__ import annotations

from math import inf

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rtamt
from rtamt.explain import bands, signals
from rtamt.explain.bands import Band, band_around
from rtamt.explain.explain import explain
from rtamt.signals.instants import StepFunction

NUMBERS = st.floats(-8, 8) | st.sampled_from([-inf, -2.0, -1.0, 0.0, 1.0, 2.0, inf])
TEXTS = (
    "always(atleast[0:4](50%, x >= 1))",
    "eventually(atleast[0:4](75%, x >= 1))",
    "eventually(wasatleast[0:3](2s, x >= 1) and y <= 1)",
    "always(x >= 1 -> atleast[1:5](30%, y >= 0))",
    "always(not atleast[0:4](50%, x >= 1) or y >= 1) and always(atleast[0:2](50%, y >= -1))",
    "(atleast[0:3](60%, x >= -1)) until (atleast[0:4](50%, y >= 1))",
    "always(x >= -2 since atleast[0:4](50%, atleast[0:2](50%, y >= 0)))",
    "atleast[0:6](50%, eventually[0:2](x >= 1))",
)


def steps(values):
    return StepFunction(np.arange(len(values)), np.array(values), len(values))


@given(st.lists(NUMBERS, min_size=1, max_size=9), NUMBERS.filter(lambda value: abs(value) < inf))
def test_a_band_keeps_the_values_in_it_and_the_order_of_all(values, value):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bands, "_FEW", 0)
        band = band_around(value, [steps(values)])
    assert band is not None
    assert band.contains(value)
    within, opposite = band.of(steps(values)), band.of(steps([-each for each in values]))
    found = within.each(np.arange(len(values)))
    assert (found == -opposite.each(np.arange(len(values)))).all()
    assert all(b == a for a, b in zip(values, found, strict=True) if band.contains(a) or band.contains(b))
    ordered = found[np.argsort(values, kind="stable")]
    assert (ordered[1:] >= ordered[:-1]).all()


def test_the_edge_of_a_band_is_its_last_value():
    band = Band(1.0, 3.0)
    assert [band.contains(value) for value in (0.5, 1.0, 1.5, -1.5, 3.0, inf)] == [0, 0, 1, 1, 0, 0]
    edges = [band.edge(value, toward) for value in (2.0, -2.0) for toward in (-inf, inf)]
    assert np.round(edges, 9).tolist() == [1, 3, -3, -1]
    assert all(map(band.contains, edges))
    assert Band(0.0, inf).contains(-inf)


@given(st.sampled_from(TEXTS), st.integers(0, 10**6), st.sampled_from([0, 1, 2]), st.booleans())
def test_explanations_are_the_same_with_a_band_and_without(text, seed, digits, later):
    random = np.random.default_rng(seed)
    count = int(random.integers(5, 60))
    times = np.cumsum(random.integers(1, 4, count)).astype(float)
    x, y = np.round(random.normal(size=(2, count)) * 2, digits)
    result = rtamt.parse(text, time="dense").evaluate({"x": (times, x), "y": (times, y)})
    at = float(times[2]) if later else None
    formula = result.specification.formula
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bands, "_FEW", 0)
        patch.setattr(signals, "_WORTH", 0)
        found = explain(formula, result.trace, at=at, text=text, signal=result.signal)
    expected = explain(formula, result.trace, at=at, text=text)
    assert found.to_dict() == expected.to_dict()
    assert found.text(None) == expected.text(None)
    if not later and not found.satisfied:
        assert found.first_violation == rtamt.first_violation(result)
