"""Bounds, early verdicts and causation against values that were worked out by hand."""

from __future__ import annotations

from fractions import Fraction
from math import inf

import numpy as np
import pytest

from rtamt.errors import EvaluationError, SpecificationError
from rtamt.language.enclosures import Enclosure
from rtamt.language.operators import STL
from rtamt.language.parser import parse_formula
from rtamt.reference import dense_bounds, discrete_bounds, earliest
from rtamt.reference.causation import causation
from rtamt.reference.dense_bounds import DenseKnowledge
from rtamt.reference.discrete_bounds import Knowledge

ONE = Fraction(1)


def known(n: int | None = None, *, finished: bool = False, ranges=None, **columns) -> Knowledge:
    enclosures = {}
    for name, values in columns.items():
        pairs = [v if isinstance(v, tuple) else (v, v) for v in values][:n]
        enclosures[name] = Enclosure(*(np.array([pair[k] for pair in pairs], float) for k in (0, 1)))
    return Knowledge(enclosures, len(next(iter(enclosures.values())).lower), ranges or {}, finished)


def bounds(text: str, knowledge: Knowledge) -> list[tuple[float, float]]:
    found = discrete_bounds.bounds(parse_formula(text), knowledge, ONE)
    return list(zip(found.lower.tolist(), found.upper.tolist(), strict=True))


RESPONSE = "always[0:2](req >= 1 -> eventually[0:1](gnt >= 1))"


def test_a_response_is_open_until_the_request_is_granted_or_the_time_is_over():
    req, gnt = [0, 5, 0, 0, 0], [0, 0, 3, 0, 0]
    # After 0: nothing is requested by 1, and a grant at 1 may be as large as it likes. After 1: there is none at 1, so
    # that 0 is satisfied by 1 exactly; the request at 1 may be granted at 2, by 2, and nobody knows 2 itself.
    at_0 = [bounds(RESPONSE, known(n, req=req, gnt=gnt))[0] for n in range(1, 6)]
    # After 2: granted by 2, for 1 and for 2.
    assert at_0 == [(-inf, inf), (-inf, 1.0), (1.0, 1.0), (1.0, 1.0), (1.0, 1.0)]
    ungranted = [0, 0, 0, 0, 0]
    at_0 = [bounds(RESPONSE, known(n, req=req, gnt=ungranted))[0] for n in range(1, 6)]
    # Nothing granted at 1 and 2: max(-4, max(-1, -1)) = -1, which a later sample could only make worse.
    assert at_0 == [(-inf, inf), (-inf, 1.0), (-1.0, -1.0), (-1.0, -1.0), (-1.0, -1.0)]


def test_the_untimed_response_can_be_violated_and_never_be_satisfied_while_the_trace_goes_on():
    text = "always(req >= 1 -> eventually[0:1](gnt >= 1))"
    assert bounds(text, known(req=[0, 5, 0], gnt=[0, 0, 3]))[0] == (-inf, 1.0)
    assert bounds(text, known(req=[0, 5, 0], gnt=[0, 0, 0]))[0] == (-inf, -1.0)
    assert bounds(text, known(req=[0, 5, 0], gnt=[0, 0, 0], ranges={"req": (0, 9), "gnt": (0, 3)}))[0] == (
        -1,
        -1,
    )


def test_always_eventually_stays_open_without_ranges():
    assert bounds("always eventually (x >= 3)", known(x=[5, 1, 7]))[0] == (-inf, inf)
    assert bounds("always eventually (x >= 3)", known(x=[5, 1, 7], ranges={"x": (0, 4)}))[0] == (-3, 1)


def test_the_past_of_instants_that_are_not_seen_yet():
    # At 1 and 2, not seen yet, the window of once reaches back to sample 0.
    assert bounds("eventually[1:2] once[0:5] x", known(x=[4]))[0] == (4, inf)
    assert bounds("always[1:2] historically[0:5] x", known(x=[4]))[0] == (-inf, 4)
    # At the end there is no instant at all in [1, 2].
    assert bounds("eventually[1:2] once[0:5] x", known(x=[4], finished=True)) == [(-inf, -inf)]


def test_bounds_need_not_be_tight():
    assert bounds("x > 0 or x < 5", known(x=[(-9, 9)])) == [(-4, 14), (-inf, inf)]
    assert bounds("x - x == 0", known(x=[(0, 1)]))[0] == (-1, 0)


