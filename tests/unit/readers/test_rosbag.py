"""Bags of ROS 1 and ROS 2 become traces; ``rtamt check`` finds topics by annotation and writes a bag anew."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
from rosbags.highlevel import AnyReader
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime

import rtamt
from rtamt.cli import main
from rtamt.errors import TraceError
from rtamt.ros.message_definitions import DEFINITIONS, FLOAT_STAMPED, SATISFIED, VIOLATED
from tests.unit.readers.bags import SECOND, Bag

ROOT = Path(__file__).parents[3]
LISTING_8 = ROOT / "ros/rtamt4ros/specs/spec.stl"
KINDS = ("ros1", "sqlite3", "mcap")
START = 1_700_000_000
NEVER = QosTime(2147483647, 4294967295)
#: What sensors offer, and not what a recorder takes where nothing is known.
SENSOR = Qos(
    QosHistory.KEEP_LAST,
    5,
    QosReliability.BEST_EFFORT,
    QosDurability.VOLATILE,
    NEVER,
    NEVER,
    QosLiveliness.AUTOMATIC,
    NEVER,
    False,
)


@pytest.fixture(params=KINDS)
def drive(request, tmp_path):
    """A drive of 20 s in which the request at 6 s is granted and that at 9 s is not."""
    with Bag(tmp_path, request.param) as bag:
        for i in range(20):
            bag.stamped("/rtamt/req", START + i, 5.0 if i in {2, 9} else 0.0)
            bag.stamped("/rtamt/gnt", START + i + 0.5, 4.0 if i == 5 else 0.0)
            bag.plain("/other", START + i, float(i))
            bag.scan("/scan", START + i, [1.0, 2.0, 3.0 + i][: 3 if i else 2])
    return bag.path


def test_a_bag_has_a_signal_for_every_number_each_topic_on_the_clock_of_its_headers(drive):
    trace = rtamt.read(
        drive, columns=["/rtamt/req.value", "/rtamt/gnt.value", "/other.data", "/scan.ranges[1]"]
    )
    assert trace["/rtamt/req.value"].times[:2].tolist() == [START * SECOND, (START + 1) * SECOND]
    assert trace["/rtamt/gnt.value"].times[0] == START * SECOND + SECOND // 2
    assert trace["/other.data"].values.tolist() == list(range(20))
    assert set(trace["/scan.ranges[1]"].values) == {2.0}


def test_rtamt_check_reads_the_topics_that_the_specification_names(drive, capsys):
    assert main(["check", str(LISTING_8), str(drive), "--period", "1s", "--json"]) == 1
    assert '"robustness": -2.0' in capsys.readouterr().out
    assert main(["check", str(LISTING_8), str(drive), "--time", "dense", "--json"]) == 1
    assert '"robustness": -2.0' in capsys.readouterr().out


def test_discrete_time_samples_a_bag_as_a_node_does_every_period(drive, capsys, tmp_path):
    arguments = ["check", str(LISTING_8), str(drive), "--quiet", "-o", str(tmp_path / "rob.csv")]
    assert main([*arguments, "--period", "1"]) == 1
    with open(tmp_path / "rob.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert float(rows[0]["time"]) == START + 0.5  # when both topics have spoken
    assert len(rows) == 20
    capsys.readouterr()


@pytest.fixture
def spike(tmp_path):
    """A bag in which x is -1 for 50 ms, between two messages that are 1 s apart, and y comes every second."""
    with Bag(tmp_path, "mcap") as bag:
        for i in range(5):
            bag.plain("/y", START + i, 1.0)
            bag.plain("/x", START + i, 1.0)
            if i == 2:
                bag.plain("/x", START + i + 0.5, -1.0)
                bag.plain("/x", START + i + 0.55, 1.0)
    return bag.path


NO_PERIOD = (
    "the messages of this bag are not samples one period apart: choose a sampling period, such as --period 100ms, "
    "or use --time dense, which reads every message at its own time"
)


@pytest.mark.parametrize("formula", ['always("/x.data" >= 0)', 'always("/x.data" >= 0 and "/y.data" >= 0)'])
@pytest.mark.parametrize("command", ["check", "explain", "report", "plot"])
def test_a_spike_of_50_ms_was_missed_by_a_bag_sampled_at_1_hz(spike, tmp_path, capsys, command, formula):
    out = {"report": ["-o", str(tmp_path / "o.html")], "plot": ["-o", str(tmp_path / "o.png")]}.get(
        command, []
    )
    assert main([command, formula, str(spike), *out]) == 2
    assert capsys.readouterr().err == f"rtamt: {spike}: {NO_PERIOD}\n"
    violated = 0 if command == "plot" else 1
    for chosen in (["--period", "50ms"], ["--time", "dense"], ["--resample", "50ms"]):
        assert main([command, formula, str(spike), *out, *chosen]) == violated
    capsys.readouterr()


def test_what_a_chosen_period_passes_over_is_noted_beside_the_verdict(spike, tmp_path, capsys):
    arguments = ["check", 'always("/x.data" >= 0)', str(spike), "--period", "1"]
    assert main([*arguments, "--junit", str(tmp_path / "junit.xml")]) == 0
    note = "resampling left out 2 of 7 samples of /x.data, between those it took"
    assert f"note: {spike}: {note}\n" in capsys.readouterr().out
    assert note in (tmp_path / "junit.xml").read_text()
    assert main([*arguments[:-1], "50ms", "--json"]) == 1
    assert "notes" not in json.loads(capsys.readouterr().out)


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_violation_with_the_stamp_of_the_message_before_was_left_out_silently(tmp_path, capsys, time):
    with Bag(tmp_path, "mcap") as bag:
        for i in range(4):
            bag.stamped("/x", START + i, 1.0)
            for value in (-1.0, 1.0) if i == 2 else (1.0,):
                bag.stamped("/x", START + i, value)
    assert main(["check", 'always("/x.value" >= 0)', str(bag.path), "--time", time]) == 0
    note = "1 message on /x has the stamp of the message before and another value; it is left out"
    assert f"note: {bag.path}: {note}\n" in capsys.readouterr().out
    assert note in rtamt.read(bag.path).losses


def test_topics_with_the_same_regular_stamps_imply_their_period_and_every_message_is_a_sample(
    spike, tmp_path, capsys
):
    assert main(["check", 'always("/y.data" >= 0)', str(spike), "--json"]) == 0
    row = json.loads(capsys.readouterr().out)
    assert (row["samples"], row["period"]) == (5, 1)
    with Bag(tmp_path / "both", "sqlite3") as bag:
        for i in range(50):
            for topic in ("/x", "/y"):
                bag.stamped(
                    topic, START + i / 20 + (0.004 if i % 3 else 0), -1.0 if (topic, i) == ("/x", 31) else 1.0
                )
    assert main(["check", 'always("/x.value" >= 0 and "/y.value" >= 0)', str(bag.path), "--json"]) == 1
    row = json.loads(capsys.readouterr().out)
    assert (row["samples"], row["period"]) == (50, 0.05)
    assert row["first_violation"] == pytest.approx(START + 31 / 20 + 0.004)


def test_the_samples_of_a_requirement_depended_on_the_requirements_beside_it(tmp_path, capsys):
    """The first sample lay at the latest first message of any requirement's topics."""
    (tmp_path / "early.stl").write_text('"/early.data" >= 0')
    (tmp_path / "late.stl").write_text('"/late.data" >= 0')
    with Bag(tmp_path, "mcap") as bag:
        for i in range(10):
            bag.plain("/early", START + i, float(i))
            bag.plain("/late", START + 5.25 + i, float(i))
    specs = [str(tmp_path / name) for name in ("early.stl", "late.stl")]

    (tmp_path / "both.stl").write_text('require early: "/early.data" >= 0; require late: "/late.data" >= 0')

    def rows(*given, options=("--period", "1")):
        assert main(["check", *given, str(bag.path), *options, "--json"]) == 0
        return [json.loads(line) for line in capsys.readouterr().out.splitlines()]

    def read_row(row):
        return row["robustness"], row["samples"]

    for options in (["--period", "1"], ["--time", "dense"]):
        alone = [read_row(row) for spec in specs for row in rows(spec, options=options)]
        assert [read_row(row) for row in rows(str(tmp_path / "both.stl"), options=options)] == alone
    assert [read_row(row) for row in rows(*specs)] == [read_row(row) for spec in specs for row in rows(spec)]
    assert [read_row(row) for row in rows(*specs)] == [(0, 10), (0, 10)]


