"""What is read of the messages of a bag: their times, and the nearest range of a laser scan."""

from __future__ import annotations

import json
import math
import struct

import pytest
from mcap.writer import Writer
from rosbags import rosbag1
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

import rtamt
from rtamt.cli import main
from rtamt.errors import TraceError
from tests.unit.readers.bags import Bag

START = 1_700_000_000


@pytest.mark.parametrize("kind", ["ros1", "mcap"])
@pytest.mark.parametrize("options", [["--time", "dense"], ["--time", "dense", "--early"], ["--period", "1s"]])
def test_a_violation_in_simulated_time_was_missed_beside_a_topic_with_times_of_recording(
    tmp_path, capsys, kind, options
):
    with Bag(tmp_path, kind) as bag:
        for i in range(5):
            bag.stamped("/x", 1 + i, -1.0 if i == 2 else 1.0, late=START)
            bag.plain("/y", START + 1 + i, 1.0)
    both = 'always("/x.value" >= 0 and "/y.data" >= 0)'
    assert main(["check", both, str(bag.path), "--json", *options]) == 1
    row = json.loads(capsys.readouterr().out)
    assert row["first_violation"] == START + 3
    note = (
        "/x: the timestamps in its headers are 1.7e+09 s behind the clock of the recording, which /y uses; "
        "the times of recording are used instead"
    )
    assert note in row["notes"]
    assert rtamt.read(bag.path, columns=["/x.value", "/y.data"]).losses == (note,)
    alone = rtamt.read(bag.path, columns=["/x.value"])
    assert (alone["/x.value"].times.tolist(), alone.losses) == ([1, 2, 3, 4, 5], ())


def test_an_obstacle_too_close_to_measure_was_left_out_and_so_were_all_ranges_without_limits(tmp_path):
    with Bag(tmp_path, "mcap") as bag:
        for i, ranges in enumerate(
            ([9.0, 3.0, 0.01], [9.0, 0.0], [2.0, -math.inf], [math.inf, math.nan, 0.5])
        ):
            bag.scan("/scan", i + 1, ranges)
            bag.scan("/unset", i + 1, ranges, limits=(0.0, 0.0))
    trace = rtamt.read(bag.path, columns=["/scan.ranges.min"])
    assert trace["/scan.ranges.min"].values.tolist() == [3, math.inf, -math.inf, 0.5]
    with pytest.raises(TraceError) as refused:
        rtamt.read(bag.path, columns=["/unset.ranges.min"])
    assert str(refused.value) == (
        "a laser scan on /unset has no valid range, because its range_min is 0 and its range_max 0: "
        "read single ranges, such as /unset.ranges[0], or correct the driver"
    )


@pytest.mark.parametrize("late", [START, 0])
def test_a_simulation_that_starts_at_0_was_an_error(tmp_path, late):
    with Bag(tmp_path, "mcap") as bag:
        for i in range(5):
            bag.stamped("/x", i / 10, i, late=late)
    trace = rtamt.read(bag.path)
    assert trace["/x.value"].times.tolist() == [0, 0.1, 0.2, 0.3, 0.4]


def test_stamps_that_were_left_at_0_at_first_are_times_of_recording(tmp_path):
    with Bag(tmp_path, "mcap") as bag:
        for i in range(5):
            at = START + i
            bag.stamped("/x", at if i > 1 else 0, i, late=0 if i > 1 else at)
    assert rtamt.read(bag.path)["/x.value"].times.tolist() == [(START + i) * 10**9 for i in range(5)]


@pytest.mark.parametrize("zero", [0, 2, 4])
def test_a_message_without_a_time_among_simulated_stamps_was_at_the_time_of_its_recording(tmp_path, zero):
    with Bag(tmp_path, "mcap") as bag:
        for i in range(5):
            at = 0 if i == zero else 100 + i
            bag.stamped("/x", at, i, late=START + i - at)
            bag.plain("/y", START + i, i)
    with pytest.raises(TraceError) as caught:
        rtamt.read(bag.path, columns=["/x.value"])
    assert str(caught.value) == (
        "a message on /x has the timestamp 0, so that its time is unknown: the other timestamps on this topic are not "
        "from the clock of the recording; leave the message out of the bag"
    )
    both = rtamt.read(bag.path, columns=["/x.value", "/y.data"])
    assert both["/x.value"].times.tolist() == both["/y.data"].times.tolist()


