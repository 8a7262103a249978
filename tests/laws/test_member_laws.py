"""Quantifiers over members: a formula over a member means what it means on the trace of that member alone."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rtamt
from rtamt.errors import EvaluationError
from rtamt.language.formula import Apply, Formula, Var, fold
from rtamt.language.groups import Binder, Field, FieldOf, Group, quantified
from rtamt.rewrite.truth import rebuilt
from rtamt.testing.strategies import formulas, traces

CARS = Group("cars", "car_*", (Field("x"),))
COMBINED = {"forall": np.min, "exists": np.max, "count": lambda truths, axis: np.sum(truths > 0, axis=axis)}
EMPTY = {"forall": np.inf, "exists": -np.inf, "count": 0.0}


def quantify(word: str, body: Formula) -> Formula:
    """Return a quantifier over a formula whose variables x become fields v.x."""

    def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if isinstance(node, Var) and node.name == "x":
            return FieldOf("v.x", None, None, "v", "x", CARS)
        return rebuilt(node, args) if isinstance(node, Apply) else node

    return quantified(word, Binder("v", CARS))(fold(body, step))


def values_of(formula: Formula, data: dict[str, object]) -> np.ndarray | None:
    """Return the robustness at each sample, None where an operation has no value."""
    try:
        spec = rtamt.parse('group cars = "car_*"; true').with_formula(formula)
        return spec.evaluate(data).signal.values
    except EvaluationError:
        return None


@pytest.mark.parametrize("word", COMBINED)
@given(data=st.data())
def test_a_quantifier_means_each_member_on_its_own_trace(word, data):
    body = data.draw(formulas(3, unbounded_future=True))
    trace = data.draw(traces(("a", "b", "y"), min_size=2, max_size=12, infinite=True))
    n = len(trace["y"])
    columns: dict[str, object] = {"y": trace["y"]}
    each = np.full((2, n), EMPTY[word] if word != "count" else -np.inf)
    defined = True
    for k, name in enumerate("ab"):
        begin = data.draw(st.integers(0, n - 1))
        end = data.draw(st.integers(begin + 1, n))
        inside = range(begin, end)
        columns[f"car_{name}.x"] = [x if i in inside else None for i, x in enumerate(trace[name].tolist())]
        own = {"x": trace[name][begin:end], "y": trace["y"][begin:end]}
        try:
            spec = rtamt.parse("true").with_formula(body)
            semantics = "boolean" if word == "count" else "standard"
            each[k, begin:end] = spec.evaluate(own, semantics=semantics).signal.values
        except EvaluationError:
            defined = False
    found = values_of(quantify(word, body), columns)
    if not defined:
        return
    assert found is not None, "the error lies at an instant at which the member is absent"
    np.testing.assert_array_equal(found, COMBINED[word](each, axis=0))
