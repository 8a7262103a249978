"""A rospy node that does what it is told on stdin, a JSON object a line; see ``Puppet``."""

import json
import sys
import threading

import genpy
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

    def say(self, **event):
        with self.lock:
            print(json.dumps(event), flush=True)

    def advertise(self, topic, kind):
        cls = roslib.message.get_message_class(kind)
        self.publishers[topic] = (rospy.Publisher(topic, cls, queue_size=1000), cls)

    def subscribe(self, topic, kind):
        self.subscribers[topic] = rospy.Subscriber(
            topic,
            roslib.message.get_message_class(kind),
            lambda message: self.say(event="message", topic=topic, data=plain(message)),
            tcp_nodelay=True,
        )

    def peers(self, topic):
        ends = (self.publishers.get(topic, (None,))[0], self.subscribers.get(topic))
        return min(end.get_num_connections() for end in ends if end is not None)

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
    puppet.say(event="ready")
    for line in sys.stdin:
        command = json.loads(line)
        answer = getattr(puppet, command.pop("do"))(**command)
        puppet.say(event="done", answer=answer)


main()
