"""Many traces in one array for each variable: what is wrong in one of them, and what such arrays cannot hold."""

import datetime as dt

import numpy as np
import pytest

import rtamt
from rtamt.engine.discrete.evaluate import Evaluator
from rtamt.errors import EvaluationError, StlError, TraceError, UsageError

SPEC = rtamt.parse("always(x >= 3)")
NAN = float("nan")


def message(*arguments, spec=SPEC, error=StlError, **settings):
    with pytest.raises(error) as caught:
        spec.evaluate_batch(*arguments, **settings)
    return str(caught.value)


def test_plain_arrays_are_evaluated_together(monkeypatch):
    ran = []
    rows = Evaluator.rows
    monkeypatch.setattr(Evaluator, "rows", lambda *given: ran.append(1) or rows(*given))
    monkeypatch.setattr(Evaluator, "__call__", None)
    batch = SPEC.evaluate_batch({"x": np.arange(60).reshape(20, 3), "time": [0.0, 0.1, 0.2]})
    assert batch.robustness.tolist() == [3.0 * i - 3 for i in range(20)]
    assert batch.satisfied.tolist() == [False] + 19 * [True]
    assert len(ran) == 2  # for the robustness and for the verdicts


def test_a_result_is_that_of_the_trace_alone():
    batch = SPEC.evaluate_batch({"x": [[5, 4, 2], [7, 8, NAN]], "time": [0, 2, 4]}, lengths=[3, 2])
    assert batch.lengths.tolist() == [3, 2]
    first, second = batch
    assert (first.robustness, second.robustness) == (-1.0, 4.0)
    assert first.signal.times.tolist() == [0.0, 2.0, 4.0]
    assert second.trace.columns["x"].tolist() == [7.0, 8.0]
    assert str(first.explain()) == str(SPEC.evaluate({"x": [5, 4, 2], "time": [0, 2, 4]}).explain())
    assert [result.robustness for result in batch[:1]] == [-1.0]
    assert batch[-1].robustness == 4.0
    assert repr(batch) == "<results of 2 traces: 1 satisfied>"
    with pytest.raises(IndexError):
        batch[2]


def test_results_stay_as_they_are_when_the_arrays_change():
    x = np.full((9, 4), 5.0)
    batch = SPEC.evaluate_batch({"x": x})
    x[:] = 0
    assert batch.satisfied.all()
    assert batch[8].trace.columns["x"].tolist() == [5.0] * 4


def test_no_traces_have_no_results():
    batch = SPEC.evaluate_batch({"x": np.empty((0, 5))})
    assert (len(batch), batch.robustness.shape, batch.satisfied.shape, batch.signals.shape) == (
        0,
        (0,),
        (0,),
        (0, 5),
    )


@pytest.mark.parametrize("row", [0, 1, 7, 8, 16])
def test_the_error_of_one_trace_has_its_index(row):
    x = np.full((17, 4), 5.0)
    x[row, 2] = NAN
    nan = f"trace {row}: 'x' is NaN at sample 2, time 2 s: fill the gap or leave the sample out"
    assert message({"x": x}, error=TraceError) == nan
    x[row, 2] = -1.0
    spec = rtamt.parse("always(sqrt(x) >= 3)")
    found = message({"x": x}, spec=spec, error=EvaluationError)
    assert found.startswith(f"trace {row}: ")
    with pytest.raises(EvaluationError) as alone:
        spec.evaluate({"x": x[row]})
    assert found == f"trace {row}: {alone.value}"


def test_the_first_wrong_trace_is_reported_whatever_is_wrong_with_the_others():
    x = np.full((20, 4), 4.0)
    x[3, 1], x[12, 0] = -1, NAN
    assert message({"x": x}, spec=rtamt.parse("sqrt(x) >= 3")).startswith("trace 3: 'sqrt(x)'")
    assert message({"x": x}, lengths=[4] * 3 + [1] * 9 + [0] + [4] * 7) == (
        "trace 12: the trace is empty: give at least one sample"
    )


def test_timestamps_are_checked_for_each_trace():
    x = np.full((3, 3), 5.0)
    time = np.array([[0, 1, 2], [0, 2, 1], [0, 1, 2]])
    assert message({"x": x, "time": time}).startswith(
        "trace 1: time does not increase at sample 2: 1 s comes after 2 s"
    )
    assert message({"x": x, "time": [0, 1, 1]}).startswith("trace 0: time does not increase at sample 2")
    spec = rtamt.parse("eventually[0:1](x >= 3)")
    assert message({"x": x, "time": [[0, 1, 2], [0, 3, 6], [0, 1, 2]]}, spec=spec).startswith("trace 1: ")


