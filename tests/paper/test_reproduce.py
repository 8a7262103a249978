"""examples/paper: the paper's claims come out; the report has them beside what was measured."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

HERE = Path(__file__).parents[2] / "examples" / "paper"


@pytest.fixture(scope="module")
def found():
    command = [sys.executable, str(HERE / "experiments.py"), "--quick"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


@pytest.fixture
def reproduce(monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.syspath_prepend(str(HERE))
    import reproduce

    return reproduce


def test_listings(found):
    assert found["listing 1"] == [[0.0, 3.0], [10.0, 3.0]]
    assert found["listing 2"] == [[[0.0, "inf"], [2.0, "inf"]], [[5.0, 3.0], [10.0, 3.0]]]
    assert found["listing 8"] == [1.0] * 12 + [-3.0] * 3


def test_figure_1_has_the_robustness_of_its_caption(found):
    assert {name: round(value, 9) for name, value in found["figure 1"].items()} == {
        "satisfied": 0.048,
        "violated": -0.198,
    }


def test_a_pastified_formula_tells_the_same_at_every_instant(found):
    for told in found["pastification"].values():
        agree, _, of = told.partition(" of ")
        assert agree == of != "0"


def test_figure_4_has_the_claims_of_its_caption(found, reproduce):
    for name, claims in reproduce.CLAIMS.items():
        assert {measure: found["figure 4"][name][measure] for measure in claims} == claims


def test_the_report_has_every_part_and_does_without_rtamt(found, reproduce, monkeypatch, tmp_path):
    monkeypatch.setattr(reproduce, "CASES", [replace(reproduce.CASES[0], program="examples/none/run.py")])
    monkeypatch.setattr(reproduce, "scripts", lambda: "## Listings 3 to 8")
    text = reproduce.report({"this library": found})
    assert "RTAMT is not installed here: `make peers`" in text
    assert "| (b) | output robustness | inf | inf |" in text
    assert "`examples/none/run.py` is not here." in text
    both = {"this library": found, "RTAMT": {**found, "windows": "RTAMTException: no"}}
    assert "RTAMTException: no" in reproduce.report(both)
    reproduce.figures.draw_all(both, tmp_path)
    drawn = {path.name for path in tmp_path.iterdir()}
    assert drawn == {"pid.png", "operators.png", "interface.png", "scaling.png", "windows.png"}
    assert all(f"]({name})" in text for name in drawn)