def test_the_bag_is_written_again_with_topics_of_robustness_and_verdicts(drive, tmp_path):
    out = tmp_path / "out.mcap"
    assert main(["check", str(LISTING_8), str(drive), "--period", "1s", "--quiet", "-o", str(out)]) == 1
    expected = rtamt.read(drive, columns=["/rtamt/req.value", "/rtamt/gnt.value"]).rename(
        {"req.value": "/rtamt/req.value", "gnt.value": "/rtamt/gnt.value"}
    )
    result = rtamt.load(LISTING_8, period=1).evaluate(expected.resample(1))
    again = rtamt.read(out)
    assert again["/rtamt/rob.value"].values.tolist() == result.signal.values.tolist()
    assert again["/other.data"].values.tolist() == list(range(20))
    judged = again["/rtamt/rob/verdict.verdict"].values.tolist()
    assert judged == [SATISFIED if value > 0 else VIOLATED for value in result.signal.values]
    with AnyReader([out]) as reader:
        counts = {connection.topic: connection.msgcount for connection in reader.connections}
        kinds = {connection.topic: connection.msgtype for connection in reader.connections}
    assert counts == {
        "/rtamt/req": 20, "/rtamt/gnt": 20, "/other": 20, "/scan": 20, "/rtamt/rob": 20, "/rtamt/rob/verdict": 20
    }  # fmt: skip
    assert kinds["/rtamt/rob/verdict"] == "rtamt_msgs/msg/Verdict"
    assert list(tmp_path.glob("tmp*")) == []


