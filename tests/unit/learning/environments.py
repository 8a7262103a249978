"""Environments that replay columns, so that the samples of an episode are known."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from pettingzoo import ParallelEnv

SIGNALS = {"x": ("observation", 0), "y": ("info", "y")}


class Replay(gymnasium.Env):
    """Observes x and a constant; y is in the info. Rewards: the number of the step.

    ``episodes``: arrays with the rows (x, y), one after another, from the first again when they are used up. The last
    row of an episode terminates it, or truncates it where ``truncates``.
    """

    metadata = {"render_modes": []}  # noqa: RUF012 - as Gymnasium declares it

    def __init__(self, *episodes: Any, truncates: bool = False):
        self.observation_space = gymnasium.spaces.Box(-1e9, 1e9, (2,), np.float64)
        self.action_space = gymnasium.spaces.Discrete(2)
        self.episodes, self.next, self.truncates = (
            [np.asarray(each, float) for each in episodes],
            0,
            truncates,
        )
        self.seeds: list[int | None] = []

    def _now(self):
        x, y = self.rows[self.at]
        return np.array([x, 7.0]), {"y": float(y)}

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed, options=options)
        self.seeds.append(seed)
        self.rows = self.episodes[self.next % len(self.episodes)]
        self.next += 1
        self.at = 0
        return self._now()

    def step(self, _):
        self.at += 1
        over = self.at == len(self.rows) - 1
        observation, info = self._now()
        return observation, float(self.at), over and not self.truncates, over and self.truncates, info


class Pair(ParallelEnv):
    """Two agents that observe a column each, for as long as the columns last."""

    metadata = {"name": "pair"}  # noqa: RUF012 - as PettingZoo declares it

    def __init__(self, **columns: Any):
        self.columns = columns
        self.possible_agents = list(columns)
        self.agents: list[str] = []
        self.render_mode = None
        self.spaces = {agent: gymnasium.spaces.Box(-1e9, 1e9, (1,), np.float64) for agent in columns}
        self.actions = {agent: gymnasium.spaces.Discrete(2) for agent in columns}

    def observation_space(self, agent):
        return self.spaces[agent]

    def action_space(self, agent):
        return self.actions[agent]

    def _now(self):
        return {agent: np.array([float(self.columns[agent][self.at])]) for agent in self.agents}

    def reset(self, seed=None, options=None):  # noqa: ARG002 - it starts the same every time
        self.agents, self.at = list(self.possible_agents), 0
        return self._now(), {agent: {} for agent in self.agents}

    def step(self, _):
        self.at += 1
        every = list(self.agents)
        found = self._now()
        over = self.at == min(map(len, self.columns.values())) - 1
        if over:
            self.agents = []
        return (
            found,
            {agent: float(len(agent)) for agent in every},
            dict.fromkeys(every, False),
            dict.fromkeys(every, over),
            {agent: {} for agent in every},
        )
