"""The ROS 1 node, started as users start it: a real master, nodes in processes of their own."""

from __future__ import annotations

import signal
import time
from itertools import count, pairwise
from pathlib import Path

import pytest

import rtamt
from tests.integration.ros.processes import wait_for

LISTING_8 = (Path(__file__).parents[3] / "ros/rtamt4ros/specs/spec.stl").read_text()
FLOAT = "rtamt_msgs/FloatStamped"
VERDICT = "rtamt_msgs/Verdict"
BOUNDS = "rtamt_msgs/Bounds"
DIAGNOSTICS = "diagnostic_msgs/DiagnosticArray"
LEVELS = ("OK", "WARN", "ERROR", "STALE")
UNKNOWN, SATISFIED, VIOLATED = 0, 1, 2
SECOND = 10**9


def wait_for_connection(puppet, *topics):
    """Wait until somebody is at the other end of each topic."""
    for topic in topics:
        wait_for(lambda topic=topic: puppet.ask(do="peers", topic=topic)["answer"], f"a peer on {topic}")


def wait_for_status(puppet, text):
    """Wait until /diagnostics has a status whose message has a text."""

    def found(arrays):
        return any(text in status["message"] for array in arrays for status in array["status"])

    puppet.wait_for("/diagnostics", found, text)


def statuses(array):
    """Return the levels of a message on /diagnostics."""
    return [LEVELS[status["level"]] for status in array["status"]]


def knows(puppet, **values):
    """Wait until the monitor says that these are its inputs now."""

    def shown(arrays):
        statuses = [status for array in arrays[-1:] for status in array["status"]]
        return any(
            values.items() <= {pair["key"]: pair["value"] for pair in status["values"]}.items()
            for status in statuses
        )

    puppet.wait_for("/diagnostics", shown, f"{values}")


@pytest.fixture
def puppet(ros):
    """Start a node that publishes req and gnt, and hears what the monitor says."""
    puppet = ros.puppet()
    for topic in ("rtamt/req", "rtamt/gnt"):
        puppet.ask(do="advertise", topic=topic, kind=FLOAT)
    puppet.ask(do="subscribe", topic="rtamt/rob", kind=FLOAT)
    puppet.ask(do="subscribe", topic="rtamt/rob/verdict", kind=VERDICT)
    puppet.ask(do="subscribe", topic="/diagnostics", kind=DIAGNOSTICS)
    return puppet


def publish(puppet, topic, value, stamp=0):
    puppet.ask(do="publish", topic=topic, fields={"header": {"stamp": stamp}, "value": value})


def test_the_command_of_the_paper_on_its_listing_8(ros, puppet):
    node = ros.monitor(LISTING_8, "--period", "1", "--unit", "s")
    wait_for_connection(puppet, "rtamt/req", "rtamt/gnt", "rtamt/rob")
    publish(puppet, "rtamt/req", 5.0)
    wait_for_status(puppet, "waiting for the first message on rtamt/gnt")
    assert puppet.messages("rtamt/rob") == []
    publish(puppet, "rtamt/gnt", 1.0)
    heard = puppet.wait_for("rtamt/rob", lambda messages: len(messages) >= 2)[:2]
    timestamps = [message["header"]["stamp"] for message in heard]
    assert [later - earlier for earlier, later in pairwise(timestamps)] == [SECOND]
    assert abs(timestamps[0] - puppet.ask(do="now")["answer"]) < 60 * SECOND
    # Pastified, the request of the first sample is due 5 samples later; till then nothing was asked.
    assert [message["value"] for message in heard] == [float("inf")] * 2
    assert node.stop(signal.SIGINT) == 0
    assert "spec_x" not in ros.run("rosnode", "list").stdout


FORMULA = "G[0,2]((req>=3)->(F[0,3](gnt>=3)))"
#: Values of req and gnt, second by second.
PHASES = [(0, 0)] * 3 + [(6, 0)] * 2 + [(0, 4)] * 2 + [(5, 0)] * 6 + [(5, 1)] * 6


