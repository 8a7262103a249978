"""The solver agrees with brute force over small grids, and the engine with every trace that it finds."""

import pytest
from hypothesis import assume, given, settings

import rtamt
from rtamt.analysis.arithmetic import ENCODED, NONLINEAR
from rtamt.analysis.bounded_checker import BoundedChecker, Part
from rtamt.analysis.encoder import NotCoveredError
from rtamt.errors import StlError
from rtamt.language.contents import variables
from rtamt.language.operators import STL, Pointwise
from rtamt.language.unwritten import UNWRITTEN
from tests.laws.analysis_grid import COVERED, by_force, by_solver, encoded
from tests.support.strategies import formulas


def _real(op):
    """Whole numbers without a range may take the solver any time."""
    return encoded(op) and op.name not in ("floor", "ceil", "round", "mod", "wrap")


@settings(max_examples=150)
@given(COVERED)
def test_the_solver_finds_what_every_trace_over_three_values_and_six_samples_shows(formula):
    try:
        found, shown = by_solver(formula), by_force(formula)
    except (NotCoveredError, StlError):
        assume(False)
    assert found == shown


@settings(max_examples=60)
@given(formulas(4, unbounded_future=True, select=_real).filter(variables))
def test_the_engine_confirms_each_trace_that_the_solver_finds(formula):
    part = Part("", rtamt.parse("x").with_formula(formula))
    try:
        checker = BoundedChecker([part.spec], samples=5)
        answers = [checker.satisfiable(part), checker.valid(part)]
    except (NotCoveredError, StlError):
        assume(False)
    for answer in answers:
        assert answer.holds is not None
        assert answer.witness is None or answer.witness.confirmed


@pytest.mark.parametrize("op", [op for op in STL if isinstance(op.kernel, Pointwise)], ids=lambda op: op.name)
def test_an_operator_is_encoded_or_named_as_not_covered(op):
    spec = rtamt.parse(op.example)
    checker = BoundedChecker([spec], samples=3)
    assert (op.kernel.opcode in ENCODED) is not (op.kernel.opcode in NONLINEAR)
    if op.kernel.opcode in ENCODED and op.name not in ("mul", "div", "radians"):
        checker.require_covered(spec.formula, spec)
    elif op.kernel.opcode in NONLINEAR:
        with pytest.raises(NotCoveredError, match=f"'{op.spellings[0]}' is not linear"):
            checker.require_covered(spec.formula, spec)


def test_no_opcode_of_the_analysis_is_unknown_to_the_table():
    table = {op.kernel.opcode for op in (*STL, *UNWRITTEN.values()) if isinstance(op.kernel, Pointwise)}
    assert set(ENCODED) | NONLINEAR == table
