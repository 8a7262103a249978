"""The world: a room with a desk, people who walk, and an omnidirectional base. What is true is known here alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from geometry import to_boxes, to_discs, turned, wrapped

if TYPE_CHECKING:
    from faults import Fault

PERIOD = 0.1  # s, from sample to sample
RADIUS = 0.225  # m, of the base; the paper's Table 3: footprint 450 mm
MAX_SPEED = 0.22  # m/s, of the base; the paper's Table 3
MAX_TURN = 1.0  # rad/s
LAG = 0.2  # s, in which a drive does two thirds of what it is commanded
STUCK_SPEED = 0.05  # m/s to the side, of a stuck drive

PERSON = 0.25  # m, the radius of an agent
COURTESY = 0.9  # m: an agent stands still for a robot that is so near and ahead
ROOM = (12.0, 6.0)  # m

#: Boxes: left, bottom, right, top. The desk, a shelf, a plant, and the walls.
OBSTACLES = np.array(
    [
        (5.0, 2.3, 6.4, 3.7),
        (1.6, 5.4, 3.4, 6.0),
        (8.8, 0.0, 9.6, 0.7),
        (-0.2, -0.2, 0.0, ROOM[1] + 0.2),
        (ROOM[0], -0.2, ROOM[0] + 0.2, ROOM[1] + 0.2),
        (-0.2, -0.2, ROOM[0] + 0.2, 0.0),
        (-0.2, ROOM[1], ROOM[0] + 0.2, ROOM[1] + 0.2),
    ]
)
#: Prohibited regions: nothing stands there, and yet the robot must not enter.
REGIONS = np.array([(4.6, 5.3, 7.0, 6.0), (4.6, 0.0, 7.0, 0.7)])
#: Where agents walk to and fro, and how fast (m/s).
WALKS = (
    ((2.0, 0.6), (2.0, 4.6), 0.20),
    ((8.0, 5.4), (8.0, 0.7), 0.25),
    ((10.8, 4.6), (7.2, 5.2), 0.15),
)


@dataclass(frozen=True)
class State:
    """The robot's pose (x, y in m, heading in rad) and the agents' centres (m, 2), true or perceived."""

    pose: np.ndarray
    agents: np.ndarray

    @property
    def position(self) -> np.ndarray:
        """Where the robot's centre is."""
        return self.pose[:2]


class World:
    """The room in motion: ``step`` takes the velocity that the base is commanded, and goes on by one period."""

    def __init__(self, seed: int, fault: Fault | None = None) -> None:
        rng = np.random.default_rng([seed, 0])
        self.fault = fault
        self.time = 0.0
        self.start = np.array([1.0, 3.0 + rng.uniform(-0.5, 0.5)])
        self.goal = np.array([10.5, 3.0 + rng.uniform(-0.5, 0.5)])
        self._pose = np.array([*self.start, 0.0])
        self._velocity = np.zeros(3)  # of the base, in its own frame: forward, left, turn
        self._ends = np.array([(first, second) for first, second, _ in WALKS])
        self._speeds = np.array([speed for *_, speed in WALKS])
        share = rng.uniform(0.0, 1.0, (len(WALKS), 1))
        self._agents = self._ends[:, 0] + share * (self._ends[:, 1] - self._ends[:, 0])
        self._towards = rng.integers(0, 2, len(WALKS))

    @property
    def truth(self) -> State:
        """The true state."""
        return State(self._pose.copy(), self._agents.copy())

    def step(self, command: np.ndarray) -> None:
        """Go on by a period; ``command``: forward, left (m/s) and turn (rad/s), in the robot's own frame."""
        self._walk()
        self._drive(np.asarray(command, dtype=float))
        self.time = round(self.time + PERIOD, 6)

    def _drive(self, command: np.ndarray) -> None:
        command = np.append(limited(command[:2], MAX_SPEED), np.clip(command[2], -MAX_TURN, MAX_TURN))
        self._velocity += (command - self._velocity) * (PERIOD / LAG)
        if self.fault and self.fault.active("controller", self.time) == "stuck drive":
            self._velocity[1] = self.fault.side * STUCK_SPEED
        position = self._pose[:2] + turned(self._velocity[:2], self._pose[2]) * PERIOD
        self._pose[:2] = _stopped(position)
        self._pose[2] = wrapped(self._pose[2] + self._velocity[2] * PERIOD)

    def _walk(self) -> None:
        for i, speed in enumerate(self._speeds):
            way = self._ends[i, self._towards[i]] - self._agents[i]
            far = np.hypot(*way)
            if far < speed * PERIOD:
                self._towards[i] = 1 - self._towards[i]
                continue
            robot = self._pose[:2] - self._agents[i]
            near = np.hypot(*robot) - PERSON - RADIUS < COURTESY
            if not (near and robot @ way > 0):
                self._agents[i] += way / far * speed * PERIOD

    def signals(self) -> dict[str, float]:
        """Return how far the robot's centre truly is from the nearest of each kind, to its edge (m)."""
        here = self._pose[None, :2]
        return {
            "agent_distance": float(to_discs(here, self._agents, PERSON).min()),
            "obstacle_distance": float(to_boxes(here, OBSTACLES).min()),
            "region_distance": float(to_boxes(here, REGIONS).min()),
        }


def limited(vector: np.ndarray, longest: float) -> np.ndarray:
    """Return a vector, shortened if it is longer than that."""
    size = float(np.hypot(*vector))
    return vector if size <= longest else vector * (longest / size)


def _stopped(position: np.ndarray) -> np.ndarray:
    """Return where the base comes to stand: its body cannot enter an obstacle, it slides along."""
    for left, bottom, right, top in OBSTACLES:
        nearest = np.clip(position, (left, bottom), (right, top))
        gap = position - nearest
        far = float(np.hypot(*gap))
        if 0.0 < far < RADIUS:
            position = nearest + gap * (RADIUS / far)
    return position