def test_simulated_time_gives_the_offline_answer_one_horizon_later_and_again_after_it_goes_back(ros, puppet):
    ros.run("rosparam", "set", "/use_sim_time", "true")
    puppet = ros.puppet()  # one that knows of simulated time
    for topic, kind in (("/clock", "rosgraph_msgs/Clock"), ("rtamt/req", FLOAT), ("rtamt/gnt", FLOAT)):
        puppet.ask(do="advertise", topic=topic, kind=kind)
    for topic, kind in (("rtamt/rob", FLOAT), ("rtamt/rob/verdict", VERDICT), ("/diagnostics", DIAGNOSTICS)):
        puppet.ask(do="subscribe", topic=topic, kind=kind)
    formula = FORMULA.replace("req", "req.value").replace("gnt", "gnt.value")
    node = ros.monitor(
        f"{LISTING_8.partition('rob.value')[0]} rob.value = {formula}", "--period", "1", "--unit", "s"
    )
    wait_for_connection(puppet, "rtamt/req", "rtamt/gnt", "rtamt/rob", "rtamt/rob/verdict")
    # The puppet listens to the clock itself, as every node does in simulated time.
    wait_for(lambda: puppet.ask(do="peers", topic="/clock")["answer"] >= 2, "the monitor on /clock")
    told = []

    def play(start, phases=PHASES):
        told.append((start - 1) * SECOND)  # the first sample lies at the first messages
        for tick, (req, gnt) in enumerate(phases):
            if tick == 0 or PHASES[tick - 1] != (req, gnt):
                publish(puppet, "rtamt/req", req)
                publish(puppet, "rtamt/gnt", gnt)
                knows(puppet, **{"req.value": f"{req}", "gnt.value": f"{gnt}"})
            told.append((start + tick) * SECOND)
            puppet.ask(do="publish", topic="/clock", fields={"clock": told[-1]})
            puppet.wait_for("rtamt/rob/verdict", lambda messages: len(messages) >= len(told))

    puppet.ask(do="publish", topic="/clock", fields={"clock": 99 * SECOND})
    # What is published before the node has seen that instant would be its sample.
    puppet.wait_for("/diagnostics", lambda arrays: arrays and arrays[-1]["header"]["stamp"] == 99 * SECOND)
    play(100)
    puppet.ask(do="publish", topic="/clock", fields={"clock": 49 * SECOND})
    node.wait_for_output("the clock went back by 69 s: all monitors begin anew")
    play(50, PHASES[:7])
    heard = puppet.wait_for("rtamt/rob", lambda messages: len(messages) == len(told))
    assert [message["header"]["stamp"] for message in heard] == told
    sampled = [PHASES[0], *PHASES]
    once = [message["value"] for message in heard[: len(sampled)]]
    assert [message["value"] for message in heard[len(sampled) :]] == once[:8]
    offline = rtamt.parse(FORMULA).evaluate(
        dict(zip(("req", "gnt"), zip(*sampled, strict=True), strict=True))
    )
    horizon = 5
    assert once[horizon:] == offline.signal.values[:-horizon].tolist()
    assert min(once[horizon:]) == -2  # the second request is not granted
    verdicts = [message["verdict"] for message in puppet.messages("rtamt/rob/verdict")][: len(sampled)]
    assert verdicts == [UNKNOWN] * horizon + [
        SATISFIED if value > 0 else VIOLATED for value in once[horizon:]
    ]
    wait_for_status(puppet, "violated")


@pytest.mark.parametrize("stale", ["0", "1e9"])
def test_a_forward_jump_of_simulated_time_kept_the_node_busy_for_ever_and_deaf_to_sigterm(ros, stale):
    ros.run("rosparam", "set", "/use_sim_time", "true")
    puppet = ros.puppet()
    for topic, kind in (("/clock", "rosgraph_msgs/Clock"), ("rtamt/req", FLOAT), ("rtamt/gnt", FLOAT)):
        puppet.ask(do="advertise", topic=topic, kind=kind)
    puppet.ask(do="subscribe", topic="rtamt/rob", kind=FLOAT)
    node = ros.monitor(LISTING_8, "--period", "1ms", "--stale", stale)
    wait_for_connection(puppet, "rtamt/req", "rtamt/gnt", "rtamt/rob")
    wait_for(lambda: puppet.ask(do="peers", topic="/clock")["answer"] >= 2, "the monitor on /clock")

    def clock(seconds):
        puppet.ask(do="publish", topic="/clock", fields={"clock": round(seconds * SECOND)})

    milliseconds = count(1000)

    def speaks():
        # Time goes on, since rospy may lose what a node publishes while a subscriber connects.
        clock(next(milliseconds) / 1000)
        for topic in ("rtamt/req", "rtamt/gnt"):
            publish(puppet, topic, 0.0)
        return puppet.messages("rtamt/rob")

    wait_for(speaks, "robustness")
    clock(9)  # as many samples as are ever made up for
    puppet.wait_for("rtamt/rob", lambda messages: messages[-1]["header"]["stamp"] == 9 * SECOND)
    clock(1_600_000_000)
    node.wait_for_output("the clock went forward by 1.6e+09 s at once: all monitors begin anew")
    asked = time.monotonic()
    assert node.stop(signal.SIGTERM) in {0, -signal.SIGTERM}
    assert time.monotonic() - asked < 20  # a busy machine


