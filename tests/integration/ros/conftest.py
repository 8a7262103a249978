"""A workspace built by catkin, a master on a port of its own, nodes in processes of their own."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
import venv
import xmlrpc.client
from pathlib import Path

import pytest

from tests.integration.ros.processes import PATIENCE, Process, Puppet, free_port, stop_all, wait_for

collect_ignore_glob = ["puppet_*.py"]  # programs, run by a Python that has ROS

ROOT = Path(__file__).parents[3]
DEBIAN = Path("/usr/lib/python3/dist-packages")  # where Debian's ROS is; it is put behind this environment


def _missing():
    """Return what of ROS 1 is not here."""
    programs = [
        name for name in ("rosrun", "rosmaster", "catkin_make", "roslaunch") if shutil.which(name) is None
    ]
    modules = [
        name
        for name in ("rospy", "rosbag", "std_msgs", "nav_msgs", "diagnostic_msgs")
        if not (DEBIAN / name).is_dir()
    ]
    return [*programs, *modules]


@pytest.fixture(scope="session")
def ros_env(tmp_path_factory):
    """Build ros/ and the tests' message package with catkin; return the environment of a shell that sourced it."""
    if _missing():
        pytest.skip(
            f"ROS 1 is not installed ({', '.join(_missing())}); tools/apt-packages says what to install"
        )
    home = tmp_path_factory.mktemp("ros")
    python = _environment(home / "python")
    source = home / "workspace" / "src"
    source.mkdir(parents=True)
    for package in (
        ROOT / "ros/rtamt_msgs",
        ROOT / "ros/rtamt4ros",
        Path(__file__).parent / "packages/arm_msgs",
        ROOT / "examples/service_robot",
    ):
        (source / package.name).symlink_to(package)
    env = {name: value for name, value in os.environ.items() if not name.startswith("ROS_")}
    env = {**env, "PATH": f"{python.parent}{os.pathsep}{env['PATH']}", "PYTHONDONTWRITEBYTECODE": "1"}
    built = subprocess.run(
        ["catkin_make", "-C", str(source.parent), f"-DPYTHON_EXECUTABLE={python}"],
        cwd=source.parent,
        env=env,
        capture_output=True,
        text=True,
        check=False,
    )
    assert built.returncode == 0, built.stdout + built.stderr
    sourced = subprocess.run(
        ["bash", "-c", ". devel/setup.bash && env -0"],
        cwd=source.parent,
        env=env,
        capture_output=True,
        check=True,
        text=True,
    )
    env = dict(line.split("=", 1) for line in sourced.stdout.split("\0") if "=" in line)
    return {**env, "ROS_IP": "127.0.0.1", "ROS_HOME": str(home / "home"), "RTAMT_TEST_PYTHON": str(python)}


def _environment(path):
    """Make a Python in which this environment comes first and Debian's ROS after it; return its program."""
    venv.create(path, symlinks=True)
    here = sysconfig.get_path("purelib")
    there = Path(sysconfig.get_path("purelib", vars={"base": str(path), "platbase": str(path)}))
    (there / "ros.pth").write_text(f"import site; site.addsitedir({here!r})\n{DEBIAN}\n")
    return path / "bin" / Path(sys.executable).name


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
        """Tell whether the master takes calls."""
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
