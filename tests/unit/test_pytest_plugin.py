"""The plugin for pytest: explained failures, plots, properties, and a message where matplotlib is missing."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

import rtamt
from rtamt.assertions import UnsatisfiedError, assert_satisfied, facts

pytest_plugins = ["pytester"]

ROOT = Path(__file__).parents[2]
SPEC = "require low: always(x <= 3)\nrequire high: always(x >= 1)\n"


@pytest.fixture
def folder(pytester):
    """A folder with a specification beside the tests."""
    pytester.makefile(".stl", limits=SPEC)
    return pytester


def run(folder, body, *arguments):
    """Run a test module in this process."""
    folder.makepyfile(f"from pathlib import Path\nimport rtamt\nLIMITS = Path('limits.stl')\n\n{body}")
    return folder.runpytest_inprocess("-p", "no:cacheprovider", *arguments)


def test_a_satisfied_requirement_returns_the_result():
    result = assert_satisfied(SPEC, {"x": [1, 2]})
    assert result.robustness == 0


def test_the_message_explains_each_failed_requirement():
    with pytest.raises(UnsatisfiedError) as failed:
        assert_satisfied(SPEC, {"x": [2, 5]})
    assert str(failed.value) == (
        "1 of 2 requirements failed\n"
        "low: violated, robustness -2: always(x <= 3)\n"
        "first violation at 1 s\n"
        "critical point at 1 s: 'x <= 3' is -2; the robustness follows it up to 1\n"
        "sufficient cause, independent of all other samples:\n"
        "  'x <= 3' fails at 1 s (-2)"
    )
    assert list(failed.value.failures) == ["low"]


def test_a_margin_is_the_least_robustness():
    assert assert_satisfied("always(x >= 3)", {"x": [5, 4]}, margin=1).robustness == 1
    with pytest.raises(
        UnsatisfiedError, match=r"^the robustness is 1, less than the margin of 1.5\nsatisfied"
    ):
        assert_satisfied("always(x >= 3)", {"x": [5, 4]}, margin=1.5)


def test_a_violation_without_robustness_fails():
    with pytest.raises(UnsatisfiedError, match="violated, robustness 0"):
        assert_satisfied("always(x > 3)", {"x": [5, 3]})


@pytest.mark.parametrize("margin", [-1, float("nan"), "1"])
def test_a_margin_below_zero_is_rejected(margin):
    with pytest.raises(rtamt.UsageError, match=f"^margin is {margin!r}, expected a number of at least 0$"):
        assert_satisfied("x >= 3", {"x": [5]}, margin=margin)


def test_options_reach_the_evaluation():
    with pytest.raises(rtamt.BoundError, match="period"):
        assert_satisfied("always[0:1](x >= 3)", {"x": [5, 5]}, period="300ms")


def test_a_violation_that_is_decided_though_samples_are_missing_fails():
    with pytest.raises(UnsatisfiedError) as failed:
        assert_satisfied("always(x > 0)", {"x": [1, -1, None]})
    assert str(failed.value) == "violated, robustness -inf to -1: always(x > 0)"


def test_a_margin_is_reached_though_samples_are_missing():
    data = {"x": [1, 2, None]}
    assert assert_satisfied("eventually(x > 0)", data, margin=2).interval.lower == 2
    with pytest.raises(UnsatisfiedError, match=r"^the robustness is 2 to 5, less than the margin of 6\n"):
        assert_satisfied("eventually(x > 0)", data, margin=6, ranges={"x": (0, 5)})
    with pytest.raises(rtamt.EvaluationError, match="only known to lie between 2 and inf"):
        assert_satisfied("eventually(x > 0)", data, margin=3)


def test_the_fixture_reports_bounds_where_samples_are_missing(folder):
    body = """
def test_satisfied(stl):
    stl.assert_satisfied("eventually(x > 0)", {"x": [1, -1, None]})

def test_violated(stl):
    stl.assert_satisfied("always(x > 0)", {"x": [1, -1, None]})
