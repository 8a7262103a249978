"""Results that several tests export, and MCAP files read by the reader of the format's authors."""

import json
from pathlib import Path

from mcap.reader import make_reader

import rtamt

#: A start whose doubles are 0.2 µs apart.
EPOCH = 1_700_000_000_100_000_001

LIMITS = """
input float speed
input bool brake
require SPEED "not too fast": always(speed <= 30)
require BRAKE: always(speed >= 25 -> eventually[0:1](brake))
"""


def drive():
    """Return the result of a drive with two episodes of violation."""
    return rtamt.parse(LIMITS).evaluate(
        {"time": [0, 1, 2, 3, 4], "speed": [20, 32, 31, 20, 33], "brake": [False, False, True, False, True]}
    )


def messages(path):
    """Return the messages of a file: by topic, (nanoseconds, message)."""
    found = {}
    with Path(path).open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
            assert message.log_time == message.publish_time
            found.setdefault(channel.topic, []).append((message.log_time, json.loads(message.data)))
    return found


def topics(path):
    """Return the topics of a file: the schema and the metadata of each."""
    with Path(path).open("rb") as file:
        summary = make_reader(file).get_summary()
    return {
        channel.topic: (json.loads(summary.schemas[channel.schema_id].data), dict(channel.metadata))
        for channel in summary.channels.values()
    }
