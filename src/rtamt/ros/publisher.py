"""Convert records and conditions to messages of any origin: rospy, rclpy, or the definitions alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.ros.binding import MessageType
from rtamt.ros.early_group import Bounds
from rtamt.ros.fields import write
from rtamt.ros.group import Robustness
from rtamt.ros.message_definitions import SATISFIED, UNKNOWN, VIOLATED

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from rtamt.ros.binding import Binding, Output
    from rtamt.ros.diagnostics import Condition, Level
    from rtamt.ros.group import Record

VERDICT = MessageType("rtamt_msgs.msg", "Verdict")
BOUNDS = MessageType("rtamt_msgs.msg", "Bounds")
DIAGNOSTICS = "/diagnostics"
_VERDICTS = {None: UNKNOWN, True: SATISFIED, False: VIOLATED}


class Publisher:
    """Creates the messages that a node publishes.

    ``load``: from a type to its class, which can be called without arguments. ``stamp``: from
    nanoseconds to the timestamp of a header. ``level``: from a level to the level of a status message.
    """

    def __init__(
        self,
        binding: Binding,
        load: Callable[[MessageType], Any],
        stamp: Callable[[int], Any],
        level: Callable[[Level], Any] = int,
    ) -> None:
        self.classes = binding.check(load)
        self._verdict = load(VERDICT)
        self._bounds = load(BOUNDS)
        self._stamp = stamp
        self._level = level
        self._load = load
        #: From every topic that is published to its class.
        self.topics: Mapping[str, Any] = {
            topic: cls for output in binding.outputs for topic, cls in self._topics(output)
        }

    def _topics(self, output: Output) -> Sequence[tuple[str, Any]]:
        if output.early:
            return [(output.bounds, self._bounds)]
        return [(output.topic, self.classes[output.type]), (output.verdicts, self._verdict)]

    def topic(self, record: Record) -> str:
        """Return the topic of a record."""
        output = record.output
        if isinstance(record, Bounds):
            return output.bounds
        return output.topic if isinstance(record, Robustness) else output.verdicts

    def message(self, record: Record) -> Any:
        """Return the message of a record, with its timestamp in the header."""
        if isinstance(record, Robustness):
            message = self.classes[record.output.type]()
            write(message, record.output.path, record.value)
            if not hasattr(message, "header"):
                return message
        elif isinstance(record, Bounds):
            message = self._bounds()
            message.name, message.lower, message.upper = record.output.name, record.lower, record.upper
            message.verdict = _VERDICTS[record.satisfied]
            message.decided_at = record.decided_at or 0
            message.begin, message.end = record.begin, record.end
        else:
            message = self._verdict()
            message.name, message.horizon = record.output.name, record.horizon
            message.verdict = _VERDICTS[record.satisfied]
        message.header.stamp = self._stamp(record.stamp)
        return message

    def diagnostics(self, conditions: list[Condition], node: str, now: int) -> Any:
        """Return the ``DiagnosticArray`` of a node's conditions."""
        array = self._load(diagnostic("DiagnosticArray"))()
        array.header.stamp = self._stamp(now)
        array.status = [self._status(condition, node) for condition in conditions]
        return array

    def _status(self, condition: Condition, node: str) -> Any:
        status = self._load(diagnostic("DiagnosticStatus"))()
        status.level = self._level(condition.level)
        status.name, status.message, status.hardware_id = condition.name, condition.message, node
        status.values = [self._pair(key, value) for key, value in condition.values]
        return status

    def _pair(self, key: str, value: str) -> Any:
        pair = self._load(diagnostic("KeyValue"))()
        pair.key, pair.value = key, value
        return pair


def diagnostic(name: str) -> MessageType:
    """Return a type of ``diagnostic_msgs``."""
    return MessageType("diagnostic_msgs.msg", name)
