"""Fleets of suites with a monitor for each requirement; the reports: tests/laws/test_fleet_monitor_laws.py."""

from __future__ import annotations

from typing import Any

import pytest

import rtamt

TEXT = "require LOW: always[0:1](x <= 9); require HIGH: y >= 3"
SPECS = rtamt.parse(TEXT)
DENSE = rtamt.Suite(rtamt.parse(TEXT, time="dense"))
SUITE = rtamt.Suite(SPECS)


def filled(suite: rtamt.Suite = SUITE, **settings: Any) -> rtamt.Fleet[Any]:
    fleet: rtamt.Fleet[Any] = rtamt.Fleet(suite, 3, **settings)
    fleet.update_many(["a", "b"], [0, 5], {"x": [4, 12], "y": [1, 5]})
    return fleet


def test_each_requirement_has_its_own_update() -> None:
    fleet: rtamt.Fleet[Any] = rtamt.Fleet(SUITE, 3, verdict="eager")
    update = fleet.update_many(["a", "b"], [0, 5], {"x": [4, 12], "y": [1, 5]})
    assert update.requirements == fleet.requirements == ("LOW", "HIGH")
    assert update["LOW"].keys.tolist() == ["b"]
    assert update["HIGH"].satisfied.tolist() == [False, True]
    with pytest.raises(
        rtamt.UsageError, match=r"^the fleet has no requirement 'HIHG'; did you mean 'HIGH'\?"
    ):
        update["HIHG"]


def test_in_dense_time_a_batch_may_lack_the_variables_of_a_requirement() -> None:
    fleet = filled(DENSE)
    update = fleet.update_many(["a"], [2.5], {"x": [11]})
    assert update["LOW"].times.tolist() == [0.0, 1.5]
    assert update["LOW"].values.tolist() == [5.0, -2.0]
    assert len(update["HIGH"]) == 0


def test_recorded_names_are_those_of_each_requirement() -> None:
    text = 'input float v = "speed"; require LOW: v <= 9; require HIGH: always(v >= 3)'
    fleet = rtamt.Fleet(rtamt.Suite(rtamt.parse(text)), 3, verdict="causation")
    update: Any = fleet.update_many([1], [0], {"speed": [4.0]})
    assert [update[name].violation.tolist() for name in update.requirements] == [[5.0], [1.0]]


def test_a_suite_that_does_not_select_the_robustness_has_verdicts() -> None:
    suite = rtamt.Suite(rtamt.parse("x > 3", time="dense"), select=["satisfied"])
    fleet: rtamt.Fleet[Any] = rtamt.Fleet(suite, 3)
    assert fleet.update_many([1], [0], {"x": [3]})["x > 3"].values.tolist() == [-float("inf")]


def test_late_samples_are_counted_once() -> None:
    fleet = rtamt.Fleet(SUITE, 3, verdict="interval", lateness=1)
    columns = {"x": [1, 1, 1], "y": [1, 1, 1]}
    fleet.update_many([7, 7, 7], [0, 5, 1], columns)
    assert fleet.late == 1
    assert rtamt.Fleet.restore(SUITE, fleet.snapshot(), verdict="interval", lateness=1).late == 1
    assert len(fleet.watermark(9)["LOW"]) == len(fleet.advance(9)["HIGH"]) == 1


def test_keys_come_and_go() -> None:
    fleet = filled(DENSE)
    assert (len(fleet), fleet.capacity, fleet.waiting, fleet.memory > 0) == (2, 3, 0, True)
    assert "a" in fleet
    assert fleet.expire(before=5.0) == 1
    assert fleet.keys() == ["b"]
    fleet.drop(["b"])
    assert len(fleet) == 0
    assert fleet.update_many(["b"], [0.0], {"x": [4.0], "y": [4.0]})["HIGH"].values.tolist() == [1.0]


