"""What files, columns and requirements are called: it drives no terminal and breaks no report."""

import json
import os
import re
import stat
import sys
from xml.etree import ElementTree as ET

import pytest

from rtamt.cli.terminal import Progress
from rtamt.files import write_text

NASTY = ["log\x1b[2J\x07.csv", "log\u202evsc.csv", b"caf\xe9.csv", "log\r\x9b.csv"]
#: What a terminal would act on, beside the colours that we print.
ACTIVE = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]")


@pytest.mark.parametrize("name", NASTY)
@pytest.mark.parametrize(
    "options", [[], ["--json"], ["--color", "always"], ["--period", "2"], ["--time-column", "a\x1bb"]]
)
def test_what_a_file_is_called_drives_no_terminal_and_breaks_no_report(run, tmp_path, name, options):
    name = os.fsdecode(name)
    (tmp_path / name).write_text("time,x\n0,1\n1,-1\n")
    reports = [part for kind in ("junit", "sarif", "html") for part in (f"--{kind}", kind)]
    answer = run("check", "always(x >= 0)", name, *options, *reports)
    assert answer.code == (2 if options and options[0] in ("--period", "--time-column") else 1)
    assert "internal error" not in answer.err
    assert not ACTIVE.search(re.sub("\x1b\\[(31|1|0)m", "", answer.out + answer.err))
    if options == ["--json"]:
        assert json.loads(answer.out)["trace"].encode().decode().startswith(name[:3])
    ET.fromstring((tmp_path / "junit").read_bytes())
    uri = json.loads((tmp_path / "sarif").read_bytes())["runs"][0]
    assert uri["tool"]["driver"]["name"] == "rtamt"
    assert (tmp_path / "html").read_bytes().decode().rstrip().endswith("</html>")


def test_columns_and_requirements_drive_no_terminal_either(run, write):
    write("log.csv", "time,x\x1b[31m,\x07\n0,1,1\n")
    for answer in (run("check", "y >= 0", "log.csv"), run("info", "log.csv"), run("monitor", "y\x1b >= 0")):
        assert answer.out + answer.err
        assert not ACTIVE.search(answer.out + answer.err)


@pytest.mark.parametrize("drawn", [True, False])
def test_progress_drives_no_terminal(monkeypatch, drawn):
    if not drawn:
        monkeypatch.setitem(sys.modules, "rich.progress", None)

    class Terminal:
        text = ""

        def isatty(self):
            return True

        def write(self, text):
            self.text += text

        def flush(self):
            pass

    terminal = Terminal()
    progress = Progress(terminal)
    progress._next = 0
    progress.bar(1, 2, "log\x1b]0;evil\x07.csv")
    assert r"log\x1b]0;evil\x07.csv" in terminal.text
    assert "\x1b]" not in terminal.text
    assert "\x07" not in terminal.text


# ---- output files ------------------------------------------------------------------------------------


def test_a_report_that_cannot_be_finished_leaves_the_one_before(run, write, tmp_path, monkeypatch):
    write("log.csv", "time,x\n0,1\n")
    assert run("check", "x >= 0", "log.csv", "--html", "page.html").code == 0
    before = (tmp_path / "page.html").read_text()
    (tmp_path / "page.html").chmod(0o640)

    def full(*_):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", full)
        answer = run("check", "x >= 5", "log.csv", "--html", "page.html")
    assert (answer.code, answer.err) == (2, "rtamt: cannot write 'page.html': No space left on device\n")
    assert (tmp_path / "page.html").read_text() == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["log.csv", "page.html"]
    assert run("check", "x >= 5", "log.csv", "--html", "page.html").code == 1
    assert (tmp_path / "page.html").read_text() != before
    assert stat.S_IMODE((tmp_path / "page.html").stat().st_mode) == 0o640


def test_links_and_pipes_stay_what_they_are(tmp_path):
    (tmp_path / "real").write_text("before")
    (tmp_path / "link").symlink_to("real")
    write_text(tmp_path / "link", "after")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_text() == "after"
    (tmp_path / "dangling").symlink_to("new")
    write_text(tmp_path / "dangling", "here")
    assert (tmp_path / "new").read_text() == "here"
    write_text("/dev/null", "gone")
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)


def test_new_files_have_the_permissions_that_the_user_wants(tmp_path):
    before = os.umask(0o027)
    try:
        write_text(tmp_path / "new", "x")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == 0o640
