"""A fleet of many requirements: the values of one fleet for each."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rtamt

TEXT = """
    input bool armed
    input float v [m/s]
    require SPEED: always[0:2](v <= 30)
    require BOTH: once[0:3](v >= 20) and eventually[0:1] armed
    require RATIO: v / v >= 1
"""
SPEC = rtamt.parse(TEXT, period="1s")


def batches(count: int = 6) -> Any:
    random = np.random.default_rng(4)
    times = dict.fromkeys(range(5), 0.0)
    for _ in range(count):
        keys = random.integers(0, 5, 9)
        stamps = []
        for key in keys.tolist():
            stamps.append(times[key])
            times[key] += 1.0
        yield keys, np.array(stamps), {"v": random.uniform(1, 40, 9), "armed": random.random(9) < 0.5}


@pytest.mark.parametrize("select", [["robustness"], ["satisfied"], ["robustness", "satisfied"]])
def test_each_column_is_that_of_a_fleet_of_the_requirement(select: list[str]) -> None:
    suite = rtamt.Suite(SPEC, select=select)
    fleet = rtamt.Fleet(suite, 10)
    semantics = "standard" if "robustness" in select else "boolean"
    alone = {name: rtamt.Fleet(SPEC.select(name), 10, semantics=semantics) for name in fleet.requirements}
    assert list(alone) == ["SPEED", "BOTH", "RATIO"]
    for keys, times, columns in batches():
        update = fleet.update_many(keys, times, columns)
        assert update.values.shape == (9, 3)
        for name, single in alone.items():
            expected = single.update_many(keys, times, {n: columns[n] for n in SPEC.select(name).input_names})
            found = update[name]
            assert found.known.tolist() == expected.known.tolist()
            assert found.values.tolist() == expected.values.tolist()
            assert np.array_equal(found.times, expected.times, equal_nan=True)
        fleet = rtamt.Fleet.restore(suite, fleet.snapshot())


def test_what_waits_is_released_by_requirement() -> None:
    fleet = rtamt.Fleet(rtamt.Suite(SPEC), 10, lateness="5s")
    fleet.update_many([1, 1, 1], [2, 0, 1], {"v": [10, 40, 20], "armed": [True, False, True]})
    update = fleet.watermark(2)
    assert update.values.shape == (0, 3)
    assert update["SPEED"].released.times.tolist() == [0.0]
    assert update["SPEED"].released.values.tolist() == [-10.0]
    assert update["RATIO"].released.times.tolist() == [0.0, 1.0, 2.0]
    assert update.released.requirements.tolist() == [0, 1, 1, 2, 2, 2]


def test_an_undefined_value_changes_no_requirement() -> None:
    fleet = rtamt.Fleet(rtamt.Suite(SPEC), 10)
    before = fleet.snapshot()
    with pytest.raises(rtamt.EvaluationError, match=r"key 2 at index 1 of the batch: 'v / v' has no value"):
        fleet.update_many([1, 2], [0, 0], {"v": [1, 0], "armed": [True, True]})
    assert fleet.snapshot() == before


def test_a_state_goes_from_a_specification_to_a_suite() -> None:
    single = rtamt.Fleet(SPEC.select("SPEED"), 10)
    single.update_many([1, 1], [0, 1], {"v": [10, 40]})
    fleet = rtamt.Fleet.restore(rtamt.Suite(SPEC), single.snapshot())
    update = fleet.update_many([1], [2], {"v": [5], "armed": [True]})
    assert update["SPEED"].values.tolist() == [-10.0]
    assert update["BOTH"].warming.tolist() == [True]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: rtamt.Fleet(rtamt.Suite.from_bytes(rtamt.Suite(SPEC).to_bytes()), 3),
            "a suite that was read from bytes has no formulas to monitor; make the fleet of Suite(specs)",
        ),
        (
            lambda: rtamt.Fleet(
                rtamt.Suite([rtamt.parse("x > 3", period=1), rtamt.parse("y > 3", period=2)]), 3
            ),
            "the requirements of a fleet share the time domain, the sampling period, ",
        ),
        (
            lambda: rtamt.Fleet(rtamt.Suite(SPEC), 3, period=2),
            "period= is a setting of the suite: write Suite(specs, period=...)",
        ),
        (
            lambda: rtamt.Fleet(rtamt.Suite(SPEC, time_unit="s"), 3),
            "a fleet of a suite has delayed verdicts in discrete time without custom operators and time_unit=, or "
            "dense time, or another verdict mode; make a fleet of each specification",
        ),
        (
            lambda: rtamt.Fleet(rtamt.Suite(SPEC), 3).update_many([], [], {"v": [], "armed": []})["SPED"],
            "the fleet has no requirement 'SPED'; did you mean 'SPEED'? (requirements: SPEED, BOTH, RATIO)",
        ),
    ],
)
def test_wrong_use_is_rejected_with_a_sentence(make: Any, message: str) -> None:
    with pytest.raises(rtamt.UsageError) as caught:
        make()
    assert str(caught.value).startswith(message)
