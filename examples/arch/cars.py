"""The chasing cars of ARCH-COMP: five cars in a row, the first driven, each other one follows the car before it.

Published (Hu, Lygeros and Sastry, "Towards a theory of stochastic hybrid systems", 2000, as the
competition's model has it): the equations, the thresholds 5, 10, 15 and 20, the places at the start
(0, 10, ... 40, at rest, all *keeping*). Cars drive towards smaller numbers::

    driven    y' = v    v' = -throttle - brake v
    chasing   y' = -v   v' = 1       until the distance is 10 or less: keeping
    keeping   y' = v    v' = 0       until it is 15 or more: chasing, or 5 or less: braking
    braking   y' = -v   v' = -v      until it is 20 or more: chasing

Declared here: Euler's method with a step of 25 ms, in which places change evenly; a mode changes where, within
the step, the distance crosses its threshold. (With mode changes at the steps only, a fast car runs past its
threshold by a metre and more, and CC4, CC5 and CCx become easy.)
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

STEP = 0.025  # s
DURATION = 100.0  # s
CHASING, KEEPING, BRAKING = range(3)
MARGIN = 1e-9  # s past the crossing, so that it is one in floating point too
CARS = ("y1", "y2", "y3", "y4", "y5")


def chase(
    throttle: Callable[[float], float], brake: Callable[[float], float], duration: float = DURATION
) -> dict[str, list[float]]:
    """Simulate; returns the places of the five cars at every step.

    >>> parked = chase(lambda time: 0.0, lambda time: 0.0, duration=1.0)
    >>> [parked[car][-1] for car in CARS]
    [0.0, 10.0, 20.0, 30.0, 40.0]
    """
    place = [0.0, 10.0, 20.0, 30.0, 40.0]
    speed = 0.0
    followers = [Follower(y) for y in place[1:]]
    columns: dict[str, list[float]] = {name: [] for name in ("time", *CARS)}
    for k in range(round(duration / STEP) + 1):
        time = k * STEP
        columns["time"].append(time)
        for name, y in zip(CARS, place, strict=True):
            columns[name].append(y)
        ahead, place[0] = place[0], place[0] + STEP * speed
        speed -= STEP * (throttle(time) + brake(time) * speed)
        for i, follower in enumerate(followers):
            before = follower.place
            follower.move(ahead, place[i])
            ahead, place[i + 1] = before, follower.place
    return columns


@dataclass
class Follower:
    """A car that follows another one."""

    place: float
    speed: float = 0.0
    mode: int = KEEPING

    def move(self, ahead: float, then: float) -> None:
        """Drive one step, in which the car before goes evenly from ``ahead`` to ``then``."""
        rest = STEP
        pace = (then - ahead) / STEP
        while True:
            self.mode = _next(self.mode, self.place - ahead)
            own = self.speed if self.mode == KEEPING else -self.speed
            part = min(rest, _until_change(self.mode, self.place - ahead, own - pace))
            self.place += part * own
            ahead += part * pace
            if self.mode == CHASING:
                self.speed += part
            elif self.mode == BRAKING:
                self.speed -= part * self.speed
            rest -= part
            if rest <= 0:
                return


def _until_change(mode: int, distance: float, growth: float) -> float:
    """Return how long, in seconds, the distance stays where it does not change the mode."""
    if growth > 0:
        limit = 15.0 if mode == KEEPING else 20.0 if mode == BRAKING else inf
    elif growth < 0:
        limit = 10.0 if mode == CHASING else 5.0 if mode == KEEPING else -inf
    else:
        return inf
    return (limit - distance) / growth + MARGIN


def _next(mode: int, distance: float) -> int:
    if mode == CHASING:
        return KEEPING if distance <= 10 else CHASING
    if mode == KEEPING:
        return CHASING if distance >= 15 else BRAKING if distance <= 5 else KEEPING
    return CHASING if distance >= 20 else BRAKING
