"""The service robot as nodes on a real master: the drive, and what the monitors say of it, is that without ROS."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[3] / "examples" / "service_robot"
SEED = "3"
FELL = re.compile(r"^(\w+): .*violated at ([\d.]+) s(, the first component)?$", re.MULTILINE)


def without_ros():
    """Return when each specification fell in a plain run (s)."""
    run = [sys.executable, FOLDER / "run.py", "--fault", "planner", "--seed", SEED]
    told = subprocess.run(run, capture_output=True, text=True, check=True).stdout
    return {name: float(time) for name, time, _ in FELL.findall(told)}


def test_the_planner_falls_first_when_its_tree_is_cut_off(ros):
    arguments = ["fault:=planner", f"seed:={SEED}", "duration:=40", "speed:=5"]
    launch = ros.start("roslaunch", "service_robot", "experiment.launch", *arguments)
    launch.wait_for_output("system: violated")
    fell = {name: (float(time), bool(first)) for name, time, first in FELL.findall(launch.output)}
    plain = without_ros()
    assert [name for name, (_, first) in fell.items() if first] == ["planner"]
    assert {"planner", "system"} <= set(fell) <= set(plain)
    for name, (time, _) in fell.items():  # dense time here, discrete time there: a sample more or less
        assert time == pytest.approx(plain[name], abs=0.11)
