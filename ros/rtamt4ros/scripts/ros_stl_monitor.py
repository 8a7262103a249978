#!/usr/bin/env python3
"""The ROS 1 node: watches a specification over topics, publishes robustness, verdicts and diagnostics.

    rosrun rtamt4ros ros_stl_monitor.py spec.stl --period 1 --unit s

What it subscribes and publishes is in the specification (the paper's listing 8). Arguments may be private
parameters as well: ~spec, ~period, ~unit, ~time, ~stale, ~verdict, ~at, ~set.
"""

import contextlib
import gc
import sys
import threading
import time
import xmlrpc.client
from concurrent.futures import ThreadPoolExecutor

import rosgraph
import rospy

from rtamt import load
from rtamt.errors import StlError
from rtamt.metrics import exported
from rtamt.ros.binding import MessageType
from rtamt.ros.diagnostics import Level
from rtamt.ros.metrics import note
from rtamt.ros.options import options, parser
from rtamt.ros.publisher import DIAGNOSTICS, Publisher

PROGRAM = "ros_stl_monitor.py"
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

    def __init__(self, monitor, metrics=None):
        self.monitor = monitor
        self.metrics = metrics
        self.lock = threading.Lock()
        self.simulated = rospy.get_param("/use_sim_time", False)
        self.outbox = Publisher(monitor.binding, MessageType.load, stamp)
        self.heard = set()  # topics with subscribers; the others get no messages, but metrics need all
        monitor.wanted = self.heard if metrics is None else None
        self.publishers = {topic: self.publisher(topic, cls) for topic, cls in self.outbox.topics.items()}
        self.diagnostics = self.on_diagnostics()
        self.due = 0.0
        for topic, kind in {known.topic: known.type for known in monitor.binding.inputs}.items():
            rospy.Subscriber(topic, self.outbox.classes[kind], self.receive, topic, tcp_nodelay=True)

    def publisher(self, topic, cls):
        """Return the publisher of a topic, which keeps track of its subscribers."""
        audience = Audience(topic, self.heard)
        return rospy.Publisher(topic, cls, audience, tcp_nodelay=True, queue_size=QUEUE)

    def on_diagnostics(self):
        """Return the publisher of conditions; None where there is no message type for them."""
        try:
            from diagnostic_msgs.msg import DiagnosticArray
        except ImportError:
            rospy.logwarn("diagnostic_msgs is not installed, so that nothing is published on /diagnostics")
            return None
        return self.publisher(DIAGNOSTICS, DiagnosticArray)

    def receive(self, message, topic):
        """Take a message; called by rospy, a thread for each connection."""
        with self.lock:
            self.publish(self.monitor.message(topic, message, rospy.Time.now().to_nsec()))

    def run(self):
        """Monitor until the node is shut down, while the calling thread only handles signals.

        rospy closes the connections in its signal handler. A handler that interrupts a thread inside publish()
        waits forever for the queue that this thread has locked.
        """
        with ThreadPoolExecutor(1) as pool:
            work = pool.submit(self.work)
            work.add_done_callback(lambda _: rospy.signal_shutdown("the monitor has ended"))
            rospy.spin()
        work.result()

    def work(self):
        """Log what is monitored; read the clock, sample and publish until the node is shut down."""
        for output in self.monitor.binding.outputs:
            rospy.loginfo("%s: %s", output.name, output.specification.formula)
        try:
            while not rospy.is_shutdown():
                self.cycle()
        except rospy.ROSException:
            if not rospy.is_shutdown():  # which closes topics that are being published
                raise

    def cycle(self):
        """Sample and publish what is due, then sleep."""
        with self.lock:
            now = rospy.Time.now().to_nsec()
            if now:  # simulated time is 0 until a node publishes it
                self.publish(self.monitor.tick(now))
            notices = self.monitor.notices()
            conditions = self.conditions(now, notices)
        self.report(now, notices, conditions)  # messages need not wait for that
        self.sleep(self.monitor.pause(rospy.Time.now().to_nsec()))

    def sleep(self, seconds):
        """Sleep, or wait for the next simulated instant."""
        if not self.simulated:
            time.sleep(seconds)
            return
        changed = rospy.rostime.get_rostime_cond()
        with changed:
            changed.wait(0.1)

    def publish(self, records):
        """Publish robustness and verdicts to those who listen."""
        note(self.metrics, records, rospy.Time.now().to_nsec())
        for record in records:
            self.publishers[self.outbox.topic(record)].publish(self.outbox.message(record))

    def report(self, now, notices, conditions):
        """Log what happened; publish the conditions."""
        for notice in notices:
            LOGS[notice.level](notice.message)
        if conditions:
            self.diagnostics.publish(self.outbox.diagnostics(conditions, rospy.get_name(), now))

    def conditions(self, now, notices):
        """Return the conditions once a second, and after events; none without subscribers."""
        if DIAGNOSTICS not in self.heard or not (notices or time.monotonic() >= self.due):
            return []
        self.due = time.monotonic() + DIAGNOSTICS_EVERY
        return self.monitor.conditions(now)


class Audience(rospy.SubscribeListener):
    """Keeps a topic in a set while it has subscribers."""

    def __init__(self, topic, heard):
        super().__init__()
        self.topic = topic
        self.heard = heard

    def peer_subscribe(self, _name, _to_all, _to_peer):
        """Note a new subscriber."""
        self.heard.add(self.topic)

    def peer_unsubscribe(self, _name, peers):
        """Note that a subscriber has left."""
        if not peers:
            self.heard.discard(self.topic)


class Registration(threading.Thread):
    """Registers the topics of this node with a restarted master, which rospy itself does not."""

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
        """Return whether the node is registered with the master."""
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
        monitor = options(arguments, parameters).monitor()
        with exported(arguments) as metrics:
            node = Node(monitor, metrics)
            Registration().start()
            gc.freeze()  # what is here stays: looking through it again and again would make messages wait
            node.run()
    except StlError as error:
        print(f"{PROGRAM}: {error}", file=sys.stderr)
        return 2
    except rospy.ROSInterruptException:
        return 0
    return 0


if __name__ == "__main__":
    sys.exit(main())
