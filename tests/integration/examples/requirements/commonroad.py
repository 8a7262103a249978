"""Made traces for the traffic rules of CommonRoad."""

from __future__ import annotations

from typing import Any

from tests.integration.examples.requirements.traces import Columns, Traces, step


def _vehicle(number: int, **fields: Any) -> Columns:
    return {f"vehicle_{number}.{name}": value for name, value in fields.items()}


_JAM = {"congestion": 1, "speed": 0, "lead_gap": 2, "lead_speed": 0}
INTERSTATE = Traces(
    100,
    dict.fromkeys(("on_access_ramp", "congestion", "leftmost_lane", "lateral_offset"), 0)
    | {
        "on_carriageway": 1,
        "rightmost_lane": 1,
        "speed": 25,
        "heading_error": 1,
        "lead_gap": 60,
        "lead_speed": 25,
    }
    | _vehicle(1, speed=30, on_left=1, entering=0)
    | _vehicle(2, speed=15, on_left=0, entering=0),
    {
        "R_I1": (_JAM, {"speed": step(20, 0, 25, 60)}),
        "R_I2": (
            {"speed": 20} | _vehicle(2, speed=15, on_left=1, entering=0),
            _vehicle(2, speed=20, on_left=1, entering=0),
        ),
        "R_I3": ({"heading_error": -20}, {"heading_error": step(50, 120)}),
        "R_I4": (
            _JAM | {"lateral_offset": step(40, -0.5)},
            _JAM | {"leftmost_lane": 1, "lateral_offset": 0.1},
        ),
        "R_I5": (
            {"rightmost_lane": step(50, 1), "vehicle_2.entering": step(60, 1)},
            {"rightmost_lane": step(50, 1), "vehicle_2.entering": 1},
        ),
    },
)

_PASS = {"past_line": step(60, 1)}
_ENTER = {"in_conflict_area": step(60, 1, 0, 90)}
_STOP = {"speed": step(30, 0, 10, 50)}
INTERSECTION = Traces(
    250,
    dict.fromkeys(
        ("green_arrow", "stop_sign", "turning_left", "turning_right", "past_line", "in_conflict_area"), 0
    )
    | {"light": 2, "light_works": 1, "speed": 10, "exit_gap": 30, "ego_length": 5}
    | _vehicle(1, arrival=2, oncoming=0, has_priority=0)
    | _vehicle(2, arrival=5, oncoming=0, has_priority=0),
    {
        "R_IN1": (_PASS | _STOP | {"stop_sign": 1}, _PASS | {"stop_sign": 1}),
        "R_IN2": (_PASS | {"light": step(50, 2)}, _PASS | {"light": 0}),
        "R_IN3": (
            _PASS | _STOP | {"light": 0, "green_arrow": 1, "turning_right": 1},
            _PASS | {"light": 0, "green_arrow": 1, "turning_right": 1},
        ),
        "R_IN4": (_ENTER | {"vehicle_2.has_priority": 1}, _ENTER | {"vehicle_1.has_priority": 1}),
        "R_IN5": (
            _ENTER | {"turning_left": 1, "vehicle_2.oncoming": 1},
            _ENTER | {"turning_left": 1, "vehicle_1.oncoming": 1},
        ),
        "R_IN6": (_ENTER, {"in_conflict_area": step(60, 1)}),
    },
)

#: From each file to its traces.
TRACES = {
    "interstate": INTERSTATE,
    "intersection": INTERSECTION,
}
