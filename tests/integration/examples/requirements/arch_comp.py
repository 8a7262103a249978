"""Made traces for the formulas of ARCH-COMP's falsification benchmarks."""

from __future__ import annotations

from tests.integration.examples.requirements.traces import Columns, Traces, step


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

#: From each file to its traces.
TRACES = {
    "transmission": TRANSMISSION,
    "fuel_control": FUEL,
    "neural_controller": NEURAL,
    "cars": CARS,
    "f16": F16,
    "steam_condenser": CONDENSER,
    "wind_turbine": TURBINE,
}
