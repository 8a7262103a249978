"""docs/how-to/logs.md is run: Python and command lines print what stands below them."""

import contextlib
import io
import re
import shlex
from pathlib import Path

import pytest

from rtamt.cli import main

PAGE = (Path(__file__).parents[2] / "docs/how-to/logs.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```$", PAGE, flags=re.MULTILINE | re.DOTALL)


@pytest.fixture(autouse=True)
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = "0,10,0,go\n100,31,0,\n200,20,1,\n300,31,0,\n400,20,0,stop\n"
    Path("drive.csv").write_text(f"t [ms],speed [m/s],brake,note\n{rows}")
    Path("parked.csv").write_text("t [ms],speed [m/s],brake,note\n0,0,0,\n100,0,0,\n200,0,0,\n")
    Path("limits.stl").write_text("specification limits\nalways(speed <= 40)\n")
    Path("braking.stl").write_text(
        "specification braking\nalways(speed > 30 -> eventually[0:200ms](brake >= 0.5))\n"
    )


def test_the_page_says_what_its_programs_print():
    namespace = {}
    printed, compared = "", 0
    for language, text in BLOCKS:
        if language == "text":
            assert printed == text
            compared += 1
            continue
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            if language == "python":
                exec(compile(text, "logs.md", "exec"), namespace)  # noqa: S102 - our own page
            else:
                assert main(shlex.split(text)[1:]) in (0, 1)
        printed = out.getvalue()
        assert printed
    assert compared == 6
    assert printed.startswith("Trace of drive.csv")
    for report in ("report.xml", "report.sarif", "report.html"):
        assert Path(report).stat().st_size
