"""A rospy node that does what it is told on stdin, a JSON object a line; see ``Puppet``."""

import json
import sys
import threading
import xmlrpc.client

import genpy
import rosgraph
import roslib.message
import rospy


def plain(value):
    """Return a message as JSON can hold it: fields by name, times in nanoseconds."""
    if isinstance(value, (genpy.Time, genpy.Duration)):
        return value.to_nsec()
    if isinstance(value, genpy.Message):
        return {name: plain(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return value


def fill(message, fields):
    """Set the fields of a message; times are in nanoseconds."""
    for name, value in fields.items():
        present = getattr(message, name)
        if isinstance(present, (genpy.Time, genpy.Duration)):
            setattr(message, name, type(present)(*divmod(value, 10**9)))
        elif isinstance(present, genpy.Message):
            fill(present, value)
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            kind = message._slot_types[message.__slots__.index(name)].split("[")[0]
            items = [roslib.message.get_message_class(kind)() for _ in value]
            for item, inside in zip(items, value, strict=True):
                fill(item, inside)
            setattr(message, name, items)
        else:
            setattr(message, name, value)


class Puppet:
    """Publishers by topic, and one word for each thing to do."""

    def __init__(self):
        self.publishers = {}
        self.subscribers = {}
        self.lock = threading.Lock()

    def report_event(self, **event):
        with self.lock:
            print(json.dumps(event), flush=True)

    def advertise(self, topic, kind):
        cls = roslib.message.get_message_class(kind)
        self.publishers[topic] = (rospy.Publisher(topic, cls, queue_size=1000), cls)

    def subscribe(self, topic, kind):
        self.subscribers[topic] = rospy.Subscriber(
            topic,
            roslib.message.get_message_class(kind),
            lambda message: self.report_event(event="message", topic=topic, data=plain(message)),
            tcp_nodelay=True,
        )

    def peers(self, topic):
        """Return how many publishers and subscribers would miss nothing that is sent on a topic from now on."""
        found = []
        if topic in self.publishers:
            found.append(self.publishers[topic][0].get_num_connections())
        if topic in self.subscribers:
            found.append(self.senders(topic))
        return min(found)

    def senders(self, topic):
        """Return how many publishers of a topic list this node among those that they send to.

        The count of the subscriber does not say that: a connection stands at its end a moment before the publisher
        has it in its list, and what is published in between is lost.
        """
        topic = rospy.resolve_name(topic)
        master = rosgraph.Master(rospy.get_name())
        publishers = dict(master.getSystemState()[0]).get(topic, [])
        return sum(self.sends(master.lookupNode(node), topic) for node in publishers)

    def sends(self, address, topic):
        """Return whether the node at an address sends a topic to this node."""
        with xmlrpc.client.ServerProxy(address) as node:
            _, _, connections = node.getBusInfo(rospy.get_name())
        return any(
            peer == rospy.get_name() and direction == "o" and of == topic and connected
            for _, peer, direction, _, of, connected, *_ in connections
        )

    def publish(self, topic, fields):
        publisher, cls = self.publishers[topic]
        message = cls()
        fill(message, fields)
        publisher.publish(message)

    def now(self):
        return rospy.Time.now().to_nsec()


def main():
    rospy.init_node("puppet", anonymous=True)
    puppet = Puppet()
    puppet.report_event(event="ready")
    for line in sys.stdin:
        command = json.loads(line)
        answer = getattr(puppet, command.pop("do"))(**command)
        puppet.report_event(event="done", answer=answer)


main()
