"""Drive in highway-env and record what the driving pack reads: ``python highway.py drive.csv [--seed 1]``.

Needs ``pip install highway-env``. The car keeps its lane and accelerates, whatever is ahead.
"""

from __future__ import annotations

import argparse
import csv
from math import inf
from pathlib import Path
from typing import Any

import gymnasium
import highway_env  # noqa: F401 - registers the environments

CONFIG = {"policy_frequency": 10, "simulation_frequency": 10, "duration": 20, "vehicles_count": 30}
COLUMNS = ("time", "ego_speed", "ego_acceleration", "speed_limit", "lead_gap", "lead_speed")
FASTER = 3


def sample(env: Any) -> dict[str, float]:
    """Return the columns of the driving pack, without the time."""
    car = env.vehicle
    ahead, _ = env.road.neighbour_vehicles(car)
    gap = inf if ahead is None else ahead.position[0] - car.position[0] - (ahead.LENGTH + car.LENGTH) / 2
    return {
        "ego_speed": car.speed,
        "ego_acceleration": car.action["acceleration"],
        "speed_limit": env.road.network.get_lane(car.lane_index).speed_limit,
        "lead_gap": gap,
        "lead_speed": 0.0 if ahead is None else ahead.speed,
    }


def main() -> None:
    """Record one episode."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("output", type=Path)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    env = gymnasium.make("highway-v0", config=CONFIG)
    env.reset(seed=given.seed)
    rows, ended = [sample(env.unwrapped)], False
    while not ended:
        _, _, terminated, truncated, info = env.step(FASTER)
        rows.append(sample(env.unwrapped))
        ended = terminated or truncated
    with given.output.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        for number, row in enumerate(rows):
            table.writerow({"time": f"{number / 10:.1f}", **{name: f"{x:.4g}" for name, x in row.items()}})
    print(f"{len(rows)} samples; {'a collision' if info['crashed'] else 'no collision'}")


if __name__ == "__main__":
    main()
