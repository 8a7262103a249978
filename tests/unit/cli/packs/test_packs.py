"""What is in the packs: every requirement is satisfied by one made trace and violated by another."""

from math import inf

import pytest

import rtamt
from rtamt.specification_loader import packs
from tests.unit.cli.packs.traces import DRIVING, PACKS, PX4, after, made

EACH = [(pack, requirement) for pack, (_, violated) in PACKS.items() for requirement in violated]


@pytest.fixture(scope="module")
def specs():
    return {name: rtamt.pack(name) for name in packs()}


def test_every_requirement_of_every_pack_has_its_traces(specs):
    assert {name: list(spec.requirements) for name, spec in specs.items()} == {
        name: list(PACKS[name][1]) for name in specs
    }


def test_packs_have_no_warnings_and_every_requirement_and_limit_is_described(specs):
    for spec in specs.values():
        assert spec.warnings == ()
        assert all(known.description for known in spec.document.requirements)
        limits = [line for line in spec.text.splitlines() if line.startswith("parameter")]
        assert limits
        assert all("// [" in line for line in limits), "a limit states its source"


@pytest.mark.parametrize("pack", PACKS)
def test_a_good_trace_satisfies_a_pack(specs, pack):
    spec = specs[pack]
    data = made(PACKS[pack][0])
    assert spec.unchecked(data) == {}
    found = {name: one.evaluate(data) for name, one in spec.requirements.items()}
    assert {name: result.robustness for name, result in found.items() if not result.satisfied} == {}


@pytest.mark.parametrize(("pack", "requirement"), EACH)
def test_a_bad_trace_violates_a_requirement_of_a_pack(specs, pack, requirement):
    good, violated = PACKS[pack]
    result = specs[pack].requirements[requirement].evaluate(made(good, **violated[requirement]))
    assert result.satisfied is False


def test_rc_that_was_lost_before_the_recording_is_no_loss(specs):
    """It was reported as a loss at the first sample."""
    data = made(PACKS["px4"][0], **{"failsafe_flags.manual_control_signal_lost": 1})
    assert specs["px4"].requirements["RC-1"].evaluate(data).satisfied is True


def test_rc_that_was_lost_before_arming_is_a_loss(specs):
    """It was satisfied though the vehicle never was in failsafe."""
    changed = {
        "failsafe_flags.manual_control_signal_lost": after(1, 1),
        "vehicle_status.arming_state": after(2, 2, 1),
    }
    rc = specs["px4"].requirements["RC-1"]
    assert rc.evaluate(made(PX4, **changed)).satisfied is False
    assert rc.evaluate(made(PX4, **changed, **{"vehicle_status.failsafe": after(6, 1)})).satisfied is True
    assert (
        rc.evaluate(made(PX4, **changed, **{"vehicle_status.failsafe": after(6, 1, 0, 8)})).satisfied is False
    )


@pytest.mark.parametrize(
    ("changed", "visible"),
    [
        ({"battery_status.cell_count": 0, "battery_status.voltage_v": 9}, "BAT-4"),
        ({"battery_status.voltage_v": 0}, "BAT-4"),
        ({"battery_status.remaining": -1}, "BAT-5"),
    ],
)
def test_unknown_values_of_the_battery_violate_only_the_requirement_that_they_are_known(
    specs, changed, visible
):
    """Unknown remaining capacity and voltage were violations; 9 V of an unknown number of cells passed silently."""
    data = made(PX4, **changed)
    battery = {name: one for name, one in specs["px4"].requirements.items() if name.startswith("BAT")}
    assert [name for name, one in battery.items() if not one.evaluate(data).satisfied] == [visible]


def test_a_vehicle_that_cuts_in_may_be_near_for_a_while(specs):
    rule = specs["driving"].requirements["R_G1"]
    assert rule.evaluate(made(DRIVING, lead_gap=after(5, 4, inf, 7.9))).satisfied is True
    assert rule.evaluate(made(DRIVING, lead_gap=after(5, 4, inf, 8.5))).satisfied is False


def test_no_vehicle_ahead_is_no_reason_to_be_slow(specs):
    rule = specs["driving"].requirements["R_G4"]
    slow = {"ego_speed": 5, "lead_speed": 0}
    assert rule.evaluate(made(DRIVING, **slow)).satisfied is True
    assert rule.evaluate(made(DRIVING, **slow, lead_gap=inf)).satisfied is False


def test_a_gps_topic_that_stops_does_not_pass(specs):
    """Its last position was held to the end of the flight, and no requirement was violated."""
    data = made(PX4)
    for name in [name for name in data if name.startswith("vehicle_gps_position")]:
        data[name] = tuple(column[:31] for column in data[name])
    gps = {name: one for name, one in specs["px4"].requirements.items() if name.startswith("GPS")}
    assert [name for name, one in gps.items() if not one.evaluate(data).satisfied] == ["GPS-4"]
