"""Tests of the command line, and the way they call it."""

import io
import sys
from typing import NamedTuple

from rtamt.cli import main


class Answer(NamedTuple):
    code: int
    out: str
    err: str


def invoke(capsys, monkeypatch, args, stdin=""):
    """Run the command line in this process; ``stdin`` is text or bytes."""
    data = stdin if isinstance(stdin, bytes) else stdin.encode()
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data), encoding="utf-8"))
    code = main(list(args))
    captured = capsys.readouterr()
    return Answer(code, captured.out, captured.err)
