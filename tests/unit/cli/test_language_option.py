"""--language: operators of the user's own on the command line."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest

from rtamt.cli import main

if TYPE_CHECKING:
    from pathlib import Path

MODULE = """
from rtamt.extend import STL, Fixity, Operator, Sort

HALF = Operator("half", ("half",), Fixity.FUNCTION, 200, (Sort.NUMBER,), Sort.NUMBER, "Half of it.", "half(x) >= 1",
                definition=lambda x: x / 2)
MINE = STL.extend(HALF)
"""


@pytest.fixture(autouse=True)
def _module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "half_of_it.py").write_text(MODULE, encoding="utf-8")
    (tmp_path / "log.csv").write_text("time,x\n0,4\n1,2\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delitem(sys.modules, "half_of_it", raising=False)


def test_it_is_the_language_of_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    path = list(sys.path)
    assert main(["check", "always(half(x) >= 1)", "log.csv", "--language", "half_of_it:MINE"]) == 0
    assert main(["info", "half(x) >= 1", "--language", "half_of_it:MINE"]) == 0
    assert main(["operators", "half", "--language", "half_of_it:MINE"]) == 0
    assert "half(x) >= 1  Half of it." in " ".join(capsys.readouterr().out.split(" ")).replace("   ", "  ")
    assert sys.path == path


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            "half_of_it",
            "--language is 'half_of_it'; give a module and a name in it, such as my_operators:MINE",
        ),
        ("no_such:MINE", "there is no module 'no_such' for --language no_such:MINE"),
        (
            "half_of_it:YOURS",
            "'YOURS' in the module 'half_of_it' is None, expected a Language: STL.extend(...)",
        ),
    ],
)
def test_what_is_no_language_is_refused(given: str, message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["operators", "--language", given]) == 2
    assert capsys.readouterr().err == f"rtamt: {message}\n"
