"""Workers on Kafka as processes: crashes, signals, and the command line."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from confluent_kafka import Consumer, Producer, TopicPartition

import rtamt
from rtamt.cli import main
from tests.unit.scale.kafka_topics import FORMULA, OPTIONS, offline, rows, sample, send


def process(brokers, topic, place, *more, specs=(FORMULA,)):
    command = [sys.executable, "-m", "rtamt", "worker", *specs, "--brokers", brokers, "--topic", topic]
    command += ["--checkpoint", str(place), "--interval", "0.1", *OPTIONS, *more]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True)


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
