"""Offline evaluation of missing samples, the same for every kind of data and every file."""

from __future__ import annotations

import itertools
import math
import random
import re

import numpy as np
import pytest

import rtamt
from rtamt import Interval
from rtamt.errors import EvaluationError, TraceError, UsageError

pandas = pytest.importorskip("pandas")
polars = pytest.importorskip("polars")
arrow = pytest.importorskip("pyarrow")
xarray = pytest.importorskip("xarray")

TIMES = [0.0, 1.0, 2.0, 3.0]
X = [5.0, None, 4.0, 6.0]
Y = [None, 2.0, 2.0, 2.0]
NAN = [math.nan if x is None else x for x in X], [math.nan if y is None else y for y in Y]
DICT = {"time": TIMES, "x": X, "y": Y}
MASKED = {"time": TIMES} | {n: np.ma.masked_invalid(v) for n, v in zip("xy", NAN, strict=True)}
PANDAS = pandas.DataFrame({"time": TIMES, "x": pandas.array(X, "Float64"), "y": pandas.array(Y, "Float64")})
POLARS = polars.DataFrame(DICT)
ARROW = arrow.table(DICT)
DATASET = xarray.Dataset({n: ("time", v) for n, v in zip("xy", NAN, strict=True)}, coords={"time": TIMES})


def csv(folder):
    path = folder / "log.csv"
    path.write_text("time,x,y\n0,5,\n1,,2\n2,4,2\n3,6,2\n")
    return rtamt.read(path)


def parquet(folder):
    path = folder / "log.parquet"
    POLARS.write_parquet(path)
    return rtamt.read(path)


def excel(folder):
    path = folder / "log.xlsx"
    pandas.DataFrame({"time": TIMES, "x": X, "y": Y}).to_excel(path, index=False)
    return rtamt.read(path)


SOURCES = {
    "dict": lambda _: DICT,
    "masked": lambda _: MASKED,
    "pandas": lambda _: PANDAS,
    "polars": lambda _: POLARS,
    "Arrow columns": lambda _: {name: ARROW[name] for name in ARROW.column_names},
    "trace of a dict": lambda _: rtamt.read(DICT),
    "trace of masked arrays": lambda _: rtamt.read(MASKED),
    "trace of pandas": lambda _: rtamt.read(PANDAS),
    "trace of NaN in pandas": lambda _: rtamt.read(
        pandas.DataFrame(dict(zip("xy", NAN, strict=True), time=TIMES))
    ),
    "trace of polars": lambda _: rtamt.read(POLARS),
    "trace of Arrow": lambda _: rtamt.read(ARROW),
    "trace of a batch of Arrow": lambda _: rtamt.read(ARROW.to_batches()[0]),
    "trace of xarray": lambda _: rtamt.read(DATASET),
    "skipped NaN": lambda _: rtamt.read(
        {"time": TIMES, "x": np.array(NAN[0]), "y": np.array(NAN[1])}, skip_nan=["x", "y"]
    ),
    "CSV": csv,
    "Parquet": parquet,
    "Excel": excel,
}


@pytest.fixture(params=SOURCES)
def data(request, tmp_path):
    return SOURCES[request.param](tmp_path)


@pytest.mark.parametrize(
    ("text", "settings", "expected"),
    [
        ("always(x >= 3)", {}, Interval(-math.inf, 1.0)),
        ("always(x >= 3)", {"uncertainty": {}}, Interval(-math.inf, 1.0)),
        ("always(x >= 3)", {"uncertainty": {"x": 0.5}}, Interval(-math.inf, 1.5)),
        ("always(x >= 3)", {"ranges": {"x": (2, 9)}}, Interval(-1.0, 1.0)),
        ("always(x >= 3) and eventually(y >= 1)", {"ranges": {"x": (2, 9)}}, Interval(-1.0, 1.0)),
        ("eventually(y >= 1)", {"ranges": {"y": (0, 2)}}, Interval(1.0, 1.0)),
        ("input float x in [2, 9]; always(x >= 3)", {"uncertainty": {}}, Interval(-1.0, 1.0)),
    ],
)
def test_missing_samples_bound_the_robustness_of_data_of_every_kind(data, text, settings, expected):
    result = rtamt.parse(text).evaluate(data, **settings)
    assert result.interval == expected
    assert result.intervals.times.tolist() == TIMES


