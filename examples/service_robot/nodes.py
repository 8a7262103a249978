#!/usr/bin/env python3
"""The same robot as nodes of ROS 1: nodes.py plant|perception|planner|controller|judge; see experiment.launch.

They go in lockstep: the plant steps when the answer to its last state has come, so that the drive is that of
run.py, whatever the machine is busy with. Topics are latched, and nodes may start in any order.

    plant -- truth --> perception -- view --> planner -- path --> controller -- command --> plant
                                              planner <-- reference -- controller
"""

from __future__ import annotations

import sys
import threading
import time
from typing import TYPE_CHECKING

import numpy as np
import rospy
from geometry_msgs.msg import PointStamped, Pose, PoseArray, PoseStamped, TwistStamped
from nav_msgs.msg import Path
from rosgraph_msgs.msg import Clock
from rtamt_msgs.msg import FloatStamped, Verdict

from controller import Controller
from faults import draw
from monitors import COMPONENTS, NAMES
from perception import Perception
from planner import Plan, Planner
from sim import PERIOD, State, World

if TYPE_CHECKING:
    from collections.abc import Mapping

BEGIN = 1.0  # s of simulated time; ROS reads 0 as no time
SIGNALS = {
    "plant": ("agent_distance", "obstacle_distance", "region_distance"),
    "perception": ("pose_error", "agent_error", "obstacle_error", "region_error"),
    "planner": ("path_to_agent", "path_to_obstacle", "path_to_region"),
    "controller": ("tracking_error",),
}


class Component:
    """What the nodes of the robot have in common: the seed, the fault, and their signals."""

    def __init__(self, name: str) -> None:
        chosen = rospy.get_param("fault", "none")
        self.seed = int(rospy.get_param("seed", 0))
        self.fault = draw(None if chosen == "none" else chosen, self.seed)
        self.lock = threading.Lock()
        self._signals = {
            signal: rospy.Publisher(f"signals/{signal}", FloatStamped, queue_size=0, latch=True)
            for signal in SIGNALS[name]
        }

    def publish_signals(self, at: float, signals: Mapping[str, float]) -> None:
        """Publish the signals that the monitors read."""
        for signal, value in signals.items():
            message = FloatStamped(value=value)
            message.header.stamp = stamp(at)
            self._signals[signal].publish(message)


class PlantNode(Component):
    """The world: publishes what is true, and takes the commands to the base."""

    def __init__(self) -> None:
        super().__init__("plant")
        self.world = World(self.seed, self.fault)
        self.clock = rospy.Publisher("/clock", Clock, queue_size=1, latch=True)
        self.truth = rospy.Publisher("truth", PoseArray, queue_size=0, latch=True)
        self.answer: TwistStamped | None = None
        self.answered = threading.Condition()
        rospy.Subscriber("command", TwistStamped, self.take, tcp_nodelay=True)

    def take(self, message: TwistStamped) -> None:
        """Take a command to the base."""
        with self.answered:
            self.answer = message
            self.answered.notify()

    def run(self) -> None:
        """Step until the drive is over."""
        pause = PERIOD / float(rospy.get_param("speed", 1.0))
        end = float(rospy.get_param("duration", 60.0))
        self.wait_for_monitors()
        while not rospy.is_shutdown() and self.world.time < end:
            due = time.monotonic() + pause
            at = self.world.time
            self.clock.publish(Clock(clock=stamp(at)))
            self.publish_signals(at, self.world.signals())
            self.truth.publish(poses(at, self.world.truth))
            with self.answered:
                while not (self.answer and time_of(self.answer) == at) and not rospy.is_shutdown():
                    self.answered.wait(0.1)
            if self.answer is not None:
                twist = self.answer.twist
                self.world.step(np.array([twist.linear.x, twist.linear.y, twist.angular.z]))
            time.sleep(max(0.0, due - time.monotonic()))
        time.sleep(1.0)  # the monitors' last words

    def wait_for_monitors(self) -> None:
        """Wait until somebody listens to the first signals, so that no sample is lost to them."""
        while not rospy.is_shutdown() and not all(p.get_num_connections() for p in self._signals.values()):
            time.sleep(0.05)


class PerceptionNode(Component):
    """Publishes what is perceived; its signals compare it with the truth, which only a simulation knows."""

    def __init__(self) -> None:
        super().__init__("perception")
        self.perception = Perception(self.seed, self.fault)
        self.view = rospy.Publisher("view", PoseArray, queue_size=0, latch=True)
        rospy.Subscriber("truth", PoseArray, self.take, tcp_nodelay=True)

    def take(self, message: PoseArray) -> None:
        """Perceive a state."""
        at, truth = time_of(message), state(message)
        view = self.perception.observe(at, truth)
        self.publish_signals(at, self.perception.signals(truth, view))
        self.view.publish(poses(at, view))