"""
    result = run(folder, body, "--junit-xml=report.xml")
    result.assert_outcomes(passed=1, failed=1)
    properties = ET.parse(folder.path / "report.xml").iter("property")
    report = {each.get("name"): each.get("value") for each in properties}
    plot = report.pop("rtamt.plot")
    assert plot.startswith("plot: ")
    assert plot.endswith(".png")
    assert report == {
        "rtamt.requirement_1.verdict": "violated",
        "rtamt.requirement_1.robustness": "-inf to -1",
    }


def test_facts_of_a_requirement_without_a_name():
    assert facts(rtamt.parse("always(x >= 3)").evaluate({"x": [5]})) == {
        "requirement_1.verdict": "satisfied",
        "requirement_1.robustness": "2",
    }


def test_a_failure_shows_the_explanation_and_the_plot(folder):
    outcome = run(
        folder,
        "def test_drive(stl):\n    stl.assert_satisfied(LIMITS, {'x': [2, 5]})\n",
        "--stl-plots=plots",
    )
    outcome.assert_outcomes(failed=1)
    plot = folder.path / "plots" / "test_a_failure_shows_the_explanation_and_the_plot.py_test_drive-low.png"
    assert plot.read_bytes().startswith(b"\x89PNG")
    outcome.stdout.fnmatch_lines(
        [
            ">*stl.assert_satisfied(LIMITS, {'x': [[]2, 5[]]})",
            "E*low: violated, robustness -2: always(x <= 3)",
            "E*'x <= 3' fails at 1 s (-2)",
            "*requirements*",
            f"plot: {plot}",
        ]
    )
    outcome.stdout.no_fnmatch_line("*assertions.py*")


def test_a_failure_without_the_fixture_is_plotted_too(folder):
    outcome = run(folder, "def test_drive():\n    rtamt.assert_satisfied('x >= 3', {'x': [2]})\n")
    outcome.assert_outcomes(failed=1)
    outcome.stdout.fnmatch_lines(["plot: *test_drive*.png"])


def test_another_failure_is_not_plotted(folder):
    outcome = run(
        folder,
        "def test_drive(stl):\n    assert not stl.load(LIMITS).name\n    assert 0\n",
        "--stl-plots=plots",
    )
    outcome.assert_outcomes(failed=1)
    assert not (folder.path / "plots").exists()


def test_properties_reach_the_junit_report(folder):
    body = (
        "def test_drive(stl):\n"
        "    stl.assert_satisfied(LIMITS, {'x': [2, 3]})\n"
        "    stl.assert_satisfied(LIMITS, {'x': [2, 5]})\n"
    )
    run(folder, body, "--junit-xml=report.xml", "--stl-plots=plots").assert_outcomes(failed=1)
    found = {
        each.attrib["name"]: each.attrib["value"]
        for each in ET.parse(folder.path / "report.xml").iter("property")
    }
    assert found.pop("rtamt.plot").endswith("test_drive-low.png")
    assert found == {
        "rtamt.low.verdict": "satisfied",
        "rtamt.low.robustness": "0",
        "rtamt.high.verdict": "satisfied",
        "rtamt.high.robustness": "1",
        "rtamt.low.verdict.2": "violated",
        "rtamt.low.robustness.2": "-2",
        "rtamt.low.first_violation.2": "1 s",
        "rtamt.high.verdict.2": "satisfied",
        "rtamt.high.robustness.2": "1",
    }


def test_without_matplotlib_the_failure_says_what_to_install(folder, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    outcome = run(folder, "def test_drive(stl):\n    stl.assert_satisfied('x >= 3', {'x': [2]})\n")
    outcome.stdout.fnmatch_lines(["E*violated, robustness -1: x >= 3", "*pip install 'rtamt[[]plot[]]'"])


def test_the_tests_of_the_cruise_controller_pass(tmp_path):
    """The worked example, run as a user runs it."""
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(ROOT / "examples" / "cruise")],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "5 passed" in done.stdout
