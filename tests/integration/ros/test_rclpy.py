"""The node on rclpy, where ROS 2 is installed and ros/rtamt_msgs is built for it: real topics, two processes."""

from __future__ import annotations

import os
import signal
import sys

import pytest

from tests.integration.ros.processes import Process, stop_all, wait_for
from tests.integration.ros.test_ros2 import free_domain
from tests.integration.ros.workspace import ROOT

rclpy = pytest.importorskip("rclpy", reason="ROS 2 is not installed: there is no rclpy")
messages = pytest.importorskip(
    "rtamt_msgs.msg", reason="ros/rtamt_msgs is not built for ROS 2: colcon build, and source it"
)

LISTING_8 = ROOT / "ros/rtamt4ros/specs/spec.stl"


class Puppet:
    """A node in this process that publishes req and gnt, and hears what the monitor says."""

    def __init__(self):
        self.node = rclpy.create_node("puppet")
        self.heard, self.judged = [], []
        number, verdict = messages.FloatStamped, messages.Verdict
        self.publishers = [self.node.create_publisher(number, f"rtamt/{name}", 10) for name in ("req", "gnt")]
        self.subscriptions = [
            self.node.create_subscription(number, "rtamt/rob", self.heard.append, 10),
            self.node.create_subscription(verdict, "rtamt/rob/verdict", self.judged.append, 10),
        ]

    def publish_value(self):
        """Publish a request that is never granted; take what came."""
        for publisher, value in zip(self.publishers, (5.0, 1.0), strict=True):
            publisher.publish(messages.FloatStamped(value=value))
        rclpy.spin_once(self.node, timeout_sec=0.02)


@pytest.fixture
def start(monkeypatch, tmp_path):
    """Return what starts the monitor with arguments, in a domain of its own; a puppet is there already."""
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
    monkeypatch.setenv(
        "PYTHONPATH", f"{ROOT / 'ros/rtamt4ros2'}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
    )
    started = []

    def monitor(*arguments):
        program = [sys.executable, "-m", "rtamt4ros2.ros_stl_monitor", *arguments]
        started.append(Process(program, dict(os.environ), tmp_path))
        return started[-1]

    rclpy.init()
    yield monitor
    rclpy.shutdown()
    stop_all(started)


@pytest.mark.parametrize(
    "arguments",
    [
        [str(LISTING_8), "--period", "100", "--unit", "ms", "--stale", "0"],
        # The command line makes numbers of these parameters.
        ["--ros-args", "-p", f"spec:={LISTING_8}", "-p", "period:=0.1", "-p", "stale:=0"],
    ],
)
def test_robustness_and_verdicts_come_every_period_from_arguments_or_parameters(start, arguments):
    node = start(*arguments)
    puppet = Puppet()

    def received():
        puppet.publish_value()
        return [m.value for m in puppet.heard][-1:] == [-2.0] and puppet.judged[-1:]

    verdict = wait_for(received, "the violation")[0]
    assert (verdict.name, verdict.horizon) == ("rob.value", 15.0)
    timestamps = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in puppet.heard[-2:]]
    assert (timestamps[1] - timestamps[0]) % 10**8 == 0
    assert node.stop(signal.SIGINT) == 0
    assert "Traceback" not in node.output


def test_a_quality_of_service_that_is_none_is_said(start):
    node = start(str(LISTING_8), "--period", "1", "--ros-args", "-p", "reliability:=besteffort")
    node.wait_for_output(
        "ros_stl_monitor: the reliability of topics cannot be 'besteffort'; choose from reliable, best_effort"
    )
    assert node.stop() == 2
