"""``rtamt worker``: monitor the samples of a Kafka topic, one partition a shard."""

from __future__ import annotations

import os
import signal
from typing import TYPE_CHECKING, Any

from rtamt.cli.arguments import specification_paths
from rtamt.cli.command import (
    METRICS,
    READING,
    CommandError,
    add_specification_options,
    add_stamp_options,
    add_time_option,
    options,
    read_specifications,
)
from rtamt.cli.parser import OK, complain
from rtamt.files import open_text
from rtamt.language.units.durations import duration
from rtamt.metrics import add_metrics_options

if TYPE_CHECKING:
    import argparse
    from collections import Counter

    from rtamt.fleet.suite import Suite
    from rtamt.metrics import Metrics
    from rtamt.specification import Specification

_DESCRIPTION = """\
Monitor the samples of a Kafka topic, and write the robustness to another one. Workers of one group share the
partitions of the topic; each partition has a fleet of monitors, one for each key. SIGTERM and Ctrl-C end a worker
cleanly. It requires the package confluent-kafka: pip install 'rtamt[kafka]'."""

_EPILOG = """\
messages: one sample each, the values by name: {"time": 0.0, "speed": 20.5}, fields of nested objects with dots.
The key, such as a vehicle, is the key of the message, or the field that --key names. The time is a number or a date in
a field time, t, timestamp, stamp or datetime, or the one that --time-column names. The samples of one key are in one
partition, one period apart; after a gap, the trace of the key starts again. They are in the order of their times, or
come late by at most --lateness.

With --time dense, each variable has samples of its own: a message may lack some, and its time is after that of the
sample before of the same variable. There are no gaps and no lateness then.

output: {"key": "car-1", "time": 0.0, "robustness": 3.0, "satisfied": true}, with the key as the key of the message;
the time is that of the sample one horizon before, in dense time one from which on the robustness holds. Of several
requirements, each has its results, with its name in "requirement"; a sample without a value for one of them is
rejected for all. "satisfied" is null at robustness 0, whose sign does not decide it;
with --semantics boolean it is always decided. Infinities are the strings "inf" and "-inf", because JSON has none.

A message that is not a sample, and a sample whose time is not after the one before of its key, or behind by more than
--lateness, go to the topic of dead letters unchanged, with the headers rtamt.error, rtamt.reason (rejected or late),
rtamt.topic, rtamt.partition and rtamt.offset. One that is too large for that topic goes there without key and value,
with the header rtamt.omitted. With --lateness, a sample that has waited and then has no value is discarded: its key
and the error go there. The other samples of the key are not affected.

With --expire-after, keys without messages are forgotten. What waits of them is monitored before that; their next sample
starts a trace. A key expires by the timestamps of the messages of its partition, so that a worker that resumes has the
same results. A partition without messages forgets nothing.

Checkpoints are written after the broker has confirmed the results: a state and an offset, in one object for each
partition. After a crash or a kill, the same command continues there, and nothing is lost. Results after the last
checkpoint may be sent twice, with the same key, time and robustness. Without --checkpoint each start reads the topic
from its beginning.

Avro: --schema FILE.avsc. Protobuf: --schema FILE, written with protoc --include_imports --descriptor_set_out=FILE,
and --message. With a schema registry, messages begin with an ID: --schema 7=FILE, repeatable.

examples:
  rtamt worker limits.stl --brokers localhost:9092 --topic cars --checkpoint /var/lib/rtamt
  rtamt worker limits.stl --brokers localhost:9092 --topic cars --format avro --schema cars.avsc
  rtamt worker limits.stl --brokers localhost:9092 --topic cars --checkpoint /var/lib/rtamt --expire-after 1h"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_specification_options(parser)
    parser.add_argument(
        "more",
        metavar="SPEC",
        nargs="*",
        help="more specifications; a folder: those in it. Each requirement has results of its own",
    )
    add_time_option(parser)
    add_stamp_options(parser, "field")
    reading = options(parser, READING)
    reading.add_argument(
        "--format", default="json", metavar="{json,avro,protobuf}", help="of the values (default: json)"
    )
    reading.add_argument(
        "--schema",
        action="append",
        default=[],
        metavar="[ID=]FILE",
        help="the schema of the values; with an ID for messages of a schema registry; repeatable",
    )
    reading.add_argument("--message", metavar="NAME", help="the full name of the type, for protobuf")
    reading.add_argument("--key", metavar="FIELD", help="the field with the key (default: the message key)")
    reading.add_argument(
        "--tolerance",
        type=float,
        metavar="FRACTION",
        help="the allowed deviation of the gap between samples, as a fraction of the period",
    )
    reading.add_argument(
        "--lateness",
        metavar="DURATION",
        help="how late a sample may arrive: seconds, or with a unit, such as 2s; samples of a key then come in any "
        "order, and wait until one is newer by that (default: they come in the order of their times)",
    )
    reading.add_argument(
        "--expire-after",
        metavar="DURATION",
        help="forget a key without a message for so long, by the timestamps of the messages of its partition: seconds, "
        "or with a unit, such as 30min (default: never)",
    )
    group = options(parser, "Kafka")
    group.add_argument("--brokers", required=True, metavar="HOST:PORT", help="brokers, separated by commas")
    group.add_argument("--topic", required=True, metavar="NAME", help="the topic of the samples")
    group.add_argument("--group", default="rtamt", metavar="NAME", help="the consumer group (default: rtamt)")
    group.add_argument("--output-topic", metavar="NAME", help="(default: TOPIC.robustness)")
    group.add_argument("--dead-letter-topic", metavar="NAME", help="(default: TOPIC.dead-letters)")
    group.add_argument(
        "--checkpoint",
        metavar="PLACE",
        help="a folder, or an address of an object store, such as s3://bucket/cars",
    )
    group.add_argument(
        "--interval",
        type=float,
        default=10.0,
        metavar="SECONDS",
        help="between checkpoints (default: 10)",
    )
    group.add_argument(
        "--from",
        dest="start",
        choices=("earliest", "latest"),
        default="earliest",
        help="where to begin in a partition without a checkpoint (default: earliest)",
    )
    group.add_argument("--until-end", action="store_true", help="end when all messages are read")
    group.add_argument(
        "--client",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="a setting of librdkafka, such as security.protocol=SSL, or of one client only, with consumer. or "
        "producer. before it; repeatable",
    )
    group.add_argument(
        "--client-file", metavar="FILE", help="such settings, one a line; for what others must not see"
    )
    group.add_argument(
        "--capacity",
        type=int,
        metavar="N",
        help="the largest number of keys of a partition (default: 1000000)",
    )
    add_metrics_options(options(parser, METRICS))


def run(args: argparse.Namespace) -> int:
    """Work until a signal, or the end of the messages."""
    from rtamt.metrics import exported

    with exported(args) as metrics:
        counts = _run_job(args, metrics)
    expired = f", {counts['expired']} keys expired" if counts["expired"] else ""
    complain(
        f"{counts['samples']} samples, {counts['results']} results, {counts['violations']} of them violations, "
        f"{counts['late']} late, {counts['rejected']} rejected{expired}"
    )
    return OK


def _run_job(args: argparse.Namespace, metrics: Metrics | None) -> Counter[str]:
    from rtamt.scale.kafka import Worker
    from rtamt.scale.kafka_settings import Settings
    from rtamt.scale.messages import MessageReader, decoder
    from rtamt.specification import Specification

    if not args.interval > 0:
        raise CommandError(f"--interval is {args.interval:g}; give a number of seconds, such as 10")
    spec = _spec_of(args)
    decode = decoder(args.format, _schemas(args.schema), args.message)
    if args.time_column == "":
        raise CommandError("a worker needs the time of each sample: name its field with --time-column")
    reader = MessageReader(spec, decode, key=args.key, time=args.time_column, unit=args.time_unit)
    settings = Settings(
        args.brokers,
        args.topic,
        args.group,
        args.output_topic or f"{args.topic}.robustness",
        args.dead_letter_topic or f"{args.topic}.dead-letters",
        checkpoints=args.checkpoint,
        interval=args.interval,
        beginning=args.start == "earliest",
        until_end=args.until_end,
        client=_client(args.client, args.client_file),
    )
    if len({settings.topic, settings.output, settings.dead_letters}) < 3:
        raise CommandError("the topics of samples, results and dead letters must be three different ones")
    given: dict[str, Any] = {} if args.capacity is None else {"capacity": args.capacity}
    if args.tolerance is not None and isinstance(spec, Specification):  # a suite has it
        given["tolerance"] = args.tolerance
    given |= {} if args.lateness is None else {"lateness": args.lateness}
    given |= {} if args.expire_after is None else {"expire_after": _lifetime(args.expire_after)}
    worker = Worker(spec, reader, settings, say=complain, metrics=metrics, **given)
    before = [
        (each, signal.signal(each, lambda *_: worker.stop())) for each in (signal.SIGTERM, signal.SIGINT)
    ]
    try:
        worker.run()
    finally:
        for each, handler in before:
            signal.signal(each, handler)
    return worker.counts


def _spec_of(args: argparse.Namespace) -> Specification | Suite:
    """Return the specification, or a suite of all requirements if there are several."""
    from rtamt.fleet.suite import Suite

    specs = read_specifications(args, args.time, specification_paths([args.spec, *args.more]))
    if len(specs) == 1 and len(specs[0].requirements) == 1:
        return specs[0]
    return Suite(specs, tolerance=args.tolerance)


def _lifetime(given: str) -> float:
    seconds = duration(given)
    if seconds <= 0:
        raise CommandError(f"--expire-after is {given}; give a duration, such as 30min")
    return float(seconds)


def _schemas(given: list[str]) -> dict[int | None, str]:
    found: dict[int | None, str] = {}
    for each in given:
        number, mark, path = each.partition("=")
        known = mark and number.isdecimal() and not os.path.exists(each)
        key, path = (int(number), path) if known else (None, each)
        if key in found:
            raise CommandError(f"--schema {each}: there is another schema with the same ID, or without one")
        found[key] = path
    return found


def _client(given: list[str], path: str | None) -> dict[str, str]:
    lines: list[str] = []
    if path is not None:
        try:
            with open_text(path, "utf-8") as file:
                lines = [line.strip() for line in file]
        except (OSError, UnicodeDecodeError) as error:
            raise CommandError(
                f"cannot read '{path}': {getattr(error, 'strerror', 'not UTF-8 text')}"
            ) from None
    found: dict[str, str] = {}
    for each in [*(line for line in lines if line and not line.startswith("#")), *given]:
        name, mark, value = each.partition("=")
        if not mark:  # whatever it is, it may be a password
            raise CommandError("a setting of the client is NAME=VALUE, such as security.protocol=SSL")
        found[name.strip()] = value.strip()
    return found
