"""A participant of Cyclone DDS that does what it is told on stdin, a JSON object a line; see ``Puppet``."""

import dataclasses
import json
import os
import sys
import threading

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from rtamt.ros.dds.participant import Participant, Quality
from rtamt.ros.dds.types import Types


def fill(message, fields):
    """Set the fields of a message."""
    for name, value in fields.items():
        if isinstance(value, dict):
            fill(getattr(message, name), value)
        else:
            setattr(message, name, value)


class Puppet:
    """One word for each thing to do."""

    def __init__(self, quality):
        self.types = Types()
        self.participant = Participant("puppet", self.types, quality)
        self.participant._offered = self.participant._quality  # unlike a monitor, it may offer best effort
        self.classes = {}
        self.lock = threading.Lock()  # a participant is used by one thread at a time
        self.graph = None

    def report_event(self, **event):
        sys.stdout.write(json.dumps(event) + "\n")  # one write: two threads speak
        sys.stdout.flush()

    def advertise(self, topic, kind):
        self.classes[topic] = self.types.named(kind)
        self.participant.advertise(topic, self.classes[topic])

    def subscribe(self, topic, kind):
        self.participant.subscribe(topic, self.types.named(kind))

    def nodes(self):
        """Return the names of the nodes that the graph knows, as ``ros2 node list`` reads them."""
        if self.graph is None:
            cls = self.types.named("rmw_dds_common/msg/ParticipantEntitiesInfo")
            qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.Durability.TransientLocal)
            domain = DomainParticipant(int(os.environ["ROS_DOMAIN_ID"]))
            self.graph = DataReader(domain, Topic(domain, "ros_discovery_info", cls, qos=qos), qos=qos)
        told = [info for info in self.graph.read(100) if hasattr(info, "node_entities_info_seq")]
        return [
            [node.node_name, len(node.reader_gid_seq), len(node.writer_gid_seq)]
            for info in told
            for node in info.node_entities_info_seq
        ]

    def user_data(self, topic):
        """Return what other participants attach to readers and writers of a topic, as ``ros2 topic info`` reads it."""
        found = set()
        for kind in (BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription):
            for endpoint in BuiltinDataReader(self.participant._participant, kind).take(100):
                mine = endpoint.participant_key == self.participant._participant.guid
                if endpoint.topic_name == f"rt/{topic}" and not mine:
                    found.add(endpoint.qos[Policy.Userdata].data.decode())
        return sorted(found)

    def peers(self, topic):
        return self.participant.peers(topic)

    def publish(self, topic, fields):
        message = self.classes[topic]()
        fill(message, fields)
        self.participant.publish(topic, message)

    def listen(self):
        while True:
            with self.lock:
                for topic, message in self.participant.take():
                    self.report_event(event="message", topic=topic, data=dataclasses.asdict(message))
            self.participant.wait(0.02)


def main():
    puppet = Puppet(Quality(*sys.argv[1:]))
    threading.Thread(target=puppet.listen, daemon=True).start()
    puppet.report_event(event="ready")
    for line in sys.stdin:
        command = json.loads(line)
        with puppet.lock:
            answer = getattr(puppet, command.pop("do"))(**command)
        puppet.report_event(event="done", answer=answer)


main()
