"""The automatic transmission of ARCH-COMP: a car with four gears, driven by throttle and brake.

Published (Hoxha, Abbas and Fainekos, "Benchmarks for temporal logic requirements for automotive
systems", 2014, and the tables of zlscheck's entry in the competition of 2020): the equations, the map of the
engine, the thresholds of the shifts, the ratios of the gears, the curves of the torque converter, the inertias
and the resistances. Units are the model's: mph, rpm, ft lb, percent of throttle::

    engine     Ie N' = T(throttle, N) - (N / K(s))^2         600 <= N <= 6000, 1000 at the start
    converter  s = (turbine speed) / N, turbine torque = (N / K(s))^2 R(s)
    gearbox    output torque = ratio(gear) (turbine torque); turbine speed = ratio(gear) (output speed)
    car        Iv w' = f (output torque) - sign(v) (40 + 0.02 v^2 + brake);  output speed = f w
    shifts     up or down one gear after the speed was beyond the threshold for 0.08 s

Declared here: Euler's method with a step of 10 ms, at which gears change too; a car that stands is not
driven backwards by its brake; beyond the ends of its table a curve goes straight on.
"""

from __future__ import annotations

from bisect import bisect_right
from math import pi
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

STEP = 0.01  # s
DURATION = 30.0  # s
WAIT = 0.08  # s
ENGINE_INERTIA = 0.02199
CAR_INERTIA = 12.09415
FINAL_DRIVE = 3.23
DRAG, FRICTION = 0.02, 40.0
MPH = 2 * pi * 60 / 5280  # of a wheel of 1 ft, from revolutions a minute
RATIO = (2.393, 1.450, 1.000, 0.677)

THROTTLE = (0, 20, 30, 40, 50, 60, 70, 80, 90, 100)
RPM = (800, 1200, 1600, 2000, 2400, 2800, 3200, 3600, 4000, 4400, 4800)
TORQUE = (
    (-40, -44, -49, -53, -57, -61, -65, -70, -74, -78, -82),
    (215, 117, 85, 66, 44, 29, 10, -2, -13, -22, -32),
    (245, 208, 178, 148, 122, 104, 85, 66, 48, 33, 18),
    (264, 260, 241, 219, 193, 167, 152, 133, 119, 96, 85),
    (264, 279, 282, 275, 260, 238, 223, 208, 189, 171, 152),
    (267, 290, 293, 297, 290, 275, 260, 256, 234, 212, 193),
    (267, 297, 305, 305, 305, 301, 293, 282, 267, 249, 226),
    (267, 301, 308, 312, 319, 323, 319, 316, 297, 279, 253),
    (267, 301, 312, 319, 327, 327, 327, 327, 312, 293, 267),
    (267, 301, 312, 319, 327, 334, 334, 334, 319, 305, 275),
)
SPEED_RATIO = (0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.81, 0.82,
               0.83, 0.84, 0.85, 0.86, 0.87, 0.88, 0.89, 0.9, 0.92, 0.94)  # fmt: skip
K_FACTOR = (137.465, 137.065, 135.864, 135.664, 137.565, 140.367, 145.269, 152.873, 162.977, 164.278, 166.179,
            167.980, 170.081, 172.782, 175.383, 179.585, 183.587, 189.890, 197.694, 215.902, 244.516)  # fmt: skip
TORQUE_RATIO = (2.232, 2.075, 1.975, 1.846, 1.720, 1.564, 1.409, 1.254, 1.096, 1.080, 1.061,
                1.043, 1.028, 1.012, 1.002, 1.002, 1.001, 0.998, 0.999, 1.001, 1.002)  # fmt: skip

#: From throttle to speed, for the gears 1 to 3 (up) and 2 to 4 (down).
UP_THROTTLE = (0, 25, 35, 50, 90, 100)
UP = ((10, 10, 15, 23, 40, 40), (30, 30, 30, 41, 70, 70), (50, 50, 50, 60, 100, 100))
DOWN_THROTTLE = (0, 5, 40, 50, 90, 100)
DOWN = ((5, 5, 5, 5, 30, 30), (20, 20, 25, 30, 50, 50), (35, 35, 40, 50, 80, 80))


def drive(
    throttle: Callable[[float], float], brake: Callable[[float], float], duration: float = DURATION
) -> dict[str, list[float]]:
    """Simulate; returns the speed (mph), the speed of the engine (rpm) and the gear at every step.

    >>> full = drive(lambda time: 100.0, lambda time: 0.0, duration=20.0)
    >>> max(full["gear"]), round(full["speed"][-1])
    (4, 120)
    """
    rpm, wheel, gear, since = 1000.0, 0.0, 1, 0.0
    columns: dict[str, list[float]] = {name: [] for name in ("time", "speed", "rpm", "gear")}
    for k in range(round(duration / STEP) + 1):
        time = k * STEP
        speed = wheel * MPH
        columns["time"].append(time)
        columns["speed"].append(speed)
        columns["rpm"].append(rpm)
        columns["gear"].append(gear)
        pressed = throttle(time)
        shift = _wanted(gear, speed, pressed)
        since = since + STEP if shift else 0.0
        if shift and since > WAIT:
            gear, since = gear + shift, 0.0
        impeller, turned = _converter(rpm, wheel * FINAL_DRIVE * RATIO[gear - 1])
        engine = _engine(pressed, rpm)
        rpm = min(6000.0, max(600.0, rpm + STEP * (engine - impeller) / ENGINE_INERTIA))
        load = FRICTION + DRAG * speed * speed + brake(time)
        wheel = max(0.0, wheel + STEP * (FINAL_DRIVE * RATIO[gear - 1] * turned - load) / CAR_INERTIA)
    return columns


def _engine(throttle: float, rpm: float) -> float:
    """Return the torque of the engine, straight between the points of its map."""
    row, part = _place(THROTTLE, throttle)
    place = _place(RPM, rpm)
    low, high = _at(TORQUE[row], *place), _at(TORQUE[row + 1], *place)
    return low + part * (high - low)


def _converter(rpm: float, turbine: float) -> tuple[float, float]:
    """Return the torques of the impeller and of the turbine."""
    place = _place(SPEED_RATIO, turbine / rpm)
    impeller = (rpm / _at(K_FACTOR, *place)) ** 2
    return impeller, impeller * _at(TORQUE_RATIO, *place)


def _wanted(gear: int, speed: float, throttle: float) -> int:
    """Return 1 where the speed is above the threshold of its gear, -1 where it is below, else 0."""
    if gear > 1 and speed < _at(DOWN[gear - 2], *_place(DOWN_THROTTLE, throttle)):
        return -1
    if gear < 4 and speed > _at(UP[gear - 1], *_place(UP_THROTTLE, throttle)):
        return 1
    return 0


def _place(points: Sequence[float], x: float) -> tuple[int, float]:
    """Return between which points x lies, and how far: a part of 0 to 1, another one beyond the ends."""
    k = min(max(bisect_right(points, x) - 1, 0), len(points) - 2)
    return k, (x - points[k]) / (points[k + 1] - points[k])


def _at(values: Sequence[float], k: int, part: float) -> float:
    return values[k] + part * (values[k + 1] - values[k])
