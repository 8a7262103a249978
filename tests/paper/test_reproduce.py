"""examples/paper: the paper's claims come out; the report has them beside what was measured."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parents[2] / "examples" / "paper"


@pytest.fixture(scope="module")
def found():
    command = [sys.executable, str(HERE / "experiments.py"), "--quick"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def test_listings(found):
    assert found["listing 1"] == [[0.0, 3.0], [10.0, 3.0]]
    assert found["listing 2"] == [[[0.0, "inf"], [2.0, "inf"]], [[5.0, 3.0], [10.0, 3.0]]]


def test_figure_4_has_the_claims_of_its_caption(found, monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.syspath_prepend(str(HERE))
    import reproduce

    for name, claims in reproduce.CLAIMS.items():
        assert {measure: found["figure 4"][name][measure] for measure in claims} == claims


def test_the_report_has_every_part_and_does_without_rtamt(found, monkeypatch, tmp_path):
    pytest.importorskip("matplotlib")
    monkeypatch.syspath_prepend(str(HERE))
    import reproduce

    monkeypatch.setattr(reproduce, "CASES", {"A case": "examples/none/run.py"})
    monkeypatch.setattr(reproduce, "OUT", tmp_path)
    text = reproduce.report({"this library": found})
    assert "RTAMT is not installed here: `make peers`" in text
    assert "| (b) | output robustness | inf | inf |" in text
    assert "`examples/none/run.py` is not here." in text
    both = {"this library": found, "RTAMT": {**found, "windows": "RTAMTException: no"}}
    assert "RTAMTException: no" in reproduce.report(both)
    reproduce.draw_scaling(both)
    reproduce.draw_windows(both)
    assert {path.name for path in tmp_path.iterdir()} == {"scaling.png", "windows.png"}
