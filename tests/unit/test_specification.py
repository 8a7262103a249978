"""Specifications: formulas that a monitor evaluates beside its own."""

import pickle

import pytest

import rtamt

SPEC = rtamt.parse("asked = req >= 3; always[0:1](asked -> gnt >= 3)")
FORMULAS = {
    "asked": rtamt.parse("req >= 3").formula,
    "once[0:1](asked)": rtamt.parse("once[0:1](req >= 3)").formula,
    "gnt - req": rtamt.parse("gnt - req").formula,
}
SAMPLES = [(5.0, 2.0), (1.0, 4.0), (3.5, 3.0)]


def outcomes(verdict: str, watched: object, semantics: str) -> list[object]:
    """Return what a monitor reports of a watched formula after each sample."""
    monitor = SPEC.monitor(watch=watched, verdict=verdict, semantics=semantics)
    found = []
    for t, (req, gnt) in enumerate(SAMPLES):
        monitor.update(float(t), req=req, gnt=gnt)
        found.append(monitor[watched])
    return found


@pytest.mark.parametrize("semantics", ["standard", "boolean"])
@pytest.mark.parametrize(
    ("text", "verdict"),
    [
        (text, verdict)
        for text in ("asked", "once[0:1](asked)")
        for verdict in ("delayed", "eager", "interval")
    ]
    + [("gnt - req", "delayed"), ("gnt - req", "interval")],
)
def test_a_formula_is_watched_as_its_text_is(text, verdict, semantics):
    formula = FORMULAS[text]
    assert outcomes(verdict, formula, semantics) == outcomes(verdict, text, semantics)


def test_a_formula_is_watched_in_dense_time_as_its_text_is():
    formula = FORMULAS["once[0:1](asked)"]
    by_formula = SPEC.monitor(time="dense", watch=[formula])
    by_text = SPEC.monitor(time="dense", watch=["once[0:1](asked)"])
    for monitor in (by_formula, by_text):
        for t, (req, gnt) in enumerate(SAMPLES):
            monitor.update(float(t), req=req, gnt=gnt)
    assert by_formula[formula].values.tolist() == by_text["once[0:1](asked)"].values.tolist() != []


def test_a_formula_is_found_by_an_equal_one_and_watched_once():
    monitor = SPEC.monitor(watch=[FORMULAS["asked"], rtamt.parse("req >= 3").formula])
    monitor.update(0.0, req=5, gnt=2)
    assert monitor[rtamt.parse("req>=3").formula] == 2.0


@pytest.mark.parametrize("other", ["x > 2", None, SPEC.pastified])
def test_with_formula_takes_no_text(other):
    with pytest.raises(
        rtamt.UsageError, match=r"with_formula takes a formula, such as spec\.pastified\(\), got"
    ):
        SPEC.with_formula(other)


def test_a_specification_of_another_formula_is_pickled_with_that_formula():
    spec = SPEC.with_formula(SPEC.pastified())
    twin = pickle.loads(pickle.dumps(spec))
    assert twin.formula == spec.formula != SPEC.formula
    monitor = spec.monitor()
    monitor.update(0.0, req=5.0, gnt=2.0)
    resumed = pickle.loads(pickle.dumps(monitor))
    assert resumed.update(1.0, req=5.0, gnt=4.0) == monitor.update(1.0, req=5.0, gnt=4.0)
