"""Missing samples in lists and in containers of other libraries: the same as None for everything that takes data."""

import warnings

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest

import rtamt

MASKED = "'x' is masked at sample 1, expected a number"
NONE = "'x' is None at sample 1, expected a number"
NA = "'x' is <NA> at sample 1, expected a number"
MISSING = {
    "list": ([5, np.ma.masked, 2], MASKED),
    "tuple": ((5.0, np.ma.masked, 2.0), MASKED),
    "objects": (np.array([5, np.ma.masked, 2], object), MASKED),
    "array": (np.ma.array([5.0, 1.0, 2.0], mask=[0, 1, 0]), MASKED),
    "integers": (np.ma.array([5, 1, 2], mask=[0, 1, 0]), MASKED),
    "None": ([5, None, 2], NONE),
    "Arrow": (pa.array([5, None, 2]), NONE),
    "chunks": (pa.chunked_array([[5.0, None], [2.0]]), NONE),
    "polars": (pl.Series([5, None, 2]), NONE),
    "pandas": (pd.array([5, None, 2], dtype="Int64"), NA),
    "pandas.Series": (pd.Series([5, None, 2], dtype="Float64"), NA),
}
CASES = pytest.mark.parametrize(("values", "message"), MISSING.values(), ids=MISSING)


def data_of(time, values):
    return {"x": ([0, 1, 2], values)} if time == "dense" else {"time": [0, 1, 2], "x": values}


@pytest.fixture(autouse=True)
def no_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


@pytest.mark.parametrize("values", [values for values, _ in MISSING.values()], ids=MISSING)
@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_masked_values_in_lists_are_missing_and_not_nan(time, values):
    signal = rtamt.parse("x >= 3", time=time).evaluate(data_of(time, values)).signal
    assert (signal.lower.tolist(), signal.upper.tolist()) == ([2, -np.inf, -1], [2, np.inf, -1])


@CASES
@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_monitors_do_not_call_missing_values_nan(time, values, message):
    monitor = rtamt.parse("x >= 3", time=time).monitor()
    with pytest.raises(rtamt.TraceError) as caught:
        monitor.update_many(data_of(time, values))
    assert (str(caught.value), caught.value.variable, caught.value.index) == (message, "x", 1)
    assert monitor.samples == 0


@CASES
def test_fleets_do_not_call_missing_values_nan(values, message):
    fleet = rtamt.Fleet(rtamt.parse("x >= 3"), 5)
    with pytest.raises(rtamt.TraceError) as caught:
        fleet.update_many([7, 7, 7], [0, 1, 2], {"x": values})
    assert str(caught.value) == f"key 7 at index 1 of the batch: {message.replace(' at sample 1', '')}"


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_masked_value_of_an_update_causes_no_warning(time):
    monitor = rtamt.parse("x >= 3").monitor(time=time)
    with pytest.raises(rtamt.TraceError) as caught:
        monitor.update(0, x=np.ma.masked)
    assert str(caught.value) == "'x' is masked at sample 0, expected a number"


def test_texts_of_arrow_are_named_as_texts():
    with pytest.raises(rtamt.TraceError) as caught:
        rtamt.parse("x >= 3").evaluate({"x": pa.array(["high"])})
    assert str(caught.value) == "'x' is 'high' at sample 0, expected a number"


@pytest.mark.parametrize("unit", [None, "ms", "s"])
@pytest.mark.parametrize("kind", [int, float])
def test_a_masked_time_is_not_the_number_behind_the_mask(kind, unit):
    times = np.ma.array([0, 1, 2], kind, mask=[0, 1, 0])
    with pytest.raises(rtamt.TraceError) as caught:
        rtamt.parse("x >= 3").evaluate({"time": times, "x": [1, 2, 3]}, time_unit=unit, period=1)
    assert str(caught.value) == "time is nan at sample 1: give a finite number of seconds"


LEAST = np.iinfo(np.int64).min


@pytest.mark.parametrize("verdict", ["delayed", "eager", "interval", "causation"])
@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize("number", [np.int64(LEAST), LEAST])
def test_the_least_integer_as_a_time_causes_no_overflow_warning(number, time, verdict):
    monitor = rtamt.parse("x >= 3").monitor(time=time, verdict=verdict)
    with pytest.raises(rtamt.TraceError) as caught:
        monitor.update(number, x=1.0)
    assert str(caught.value).endswith(
        f"is {LEAST} at sample 0, too large for seconds: if it counts ns since 1970, say time_unit='ns', or on the "
        "command line --time-unit ns"
    )


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_the_least_integer_among_times_causes_no_overflow_warning(time):
    times = np.array([LEAST, 0, 1])
    data = {"x": (times, [1.0, 2, 3])} if time == "dense" else {"time": times, "x": [1.0, 2, 3]}
    with pytest.raises(rtamt.TraceError) as caught:
        rtamt.parse("x >= 3", time=time).evaluate(data)
    assert f"is {LEAST} at sample 0, too large for seconds" in str(caught.value)
