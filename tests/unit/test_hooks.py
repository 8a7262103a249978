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
    done = run_action(tmp_path, inputs)
    assert done.returncode == code, done.stdout + done.stderr
    assert (tmp_path / "rtamt-report.xml").exists() == (
        bool(inputs.get("traces")) and "none" not in str(inputs)
    )


#: A file of this name beside a module ``evil`` ran that module: argparse took it for an option.
LIKE_AN_OPTION = "--language=evil:x"


@pytest.fixture
def evil(tmp_path):
    """Make a folder in which a module leaves a mark when it is imported; return the mark."""
    (tmp_path / "evil.py").write_text("open('mark', 'w').close()\n", encoding="utf-8")
    (tmp_path / f"{LIKE_AN_OPTION}.stl").write_text("always(x >= 3)", encoding="utf-8")
    (tmp_path / f"{LIKE_AN_OPTION}.csv").write_text("time,x\n0,4\n1,5\n", encoding="utf-8")
    return tmp_path / "mark"


def run_action(folder, inputs):
    """Run the last step of the action as GitHub runs one with ``shell: bash``."""
    step = ACTION["runs"]["steps"][-1]
    values = {name: inputs.get(name, about["default"]) for name, about in ACTION["inputs"].items()}
    environment = {
        key: re.sub(r"\$\{\{ inputs\.([\w-]+) \}\}", lambda match: values[match[1]], value)
        for key, value in step["env"].items()
    }
    return run_in(
        folder, ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]], **environment
    )


def run_in(folder, command, **environment):
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    return subprocess.run(
        command, cwd=folder, env={**os.environ, **environment, "PATH": path},
        capture_output=True, text=True, check=False,
    )  # fmt: skip


def test_a_file_called_like_an_option_ran_code_in_the_hook_for_pre_commit(tmp_path, evil):
    (hook,) = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
    done = run_in(tmp_path, [*shlex.split(hook["entry"]), f"{LIKE_AN_OPTION}.stl"])
    assert (done.returncode, done.stdout + done.stderr, evil.exists()) == (0, "", False)


@pytest.mark.parametrize("traces", ["", "*.csv"])
def test_a_file_called_like_an_option_ran_code_in_the_action(tmp_path, evil, traces):
    done = run_action(tmp_path, {"traces": traces, "options": "--period 1 --color never"})
    assert done.returncode == 0, done.stdout + done.stderr
    assert ("satisfied" in done.stdout) is bool(traces)
    assert not evil.exists()


def test_options_of_the_action_are_words_and_no_patterns(tmp_path):
    (tmp_path / "a.stl").write_text("v >= 3", encoding="utf-8")
    (tmp_path / "a.csv").write_text("time,volts[0]\n0,4\n1,5\n", encoding="utf-8")
    done = run_action(tmp_path, {"traces": "a.csv", "options": "--name v=volts[0]\n--period 1"})
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("command", ["check", "explain", "plot", "report", "info", "lint", "compile", "fmu"])
def test_no_command_takes_what_follows_two_dashes_for_an_option(tmp_path, monkeypatch, capsys, evil, command):
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    suffix = {"plot": ".png", "report": ".html", "fmu": ".fmu", "compile": ".rtamt"}.get(command)
    options = [] if suffix is None else ["-o", f"out{suffix}"]
    options += ["--period", "1"]
    traces = [f"{LIKE_AN_OPTION}.csv"] * (command in ("check", "explain", "plot", "report"))
    spec = tmp_path / f"{LIKE_AN_OPTION}.stl"
    if command in ("compile", "fmu"):
        spec.write_text("historically(x >= 3)", encoding="utf-8")
    # Options may also follow the specification, and an option's own value may stand just before the dashes.
    for arguments in ([*options, "--", spec.name, *traces], ["./" + spec.name, *options, "--", *traces]):
        assert main([command, *arguments]) == 0, capsys.readouterr().err
    assert not evil.exists()


def test_the_action_installs_extras_that_exist():
    wheel, sources = re.findall(r"\[([\w,]+)\]", ACTION["runs"]["steps"][1]["run"])
    assert wheel == sources
    assert set(sources.split(",")) <= set(PROJECT["project"]["optional-dependencies"])


#: Stands for Python: writes down its arguments, and downloads a wheel if the release has one.
PIP = """#!/bin/bash
echo "$@" >> "$CALLS"
if [[ $3 == download ]]; then
  [[ -n $WHEEL ]] || exit 1
  mkdir -p "${@: -2:1}"
  touch "${@: -2:1}/$WHEEL"
fi
"""


@pytest.mark.parametrize("wheel", ["rtamt-1.0-cp312-abi.whl", ""])
def test_the_action_installs_a_wheel_and_compiles_only_if_there_is_none(tmp_path, wheel):
    step = ACTION["runs"]["steps"][1]
    python = tmp_path / "python"
    python.write_text(PIP, encoding="utf-8")
    python.chmod(0o755)
    environment = {
        "RELEASE": "https://host/owner/rtamt/releases/expanded_assets/v1",
        "RUNNER_TEMP": str(tmp_path / "temp"),
        "GITHUB_ACTION_PATH": "/action",
        "CALLS": str(tmp_path / "calls"),
        "WHEEL": wheel,
        "PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}",
    }
    done = subprocess.run(
        ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]],
        env={**os.environ, **environment}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    download, install = (tmp_path / "calls").read_text(encoding="utf-8").splitlines()
    assert f"--find-links {environment['RELEASE']} " in download
    # On PyPI the name belongs to another project.
    assert " --no-index " in download
    what = f"{tmp_path}/temp/rtamt-wheels/{wheel}" if wheel else "/action"
    assert install == f"-m pip install {what}[data,report]"


def test_wheels_are_for_every_python_that_we_support():
    wheels = re.findall(r"cp3(\d+)-", PROJECT["tool"]["cibuildwheel"]["build"])
    assert list(map(int, wheels)) == [10, 11, 12, 13, 14]
    assert "cp313t-* cp314t-*" in PROJECT["tool"]["cibuildwheel"]["build"]
    assert PROJECT["project"]["requires-python"] == ">=3.10"


WORKFLOWS = [ROOT / "action.yml", *sorted((ROOT / ".github/workflows").glob("*.yml"))]


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_foreign_actions_are_pinned_by_hash_with_their_version_beside_it(path):
    lines = re.findall(r"uses: (.*)", path.read_text(encoding="utf-8"))
    assert [line for line in lines if not re.fullmatch(r"\S+@[0-9a-f]{40} # v\d+\.\d+\.\d+", line)] == []


def test_the_workflow_of_a_public_host_runs_what_must_pass_here():
    (job,) = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text(encoding="utf-8"))["jobs"].values()
    assert job["steps"][-1]["run"] == ".ci/run"
    assert os.access(ROOT / ".ci/run", os.X_OK)
