"""Operations without a value in formulas with quantifiers: messages name what is written."""

from __future__ import annotations

import pickle

import pytest

import rtamt
from rtamt.errors import EvaluationError, SpecificationError

inf = float("inf")
GROUP = 'input float e; group cars = "car_*" { float p } '
ENDLESS = [-inf] * 5 + [inf] * 4

CULPRITS = [
    (
        "forall v in cars: once[0:2](diff[2s](maximum[1:3](e)) < v.p)",
        "diff[2s](maximum[1:3](e))",
        "diff[2s](maximum[1:3](e))",
    ),
    (
        "forall v in cars: once(exists w in cars where v != w: sqrt(v.p - 5 * w.p) > 0)",
        "sqrt(car_1.p - 5 * car_2.p)",
        "sqrt(v.p - 5 * w.p)",
    ),
    (
        "forall v in cars: once(sqrt((count w in cars: w.p > 0) - 5) > v.p)",
        "sqrt((count w in cars: w.p > 0) - 5)",
        "sqrt((count w in cars: w.p > 0) - 5)",
    ),
    (
        "(count v in cars: v.p > 3) * e > 0",
        "(count v in cars: v.p > 3) * e",
        "(count v in cars: v.p > 3) * e",
    ),
]


@pytest.mark.parametrize("gaps", [False, True])
@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize(("text", "offline", "online"), CULPRITS)
def test_an_operation_without_a_value_is_named_as_written_without_internal_names(
    text, offline, online, time, gaps
):
    spec = rtamt.parse(GROUP + text, time=time)
    columns = {"e": ENDLESS, "car_1.p": [1.0] * 8 + [None if gaps else 1.0], "car_2.p": [1.0] * 9}
    if time == "dense":
        columns = {name: list(enumerate(values)) for name, values in columns.items()}
    with pytest.raises(EvaluationError) as error:
        spec.evaluate(columns)
    assert f"'{offline}' has no value at" in str(error.value)
    for monitor in (spec.monitor(), pickle.loads(pickle.dumps(spec.monitor()))):
        with pytest.raises(EvaluationError) as error:
            whole_stream(monitor, columns)
        assert f"'{online}' has no value at" in str(error.value)


def whole_stream(monitor, columns):
    monitor.update_many(columns)
    monitor.finish()


def test_an_operator_without_a_duration_is_named_as_written_in_a_dense_stream():
    with pytest.raises(SpecificationError, match="'diff' without a duration"):
        rtamt.parse(GROUP + "forall v in cars: diff(v.p) > 0", time="dense").monitor()
