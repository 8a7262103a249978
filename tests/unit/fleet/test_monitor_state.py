"""The states of monitors of a fleet. That restored ones continue: tests/laws/test_fleet_monitor_laws.py.

Forged ones: tests/fuzz/test_forged_states.py.
"""

from __future__ import annotations

import datetime as dt
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rtamt
from rtamt.fleet.collectors import COLLECTORS
from rtamt.fleet.monitor_state import REMEMBERED, MonitorStates

SPEC = rtamt.parse("always[0:2](x >= 3)")
PAIR = rtamt.parse("require A: once[0:2](x >= 3); require B: always[0:1](y >= 3)")
START = dt.datetime(2026, 11, 22)
SECONDS = [float(t) for t in range(6)]
DATES = [START + dt.timedelta(seconds=t) for t in range(6)]

#: Settings whose monitors remember more than numbers, and times in the form of the caller.
CASES: dict[str, tuple[rtamt.Specification, dict[str, Any], list[Any]]] = {
    "numbers of a unit": (SPEC, {"time_unit": "s"}, [0, 1, 2, 3, 4, 5]),
    "dates": (SPEC, {"verdict": "eager"}, list(np.array(DATES, "M8[ms]"))),
    "dates in dense time": (SPEC, {"time": "dense"}, DATES),
    "numbers of a unit in dense time": (SPEC, {"time": "dense", "time_unit": "s"}, [0, 1, 2, 3, 4, 5]),
    "durations": (SPEC, {"verdict": "interval", "lateness": 2}, list(np.arange(6).astype("m8[s]"))),
    "episodes": (SPEC, {"episodes": True}, SECONDS),
    "episodes in dense time": (SPEC, {"time": "dense", "episodes": True}, SECONDS),
    "evidence": (SPEC, {"verdict": "eager", "explain": True}, DATES),
    "evidence in dense time": (SPEC, {"time": "dense", "verdict": "eager", "explain": True}, SECONDS),
    "watched formulas": (SPEC, {"watch": ["x - 3"]}, SECONDS),
    "requirements with different variables": (PAIR, {"time": "dense"}, SECONDS),
    "requirements with different variables, eager": (PAIR, {"time": "dense", "verdict": "eager"}, SECONDS),
    "corrections": (
        SPEC, {"verdict": "interval", "lateness": 3, "on_correction": "replay"}, SECONDS
    ),
    "corrections in dense time": (
        SPEC, {"time": "dense", "verdict": "interval", "lateness": 3, "on_correction": "replay"}, SECONDS
    ),
}  # fmt: skip


def batch(spec: rtamt.Specification, times: list[Any], i: int) -> tuple[Any, Any, dict[str, Any]]:
    values = [float((7 * i) % 5), float((3 * i) % 7)]
    return ["a", "b"], [times[i], times[i]], dict.fromkeys(spec.input_names, values)


def taken(case: str, count: int) -> rtamt.Fleet:
    spec, made, times = CASES[case]
    fleet = rtamt.Fleet(spec, 5, **made)
    for i in range(count):
        fleet.update_many(*batch(spec, times, i))
    return fleet


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("count", [0, 1, 4])
def test_a_restored_fleet_continues(case: str, count: int) -> None:
    spec, made, times = CASES[case]
    fleet = taken(case, count)
    other = rtamt.Fleet.restore(spec, fleet.snapshot(), **made)
    assert (other.keys(), other.capacity, other.late) == (fleet.keys(), 5, 0)
    if made.get("on_correction") and count:
        correction = (["b"], [times[count - 1]], {"x": [9.0]})
        assert repr(other.update_many(*correction)) == repr(fleet.update_many(*correction))
    for i in range(count, 6):
        assert repr(other.update_many(*batch(spec, times, i))) == repr(
            fleet.update_many(*batch(spec, times, i))
        )
    monitors: list[Any] = [each.monitor("b") for each in (fleet, other)]
    if made.get("episodes"):
        assert repr(monitors[1].episodes()) == repr(monitors[0].episodes()) != "[]"
    ended = [monitor.finish() for monitor in monitors]
    assert repr(ended[0]) == repr(ended[1])
    assert other.expire(before=1e10) == 2


def test_evidence_is_part_of_a_state() -> None:
    fleet = rtamt.Fleet(SPEC, 5, verdict="eager", explain=True)
    fleet.update_many(["a", "a"], DATES[:2], {"x": [5, (6, 7)]})
    monitor: Any = rtamt.Fleet.restore(SPEC, fleet.snapshot(), verdict="eager", explain=True).monitor("a")
    (verdict,) = monitor.update(DATES[2], x=4)
    assert monitor.explain(verdict) == [
        rtamt.Cause("x", DATES[0], 5),
        rtamt.Cause("x", DATES[1], (6, 7)),
        rtamt.Cause("x", DATES[2], 4),
    ]


def test_a_value_that_has_no_format_is_named() -> None:
    spec = rtamt.parse("x >= 3")
    fleet = rtamt.Fleet(spec, 5, verdict="eager", explain=True)
    fleet.update_many([1], [0], {"x": np.array([2**70], object)})
    with pytest.raises(rtamt.UsageError) as caught:
        fleet.snapshot()
    assert str(caught.value) == "1180591620717411303424 (int) cannot be part of a snapshot"


def test_all_that_monitors_remember_is_listed() -> None:
    classes = list(COLLECTORS)
    for each in classes:
        classes += each.__subclasses__()
    names = {name for each in classes for name in getattr(each, "_remembered", ())}
    assert names == set(REMEMBERED)


def test_states_of_python_have_no_format() -> None:
    fleet = rtamt.Fleet(rtamt.parse("x >= 3", backend="python"), 3, verdict="eager")
    with pytest.raises(rtamt.UsageError) as caught:
        fleet.snapshot()
    assert str(caught.value) == (
        "the state of backend='python' has no portable format; take snapshots of fleets of backend='cpp'"
    )


def test_the_page_on_the_format_states_the_version_of_the_back_ends() -> None:
    page = Path(__file__).parents[3] / "docs" / "reference" / "fleet-state.md"
    (stated,) = re.findall(
        r"\| version of the back ends, (\d+): .*; (\d+) on machines", page.read_text("utf-8")
    )
    version = MonitorStates(SPEC.monitor(verdict="eager"), {}).version
    assert version in {int(stated[0]), int(stated[1])}
    assert int(stated[1]) == int(stated[0]) + 2**16
