"""The worker on Kafka, against librdkafka's mock cluster in this process."""

import threading
import time
from collections import Counter

import numpy as np
import pytest
from confluent_kafka import KafkaError, Producer

import rtamt
from rtamt.metrics import METRICS, Metrics
from tests.unit.scale.kafka_topics import offline, receive, rows, sample, send, worker


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
    working._delivery_error(KafkaError(KafkaError.MSG_SIZE_TOO_LARGE), Returned)
    working.run()
    (letter,) = receive(brokers, "returned.dead-letters")
    omitted = ("rtamt.omitted", b"key and value: 101 bytes are too large for the topic")
    assert (letter.value(), letter.headers()) == (None, [("rtamt.offset", b"7"), omitted])


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
