"""A car under cruise control on a hilly road: a plant for `rtamt falsify`."""

from __future__ import annotations

from math import atan, sin
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

MASS = 1200.0  # kg
GRAVITY = 9.81  # m/s2
DRAG = 0.45  # N per (m/s)2
ROLLING = 120.0  # N
PULL = 4200.0  # N, at most
TARGET = 20.0  # m/s
PROPORTIONAL, INTEGRAL = 0.35, 0.05  # of the controller
STEP = 0.05  # s


def drive(slope: Callable[[float], float]) -> Iterator[tuple[float, dict[str, float]]]:
    """Drive for 60 s over a road of ``slope`` (rise over run) at each time: yields the speed and the throttle."""
    speed, total = TARGET, 0.0
    for k in range(round(60 / STEP) + 1):
        error = TARGET - speed
        wanted = PROPORTIONAL * error + INTEGRAL * total
        throttle = min(1.0, max(0.0, wanted))
        yield k * STEP, {"speed": speed, "throttle": throttle}
        if throttle == wanted:  # the integral part rests while the throttle can do no more
            total += error * STEP
        force = PULL * throttle - DRAG * speed * speed - ROLLING - MASS * GRAVITY * sin(atan(slope(k * STEP)))
        speed = max(0.0, speed + force / MASS * STEP)
