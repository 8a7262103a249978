"""What the README says is run: its Python prints what the comments say, its command lines work."""

from __future__ import annotations

import contextlib
import io
import json
import re
import shlex
import shutil
from pathlib import Path

import pytest

from rtamt.cli import COMMANDS, OK, main
from rtamt.cli.command import VIOLATED
from tests.unit.cli import invoke

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
# A block of code: its language, its text.
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```$", README, flags=re.MULTILINE | re.DOTALL)
# A line that prints says in a comment what it prints.
PRINTED = re.compile(r"^ *print\(.*\) +# (.*)$", flags=re.MULTILINE)
COMMAND_LINES = [
    line.partition("#")[0].strip()
    for language, block in BLOCKS
    if not language
    for line in block.splitlines()
    if line.startswith("rtamt ")
]


def test_the_examples_print_what_their_comments_say():
    blocks = [block for language, block in BLOCKS if language == "python"]
    assert len(blocks) >= 4
    namespace = {"__name__": "README"}
    for block in blocks:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(block, "README.md", "exec"), namespace)  # noqa: S102 - our own text
        assert block.count("print(") == len(PRINTED.findall(block)) > 0
        assert printed.getvalue().splitlines() == PRINTED.findall(block)


@pytest.mark.parametrize("line", COMMAND_LINES)
def test_a_command_line_of_the_readme_works(line, tmp_path, monkeypatch, capsys):
    shutil.copy(ROOT / "examples" / "request_grant" / "a_satisfied.csv", tmp_path / "log.csv")
    requirement = "input float req\ninput float gnt\n(req >= 3) -> eventually[0:5](gnt >= 3)\n"
    (tmp_path / "requirement.stl").write_text(requirement, encoding="utf-8")
    samples = [{"time": time, "req": 0.0, "gnt": 5.0} for time in range(10)]
    (tmp_path / "samples.jsonl").write_text("\n".join(map(json.dumps, samples)), encoding="utf-8")
    shutil.copytree(ROOT / "examples" / "cruise", tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    arguments, _, source = line.partition(" < ")
    stdin = (tmp_path / source).read_text(encoding="utf-8") if source else ""
    code, out, err = invoke(capsys, monkeypatch, shlex.split(arguments)[1:], stdin)
    # A search that finds what it looks for ends as a check does.
    assert (code, err) == (VIOLATED if " falsify " in line else OK, "")
    assert out


def test_the_readme_shows_every_command():
    assert {line.split()[1] for line in COMMAND_LINES} == set(COMMANDS)


def test_commands_in_prose_exist():
    named = set(re.findall(r"`rtamt (\w+)`", README))
    assert named
    assert named <= set(COMMANDS)


def test_the_exit_codes_that_the_readme_tells(tmp_path, capsys):
    trace = tmp_path / "log.csv"
    trace.write_text("time,x\n0,1\n", encoding="utf-8")
    codes = [main(["check", text, str(trace)]) for text in ("x >= 0", "x >= 2", "x >=")]
    assert codes == [0, 1, 2]
    assert "exit 0 satisfied, 1 violated, 2 error" in README
    capsys.readouterr()
