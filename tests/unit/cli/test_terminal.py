"""Colour, tables and the counter line."""

import io
import re
import shutil
import sys

import pytest

from rtamt.cli.terminal import Progress, table, terminal_width, use_color


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture(autouse=True)
def _a_plain_terminal(monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm")


def test_colour_only_on_a_terminal(monkeypatch):
    assert use_color("auto", Terminal())
    assert not use_color("auto", io.StringIO())
    assert use_color("always", io.StringIO())
    assert not use_color("never", Terminal())
    monkeypatch.setenv("TERM", "dumb")
    assert not use_color("auto", Terminal())


@pytest.mark.parametrize("columns", ["60", "0", "-3", "wide", "", None])
@pytest.mark.parametrize("stdout", [sys.__stdout__, None, io.StringIO()])
def test_the_width_is_that_of_the_standard_library(monkeypatch, columns, stdout):
    monkeypatch.setattr(sys, "__stdout__", stdout)
    monkeypatch.delenv("COLUMNS", raising=False)
    if columns is not None:
        monkeypatch.setenv("COLUMNS", columns)
    assert terminal_width() == shutil.get_terminal_size().columns


def test_no_color_is_respected(monkeypatch):
    monkeypatch.setenv("NO_COLOR", "1")
    assert not use_color("auto", Terminal())
    assert use_color("always", Terminal())


def test_colour_does_not_change_the_columns():
    rows = [("a", "b"), ("x", "yy"), ("longer", "z")]
    kinds = ["good", "bad"]
    assert table(rows) == "a       b\nx       yy\nlonger  z"
    assert table(rows, kinds=kinds, color=True) == (
        "\x1b[1ma       b\x1b[0m\nx       \x1b[32myy\x1b[0m\nlonger  \x1b[31mz\x1b[0m"
    )


def test_a_table_wider_than_the_terminal_is_folded_within_its_columns():
    rows = [
        ("requirement", "trace", "verdict"),
        ("brakes in time", "x" * 30, "violated"),
        ("b", "y", "satisfied"),
    ]
    folded = table(rows, kinds=["bad", "good"], width=40).splitlines()
    assert max(map(len, folded)) <= 40
    assert "".join(line for line in folded).count("x") == 30
    assert table(rows, kinds=["bad", "good"], width=80) == table(rows, kinds=["bad", "good"])
    painted = table(rows, kinds=["bad", "good"], color=True, width=40)
    assert re.sub("\x1b\\[[0-9]+m", "", painted).split() == " ".join(folded).split()
    assert set(re.findall("\x1b\\[[0-9;]+m", painted)) == {f"\x1b[{code}m" for code in (0, 1, 31, 32)}


def test_a_table_is_plain_text_where_rich_is_not_installed(monkeypatch):
    rows = [("trace", "verdict"), ("x" * 30, "violated")]
    monkeypatch.setitem(sys.modules, "rich.table", None)
    assert table(rows, width=20) == table(rows)


def test_rich_draws_a_bar_and_takes_it_away(monkeypatch):
    monkeypatch.setattr(Progress, "PAUSE", 0.0)
    stream = Terminal()
    with Progress(stream) as progress:
        progress.bar(1, 4, "[b]a.csv")
        assert "1/4" in stream.getvalue()
        assert "[b]a.csv" in stream.getvalue()
    assert stream.getvalue().endswith("\x1b[2K")


def test_the_counter_line_comes_after_a_while_and_goes_away(monkeypatch):
    monkeypatch.setitem(sys.modules, "rich.progress", None)
    clock = iter([0.0, 0.1, 1.0, 1.0, 1.1])
    monkeypatch.setattr("rtamt.cli.terminal.time.monotonic", lambda: next(clock))
    stream = Terminal()
    with Progress(stream) as progress:
        progress.show("too early")
        progress.show("1/3 a.csv")
        progress.show("too soon")
    assert stream.getvalue() == "\r\x1b[K1/3 a.csv\r\x1b[K"


def test_no_counter_line_where_stderr_is_no_terminal(monkeypatch):
    monkeypatch.setattr(Progress, "PAUSE", 0.0)
    stream = io.StringIO()
    with Progress(stream) as progress:
        progress.show("1/3 a.csv")
    assert stream.getvalue() == ""