def test_dense_time_takes_the_stamps_of_messages_of_any_type_for_several_assertions(ros):
    puppet = ros.puppet()
    puppet.ask(do="advertise", topic="/arm", kind="arm_msgs/Arm")
    puppet.ask(do="advertise", topic="/odom", kind="nav_msgs/Odometry")
    puppet.ask(do="subscribe", topic="/elbow", kind=FLOAT)
    puppet.ask(do="subscribe", topic="/speed", kind="nav_msgs/Odometry")
    node = ros.monitor(
        """
        from arm_msgs.msg import Arm
        from nav_msgs.msg import Odometry
        from rtamt_msgs.msg import FloatStamped
        input Arm arm  input Odometry odom  output FloatStamped elbow  output Odometry speed
        @ topic(arm, /arm)  @ topic(odom, /odom)  @ topic(elbow, /elbow)  @ topic(speed, /speed)
        still = odom.twist.twist.linear.x <= 0.5;
        elbow.value = eventually[0,1]("arm.fingers[1].torque[2]" >= 3);
        speed.pose.pose.position.z = historically(arm.elbow.angle <= 2 or still)
        """,
        "--time",
        "dense",
        "--stale",
        "0",
    )
    wait_for_connection(puppet, "/arm", "/odom", "/elbow", "/speed")
    finger = {"angle": 0.0, "torque": [0.0, 0.0, 0.0]}

    def arm(at, angle, torque):
        fingers = [finger, {"angle": 0.0, "torque": [0.0, 0.0, torque]}]
        header = {"stamp": round(at * SECOND)}
        fields = {"header": header, "elbow": {"angle": angle}, "fingers": fingers}
        puppet.ask(do="publish", topic="/arm", fields=fields)

    def odom(at, speed):
        fields = {"header": {"stamp": round(at * SECOND)}, "twist": {"twist": {"linear": {"x": speed}}}}
        puppet.ask(do="publish", topic="/odom", fields=fields)

    def numbers(topic, *path):
        found = {}
        for message in puppet.messages(topic):
            at = message["header"]["stamp"] / SECOND
            for name in path:
                message = message[name]  # noqa: PLW2901 - one field further
            found[at] = message
        return found

    for at, torque in ((10, 1.0), (10.5, 4.0), (11.25, 0.0), (13, 0.0)):
        arm(at, 2.5, torque)
    for at, speed in ((10.25, 0.25), (12, 1.0), (13.5, 1.0)):
        odom(at, speed)
    puppet.wait_for("/elbow", lambda _: 13 in numbers("/elbow", "value"))
    # Pastified: the greatest of the last second. 4 holds from 10.5, and is 1 s old at 12.25.
    assert numbers("/elbow", "value") == {10: -2, 10.5: 1, 11.25: 1, 12.25: -3, 13: -3}
    puppet.wait_for("/speed", lambda _: 13 in numbers("/speed", "pose", "pose", "position", "z"))
    # Of both topics from 10.25 on; too fast from 12 on, and the elbow was bent all the time.
    told = numbers("/speed", "pose", "pose", "position", "z")
    assert [told[at] for at in sorted(told) if at < 12] == [0.25] * sum(at < 12 for at in told)
    assert (min(told), told[12], told[13]) == (10.25, -0.5, -0.5)
    assert "anew" not in node.output