def test_dates_and_units_of_time_are_taken():
    x = [[5, 2], [7, 8]]
    start = dt.datetime(2026, 5, 1)
    stamps = np.array([start, start + dt.timedelta(seconds=1)], "M8[ms]")
    batch = SPEC.evaluate_batch({"x": x, "time": stamps})
    assert batch[1].signal.times.tolist() == SPEC.evaluate({"x": x[1], "time": stamps}).signal.times.tolist()
    spec = rtamt.parse("eventually[0:10ms](x >= 3)")
    assert spec.evaluate_batch({"x": x, "time": [0, 10]}, time_unit="ms").robustness.tolist() == [2.0, 5.0]


def test_booleans_members_and_recorded_names_are_read_as_alone():
    spec = rtamt.parse(
        'enum Mode { MANUAL, AUTO } input Mode mode input bool p = "armed" always(p -> mode == AUTO)'
    )
    data = {"mode": [["AUTO", "MANUAL"], ["AUTO", "AUTO"]], "armed": [[True, True], [True, False]]}
    assert spec.evaluate_batch(data).satisfied.tolist() == [False, True]
    assert message({**data, "mode": [["AUTO", "AUTO"], ["AUTO", "OFF"]]}, spec=spec).startswith(
        "trace 1: 'mode' is 'OFF'"
    )


@pytest.mark.parametrize(
    ("data", "settings", "expected"),
    [
        ([1, 2], {}, "expected a mapping from variable to an array of shape (traces, samples), got list"),
        ({"y": [[1]]}, {}, "the data has no 'x'; signals: y"),
        ({"x": [1, 2]}, {}, "'x' has 1 dimensions, expected 2: give an array of shape (traces, samples)"),
        ({"x": [[1, 2], [3]]}, {}, "'x' has rows of different lengths: fill them up, and give lengths="),
        (
            {"x": np.ma.masked_equal([[1, 2]], 2)},
            {},
            "'x' has masked values, and samples of a batch cannot be missing: evaluate the traces one by one",
        ),
        (
            {"x": [[1, 2]], "time": [0, 1, 2]},
            {},
            "'time' has the shape (3,) and 'x' (1, 2): give one timestamp for every sample",
        ),
        (
            {"x": [[1, 2]]},
            {"lengths": [1, 2]},
            "lengths is [1, 2]; give a whole number of samples for each of the 1 traces",
        ),
        (
            {"x": [[1, 2]]},
            {"lengths": [1.5]},
            "lengths is [1.5]; give a whole number of samples for each of the 1 traces",
        ),
        ({"x": [[1, 2]]}, {"lengths": [3]}, "lengths[0] is 3; the rows have 2 samples"),
        (
            {"x": [[1, 2]]},
            {"time": "dense"},
            "arrays of traces cannot be evaluated with dense time: use rtamt.evaluate_batch(spec, traces)",
        ),
        (
            {"x": [[1, 2], [3, None]]},
            {},
            "trace 1: samples are missing, which arrays of traces cannot express",
        ),
        ({"x": [["a", "b"]]}, {}, "trace 0: 'x' is 'a' at sample 0, expected a number"),
    ],
)
def test_what_is_no_batch_is_rejected_in_one_sentence(data, settings, expected):
    assert message(data, **settings).startswith(expected)


def test_shapes_of_variables_must_agree():
    spec = rtamt.parse("x >= y")
    assert message({"x": [[1, 2]], "y": [[1, 2], [3, 4]]}, spec=spec, error=TraceError) == (
        "'x' has the shape (1, 2) and 'y' (2, 2): give one value of each at every sample"
    )
    assert message({}, spec=rtamt.parse("true"), error=UsageError) == (
        "the formula reads no variable, so that there is nothing to evaluate in a batch"
    )


def test_groups_and_sampled_signals_are_evaluated_one_by_one():
    spec = rtamt.parse('group cars = "car_*" forall v in cars: v.x >= 3')
    assert message({"car_1.x": [[1]]}, spec=spec, error=UsageError) == (
        "arrays of traces cannot be evaluated with groups: use rtamt.evaluate_batch(spec, traces)"
    )
