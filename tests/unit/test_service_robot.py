"""The service robot of the paper's section 7.2, started as users start it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import rtamt

FOLDER = Path(__file__).parents[2] / "examples" / "service_robot"
NAMES = ("system", "perception", "planner", "controller")


def drive(*arguments):
    """Run the experiment; return what it prints, from the word before the colon."""
    ended = subprocess.run(
        [sys.executable, FOLDER / "run.py", *arguments], capture_output=True, text=True, check=False
    )
    assert (ended.returncode, ended.stderr) == (0, "")
    return dict(line.split(": ", 1) for line in ended.stdout.splitlines() if ": " in line)


def fell(told, name):
    return float(told[name].split("violated at ")[1].removesuffix(" s"))


def test_no_specification_of_a_healthy_robot_falls():
    told = drive("--seed", "3")
    assert (told["fault"], told["violated first"]) == ("none", "none")
    assert all(told[name].endswith("satisfied") for name in NAMES)


def test_a_tree_that_is_cut_off_leads_into_the_desk_and_the_planner_falls_seconds_before_the_system(tmp_path):
    told = drive("--fault", "planner", "--seed", "3", "--plots", str(tmp_path))
    assert told["violated first"] == "planner"
    begun = float(told["fault"].split(" at ")[1].removesuffix(" s"))
    assert begun < fell(told, "planner") < fell(told, "system") - 2
    assert told["perception"].endswith("satisfied")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["robustness.png", "scene.gif", "scene.png"]


@pytest.mark.parametrize("component", ["perception", "controller"])
@pytest.mark.parametrize("seed", ["0", "1"])  # another kind of fault each
def test_a_fault_of_another_component_is_named(component, seed):
    told = drive("--fault", component, "--seed", seed)
    assert told["fault"].startswith(component)
    assert told["violated first"] == component


@pytest.mark.parametrize("name", NAMES)
def test_the_specifications_have_the_horizons_of_the_paper(name):
    spec = rtamt.load(FOLDER / "specs" / f"{name}.stl", period=0.1)
    assert (spec.name, spec.horizon) == (name, 3 if name in {"system", "planner"} else 7 + 5)