def test_a_topic_that_goes_silent_is_stale_on_diagnostics_and_nothing_is_published_meanwhile(ros, puppet):
    ros.monitor(LISTING_8, "--period", "100", "--unit", "ms", "--stale", "500ms")
    wait_for_connection(puppet, "rtamt/req", "rtamt/gnt", "rtamt/rob")

    def publish_value():
        """Publish until robustness comes: on a busy machine one message may be stale before the other is there."""
        so_far = len(puppet.messages("rtamt/rob"))

        def published():
            publish(puppet, "rtamt/req", 0.0)
            publish(puppet, "rtamt/gnt", 0.0)
            return len(puppet.messages("rtamt/rob")) > so_far

        wait_for(published, "robustness")

    publish_value()
    silent = puppet.wait_for("/diagnostics", lambda arrays: arrays and statuses(arrays[-1]) == ["STALE"])[-1]
    assert "no message on rtamt/" in silent["status"][0]["message"]
    since = silent["header"]["stamp"]
    puppet.wait_for(
        "/diagnostics", lambda arrays: arrays[-1]["header"]["stamp"] > since
    )  # a second of silence
    assert all(message["header"]["stamp"] <= since for message in puppet.messages("rtamt/rob"))
    publish_value()


def test_a_master_that_restarts_gets_the_node_back(ros, puppet):
    node = ros.monitor(LISTING_8, "--period", "100ms", "--stale", "0")
    wait_for_connection(puppet, "rtamt/req", "rtamt/gnt", "rtamt/rob")
    ros.master.stop(signal.SIGKILL)
    ros.start_master()
    node.wait_for_output("the master was restarted: registering again")
    late = ros.puppet()  # knows the new master alone
    for topic in ("rtamt/req", "rtamt/gnt"):
        late.ask(do="advertise", topic=topic, kind=FLOAT)
    late.ask(do="subscribe", topic="rtamt/rob", kind=FLOAT)
    wait_for_connection(late, "rtamt/req", "rtamt/gnt", "rtamt/rob")
    publish(late, "rtamt/req", 0.0)
    publish(late, "rtamt/gnt", 0.0)
    late.wait_for("rtamt/rob")


def test_the_launch_file_takes_parameters(ros, puppet):
    spec = ros.folder / "mine.stl"
    spec.write_text(LISTING_8)
    arguments = [f"spec:={spec}", "period:=200", "unit:=ms", "stale:=0"]
    node = ros.start("roslaunch", "rtamt4ros", "monitor.launch", *arguments)
    wait_for_connection(puppet, "rtamt/req", "rtamt/gnt", "rtamt/rob")
    publish(puppet, "rtamt/req", 0.0)
    publish(puppet, "rtamt/gnt", 0.0)
    heard = puppet.wait_for("rtamt/rob", lambda messages: len(messages) >= 2)
    timestamps = [message["header"]["stamp"] for message in heard]
    assert timestamps[1] - timestamps[0] == SECOND // 5
    assert "/stl_monitor" in ros.run("rosnode", "list").stdout
    node.stop(signal.SIGINT)


def test_a_specification_that_cannot_be_watched_ends_the_node_with_a_sentence(ros):
    node = ros.monitor(LISTING_8.replace("(req.value", "(req.val"), "--period", "1")
    sentence = "'req' has no field 'val'; did you mean 'value'?"
    node.wait_for_output(f"ros_stl_monitor.py: {sentence}")
    wait_for(lambda: node.popen.poll() is not None, "the node's end")
    assert node.stop() == 2
    assert "Traceback" not in node.output


def test_bounds_and_verdict_at_the_start_of_the_trace(ros, puppet):
    puppet.ask(do="subscribe", topic="rtamt/rob/bounds", kind=BOUNDS)
    text = LISTING_8[: LISTING_8.index("rob.value =")] + "rob.value = always(req.value >= 3)"
    ros.monitor(text, "--period", "100ms", "--stale", "0")
    wait_for_connection(puppet, "rtamt/req", "rtamt/rob/bounds")

    def last(verdict):
        return puppet.wait_for(
            "rtamt/rob/bounds", lambda messages: messages and messages[-1]["verdict"] == verdict
        )[-1]

    publish(puppet, "rtamt/req", 5)
    assert (last(UNKNOWN)["upper"], last(UNKNOWN)["decided_at"]) == (2.0, 0)
    publish(puppet, "rtamt/req", 1)
    found = last(VIOLATED)
    assert (found["name"], found["upper"]) == ("rob.value", -2.0)
    assert found["decided_at"] > 0
    wait_for_status(puppet, "violated")
