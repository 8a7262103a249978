"""What the wrapper of vector environments costs for each environment and step, in processor time.

``python -m benchmarks.learning``: the environments return the same arrays at every step, whose cost is subtracted; none
of them ends, or one in 64 at every step.
"""

from __future__ import annotations

import statistics
import time
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv

import rtamt
from rtamt.learning import VectorRobustnessReward

FORMULAS = ("always(x >= 0)", "always(once[0:20](x >= 1) and y <= 5)")
#: In microseconds.
TARGET = 1.0


class Constant(VectorEnv):
    """Environments that cost almost nothing."""

    def __init__(self, count: int, *, ends: bool) -> None:
        self.num_envs = count
        self.metadata = {"autoreset_mode": AutoresetMode.NEXT_STEP}
        self.single_observation_space = gymnasium.spaces.Box(-10, 10, (4,), np.float64)
        self.observation_space = gymnasium.spaces.Box(-10, 10, (count, 4), np.float64)
        self.single_action_space = self.action_space = gymnasium.spaces.Discrete(2)
        self._observations = np.random.default_rng(1).uniform(0, 9, (count, 4))
        self._zeros, self._none = np.zeros(count), np.zeros(count, bool)
        self._ends = [np.arange(count) % 64 == turn if ends else self._none for turn in range(64)]
        self._steps = 0

    def reset(self, **_: Any) -> tuple[Any, Any]:
        """Return the same observations."""
        return self._observations, {}

    def step(self, _: Any) -> tuple[Any, Any, Any, Any, Any]:
        """Return the same observations."""
        self._steps += 1
        return self._observations, self._zeros, self._none, self._ends[self._steps % 64], {}


def cost(envs: Any, steps: int = 512) -> float:
    """Return microseconds a step."""
    envs.reset()
    actions = np.zeros(envs.num_envs)
    start = time.process_time_ns()
    for _ in range(steps):
        envs.step(actions)
    return (time.process_time_ns() - start) / steps / 1000


def added(count: int, text: str, *, ends: bool, **settings: Any) -> float:
    """Return microseconds that the wrapper adds for each environment and step: the median of seven runs."""
    spec = rtamt.parse(text)
    signals = {name: ("observation", number) for number, name in enumerate(spec.input_names)}
    plain = Constant(count, ends=ends)
    wrapped = VectorRobustnessReward(Constant(count, ends=ends), spec, signals, **settings)
    return statistics.median((cost(wrapped) - cost(plain)) / count for _ in range(7))


def main() -> None:
    """Print a table."""
    print(
        f"{'requirement':42}{'reward':12}{'ends':>6}" + "".join(f"{n:>9}" for n in (16, 64, 256, 1024, 4096))
    )
    for text in FORMULAS:
        for settings in ({"reward": "robustness"}, {"reward": "shaping", "gamma": 0.99}):
            for ends in (False, True):
                row = [added(count, text, ends=ends, **settings) for count in (16, 64, 256, 1024, 4096)]
                print(
                    f"{text:42}{settings['reward']:12}{'1/64' if ends else '-':>6}"
                    + "".join(f"{x:9.3f}" for x in row)
                )
    print(f"microseconds for each environment and step; target: {TARGET}")


if __name__ == "__main__":
    main()
