"""The node on Cyclone DDS alone, and another participant in a process of its own, on loopback."""

from __future__ import annotations

import os
import signal
import socket
import sys

import pytest

from rtamt.cli import main
from rtamt.ros.dds.types import Types
from tests.integration.ros.processes import Process, Puppet, free_port, stop_all, wait_for

FLOAT = "rtamt_msgs/msg/FloatStamped"
VERDICT = "rtamt_msgs/msg/Verdict"
BOUNDS = "rtamt_msgs/msg/Bounds"
SATISFIED = 1
LOOPBACK = """<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>
<AllowMulticast>false</AllowMulticast></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>50</MaxAutoParticipantIndex>
<Peers><Peer address="127.0.0.1"/></Peers></Discovery></Domain></CycloneDDS>"""
SPEC = """
specification response
from rtamt_msgs.msg import FloatStamped
from geometry_msgs.msg import PoseWithCovarianceStamped
input FloatStamped req  output FloatStamped gnt  output FloatStamped rob  output FloatStamped sure
input PoseWithCovarianceStamped pose
@ topic(req, rtamt/req)  @ topic(gnt, /rtamt/gnt)  @ topic(rob, rtamt/rob)  @ topic(pose, amcl_pose)
rob.value = eventually[0,1](gnt.value >= req.value);
sure.value = historically("pose.pose.covariance[35]" <= 0.5)
"""


def free_domain():
    """Return a domain in which nobody on this machine is: the port of its first participant is free."""
    first = range(7410 + 250, 32_000, 250)
    return str((free_port(socket.SOCK_DGRAM, first) - 7410) // 250)


@pytest.fixture
def dds(tmp_path):
    """Start programs on loopback, in a domain of their own."""
    pytest.importorskip("cyclonedds", reason="ROS 2 topics need cyclonedds: pip install 'rtamt[ros]'")
    env = {**os.environ, "ROS_DOMAIN_ID": free_domain(), "CYCLONEDDS_URI": LOOPBACK, "PYTHONUNBUFFERED": "1"}
    env.pop("ROS_DISTRO", None)
    (tmp_path / "spec.stl").write_text(SPEC)
    started = []

    class World:
        def node(self, *arguments):
            command = [sys.executable, "-m", "rtamt", "ros2", "spec.stl", *arguments]
            started.append(Process(command, env, tmp_path))
            return started[-1]

        def puppet(self, *quality):
            puppet = Puppet("puppet_ros2.py", env, *quality)
            started.append(puppet)
            return puppet

    yield World()
    stop_all(started)


def stamped(puppet, topic, value, at):
    header = {"stamp": {"sec": int(at), "nanosec": int(at % 1 * 1e9)}}
    puppet.ask(do="publish", topic=topic, fields={"header": header, "value": value})


def test_two_processes_on_dds_alone_in_dense_time(dds):
    puppet = dds.puppet()
    for topic in ("rtamt/req", "rtamt/gnt"):
        puppet.ask(do="advertise", topic=topic, kind=FLOAT)
    pose = "geometry_msgs/msg/PoseWithCovarianceStamped"
    puppet.ask(do="advertise", topic="amcl_pose", kind=pose)
    for topic, kind in (("rtamt/rob", FLOAT), ("rtamt/rob/verdict", VERDICT), ("rtamt/sure", FLOAT)):
        puppet.ask(do="subscribe", topic=topic, kind=kind)
    puppet.ask(do="subscribe", topic="/diagnostics", kind="diagnostic_msgs/msg/DiagnosticArray")
    node = dds.node("--time", "dense", "--stale", "0")
    for topic in ("rtamt/req", "rtamt/gnt", "amcl_pose", "rtamt/rob", "rtamt/rob/verdict", "rtamt/sure"):
        wait_for(lambda topic=topic: puppet.ask(do="peers", topic=topic)["answer"], f"the node on {topic}")
    # The puppet knows the node's writers; a message on its last subscription proves that they know all its readers.
    puppet.wait_for("/diagnostics")

    for at, gnt in ((10, 1.0), (10.5, 4.0), (11.25, 0.0), (13, 0.0)):
        stamped(puppet, "rtamt/gnt", gnt, at)
    for at in (10, 13):
        stamped(puppet, "rtamt/req", 3.0, at)

    def numbers(messages):
        return {
            m["header"]["stamp"]["sec"] + m["header"]["stamp"]["nanosec"] / 1e9: m["value"] for m in messages
        }

    heard = puppet.wait_for("rtamt/rob", lambda messages: 13 in numbers(messages))
    # Where the last grant came later than the requests, it is also told how far the first ones reached.
    assert {11.25: 1, **numbers(heard)} == {10: -2, 10.5: 1, 11.25: 1, 12.25: -3, 13: -3}
    verdicts = puppet.wait_for(
        "rtamt/rob/verdict", lambda messages: messages and messages[-1]["header"]["stamp"]["sec"] == 13
    )
    assert {(m["name"], m["horizon"]) for m in verdicts} == {("rob.value", 1.0)}
    assert [m["verdict"] for m in verdicts][:1] == [0]
    assert [m["verdict"] for m in verdicts][-1:] == [2]

    covariance = [0.0] * 35 + [0.25]
    puppet.ask(
        do="publish",
        topic="amcl_pose",
        fields={"header": {"stamp": {"sec": 5}}, "pose": {"covariance": covariance}},
    )
    assert numbers(puppet.wait_for("rtamt/sure")) == {5: 0.25}

    # What `ros2 node list` and `ros2 topic list` read: three topics in, four out and /diagnostics.
    wait_for(lambda: ["response", 3, 5] in puppet.ask(do="nodes")["answer"], "the node in the graph")
    # What `ros2 topic info --verbose` reads: the hash of the type.
    for topic, kind in (("rtamt/req", FLOAT), ("rtamt/rob", FLOAT), ("rtamt/rob/verdict", VERDICT)):
        types = Types()
        expected = [f"typehash={types.type_hash(types.named(kind))};"]
        assert puppet.ask(do="user_data", topic=topic)["answer"] == expected
    puppet.wait_for(
        "/diagnostics", lambda arrays: any(s["message"] == "violated" for a in arrays for s in a["status"])
    )
    assert node.stop(signal.SIGINT) == 0
    wait_for(
        lambda: not any("response" in told for told in puppet.ask(do="nodes")["answer"]), "the node's leaving"
    )


def test_simulated_time_and_quality_of_service(dds):
    puppet = dds.puppet("best_effort")
    for topic, kind in (("rtamt/req", FLOAT), ("rtamt/gnt", FLOAT), ("/clock", "rosgraph_msgs/msg/Clock")):
        puppet.ask(do="advertise", topic=topic, kind=kind)
    puppet.ask(do="subscribe", topic="rtamt/rob", kind=FLOAT)
    puppet.ask(do="subscribe", topic="/diagnostics", kind="diagnostic_msgs/msg/DiagnosticArray")
    listener = dds.puppet()
    listener.ask(do="subscribe", topic="rtamt/rob", kind=FLOAT)
    deaf = dds.node("--sim-time", "--period", "1")  # reliable: it is not offered that
    node = dds.node("--sim-time", "--period", "1", "--reliability", "best_effort", "--node", "hears")
    for topic in ("rtamt/req", "rtamt/gnt", "/clock", "rtamt/rob"):
        wait_for(lambda topic=topic: puppet.ask(do="peers", topic=topic)["answer"], f"the node on {topic}")

    def tick():
        tick.seconds += 1
        stamped(puppet, "rtamt/req", 3.0, 0)
        stamped(puppet, "rtamt/gnt", 5.0, 0)
        puppet.ask(do="publish", topic="/clock", fields={"clock": {"sec": tick.seconds}})
        return len(puppet.messages("rtamt/rob")) >= 3

    tick.seconds = 100
    wait_for(tick, "robustness")
    heard = puppet.messages("rtamt/rob")
    assert {message["value"] for message in heard} == {2.0}
    # What the node publishes is reliable whatever it reads.
    wait_for(lambda: tick() and listener.messages("rtamt/rob"), "robustness at a reliable listener")
    deaf.wait_for_output(
        "[WARN] a publisher on rtamt/req is not heard, for its reliability is less than is asked for: "
        "--reliability best_effort hears it"
    )
    assert "is not heard" not in node.output
    assert all(100 < message["header"]["stamp"]["sec"] <= tick.seconds for message in heard)

    def conditions(name):
        arrays = puppet.messages("/diagnostics")
        return [s["message"] for array in arrays for s in array["status"] if s["hardware_id"] == name]

    wait_for(lambda: conditions("response"), "the deaf node's condition")
    assert all(said.startswith("waiting for the first message") for said in conditions("response"))
    wait_for(lambda: "satisfied" in conditions("hears"), "the hearing node's condition")
    assert node.stop(signal.SIGTERM) == 0
    assert deaf.stop(signal.SIGTERM) == 0


@pytest.mark.parametrize("domain", ["abc", "-1", "233"])
def test_a_domain_that_there_is_not_is_said(tmp_path, monkeypatch, capsys, domain):
    pytest.importorskip("cyclonedds", reason="ROS 2 topics need cyclonedds: pip install 'rtamt[ros]'")
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)
    (tmp_path / "spec.stl").write_text(SPEC)
    assert main(["ros2", str(tmp_path / "spec.stl"), "--period", "1"]) == 2
    assert (
        capsys.readouterr().err == f"rtamt: ROS_DOMAIN_ID is '{domain}'; give a whole number from 0 to 232\n"
    )


