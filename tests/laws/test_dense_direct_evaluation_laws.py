"""Dense recordings that one call reads and evaluates give what the general way gives, to the bit, or the same error."""

from __future__ import annotations

import pickle
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from tests.laws.test_recording_laws import bits, columns, outcome
from tests.support.strategies import formulas

FORMULAS = [
    "x + y >= 0",
    "always[0:3](x + y >= 0)",
    "always(x >= 0)",
    "eventually[0.5:inf](x >= y) and once(y > 1)",
    "always(x >= 0 -> (y >= 0 until x <= 1))",
    "sqrt(x) >= y",
    "historically[0:1](x >= y) or eventually[0:2](y > 0)",
]


@st.composite
def times(draw: st.DrawFn, n: int) -> Any:
    """Draw n times, nearly always seconds that increase."""
    gaps = draw(st.lists(st.sampled_from([0.5, 1.0, 0.1, 1e-9, 0.25]), min_size=n, max_size=n))
    found = draw(st.sampled_from([0.0, 0.0, -3.0, 1.7e9, 2e6])) + np.cumsum(gaps)
    odd = draw(st.integers(0, 29))
    if n and odd == 0:
        found[draw(st.integers(0, n - 1))] = draw(st.sampled_from([np.nan, np.inf, 1e12, 0.0]))
    if n and odd == 1 and np.isfinite(found).all():
        found = found.astype(draw(st.sampled_from(["i8", "f4", "m8[s]"])))
    if odd == 2:
        found = np.repeat(found, 2)[::2]
    return found.tolist() if draw(st.booleans()) else found


@st.composite
def recordings(draw: st.DrawFn) -> dict[str, Any]:
    """Draw signals with times of their own, or common ones."""
    n, m = draw(st.integers(1, 8)), draw(st.integers(1, 8))
    odd = draw(st.integers(0, 4)) == 0
    form = draw(st.sampled_from(["own", "own", "shared", "pairs"]))
    if form == "shared":
        return {"time": draw(times(n)), "x": draw(columns(n, odd=odd)), "y": draw(columns(n, odd=odd))}
    if form == "pairs":
        xs = list(zip(draw(times(n)), draw(columns(n, odd=False)), strict=True))
        return {"x": xs, "y": (draw(times(m)), draw(columns(m, odd=odd)))}
    shorter = m if draw(st.integers(0, 19)) else m - 1
    data = {
        "x": (draw(times(n)), draw(columns(n, odd=odd))),
        "y": (draw(times(m)), draw(columns(shorter, odd=odd))),
    }
    if draw(st.integers(0, 19)) == 0:
        del data["x"]
    return data


def facts(result: rtamt.Result) -> tuple[Any, ...]:
    """Return all that a result is made of."""
    trace: Any = result.trace
    lower, upper = result.intervals.lower, result.intervals.upper
    return (
        *(bits(values) for values in (lower, upper, result.signal.times)),
        result.signal.times.flags.writeable,
        {name: (bits(ticks), bits(values)) for name, (ticks, values) in trace.columns.items()},
        (trace.scale, trace.start, trace.end, dict(trace.units)),
        (result.robustness, outcome(lambda: result.satisfied), repr(result), result.semantics),
    )


@settings(max_examples=300)
@given(
    st.sampled_from(FORMULAS) | formulas(unbounded_future=True).map(str),
    st.lists(recordings(), min_size=2, max_size=5),
    st.sampled_from(["1ns", "1us", "100ms"]),
)
def test_a_specification_evaluates_one_recording_after_another_as_a_new_one(
    text: str, data: list[dict[str, Any]], resolution: str
) -> None:
    def evaluated(spec: rtamt.Specification, one: Any) -> Any:
        return outcome(lambda: facts(spec.evaluate(one)))

    spec = outcome(lambda: rtamt.parse(text, time="dense", resolution=resolution))
    assume(not isinstance(spec, str))
    for one in data:
        alone = rtamt.parse(text, time="dense", resolution=resolution)
        assert evaluated(spec, one) == evaluated(alone, MappingProxyType(one))


@settings(max_examples=300)
@given(st.sampled_from(FORMULAS) | formulas(unbounded_future=True).map(str), recordings())
def test_a_requirement_is_satisfied_if_it_is_never_violated(text: str, data: dict[str, Any]) -> None:
    result = outcome(lambda: rtamt.parse(text, time="dense").evaluate(data))
    assume(not isinstance(result, str) and not result.trace.bounds)
    assert outcome(lambda: result.satisfied) == outcome(lambda: rtamt.first_violation(result) is None)


def evaluate_twice(text: str, data: dict[str, Any]) -> rtamt.Result:
    """Return the result of the second evaluation, which is direct."""
    spec = rtamt.parse(text, time="dense")
    spec.evaluate(data)
    assert spec.__dict__["_direct"][0](data) is not None
    return spec.evaluate(data)


@pytest.mark.parametrize("text", FORMULAS)
@pytest.mark.parametrize("n", [3, 100, 70_000])
@pytest.mark.parametrize("shared", [False, True])
def test_plain_recordings_are_evaluated_directly(text: str, n: int, shared: bool) -> None:
    x, y = np.linspace(0, 2, n), np.linspace(1, 0, n)
    seconds = 3.0 + np.arange(n) * 0.1
    data: dict[str, Any] = {"time": seconds, "x": x, "y": y}
    if not shared:
        data = {"x": (seconds, x), "y": ((seconds - 0.05).tolist(), y.tolist())}
    assert facts(evaluate_twice(text, data)) == facts(rtamt.parse(text, time="dense").evaluate(data))


def test_a_result_keeps_its_values_when_the_data_change() -> None:
    data = {"x": (np.arange(5.0), np.arange(5.0))}
    result = evaluate_twice("always[0:2](x >= 1)", data)
    data["x"][0][:] = -1.0
    data["x"][1][:] = -9.0
    result.signal.values[:] = 7.0
    assert result["x"].values.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert result.satisfied is False


def test_a_result_that_is_found_directly_is_pickled() -> None:
    result = evaluate_twice(FORMULAS[2], {"x": (np.arange(4) * 0.25, np.arange(4.0))})
    assert facts(pickle.loads(pickle.dumps(result))) == facts(result)


def test_a_result_is_the_same_after_a_recording_without_a_value() -> None:
    spec = rtamt.parse("always(sqrt(x) >= 1)", time="dense")
    good, bad = {"x": ([0.0, 1.0], [4.0, 9.0])}, {"x": ([0.0, 1.0, 2.0], [4.0, 9.0, -1.0])}
    expected = facts(spec.evaluate(good))
    for _ in range(2):
        assert "sqrt" in outcome(lambda: spec.evaluate(bad))
        assert facts(spec.evaluate(good)) == expected
