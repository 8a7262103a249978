"""Every page does what it says."""

from __future__ import annotations

import os
import re
import shutil
import sys
from pathlib import Path

import pytest

from rtamt.cli import COMMANDS, main
from tests.unit.docs.pages import FILES, PAGES, ROOT, Page, blocks


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to run a page in, in which modules are found, and `rtamt` by its name."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv("PATH", os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]))
    monkeypatch.setenv("COLUMNS", "100")
    return tmp_path


@pytest.mark.parametrize("path", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_what_a_page_says_is_what_happens(path: Path, place: Path) -> None:
    (place / "examples").symlink_to(ROOT / "examples")
    if (FILES / path.stem).is_dir():
        shutil.copytree(FILES / path.stem, place, dirs_exist_ok=True)
    known = set(sys.modules)
    try:
        Page(str(path.relative_to(ROOT)), path.read_text(encoding="utf-8")).run()
    finally:
        for name in set(sys.modules) - known:  # modules that the page wrote
            if str(getattr(sys.modules[name], "__file__", "")).startswith(str(place)):
                del sys.modules[name]


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("```python\nprint(1)  # 2\n```\n", "page, line 1 prints\n1\n"),
        ("a\n```python\nprint(1)\n```\n```text\n2\n```\n", "page, line 2 prints\n1\n"),
        ("```python\nprint(1)\n```\n", "page, line 1 prints\n1\n"),
        (
            "```console\nrtamt check 'x >=' log.csv\n```\n",
            "page, line 1: 'rtamt check 'x >=' log.csv' says 2",
        ),
        ("```console\n$ echo 1\n```\n```text\n2\n```\n", "page, line 1 prints\n1\n"),
        ("```sh\nmake nothing-such\n```\n", "page, line 1: no task of make: {'nothing-such'}"),
        ("```sh\npip install 'rtamt[such]'\n```\n", "page, line 1: no extra: {'such'}"),
        ("```pyhton\n```\n", "page, line 1: 'pyhton' is not among"),
    ],
)
@pytest.mark.usefixtures("place")
def test_a_page_that_says_something_else_is_found(text: str, complaint: str) -> None:
    with pytest.raises(AssertionError) as failure:
        Page("page", text).run()
    assert str(failure.value).startswith(complaint)


def test_the_blocks_of_a_page_are_found() -> None:
    found = blocks('a\n```csv title="log.csv"\ntime,x\n```\n```python\n# m.py\nx = 1\n```\n```\nplain\n```\n')
    assert [(b.language, b.file, b.line) for b in found] == [
        ("csv", "log.csv", 2),
        ("python", "m.py", 5),
        ("", None, 9),
    ]


def test_commands_in_prose_exist() -> None:
    for path in PAGES:
        named = set(re.findall(r"`rtamt (\w+)", path.read_text(encoding="utf-8")))
        assert named <= set(COMMANDS), path


def test_the_page_on_extension_does_all_that_the_language_can_be_extended_by() -> None:
    text = (ROOT / "docs/how-to/extend.md").read_text(encoding="utf-8")
    for word in ("expansion=", "definition=", "Blocks(", "RTAMT_KERNEL(", "semantics=", "check_operator("):
        assert word in text


def test_the_exit_codes_in_the_readme(tmp_path, capsys):
    trace = tmp_path / "log.csv"
    trace.write_text("time,x\n0,1\n", encoding="utf-8")
    codes = [main(["check", text, str(trace)]) for text in ("x >= 0", "x >= 2", "x >=")]
    assert codes == [0, 1, 2]
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert (
        "The exit code is 0 if the requirement is satisfied, 1 if it is violated and 2 on an error" in readme
    )
    capsys.readouterr()


def test_the_readme_links_every_page():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    pages = {path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").rglob("*.md")}
    assert pages - set(re.findall(r"\((docs/[^)#]+)", readme)) == set()
