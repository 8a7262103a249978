#!/usr/bin/env python3
"""The ROS 1 node: watches a specification over topics, publishes robustness, verdicts and diagnostics.

    rosrun rtamt4ros ros_stl_monitor.py spec.stl --period 1 --unit s

What it subscribes and publishes is in the specification (the paper's listing 8). Arguments may be private
parameters as well: ~spec, ~period, ~unit, ~time, ~stale.
"""

import contextlib
import sys
import threading
import time
import xmlrpc.client

import rosgraph
import rospy

from rtamt.errors import StlError
from rtamt.ros import Robustness
from rtamt.ros.binding import MessageType
from rtamt.ros.fields import write
from rtamt.ros.options import options, parser
from rtamt.ros.report import Level
from rtamt.specification import load

PROGRAM = "ros_stl_monitor.py"
VERDICT = MessageType("rtamt_msgs.msg", "Verdict")
QUEUE = 100  # messages that wait for a slow subscriber
DIAGNOSTICS_EVERY = 1.0  # seconds of wall time
LOGS = {
    Level.OK: rospy.loginfo,
    Level.WARN: rospy.logwarn,
    Level.ERROR: rospy.logerr,
    Level.STALE: rospy.logwarn,
}


class Node:
    """Carries messages to a monitor, and what comes out to topics."""

    def __init__(self, monitor):
        self.monitor = monitor
        self.lock = threading.Lock()
        self.simulated = rospy.get_param("/use_sim_time", False)
        classes = monitor.binding.check()
        self.verdict_class = VERDICT.load()
        self.publishers = {
            output: (
                rospy.Publisher(output.topic, classes[output.type], queue_size=QUEUE),
                rospy.Publisher(f"{output.topic}/verdict", self.verdict_class, queue_size=QUEUE),
                classes[output.type],
            )
            for output in monitor.binding.outputs
        }
        self.diagnostics = Diagnostics(monitor)
        for topic, kind in {known.topic: known.type for known in monitor.binding.inputs}.items():
            rospy.Subscriber(topic, classes[kind], self.receive, topic, tcp_nodelay=True)

    def receive(self, message, topic):
        """Take a message; called by rospy, a thread for each connection."""
        with self.lock:
            self.publish(self.monitor.message(topic, message, rospy.Time.now().to_nsec()))

    def run(self):
        """Look at the clock until the node is shut down."""
        while not rospy.is_shutdown():
            with self.lock:
                now = rospy.Time.now().to_nsec()
                if now:  # simulated time is 0 until somebody publishes it
                    self.publish(self.monitor.tick(now))
                self.diagnostics.tell(now)
                pause = self.monitor.pause(rospy.Time.now().to_nsec())
            self.sleep(pause)

    def sleep(self, seconds):
        """Sleep, or wait for the next simulated instant."""
        if not self.simulated:
            time.sleep(seconds)
            return
        changed = rospy.rostime.get_rostime_cond()
        with changed:
            changed.wait(0.1)

    def publish(self, records):
        """Publish robustness and verdicts."""
        for record in records:
            numbers, verdicts, number_class = self.publishers[record.output]
            if isinstance(record, Robustness):
                if numbers.get_num_connections():
                    numbers.publish(self.number(number_class, record))
            elif verdicts.get_num_connections():
                verdicts.publish(self.verdict(record))

    def number(self, cls, record):
        """Return the message of a robustness."""
        message = cls()
        write(message, record.output.path, record.value)
        if hasattr(message, "header"):
            message.header.stamp = stamp(record.stamp)
        return message

    def verdict(self, record):
        """Return the message of a verdict."""
        cls = self.verdict_class
        message = cls(name=record.output.name, horizon=record.horizon)
        message.header.stamp = stamp(record.stamp)
        message.verdict = {None: cls.UNKNOWN, True: cls.SATISFIED, False: cls.VIOLATED}[record.satisfied]
        return message


class Diagnostics:
    """Publishes the condition of every output, once a second and when something happened; logs what did."""

    def __init__(self, monitor):
        self.monitor = monitor
        self.next = 0.0
        try:
            from diagnostic_msgs import msg
        except ImportError:
            rospy.logwarn("diagnostic_msgs is not installed, so that nothing is published on /diagnostics")
            self.messages = None
            return
        self.messages = msg
        self.publisher = rospy.Publisher("/diagnostics", msg.DiagnosticArray, queue_size=QUEUE)

    def tell(self, now):
        """Say what there is to say at ``now``."""
        notices = self.monitor.notices()
        for notice in notices:
            LOGS[notice.level](notice.message)
        if self.messages is None or not (notices or time.monotonic() >= self.next):
            return
        self.next = time.monotonic() + DIAGNOSTICS_EVERY
        array = self.messages.DiagnosticArray(status=[self.status(c) for c in self.monitor.conditions(now)])
        array.header.stamp = stamp(now)
        self.publisher.publish(array)

    def status(self, condition):
        """Return the message of one condition."""
        values = [self.messages.KeyValue(key, value) for key, value in condition.values]
        return self.messages.DiagnosticStatus(
            level=int(condition.level),
            name=condition.name,
            message=condition.message,
            hardware_id=rospy.get_name(),
            values=values,
        )


class Registration(threading.Thread):
    """Tells a master that was restarted what this node subscribes and publishes: rospy itself does not."""

    def __init__(self):
        super().__init__(daemon=True)
        self.name_of_node = rospy.get_name()
        self.uri = rospy.get_node_uri()

    def run(self):
        """Ask once a second whether the master knows this node."""
        master = rosgraph.Master(self.name_of_node)
        while not rospy.is_shutdown():
            time.sleep(1.0)
            with contextlib.suppress(OSError, xmlrpc.client.Error, rosgraph.MasterException):
                # A master that is away is asked again; one that knows the node needs nothing.
                if not self.known(master) and not rospy.is_shutdown():
                    self.register(master)

    def known(self, master):
        """Tell whether the master has this node."""
        try:
            return master.lookupNode(self.name_of_node) == self.uri
        except rosgraph.MasterError:
            return False

    def register(self, master):
        """Register every topic again, and connect to the publishers that are there already."""
        rospy.logwarn("the master was restarted: registering again")
        itself = xmlrpc.client.ServerProxy(self.uri)
        for topic, kind in itself.getPublications(self.name_of_node)[2]:
            master.registerPublisher(topic, kind, self.uri)
        for topic, kind in itself.getSubscriptions(self.name_of_node)[2]:
            publishers = master.registerSubscriber(topic, kind, self.uri)
            itself.publisherUpdate(self.name_of_node, topic, publishers)


def stamp(nanoseconds):
    """Return a time of ROS."""
    return rospy.Time(*divmod(nanoseconds, 10**9))


def main():
    """Run the node until it is shut down; return the exit code."""
    try:
        arguments = parser(PROGRAM).parse_args(rospy.myargv(sys.argv)[1:])
        name = (load(arguments.spec).name if arguments.spec else None) or "stl_monitor"
        rospy.init_node(name, anonymous=True)
        parameters = rospy.get_param("~", {})
        node = Node(options(arguments, parameters).monitor())
    except StlError as error:
        print(f"{PROGRAM}: {error}", file=sys.stderr)
        return 2
    except rospy.ROSInterruptException:
        return 0
    Registration().start()
    for output in node.monitor.binding.outputs:
        rospy.loginfo("%s: %s", output.name, output.specification.formula)
    with contextlib.suppress(rospy.ROSInterruptException):
        node.run()
    return 0


if __name__ == "__main__":
    sys.exit(main())
