"""docs/how-to/extend.md does what it says: its files are written, its Python, C++ and command lines run."""

from __future__ import annotations

import contextlib
import io
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "extend.md"
TEXT = PAGE.read_text(encoding="utf-8")
# A block of code: its language, its text.
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", TEXT, flags=re.MULTILINE | re.DOTALL)
FILE = re.compile(r"\A(?:#|//) ([\w.]+)\n")
# A line that prints says in a comment what it prints.
PRINTED = re.compile(r"^print\(.*\) +# (.*)$", flags=re.MULTILINE)


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which the files of the page are written, and its modules are found."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv("PATH", os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]))
    (tmp_path / "trace.csv").write_text("time,x\n0,1\n1,2\n2,3\n", encoding="utf-8")
    return tmp_path


def test_every_block_runs_in_order(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    namespace: dict[str, object] = {"__name__": "extend"}
    for language, block in BLOCKS:
        named = FILE.match(block)
        if named is not None:
            write(place / named[1], block)
            monkeypatch.delitem(sys.modules, "my_operators", raising=False)
        elif language == "python":
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                exec(compile(block, str(PAGE), "exec"), namespace)  # noqa: S102 - our own text
            assert printed.getvalue().splitlines() == PRINTED.findall(block)
        else:
            assert language == "console"
            for line in block.splitlines():
                done = subprocess.run(["/bin/sh", "-c", line], capture_output=True, text=True, check=False)
                assert done.returncode == 0, done.stdout + done.stderr
                assert done.stdout
    monkeypatch.delitem(sys.modules, "my_operators", raising=False)


def write(path: Path, block: str) -> None:
    """Write a file, or go on with it: a page shows a Python module piece by piece."""
    going_on = path.exists() and path.suffix == ".py"
    path.write_text((path.read_text(encoding="utf-8") if going_on else "") + block, encoding="utf-8")


def test_the_page_does_all_that_the_language_can_be_extended_by() -> None:
    for word in ("expansion=", "definition=", "Blocks(", "RTAMT_KERNEL(", "semantics=", "check_operator("):
        assert word in TEXT
