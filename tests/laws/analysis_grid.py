"""The analysis against brute force: every trace over three values, of one to six samples, evaluated by the engine."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from hypothesis import strategies as st

import rtamt
from rtamt.analysis.arithmetic import ENCODED
from rtamt.analysis.encoder import Encoder
from rtamt.analysis.solver import Solver
from rtamt.language.contents import variables
from rtamt.language.formula import Var
from rtamt.language.operators import Pointwise
from tests.support.strategies import formulas

if TYPE_CHECKING:
    from rtamt.language.formula import Formula
    from rtamt.language.operators import Operator


#: Their factor is no fraction: whether ``degrees(radians(x)) == x`` depends on rounding, which the analysis leaves out.
ROUNDED = ("degrees", "radians")


def encoded(op: Operator) -> bool:
    """Return whether the analysis covers an operator over signals, with the values of the engine."""
    if op.name in ROUNDED:
        return False
    return not isinstance(op.kernel, Pointwise) or op.kernel.opcode in ENCODED


#: Formulas over one or two variables that the analysis covers, most of them.
COVERED = st.one_of(
    formulas(4, ("x",), unbounded_future=True, select=encoded),
    formulas(3, ("x", "y"), unbounded_future=True, select=encoded),
).filter(variables)

#: The values of every sample.
GRID = (-1.0, 0.5, 2.0)
#: The samples of traces over so many variables: no more than 1092 traces.
SAMPLES = {0: 6, 1: 6, 2: 3}


@dataclass(frozen=True)
class Traces:
    """All traces over some variables: an array for each variable, a trace in each row, and their lengths."""

    columns: dict[str, np.ndarray]
    lengths: np.ndarray


@cache
def all_traces(names: tuple[str, ...]) -> Traces:
    samples = SAMPLES[len(names)]
    rows, lengths = [], []
    for n in range(1, samples + 1):
        for values in itertools.product(GRID, repeat=n * len(names)):
            rows.append([*np.reshape(values, (len(names), n)).tolist()])
            lengths.append(n)
    columns = {
        name: np.array([[*row[k], *[0.0] * (samples - len(row[k]))] for row in rows])
        for k, name in enumerate(names)
    }
    return Traces(columns, np.array(lengths))


def by_force(formula: Formula) -> list[tuple[bool, bool]]:
    """Return for each length whether some trace satisfies a formula, and whether some trace violates it."""
    names = variables(formula) or ("x",)
    traces = all_traces(names)
    spec = rtamt.parse("x").with_formula(formula)
    satisfied = spec.evaluate_batch(traces.columns, lengths=traces.lengths).satisfied
    return [
        (bool(satisfied[traces.lengths == n].any()), bool((~satisfied[traces.lengths == n]).any()))
        for n in range(1, SAMPLES[len(names)] + 1)
    ]


def by_solver(formula: Formula) -> list[tuple[bool | None, bool | None]]:
    """Return the same, by the solver; the engine evaluates each trace that it finds."""
    names = variables(formula) or ("x",)
    samples = SAMPLES[len(names)]
    solver = Solver()
    encoder = Encoder(solver, samples, Fraction(1))
    spec = rtamt.parse("x").with_formula(formula)
    for name in names:
        for value in encoder.column(Var(name)):
            solver.require(solver.some(solver.equal(value.real, Fraction(number)) for number in GRID))
    holds = encoder.holds(formula)[0]
    solver.require(encoder.defined(formula))

    def asked(n: int, wanted: bool) -> bool | None:
        found = solver.ask([holds if wanted else solver.no(holds), *encoder.length(n, n)])
        if found:
            trace = {
                name: [float(solver.value(value.real)) for value in encoder.columns[name][:n]]
                for name in names
            }
            assert spec.evaluate(trace).satisfied is wanted, (str(formula), trace)
        return found

    return [(asked(n, True), asked(n, False)) for n in range(1, samples + 1)]
