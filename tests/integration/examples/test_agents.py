"""The CommonRoad rules R_G1 to R_G4 over made traces: for each rule one that keeps it and some that break it."""

from __future__ import annotations

from pathlib import Path

import pytest

import rtamt

SPEC = rtamt.load(Path(__file__).parents[3] / "examples" / "agents" / "commonroad.stl")
N = 60

#: A quiet drive: 30 m/s with a limit of 36 m/s, a vehicle 60 m ahead in the same lane.
QUIET = {
    "time": [i / 10 for i in range(N)],
    "ego.front": [3.0 * i for i in range(N)],
    "ego.v": [30.0] * N,
    "ego.a": [0.0] * N,
    "limit": [36.0] * N,
    "sight_limit": [50.0] * N,
}


def vehicle(name: str, gap: float, *, v=30.0, a=0.0, in_lane=True, since=0, until=N, changes=None):
    """Return the columns of a vehicle that keeps its gap; it comes into the lane of the ego vehicle at ``changes``."""

    def column(value):
        return [value(i) if since <= i < until else None for i in range(N)]

    return {
        f"vehicle_{name}.rear": column(lambda i: 3.0 * i + gap),
        f"vehicle_{name}.v": column(lambda _: v),
        f"vehicle_{name}.a": column(lambda _: a),
        f"vehicle_{name}.in_lane": column(lambda i: in_lane and (changes is None or i >= changes)),
    }


BRAKES = {"ego.a": [0.0] * 20 + [-5.0] * 5 + [0.0] * (N - 25)}

CASES = [
    # 30 * 0.4 = 12 m is safe at equal speeds.
    ("quiet", {**vehicle("a", 60)}, {}),
    ("too close", {**vehicle("a", 60), **vehicle("b", 10, since=30)}, {"R_G1": -2}),
    ("close, but slower ahead", {**vehicle("a", 60, v=20)}, {}),
    ("too close to a slower one", {**vehicle("a", 40, v=20)}, {"R_G1": 40 - 500 / 16 - 12}),
    ("close in another lane", {**vehicle("a", 60), **vehicle("b", 10, in_lane=False)}, {}),
    ("close behind", {**vehicle("a", 60), **vehicle("b", -20)}, {}),
    ("cuts in and stays close for 2 s", {**vehicle("a", 60), **vehicle("b", 10, changes=20, until=40)}, {}),
    (
        "cuts in and stays close for 4 s",
        {**vehicle("a", 60), **vehicle("b", 10, changes=10, until=50)},
        {"R_G1": -2},
    ),
    ("brakes for nothing", {**vehicle("a", 60), **BRAKES}, {"R_G2": -3}),
    ("brakes with the vehicle ahead", {**vehicle("a", 60, a=-4), **BRAKES}, {}),
    (
        "brakes for one that is too close",
        {**vehicle("b", 10, changes=18, until=40), **vehicle("a", 60), **BRAKES},
        {},
    ),
    ("too fast", {**vehicle("a", 60), "limit": [28.0] * N}, {"R_G3": -2}),
    ("too fast for the fog", {**vehicle("a", 60), "sight_limit": [29.0] * N}, {"R_G3": -1}),
    ("too slow", {**vehicle("a", 60, v=45), "limit": [50.0] * N}, {"R_G4": -10}),
    ("slow behind a slow one", {**vehicle("a", 60, v=28), "limit": [50.0] * N}, {}),
]


@pytest.mark.parametrize(("name", "change", "broken"), CASES, ids=[case[0] for case in CASES])
def test_the_general_rules_on_traces_made_for_them(name, change, broken):
    results = SPEC.evaluate({**QUIET, **change}).requirements
    violated = {rule for rule, result in results.items() if not result.satisfied}
    assert violated == set(broken), name
    for rule, least in broken.items():
        assert results[rule].robustness <= min(least, 0) + 1e-9


def test_the_rules_name_the_vehicle_that_is_too_close():
    result = SPEC.evaluate({**QUIET, **vehicle("a", 60), **vehicle("b", 10, since=30)})
    explanation = str(result.requirements["R_G1"].explain())
    assert "vehicle_b" in explanation
    assert result.requirements["R_G1"].robustness == pytest.approx(-2)


def test_the_spec_has_no_warnings():
    assert SPEC.warnings == ()