@pytest.mark.parametrize("options", [(), ("--time", "dense")])
@pytest.mark.parametrize("kind", KINDS)
def test_the_written_bag_keeps_nanoseconds_types_and_qualities_of_service(tmp_path, capsys, kind, options):
    start, period, held = 1_763_790_478_123_456_789, 10_000_001, 7
    with Bag(tmp_path, kind) as bag:
        if not bag.ros1:
            bag.topics["/x"] = bag.writer.add_connection(
                "/x", FLOAT_STAMPED, typestore=bag.store, offered_qos_profiles=[SENSOR]
            )
        for i in range(5):
            stamp = start + i * period
            message = bag.store.types[FLOAT_STAMPED](header=bag.header(stamp), value=float(-i % 2))
            bag.write("/x", FLOAT_STAMPED, stamp + held, message)
    out = tmp_path / "out.mcap"
    spec = 'always("/x.value" >= 1)'
    assert main(["check", spec, str(bag.path), *options, "-o", str(out)]) == 1
    assert "2025-11-22 05:47:58.123456789 (+0 s)  violated" in capsys.readouterr().out
    with AnyReader([out]) as reader:
        (copied,) = (connection for connection in reader.connections if connection.topic == "/x")
        assert copied.msgtype == FLOAT_STAMPED
        assert copied.ext.offered_qos_profiles == ([] if bag.ros1 else [SENSOR])
        timestamps = {connection.topic: [] for connection in reader.connections}
        for connection, recorded, raw in reader.messages():
            header = reader.deserialize(raw, connection.msgtype).header.stamp
            timestamps[connection.topic].append((header.sec * 10**9 + header.nanosec, recorded))
    exact = [start + i * period for i in range(5)]
    assert timestamps["/x"] == [(stamp, stamp + held) for stamp in exact]
    assert timestamps["/rtamt/robustness"][0] == (start, start)
    assert {stamp for stamp, _ in timestamps["/rtamt/robustness"]} <= set(exact)


def test_requirements_whose_topics_become_equal_were_written_beside_each_other_as_offline(
    drive, tmp_path, capsys
):
    out, spec = tmp_path / "out.mcap", tmp_path / "a.stl"
    formulas = [
        f'require {name}: always("/other.data" >= {k})' for k, name in enumerate(("REQ-1", "REQ_1", "REQ.1"))
    ]
    spec.write_text("\n".join(formulas))
    assert main(["check", str(spec), str(drive), "--quiet", "-o", str(out), "--period", "1"]) == 1
    assert capsys.readouterr().err == (
        "rtamt: note: 'REQ_1' is written to /rtamt/REQ_1_2, because /rtamt/REQ_1 is the topic of 'REQ-1'\n"
        "rtamt: note: 'REQ.1' is written to /rtamt/REQ_1_3, because /rtamt/REQ_1 is the topic of 'REQ-1'\n"
    )
    with AnyReader([out]) as reader:
        names = {
            connection.topic: reader.deserialize(raw, connection.msgtype).name
            for connection, _, raw in reader.messages()
            if connection.topic.endswith("/verdict")
        }
    assert names == {
        "/rtamt/REQ_1/verdict": "REQ-1", "/rtamt/REQ_1_2/verdict": "REQ_1", "/rtamt/REQ_1_3/verdict": "REQ.1"
    }  # fmt: skip


