"""Bounds in dense time, calculated by hand."""

from __future__ import annotations

from math import inf

from rtamt.language.parsing.parser import parse_formula
from rtamt.reference import dense_bounds
from rtamt.reference.dense_bounds import DenseKnowledge
from tests.unit.reference.knowledge import ONE


def test_dense_bounds_of_a_response():
    formula = parse_formula("req >= 1 -> eventually[0:2](gnt >= 1)")
    samples = {"req": ([0, 3], [0, 5], [0, 5]), "gnt": ([0, 4], [0, 0], [0, 0])}
    found = dense_bounds.bounds(formula, DenseKnowledge(samples), ONE)
    # req is known up to tick 3 and gnt, which is 0, up to tick 4: ticks 0 to 2 see all of it. At tick 4 the
    # window has begun, so that the best is -1 at least.
    assert [found.at(t) for t in range(6)] == [(1, 1), (1, 1), (1, 1), (-1, inf), (-1, inf), (-inf, inf)]
    finished = dense_bounds.bounds(formula, DenseKnowledge(samples, finished=True), ONE)
    assert [finished.at(t) for t in (0, 3, 9)] == [(1, 1), (-1, -1), (-1, -1)]
