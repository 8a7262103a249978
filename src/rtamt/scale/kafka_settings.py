"""The settings of a worker on Kafka, and those of its clients of librdkafka."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError
from rtamt.lazy.dataclasses import dataclass, field

if TYPE_CHECKING:
    from collections.abc import Mapping

#: Settings of the client that a worker depends on.
_OWN = {
    "bootstrap.servers": "--brokers",
    "group.id": "--group",
    "enable.auto.commit": "a worker commits with its checkpoints",
    "enable.auto.offset.store": "a worker commits with its checkpoints",
    "auto.offset.reset": "--from",
    "enable.partition.eof": "--until-end",
    "enable.idempotence": "results must not be sent twice",
    "delivery.report.only.error": "a worker looks at errors alone",
}


@dataclass(frozen=True)
class Settings:
    """The brokers, topics and options of a worker.

    ``checkpoints``: a folder or an address, None for none; ``interval``: seconds between checkpoints. ``beginning``:
    whether a partition without a checkpoint is read from its start. ``until_end``: whether to end when all messages are
    read. ``client``: settings of librdkafka, those of one client with ``consumer.`` or ``producer.`` before them.
    """

    brokers: str
    topic: str
    group: str
    output: str
    dead_letters: str
    checkpoints: str | None = None
    interval: float = 10.0
    beginning: bool = True
    until_end: bool = False
    client: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in self.client:
            own = name.removeprefix("consumer.").removeprefix("producer.")
            if own in _OWN:
                raise UsageError(f"the setting '{own}' of the client cannot be chosen: {_OWN[own]}")

    def consumer(self) -> dict[str, Any]:
        """Return the settings of the consumer."""
        return self._of("consumer.", "producer.") | {
            "bootstrap.servers": self.brokers,
            "group.id": self.group,
            "enable.auto.commit": False,
            "enable.auto.offset.store": False,
            "auto.offset.reset": "error",  # an offset that no longer exists means lost samples
            "enable.partition.eof": True,
        }

    def producer(self) -> dict[str, Any]:
        """Return the settings of the producer."""
        return {
            "linger.ms": "20",
            **self._of("producer.", "consumer."),
            "bootstrap.servers": self.brokers,
            "enable.idempotence": True,
            "delivery.report.only.error": True,
        }

    def _of(self, prefix: str, other: str) -> dict[str, Any]:
        return {
            name.removeprefix(prefix): value
            for name, value in self.client.items()
            if not name.startswith(other)
        }
