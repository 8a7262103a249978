"""What a sample costs a worker on Kafka, and whether one that is killed at random moments loses or changes results.

``python benchmarks/worker.py [KEYS] [SAMPLES] [KILLS]``, by default 100 000 keys, 6 samples each, 10 kills. The
broker is the mock cluster of librdkafka in this process. First a worker takes all samples without a kill, timed; then
workers take them again, and each is killed with SIGKILL at a random moment of the stream, until the last one ends.
Each result must be that of ``evaluate`` on the samples of its key, and each must be there: results that were sent again
are equal, and are dropped by key and time.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from confluent_kafka import Consumer, Producer, TopicPartition

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.support.brokers import broker

import rtamt

FORMULA = "always[0:2](speed <= 30)"
PARTITIONS = 16
CLIENT = ["session.timeout.ms=2000", "heartbeat.interval.ms=200"]
#: Seconds after which a run has failed.
_LIMIT = 1800


def send(address: str, topic: str, speeds: np.ndarray) -> None:
    """Send the samples of all keys, instant by instant."""
    producer = Producer(
        {"bootstrap.servers": address, "compression.type": "lz4", "queue.buffering.max.messages": 10_000_000}
    )
    keys = [f"car-{i}".encode() for i in range(len(speeds))]
    for at in range(speeds.shape[1]):
        for key, speed in zip(keys, speeds[:, at].tolist(), strict=True):
            producer.produce(topic, f'{{"time": {at}, "speed": {speed}}}'.encode(), key)
            producer.poll(0)
    assert producer.flush(120) == 0


def start(address: str, topic: str, place: str, *more: str) -> subprocess.Popen[str]:
    """Start a worker."""
    command = [sys.executable, "-m", "rtamt", "worker", FORMULA, "--brokers", address, "--topic", topic]
    command += ["--checkpoint", place, "--interval", "1", "--group", f"group-{topic}", *more]
    command += [f"--client=consumer.{each}" for each in CLIENT]
    command += ["--client=producer.compression.type=lz4"]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True)


class Output:
    """The results of a topic."""

    def __init__(self, address: str, topic: str) -> None:
        self._topic = f"{topic}.robustness"
        self._consumer = Consumer(
            {
                "bootstrap.servers": address,
                "group.id": "output",
                "enable.auto.commit": False,
                "fetch.wait.max.ms": 10,
            }
        )

    def _places(self) -> list[TopicPartition]:
        return [TopicPartition(self._topic, i, 0) for i in range(PARTITIONS)]

    def count(self) -> int:
        """Return how many results there are, those that were sent again included."""
        ends = [self._consumer.get_watermark_offsets(place, 10) for place in self._places()]
        assert all(low == 0 for low, _ in ends), "the broker has deleted results"
        return sum(high for _, high in ends)

    def read(self) -> list[Any]:
        """Return all results."""
        total, found, limit = self.count(), [], time.monotonic() + _LIMIT
        self._consumer.assign(self._places())
        while len(found) < total:
            assert time.monotonic() < limit
            found += [json.loads(message.value()) for message in self._consumer.consume(10_000, 0.2)]
        self._consumer.close()
        return found


def compare(found: list[Any], speeds: np.ndarray) -> tuple[int, int, int]:
    """Return how many results are missing, different from those of ``evaluate``, and sent more than once."""
    spec = rtamt.parse(FORMULA)
    stamps = np.arange(speeds.shape[1], dtype=float)
    known: dict[tuple[str, float], float] = {}
    different = 0
    for row in found:
        place = row["key"], row["time"]
        different += known.setdefault(place, row["robustness"]) != row["robustness"]
    missing, again = 0, len(found) - len(known)
    for i, own in enumerate(speeds):
        values = spec.evaluate({"time": stamps, "speed": own}).signal.values[:-2].tolist()
        for at, value in enumerate(values):
            got = known.pop((f"car-{i}", float(at)), None)
            missing += got is None
            different += got is not None and got != value
    return missing, different + len(known), again


def main() -> None:
    """Run both, and print what came of them; exit with 1 if a result is missing or different."""
    given = [int(text) for text in sys.argv[1:]]
    keys, samples, kills = (*given, *(100_000, 6, 10)[len(given) :])
    random = np.random.default_rng(1)
    speeds = random.uniform(0, 60, (keys, samples)).round(3)
    total = keys * (samples - 2)
    topics = {name: PARTITIONS for topic in ("timed", "killed") for name in (topic, f"{topic}.robustness")}
    with broker(**topics) as address, tempfile.TemporaryDirectory() as place:
        send(address, "timed", speeds)
        begin, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
        timed = start(address, "timed", place, "--until-end")
        timed.communicate(timeout=_LIMIT)
        spent = resource.getrusage(resource.RUSAGE_CHILDREN)
        processor = spent.ru_utime + spent.ru_stime - before.ru_utime - before.ru_stime
        size = sum(path.stat().st_size for path in Path(place).rglob("*.checkpoint"))
        print(
            f"{keys} keys, {samples} samples each: {time.monotonic() - begin:.1f} s, {processor:.1f} s of processor, "
            f"{processor / (keys * samples) * 1e6:.1f} us a sample; {size / keys:.0f} bytes of checkpoint a key"
        )
        print(
            "not killed: {} missing, {} different, {} sent again".format(
                *compare(Output(address, "timed").read(), speeds)
            )
        )

        send(address, "killed", speeds)
        output = Output(address, "killed")
        for _ in range(kills):
            running = start(address, "killed", place)
            moment = output.count() + int(random.integers(1, 2 * total // kills))
            limit, last_count, changed = time.monotonic() + _LIMIT, -1, time.monotonic()
            while (count := output.count()) < moment and time.monotonic() < min(limit, changed + 10):
                if count != last_count:
                    last_count, changed = count, time.monotonic()
            time.sleep(float(random.uniform(0, 0.5)))  # at any moment of a batch or a checkpoint
            os.kill(running.pid, signal.SIGKILL)
            running.communicate()
            assert running.returncode == -signal.SIGKILL
            print(f"killed after {output.count()} results", flush=True)
        last = start(address, "killed", place, "--until-end")
        _, said = last.communicate(timeout=_LIMIT)
        print(said.strip())
        missing, different, again = compare(output.read(), speeds)
        print(
            f"killed {kills} times: {missing} missing, {different} different, {again} sent again of {total}"
        )
    if missing or different or last.returncode:
        sys.exit(1)


if __name__ == "__main__":
    main()
