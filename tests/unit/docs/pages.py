"""How a page is run, block by block, from top to bottom, in an empty folder.

==============================  =====================================================================
block                           what is done
==============================  =====================================================================
```LANGUAGE title="FILE"        the file is written; so is a block whose first line is ``# FILE`` or ``// FILE``.
                                A Python file that is there already goes on.
```python                       runs, in one namespace a page. What it prints stands in comments
                                behind its prints, then in the ```text block that follows.
```console                      every line is run by the shell, with or without ``$`` before it, and may not
                                fail; ``rtamt`` may say 1, violated. What is printed stands in the ```text
                                block that follows, if one does.
```sh                           not run: sets up a machine. Tasks of make and extras of pip must exist.
==============================  =====================================================================

Other languages are not run. Files that a page takes for granted are in ``files/<name of the page>``.
"""

from __future__ import annotations

import contextlib
import io
import re
import shlex
import subprocess
import sys
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING

from rtamt.cli import main

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).parents[3]
FILES = Path(__file__).parent / "files"
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]

RUN = ("python", "console")
SHOWN = ("text", "sh", "cpp", "c", "cmake", "csv", "stl", "ebnf", "json", "toml", "xml", "yaml", "matlab", "")

_BLOCK = re.compile(r'^```(\w*)(?: title="([\w./-]+)")?\n(.*?)^```$', re.MULTILINE | re.DOTALL)
_FILE = re.compile(r"\A(?:#|//) ([\w./-]+\.\w+)\n")
# A line that prints says in a comment what it prints.
_PRINTED = re.compile(r"^ *print\(.*\) +# (.*)$", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Block:
    """A block of a page; ``file`` is the name of the file that it is, if it is one."""

    language: str
    file: str | None
    text: str
    line: int


def blocks(text: str) -> list[Block]:
    """Return the blocks of a page."""
    found = []
    for match in _BLOCK.finditer(text):
        named = _FILE.match(match[3])
        file = match[2] or (named and named[1])
        found.append(Block(match[1], file, match[3], text.count("\n", 0, match.start()) + 1))
    return found


class Page:
    """A page that is being run in the current folder."""

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self.blocks = blocks(text)
        self.namespace: dict[str, object] = {"__name__": "page"}

    def run(self) -> None:
        """Run every block; raise AssertionError where one does not do what the page says."""
        for block, after in zip_longest(self.blocks, self.blocks[1:]):
            where = f"{self.name}, line {block.line}"
            if block.file is not None:
                self._write(block, Path(block.file))
                continue
            assert block.language in (*RUN, *SHOWN), f"{where}: '{block.language}' is not among {RUN + SHOWN}"
            said = after.text if after is not None and after.language == "text" and not after.file else None
            if block.language == "python":
                self._python(block, said, where)
            elif block.language == "console":
                self._console(block, said, where)
            elif block.language == "sh":
                check_set_up(block.text, where)

    def _write(self, block: Block, path: Path) -> None:
        going_on = path.exists() and path.suffix == ".py"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text((path.read_text(encoding="utf-8") if going_on else "") + block.text, encoding="utf-8")
        sys.modules.pop(path.stem, None)

    def _python(self, block: Block, said: str | None, where: str) -> None:
        out = io.StringIO()
        code = compile("\n" * block.line + block.text, self.name, "exec")
        with contextlib.redirect_stdout(out):
            exec(code, self.namespace)  # noqa: S102 - our own text
        comments = _PRINTED.findall(block.text)
        expected = "".join(f"{line}\n" for line in comments) + (said or "")
        assert out.getvalue() == expected, f"{where} prints\n{out.getvalue()}"

    def _console(self, block: Block, said: str | None, where: str) -> None:
        out = ""
        for line in block.text.splitlines():
            command = line.removeprefix("$ ").partition("  #")[0].strip()
            code, printed = _run(command)
            limit = 1 if command.startswith("rtamt ") else 0
            assert code <= limit, f"{where}: '{command}' says {code}\n{printed}"
            out += printed
        assert said is None or out == said, f"{where} prints\n{out}"


def _run(command: str) -> tuple[int, str]:
    """Run a command line: ours in this process, which is quicker, any other by the shell."""
    words = shlex.split(command, comments=False)
    if words[0] != "rtamt" or set(words) & set("<>|&;") or "$(" in command:
        done = subprocess.run(["/bin/sh", "-c", command], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout + done.stderr
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
        code = main(list(_expanded(words[1:])))
    return code, out.getvalue()


def _expanded(words: list[str]) -> Iterator[str]:
    """Replace ``logs/*.csv`` by the files there, as a shell does."""
    for word in words:
        found = sorted(map(str, Path().glob(word))) if re.fullmatch(r"[\w./-]*\*[\w.]*", word) else []
        yield from found or [word]


def check_set_up(text: str, where: str) -> None:
    """Hold what sets up a machine to what there is: tasks of the Makefile, extras of pyproject.toml."""
    tasks = set(
        re.findall(r"^([a-z-]+):.*## ", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    )
    optional = (
        (ROOT / "pyproject.toml").read_text(encoding="utf-8").partition("[project.optional-dependencies]")[2]
    )
    extras = set(re.findall(r"^(\w+) = \[", optional.partition("\n[")[0], re.MULTILINE))
    named = set(re.findall(r"^make ([a-z-]+)", text, re.MULTILINE))
    assert named <= tasks, f"{where}: no task of make: {named - tasks}"
    wanted = {
        e
        for group in re.findall(r"rtamt\[([\w,]+)\]|\.\[([\w,]+)\]", text)
        for e in ",".join(group).split(",")
        if e
    }
    assert wanted <= extras, f"{where}: no extra: {wanted - extras}"
