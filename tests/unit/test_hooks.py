"""What other tools take from the repository: the hook for pre-commit, the GitHub Action, the wheels' settings."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from rtamt.cli import main

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
ACTION = yaml.safe_load((ROOT / "action.yml").read_text(encoding="utf-8"))


def test_the_hook_for_pre_commit_checks_the_files_that_it_is_given(tmp_path, capsys):
    (hook,) = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
    assert hook["language"] == "python"
    assert re.search(hook["files"], "specs/response.stl")
    assert not re.search(hook["files"], "specs/response.stl.md")
    (tmp_path / "right.stl").write_text("x >= 3", encoding="utf-8")
    (tmp_path / "wrong.stl").write_text("x >=", encoding="utf-8")
    entry = shlex.split(hook["entry"])
    assert entry[0] == "rtamt"
    assert main([*entry[1:], str(tmp_path / "right.stl")]) == 0
    assert main([*entry[1:], str(tmp_path / "right.stl"), str(tmp_path / "wrong.stl")]) == 2
    assert "wrong.stl: expected an operand after '>='" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("inputs", "code"),
    [
        ({}, 0),
        ({"traces": "logs/good*.csv"}, 0),
        ({"traces": "logs/*.csv"}, 1),
        ({"traces": "logs/good.csv", "options": "--semantics boolean --quiet"}, 0),
        ({"traces": "none/*.csv"}, 1),
        ({"specs": "**/*.txt"}, 2),
    ],
)
def test_the_action_says_what_the_command_says(tmp_path, inputs, code):
    for path, text in {
        "specs/deep/spec.stl": "always(x >= 3)",
        "wrong.txt": "x >=",
        "logs/good.csv": "time,x\n0,4\n1,5\n",
        "logs/poor.csv": "time,x\n0,4\n1,2\n",
    }.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text, encoding="utf-8")
    step = ACTION["runs"]["steps"][-1]
    values = {name: inputs.get(name, about["default"]) for name, about in ACTION["inputs"].items()}
    environment = {
        key: re.sub(r"\$\{\{ inputs\.([\w-]+) \}\}", lambda match: values[match[1]], value)
        for key, value in step["env"].items()
    }
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    # As GitHub runs a step with `shell: bash`.
    done = subprocess.run(
        ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]],
        cwd=tmp_path, env={**os.environ, **environment, "PATH": path}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == code, done.stdout + done.stderr
    assert (tmp_path / "rtamt-report.xml").exists() == (
        bool(inputs.get("traces")) and "none" not in str(inputs)
    )


def test_the_action_installs_an_extra_that_exists():
    (extra,) = re.findall(r"\[(\w+)\]", ACTION["runs"]["steps"][1]["run"])
    assert extra in PROJECT["project"]["optional-dependencies"]


def test_wheels_are_for_every_python_that_we_support():
    wheels = re.findall(r"cp3(\d+)-", PROJECT["tool"]["cibuildwheel"]["build"])
    assert list(map(int, wheels)) == [10, 11, 12, 13, 14]
    assert PROJECT["project"]["requires-python"] == ">=3.10"
