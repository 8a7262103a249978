"""The ROS 2 node on rclpy: watches a specification over topics, publishes robustness, verdicts, diagnostics.

    ros2 run rtamt4ros2 ros_stl_monitor spec.stl --period 1 --unit s

What it subscribes and publishes is in the specification. Arguments may be parameters as well: spec, period,
unit, time, stale, verdict, at, set; and quality of service: reliability, durability, depth.
"""

import sys
import time

import rclpy
from builtin_interfaces.msg import Time
from rcl_interfaces.msg import ParameterDescriptor
from rclpy._rclpy_pybind11 import RCLError  # rclpy offers it nowhere else
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.utilities import remove_ros_args

from rtamt import load
from rtamt.errors import StlError
from rtamt.metrics import exported
from rtamt.ros.binding import MessageType
from rtamt.ros.dds.participant import Quality
from rtamt.ros.metrics import note
from rtamt.ros.monitor import PAUSE
from rtamt.ros.options import DEFAULTS, options, parser
from rtamt.ros.publisher import DIAGNOSTICS, Publisher, diagnostic

PROGRAM = "ros_stl_monitor"
DIAGNOSTICS_EVERY = 1.0  # seconds of wall time


class Monitor(Node):
    """Carries messages to a monitor, and what comes out to topics."""

    def __init__(self, arguments, metrics):
        self.metrics = metrics
        name = (load(arguments.spec).name if arguments.spec else None) or "stl_monitor"
        super().__init__(name)
        # The command line makes a number of 1, a launch file may make a text of it: both are taken.
        chosen = {
            key: self.declare_parameter(key, value, ParameterDescriptor(dynamic_typing=True)).value
            for key, value in DEFAULTS.items()
        }
        self.monitor = options(arguments, chosen).monitor()
        quality = self.quality()
        self.outbox = Publisher(self.monitor.binding, MessageType.load, stamp, lambda level: bytes([level]))
        # Who asks for less hears a reliable publisher, too; not the other way round.
        offered = QoSProfile(
            depth=quality.depth, reliability=ReliabilityPolicy.RELIABLE, durability=quality.durability
        )
        self.senders = {
            topic: self.create_publisher(cls, topic, offered) for topic, cls in self.outbox.topics.items()
        }
        array = diagnostic("DiagnosticArray").load()
        self.diagnostics = self.create_publisher(array, DIAGNOSTICS, offered)
        self.due = 0.0
        for topic, kind in {known.topic: known.type for known in self.monitor.binding.inputs}.items():
            self.create_subscription(
                self.outbox.classes[kind],
                topic,
                lambda message, topic=topic: self.receive(topic, message),
                quality,
            )

    def quality(self):
        """Return the quality of service that is asked of topics, from parameters."""
        default = Quality()
        chosen = Quality(
            self.declare_parameter("reliability", default.reliability).value,
            self.declare_parameter("durability", default.durability).value,
            self.declare_parameter("depth", default.depth).value,
        )
        return QoSProfile(
            depth=chosen.depth,
            reliability=ReliabilityPolicy[chosen.reliability.upper()],
            durability=DurabilityPolicy[chosen.durability.upper()],
        )

    def now(self):
        """Return the time in nanoseconds, simulated where use_sim_time is set."""
        return self.get_clock().now().nanoseconds

    def receive(self, topic, message):
        """Take a message."""
        self.publish(self.monitor.message(topic, message, self.now()))

    def publish(self, records):
        """Publish robustness and verdicts."""
        note(self.metrics, records, self.now())
        for record in records:
            self.senders[self.outbox.topic(record)].publish(self.outbox.message(record))

    def look(self):
        """Look at the clock; say what there is to say."""
        now = self.now()
        if now:  # simulated time is 0 until a node publishes it
            self.publish(self.monitor.tick(now))
        notices = self.monitor.notices()
        for notice in notices:
            self.get_logger().warning(notice.message)
        if notices or time.monotonic() >= self.due:
            self.due = time.monotonic() + DIAGNOSTICS_EVERY
            array = self.outbox.diagnostics(self.monitor.conditions(now), self.get_name(), now)
            self.diagnostics.publish(array)
        return self.monitor.pause(self.now())

    def run(self):
        """Watch until the node is shut down."""
        executor = SingleThreadedExecutor()
        executor.add_node(self)
        while rclpy.ok():
            executor.spin_once(timeout_sec=min(PAUSE, self.look()))


def stamp(nanoseconds):
    """Return a time of ROS 2."""
    return Time(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)


def main():
    """Run the node until it is shut down; return the exit code."""
    rclpy.init(args=sys.argv)
    try:
        arguments = parser(PROGRAM).parse_args(remove_ros_args(sys.argv)[1:])
        with exported(arguments) as metrics:
            Monitor(arguments, metrics).run()
    except StlError as error:
        print(f"{PROGRAM}: {error}", file=sys.stderr)
        return 2
    except (KeyboardInterrupt, ExternalShutdownException):
        return 0
    except RCLError:
        if rclpy.ok():
            raise
        return 0  # it was about to publish when it was asked to end
    finally:
        if rclpy.ok():
            rclpy.shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
