"""The earliest verdicts, calculated by hand."""

from __future__ import annotations

from rtamt.language.parsing.parser import parse_formula
from rtamt.reference import eager_verdicts
from tests.unit.reference.knowledge import ONE, known


def test_the_earliest_verdicts_of_a_response():
    knowledge = known(req=[0, 5, 0, 5, 0], gnt=[0, 0, 3, 0, 0], finished=True)
    found = eager_verdicts.verdicts(parse_formula("req >= 1 -> eventually[0:1](gnt >= 1)"), knowledge, ONE)
    # Without a request at once; the request at 1 by the grant at 2; that at 3 by the missing grant at 4.
    assert found == [[(0, True, 0)], [], [(1, True, 2), (2, True, 2)], [], [(3, False, 4), (4, True, 4)], []]


def test_a_verdict_may_come_before_its_instant_and_is_reported_at_it():
    found = eager_verdicts.verdicts(
        parse_formula("once[1:3] x > 0"), known(x=[1, 0, 0, 0, 0], finished=True), ONE
    )
    assert found[:3] == [[(0, False, 0)], [(1, True, 0)], [(2, True, 0)]]


def test_dense_verdicts_are_runs():
    updates = [(0, {"x": (1.0, 1.0)}), (4, {"x": (-1.0, -1.0)}), (6, {"x": (2.0, 2.0)})]
    found = eager_verdicts.dense_verdicts(parse_formula("x > 0"), updates, ("x",), ONE, {}, finished=True)
    assert [eager_verdicts.runs(each) for each in found] == [
        [(0, 1, True, 0)],
        [(1, 4, True, 4), (4, 5, False, 4)],
        [(5, 6, False, 6), (6, 7, True, 6)],
        [],
    ]
