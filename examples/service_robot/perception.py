"""Perception: where the robot believes that it is, that others are, and what it has for a map."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geometry import turned, wrapped
from sim import OBSTACLES, PERIOD, REGIONS, State

if TYPE_CHECKING:
    from faults import Fault

NOISE = 0.01  # m, from sample to sample
WANDER = 0.025  # m, the slow part of the localisation's error: its standard deviation...
MEMORY = 4.0  # s, ...and how long it lasts
HEADING_NOISE = 0.01  # rad
AGENT_NOISE = 0.015  # m, of the range sensor
MAP_NOISE = 0.01  # m, of each box of the map, once and for all
DRIFT = 0.05  # m/s, of the drift that is a fault
JUMP = 0.45  # m, of the jump that is a fault


class Perception:
    """Localisation on a map: agents are seen from the robot, so that its own error moves them too."""

    def __init__(self, seed: int, fault: Fault | None = None) -> None:
        self._rng = np.random.default_rng([seed, 1])
        self._fault = fault
        self._wander = self._rng.normal(0.0, WANDER, 2)
        self.obstacles = OBSTACLES + np.tile(self._rng.normal(0.0, MAP_NOISE, (len(OBSTACLES), 2)), 2)
        self.regions = REGIONS + np.tile(self._rng.normal(0.0, MAP_NOISE, (len(REGIONS), 2)), 2)

    def observe(self, time: float, truth: State) -> State:
        """Return what is perceived of the true state at a time (s)."""
        rng = self._rng
        keep = np.exp(-PERIOD / MEMORY)
        self._wander = keep * self._wander + np.sqrt(1 - keep**2) * rng.normal(0.0, WANDER, 2)
        error = self._wander + rng.normal(0.0, NOISE, 2) + self._wrong(time)
        turn = rng.normal(0.0, HEADING_NOISE)
        pose = np.array([*(truth.position + error), wrapped(truth.pose[2] + turn)])
        seen = [pose[:2] + turned(agent - truth.position, turn) for agent in truth.agents]
        return State(pose, np.array(seen) + rng.normal(0.0, AGENT_NOISE, truth.agents.shape))

    def _wrong(self, time: float) -> np.ndarray:
        """Return what the fault adds to the error."""
        kind = self._fault.active("perception", time) if self._fault else None
        if self._fault is None or kind is None:
            return np.zeros(2)
        size = JUMP if kind == "jump" else DRIFT * (time - self._fault.onset)
        return size * np.array([np.cos(self._fault.direction), np.sin(self._fault.direction)])

    def signals(self, truth: State, view: State) -> dict[str, float]:
        """Return the errors of what is perceived (m), each the largest of its kind."""
        return {
            "pose_error": float(np.hypot(*(view.position - truth.position))),
            "agent_error": float(np.hypot(*(view.agents - truth.agents).T).max()),
            "obstacle_error": float(np.hypot(*(self.obstacles - OBSTACLES)[:, :2].T).max()),
            "region_error": float(np.hypot(*(self.regions - REGIONS)[:, :2].T).max()),
        }