def test_a_recorded_robustness_topic_stays_and_the_offline_one_lies_beside_it(drive, tmp_path):
    once, twice = tmp_path / "once.mcap", tmp_path / "twice.mcap"
    main(["check", str(LISTING_8), str(drive), "--quiet", "-o", str(once), "--period", "1"])
    main(["check", str(LISTING_8), str(once), "--quiet", "-o", str(twice), "--period", "1"])
    topics = {name.split(".")[0] for name in rtamt.read(twice).names}
    assert {"/rtamt/rob", "/rtamt/rob/offline", "/rtamt/rob/verdict"} <= topics


def test_a_formula_over_columns_needs_no_annotations(drive, tmp_path, capsys):
    out = tmp_path / "out.mcap"
    assert main(["check", 'always("/other.data" <= 15)', str(drive), "-o", str(out)]) == 1
    assert rtamt.read(out)["/rtamt/robustness.value"].values[-1] == -4
    capsys.readouterr()


@pytest.mark.parametrize("kind", KINDS)
def test_an_element_that_an_array_sometimes_lacks_is_no_sample_there(tmp_path, kind):
    with Bag(tmp_path, kind) as bag:
        for at, ranges in ((1, [1, 2, 3]), (2, [1]), (3, [1, 2, 4])):
            bag.scan("/scan", at, ranges)
    signal = rtamt.read(bag.path, columns=["/scan.ranges[2]"])["/scan.ranges[2]"]
    assert (signal.times.tolist(), signal.values.tolist()) == ([1, 3], [3, 4])


def test_stamps_that_go_back_are_refused_and_repeated_ones_are_one_sample(tmp_path):
    with Bag(tmp_path, "mcap") as bag:
        for at, value in ((5, 1.0), (5, 9.0), (6, 2.0)):
            bag.stamped("/x", at, value)
        for at in (5, 6, 2):
            bag.stamped("/y", at, 0.0, late=10 - at)
    assert rtamt.read(bag.path, columns=["/x.value"])["/x.value"].values.tolist() == [1, 2]
    with pytest.raises(TraceError) as caught:
        rtamt.read(bag.path)
    assert str(caught.value) == (
        "the timestamps on /y go back by 4 s at message 2: was simulated time set back? Cut the bag there"
    )


@pytest.mark.parametrize("name", ["no.bag", "no.db3", "no.mcap"])
def test_what_is_no_bag_is_refused_with_a_sentence(tmp_path, name):
    path = tmp_path / name
    with pytest.raises(TraceError) as caught:
        rtamt.read(path)
    assert str(caught.value) == f"there is no file '{path}'"
    path.write_bytes(b"time,x\n0,1\n")
    with pytest.raises(TraceError) as caught:
        rtamt.read(path)
    assert str(caught.value).startswith(f"'{path}' cannot be read as ROS bag: ")


@pytest.mark.parametrize("packed", [None, "FILE", "MESSAGE"])
@pytest.mark.parametrize("kind", ["sqlite3", "mcap"])
def test_the_folder_that_ros2_records_is_a_bag_compressed_or_not(tmp_path, kind, packed, capsys):
    with Bag(tmp_path, kind, packed) as bag:
        for i in range(20):
            bag.stamped("/rtamt/req", START + i, 5.0 if i in {2, 9} else 0.0)
            bag.stamped("/rtamt/gnt", START + i, 4.0 if i == 5 else 0.0)
    folder, out = bag.path.parent, tmp_path / "out.mcap"
    assert main(["check", str(LISTING_8), str(folder), "--quiet", "-o", str(out), "--period", "1"]) == 1
    capsys.readouterr()
    assert main(["info", str(folder)]) == 0
    assert "/rtamt/gnt.value" in capsys.readouterr().out
    again = rtamt.read(out)
    assert again["/rtamt/rob.value"].values.min() == -2
    assert again["/rtamt/req.value"].values.tolist() == [5.0 if i in {2, 9} else 0.0 for i in range(20)]


