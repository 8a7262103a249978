"""Fixtures of the command-line tests."""

import pytest

from tests.unit.cli import invoke


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    """Run the command line in an empty directory."""
    monkeypatch.chdir(tmp_path)
    return lambda *args, stdin="": invoke(capsys, monkeypatch, args, stdin)


@pytest.fixture
def write(tmp_path):
    """Write a file into that directory, return its name."""

    def write(name, content):
        (tmp_path / name).write_text(content, encoding="utf-8")
        return name

    return write