def test_missing_samples_leave_a_verdict_only_where_all_completions_agree(data):
    assert rtamt.parse("always(x >= 7)").evaluate(data).satisfied is False
    assert rtamt.parse("eventually(x >= 3)").evaluate(data).satisfied is True
    message = (
        "the samples do not decide whether the formula holds, because some are missing or uncertain; "
        "read result.interval"
    )
    with pytest.raises(EvaluationError, match=f"^{re.escape(message)}$"):
        _ = rtamt.parse("always(x >= 3)").evaluate(data).satisfied


def test_a_formula_that_reads_no_missing_sample_has_an_exact_robustness():
    trace = rtamt.read({**DICT, "z": [3.0, 1.0, 2.0, 4.0]})
    result = rtamt.parse("always(z >= 0)").evaluate(trace)
    assert (result.robustness, result.interval) == (1.0, Interval(1.0, 1.0))
    assert result.explain() is not None


@pytest.mark.parametrize(
    ("settings", "error", "message"),
    [
        (
            {"ranges": {"x": (0, 5)}},
            TraceError,
            "'x' is 6 at sample 3, outside its declared range [0, 5]: correct the value, or declare a wider range",
        ),
        (
            {"uncertainty": {"xs": 1}},
            UsageError,
            "uncertainty= has 'xs', and the formula reads x; did you mean 'x'?",
        ),
    ],
)
def test_wrong_declarations_are_rejected_for_data_of_every_kind(data, settings, error, message):
    with pytest.raises(error, match=f"^{re.escape(message)}$"):
        rtamt.parse("always(x >= 3)").evaluate(data, **settings)


def test_nan_is_no_missing_sample():
    message = "'x' is NaN at sample 1, time 1 s: fill the gap or leave the sample out"
    for given in ({"time": TIMES, "x": NAN[0]}, pandas.DataFrame({"time": TIMES, "x": NAN[0]})):
        with pytest.raises(TraceError, match=f"^{re.escape(message)}$"):
            rtamt.parse("x >= 3").evaluate(given)


def test_a_nan_beside_a_missing_sample_is_an_error():
    trace = rtamt.read({"time": TIMES, "x": np.ma.masked_array([5, 0, math.nan, 6], [0, 1, 0, 0])})
    with pytest.raises(TraceError, match=r"^'x' is NaN at sample 2, time 2 s: "):
        rtamt.parse("x >= 3").evaluate(trace)


def test_signals_of_different_tables_have_no_common_samples_to_miss():
    trace = rtamt.read({"x": ([0.0, 1.0], [5.0, 4.0]), "y": ([0.0, 2.0], [1.0, 2.0])})
    with pytest.raises(TraceError, match=r"^'x' and 'y' have different time bases"):
        rtamt.parse("x >= y").evaluate(trace, uncertainty={})


def test_a_signal_without_any_sample_may_have_any_value():
    trace = rtamt.read(arrow.table({"time": TIMES, "x": arrow.array([None] * 4, arrow.float64())}))
    assert rtamt.parse("always(x >= 3)").evaluate(trace).interval == Interval(-math.inf, math.inf)


def test_a_slice_has_the_missing_samples_that_are_in_it():
    trace = rtamt.read(DICT)
    spec = rtamt.parse("always(x >= 3)", period=1)
    assert spec.evaluate(trace[2:3]).robustness == 1.0
    assert spec.evaluate(trace[1:3]).interval == Interval(-math.inf, 1.0)
    with pytest.raises(TraceError, match=r"^'x' is missing at sample 0 of a dict, "):
        rtamt.parse("x >= 3", period=1).monitor().update_many(trace[1:3])


