"""A worker on Apache Kafka: samples from one topic, robustness to another; needs ``rtamt[kafka]``.

Workers of one consumer group share the partitions of a topic; each partition is a shard with its own fleet. The
checkpoint of a shard is its state together with the offset of the next message, in one object. It is written after
the broker has confirmed all results of the messages before it. So nothing is lost, however a worker ends. A worker
that resumes may send results again that were sent after the checkpoint: they are equal, and have the same key and time,
by which a reader drops them or an upsert overwrites them.
"""

from __future__ import annotations

import json
import time
from collections import Counter
from math import inf, isfinite, nan
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, UsageError
from rtamt.extras import library
from rtamt.scale.checkpoints import Checkpoint, Checkpoints
from rtamt.scale.shard import Sample, Shard

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from rtamt.fleet.suite import Suite
    from rtamt.metrics import Metrics
    from rtamt.scale.kafka_settings import Settings
    from rtamt.scale.messages import MessageReader
    from rtamt.scale.shard import Rejected, Result, Taken
    from rtamt.specification import Specification

#: The most messages that are taken together, and seconds until fewer are.
_BATCH, _WAIT = 5000, 0.1
#: Seconds for what a broker answers at once.
_ANSWER = 10.0
#: The longest text of an error in a dead letter.
_LONGEST_ERROR = 1000


class _Partition:
    """A partition that is assigned to this worker; ``offset``: of the next message, None before the first."""

    def __init__(self, shard: Shard, offset: int | None) -> None:
        self.shard = shard
        self.offset = offset
        self.saved = offset


