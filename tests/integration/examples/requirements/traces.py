"""Made traces for ``examples/requirements``: for each requirement one that satisfies it and one that violates it.

A trace has ``length`` samples; a column is a number, a list (whose last value goes on) or a function of the index.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import cos, inf, pi, sin, sqrt
from typing import Any

import numpy as np

Columns = dict[str, Any]


@dataclass(frozen=True)
class Traces:
    """The traces for one file: ``common`` columns, and for each requirement what differs, first good, then bad."""

    length: int
    common: Columns
    cases: dict[str, tuple[Columns, Columns]] = field(default_factory=dict)

    def made(self, changed: Columns) -> dict[str, np.ndarray]:
        """Return a trace."""
        columns = {**self.common, **changed}
        return {
            name: np.array([_at(value, i) for i in range(self.length)]) for name, value in columns.items()
        }


def _at(value: Any, i: int) -> float:
    if isinstance(value, list):
        value = value[min(i, len(value) - 1)]
    return float(value(i) if callable(value) else value)


def step(begin: int, value: float, before: float = 0.0, end: float = inf) -> Any:
    """Return a column that has another value from ``begin`` on, until ``end``."""
    return lambda i: value if begin <= i < end else before


# ---- Lockheed Martin -----------------------------------------------------------------------------

_SIGNALS = {"ia": 1, "ib": 1.02, "ic": 1.05}
TRIPLEX = Traces(
    12,
    {**_SIGNALS, "failure": 0, "selected": 1.02},
    {
        "TSM-001": (
            {"ia": step(3, 5, 1), "failure": step(8, 4), "selected": 1.02},
            {"ia": step(3, 5, 1), "failure": 0},
        ),
        "TSM-002": ({}, {"selected": 1.05}),
        "TSM-003a": ({"failure": 1, "selected": 1.01}, {"failure": 1, "selected": 1.02}),
        "TSM-003b": ({"failure": 2, "selected": 1.025}, {"failure": 2, "selected": 1}),
        "TSM-003c": ({"failure": 4, "selected": 1.035}, {"failure": 4, "selected": 1}),
        "TSM-004": (
            {"failure": 1, "ib": step(5, 3, 1), "selected": 1},
            {"failure": 1, "ib": step(5, 3, 1), "selected": step(6, 2, 1)},
        ),
    },
)


def _move(
    state: int, then: int, otherwise: int, column: str = "state", **inputs: float
) -> tuple[Columns, Columns]:
    return {column: [state, then], **inputs}, {column: [state, otherwise], **inputs}


_T, _N, _M, _S = range(4)
MACHINE = Traces(
    2,
    dict.fromkeys(
        ("standby", "apfail", "supported", "limits", "good", "request", "mode", "pullup", "state", "sensor"),
        0,
    ),
    {
        "FSM-001": ({"limits": 1, "supported": 1, "pullup": 1}, {"limits": 1, "supported": 1, "pullup": 0}),
        "FSM-002": _move(_T, _S, _T, standby=1),
        "FSM-003": _move(_T, _N, _T, good=1, supported=1),
        "FSM-004": _move(_N, _M, _N),
        "FSM-005": _move(_N, _S, _M, standby=1, good=1),
        "FSM-006": _move(_M, _S, _M, standby=1, good=1),
        "FSM-007": _move(_M, _T, _M, supported=1, good=1),
        "FSM-008": _move(_S, _T, _S),
        "FSM-009": _move(_S, _M, _S, apfail=1),
        "FSM-010": _move(0, 2, 0, "sensor", limits=1),
        "FSM-011": _move(0, 1, 2, "sensor"),
        "FSM-012": _move(2, 1, 0, "sensor"),
        "FSM-013": _move(1, 0, 2, "sensor", request=1, mode=1),
    },
)


def _integral(i: int) -> float:
    return sum(0.05 * (sin(k) + sin(k - 1)) for k in range(1, i + 1))


TUSTIN = Traces(
    105,
    {"x": 1, "reset": 0, "initial": 0, "top": 20, "bottom": -20, "y": lambda i: 0.1 * i},
    {
        "TUI-001": ({"reset": 1, "initial": 3, "y": 3}, {"reset": 1, "initial": 3, "y": 0}),
        "TUI-002": ({}, {"top": 5}),
        "TUI-003": ({"x": sin, "y": _integral}, {"x": sin, "y": 0}),
        "TUI-004": ({}, {"y": lambda i: 0.09 * i}),
    },
)

_SHORT, _LONG = step(10, 60, 0, 60), step(10, 60, 0, 160)


def _loop(column: str, slope: float) -> tuple[Columns, Columns]:
    return {column: lambda i: 0.009 * slope * i}, {column: lambda i: 0.011 * slope * i}


REGULATORS = Traces(
    200,
    dict.fromkeys(("roll", "pitch", "yaw", "airspeed", "height"), 0),
    {
        **{
            f"REG-00{k}": ({name: _SHORT}, {name: _LONG})
            for k, name in enumerate(("roll", "pitch", "yaw", "airspeed", "height"), 1)
        },
        "REG-006": _loop("roll", 50),
        "REG-007": _loop("pitch", 50),
        "REG-008": _loop("yaw", 50),
        "REG-009": _loop("airspeed", 32),
        "REG-010": _loop("height", 32),
    },
)

# The vehicle flies north at 200 m from the target, which is to the west; the tangent points are at 60 degrees.
_TANGENT = {"ax": 50, "ay": 50 * sqrt(3)}
GUIDANCE = Traces(
    3,
    {
        "px": 200,
        "py": 0,
        "vx": 0,
        "vy": 30,
        "tx": 0,
        "ty": 0,
        "tz": 500,
        "wx": 1,
        "wy": 0,
        "first_x": 100,
        "first_y": 0,
        "second_x": -100,
        "second_y": 0,
        "az": 500,
        **_TANGENT,
    },
    {
        "NLG-001": ({}, {"vy": -30}),
        "NLG-002": ({}, {"ax": 0, "ay": 50}),
        "NLG-003": ({}, {"ax": 0, "ay": 100}),
        "NLG-004": ({}, {"ay": -50 * sqrt(3)}),
        "NLG-005": ({"px": 50, "ax": 100, "ay": 0}, {"px": 50, "ax": -100, "ay": 0}),
        "NLG-006": ({"ax": [50, 60]}, {"ax": [50, 90]}),
        "NLG-007": ({}, {"az": 499}),
    },
)

NETWORK = Traces(
    5,
    {"x": 0, "y": 0, "xt": lambda i: 0.1 * i, "yt": lambda i: 0.1 * i, "zt": 0.5, "z": 0.5},
    {
        "NN-001": ({}, {"z": 1.2}),
        "NN-002": ({}, {"z": -0.3}),
        "NN-003a": ({"z": lambda i: -0.1 * i}, {"yt": 0, "z": [0, 1.05]}),
        "NN-003b": ({"z": lambda i: -0.1 * i}, {"xt": 0, "z": [1, -3]}),
        "NN-004": ({"xt": 0, "yt": 0, "z": 0.495}, {"xt": 0, "yt": 0, "z": 0.48}),
    },
)

BLENDER = Traces(
    3,
    {
        "det_bbt": 0.2,
        "ridge_on": 0,
        **{f"check{i}{j}": float(i == j) + 1e-9 for i in (1, 2, 3) for j in (1, 2, 3)},
        "residual": 1e-5,
    },
    {
        "EB-001": ({"det_bbt": 1e-13, "ridge_on": 1}, {"det_bbt": 1e-13}),
        "EB-002": ({}, {"check12": 1e-3}),
        "EB-003": ({}, {"residual": 1e-3}),
    },
)

_HOLD = {"engaged": step(5, 1), "roll_hold": step(5, 1)}
_LATE = {"roll_hold": 1, "roll_reference": step(20, 10)}
PILOT = Traces(
    200,
    {
        "engaged": 1,
        "roll_hold": 1,
        "heading_mode": 0,
        "heading_hold": 0,
        "altitude_hold": 1,
        "turn_knob": 0,
        "roll": 0,
        "roll_rate": 0,
        "heading": 0,
        "heading_reference": 0,
        "altitude": 1000,
        "roll_reference": 0,
        "roll_command": 0,
        "roll_hold_command": 0,
        "heading_command": 0,
        "aileron": 0,
    },
    {
        "AP-000": (
            {"altitude_hold": step(5, 1), "altitude": step(9, 1220, 1200)},
            {"altitude_hold": step(5, 1), "altitude": step(9, 1240, 1200)},
        ),
        "AP-001": ({"engaged": 0}, {"engaged": 0, "roll_command": 1}),
        "AP-002": ({}, {"roll_hold": 0}),
        "AP-002b": ({"roll_command": 3, "roll_hold_command": 3}, {"roll_command": 3}),
        "AP-003a": ({**_HOLD, "roll": 20, "roll_reference": 20}, {**_HOLD, "roll": 20, "roll_reference": 0}),
        "AP-003b": ({**_HOLD, "roll": 4}, {**_HOLD, "roll": 4, "roll_reference": 4}),
        "AP-003c": (
            {**_HOLD, "roll": -32, "roll_reference": -30},
            {**_HOLD, "roll": -32, "roll_reference": -32},
        ),
        "AP-003d": ({"turn_knob": 40, "roll_reference": 30}, {"turn_knob": 40, "roll_reference": 40}),
        "AP-004a": ({"roll_reference": 10, "roll": 9.5}, {"roll_reference": 10, "roll": step(150, 8, 10)}),
        "AP-004b": (_LATE | {"roll": step(20, 10.5)}, _LATE | {"roll": step(20, 11.5)}),
        "AP-005": ({"roll_rate": -6}, {"roll_rate": -7}),
        "AP-006": ({"roll": 30}, {"roll": 34}),
        "AP-007": ({"aileron": 14}, {"aileron": -16}),
        "AP-008a": ({"heading_hold": 1, "heading_mode": 1}, {"heading_hold": 1}),
        "AP-008b": ({"heading_hold": 1, "heading_command": 0}, {"heading_hold": 1, "heading_command": 5}),
        "AP-010a": (
            {"heading_mode": 1, "heading_reference": 179.8, "heading": -179.8},
            {"heading_mode": 1, "heading_reference": 90, "heading": 88},
        ),
        "AP-010b": (
            {"heading_mode": 1, "heading_reference": step(20, -20), "heading": step(20, -21)},
            {"heading_mode": 1, "heading_reference": step(20, -20), "heading": step(20, -23)},
        ),
    },
)

INTEGRITY = Traces(
    2,
    {"stores": 1, "weight": 22500, "airspeed_least": 1.25921 * 150 + 10},
    {
        "SWIM-001a": ({}, {"airspeed_least": 190}),
        "SWIM-001b": ({"stores": 3, "airspeed_least": 1.33694 * 150 + 10}, {"stores": 3}),
    },
)


def _rotation(roll: float, pitch: float, yaw: float) -> Columns:
    about_x = np.array([[1, 0, 0], [0, cos(roll), sin(roll)], [0, -sin(roll), cos(roll)]])
    about_y = np.array([[cos(pitch), 0, -sin(pitch)], [0, 1, 0], [sin(pitch), 0, cos(pitch)]])
    about_z = np.array([[cos(yaw), sin(yaw), 0], [-sin(yaw), cos(yaw), 0], [0, 0, 1]])
    matrix = about_x @ about_y @ about_z
    body = matrix @ [1, 2, 3]
    elements = {f"r{i + 1}{j + 1}": matrix[i, j] for i in range(3) for j in range(3)}
    return {
        "phi": roll,
        "theta": pitch,
        "psi": yaw,
        "x": 1,
        "y": 2,
        "z": 3,
        **elements,
        **dict(zip(("bx", "by", "bz"), body, strict=True)),
    }


EULER = Traces(
    2,
    _rotation(0.3, -0.5, pi / 3),
    {
        "EUL-001a": ({}, {"r13": 0.1}),
        "EUL-001b": ({}, {"r21": 0.1}),
        "EUL-001c": ({}, {"r33": 0.1}),
        "EUL-002": ({}, {"by": 0}),
        "EUL-006c": ({}, {"r22": 2}),
        "EUL-006d": ({}, {"r32": 0.5}),
    },
)

# ---- ARCH-COMP -----------------------------------------------------------------------------------


def _shift(gear: int) -> tuple[Columns, Columns]:
    return {"gear": step(100, gear, 0)}, {"gear": step(100, gear, 0, 200)}


_SLOW = {"rpm": 2000}
TRANSMISSION = Traces(
    3100,
    {"throttle": 50, "brake": 0, "speed": 30, "rpm": 3500, "gear": 5},
    {
        "AT1": ({}, {"speed": step(1999, 121, 100)}),
        "AT2": ({}, {"rpm": step(900, 4800, 4000)}),
        **{f"AT5{gear}": _shift(gear) for gear in range(1, 5)},
        "AT6a": (_SLOW, _SLOW | {"speed": 36}),
        "AT6b": (_SLOW, _SLOW | {"speed": step(700, 51, 30)}),
        "AT6c": (_SLOW, _SLOW | {"speed": step(1900, 66, 30)}),
    },
)

_KICK = step(2000, 60, 5)
FUEL = Traces(
    5600,
    {"throttle": 70, "mu": 0},
    {
        "AFC27": (
            {"throttle": _KICK, "mu": step(2000, 0.05, 0, 2090)},
            {"throttle": _KICK, "mu": step(2000, 0.05, 0, 2200)},
        ),
        "AFC29": ({"mu": 0.006}, {"mu": step(4000, 0.0071)}),
        "AFC33": ({"mu": step(500, 0.05, 0, 1000)}, {"mu": 0.01}),
    },
)

NEURAL = Traces(
    4200,
    {"reference": 2, "position": 2},
    {
        "NN": ({"position": step(1000, 2.5, 2, 1150)}, {"position": step(1000, 2.5, 2, 1350)}),
        "NNx": ({"position": step(0, 3.3, 2, 60)}, {"position": step(0, 3.3, 2, 160)}),
    },
)

CARS = Traces(
    101,
    {f"y{k}": 10 * k for k in range(1, 6)},
    {
        "CC1": ({}, {"y5": step(90, 81, 50)}),
        "CC2": ({"y5": step(20, 60, 50)}, {}),
        "CC3": ({}, {"y2": step(30, 40, 20)}),
        "CC4": ({}, {"y5": 45}),
        "CC5": ({}, {"y5": 45}),
        "CCx": ({}, {"y3": step(40, 27, 30)}),
    },
)

F16 = Traces(1501, {"altitude": 100}, {"F16": ({}, {"altitude": lambda i: 100 - i / 14})})
CONDENSER = Traces(
    351, {"pressure": 87.2}, {"SC": ({"pressure": step(299, 87.4, 90)}, {"pressure": step(340, 87.6, 87.2)})}
)
TURBINE = Traces(
    640,
    {"wind": 12, "pitch": 10, "pitch_demand": 10, "torque": 30_000, "rotor": 12},
    {
        "WT1": ({"pitch": step(0, 15, 10, 30)}, {"pitch": step(100, 14.3, 10)}),
        "WT2": ({}, {"torque": step(100, 20_000, 30_000)}),
        "WT3": ({}, {"rotor": step(100, 14.4, 12)}),
        "WT4": ({"pitch_demand": step(100, 12, 10, 104)}, {"pitch_demand": step(100, 12, 10, 110)}),
    },
)

# ---- CommonRoad ----------------------------------------------------------------------------------


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
    "lockheed_martin/triplex_signal_monitor": TRIPLEX,
    "lockheed_martin/finite_state_machine": MACHINE,
    "lockheed_martin/tustin_integrator": TUSTIN,
    "lockheed_martin/regulators": REGULATORS,
    "lockheed_martin/nonlinear_guidance": GUIDANCE,
    "lockheed_martin/neural_network": NETWORK,
    "lockheed_martin/effector_blender": BLENDER,
    "lockheed_martin/autopilot": PILOT,
    "lockheed_martin/safety_monitor": INTEGRITY,
    "lockheed_martin/euler_transformation": EULER,
    "arch_comp/transmission": TRANSMISSION,
    "arch_comp/fuel_control": FUEL,
    "arch_comp/neural_controller": NEURAL,
    "arch_comp/cars": CARS,
    "arch_comp/f16": F16,
    "arch_comp/steam_condenser": CONDENSER,
    "arch_comp/wind_turbine": TURBINE,
    "commonroad/interstate": INTERSTATE,
    "commonroad/intersection": INTERSECTION,
}
