"""A node of ROS 2 on DDS: topics under its names, quality of service, and its place in the graph."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, choices, shown
from rtamt.extras import library

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtamt.ros.dds.types import Types

RELIABILITY = ("reliable", "best_effort")
DURABILITY = ("volatile", "transient_local")
#: The DDS standard's numbers of the qualities in which a publisher may offer too little.
_POLICIES = {2: "durability", 11: "reliability"}
#: Of each, what every publisher offers.
LEAST = {"durability": "volatile", "reliability": "best_effort"}
#: The last domain whose ports exist.
LAST_DOMAIN = 232
#: Messages that are taken at a time.
_AT_ONCE = 1000


@dataclass(frozen=True, slots=True)
class Quality:
    """Quality of service of topics: what rclpy calls reliability, durability and depth."""

    reliability: str = "reliable"
    durability: str = "volatile"
    depth: int = 100

    def __post_init__(self) -> None:
        for name, known in (("reliability", RELIABILITY), ("durability", DURABILITY)):
            value = getattr(self, name)
            if value not in known:
                raise UsageError(f"the {name} of topics cannot be '{value}'{choices(value, known, 'values')}")
        if self.depth < 1:
            raise UsageError(f"the depth of topics is {self.depth}; keep at least one message")


class Participant:
    """One node: subscribes, publishes, and tells the graph. Close it at the end.

    ``quality``: what is asked of publishers; what the node itself publishes is always reliable.
    """

    def __init__(self, name: str, types: Types, quality: Quality) -> None:
        self.name = name
        self._types = types
        self._cyclone = {
            part: library(f"cyclonedds.{part}", "speaking to ROS 2", "ros")
            for part in ("core", "domain", "topic", "pub", "sub", "util")
        }
        self._participant = self._join()
        self._quality = self._qos(quality)
        # Who asks for less hears a reliable publisher, too; not the other way round.
        self._offered = self._qos(replace(quality, reliability="reliable"))
        self._wake = self._cyclone["core"].WaitSet(self._participant)
        self._conditions: list[Any] = []
        self._readers: dict[str, Any] = {}
        self._writers: dict[str, Any] = {}
        latest = Quality(durability="transient_local", depth=1)
        self._info = types.named("rmw_dds_common/msg/ParticipantEntitiesInfo")
        self._graph = self._writer("ros_discovery_info", self._info, self._qos(latest))

    def _join(self) -> Any:
        """Return the participant of the domain; what is wrong is mostly a setting of the environment."""
        domain = _domain()
        try:
            return self._cyclone["domain"].DomainParticipant(domain)
        except self._cyclone["core"].DDSException as error:
            given = os.environ.get("CYCLONEDDS_URI")
            cause = (
                f"check the environment variable CYCLONEDDS_URI, which configures the network and is {shown(given)}"
                if given
                else "is there a network interface? CYCLONEDDS_URI chooses one"
            )
            raise UsageError(f"cannot join DDS domain {domain} ({error}): {cause}") from None

    def _qos(self, quality: Quality) -> Any:
        core = self._cyclone["core"]
        policy, lasting = core.Policy, self._cyclone["util"].duration(milliseconds=100)
        return core.Qos(
            policy.Reliability.Reliable(lasting)
            if quality.reliability == "reliable"
            else policy.Reliability.BestEffort,
            policy.Durability.TransientLocal
            if quality.durability == "transient_local"
            else policy.Durability.Volatile,
            policy.History.KeepLast(quality.depth),
            # What ROS 2 speaks: the first encoding.
            policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False),
        )

    def _writer(self, topic: str, cls: Any, qos: Any) -> Any:
        channel = self._cyclone["topic"].Topic(self._participant, topic, cls, qos=qos)
        return self._cyclone["pub"].DataWriter(self._participant, channel, qos=qos)

    # ---- topics ----------------------------------------------------------------------------------

    def subscribe(self, topic: str, cls: Any) -> None:
        """Take messages of a topic from now on; see :meth:`take`."""
        channel = self._cyclone["topic"].Topic(self._participant, _on_wire(topic), cls, qos=self._quality)
        reader = self._cyclone["sub"].DataReader(self._participant, channel, qos=self._quality)
        core = self._cyclone["core"]
        new = core.SampleState.NotRead | core.ViewState.Any | core.InstanceState.Any
        condition = core.ReadCondition(reader, new)
        self._wake.attach(condition)
        self._conditions.append(condition)
        self._readers[topic] = reader
        self._tell()

    def advertise(self, topic: str, cls: Any) -> None:
        """Announce that messages will be published on a topic."""
        self._writers[topic] = self._writer(_on_wire(topic), cls, self._offered)
        self._tell()

    def publish(self, topic: str, message: Any) -> None:
        """Publish a message on an announced topic."""
        self._writers[topic].write(message)

    def peers(self, topic: str) -> int:
        """Return how many are at the other end of a topic, listening or publishing."""
        if topic in self._writers:
            return len(self._writers[topic].get_matched_subscriptions())
        return len(self._readers[topic].get_matched_publications())

    def refused(self) -> list[tuple[str, str]]:
        """Return topics of which a publisher is not heard since the last call, with the quality that it lacks.

        That is reliability or durability: a publisher that offers less than is asked for stays unheard.
        """
        found = []
        for topic, reader in self._readers.items():
            status = reader.get_requested_incompatible_qos_status()
            if status.total_count_change and status.last_policy_id in _POLICIES:
                found.append((topic, _POLICIES[status.last_policy_id]))
        return found

    def wait(self, seconds: float) -> None:
        """Wait until a message is there, at most so long."""
        self._wake.wait(self._cyclone["util"].duration(seconds=seconds))

    def take(self) -> Iterator[tuple[str, Any]]:
        """Yield the messages that came, with their topics."""
        for topic, reader in self._readers.items():
            for sample in reader.take(_AT_ONCE):
                if not isinstance(sample, self._cyclone["sub"].InvalidSample):  # a publisher that left
                    yield topic, sample

    # ---- the graph -------------------------------------------------------------------------------

    def _tell(self) -> None:
        """Tell the graph what belongs to this node: ``ros2 node list`` reads it."""
        gid = self._types.named("rmw_dds_common/msg/Gid")
        node = self._types.named("rmw_dds_common/msg/NodeEntitiesInfo")

        def identity(entity: Any) -> Any:
            raw = list(entity.guid.bytes)
            made = gid()
            made.data = raw + [0] * (len(made.data) - len(raw))
            return made

        mine = node(
            node_namespace="/",
            node_name=self.name,
            reader_gid_seq=[identity(reader) for reader in self._readers.values()],
            writer_gid_seq=[identity(writer) for writer in self._writers.values()],
        )
        self._graph.write(self._info(gid=identity(self._participant), node_entities_info_seq=[mine]))

    def close(self) -> None:
        """Leave the graph."""
        self._graph.write(self._info(gid=self._types.named("rmw_dds_common/msg/Gid")()))
        self._conditions.clear()
        self._readers.clear()
        self._writers.clear()
        del self._wake, self._graph, self._participant


def _domain() -> int:
    """Return the domain that the environment chooses, 0 by default."""
    text = os.environ.get("ROS_DOMAIN_ID") or "0"
    if not (text.isascii() and text.isdigit() and int(text) <= LAST_DOMAIN):
        raise UsageError(f"ROS_DOMAIN_ID is '{text}'; give a whole number from 0 to {LAST_DOMAIN}")
    return int(text)


def _on_wire(topic: str) -> str:
    """Return the name that ROS 2 gives a topic on DDS."""
    return f"rt/{topic.lstrip('/')}"
