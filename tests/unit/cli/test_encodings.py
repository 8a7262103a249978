"""What an encoding of stdout lacks is escaped in text for people, and an error in files for programs."""

from __future__ import annotations

import sys
from io import BytesIO, TextIOWrapper

import pytest

from rtamt.cli import main

SPECIFICATION = 'float "größe" [m]\nrequire R-1 "hält Maß": always("größe" >= 1)\n'
#: FRET has no such names, but such texts.
TITLED = 'float size [m]\nrequire R-1 "hält Maß": always(size >= 1)\n'


@pytest.fixture
def ascii_output(monkeypatch, tmp_path):
    """Run the command line with a stdout that has ASCII only; return the exit code and what it prints."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "size.stl").write_text(SPECIFICATION, encoding="utf-8")
    (tmp_path / "titled.stl").write_text(TITLED, encoding="utf-8")
    (tmp_path / "size.csv").write_text("time,größe\n0,1\n1,0\n", encoding="utf-8")

    def run(*arguments):
        streams = [
            TextIOWrapper(BytesIO(), encoding="ascii", errors=errors)
            for errors in ("strict", "backslashreplace")
        ]
        with monkeypatch.context() as patched:
            for name, stream in zip(("stdout", "stderr"), streams, strict=True):
                patched.setattr(sys, name, stream)
            code = main(list(arguments))
        for stream in streams:
            stream.flush()
        return code, *(stream.buffer.getvalue().decode("ascii") for stream in streams)

    return run


@pytest.mark.parametrize(
    ("arguments", "code", "line"),
    [
        (["info", "size.stl"], 0, r"formula    always(gr\xf6\xdfe >= 1)"),
        (["info", "size.csv"], 0, r"gr\xf6\xdfe"),
        (["describe", "size.stl"], 0, r"gr\xf6\xdfe is at least 1"),
        (["check", "size.stl", "size.csv"], 1, r"always(gr\xf6\xdfe >= 1)"),
        (["explain", "size.stl", "size.csv"], 1, r"gr\xf6\xdfe >= 1"),
    ],
)
def test_text_for_people_is_escaped(arguments, code, line, ascii_output):
    found, out, errors = ascii_output(*arguments)
    assert (found, errors) == (code, "")
    assert line in out, out


@pytest.mark.parametrize(
    ("arguments", "lacking", "note"),
    [
        (["info", "size.stl", "--latex"], "f6", ""),
        (
            ["convert", "titled.stl", "--to", "fret"],
            "e4",
            "rtamt: titled.stl: note: one tick is one sample of 1 s\n",
        ),
    ],
)
def test_files_for_programs_are_refused(arguments, lacking, note, ascii_output):
    assert ascii_output(*arguments) == (
        2,
        "",
        f"{note}rtamt: the output contains '\\x{lacking}', which its encoding, ascii, lacks; "
        "set PYTHONIOENCODING=utf-8\n",
    )


def test_json_needs_ascii_only(ascii_output):
    code, out, _ = ascii_output("info", "size.stl", "--json")
    assert code == 0
    assert "gr\\u00f6\\u00dfe" in out
