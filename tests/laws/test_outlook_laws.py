"""A verdict that is told before the end of a simulation is the verdict at its end, whatever was still to come."""

from __future__ import annotations

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st

import rtamt
from rtamt.errors import EvaluationError
from rtamt.language.printer import to_text
from rtamt.verdicts.robust_interval import RobustInterval
from tests.strategies import formulas, traces

# Without arithmetic every recording has a value for every formula.
FORMULAS = formulas(unbounded_future=True, arithmetic=False, infinite=False)


def outlook_of(spec, samples=None):
    """Return the outlook of a specification whose period or tick is 1 s."""
    return RobustInterval(
        spec.formula,
        semantics=spec.semantics,
        roles=spec.roles,
        backend=spec.backend,
        domain=spec.domain.online,
        samples=samples,
    )


@given(FORMULAS, traces(max_size=12), st.data())
def test_a_settled_verdict_is_that_of_every_continuation(formula, columns, data):
    spec = rtamt.parse(to_text(formula), period=1)
    names = spec.input_names
    assume(names)
    n = len(columns[names[0]])
    known = data.draw(st.integers(1, n))
    outlook = outlook_of(spec, n)
    assume(outlook.able)
    times = np.arange(n, dtype=float)
    settled = outlook.after(times[:known], {name: columns[name][:known] for name in names})
    if settled is None:
        assert known < n or spec.evaluate({name: columns[name] for name in names}).robustness == 0
        return
    result = spec.evaluate({"time": times, **{name: columns[name] for name in names}})
    assert result.satisfied == settled.satisfied
    assert settled.low <= result.robustness <= settled.high
    assert settled.low >= 0 if settled.satisfied else settled.high <= 0
    assert 1 <= settled.samples <= known
    if settled.samples > 1:  # the fewest that do
        fewer = settled.samples - 1
        assert outlook.after(times[:fewer], {name: columns[name][:fewer] for name in names}) is None


@given(formulas(unbounded_future=True, arithmetic=False, infinite=False, discrete=False), st.data())
def test_in_dense_time_too(formula, data):
    spec = rtamt.parse(to_text(formula), time="dense", resolution=1)
    names = spec.input_names
    assume(names)
    n = data.draw(st.integers(1, 6))
    times = np.cumsum(data.draw(st.lists(st.integers(1, 4), min_size=n, max_size=n))).astype(float)
    values = st.integers(-3, 3).map(float)
    columns = {name: np.array(data.draw(st.lists(values, min_size=n, max_size=n))) for name in names}
    known = data.draw(st.integers(1, n))
    outlook = outlook_of(spec)
    assume(outlook.able)
    settled = outlook.after(times[:known], {name: columns[name][:known] for name in names})
    try:
        result = spec.evaluate({name: (times, columns[name]) for name in names})
    except EvaluationError:
        return
    if settled is not None:
        assert result.satisfied == settled.satisfied
