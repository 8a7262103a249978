"""The planner: rapidly-exploring random trees (LaValle, Kuffner 2000) around everything that is perceived."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from geometry import along, length, to_boxes, to_discs
from sim import PERSON, ROOM

if TYPE_CHECKING:
    from collections.abc import Callable

    from faults import Fault
    from sim import State

CLEARANCE = 0.5  # m, that a new path keeps from everything
TOO_NEAR = 0.4  # m: a path that has come so near to somebody is given up
AGAIN = 5.0  # s, after which a shorter path is looked for
GAIN = 0.02  # m, by which it must be shorter
RETRY = 0.3  # s, between two attempts at a path that is blocked
BRANCH = 0.6  # m, of the tree
NODES = 600  # of a tree, at most
CUT_OFF = 1  # node of a tree that a fault cuts off
SPACING = 0.1  # m, between waypoints
TO_GOAL, TO_OLD_PATH = 0.15, 0.4  # shares of samples


@dataclass(frozen=True)
class Plan:
    """Waypoints (n, 2) that lie ahead, and when their path was made (s), which identifies the path."""

    made: float
    waypoints: np.ndarray


class Planner:
    """Keeps a path as long as it is clear; asked at every sample."""

    def __init__(
        self,
        goal: np.ndarray,
        obstacles: np.ndarray,
        regions: np.ndarray,
        seed: int,
        fault: Fault | None = None,
    ) -> None:
        self._goal = goal
        self._obstacles, self._regions = obstacles, regions
        self._boxes = np.concatenate([obstacles, regions])
        self._rng = np.random.default_rng([seed, 2])
        self._fault = fault
        self._plan: Plan | None = None
        self._arrives = False  # whether the path leads to the goal
        self._next = 0.0  # when the next tree may grow

    def plan(self, time: float, view: State, reference: np.ndarray) -> Plan:
        """Return the waypoints ahead of the reference, the point on the path where the robot should be now.

        A new path begins there, not at the robot: it is no excuse for a controller that has left the old one.
        """
        old = reference[None] if self._plan is None else self._ahead(reference)
        self._plan = Plan(time if self._plan is None else self._plan.made, old)
        blocked = not self._arrives or self._clearance(old, view.agents).min() < TOO_NEAR
        if time >= self._next or (blocked and self._next - time > RETRY):
            self._renew(time, view.agents, blocked=blocked)
        return self._plan

    def _renew(self, time: float, agents: np.ndarray, *, blocked: bool) -> None:
        """Look for a path that is shorter; where the old one is blocked for any, or else wait."""
        assert self._plan is not None
        old = self._plan.waypoints
        cut = self._fault is not None and self._fault.active("planner", time) is not None
        found = self._grow(old[0], agents, old, CUT_OFF if cut else NODES, checked=not cut)
        if found is not None and (blocked or length(found) < length(old) - GAIN):
            self._plan = Plan(time, along(found, SPACING))
            self._arrives = True
        elif blocked:
            self._plan = Plan(time, old[:1])
            self._arrives = False
        self._next = time + (AGAIN if self._arrives else RETRY)

    def signals(self, view: State) -> dict[str, float]:
        """Return how near the waypoints come to what is perceived (m), the least of each kind."""
        assert self._plan is not None, "asked after the first plan"
        points = self._plan.waypoints
        return {
            "path_to_agent": float(to_discs(points, view.agents, PERSON).min()),
            "path_to_obstacle": float(to_boxes(points, self._obstacles).min()),
            "path_to_region": float(to_boxes(points, self._regions).min()),
        }

    def _ahead(self, reference: np.ndarray) -> np.ndarray:
        """Return the reference and the waypoints after it."""
        assert self._plan is not None
        points = self._plan.waypoints
        if len(points) == 1:
            return points
        nearest = int(np.hypot(*(points[:8] - reference).T).argmin())
        passed = nearest
        if nearest + 1 < len(points):
            onward = points[nearest + 1] - points[nearest]
            passed = nearest + int((reference - points[nearest]) @ onward > 0)
        return np.concatenate([reference[None], points[min(passed, len(points) - 1) :]])

    def _clearance(self, points: np.ndarray, agents: np.ndarray) -> np.ndarray:
        return np.minimum(
            to_boxes(points, self._boxes).min(axis=1), to_discs(points, agents, PERSON).min(axis=1)
        )

    # ---- the tree --------------------------------------------------------------------------------

    def _grow(
        self, start: np.ndarray, agents: np.ndarray, old: np.ndarray, most: int, *, checked: bool
    ) -> np.ndarray | None:
        """Return a path from the start to the goal; None where no tree of ``most`` nodes has reached it."""
        # Who stands too near already may go wherever it is no nearer.
        needed = min(CLEARANCE, float(self._clearance(start[None], agents)[0]) - 1e-9)

        def clear(end: np.ndarray, begin: np.ndarray) -> bool:
            points = along(np.array([begin, end]), 0.08)
            close = np.hypot(*(points - start).T) < 0.5
            return bool((self._clearance(points, agents) >= np.where(close, needed, CLEARANCE)).all())

        if checked and clear(self._goal, start):
            return np.array([start, self._goal])
        nodes = np.empty((most + 1, 2))
        nodes[0] = start
        parents = [0]
        for choice in self._rng.random((4 * most, 3)):
            if len(parents) > most:
                break
            target = self._sample(choice, old)
            near = int(np.hypot(*(nodes[: len(parents)] - target).T).argmin())
            way = target - nodes[near]
            far = float(np.hypot(*way))
            if far < 1e-6:
                continue
            node = nodes[near] + way * min(1.0, BRANCH / far)
            if not clear(node, nodes[near]):
                continue
            nodes[len(parents)] = node
            parents.append(near)
            if checked and np.hypot(*(self._goal - node)) < 3 * BRANCH and clear(self._goal, node):
                path = np.array([*_branch(nodes, parents, len(parents) - 1), self._goal])
                return self._shortened(path, clear)
        if checked:
            return None
        last = int(np.hypot(*(nodes[: len(parents)] - self._goal).T).argmin())
        return np.array([*_branch(nodes, parents, last), self._goal])

    def _sample(self, choice: np.ndarray, old: np.ndarray) -> np.ndarray:
        """Return where to grow to: the goal, a waypoint of the old path, or anywhere in the room."""
        if choice[0] < TO_GOAL:
            return self._goal
        if choice[0] < TO_GOAL + TO_OLD_PATH and len(old) > 1:
            return old[int(choice[1] * len(old))]
        return choice[1:] * ROOM

    def _shortened(self, path: np.ndarray, clear: Callable[[np.ndarray, np.ndarray], bool]) -> np.ndarray:
        """Return the path with detours left out."""
        for first, second in self._rng.random((30, 2)):
            dense = along(path, 0.3)
            i, j = sorted((int(first * len(dense)), int(second * len(dense))))
            if j - i > 1 and clear(dense[j], dense[i]):
                path = np.concatenate([dense[: i + 1], dense[j:]])
        return path


def _branch(nodes: np.ndarray, parents: list[int], last: int) -> list[np.ndarray]:
    """Return the nodes from the root of the tree to the last."""
    path = [nodes[last]]
    while last:
        last = parents[last]
        path.append(nodes[last])
    return path[::-1]
