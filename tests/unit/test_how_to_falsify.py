"""docs/how-to/falsify.md is run: its files are written, its Python and command lines run, and print what it says."""

import contextlib
import io
import re
import shlex
import sys
from pathlib import Path

from rtamt.cli import main

PAGE = (Path(__file__).parents[2] / "docs/how-to/falsify.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", PAGE, flags=re.MULTILINE | re.DOTALL)
FILE = re.compile(r"\A# ([\w.]+)\n")


def test_the_page_says_what_its_programs_print(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "tank", raising=False)
    namespace, printed, compared, codes = {}, "", 0, []
    for language, text in BLOCKS:
        named = FILE.match(text)
        if named:
            Path(named[1]).write_text(text, encoding="utf-8")
        elif language == "text":
            assert printed == text
            compared += 1
        elif language == "console":
            with contextlib.redirect_stdout(io.StringIO()):
                codes += [main(shlex.split(line)[2:]) for line in text.splitlines()]
        else:
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                exec(compile(text, "falsify.md", "exec"), namespace)  # noqa: S102 - our own page
            printed = out.getvalue()
    assert compared == 3
    assert codes[0] == 1
    assert codes[1] in {0, 1}
    assert Path("run.png").exists()
    assert Path("run.jsonl").exists()
