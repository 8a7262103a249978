"""The monitor as a ROS 2 node on Cyclone DDS alone."""

from __future__ import annotations

import signal
import sys
import time
from typing import TYPE_CHECKING, Any

from rtamt.errors import escaped
from rtamt.ros.dds.participant import LEAST
from rtamt.ros.metrics import note
from rtamt.ros.publisher import DIAGNOSTICS, Publisher, diagnostic

if TYPE_CHECKING:
    from rtamt.metrics import Metrics
    from rtamt.ros.binding import MessageType
    from rtamt.ros.dds.participant import Participant
    from rtamt.ros.dds.types import Types
    from rtamt.ros.monitor import RosMonitor

#: The period of messages on /diagnostics in seconds.
_DIAGNOSTICS_EVERY = 1.0
_CLOCK = "/clock"


class Node:
    """Passes messages to a monitor and publishes its output, until it is stopped.

    ``simulated``: time is taken from ``/clock``. ``metrics``: what exporters read.
    """

    def __init__(
        self,
        monitor: RosMonitor,
        participant: Participant,
        types: Types,
        *,
        simulated: bool = False,
        metrics: Metrics | None = None,
    ) -> None:
        self._metrics = metrics
        self._monitor = monitor
        self._participant = participant
        self._now = 0 if simulated else None
        time_class = types.named("builtin_interfaces/msg/Time")

        def stamp(nanoseconds: int) -> Any:
            return time_class(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)

        self._outbox = Publisher(monitor.binding, types.load, stamp)
        for topic, cls in self._outbox.topics.items():
            participant.advertise(topic, cls)
        participant.advertise(DIAGNOSTICS, types.load(diagnostic("DiagnosticArray")))
        if simulated:
            participant.subscribe(_CLOCK, types.named("rosgraph_msgs/msg/Clock"))
        read: dict[str, MessageType] = {known.topic: known.type for known in monitor.binding.inputs}
        for topic, kind in read.items():
            participant.subscribe(topic, self._outbox.classes[kind])
        self._due = 0.0
        self._stopped = False

    def stop(self, *_: object) -> None:
        """Make :meth:`run` return soon."""
        self._stopped = True

    def run(self) -> None:
        """Run until :meth:`stop` or a termination signal."""
        for ending in (signal.SIGINT, signal.SIGTERM):
            signal.signal(ending, self.stop)
        while not self._stopped:
            now = self._time()
            if now:  # simulated time is 0 until it is published
                self._publish(self._monitor.tick(now))
            self._report(now)
            self._participant.wait(self._monitor.pause(self._time()))
            self._take()
        self._participant.close()

    def _time(self) -> int:
        return time.time_ns() if self._now is None else self._now

    def _take(self) -> None:
        for topic, message in self._participant.take():
            if self._stopped:  # each clock message may require many samples
                return
            self._receive(topic, message)

    def _receive(self, topic: str, message: Any) -> None:
        if topic == _CLOCK:
            self._now = int(message.clock.sec) * 10**9 + int(message.clock.nanosec)
            self._publish(self._monitor.tick(self._now))
            return
        self._publish(self._monitor.message(topic, message, self._time()))

    def _publish(self, records: Any) -> None:
        note(self._metrics, records, self._time())
        for record in records:
            self._participant.publish(self._outbox.topic(record), self._outbox.message(record))

    def _report(self, now: int) -> None:
        notices = self._monitor.notices()
        for notice in notices:
            print(escaped(f"[{notice.level.name}] {notice.message}"), file=sys.stderr, flush=True)
        if notices or time.monotonic() >= self._due:
            self._due = time.monotonic() + _DIAGNOSTICS_EVERY
            self._report_incompatible()
            conditions = self._monitor.conditions(now)
            array = self._outbox.diagnostics(conditions, self._participant.name, now)
            self._participant.publish(DIAGNOSTICS, array)

    def _report_incompatible(self) -> None:
        for topic, quality in self._participant.refused():
            sentence = (
                f"[WARN] a publisher on {topic} is not heard, for its {quality} is less than is asked for: "
                f"--{quality} {LEAST[quality]} hears it"
            )
            print(escaped(sentence), file=sys.stderr, flush=True)
