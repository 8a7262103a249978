"""``rtamt new``: a specification file from a pattern, by options or by answers."""

from pathlib import Path

from tests.unit.cli import invoke

TEXT = """\
import "patterns.stl"

float speed
bool locked

require DOOR-1 "Each (speed is more than 2) is followed by locked within 1 s.":
    response_within(speed > 2, locked, 1s)
"""


def test_by_options(run, tmp_path):
    options = ("response_within", "p=speed > 2", "s=locked", "duration=1s", "--id", "DOOR-1")
    assert run("new", *options) == (0, TEXT, "")
    path = tmp_path / "door.stl"
    assert run("new", *options, "-o", str(path)).code == 0
    assert path.read_text() == TEXT
    assert run("lint", "--strict", str(path)).code == 0
    assert run("new", *options, "-o", str(path)) == (
        2,
        "",
        f"rtamt: '{path}' exists; choose another name with -o\n",
    )


def test_by_answers(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    answer = invoke(
        capsys, monkeypatch, ["new", "--id", "DOOR-1"], "response_within\nspeed > 2\nlocked\n1s\n\n"
    )
    assert (answer.code, answer.err) == (0, "")
    assert "response(p, s)" in answer.out
    assert answer.out.endswith(
        "response_within.stl: Each (speed is more than 2) is followed by locked within 1 s.\n"
    )
    assert Path("response_within.stl").read_text() == TEXT


def test_what_is_missing_is_said(run):
    answer = run("new", "response", "p=x > 1")
    assert (answer.code, answer.err) == (
        2,
        "rtamt: there is no answer for 's'; give it on the command line, see 'rtamt new --help'\n",
    )
    assert "is no argument of a pattern; write NAME=TEXT" in run("new", "response", "x > 1").err
