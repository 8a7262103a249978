"""Turn a CommonRoad scenario into a recording for ``examples/agents/commonroad.stl``.

    python commonroad_trace.py make tailgating.xml
    python commonroad_trace.py convert tailgating.xml tailgating.csv --ego 100 --limit 33.3

``make`` writes a scenario of two lanes along the x axis: a car approaches a slower one and brakes late. ``convert``
reads scenarios whose roads run along the x axis. Needs ``pip install commonroad-io``.
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path
from typing import Any

import numpy as np
from commonroad.common.common_lanelet import LaneletType
from commonroad.common.file_reader import CommonRoadFileReader
from commonroad.common.file_writer import CommonRoadFileWriter, OverwriteExistingFile
from commonroad.common.util import FileFormat
from commonroad.geometry.obstacle_shapes.rect_obstacle_shape import RectObstacleShape
from commonroad.planning.planning_problem import PlanningProblemSet
from commonroad.prediction.prediction import TrajectoryPrediction
from commonroad.scenario.lanelet import Lanelet
from commonroad.scenario.obstacle import DynamicObstacle, ObstacleType
from commonroad.scenario.scenario import Scenario
from commonroad.scenario.state import InitialState, KSState
from commonroad.scenario.trajectory import Trajectory

STEP, STEPS = 0.1, 120
LENGTH = 4.5


def car(number: int, x: float, y: float, speeds: Any) -> DynamicObstacle:
    """Return a car that drives along the x axis with given speeds."""
    shape = RectObstacleShape(length=LENGTH, width=2.0)
    places = x + STEP * np.concatenate([[0.0], np.cumsum(speeds[:-1])])
    settings = {"orientation": 0.0}
    start = InitialState(
        time_step=0, position=np.array([x, y]), velocity=speeds[0], acceleration=0.0, yaw_rate=0.0, slip_angle=0.0,
        **settings,
    )  # fmt: skip
    later = [
        KSState(
            time_step=k, position=np.array([places[k], y]), velocity=speeds[k], steering_angle=0.0, **settings
        )
        for k in range(1, len(speeds))
    ]
    prediction = TrajectoryPrediction(Trajectory(1, later), shape)
    return DynamicObstacle(number, ObstacleType.CAR, shape, start, prediction)


def scenario() -> Scenario:
    """Return the scenario of ``make``."""
    made = Scenario(STEP)
    for number, y in (1, 0.0), (2, 3.5):
        left, centre, right = (np.array([[0.0, y + d], [600.0, y + d]]) for d in (1.75, 0.0, -1.75))
        made.add_objects(Lanelet(left, centre, right, number, lanelet_type={LaneletType.INTERSTATE}))
    t = STEP * np.arange(STEPS)
    made.add_objects(
        car(100, 10.0, 0.0, np.clip(31 - 1.5 * np.maximum(t - 5, 0), 24, None))
    )  # it brakes late
    made.add_objects(car(101, 70.0, 0.0, np.full(STEPS, 24.0)))
    made.add_objects(car(102, 0.0, 3.5, np.full(STEPS, 30.0)))
    return made


def rows(given: Scenario, ego: int, limit: float) -> list[dict[str, Any]]:
    """Return a row for each time step of the ego vehicle; cells of vehicles that are absent are empty."""
    network = given.lanelet_network
    cars = {each.obstacle_id: each for each in given.dynamic_obstacles}
    found, time = [], 0
    while (own := cars[ego].state_at_time(time)) is not None:
        lane = network.find_lanelet_by_position([own.position])[0]
        row: dict[str, Any] = {"time": f"{time * given.dt:.1f}"}
        row |= {"ego.front": own.position[0] + cars[ego].obstacle_shape.length / 2, "ego.v": own.velocity}
        row |= {"ego.a": acceleration(cars[ego], time, given.dt), "limit": limit, "sight_limit": limit}
        for number in sorted(cars.keys() - {ego}):
            state = cars[number].state_at_time(time)
            cells = dict.fromkeys((f"vehicle_{number}.{name}" for name in ("rear", "v", "a", "in_lane")), "")
            if state is not None:
                there = network.find_lanelet_by_position([state.position])[0]
                values = (
                    state.position[0] - cars[number].obstacle_shape.length / 2,
                    state.velocity,
                    acceleration(cars[number], time, given.dt),
                    int(bool({*lane} & {*there})),
                )
                cells = dict(zip(cells, values, strict=True))
            row |= cells
        found.append({name: f"{x:.6g}" if isinstance(x, float) else x for name, x in row.items()})
        time += 1
    return found


def acceleration(vehicle: DynamicObstacle, time: int, step: float) -> float:
    """Return the acceleration since the step before; trajectories need not have one."""
    before = vehicle.state_at_time(time - 1)
    return 0.0 if before is None else float(vehicle.state_at_time(time).velocity - before.velocity) / step


def main() -> None:
    """Make or convert a scenario."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    tasks = parser.add_subparsers(dest="task", required=True)
    tasks.add_parser("make").add_argument("scenario", type=Path)
    convert = tasks.add_parser("convert")
    convert.add_argument("scenario", type=Path)
    convert.add_argument("output", type=Path)
    convert.add_argument("--ego", type=int, required=True)
    convert.add_argument("--limit", type=float, required=True, help="the speed limit in m/s")
    given = parser.parse_args()
    if given.task == "make":
        writer = CommonRoadFileWriter(
            scenario(), PlanningProblemSet(), "rtamt", "", "", set(), file_format=FileFormat.XML
        )
        writer.write_to_file(str(given.scenario), OverwriteExistingFile.ALWAYS)
        return
    read, _ = CommonRoadFileReader(given.scenario).open()
    table = rows(read, given.ego, given.limit)
    with given.output.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, table[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
    print(f"{len(table)} samples")


if __name__ == "__main__":
    main()