def test_recorded_names_units_and_aliases_are_those_of_the_variable():
    spec = rtamt.parse('input float v [km/h] in [0, 90] = "speed"; always(v <= 40)')
    result = spec.evaluate(rtamt.read({"time": [0, 1, 2], "speed [m/s]": [10, None, 5]}))
    assert result.interval == Interval(-50.0, 4.0)
    assert result.trace.units == {"v": "km/h"}


def test_in_dense_time_a_trace_holds_the_value_before():
    spec = rtamt.parse("always(x >= 3)", time="dense")
    assert spec.evaluate(rtamt.read(DICT)).robustness == 1.0
    assert spec.evaluate(DICT).interval == Interval(-math.inf, 1.0)


FORMULAS = (
    "always[0:2](x >= 3)",
    "eventually[0:1](x >= y)",
    "(x >= 2) until[0:2] (y >= 3)",
    "historically(x + 2 * y >= 3) or once[1:2](abs(x) >= 4)",
    "always(rise(x >= 3) -> eventually[0:2](y >= 2))",
    "(prev x) - y >= 0 xor x >= 3",
)


@pytest.mark.parametrize("text", FORMULAS)
def test_bounds_of_a_file_contain_the_robustness_of_every_completion(text, tmp_path):
    spec = rtamt.parse(text)
    random.seed(text)
    values = [0.0, 2.5, 5.0]
    for number in range(6):
        full = {name: [random.choice(values) for _ in range(5)] for name in spec.input_names}
        gaps = random.sample([(name, i) for name in full for i in range(5)], 3)
        known = {name: [None if (name, i) in gaps else v for i, v in enumerate(full[name])] for name in full}
        path = tmp_path / f"{number}.csv"
        cells = [["" if v is None else str(v) for v in column] for column in known.values()]
        rows = [",".join(row) for row in zip("01234", *cells, strict=True)]
        path.write_text("\n".join([",".join(["time", *known]), *rows]))
        ranges = dict.fromkeys(known, (0.0, 5.0))
        trace = rtamt.read(path)
        result = spec.evaluate(trace, ranges=ranges).intervals
        memory = spec.evaluate({"time": range(5), **known}, ranges=ranges).intervals
        assert (result.lower.tolist(), result.upper.tolist()) == (
            memory.lower.tolist(),
            memory.upper.tolist(),
        )
        for chosen in itertools.product(values, repeat=len(gaps)):
            data = {name: list(column) for name, column in known.items()}
            for (name, i), value in zip(gaps, chosen, strict=True):
                data[name][i] = value
            exact = spec.evaluate(data).signal.values
            assert np.all(result.lower <= exact)
            assert np.all(exact <= result.upper)


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize(
    ("text", "samples", "expected"),
    [
        ("always(x >= 0 or y >= 0)", [1, None, 1], None),
        ("eventually(x >= 2)", [1, None, 3], None),
        ("historically(x >= 0)", [1, None, -1], None),
        ("x >= 0", [1, None, -1], None),
        ("x >= 0", [-1, None, 1], 0),
        ("x >= 0 and eventually(x >= 2)", [-1, None, 1], 0),
        ("always(x >= 0)", [1, None, -1], "when the formula is first violated"),
        ("eventually(x >= 2)", [1, None, 1], "whether the formula holds"),
    ],
)
def test_the_first_violation_was_an_error_about_truth(text, samples, expected, time):
    # In dense time a missing sample is one of an array: masked.
    x = np.ma.masked_invalid([np.nan if each is None else each for each in samples])
    result = rtamt.parse(text, time=time).evaluate({"time": [0, 1, 2], "x": x, "y": [1, 1, 1]})
    if isinstance(expected, str):
        with pytest.raises(
            rtamt.EvaluationError, match=f"^the samples do not decide {expected}, because some are"
        ):
            rtamt.first_violation(result)
    else:
        assert rtamt.first_violation(result) == expected
        assert result.satisfied == (expected is None)
