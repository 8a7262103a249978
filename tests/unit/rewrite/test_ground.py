"""Half-open bounds become closed ones once the step is known, at every entry point."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

import rtamt
from rtamt.language.parsing.parser import parse_formula
from rtamt.rewrite.ground import ground, grounds

HALF = Fraction(1, 2)


@pytest.mark.parametrize(
    ("text", "closed"),
    [
        ("always(0:5] x", "always[500ms:5] x"),
        ("always[0:5) x", "always[0:4.5] x"),
        ("x until(1:3) y", "x until[1.5:2.5] y"),
        ("once[0:inf) x", "once[0:inf] x"),
        ("once(0:inf) x", "once[0.5:inf] x"),
        ("x unless(0:2) y", "x unless[0.5:1.5] y"),
        ("minimum(0:1](x) > 3", "minimum[0.5:1](x) > 3"),
    ],
)
def test_a_grounded_formula_equals_that_with_closed_bounds_and_prints_as_written(
    text: str, closed: str
) -> None:
    formula = parse_formula(text)
    grounded = ground(formula, HALF)
    assert grounded == parse_formula(closed)
    assert str(grounded) == str(formula) == text
    assert grounded.latex() == formula.latex()
    assert ground(grounded, HALF) is grounded


def test_what_has_nothing_to_ground_stays_the_same_object_and_sharing_is_kept() -> None:
    plain, other = parse_formula("always[0:5] x"), parse_formula("always(0:5] x")
    assert grounds((plain, plain), HALF)[0] is plain
    both = grounds((other, other), HALF)
    assert both[0] is both[1] is not other


# ---- entry points ----------------------------------------------------------------------------------

OPEN = "asked = once(0:2](x > 3); always(0:3](asked or eventually[1:3)(y > 3))"
CLOSED = "asked = once[1:2](x > 3); always[1:3](asked or eventually[1:2](y > 3))"


def in_ticks(tick: str, before: str) -> str:
    """Return the closed form in dense time; ``before``: one tick before 3 s."""
    return f"asked = once[{tick}:2s](x > 3); always[{tick}:3s](asked or eventually[1s:{before}](y > 3))"


TICKS = OPEN, in_ticks("1ms", "2999ms")
DATA = {"x": [1, 5, 2, 3, 4, 0, 1, 2, 7], "y": [1, 2, 6, 1, 0, 0, 5, 0, 0]}
DENSE = {name: (np.arange(9) * 0.75, values) for name, values in DATA.items()}
#: By time domain: a specification with half-open bounds, the same with closed ones, and data.
PAIRS = {
    "discrete": (rtamt.parse(OPEN), rtamt.parse(CLOSED), DATA),
    "dense": (
        *(rtamt.parse(text, time="dense", resolution="1ms") for text in TICKS),
        DENSE,
    ),
}


@pytest.fixture(params=PAIRS)
def pair(request):
    return PAIRS[request.param]


def points_of(verdict):
    """Return what update() gave, for a comparison."""
    return [*map(np.asarray, verdict)] if isinstance(verdict, rtamt.Signal) else verdict


def test_evaluation_sub_formulas_and_episodes(pair):
    half_open, closed, data = pair
    one, other = half_open.evaluate(data), closed.evaluate(data)
    np.testing.assert_array_equal(one.signal.values, other.signal.values)
    np.testing.assert_array_equal(one["asked"].values, other["asked"].values)
    values = one["historically(0:2] x"].values
    assert values[0] == np.inf
    assert values[1] == 1
    assert one.episodes() == other.episodes()
    assert one.satisfied == other.satisfied
    assert rtamt.first_violation(one) == rtamt.first_violation(other)
    bounds = [spec.evaluate(data, uncertainty={"x": 0.5}).interval for spec in (half_open, closed)]
    assert bounds[0] == bounds[1]


def test_explanation(pair):
    half_open, closed, data = pair
    one, other = half_open.evaluate(data).explain(), closed.evaluate(data).explain()
    assert one.critical == other.critical
    assert one.implicant == other.implicant
    assert "always(0:3](once(0:2](x > 3) or eventually[1:3)(y > 3))" in str(one)


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("verdict", ["delayed", "eager", "interval", "causation"])
def test_monitors_of_all_verdicts(pair, verdict, backend):
    half_open, closed, data = pair
    outcomes = []
    for spec in (half_open, closed):
        monitor = rtamt.parse(spec.text, time=spec.time, resolution=spec.resolution, backend=backend).monitor(
            verdict=verdict, watch=["asked"]
        )
        times = data["x"][0] if spec.domain.continuous else range(9)
        rows = zip(times, DATA["x"], DATA["y"], strict=True)
        outcomes.append([(repr(monitor.update(t, x=x, y=y)), repr(monitor["asked"])) for t, x, y in rows])
    assert outcomes[0] == outcomes[1]


def test_programs_horizon_and_pastified_form(pair):
    half_open, closed, _ = pair
    assert half_open.horizon == closed.horizon
    one, other = half_open.compile(), closed.compile()
    assert one.instructions == other.instructions
    assert one.metadata.formula == str(half_open)
    past = [spec.with_formula(spec.pastified()).compile().instructions for spec in (half_open, closed)]
    assert past[0] == past[1]


def test_checks_in_chunks_and_of_many(pair):
    half_open, closed, data = pair
    one, other = (rtamt.check_stream(spec, [data]) for spec in (half_open, closed))
    assert (one.robustness, one.first_violation, one.minimum) == (
        other.robustness,
        other.first_violation,
        other.minimum,
    )
    results = rtamt.evaluate_all([half_open, closed], data)
    assert results[0].robustness == results[1].robustness


def test_the_period_of_the_data_closes_the_bounds():
    spec = rtamt.parse("always(0:1s](x > 3)")
    slow = spec.evaluate({"time": [0, 1, 2], "x": [0, 5, 0]})
    fast = spec.evaluate({"time": [0, 0.5, 1], "x": [0, 5, 0]})
    assert (slow.robustness, fast.robustness) == (2, -3)


@pytest.mark.parametrize("dense", [False, True])
def test_rtamts_classes(dense):
    values = []
    for text in (OPEN, in_ticks("1ns", "2999999999ns") if dense else CLOSED):
        spec = rtamt.StlDenseTimeSpecification() if dense else rtamt.StlDiscreteTimeSpecification()
        for name in ("x", "y", "asked"):
            spec.declare_var(name, "float")
        spec.spec = text
        spec.parse()
        data = [[n, [[float(t), v] for t, v in zip(*s, strict=True)]] for n, s in DENSE.items()]
        values.append(spec.evaluate(*data) if dense else spec.evaluate({"time": list(range(9)), **DATA}))
    assert values[0] == values[1]
