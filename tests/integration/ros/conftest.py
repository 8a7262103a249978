"""A workspace built by catkin, a master on a port of its own, nodes in processes of their own."""

from __future__ import annotations

import subprocess
import xmlrpc.client
from pathlib import Path

import pytest

from tests.integration.ros.processes import PATIENCE, Process, Puppet, free_port, stop_all, wait_for
from tests.integration.ros.workspace import ROOT, build, missing

collect_ignore_glob = ["puppet_*.py"]  # programs, run by a Python that has ROS


@pytest.fixture(scope="session")
def ros_env(tmp_path_factory):
    """Build ros/, the tests' message package and the service robot; return the environment."""
    if missing():
        pytest.skip(
            f"ROS 1 is not installed ({', '.join(missing())}); tools/apt-packages says what to install"
        )
    arm = Path(__file__).parent / "packages/arm_msgs"
    return build(tmp_path_factory.mktemp("ros"), arm, ROOT / "examples/service_robot")


class Ros:
    """A master, and what runs on it."""

    def __init__(self, env, folder):
        self.port = free_port()
        self.env = {
            **env,
            "ROS_MASTER_URI": f"http://127.0.0.1:{self.port}",
            "ROS_LOG_DIR": str(folder / "log"),
        }
        self.folder = folder
        self.processes = []
        self.master = self.start_master()

    def start(self, *command):
        """Start a program in the test's folder."""
        process = Process([str(part) for part in command], self.env, self.folder)
        self.processes.append(process)
        return process

    def start_master(self):
        """Start a master; the port is always the same."""
        master = self.start("rosmaster", "--core", "-p", str(self.port))
        wait_for(self.master_answers, "the master")
        return master

    def master_answers(self):
        """Return whether the master takes calls."""
        try:
            with xmlrpc.client.ServerProxy(self.env["ROS_MASTER_URI"]) as master:
                return master.getPid("/test")[0] == 1
        except OSError:
            return False

    def run(self, *command):
        """Run a program to its end."""
        return subprocess.run(
            [str(part) for part in command],
            env=self.env,
            cwd=self.folder,
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )

    def puppet(self):
        """Start a node that does what it is told."""
        puppet = Puppet("puppet_ros1.py", self.env)
        self.processes.append(puppet)
        return puppet

    def monitor(self, text, *arguments):
        """Start the monitor as users do, on a specification; return its process when it listens."""
        (self.folder / "spec.stl").write_text(text)
        return self.start("rosrun", "rtamt4ros", "ros_stl_monitor.py", "spec.stl", *arguments)


@pytest.fixture
def ros(ros_env, tmp_path):
    """Start a master for one test."""
    world = Ros(ros_env, tmp_path)
    yield world
    stop_all(world.processes)
