"""A workspace built by catkin from ros/, and the environment of a shell that sourced it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path

ROOT = Path(__file__).parents[3]
DEBIAN = Path("/usr/lib/python3/dist-packages")  # where Debian's ROS is; it is put behind this environment
PACKAGES = (ROOT / "ros/rtamt_msgs", ROOT / "ros/rtamt4ros")


def missing():
    """Return what of ROS 1 is not here."""
    programs = [
        name for name in ("rosrun", "rosmaster", "catkin_make", "roslaunch") if shutil.which(name) is None
    ]
    modules = [
        name
        for name in ("rospy", "rosbag", "std_msgs", "geometry_msgs", "nav_msgs", "diagnostic_msgs")
        if not (DEBIAN / name).is_dir()
    ]
    return [*programs, *modules]


def build(home, *packages):
    """Build ros/ and other packages in an empty folder; return the environment, ``RTAMT_PYTHON`` its Python."""
    python = _environment(home / "python")
    source = home / "workspace" / "src"
    source.mkdir(parents=True)
    for package in (*PACKAGES, *packages):
        (source / package.name).symlink_to(package)
    env = {name: value for name, value in os.environ.items() if not name.startswith("ROS_")}
    # As docs/how-to/ros.md has it: with the environment active, and no option names its Python.
    active = {
        "PATH": f"{python.parent}{os.pathsep}{env['PATH']}",
        "VIRTUAL_ENV": str(python.parent.parent),
        "CMAKE_POLICY_VERSION_MINIMUM": "3.5",
    }
    env = {**env, **active, "PYTHONDONTWRITEBYTECODE": "1"}
    built = subprocess.run(
        ["catkin_make", "-C", str(source.parent)],
        cwd=source.parent,
        env=env,
        capture_output=True,
        text=True,
        check=False,
    )
    assert built.returncode == 0, built.stdout + built.stderr
    (node,) = source.parent.glob("devel/lib/rtamt4ros/ros_stl_monitor.py")
    assert node.read_text().startswith(
        f"#!{python.parent / 'python3'}\n"
    )  # runs in the environment that built it
    sourced = subprocess.run(
        ["bash", "-c", ". devel/setup.bash && env -0"],
        cwd=source.parent,
        env=env,
        capture_output=True,
        check=True,
        text=True,
    )
    env = dict(line.split("=", 1) for line in sourced.stdout.split("\0") if "=" in line)
    return {**env, "ROS_IP": "127.0.0.1", "ROS_HOME": str(home / "home"), "RTAMT_PYTHON": str(python)}


def _environment(path):
    """Make a Python in which this environment comes first and Debian's ROS after it; return its program."""
    venv.create(path, symlinks=True)
    here = sysconfig.get_path("purelib")
    there = Path(sysconfig.get_path("purelib", vars={"base": str(path), "platbase": str(path)}))
    (there / "ros.pth").write_text(f"import site; site.addsitedir({here!r})\n{DEBIAN}\n")
    return path / "bin" / Path(sys.executable).name
