"""Programs of fleets for the C API: what they run, which snapshots they read, and what is for Python alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rtamt
from tests.support.c_api import REFUSED, UNDEFINED, RefusedError
from tests.support.c_fleet import CFleet, RejectedError

SPEC = rtamt.parse("always[0:2](speed <= 30)", period="1s")
EARLY: dict[str, dict[str, Any]] = {
    "dense": {"time": "dense"},
    "eager": {"verdict": "eager"},
    "interval": {"verdict": "interval", "lateness": 2},
    "causation": {"verdict": "causation", "time": "dense"},
}


def test_records_have_an_output_for_each_requirement() -> None:
    suite = rtamt.Suite(
        rtamt.parse("require FAST: speed <= 30; require SLOW: once[0:1](speed >= 5)", period="1s")
    )
    fleet = rtamt.Fleet(suite, 9)
    in_c = CFleet(fleet.compile(), 9)
    assert (in_c.inputs, in_c.outputs) == (["speed"], ["robustness.FAST", "robustness.SLOW"])
    assert (in_c.mode, in_c.dense) == ("delayed", False)
    batch = [7, 8, 7], [0, 0, 1], {"speed": [20, 3, 40]}
    assert [list(row) for row in in_c.update(*batch).values] == fleet.update_many(*batch).values.tolist()
    assert CFleet(fleet.compile(), 0, state=fleet.snapshot()).keys() == [7, 8]


@pytest.mark.parametrize(
    ("made", "moment"), [({}, "sample 0, time 0 s"), *((each, "0 s") for each in EARLY.values())]
)
def test_an_operation_without_a_value_is_named_as_it_is_written(made: dict[str, Any], moment: str) -> None:
    in_c = CFleet(rtamt.Fleet(rtamt.parse("sqrt(speed) <= 3", period="1s"), 9, **made).compile(), 9)
    with pytest.raises(RejectedError) as rejected:
        in_c.update([7], [0], {"speed": [-1]})
    assert rejected.value.args == (
        UNDEFINED,
        f"Key 7 at index 0 of the batch has no value of 'sqrt(speed)' at {moment}: it is 0/0, inf - inf, 0 * inf, or "
        f"a function outside its domain.",
        0,
    )
    assert len(in_c) == 0


@pytest.mark.parametrize("mode", EARLY)
def test_a_state_continues_with_the_same_requirement_and_settings_alone(mode: str) -> None:
    made = EARLY[mode]
    fleet = rtamt.Fleet(SPEC, 9, **made)
    fleet.update_many(["a", "b"], [0, 0], {"speed": [20, 40]})
    other = rtamt.Fleet(rtamt.parse("always[0:3](speed <= 30)", period="1s"), 9, **made)
    with pytest.raises(RefusedError) as refused:
        CFleet(other.compile(), 9, state=fleet.snapshot())
    assert refused.value.args == (
        REFUSED,
        "This state is of a fleet with another requirement or other settings: a fleet with a monitor for each key "
        "continues with the same ones.",
    )
    with pytest.raises(RefusedError) as refused:
        CFleet(fleet.compile(), 1, state=fleet.snapshot())
    assert refused.value.args[1] == "This state has 2 keys, more than the capacity of 1."


def test_a_state_with_other_times_than_seconds_is_for_python() -> None:
    fleet = rtamt.Fleet(SPEC, 9, verdict="eager")
    fleet.update_many([7], np.array(["2026-01-01"], "M8[s]"), {"speed": [20]})
    with pytest.raises(RefusedError) as refused:
        CFleet(fleet.compile(), 9, state=fleet.snapshot())
    assert refused.value.args[1] == (
        "This state has what only fleets of Python remember, such as times that are not seconds: restore it with "
        "Fleet.restore."
    )


def test_booleans_and_ranges_are_checked() -> None:
    spec = rtamt.parse(
        "input bool on; input float speed in [0, 50]; always[0:2](speed <= 30 or on)", period="1s"
    )
    for made in EARLY.values():
        in_c = CFleet(rtamt.Fleet(spec, 9, **made).compile(), 9)
        columns = {"on": [2.0], "speed": [20.0]}
        with pytest.raises(RejectedError, match="has 2 as 'on' at 0 s, which is Boolean: give 0 or 1"):
            in_c.update([7], [0], columns)


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_first_samples_that_are_too_late_are_left_out(time: str) -> None:
    spec = rtamt.parse("once[0:2](x >= 3)", time=time, period="1s")
    fleet = rtamt.Fleet(spec, 5, verdict="interval", lateness=3)
    in_c = CFleet(fleet.compile(), 5)
    batch = [7] * 5, [10, 6, 7, 6, 8], {"x": [1.0, 9.0, 2.0, 9.0, 4.0]}
    update, report = fleet.update_many(*batch), in_c.update(*batch)
    assert update.late.tolist() == report.late == [False, True, False, True, False]
    assert [list(row) for row in zip(update.lower, update.upper, strict=True)] == [
        list(row) for row in report.values
    ]
    assert fleet.late == in_c.late == 2
    # The watermark counts before the trace starts, too.
    for each in (fleet.update_many, in_c.update):
        each([8], [20], {"x": [1.0]})
    assert fleet.watermark(18) is not None
    assert in_c.watermark(18) is not None
    batch = [8, 8], [18, 19], {"x": [4.0, 5.0]}
    assert fleet.update_many(*batch).late.tolist() == in_c.update(*batch).late == [True, False]


PYTHON_ALONE: dict[str, tuple[dict[str, Any], str]] = {
    "unit": (
        {"verdict": "eager", "time_unit": "ms"},
        "fleets of the C API have no time_unit=; leave it out",
    ),
    "episodes": (
        {"time": "dense", "episodes": True},
        "fleets of the C API have no episodes=; leave it out",
    ),
    "explain": (
        {"verdict": "eager", "explain": True},
        "fleets of the C API have no explain=; leave it out",
    ),
    "replay": (
        {"verdict": "interval", "lateness": 2, "on_correction": "replay"},
        "fleets of the C API have no on_correction='replay'; leave it out",
    ),
    "watch": (
        {"verdict": "eager", "watch": ["speed <= 30"]},
        "fleets of the C API have no watch=; leave it out",
    ),
    "tick": (
        {"time": "dense", "resolution": "2/3s"},
        "the C API counts dense time in ticks of which a whole number are one second, and resolution is 2/3 s; choose "
        "another one, such as resolution='1ms'",
    ),
}


@pytest.mark.parametrize("case", PYTHON_ALONE)
def test_what_is_for_python_alone_is_an_error(case: str) -> None:
    made, sentence = PYTHON_ALONE[case]
    with pytest.raises(rtamt.UsageError) as raised:
        rtamt.Fleet(SPEC, 9, **made).compile()
    assert str(raised.value) == sentence


def test_a_back_end_in_python_is_for_python_alone() -> None:
    spec = rtamt.parse("always[0:2](speed <= 30)", period="1s", backend="python")
    with pytest.raises(rtamt.UsageError) as raised:
        rtamt.Fleet(spec, 9, verdict="eager").compile()
    assert str(raised.value) == (
        "fleets of the C API have backend='cpp', no custom operators, and in dense time with delayed verdicts "
        "requirements over the same variables; make a fleet of each requirement"
    )


def test_requirements_with_monitors_are_compiled_one_by_one() -> None:
    suite = rtamt.Suite(rtamt.parse("require FAST: speed <= 30; require ON: brake >= 1", period="1s"))
    with pytest.raises(rtamt.UsageError) as raised:
        rtamt.Fleet(suite, 9, verdict="eager").compile()
    assert str(raised.value) == (
        "fleets of the C API that have a monitor for each key have one requirement; compile a fleet of each"
    )