class PlannerNode(Component):
    """Plans when it knows the view of this sample and the reference of the one before."""

    def __init__(self) -> None:
        super().__init__("planner")
        known = Perception(self.seed)  # its map, which no fault changes
        self.planner = Planner(World(self.seed).goal, known.obstacles, known.regions, self.seed, self.fault)
        self.path = rospy.Publisher("path", Path, queue_size=0, latch=True)
        self.references: dict[float, np.ndarray] = {}
        self.views: dict[float, State] = {}
        rospy.Subscriber("reference", PointStamped, self.take_reference, tcp_nodelay=True)
        rospy.Subscriber("view", PoseArray, self.take_view, tcp_nodelay=True)

    def take_reference(self, message: PointStamped) -> None:
        """Take the point where the robot should be."""
        with self.lock:
            self.references[time_of(message)] = np.array([message.point.x, message.point.y])
            self.plan()

    def take_view(self, message: PoseArray) -> None:
        """Take what is perceived."""
        with self.lock:
            self.views[time_of(message)] = state(message)
            self.plan()

    def plan(self) -> None:
        """Publish the waypoints, if all that they depend on is there."""
        for at in [at for at in self.views if before(at) in self.references]:
            view = self.views.pop(at)
            plan = self.planner.plan(at, view, self.references.pop(before(at)))
            self.publish_signals(at, self.planner.signals(view))
            message = Path()
            message.header.stamp = stamp(at)
            for x, y in plan.waypoints:
                waypoint = PoseStamped()
                waypoint.header.stamp = stamp(plan.made)
                waypoint.pose.position.x, waypoint.pose.position.y = x, y
                message.poses.append(waypoint)
            self.path.publish(message)


class ControllerNode(Component):
    """Follows the path of this sample from the view of this sample."""

    def __init__(self) -> None:
        super().__init__("controller")
        self.controller = Controller(World(self.seed).start, self.fault)
        self.command = rospy.Publisher("command", TwistStamped, queue_size=0, latch=True)
        self.reference = rospy.Publisher("reference", PointStamped, queue_size=0, latch=True)
        self.views: dict[float, State] = {}
        self.plans: dict[float, Plan] = {}
        self.publish_reference(before(0.0))
        rospy.Subscriber("view", PoseArray, self.take_view, tcp_nodelay=True)
        rospy.Subscriber("path", Path, self.take_path, tcp_nodelay=True)

    def take_view(self, message: PoseArray) -> None:
        """Take what is perceived."""
        with self.lock:
            self.views[time_of(message)] = state(message)
            self.follow()

    def take_path(self, message: Path) -> None:
        """Take the waypoints."""
        points = np.array([(at.pose.position.x, at.pose.position.y) for at in message.poses])
        with self.lock:
            self.plans[time_of(message)] = Plan(time_of(message.poses[0]), points)
            self.follow()

    def follow(self) -> None:
        """Publish the command to the base, if all that it depends on is there."""
        for at in [at for at in self.views if at in self.plans]:
            command = self.controller.follow(at, self.views.pop(at), self.plans.pop(at))
            self.publish_signals(at, self.controller.signals())
            self.publish_reference(at)
            message = TwistStamped()
            message.header.stamp = stamp(at)
            message.twist.linear.x, message.twist.linear.y, message.twist.angular.z = command
            self.command.publish(message)

    def publish_reference(self, at: float) -> None:
        """Publish the point where the robot should be."""
        message = PointStamped()
        message.header.stamp = stamp(at)
        message.point.x, message.point.y = self.controller.reference
        self.reference.publish(message)


class PredicateSemantics:
    """Logs violated specifications, and names the component whose specification was violated first."""

    def __init__(self) -> None:
        self.fallen: dict[str, float] = {}
        self.lock = threading.Lock()
        for name in NAMES:
            rospy.Subscriber(f"robustness/{name}/verdict", Verdict, self.take, name, tcp_nodelay=True)

    def take(self, message: Verdict, name: str) -> None:
        """Take a verdict."""
        if message.verdict != Verdict.VIOLATED:
            return
        with self.lock:
            if name in self.fallen:
                return
            first = name in COMPONENTS and not self.fallen.keys() & set(COMPONENTS)
            self.fallen[name] = time_of(message)
            print(
                f"{name}: violated at {self.fallen[name]:.1f} s" + (", the first component" if first else ""),
                flush=True,
            )


def stamp(at: float) -> rospy.Time:
    """Return a time of the simulation (s) as one of ROS."""
    return rospy.Time.from_sec(BEGIN + at)


def time_of(message: rospy.Message) -> float:
    """Return the time (s) of the simulation in a message's header."""
    return round(message.header.stamp.to_sec() - BEGIN, 6)


def before(at: float) -> float:
    """Return the time of the sample before."""
    return round(at - PERIOD, 6)


def poses(at: float, held: State) -> PoseArray:
    """Return a message of a state: the robot first, the agents after it."""
    message = PoseArray(poses=[Pose() for _ in range(1 + len(held.agents))])
    message.header.stamp = stamp(at)
    for pose, (x, y) in zip(message.poses, [held.position, *held.agents], strict=True):
        pose.position.x, pose.position.y = x, y
        pose.orientation.w = 1.0
    message.poses[0].orientation.z = np.sin(held.pose[2] / 2)
    message.poses[0].orientation.w = np.cos(held.pose[2] / 2)
    return message


def state(message: PoseArray) -> State:
    """Return the state in a message."""
    robot = message.poses[0]
    heading = 2 * np.arctan2(robot.orientation.z, robot.orientation.w)
    agents = np.array([(pose.position.x, pose.position.y) for pose in message.poses[1:]])
    return State(np.array([robot.position.x, robot.position.y, heading]), agents)


NODES = {
    "perception": PerceptionNode,
    "planner": PlannerNode,
    "controller": ControllerNode,
    "judge": PredicateSemantics,
}


def main() -> None:
    """Run the node that the command line names."""
    name = rospy.myargv(sys.argv)[1]
    rospy.init_node(name)
    if name == "plant":
        PlantNode().run()
        return
    node = NODES[name]()  # kept: its subscriptions live as long as it does
    rospy.spin()
    del node


if __name__ == "__main__":
    main()