def test_a_part_of_a_compressed_bag_says_that_the_folder_is_the_bag(tmp_path):
    for packed in ("FILE", "MESSAGE"):
        with Bag(tmp_path / packed, "sqlite3", packed) as bag:
            bag.stamped("/x", 1, 1.0)
    packed = tmp_path / "FILE/drive/drive.db3.zstd"
    with pytest.raises(TraceError) as caught:
        rtamt.read(packed)
    assert str(caught.value) == (
        f"'{packed}' is a compressed file of a bag: give the bag's folder, in which metadata.yaml is, or unpack it"
    )
    with pytest.raises(TraceError) as caught:
        rtamt.read(bag.path)
    assert str(caught.value) == (
        "a message on /x cannot be read as rtamt_msgs/msg/FloatStamped: Invalid or unsupported CDR encapsulation; "
        f"the file is a part of a bag: give its folder, '{bag.path.parent}'"
    )
    with pytest.raises(TraceError) as caught:
        rtamt.read(tmp_path)
    assert str(caught.value) == (
        f"'{tmp_path}' is a folder without metadata.yaml, so that it is no bag of ROS 2; name a file"
    )


def test_topics_are_written_to_bags_only(tmp_path, capsys):
    trace = tmp_path / "log.csv"
    trace.write_text("time,x\n0,1\n1,2\n")
    assert main(["check", "always(x <= 3)", str(trace), "-o", str(tmp_path / "o.mcap")]) == 2
    assert capsys.readouterr().err == (
        f"rtamt: '{trace}' is no bag, so that there are no topics to write to '{tmp_path / 'o.mcap'}'; write .csv\n"
    )


def test_the_definitions_in_the_package_are_those_of_the_ros_package():
    for name, text in DEFINITIONS.items():
        package, _, short = name.split("/")
        assert (ROOT / "ros" / package / "msg" / f"{short}.msg").read_text() == text


def test_every_published_assertion_is_judged_not_the_last_alone(drive, tmp_path, capsys):
    spec = tmp_path / "two.stl"
    spec.write_text("""
        specification two
        from rtamt_msgs.msg import FloatStamped
        input FloatStamped req  output FloatStamped a  output FloatStamped b
        @ topic(req, rtamt/req)
        a.value = always(req.value <= -100);
        b.value = always(req.value <= 100)
    """)
    junit, rob, out = tmp_path / "junit.xml", tmp_path / "rob.csv", tmp_path / "out.mcap"
    assert (
        main(
            ["check", str(spec), str(drive), "--json", "--junit", str(junit), "-o", str(rob), "--period", "1"]
        )
        == 1
    )
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [(row["requirement"], row["satisfied"]) for row in rows] == [
        ("two: a.value", False),
        ("two: b.value", True),
    ]
    assert 'name="two: a.value" tests="1" failures="1"' in junit.read_text()
    with rob.open() as file:
        first = next(csv.DictReader(file))
    assert [float(first[name]) for name in ("a.value", "b.value")] == [row["robustness"] for row in rows]
    assert main(["check", str(spec), str(drive), "--quiet", "--time", "dense", "-o", str(rob)]) == 1
    assert rtamt.read(rob)["b.value"].values[0] == rows[1]["robustness"]
    assert main(["check", str(spec), str(drive), "--quiet", "-o", str(out), "--period", "1"]) == 1
    assert {"/rtamt/a.value", "/rtamt/b.value"} <= set(rtamt.read(out).names)


@pytest.mark.parametrize("name", ["out.bag", "out.db3"])
def test_a_bag_that_is_no_mcap_is_not_written(drive, tmp_path, capsys, name):
    out = tmp_path / name
    assert main(["check", str(LISTING_8), str(drive), "-o", str(out)]) == 2
    assert capsys.readouterr().err == (
        f"rtamt: --output is '{out}', but bags are written as MCAP: write to a file .mcap\n"
    )
    assert not out.exists()
