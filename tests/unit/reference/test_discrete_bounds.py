"""Bounds in discrete time, calculated by hand."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

import pytest

from rtamt.errors import EvaluationError, SpecificationError
from rtamt.language.operators import STL
from rtamt.language.parsing.parser import parse_formula
from rtamt.reference import discrete_bounds
from tests.unit.reference.knowledge import ONE, known

if TYPE_CHECKING:
    from rtamt.reference.discrete_bounds import Knowledge


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
