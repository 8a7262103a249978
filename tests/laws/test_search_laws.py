"""A simulation that is stopped has the verdict of the whole one, and stops at the first sample that decides it."""

from __future__ import annotations

from math import isfinite

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.errors import EvaluationError
from rtamt.language.printing.printer import to_text
from rtamt.search import Problem, Range
from rtamt.verdicts.early.check import holds_at_end
from tests.support.strategies import formulas, traces


def _problem(spec, times, columns, duration):
    def plant(p):
        for i, time in enumerate(times):
            yield float(time), {name: float(column[i]) + 0 * p for name, column in columns.items()}

    return Problem(spec, plant, {"p": Range(0, 1)}, duration)


def _check(spec, times, columns, duration):
    problem = _problem(spec, times, columns, duration)
    try:
        whole, early = problem.run({"p": 0.5}, whole=True), problem.run({"p": 0.5})
    except rtamt.UsageError as error:
        assume(isinstance(error.__cause__, EvaluationError))
        raise
    except EvaluationError:
        return
    assert early.satisfied == whole.satisfied
    verdicts = [
        verdict
        for monitor in [spec.monitor(verdict="eager")]
        for i, time in enumerate(times[: len(times) - (duration is not None)])
        for verdict in monitor.update(float(time), **{name: columns[name][i] for name in spec.input_names})
    ]
    decided = [v.decided_at for v in verdicts if (v.begin if spec.domain.continuous else v.time) == times[0]]
    if early.stopped is None:
        assert early.robustness == whole.robustness
        assert not (decided and (spec.domain.continuous or holds_at_end(spec)))
        return
    assert decided == [early.stopped]
    if not early.satisfied or isfinite(early.robustness):
        # The upper bound; where that is infinite, the lower one.
        assert early.robustness >= whole.robustness or early.satisfied
        assert (early.robustness >= 0) if early.satisfied else (early.robustness <= 0)


@settings(max_examples=60)
@given(formulas(unbounded_future=True, arithmetic=False, infinite=False), traces(max_size=12))
def test_a_stopped_simulation_has_the_verdict_of_the_whole_one(formula, columns):
    spec = rtamt.parse(to_text(formula), period=1)
    assume(spec.input_names)
    n = len(columns[spec.input_names[0]])
    assume(n > 1)
    _check(spec, np.arange(n, dtype=float), columns, n - 1)


@settings(max_examples=30)
@given(formulas(unbounded_future=True, arithmetic=False, infinite=False, discrete=False), st.data())
def test_in_dense_time_too(formula, data):
    spec = rtamt.parse(to_text(formula), time="dense", resolution=1)
    assume(spec.input_names)
    n = data.draw(st.integers(1, 6))
    times = np.cumsum(data.draw(st.lists(st.integers(1, 4), min_size=n, max_size=n))).astype(float)
    values = st.integers(-3, 3).map(float)
    columns = {
        name: np.array(data.draw(st.lists(values, min_size=n, max_size=n))) for name in spec.input_names
    }
    _check(spec, times, columns, None)
