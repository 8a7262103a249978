"""The controller: a PID path follower. A reference moves along the waypoints, and the base is kept on it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geometry import turned, wrapped
from sim import MAX_SPEED, MAX_TURN, PERIOD, limited

if TYPE_CHECKING:
    from faults import Fault
    from planner import Plan
    from sim import State

CRUISE = 0.18  # m/s
SLOWER_FROM = 0.3  # m: the reference goes at half its speed when the robot is so far off
PROPORTIONAL, INTEGRAL, DERIVATIVE = 1.2, 0.15, 0.1  # 1/s, 1/s2, 1
WINDUP = 0.08  # m/s, the most that the integral part may ask for
TURN = 1.5  # 1/s
WRONG_GAIN = -0.3  # what a fault makes of the gain to the side


class Controller:
    """Keeps the perceived position on the reference; commands the base by velocities in its own frame."""

    def __init__(self, start: np.ndarray, fault: Fault | None = None) -> None:
        self.reference = start.copy()
        self._fault = fault
        self._made: float | None = None
        self._left = np.empty((0, 2))  # waypoints to come
        self._total = np.zeros(2)
        self._before: np.ndarray | None = None
        self._off = 0.0

    def follow(self, time: float, view: State, plan: Plan) -> np.ndarray:
        """Return the command to the base: forward, left (m/s), turn (rad/s)."""
        if plan.made != self._made:
            self._made, self._left = plan.made, plan.waypoints[1:]
        moved = self._advance()
        error = self.reference - view.position
        self._off = float(np.hypot(*error))
        change = np.zeros(2) if self._before is None else (error - self._before) / PERIOD
        self._before = error
        self._total = limited(self._total + INTEGRAL * error * PERIOD, WINDUP)
        wanted = moved + PROPORTIONAL * error + self._total + DERIVATIVE * change
        command = turned(wanted, -view.pose[2])
        if self._fault and self._fault.active("controller", time) == "wrong gain":
            command[1] *= WRONG_GAIN
        turn = 0.0
        if np.hypot(*moved) > 0:
            turn = TURN * wrapped(float(np.arctan2(moved[1], moved[0])) - view.pose[2])
        return np.append(limited(command, MAX_SPEED), np.clip(turn, -MAX_TURN, MAX_TURN))

    def _advance(self) -> np.ndarray:
        """Move the reference on; return its velocity. It is slower while the robot is behind."""
        before = self.reference.copy()
        step = CRUISE * PERIOD * (1.0 - 0.5 * min(1.0, self._off / SLOWER_FROM))
        while step > 0 and len(self._left):
            way = self._left[0] - self.reference
            far = float(np.hypot(*way))
            if far > step:
                self.reference = self.reference + way * (step / far)
                break
            self.reference, self._left = self._left[0].copy(), self._left[1:]
            step -= far
        return (self.reference - before) / PERIOD

    def signals(self) -> dict[str, float]:
        """Return how far the perceived position is from the reference (m)."""
        return {"tracking_error": self._off}
