"""A ROS 2 node on DDS: topics under ROS 2's names, quality of service, and the ROS 2 graph."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, choices, shown
from rtamt.extras import library
from rtamt.files import nearest_file
from rtamt.lazy.dataclasses import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtamt.ros.dds.types import Types

RELIABILITY = ("reliable", "best_effort")
DURABILITY = ("volatile", "transient_local")
#: The DDS policy IDs of the quality-of-service settings in which a publisher may offer too little.
_POLICIES = {2: "durability", 11: "reliability"}
#: The weakest value of each, which every publisher offers.
LEAST = {"durability": "volatile", "reliability": "best_effort"}
#: The largest domain number with valid ports.
LAST_DOMAIN = 232
#: The number of messages taken at a time.
_AT_ONCE = 1000


@dataclass(frozen=True, slots=True)
class Quality:
    """Quality of service of topics: reliability, durability and depth, as in rclpy."""

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
    """One node: subscribes, publishes, and registers in the graph. Close it at the end.

    ``quality``: the quality of service requested of publishers; the node itself always publishes reliably.
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
        # A best-effort reader also receives from a reliable publisher, but not the other way round.
        self._offered = self._qos(replace(quality, reliability="reliable"))
        self._wake = self._cyclone["core"].WaitSet(self._participant)
        self._conditions: list[Any] = []
        self._readers: dict[str, Any] = {}
        self._writers: dict[str, Any] = {}
        latest = Quality(durability="transient_local", depth=1)
        self._info = types.named("rmw_dds_common/msg/ParticipantEntitiesInfo")
        self._graph = self._writer("ros_discovery_info", self._info, self._qos(latest))

    def _join(self) -> Any:
        """Return the participant of the domain; errors are mostly due to environment settings.

        Cyclone DDS prints the cause itself. Its lines are not held back: for some wrong settings it prints one and
        aborts the process.
        """
        domain = _domain()
        _check_files(os.environ.get("CYCLONEDDS_URI", ""))
        enclave = self._user_data(self._cyclone["core"].Qos(), "enclave=/;")
        try:
            return self._cyclone["domain"].DomainParticipant(domain, enclave)
        except self._cyclone["core"].DDSException:
            given = os.environ.get("CYCLONEDDS_URI")
            remedy = (
                f"check the environment variable CYCLONEDDS_URI, which configures the network and is {shown(given)}"
                if given
                else "is there a network interface? CYCLONEDDS_URI chooses one"
            )
            raise UsageError(
                f"cannot join DDS domain {domain} (the lines above give the cause): {remedy}"
            ) from None

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
            # ROS 2 uses the first encoding (XCDR1).
            policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False),
        )

    def _user_data(self, qos: Any, text: str) -> Any:
        """Return a quality of service with the pairs of keys and values that ROS 2 attaches to an entity."""
        core = self._cyclone["core"]
        return core.Qos(core.Policy.Userdata(text.encode()), base=qos)

    def _with_type_hash(self, qos: Any, cls: Any) -> Any:
        """Return the quality of service of a reader or writer, with the hash of its type (Iron and newer)."""
        return self._user_data(qos, f"typehash={self._types.type_hash(cls)};")

    def _writer(self, topic: str, cls: Any, qos: Any) -> Any:
        channel = self._cyclone["topic"].Topic(self._participant, topic, cls, qos=qos)
        return self._cyclone["pub"].DataWriter(self._participant, channel, qos=self._with_type_hash(qos, cls))

    # ---- topics ----------------------------------------------------------------------------------

    def subscribe(self, topic: str, cls: Any) -> None:
        """Subscribe to a topic; see :meth:`take`."""
        channel = self._cyclone["topic"].Topic(self._participant, _on_wire(topic), cls, qos=self._quality)
        hashed = self._with_type_hash(self._quality, cls)
        reader = self._cyclone["sub"].DataReader(self._participant, channel, qos=hashed)
        core = self._cyclone["core"]
        new = core.SampleState.NotRead | core.ViewState.Any | core.InstanceState.Any
        condition = core.ReadCondition(reader, new)
        self._wake.attach(condition)
        self._conditions.append(condition)
        self._readers[topic] = reader
        self._announce()

    def advertise(self, topic: str, cls: Any) -> None:
        """Announce that messages will be published on a topic."""
        self._writers[topic] = self._writer(_on_wire(topic), cls, self._offered)
        self._announce()

    def publish(self, topic: str, message: Any) -> None:
        """Publish a message on an announced topic."""
        self._writers[topic].write(message)

    def peers(self, topic: str) -> int:
        """Return the number of matched subscribers or publishers of a topic."""
        if topic in self._writers:
            return len(self._writers[topic].get_matched_subscriptions())
        return len(self._readers[topic].get_matched_publications())

    def refused(self) -> list[tuple[str, str]]:
        """Return topics with incompatible publishers since the last call, and the quality that they lack.

        That is reliability or durability: a publisher that offers less than requested is not connected.
        """
        found = []
        for topic, reader in self._readers.items():
            status = reader.get_requested_incompatible_qos_status()
            if status.total_count_change and status.last_policy_id in _POLICIES:
                found.append((topic, _POLICIES[status.last_policy_id]))
        return found

    def wait(self, seconds: float) -> None:
        """Wait until a message arrives, or until the timeout."""
        self._wake.wait(self._cyclone["util"].duration(seconds=seconds))

    def take(self) -> Iterator[tuple[str, Any]]:
        """Yield the received messages with their topics."""
        for topic, reader in self._readers.items():
            for sample in reader.take(_AT_ONCE):
                if not isinstance(sample, self._cyclone["sub"].InvalidSample):  # a publisher that left
                    yield topic, sample

    # ---- the graph -------------------------------------------------------------------------------

    def _announce(self) -> None:
        """Publish the entities of this node to the graph, for ``ros2 node list``."""
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


def _check_files(configuration: str) -> None:
    """Raise :class:`UsageError` for a configuration file of Cyclone DDS that does not exist.

    ``configuration``: paths, perhaps with ``file://``, separated by commas. Cyclone DDS also takes XML, and replaces
    ``$NAME`` and ``${NAME}``; neither is checked here.
    """
    if "<" in configuration or "$" in configuration:
        return
    for part in configuration.split(","):
        path = part.strip().removeprefix("file://")
        if path and not os.path.exists(path):
            raise UsageError(
                f"the environment variable CYCLONEDDS_URI names the configuration file '{path}', which does not exist"
                f"{nearest_file(path)}; correct the path, or unset the variable"
            )


def _domain() -> int:
    """Return the domain that the environment chooses, 0 by default."""
    text = os.environ.get("ROS_DOMAIN_ID") or "0"
    if not (text.isascii() and text.isdigit() and int(text) <= LAST_DOMAIN):
        raise UsageError(f"ROS_DOMAIN_ID is '{text}'; give a whole number from 0 to {LAST_DOMAIN}")
    return int(text)


def _on_wire(topic: str) -> str:
    """Return the DDS name of a ROS 2 topic."""
    return f"rt/{topic.lstrip('/')}"