class Worker:
    """Monitor the samples of a topic; ``say``: takes messages for the operator; ``metrics``: for exporters.

    ``spec``: a specification, or a suite, each of whose requirements has its results. ``options``: those of
    :class:`~rtamt.scale.shard.Shard`. ``counts``: what has happened since the start: ``samples``, ``results``,
    ``violations``, ``late``, ``rejected``, ``expired``.
    """

    def __init__(
        self,
        spec: Specification | Suite,
        reader: MessageReader,
        settings: Settings,
        *,
        say: Callable[[str], None] = print,
        metrics: Metrics | None = None,
        **options: Any,
    ) -> None:
        self._kafka = library("confluent_kafka", "a worker on Kafka", "kafka")
        self._spec, self._reader, self._settings, self._say = spec, reader, settings, say
        self._options, self._metrics = options, metrics
        #: The name of a requirement that is no one of a suite.
        self._name = getattr(spec, "name", None) or "requirement"
        Shard(spec, **options)  # what a fleet cannot monitor is an error now
        place = settings.checkpoints
        self._checkpoints = None if place is None else Checkpoints(place, settings.group, settings.topic)
        self._partitions: dict[int, _Partition] = {}
        self._ended: set[int] = set()
        self._assigned_in_consume = self._stopping = False
        self._failure: str | None = None
        self._said: set[str] = set()
        self.counts: Counter[str] = Counter()
        self._consumer, self._producer = self._clients()

    def _clients(self) -> tuple[Any, Any]:
        """Return the consumer and the producer."""
        own = {"error_cb": self._trouble}
        try:
            return (
                self._kafka.Consumer(self._settings.consumer() | own),
                self._kafka.Producer(self._settings.producer() | own | {"on_delivery": self._delivery_error}),
            )
        except (self._kafka.KafkaException, ValueError, TypeError) as error:
            raise UsageError(f"the settings of the client are wrong: {_text(error)}") from None

    def stop(self) -> None:
        """Let :meth:`run` end after the messages that it has; may be called from a signal handler."""
        self._stopping = True

    def run(self) -> None:
        """Monitor until :meth:`stop`; raise :class:`UsageError` for what needs an operator."""
        self._check_topic()
        try:
            self._consumer.subscribe(
                [self._settings.topic], on_assign=self._assign, on_revoke=self._revoke, on_lost=self._lose
            )
            due = time.monotonic() + self._settings.interval
            while not self._stopping and not self._is_done():
                self._take(self._consume())
                self._producer.poll(0)
                self._fail()
                self._measure()
                if time.monotonic() >= due:
                    self._save(self._partitions)
                    due = time.monotonic() + self._settings.interval
            self._save(self._partitions)
        except self._kafka.KafkaException as error:
            raise UsageError(f"Kafka: {_text(error)}") from None
        finally:
            self._partitions.clear()  # saved, or wrong
            self._consumer.close()
            # Clients refer to the worker, by its callbacks: without this their threads would stay.
            self._consumer = self._producer = None

    @property
    def keys(self) -> int:
        """The number of keys in the partitions of this worker."""
        return sum(len(each.shard) for each in self._partitions.values())

    def lag(self) -> dict[int, int]:
        """Return for each partition how many messages of the broker have not been read, as far as known."""
        found = {}
        for number, partition in self._partitions.items():
            place = self._kafka.TopicPartition(self._settings.topic, number)
            low, high = self._consumer.get_watermark_offsets(place, cached=True)
            if high >= 0:
                found[number] = max(0, high - (max(low, 0) if partition.offset is None else partition.offset))
        return found

    def _measure(self) -> None:
        if self._metrics is not None:
            self._metrics.set("rtamt_keys", self.keys)
            lag = {str(number): float(messages) for number, messages in self.lag().items()}
            self._metrics.replace("rtamt_lag_messages", "partition", lag)

    def _is_done(self) -> bool:
        return self._settings.until_end and bool(self._partitions) and self._ended >= self._partitions.keys()

    def _check_topic(self) -> None:
        name = self._settings.topic
        try:
            topic = self._consumer.list_topics(name, timeout=_ANSWER).topics[name]
        except self._kafka.KafkaException as error:
            raise UsageError(f"no broker answers at '{self._settings.brokers}': {_text(error)}") from None
        if topic.error is not None:
            raise UsageError(f"cannot read the topic '{name}': {topic.error.str()}")

    # ---- messages -------------------------------------------------------------------------------------

    def _consume(self) -> dict[int, list[Any]]:
        """Return messages by partition, in their order."""
        self._assigned_in_consume = False
        messages = self._consumer.consume(_BATCH, _WAIT)
        if self._assigned_in_consume and messages:
            # Some may be of the assignment before: all partitions are read again from where their shards are.
            self._consumer.assign([self._position(number) for number in self._partitions])
            self._ended.clear()
            return {}
        found: dict[int, list[Any]] = {}
        for message in messages:
            if message.error() is not None:
                self._notice(message)
            elif message.partition() in self._partitions:
                self._ended.discard(message.partition())
                found.setdefault(message.partition(), []).append(message)
        return found

    def _notice(self, message: Any) -> None:
        error, codes = message.error(), self._kafka.KafkaError
        if error.code() == codes._PARTITION_EOF:
            self._ended.add(message.partition())
            return
        if error.code() == codes._AUTO_OFFSET_RESET:
            number = message.partition()
            raise UsageError(
                f"partition {number} of '{self._settings.topic}' no longer has the message at which its checkpoint is: "
                f"the samples in between are lost; delete the checkpoint to begin with the oldest message"
            )
        lasting = (
            codes.UNKNOWN_TOPIC_OR_PART,
            codes.TOPIC_AUTHORIZATION_FAILED,
            codes.GROUP_AUTHORIZATION_FAILED,
        )
        if error.fatal() or error.code() in lasting:
            raise UsageError(f"cannot read the topic '{self._settings.topic}': {error.str()}")
        self._trouble(error)

    def _take(self, messages: Mapping[int, Sequence[Any]]) -> None:
        for number, some in messages.items():
            partition = self._partitions[number]
            samples: list[Sample] = []
            origins: list[Any] = []
            for message in some:
                sample = self._read(message)
                if sample is not None:
                    samples.append(sample)
                    origins.append(message)
            taken = partition.shard.take(samples, [_seconds_of(message) for message in origins])
            self._send(taken.results)
            self._note(samples, taken)
            for rejected in taken.rejected:
                self._divert(origins[rejected.position], rejected)
            for discarded in taken.discarded:
                self._note_wrong("rejected")
                headers = self._headers(discarded.error, "rejected")
                self._produce(self._settings.dead_letters, None, discarded.key.encode(), headers)
            self.counts["expired"] += len(taken.expired)
            partition.offset = some[-1].offset() + 1
            self.counts["samples"] += len(samples) - len(taken.rejected)

    def _note(self, samples: Sequence[Sample], taken: Taken) -> None:
        """Pass what a batch has led to on to exporters."""
        metrics = self._metrics
        if metrics is None:
            return
        metrics.count("rtamt_samples_total", len(samples) - len(taken.rejected))
        metrics.count("rtamt_expired_total", len(taken.expired))
        named = [(result.requirement or self._name, result) for result in taken.results]
        for (name, verdict), count in Counter((name, result.satisfied) for name, result in named).items():
            metrics.verdict(name, verdict, count)
        lowest: dict[str, float] = {}
        for name, result in named:
            lowest[name] = min(result.robustness, lowest.get(name, inf))
        for name, robustness in lowest.items():
            metrics.set("rtamt_robustness", robustness, requirement=name)
        if samples:
            metrics.set("rtamt_lag_seconds", time.time() - max(sample.time for sample in samples))

    def _read(self, message: Any) -> Sample | None:
        """Return the sample in a message; None for what has become a dead letter."""
        try:
            return self._reader.read(message.value(), message.key())
        except TraceError as error:
            self._send_to_dead_letters(message, str(error), "rejected")
            return None

    def _send(self, results: Iterable[Result]) -> None:
        for result in results:
            self._produce(self._settings.output, row_of(result), result.key.encode())
            self.counts["results"] += 1
            self.counts["violations"] += result.satisfied is False

    def _divert(self, message: Any, rejected: Rejected) -> None:
        self._send_to_dead_letters(message, rejected.error, "late" if rejected.late else "rejected")

    def _send_to_dead_letters(self, message: Any, error: str, reason: str) -> None:
        """Send a message unchanged to the dead-letter topic, with the error and its origin."""
        self._note_wrong(reason)
        origin = {"rtamt.partition": str(message.partition()), "rtamt.offset": str(message.offset())}
        coded = self._headers(error, reason, origin)
        try:
            self._produce(self._settings.dead_letters, message.value(), message.key(), coded)
        except self._kafka.KafkaException as wrong:
            if not self._is_too_large(wrong.args[0]):
                raise
            self._bury_alone(message, coded)

    def _note_wrong(self, reason: str) -> None:
        self.counts[reason] += 1
        if self._metrics is not None:
            self._metrics.count(f"rtamt_{reason}_total")

    def _headers(
        self, error: str, reason: str, origin: Mapping[str, str] = MappingProxyType({})
    ) -> list[tuple[str, bytes]]:
        headers = {
            "rtamt.error": error[:_LONGEST_ERROR],
            "rtamt.reason": reason,
            "rtamt.topic": self._settings.topic,
            **origin,
        }
        return [(name, text.encode(errors="replace")) for name, text in headers.items()]

    def _is_too_large(self, error: Any) -> bool:
        return bool(error.code() == self._kafka.KafkaError.MSG_SIZE_TOO_LARGE)

    def _bury_alone(self, message: Any, headers: Sequence[tuple[str, bytes]]) -> None:
        """Send a dead letter without key and value, which are too large: a worker would end at it again and again."""
        size = len(message.value() or b"") + len(message.key() or b"")
        omitted = ("rtamt.omitted", f"key and value: {size} bytes are too large for the topic".encode())
        self._produce(self._settings.dead_letters, None, None, [*headers, omitted])

    def _produce(self, topic: str, value: bytes | None, key: bytes | None, headers: Any = None) -> None:
        more = {} if headers is None else {"headers": headers}
        while not self._is_queued(topic, value, key, more):
            self._producer.poll(
                _WAIT
            )  # the broker is slower: each message is taken, or an error after its time-out
            self._fail()

    def _is_queued(self, *message: Any) -> bool:
        *given, more = message
        try:
            self._producer.produce(*given, **more)
        except BufferError:
            return False
        return True

    def _delivery_error(self, error: Any, message: Any) -> None:
        if error is None:
            return
        is_letter = message.topic() == self._settings.dead_letters and message.value() is not None
        if is_letter and self._is_too_large(error):
            self._bury_alone(message, message.headers() or [])
        elif self._failure is None:
            self._failure = f"the broker has not taken a message for '{message.topic()}': {error.str()}"

    def _fail(self) -> None:
        if self._failure is not None:
            raise UsageError(self._failure)

    def _trouble(self, error: Any) -> None:
        """Report what the client overcomes by itself, once each."""
        text = str(error.str())
        if error.fatal():
            self._failure = text
        elif text not in self._said and len(self._said) < 100:
            self._said.add(text)
            self._say(f"Kafka: {text}")

    # ---- partitions -----------------------------------------------------------------------------------

    def _position(self, number: int) -> Any:
        offset = self._partitions[number].offset
        at = self._kafka.OFFSET_BEGINNING if offset is None else offset
        return self._kafka.TopicPartition(self._settings.topic, number, at)

    def _assign(self, consumer: Any, places: Sequence[Any]) -> None:
        self._assigned_in_consume = True
        self._ended.clear()
        for place in places:
            number = place.partition
            known = None if self._checkpoints is None else self._checkpoints.load(number)
            if known is not None:
                shard = Shard(self._spec, state=known.state, **self._options)
                self._partitions[number] = _Partition(shard, known.offset)
                continue
            self._partitions[number] = _Partition(Shard(self._spec, **self._options), None)
            if not self._settings.beginning:
                _, end = consumer.get_watermark_offsets(place, timeout=_ANSWER)
                self._partitions[number].offset = end
                self._save([number])
        consumer.assign([self._position(place.partition) for place in places])

    def _revoke(self, _consumer: Any, places: Sequence[Any]) -> None:
        self._save([place.partition for place in places])
        self._lose(_consumer, places)

    def _lose(self, _consumer: Any, places: Sequence[Any]) -> None:
        """Forget partitions that another worker may have by now; its checkpoint is not touched."""
        self._assigned_in_consume = True
        for place in places:
            self._partitions.pop(place.partition, None)
            self._ended.discard(place.partition)

    def _save(self, numbers: Iterable[int]) -> None:
        """Write the checkpoints of partitions with new messages, after the broker has acknowledged their results."""
        changed = {
            number: partition
            for number in numbers
            if (partition := self._partitions.get(number)) is not None and partition.offset != partition.saved
        }
        if not changed:
            return
        while self._producer.flush(_WAIT):
            self._fail()
        self._fail()
        for number, partition in changed.items():
            assert partition.offset is not None
            if self._checkpoints is not None:
                state = partition.shard.snapshot()
                self._checkpoints.save(Checkpoint(self._settings.topic, number, partition.offset, state))
            partition.saved = partition.offset
        # For tools that show the lag of a group; a worker itself goes by its checkpoints.
        self._consumer.commit(offsets=[self._position(number) for number in changed], asynchronous=True)


def row_of(result: Result) -> bytes:
    """Return a result as JSON, with the same bytes each time.

    >>> from rtamt.scale.shard import Result
    >>> row_of(Result("car-1", 2.0, float("-inf")))
    b'{"key": "car-1", "time": 2.0, "robustness": "-inf", "satisfied": false}'
    """
    value = result.robustness + 0.0
    number = repr(value) if isfinite(value) else f'"{value}"'
    verdict = {True: "true", False: "false", None: "null"}[result.satisfied]
    named = "" if result.requirement is None else f', "requirement": {json.dumps(result.requirement)}'
    fields = f'"time": {result.time!r}, "robustness": {number}, "satisfied": {verdict}'
    return f'{{"key": {json.dumps(result.key)}{named}, {fields}}}'.encode()


def _seconds_of(message: Any) -> float:
    """Return the time of a message as the broker has it; NaN if it has none."""
    kind, milliseconds = message.timestamp()
    return milliseconds / 1000 if kind else nan


def _text(error: Any) -> str:
    first = error.args[0] if error.args else error
    return str(first.str() if hasattr(first, "str") else first).rstrip(".")
