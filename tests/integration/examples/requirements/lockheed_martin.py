"""Made traces for the Lockheed Martin challenge problems."""

from __future__ import annotations

from math import cos, pi, sin, sqrt

import numpy as np

from tests.integration.examples.requirements.traces import Columns, Traces, step

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

#: From each file to its traces.
TRACES = {
    "triplex_signal_monitor": TRIPLEX,
    "finite_state_machine": MACHINE,
    "tustin_integrator": TUSTIN,
    "regulators": REGULATORS,
    "nonlinear_guidance": GUIDANCE,
    "neural_network": NETWORK,
    "effector_blender": BLENDER,
    "autopilot": PILOT,
    "safety_monitor": INTEGRITY,
    "euler_transformation": EULER,
}