def test_uncertain_samples_shrink_margins():
    assert bounds("always[0:1](x >= 3)", known(x=[(4.5, 5.5), (3.5, 4.5)]))[0] == (0.5, 1.5)
    assert bounds("x >= 3 since[0:1] y >= 3", known(x=[(4, 5), (2, 6)], y=[(3, 4), (0, 1)]))[1] == (-1, 1)


def test_an_operation_without_a_value_is_an_error_where_it_is_final():
    with pytest.raises(EvaluationError, match=r"^'sqrt\(x\)' has no value at sample 1, time 1 s"):
        bounds("sqrt(x) >= 0", known(x=[(-1, 4), (-4, -1)]))
    # A range outside the domain is no error as long as no sample has come.
    assert bounds("sqrt(x) >= 0", known(x=[4], ranges={"x": (-4, -1)})) == [(2, 2), (-inf, inf)]


def test_an_operator_that_only_has_a_definition_has_no_bounds():
    from dataclasses import replace

    own = replace(STL["once"], name="own", spellings=("own",), kernel=None)
    with pytest.raises(SpecificationError, match="'own' has no interval extension"):
        discrete_bounds.bounds(own(parse_formula("x")), known(x=[1]), ONE)


def test_the_earliest_verdicts_of_a_response():
    knowledge = known(req=[0, 5, 0, 5, 0], gnt=[0, 0, 3, 0, 0], finished=True)
    found = earliest.verdicts(parse_formula("req >= 1 -> eventually[0:1](gnt >= 1)"), knowledge, ONE)
    # Without a request at once; the request at 1 by the grant at 2; that at 3 by the missing grant at 4.
    assert found == [[(0, True, 0)], [], [(1, True, 2), (2, True, 2)], [], [(3, False, 4), (4, True, 4)], []]


def test_a_verdict_may_come_before_its_instant_and_is_reported_at_it():
    found = earliest.verdicts(parse_formula("once[1:3] x > 0"), known(x=[1, 0, 0, 0, 0], finished=True), ONE)
    assert found[:3] == [[(0, False, 0)], [(1, True, 0)], [(2, True, 0)]]


def test_dense_bounds_of_a_response():
    formula = parse_formula("req >= 1 -> eventually[0:2](gnt >= 1)")
    samples = {"req": ([0, 3], [0, 5], [0, 5]), "gnt": ([0, 4], [0, 0], [0, 0])}
    found = dense_bounds.bounds(formula, DenseKnowledge(samples), ONE)
    # req is known up to tick 3 and gnt, which is 0, up to tick 4: ticks 0 to 2 see all of it. At tick 4 the
    # window has begun, so that the best is -1 at least.
    assert [found.at(t) for t in range(6)] == [(1, 1), (1, 1), (1, 1), (-1, inf), (-1, inf), (-inf, inf)]
    finished = dense_bounds.bounds(formula, DenseKnowledge(samples, finished=True), ONE)
    assert [finished.at(t) for t in (0, 3, 9)] == [(1, 1), (-1, -1), (-1, -1)]


def test_dense_verdicts_are_runs():
    updates = [(0, {"x": (1.0, 1.0)}), (4, {"x": (-1.0, -1.0)}), (6, {"x": (2.0, 2.0)})]
    found = earliest.dense_verdicts(parse_formula("x > 0"), updates, ("x",), ONE, {}, finished=True)
    assert [earliest.runs(each) for each in found] == [
        [(0, 1, True, 0)],
        [(1, 4, True, 4), (4, 5, False, 4)],
        [(5, 6, False, 6), (6, 7, True, 6)],
        [],
    ]


def test_causation_of_a_response_by_hand():
    formula = parse_formula("always[0:1](x >= 3)")
    x = [4, 1, 2]
    # At 0 after sample 1: it alone violates by 2. Sample 2 is outside the window of 0.
    assert causation(formula, known(2, x=x), ONE, 1) == [(-2, -2)]
    assert causation(formula, known(3, x=x), ONE, 1) == [(inf, -inf)]


def test_arithmetic_on_formulas_in_time_has_no_causation():
    with pytest.raises(SpecificationError, match=r"^'\(once x\) \+ 1' is arithmetic on a formula in time"):
        causation(parse_formula("(once x) + 1 >= 0"), known(x=[1]), ONE, 1)
