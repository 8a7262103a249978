"""Fixtures of the tests of readers."""

import pytest


@pytest.fixture
def write(tmp_path, monkeypatch):
    """Write a file into the working directory, which is a temporary one, and return its name."""
    monkeypatch.chdir(tmp_path)

    def write(content, name="log.csv"):
        data = content if isinstance(content, bytes) else content.encode()
        (tmp_path / name).write_bytes(data)
        return name

    return write
