"""A point on a plane with an obstacle between the start and the goal, as a Gymnasium environment."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np

SIZE = 6.0
GOAL, OBSTACLE = np.array([5.0, 5.0]), np.array([3.0, 3.0])
NEAR, RADIUS = 0.5, 1.0
#: Where the variables of the requirement are found.
SIGNALS = {"goal": ("info", "goal"), "clear": ("info", "clear")}


class Reach(gymnasium.Env):
    """The observation is the position, the action the step. Rewards: +1 at the goal, -1 in the obstacle, else 0."""

    metadata = {"render_modes": []}  # noqa: RUF012 - as Gymnasium declares it

    def __init__(self) -> None:
        self.observation_space = gymnasium.spaces.Box(0.0, SIZE, (2,), np.float32)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (2,), np.float32)

    def _info(self) -> dict[str, float]:
        goal = float(np.linalg.norm(self.position - GOAL))
        return {"goal": goal, "clear": float(np.linalg.norm(self.position - OBSTACLE)) - RADIUS}

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, Any]:
        """Start near a corner."""
        super().reset(seed=seed, options=options)
        self.position = self.np_random.uniform(0.0, 1.5, 2)
        return self.position.astype(np.float32), self._info()

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, float]]:
        """Move by up to 0.25 in each direction, within the square."""
        move = 0.25 * np.clip(np.asarray(action, float), -1, 1)
        self.position = np.clip(self.position + move, 0.0, SIZE)
        info = self._info()
        reward = 1.0 if info["goal"] <= NEAR else -1.0 if info["clear"] < 0 else 0.0
        return self.position.astype(np.float32), reward, reward != 0, False, info
