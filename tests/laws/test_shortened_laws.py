"""Explanations evaluate fewer samples where signals are constant for long, with the same values."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
from hypothesis import assume, event, given
from hypothesis import strategies as st

from rtamt.engine import Evaluators
from rtamt.engine.discrete.time_axis import DiscreteTimeAxis
from rtamt.rewrite.structure import Structure, settling
from rtamt.signals.discrete import DiscreteTrace
from rtamt.signals.instants import StepFunction
from rtamt.signals.shortened import Shortened
from tests.support.strategies import formulas

if TYPE_CHECKING:
    from rtamt.language.formula import Formula

ONE = Fraction(1)


@st.composite
def steps(draw: Any, end: int) -> StepFunction:
    """A function that changes seldom, sometimes often for a while."""
    places = st.one_of(st.integers(1, end - 1), st.integers(end // 2, end // 2 + 9))
    changes = sorted({0, *draw(st.lists(places, max_size=6))})
    values = draw(
        st.lists(
            st.sampled_from([-np.inf, -2.0, -1.0, 0.0, 1.0, 3.0, np.inf]),
            min_size=len(changes),
            max_size=len(changes),
        )
    )
    return StepFunction(np.array(changes, np.int64), np.array(values), end)


@given(formula=formulas(max_depth=4), data=st.data())
def test_the_values_over_fewer_samples_are_those_over_all(formula: Formula, data: Any) -> None:
    structure = Structure.of(formula, None)
    core, end = structure.core, 400
    assume(structure.leaves)
    signals = {name: data.draw(steps(end)) for name in structure.leaves}
    columns = {name: np.repeat(s.values, np.diff(s.changes, append=end)) for name, s in signals.items()}
    trace = DiscreteTrace(np.arange(float(end)), columns, ONE)
    changes = sum(len(s.changes) for s in signals.values())
    event("shortened" if changes * 2 * settling((core,), ONE) < end else "whole")
    (found,) = DiscreteTimeAxis(trace, "cpp").runner((core,))(signals)
    (wanted,) = Evaluators("cpp")((core,), trace)
    np.testing.assert_array_equal(np.repeat(found.values, np.diff(found.changes, append=end)), wanted.values)


@given(st.lists(steps(60), min_size=1, max_size=3), st.integers(1, 9))
def test_what_is_shortened_and_brought_back_is_the_same(functions: list[StepFunction], margin: int) -> None:
    short = Shortened.of(functions, margin)
    kept = short.cells(np.arange(short.end))
    assert (np.diff(kept) > 0).all()
    for each in functions:
        small = short.of_function(each)
        assert [small.at(k) for k in range(short.end)] == [each.at(int(k)) for k in kept]
        back = short.back(small)
        assert [back.at(k) for k in range(60)] == [each.at(k) for k in range(60)]
