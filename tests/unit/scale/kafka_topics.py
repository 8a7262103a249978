"""Samples and results in topics of a mock cluster, and a worker on them."""

import json
import time

import numpy as np
from confluent_kafka import Consumer, Producer, TopicPartition

import rtamt
from rtamt.scale.kafka import Worker
from rtamt.scale.kafka_settings import Settings
from rtamt.scale.messages import MessageReader, decode_json

FORMULA = "always[0:2](speed <= 30)"
SPEC = rtamt.parse(FORMULA)
PARTITIONS = 2
#: A killed member keeps its partitions for so long.
CLIENT = {
    "consumer.session.timeout.ms": "1500",
    "consumer.heartbeat.interval.ms": "200",
    "producer.linger.ms": "5",
}
OPTIONS = [f"--client={name}={value}" for name, value in CLIENT.items()]


def send(brokers, topic, messages):
    """Send pairs of key and value; a key has one partition."""
    producer = Producer({"bootstrap.servers": brokers, "linger.ms": 5})
    for key, value in messages:
        producer.produce(topic, value, key)
    assert producer.flush(30) == 0


def sample(key, at, speed):
    return key.encode(), json.dumps({"time": at, "speed": speed}).encode()


def receive(brokers, topic):
    """Return all messages of a topic so far."""
    consumer = Consumer({"bootstrap.servers": brokers, "group.id": "reader", "enable.auto.commit": False})
    try:
        places = [
            TopicPartition(topic, i, 0) for i in consumer.list_topics(topic, 10).topics[topic].partitions
        ]
        ends = {place.partition: consumer.get_watermark_offsets(place, 10)[1] for place in places}
        consumer.assign(places)
        found, deadline = [], time.monotonic() + 60
        while len(found) < sum(ends.values()):
            assert time.monotonic() < deadline
            found += consumer.consume(1000, 0.1)
        assert all(message.error() is None for message in found)
        return found
    finally:
        consumer.close()


def rows(brokers, topic):
    return [json.loads(message.value()) for message in receive(brokers, f"{topic}.robustness")]


def worker(brokers, topic, place, metrics=None, **changes):
    options = {"until_end": True, "checkpoints": str(place), "client": CLIENT, "interval": 0.2} | changes
    names = (topic, f"group-{topic}", f"{topic}.robustness", f"{topic}.dead-letters")
    return Worker(
        SPEC, MessageReader(SPEC, decode_json), Settings(brokers, *names, **options), metrics=metrics
    )


def offline(series):
    """Return what each key has offline: key, time and robustness, up to the horizon before its last sample."""
    found = []
    for key, speeds in series.items():
        robustness = SPEC.evaluate({"time": np.arange(len(speeds), dtype=float), "speed": speeds}).signal
        found += [
            (key, float(t), float(r)) for t, r in zip(robustness.times, robustness.values, strict=True)
        ][:-2]
    return sorted(found)
