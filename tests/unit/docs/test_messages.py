"""The page of messages: what an error is made with, also by functions that put it into a sentence."""

import importlib.util
import sys
from pathlib import Path

import pytest

TOOL = Path(__file__).parents[3] / "tools/docs/messages.py"

SOURCE = """\
EXAMPLE = "give dates such as 2026-05-01"


class Header:
    def error(self, line, problem):
        return TraceError(f"{self.file}, line {line}: {problem}")


class Cells:
    def check(self, text, line):
        if not text:
            raise self._error(line, "which is empty")
        problem = f"where '{text}' is no number"
        raise self._header.error(line, problem)

    def _error(self, line, what):
        return self._header.error(line, f"a cell {what}")


def other(at, strict):
    raise UsageError(f"--at is {at}: " + EXAMPLE if strict else "it is all the same")
"""


@pytest.fixture(scope="module")
def messages():
    spec = importlib.util.spec_from_file_location("messages", TOOL)
    module = importlib.util.module_from_spec(spec)
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "messages", module)  # dataclasses look there
        spec.loader.exec_module(module)
    return module


def test_texts_are_followed_through_the_functions_that_add_to_them(messages, tmp_path):
    (tmp_path / "cells.py").write_text(SOURCE)
    assert messages.by_kind(tmp_path) == {
        "TraceError": [
            "⟨file⟩, line ⟨line⟩: a cell which is empty",
            "⟨file⟩, line ⟨line⟩: where '⟨text⟩' is no number",
        ],
        "UsageError": ["--at is ⟨at⟩: give dates such as 2026-05-01", "it is all the same"],
    }


def test_what_the_readers_say_of_a_line_is_on_the_page(messages):
    found = messages.by_kind(TOOL.parents[2] / "src/rtamt")
    assert "⟨file⟩, line ⟨line⟩: '⟨name⟩' is '⟨text⟩', expected a number" in found["TraceError"]
    assert "this is not a program that can be read: it has no metadata" in found["UsageError"]