#: A type as two nodes define it: of the same name and size, with fields in another order.
OLD, NEW = "float64 speed\nfloat64 limit\n", "float64 limit\nfloat64 speed\n"


def car(text):
    store = get_typestore(Stores.ROS1_NOETIC)
    store.register(get_types_from_msg(text, "my_msgs/msg/Car"))
    return store


@pytest.mark.parametrize("topics", [("/old", "/new"), ("/car", "/car")])
def test_a_type_with_two_definitions_is_refused_since_one_of_them_would_be_read_wrongly(tmp_path, topics):
    path, stores = tmp_path / "a.bag", [car(OLD), car(NEW)]
    with rosbag1.Writer(path) as bag:
        for at, (topic, store) in enumerate(zip(topics, stores, strict=True)):
            connection = bag.add_connection(topic, "my_msgs/msg/Car", typestore=store)
            message = store.types["my_msgs/msg/Car"](speed=100.0, limit=10.0)
            bag.write(connection, at * 10**9, store.serialize_ros1(message, "my_msgs/msg/Car"))
    with pytest.raises(
        TraceError, match=r"it holds two definitions of the type my_msgs/msg/Car, .*; split it"
    ):
        rtamt.read(path)


def mcap(path, schemas, encoding="cdr"):
    with open(path, "wb") as file:
        bag = Writer(file)
        bag.start(profile="ros2")
        for number, (kind, text) in enumerate(schemas):
            schema = bag.register_schema(kind, "ros2msg", text.encode())
            channel = bag.register_channel(f"/t{number}", encoding, schema)
            bag.add_message(channel, 10**9, b"\0\1\0\0" + struct.pack("<2d", 100.0, 10.0), 10**9)
        bag.finish()
    return path


def test_an_embedded_type_with_two_definitions_is_refused(tmp_path):
    point = f"my_msgs/P p\n{'=' * 80}\nMSG: my_msgs/P\n"
    schemas = [("my_msgs/msg/A", point + OLD), ("my_msgs/msg/B", point + NEW)]
    with pytest.raises(TraceError, match="two definitions of the type my_msgs/msg/P, on /t0 and on /t1"):
        rtamt.read(mcap(tmp_path / "a.mcap", schemas))
    alike = [("my_msgs/msg/A", point + OLD), ("my_msgs/msg/B", point + f"# the same\n{OLD}")]
    trace = rtamt.read(mcap(tmp_path / "b.mcap", alike))
    assert [trace[f"/t{i}.p.speed"].values.tolist() for i in range(2)] == [[100], [100]]


@pytest.mark.parametrize("recover", [False, True])
def test_messages_of_ros_1_in_mcap_are_refused_by_what_they_are(tmp_path, recover):
    path = mcap(tmp_path / "a.mcap", [("my_msgs/msg/Car", OLD)], "ros1")
    with pytest.raises(TraceError) as caught:
        rtamt.read(path, recover=recover)
    assert str(caught.value) == (
        f"'{path}' cannot be read: the messages on /t0 are ros1, and only those of ROS 2 (cdr) are read; "
        f"convert the file, to CSV for example"
    )


@pytest.mark.parametrize("kind", ["ros1", "mcap"])
def test_integers_that_no_double_holds_have_a_note(tmp_path, kind):
    with Bag(tmp_path, kind) as bag:
        bag.store.register(get_types_from_msg("int64 count\nuint64 most\n", "my_msgs/msg/Count"))
        for at in range(2):
            message = bag.store.types["my_msgs/msg/Count"](count=2**53 + at, most=2**64 - 1)
            bag.write("/c", "my_msgs/msg/Count", at * 10**9, message)
    trace = rtamt.read(bag.path)
    assert trace["/c.count"].values.tolist() == [2.0**53, 2.0**53]
    assert trace["/c.most"].values.tolist() == [2.0**64, 2.0**64]
    assert trace.losses == (
        "rounded to doubles: 1 integer of /c.count beyond 2^53, the first at 1 s",
        "rounded to doubles: 2 integers of /c.most beyond 2^53, the first at 0 s",
    )
