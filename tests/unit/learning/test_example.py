"""The task of ``examples/learning``, and the learning curves that were recorded."""

from __future__ import annotations

import csv
import runpy
from pathlib import Path

import gymnasium
import pytest
from gymnasium.utils.env_checker import check_env

import rtamt
from rtamt.learning import RobustnessReward

FOLDER = Path(__file__).parents[3] / "examples" / "learning"


@pytest.fixture(scope="module")
def task():
    return runpy.run_path(str(FOLDER / "reach.py"))


@pytest.mark.parametrize(("way", "satisfied"), [([(1, 1)], False), ([(1, 0)] * 16 + [(0, 1)] * 20, True)])
def test_rewards_end_with_the_robustness_of_the_way(task, way, satisfied):
    check_env(task["Reach"](), skip_render_check=True)
    spec = rtamt.load(FOLDER / "reach.stl")
    env = RobustnessReward(
        gymnasium.wrappers.TimeLimit(task["Reach"](), 60), spec, task["SIGNALS"], reward="interval"
    )
    _, info = env.reset(seed=1)
    rows, total, ended, steps = [info], sum(info["interval"]) / 2, False, 0
    while not ended:
        _, reward, terminated, truncated, info = env.step(way[min(steps, len(way) - 1)])
        rows.append(info)
        total, ended, steps = total + reward, terminated or truncated, steps + 1
    data = {"time": range(len(rows)), **{name: [row[name] for row in rows] for name in spec.input_names}}
    assert info["satisfied"] is satisfied
    assert total == pytest.approx(spec.evaluate(data).robustness)
    assert (total > 0) is satisfied


def test_the_curves_have_every_seed():
    with (FOLDER / "curves.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert {(row["variant"], row["seed"]) for row in rows} == {
        (variant, seed)
        for variant in ("own reward", "with shaping", "interval as reward")
        for seed in ("1", "2", "3")
    }
    assert {float(row["satisfied"]) for row in rows if row["variant"] == "own reward"} == {0.0}