def test_a_type_that_is_not_known_is_said(dds):
    node = dds.node("--distro", "hummble", "--period", "1")
    node.wait_for_output("rtamt: unknown distribution 'hummble' of ROS 2; did you mean 'humble'? ")
    wait_for(lambda: node.popen.poll() is not None, "the end of the command")
    assert node.stop() == 2


def test_bounds_and_verdict_at_the_start_of_the_trace_on_dds_alone(dds, tmp_path):
    (tmp_path / "spec.stl").write_text(
        """
        from rtamt_msgs.msg import FloatStamped
        input FloatStamped req  output FloatStamped rob
        rob.value = always(req.value >= 2)
        """
    )
    puppet = dds.puppet()
    puppet.ask(do="advertise", topic="rtamt/req", kind=FLOAT)
    puppet.ask(do="subscribe", topic="rtamt/rob/bounds", kind=BOUNDS)
    dds.node("--period", "100ms", "--stale", "0")
    for topic in ("rtamt/req", "rtamt/rob/bounds"):
        wait_for(lambda topic=topic: puppet.ask(do="peers", topic=topic)["answer"], f"the node on {topic}")

    def send(value):
        puppet.ask(do="publish", topic="rtamt/req", fields={"value": value})

    def last(verdict):
        return puppet.wait_for(
            "rtamt/rob/bounds", lambda messages: messages and messages[-1]["verdict"] == verdict
        )[-1]

    send(5.0)
    assert (last(0)["upper"], last(0)["decided_at"]) == (3.0, 0)
    send(-1.0)
    found = last(2)
    assert (found["name"], found["upper"]) == ("rob.value", -3.0)
    stamp = found["header"]["stamp"]
    assert 0 < found["decided_at"] <= stamp["sec"] * 10**9 + stamp["nanosec"]
