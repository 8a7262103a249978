"""A check that stops early has the verdict and the first violation of the whole recording, in any chunks."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import rtamt
from rtamt.errors import EvaluationError
from rtamt.language.printing.printer import to_text
from rtamt.verdicts.early.check import DiscreteEarlyCheck, holds_at_end
from rtamt.verdicts.early.dense_check import DenseEarlyCheck
from tests.support.strategies import dense_chunkings, dense_traces, formulas, traces

FORMULAS = formulas(unbounded_future=True)


def _chunks(columns, n, cuts):
    edges = [0, *sorted({min(cut, n) for cut in cuts}), n]
    for begin, end in itertools.pairwise(edges):
        if end > begin:
            yield {
                "time": np.arange(begin, end) + 5.0,
                **{name: column[begin:end] for name, column in columns.items()},
            }


@pytest.mark.parametrize("backend", ["cpp", "python"])
@given(
    st.lists(FORMULAS, min_size=1, max_size=3), traces(max_size=15), st.lists(st.integers(1, 14), max_size=3)
)
def test_a_check_that_stops_early_equals_that_of_the_whole_recording(backend, some, columns, cuts):
    every = [rtamt.parse(to_text(formula), period=1, backend=backend) for formula in some]
    specs = [spec for spec in every if spec.input_names and holds_at_end(spec)]
    assume(specs)
    n = len(next(iter(columns.values())))
    check = DiscreteEarlyCheck(specs)
    try:
        expected = [spec.evaluate({"time": np.arange(n) + 5.0, **columns}) for spec in specs]
        stopped = any(check.take(chunk) for chunk in _chunks(columns, n, cuts))
    except EvaluationError:
        return
    if not stopped:
        assert check.decided is None
        return
    for spec, found, whole in zip(specs, check.decided, expected, strict=True):
        assert found.satisfied == whole.satisfied
        assert found.first_violation == rtamt.first_violation(whole)
        assert found.bounds.lower <= whole.robustness <= found.bounds.upper
        assert found.decided_at == 5.0 + found.samples - 1
        eager = spec.monitor(verdict="eager")
        verdicts = [
            verdict
            for i in range(found.samples)
            for verdict in eager.update(i, **{name: columns[name][i] for name in spec.input_names})
        ]
        earliest = next(verdict.decided_at for verdict in verdicts if verdict.time == 0)
        assert earliest <= found.samples - 1
        if found.satisfied:
            assert earliest == found.samples - 1


@pytest.mark.parametrize("backend", ["cpp", "python"])
@given(st.data())
def test_a_check_in_dense_time_that_stops_early_equals_that_of_the_whole_recording(backend, data):
    some = data.draw(st.lists(formulas(discrete=False, unbounded_future=True), min_size=1, max_size=3))
    every = [rtamt.parse(to_text(f), time="dense", resolution=1, backend=backend) for f in some]
    specs = [spec for spec in every if spec.input_names]
    assume(specs)
    trace = {
        name: (times.astype(float), values)
        for name, (times, values) in data.draw(dense_traces(max_size=8)).items()
    }
    chunks = data.draw(dense_chunkings(trace))
    check = DenseEarlyCheck(specs)
    try:
        expected = [spec.evaluate({name: trace[name] for name in spec.input_names}) for spec in specs]
        stopped = any(map(check.take, chunks))
    except (EvaluationError, rtamt.TraceError):
        assume(False)
    if not stopped:
        assert check.decided is None
        return
    for found, whole in zip(check.decided, expected, strict=True):
        assert found.satisfied == whole.satisfied
        assert found.first_violation == rtamt.first_violation(whole)
        assert found.bounds.lower <= whole.robustness <= found.bounds.upper
        assert found.period is None


def test_nothing_in_dense_time_is_read_behind_the_sample_that_decides_the_last_requirement():
    def chunks():
        yield {"x": ([0, 1.5], [5, 1])}
        yield {"y": ([0.5, 2, 3], [0, 0, 0])}
        yield {"x": ([4], [5]), "y": ([4.25], [4])}
        raise AssertionError

    first, second = (rtamt.parse(text, time="dense") for text in ("always(x >= 3)", "eventually(y >= 3)"))
    check = DenseEarlyCheck([first, second])
    assert any(map(check.take, chunks()))
    assert [(d.satisfied, d.first_violation, d.decided_at, d.samples) for d in check.decided] == [
        (False, 1.5, 1.5, 2),
        (True, None, 4.25, 4),
    ]


def test_nothing_is_read_behind_the_sample_that_decides_the_last_requirement():
    def chunks():
        yield {"x": [5, 4, 1], "y": [0, 0, 0]}
        yield {"x": [5, 5], "y": [0, 4]}
        raise AssertionError

    first, second = rtamt.parse("always(x >= 3)"), rtamt.parse("eventually(y >= 3)")
    check = DiscreteEarlyCheck([first, second])
    assert any(map(check.take, chunks()))
    assert [(d.satisfied, d.first_violation, d.samples) for d in check.decided] == [
        (False, 2.0, 3),
        (True, None, 5),
    ]
