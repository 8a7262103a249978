"""Requirement sets in ``examples/requirements``: one made trace satisfies each requirement, another violates it."""

from functools import cache
from pathlib import Path

import pytest

import rtamt
from tests.integration.examples.requirements import TRACES
from tests.integration.examples.requirements.traces import step

FOLDER = Path(__file__).parents[3] / "examples" / "requirements"
EACH = [(file, requirement) for file, traces in TRACES.items() for requirement in traces.cases]


@cache
def load_file(file):
    return rtamt.load(FOLDER / f"{file}.stl")


def test_every_requirement_of_every_file_has_its_traces():
    files = sorted(path.relative_to(FOLDER).with_suffix("").as_posix() for path in FOLDER.rglob("*.stl"))
    assert files == sorted(TRACES)
    for file, traces in TRACES.items():
        assert list(load_file(file).requirements) == list(traces.cases)
        assert load_file(file).warnings == ()


@pytest.mark.parametrize(("file", "requirement"), EACH)
def test_a_requirement_separates_a_good_trace_from_a_bad_one(file, requirement):
    traces, spec = TRACES[file], load_file(file).requirements[requirement]
    good, bad = (spec.evaluate(traces.made(changed)) for changed in traces.cases[requirement])
    assert good.satisfied is True
    assert good.robustness >= 0
    assert bad.satisfied is False
    assert bad.robustness <= 0


@pytest.mark.parametrize(("failure", "moved"), [(1, "ib"), (2, "ic"), (4, "ic")])
def test_the_selected_value_is_held_whichever_branch_has_failed(failure, moved):
    """Only the failure of branch c was covered."""
    file = "lockheed_martin/triplex_signal_monitor"
    requirement = load_file(file).requirements["TSM-004"]
    columns = {"failure": failure, moved: step(5, 3, 1)}
    assert requirement.evaluate(TRACES[file].made(columns | {"selected": 1})).satisfied is True
    assert requirement.evaluate(TRACES[file].made(columns | {"selected": step(6, 2, 1)})).satisfied is False


@pytest.mark.parametrize("element", [f"check{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)])
def test_every_element_of_the_inverse_is_checked(element):
    """Four of the nine were left out."""
    file = "lockheed_martin/effector_blender"
    columns = TRACES[file].made({element: 0.5})
    assert load_file(file).requirements["EB-002"].evaluate(columns).satisfied is False
