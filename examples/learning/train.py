"""Train PPO on the task of ``reach.py`` with and without rewards from the requirement; write the learning curves.

    python train.py [--steps 40000] [--seeds 1 2 3] [--output curves.csv]

Needs ``pip install stable-baselines3 'rtamt[learning]'``.
"""

from __future__ import annotations

import argparse
import csv
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gymnasium
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback

import rtamt
from reach import SIGNALS, Reach
from rtamt.learning import RobustnessReward

if TYPE_CHECKING:
    from collections.abc import Callable

GAMMA = 0.99
LIMIT = 60
REQUIREMENT = rtamt.load(Path(__file__).with_name("reach.stl"))
#: The potential: how near the goal is, unless the obstacle is nearer.
NEARER = rtamt.parse("goal <= 0.5 and clear >= 0")


def sparse() -> gymnasium.Env:
    """Return the task with its own reward."""
    return gymnasium.wrappers.TimeLimit(Reach(), LIMIT)


def shaped() -> gymnasium.Env:
    """Return the task with its own reward, and potentials that are robustness."""
    return RobustnessReward(sparse(), NEARER, SIGNALS, reward="shaping", gamma=GAMMA, terminate=False)


def robust() -> gymnasium.Env:
    """Return the task with rewards that add up to the robustness of the requirement."""
    return RobustnessReward(sparse(), REQUIREMENT, SIGNALS, reward="interval")


VARIANTS: dict[str, Callable[[], gymnasium.Env]] = {
    "own reward": sparse,
    "with shaping": shaped,
    "interval as reward": robust,
}


def satisfied(model: Any, episodes: int = 20) -> float:
    """Return the share of episodes that satisfy the requirement, evaluated on their traces."""
    env, found = sparse(), 0
    for seed in range(episodes):
        observation, info = env.reset(seed=10_000 + seed)
        rows, ended = [info], False
        while not ended:
            action, _ = model.predict(observation, deterministic=True)
            observation, _, terminated, truncated, info = env.step(action)
            rows.append(info)
            ended = terminated or truncated
        columns = {name: [row[name] for row in rows] for name in REQUIREMENT.input_names}
        found += REQUIREMENT.evaluate({"time": range(len(rows)), **columns}).robustness > 0
    return found / episodes


class Curve(BaseCallback):
    """Evaluates the policy after every rollout."""

    def __init__(self) -> None:
        super().__init__()
        self.points: list[tuple[int, float]] = []

    def _on_rollout_start(self) -> None:
        self.points.append((self.num_timesteps, satisfied(self.model)))

    def _on_step(self) -> bool:
        return True


def main() -> None:
    """Train each variant with each seed."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--steps", type=int, default=40_000)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--output", type=Path, default=Path("curves.csv"))
    given = parser.parse_args()
    torch.set_num_threads(1)
    with given.output.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["variant", "seed", "steps", "satisfied"])
        for seed in given.seeds:
            for name, make in VARIANTS.items():
                start = time.perf_counter()
                curve = Curve()
                model = PPO("MlpPolicy", make(), gamma=GAMMA, seed=seed, n_steps=1024, device="cpu")
                model.learn(given.steps, callback=curve)
                curve.points.append((model.num_timesteps, satisfied(model)))
                rows.writerows([name, seed, *point] for point in curve.points)
                file.flush()
                print(f"{name}, seed {seed}: {curve.points[-1][1]:.0%}, {time.perf_counter() - start:.0f} s")


if __name__ == "__main__":
    main()