def test_the_monitor_of_a_requirement_can_be_read() -> None:
    fleet = filled(verdict="interval")
    monitor: Any = fleet.monitor("a", requirement="HIGH")
    assert monitor.interval(0) == rtamt.Interval(-2.0, -2.0)


def test_a_batch_that_fails_changes_no_requirement() -> None:
    fleet, other = filled(verdict="eager"), filled(verdict="eager")
    with pytest.raises(rtamt.TraceError) as caught:
        fleet.update_many(["a", "a"], [1, 2], {"x": [1, 1], "y": [1, float("nan")]})
    assert str(caught.value) == (
        "requirement 'HIGH': key 'a' at index 1 of the batch: 'y' is NaN at sample 2, time 2 s: fill the gap or leave "
        "the sample out"
    )
    assert caught.value.index == 1
    batch: Any = (["a", "a"], [1, 2], {"x": [1, 1], "y": [1, 2]})
    assert repr(fleet.update_many(*batch)) == repr(other.update_many(*batch))


@pytest.mark.parametrize(
    ("action", "message"),
    [
        (
            lambda: filled(DENSE).update_many(["a"], [7], {"x": [1], "z": [1]}),
            "the formula has no variable 'z'; variables: x, y",
        ),
        (
            lambda: filled(DENSE).monitor("a"),
            "the fleet has a monitor for each requirement: name one of LOW, HIGH, such as monitor(key, "
            "requirement='LOW')",
        ),
        (
            lambda: filled(DENSE).monitor("a", requirement="LO"),
            "the fleet has no requirement 'LO'; did you mean 'LOW'? (requirements: LOW, HIGH)",
        ),
        (
            lambda: rtamt.Fleet(SPECS, 3, time="dense").monitor("a", requirement="LOW"),
            "the fleet is of one specification, and not of the requirements of a suite",
        ),
        (
            lambda: rtamt.Fleet(SUITE, 3, verdict="eager", period=2),
            "period= is a setting of the suite: write Suite(specs, period=...)",
        ),
        (
            lambda: rtamt.Fleet(DENSE, 3, gaps="hold"),
            "gaps='hold' needs delayed verdicts in discrete time, and this fleet has a monitor for each key (delayed "
            "verdicts in dense time): leave gaps= out",
        ),
        (
            lambda: rtamt.Fleet(
                rtamt.Suite([rtamt.parse("x > 1"), rtamt.parse("x > 2", period=2)]), 3, verdict="eager"
            ),
            "the requirements of a fleet share the time domain, the sampling period, and the names, units and types of "
            "their variables, without a sampling rule, quantifiers or operators of your own; make a fleet for each "
            "that differs",
        ),
        (
            lambda: rtamt.Fleet(
                rtamt.Suite.from_bytes(rtamt.Suite(SPECS, period=1).to_bytes()), 3, verdict="eager"
            ),
            "a suite that was read from bytes has no formulas to monitor; make the fleet of Suite(specs)",
        ),
        (
            lambda: rtamt.Fleet.restore(
                rtamt.Suite(rtamt.parse("require HIHG: y >= 3", time="dense")), filled(DENSE).snapshot()
            ),
            "the state has no requirement 'HIHG'; did you mean 'HIGH'? (requirements: HIGH, LOW); where keys have "
            "monitors, a state continues with the same requirements",
        ),
    ],
)
def test_wrong_use_is_rejected_with_a_sentence(action: Any, message: str) -> None:
    with pytest.raises((rtamt.UsageError, rtamt.TraceError)) as caught:
        action()
    assert str(caught.value) == message


def test_requirements_may_be_left_out_of_a_state() -> None:
    state = filled(DENSE).snapshot()
    fleet: Any = rtamt.Fleet.restore(rtamt.Suite(rtamt.parse("require HIGH: y >= 3", time="dense")), state)
    assert fleet.update_many(["a"], [1.0], {"y": [7]})["HIGH"].values.tolist() == [4.0]
