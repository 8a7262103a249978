"""The worker on Kafka, against librdkafka's mock cluster in this process; some workers are processes of their own."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from confluent_kafka import Consumer, KafkaError, Producer, TopicPartition

import rtamt
from rtamt.cli import main
from rtamt.metrics import METRICS, Metrics
from rtamt.scale.kafka import Worker
from rtamt.scale.kafka_settings import Settings
from rtamt.scale.messages import MessageReader, decode_json
from tests.support.brokers import broker

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


@pytest.fixture(scope="module")
def brokers():
    with broker() as address:
        yield address


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


def test_results_are_those_of_each_key_offline(brokers, tmp_path):
    random = np.random.default_rng(1)
    series = {f"car-{i}": random.uniform(0, 60, 5).round(3).tolist() for i in range(100)}
    send(brokers, "cars", [sample(key, t, series[key][t]) for t in range(5) for key in series])
    metrics = Metrics()
    first = worker(brokers, "cars", tmp_path, metrics=metrics)
    first.run()
    assert first.counts["samples"] == 500
    found = rows(brokers, "cars")
    assert sorted((row["key"], row["time"], row["robustness"]) for row in found) == offline(series)
    assert all(row["satisfied"] == (row["robustness"] > 0) for row in found)
    assert first.counts["violations"] == sum(not row["satisfied"] for row in found) > 0
    values = {name: sum(metrics.values(name).values()) for name in METRICS}
    assert values["rtamt_samples_total"] == 500
    assert values["rtamt_verdicts_total"] == 300
    assert values["rtamt_violations_total"] == first.counts["violations"]
    assert values["rtamt_lag_messages"] == 0
    assert (values["rtamt_keys"], len(metrics.values("rtamt_lag_messages"))) == (100, 4)
    again = worker(brokers, "cars", tmp_path)
    again.run()
    assert not again.counts


def test_what_is_no_sample_goes_to_the_dead_letters(brokers, tmp_path):
    good = [sample(key, t, 7) for t in range(4) for key in ("a", "b")]
    wrong = [
        ((b"a", b"nonsense"), "rejected", "the message is not JSON: Expecting value at column 1"),
        ((b"a", b"[" * 10_000), "rejected", "the message is not JSON to read: it is nested too deeply"),
        (
            sample("a", 1, 7),
            "late",
            "key 'a': time does not increase at sample 4: 1 s comes after 3 s; sort the samples and drop repeated "
            "timestamps",
        ),
        ((b"b", None), "rejected", "the message has no value"),
        (
            (None, good[0][1]),
            "rejected",
            "the message has no key: give it one, or name the field that holds it with --key",
        ),
    ]
    after = [sample(key, 4, 31) for key in ("a", "b")]
    send(brokers, "wrong", [*good, *(message for message, _, _ in wrong), *after])
    working = worker(brokers, "wrong", tmp_path)
    working.run()
    assert working.counts == Counter(samples=10, results=6, violations=2, late=1, rejected=4)
    assert {(row["key"], row["time"], row["robustness"]) for row in rows(brokers, "wrong")} == {
        (key, float(t), 23.0 if t < 2 else -1.0) for key in "ab" for t in range(3)
    }
    letters = receive(brokers, "wrong.dead-letters")
    found = []
    for letter in letters:
        headers = {name: text.decode() for name, text in letter.headers()}
        assert headers["rtamt.topic"] == "wrong"
        assert {"rtamt.partition", "rtamt.offset"} <= headers.keys()
        found.append(((letter.key(), letter.value()), headers["rtamt.reason"], headers["rtamt.error"]))
    assert sorted(found, key=repr) == sorted(wrong, key=repr)


def test_a_message_too_large_for_the_dead_letters_does_not_end_the_worker(brokers, tmp_path):
    producer = Producer({"bootstrap.servers": brokers, "message.max.bytes": 3_000_000})
    for key, value in ((b"a", b"x" * 1_000_100), sample("a", 0, 7)):
        producer.produce("large", value, key)
    assert producer.flush(30) == 0
    working = worker(brokers, "large", tmp_path)
    working.run()
    assert working.counts == Counter(samples=1, rejected=1)
    (letter,) = receive(brokers, "large.dead-letters")
    headers = dict(letter.headers())
    assert (letter.key(), letter.value()) == (None, None)
    assert headers["rtamt.omitted"] == b"key and value: 1000101 bytes are too large for the topic"
    assert {"rtamt.error", "rtamt.partition", "rtamt.offset"} <= headers.keys()


def test_a_dead_letter_that_the_broker_finds_too_large_is_sent_without_its_value(brokers, tmp_path):
    class Returned:
        """A message with its delivery report."""

        topic = staticmethod(lambda: "returned.dead-letters")
        key = staticmethod(lambda: b"a")
        value = staticmethod(lambda: b"x" * 100)
        headers = staticmethod(lambda: [("rtamt.offset", b"7")])

    send(brokers, "returned", [sample("a", 0, 7)])
    working = worker(brokers, "returned", tmp_path)
    working._undelivered(KafkaError(KafkaError.MSG_SIZE_TOO_LARGE), Returned)
    working.run()
    (letter,) = receive(brokers, "returned.dead-letters")
    omitted = ("rtamt.omitted", b"key and value: 101 bytes are too large for the topic")
    assert (letter.value(), letter.headers()) == (None, [("rtamt.offset", b"7"), omitted])


def test_late_samples_and_those_that_wait_are_in_the_checkpoint(brokers, tmp_path):
    speeds = [20, 31, 25, 28, 22, 29]
    late = [0, 2, 1, 4, 3, 5]
    for part in (late[:2], late[2:], [0]):
        send(brokers, "late", [sample("a", t, speeds[t]) for t in part])
        said = process(brokers, "late", tmp_path, "--until-end", "--lateness", "2s")
        _, text = said.communicate(timeout=60)
        assert said.returncode == 0, text
    assert text == "rtamt: 0 samples, 0 results, 0 of them violations, 1 late, 0 rejected\n"
    found = [(row["key"], row["time"], row["robustness"]) for row in rows(brokers, "late")]
    assert found == offline({"a": speeds})[: len(found)]
    assert len(found) == 2  # up to 3 s, which 5 s has released, less the horizon


def test_several_dense_specifications_and_keys_that_expire(brokers, tmp_path):
    specs = tmp_path / "specs"
    specs.mkdir()
    (specs / "slow.stl").write_text("require SLOW: always[0:1](speed <= 30)")
    (specs / "calm.stl").write_text("require CALM: acc <= 2; require STILL: historically(acc <= 5)")
    producer = Producer({"bootstrap.servers": brokers, "linger.ms": 5})
    begun = 1_700_000_000_000
    sent = [
        ("a", begun, {"time": 0, "speed": 20, "acc": 1}),
        ("a", begun + 1, {"time": 0.5, "acc": 6}),
        ("b", begun + 2, {"time": 0, "speed": 10}),
        ("b", begun + 3, {"time": 1}),
        ("a", begun + 4, {"time": 1.5, "speed": 25}),
        ("b", begun + 70_000, {"time": 70, "speed": 20, "acc": 1}),
        ("a", begun + 70_001, {"time": 0.25, "acc": 3}),
    ]
    for key, milliseconds, value in sent:
        producer.produce("dense", json.dumps(value), key, partition=0, timestamp=milliseconds)
    assert producer.flush(30) == 0
    more = ["--until-end", "--time", "dense", "--expire-after", "1min"]
    _, text = process(brokers, "dense", tmp_path, *more, specs=[str(specs)]).communicate(timeout=60)
    assert text == (
        "rtamt: 6 samples, 10 results, 3 of them violations, 0 late, 1 rejected, 2 keys expired\n"
    )
    found = [list(row.values()) for row in rows(brokers, "dense")]
    assert sorted(found) == [
        ["a", "CALM", 0.0, 1.0, True],
        ["a", "CALM", 0.25, -1.0, False],
        ["a", "CALM", 0.5, -4.0, False],
        ["a", "SLOW", 0.0, 10.0, True],
        ["a", "SLOW", 0.5, 5.0, True],
        ["a", "STILL", 0.0, 4.0, True],
        ["a", "STILL", 0.25, 2.0, True],
        ["a", "STILL", 0.5, -1.0, False],
        ["b", "CALM", 70.0, 1.0, True],
        ["b", "STILL", 70.0, 4.0, True],
    ]


def test_partitions_move_between_workers_with_their_state(brokers, tmp_path):
    keys = [f"car-{i}" for i in range(40)]
    series = {key: [20 + i % 15, 25, 28 - i % 7, 31, 22] for i, key in enumerate(keys)}
    workers = [worker(brokers, "moving", tmp_path, until_end=False, interval=0.1) for _ in range(2)]
    threads, failures = [], []

    def run(each):
        try:
            each.run()
        except rtamt.StlError as error:
            failures.append(error)

    def start(each):
        threads.append(threading.Thread(target=run, args=(each,)))
        threads[-1].start()

    def wait_for(count):
        deadline = time.monotonic() + 60
        while sum(each.counts["samples"] for each in workers) < count:
            assert not failures
            assert time.monotonic() < deadline
            time.sleep(0.02)

    try:
        send(brokers, "moving", [sample(key, t, series[key][t]) for t in range(2) for key in keys])
        start(workers[0])
        wait_for(80)
        start(workers[1])
        deadline = time.monotonic() + 60
        while workers[1].keys == 0:  # has partitions, and with them the keys that the other one had
            assert time.monotonic() < deadline
            time.sleep(0.02)
        send(brokers, "moving", [sample(key, t, series[key][t]) for t in range(2, 4) for key in keys])
        wait_for(160)
        workers[0].stop()
        threads[0].join(30)
        send(brokers, "moving", [sample(key, 4, series[key][4]) for key in keys])
        wait_for(200)
    finally:
        for each in workers:
            each.stop()
        for thread in threads:
            thread.join(30)
    assert not failures
    assert all(each.counts["results"] for each in workers)
    found = {(row["key"], row["time"], row["robustness"]) for row in rows(brokers, "moving")}
    assert sorted(found) == offline(series)


def process(brokers, topic, place, *more, specs=(FORMULA,)):
    command = [sys.executable, "-m", "rtamt", "worker", *specs, "--brokers", brokers, "--topic", topic]
    command += ["--checkpoint", str(place), "--interval", "0.1", *OPTIONS, *more]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True)


def test_nothing_is_lost_or_different_when_workers_are_killed(brokers, tmp_path):
    random = np.random.default_rng(7)
    samples = 40
    series = {f"car-{i}": random.uniform(0, 60, samples).round(3).tolist() for i in range(300)}
    messages = [sample(key, t, series[key][t]) for t in range(samples) for key in series]
    part = len(messages) // 4
    for kill in range(3):
        send(brokers, "killed", messages[kill * part : (kill + 1) * part])
        running = process(brokers, "killed", tmp_path)
        try:
            _wait_for_results(brokers, "killed", int(random.integers(1, part // 2)) + kill * part // 2)
        finally:
            os.kill(running.pid, signal.SIGKILL)
            running.communicate()
        assert running.returncode == -signal.SIGKILL
    send(brokers, "killed", messages[3 * part :])
    last = process(brokers, "killed", tmp_path, "--until-end")
    _, said = last.communicate(timeout=120)
    assert (last.returncode, said[-11:]) == (0, "0 rejected\n")
    found = [(row["key"], row["time"], row["robustness"]) for row in rows(brokers, "killed")]
    expected = offline(series)
    assert sorted(set(found)) == expected
    assert len(found) >= len(expected)


def _wait_for_results(brokers, topic, count):
    consumer = Consumer({"bootstrap.servers": brokers, "group.id": "counter"})
    name, deadline = f"{topic}.robustness", time.monotonic() + 100
    try:
        while True:
            numbers = consumer.list_topics(name, 10).topics[name].partitions
            if sum(consumer.get_watermark_offsets(TopicPartition(name, i), 10)[1] for i in numbers) >= count:
                return
            assert time.monotonic() < deadline
            time.sleep(0.01)
    finally:
        consumer.close()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_a_worker_with_a_checkpoint(brokers, tmp_path, number):
    topic = f"stopped-{number.name}"
    send(brokers, topic, [sample("a", t, 7) for t in range(5)])
    running = process(brokers, topic, tmp_path, "--interval", "3600")
    try:
        _wait_for_results(brokers, topic, 3)
        running.send_signal(number)
        _, said = running.communicate(timeout=60)
    finally:
        running.kill()
    assert (running.returncode, said) == (
        0,
        "rtamt: 5 samples, 3 results, 0 of them violations, 0 late, 0 rejected\n",
    )
    assert len(list((tmp_path / "rtamt" / topic).iterdir())) == 1
    again = process(brokers, topic, tmp_path, "--until-end")
    _, said = again.communicate(timeout=60)
    assert said == "rtamt: 0 samples, 0 results, 0 of them violations, 0 late, 0 rejected\n"


def test_samples_that_the_broker_no_longer_has_are_an_error(brokers, tmp_path):
    send(brokers, "gone", [sample("a", t, 7) for t in range(5)])
    worker(brokers, "gone", tmp_path).run()
    from rtamt.scale.checkpoints import Checkpoint, Checkpoints

    stored = Checkpoints(str(tmp_path), "group-gone", "gone")
    (known,) = filter(None, map(stored.load, range(4)))
    stored.save(Checkpoint("gone", known.partition, 1000, known.state))
    with pytest.raises(rtamt.UsageError) as caught:
        worker(brokers, "gone", tmp_path).run()
    assert str(caught.value) == (
        f"partition {known.partition} of 'gone' no longer has the message at which its checkpoint is: "
        f"the samples in between are lost; delete the checkpoint to begin with the oldest message"
    )


def test_a_damaged_checkpoint_stops_the_worker_and_stays(brokers, tmp_path):
    send(brokers, "damaged", [sample("a", t, 7) for t in range(5)])
    worker(brokers, "damaged", tmp_path).run()
    (path,) = (tmp_path / "group-damaged" / "damaged").iterdir()
    path.write_bytes(path.read_bytes()[:-1])
    before = path.read_bytes()
    with pytest.raises(rtamt.UsageError) as caught:
        worker(brokers, "damaged", tmp_path).run()
    assert str(caught.value) == (
        f"'{path}' is no checkpoint of rtamt, or a damaged one: delete it to read the partition from its start"
    )
    assert path.read_bytes() == before


def test_latest_begins_with_new_messages_and_stays_there(brokers, tmp_path):
    send(brokers, "latest", [sample("a", t, 7) for t in range(5)])
    first = worker(brokers, "latest", tmp_path, beginning=False)
    first.run()
    assert not first.counts
    send(brokers, "latest", [sample("a", t, 8) for t in range(5, 8)])
    second = worker(brokers, "latest", tmp_path, beginning=False)
    second.run()
    assert rows(brokers, "latest") == [{"key": "a", "time": 5.0, "robustness": 22.0, "satisfied": True}]


def test_the_broker_of_the_example_is_for_this_machine_alone():
    import yaml

    folder = Path(__file__).parents[3] / "examples" / "fleet"
    services = yaml.safe_load((folder / "compose.yaml").read_text())["services"]
    assert [port for service in services.values() for port in service["ports"]] == ["127.0.0.1:9092:9092"]
    assert rtamt.load(folder / "limits.stl").input_names == ("speed", "brake")


def command(*more):
    return main(["worker", FORMULA, "--brokers", "127.0.0.1:9", "--topic", "cars", *more])


def test_mistakes_on_the_command_line(capsys, tmp_path):
    secrets = tmp_path / "client"
    secrets.write_text("# of the operator\nsasl.password\n")
    for more, error in (
        (["--client", "group.id=x"], "the setting 'group.id' of the client cannot be chosen: --group"),
        (
            ["--client", "consumer.no.such=1"],
            'the settings of the client are wrong: No such configuration property: "no.such"',
        ),
        (
            ["--client-file", str(secrets)],
            "a setting of the client is NAME=VALUE, such as security.protocol=SSL",
        ),
        (["--interval", "0"], "--interval is 0; give a number of seconds, such as 10"),
        (
            ["--output-topic", "cars"],
            "the topics of samples, results and dead letters must be three different ones",
        ),
        (
            ["--schema", "1=a", "--schema", "1=b"],
            "--schema 1=b: there is another schema with the same ID, or without one",
        ),
        (["--time-column", ""], "a worker needs the time of each sample: name its field with --time-column"),
    ):
        assert command(*more) == 2
        assert capsys.readouterr().err == f"rtamt: {error}\n"


def test_without_the_extra(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "confluent_kafka", None)
    assert command() == 2
    assert capsys.readouterr().err == (
        "rtamt: a worker on Kafka needs the package 'confluent_kafka', which is not installed: "
        "pip install 'rtamt[kafka]'\n"
    )
