"""``rtamt.read`` of what is in memory: pandas, polars, xarray, arrow, numpy, dicts."""

import datetime as dt
import math

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest
import xarray as xr

import rtamt

X = [5.0, 4.0, 6.0]
STAMPS = [0.0, 0.1, 0.2]
DATES = np.array(["2024-05-01T10:00:00", "2024-05-01T10:00:01", "2024-05-01T10:00:02"], dtype="M8[ns]")


@pytest.mark.parametrize(
    "data",
    [
        {"time": STAMPS, "x": X},
        {"x": (STAMPS, X)},
        {"x": [[t, v] for t, v in zip(STAMPS, X, strict=True)]},
        {"time_ms": [0, 100, 200], "x": X},
        {"Time [us]": np.array([0, 100_000, 200_000]), "x [V]": X},
        np.array(list(zip(STAMPS, X, strict=True)), dtype=[("t", float), ("x", float)]),
        pd.DataFrame({"timestamp": STAMPS, "x": X}),
        pd.DataFrame({"x": X}, index=pd.Index(STAMPS, name="t")),
        pd.Series(X, index=pd.to_timedelta([0, 100, 200], unit="ms"), name="x"),
        pl.DataFrame({"t": STAMPS, "x": X}),
        pl.DataFrame({"t": [dt.timedelta(milliseconds=ms) for ms in (0, 100, 200)], "x": X}),
        pa.table({"stamp (ms)": [0, 100, 200], "x": X}),
        xr.DataArray(X, coords={"t": STAMPS}, dims="t", name="x"),
        xr.Dataset({"x": ("i", X)}, coords={"i": ("i", [0, 100, 200], {"units": "ms"})}).rename(i="time"),
    ],
    ids=lambda data: type(data).__name__,
)
def test_every_kind_of_data_gives_the_same_signal(data):
    trace = rtamt.read(data)
    assert trace.names == ("x",)
    assert trace["x"].times.tolist() == STAMPS
    assert trace["x"].values.tolist() == X
    assert trace["x"].values.dtype == np.float64
    assert rtamt.parse("always(x >= 3)", period="100ms").evaluate(trace).robustness == 1


@pytest.mark.parametrize(
    "data",
    [
        {"t": DATES, "x": X},
        {"t": ["2024-05-01T10:00:00Z", "2024-05-01T12:00:01+02:00", "2024-05-01 10:00:02+00:00"], "x": X},
        pd.DataFrame({"x": X}, index=pd.DatetimeIndex(DATES)),
        pd.DataFrame({"x": X}, index=pd.DatetimeIndex(DATES).tz_localize("UTC").tz_convert("Asia/Tokyo")),
        pl.DataFrame({"when": DATES, "x": X}),
        pl.DataFrame({"when": DATES, "x": X}).with_columns(
            pl.col("when").dt.replace_time_zone("UTC").dt.convert_time_zone("Asia/Tokyo")
        ),
        pa.table({"when": pa.array(DATES, pa.timestamp("ns", "UTC")), "x": X}),
        xr.Dataset({"x": ("when", X)}, coords={"when": DATES}),
    ],
    ids=lambda data: type(data).__name__,
)
def test_dates_are_utc_whatever_holds_them(data):
    trace = rtamt.read(data)
    assert trace["x"].times.dtype == np.dtype("M8[ns]")
    assert trace["x"].times.tolist() == DATES.tolist()
    assert rtamt.parse("always[0:2](x >= 3)").evaluate(trace, time="dense").robustness == 1
    assert rtamt.parse("always[0:2](x >= 3)").evaluate(trace).robustness == 1


@pytest.mark.parametrize(
    "data",
    [
        pd.DataFrame({"time": [0.0, 1.0, 2.0], "x": [1.0, np.nan, 3.0], "y": [1, 2, 3]}),
        pd.DataFrame({"time": [0.0, 1.0, 2.0], "x": pd.array([1, None, 3], dtype="Int64"), "y": [1, 2, 3]}),
        pl.DataFrame({"time": [0.0, 1.0, 2.0], "x": [1, None, 3], "y": [1, 2, 3]}),
        pl.DataFrame({"time": [0.0, 1.0, 2.0], "x": [True, None, True], "y": [1, 2, 3]}),
        pa.table({"time": [0.0, 1.0, 2.0], "x": [1, None, 3], "y": [1, 2, 3]}),
        pa.table({"time": [0.0, 1.0, 2.0], "x": [True, None, True], "y": [1, 2, 3]}),
        {"time": [0.0, 1.0, 2.0], "x": [1, None, 3], "y": [1, 2, 3]},
        {"time": [0.0, 1.0, 2.0], "x": np.ma.masked_equal([1, 9, 3], 9), "y": [1, 2, 3]},
        xr.Dataset(
            {"x": ("time", [1.0, np.nan, 3.0]), "y": ("time", [1, 2, 3])}, coords={"time": [0.0, 1.0, 2.0]}
        ),
    ],
    ids=lambda data: type(data).__name__,
)
def test_a_missing_value_is_no_sample(data):
    trace = rtamt.read(data)
    assert trace["x"].times.tolist() == [0, 2]
    assert trace["y"].times.tolist() == [0, 1, 2]
    assert rtamt.parse("always(y >= x)").evaluate(trace, time="dense").robustness == 0
    assert rtamt.parse("always(y >= x)").evaluate(trace).interval == rtamt.Interval(-math.inf, 0)


def test_nan_that_is_no_missing_value_is_an_error_as_ever():
    trace = rtamt.read({"time": [0.0, 1.0], "x": [1.0, float("nan")]})
    with pytest.raises(rtamt.TraceError, match=r"^'x' is NaN at sample 1, time 1 s: fill the gap"):
        rtamt.parse("x").evaluate(trace)


def test_columns_names_and_units():
    data = pa.table({"time": [0, 1], "Motor speed [rpm]": [3, 4], "x": [1, 2], "note": ["a", "b"]})
    trace = rtamt.read(data, columns=["speed"], names={"speed": "Motor speed"}, units={"time": "ms"})
    assert trace.names == ("speed",)
    assert (trace.channel("speed").unit, trace.channel("speed").column) == ("rpm", "Motor speed [rpm]")
    assert trace["speed"].times.tolist() == [0, 0.001]
    assert rtamt.read(data).names == ("Motor speed", "x")
    assert rtamt.read(data, names={"v": "x"}, units={"v": "m/s"}).names == ("Motor speed", "v")
    assert rtamt.read(data, units={"x": "V"}).channel("x").unit == "V"


def test_fields_of_structures_are_columns():
    table = pa.table({"t": [0, 1], "req": [{"value": 3, "ok": True}, {"value": 4, "ok": False}]})
    trace = rtamt.read(table)
    assert trace.names == ("req.value", "req.ok")
    assert rtamt.parse("always(req.value >= 3)").evaluate(trace).robustness == 0


def test_every_guess_is_visible():
    frame = pl.DataFrame({"stamp_us": [0, 10], "x [V]": [1, 2], "mode": ["a", "b"]})
    assert repr(rtamt.read(frame)) == (
        "Trace of a polars frame: 1 signal, 0 s to 1e-05 s\n"
        "  time is 'stamp_us', by its name\n"
        "  left out, not numbers: mode\n"
        "  x [V]  2 samples, 0 s to 1e-05 s"
    )
    assert rtamt.read(pl.DataFrame({"when": DATES, "x": X})).notes == (
        "time is 'when', the one column of dates",
    )


def test_the_data_of_the_caller_is_not_shared():
    x = np.array(X)
    trace = rtamt.read({"x": x})
    x[0] = 99
    assert trace["x"].values.tolist() == X


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: rtamt.read(5),
         "cannot read data of type int: give a file (CSV, Parquet, Arrow, Excel, PX4 ULog, MDF, ROS bag), the address "
         "of a database, or a dict, a structured numpy array, "
         "pandas.DataFrame, pandas.Series, polars.DataFrame, pyarrow.Table, pyarrow.RecordBatch, xarray.Dataset, "
         "xarray.DataArray"),
        (lambda: rtamt.read(np.zeros((2, 2))),
         "an array of 2 dimensions does not say what is in it: give a dict from name to values, "
         "or an array with named fields"),
        (lambda: rtamt.read({"time": [0, 1], "stamp": [0, 1], "x": [1, 2]}),
         "a dict has several columns that may hold the timestamps: 'time', 'stamp'; "
         "choose one with time=, or on the command line --time-column ('' for none)"),
        (lambda: rtamt.read({"time": [0, 1], "x": [1]}),
         "'time' has 2 and 'x' has 1 samples: give one value of each at every sample"),
        (lambda: rtamt.read({"x": [[1, 2, 3]]}), "'x' has 2 dimensions, expected 1: give one number a sample"),
        (lambda: rtamt.read({"time": [0, None], "x": [1, 2]}),
         "the time column 'time' of a dict is empty at sample 1"),
        (lambda: rtamt.read({"time": [0, "now"], "x": [1, 2]}),
         "the time column 'time' of a dict is 'now' at sample 1, expected a number, "
         "or a date such as 2026-05-01T12:00:00.5"),
        (lambda: rtamt.read({"x": [1, "a"]}, columns=["x"]), "'x' of a dict is 'a' at sample 1, expected a number"),
        (lambda: rtamt.read({"x": [1, None]}),
         "'x' is missing at sample 1 of a dict: fill the gap, or name the column of timestamps, "
         "so that each signal has its own time base"),
        (lambda: rtamt.read({"req": [1]}, columns=["rq"]),
         "a dict has no column 'rq'; did you mean 'req'? (columns: req)"),
        (lambda: rtamt.read({"req": [1]}, time="clock"), "a dict has no column 'clock'; columns: req"),
        (lambda: rtamt.read({"x": [1]}, columns="x"),
         "columns is the text 'x'; give a list of names, such as ['x']"),
        (lambda: rtamt.read({"time": [1], "x": [1]}, units={"time": "day"}),
         "the unit of the time column 'time' of a dict is 'day', which is none of h, min, s, ms, us, ns"),
        (lambda: rtamt.read({"t": [0, 1], "x": [1, 2]}, columns=["time", "x"]),
         "the formula reads 'time', but the timestamps of a dict are its column 't'; "
         "name that column 'time', or the variable something else"),
        (lambda: rtamt.read({"x [V]": [1], "x [A]": [1]}),
         "a dict has several columns for 'x': 'x [V]', 'x [A]'; say which are meant with columns= or names="),
        (lambda: rtamt.read(pd.DataFrame([[1, 2]], columns=["x", "x"])),
         "the pandas frame has two columns called 'x'; rename one of them"),
        (lambda: rtamt.read(pd.DataFrame([[1, 2]], columns=[1, "1"])),
         "the pandas frame has two columns called '1'; rename one of them"),
        (lambda: rtamt.read({"x": ([0.0], [1]), "y": (DATES[:1], [1])}),
         "some signals of a dict have dates for times and others numbers: use one of them for all"),
    ],
)  # fmt: skip
def test_messages(call, message):
    with pytest.raises(rtamt.StlError) as error:
        call()
    assert str(error.value) == message


LEVELS = pd.MultiIndex.from_product([["car"], [0.0, 0.5]], names=["vehicle", "time"])


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize(
    ("frame", "named"),
    [
        (pd.DataFrame({"time_ms": [0, 500], "x": [1, -1]}), "'time_ms'"),
        (pl.DataFrame({"time_ms": [0, 500], "x": [1, -1]}), "'time_ms'"),
        (pl.DataFrame({"when": DATES[:2], "x": [1, -1]}), "'when'"),
        (pd.DataFrame({"sim_time": [0, 500], "x": [1, -1]}), "'sim_time'"),
        (pd.DataFrame({"x": [1, -1]}, index=pd.DatetimeIndex(DATES[:2])), "its index"),
        (pd.DataFrame({"x": [1, -1]}, index=pd.Index([0, 500], name="time")), "its index 'time'"),
        (pd.DataFrame([[0, 1, 2]], columns=["x", 7, "t"]), "'t'"),
        (pd.DataFrame({"x": [1, -1]}, index=pd.period_range("2024-01", periods=2, freq="s")), "its index"),
        (pd.DataFrame({"x": [1, -1]}, index=[0.0, 0.5]), "its index"),
        (pd.DataFrame({"x": [1, -1]}, index=pd.Index([0, 500], name="time [ms]")), "its index 'time [ms]'"),
        (pd.DataFrame({"x": [1, -1]}, index=LEVELS), "its index 'time'"),
        (pd.DataFrame({"time": [0, 1], "t [ms]": [0, 500], "x": [1, -1]}), "'t [ms]'"),
        (pd.DataFrame({"when": ["2024-05-01 10:00", "2024-05-01 10:01"], "x": [1, -1]}), "'when'"),
        (pl.DataFrame({"when": ["2024-05-01T10:00", "2024-05-01T10:01"], "x": [1, -1]}), "'when'"),
        (pd.DataFrame({"x": [1, -1]}, index=["2024-05-01 10:00", "2024-05-01 10:01"]), "its index"),
        (pd.DataFrame({"x": [1, -1]}, index=[dt.timedelta(0), dt.timedelta(1)]), "its index"),
    ],
)
def test_a_frame_that_is_evaluated_directly_is_not_taken_to_have_no_time(frame, named, time):
    spec = rtamt.parse("always(x >= 0)", time=time)
    sentence = (
        f"the frame may have its timestamps in {named}, but only the column 'time' is read here: read the frame with "
        f"rtamt.read, which takes other columns and units"
    )
    for evaluate in (spec.evaluate, lambda data: rtamt.check_stream(spec, [data])):
        with pytest.raises(rtamt.TraceError) as error:
            evaluate(frame)
        assert str(error.value) == sentence


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize("others", [[0, 1], [("a", "b"), ("c", "d")], [None, 2.5]])
def test_a_frame_whose_other_columns_are_not_named_by_texts_is_evaluated(others, time):
    frame = pd.DataFrame([[5, 7, 7], [4, 8, 8]])
    frame.columns = pd.Index(["x", *others], dtype=object, tupleize_cols=False)
    if time == "dense":
        frame["time"] = [0.0, 1.0]
    assert rtamt.parse("always(x >= 3)", time=time).evaluate(frame).robustness == 1


def test_a_lazy_frame_is_an_error_that_names_collect():
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.parse("always(x >= 3)").evaluate(pl.LazyFrame({"x": [5, 4]}))
    assert str(error.value) == "expected data, got a LazyFrame; write frame.collect()"


def test_a_frame_whose_columns_tell_no_time_is_samples_one_period_apart():
    for library in (pd, pl):
        spec = rtamt.parse("always[0:1](x + lap_time >= 0)")
        assert (
            spec.evaluate(
                library.DataFrame({"x": [1.0, 2.0], "lap_time": [3.0, -4.0], "y": [0, 0]})
            ).robustness
            == -2
        )


def test_an_index_of_measured_numbers_may_hold_the_timestamps():
    frame = pd.DataFrame({"x": [1.0, -1.0]}, index=[0.0, 0.5])
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(frame)
    assert str(error.value) == (
        "a pandas frame has a column that may hold the timestamps: 'index'; choose one with time=, or on the command "
        "line --time-column ('' for none)"
    )
    assert rtamt.read(frame, time="index")["x"].times.tolist() == [0.0, 0.5]
    assert rtamt.read(frame, time="")["x"].times.tolist() == [0, 1]


def test_a_column_called_time_comes_before_an_index_of_dates_as_in_an_evaluation():
    frame = pd.DataFrame({"time": [0.0, 0.5], "x": [1, -1]}, index=pd.DatetimeIndex(DATES[:2]))
    assert rtamt.read(frame)["x"].times.tolist() == [0.0, 0.5]


def test_an_index_of_several_levels_and_one_of_periods_are_read():
    assert rtamt.read(pd.DataFrame({"x": [1.0, 2.0]}, index=LEVELS))["x"].times.tolist() == [0.0, 0.5]
    periods = pd.DataFrame({"x": [1.0, 2.0]}, index=pd.period_range("2024-01-01", periods=2, freq="min"))
    assert str(rtamt.read(periods).end) == "2024-01-01T00:01:00.000000000"


@pytest.mark.parametrize("name", ["collect", "column_names"])
def test_a_column_may_have_the_name_of_a_method(name):
    frame = pd.DataFrame({"time": [0.0, 1.0], "x": [1.0, -2.0], name: [0, 0]})
    for time in ("discrete", "dense"):
        assert rtamt.parse("always(x >= 0)", time=time).evaluate(frame).robustness == -2


def test_integers_of_128_bits_are_evaluated_as_they_are_read():
    frame = pl.DataFrame({"time": [0, 1], "x": pl.Series([1, -2]).cast(pl.Int128)})
    spec = rtamt.parse("always(x >= 0)")
    assert spec.evaluate(frame).robustness == spec.evaluate(rtamt.read(frame)).robustness == -2


def test_a_record_batch_is_read_as_a_table():
    batch = pa.RecordBatch.from_pydict({"time": [0.0, 0.5], "x": [1.0, 2.0]})
    assert rtamt.read(batch)["x"].times.tolist() == [0.0, 0.5]


def test_a_value_of_several_lines_is_shown_in_one():
    frame = pl.DataFrame({"time": [0.0], "x": [[1.0]]})
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.parse("x >= 0").evaluate(frame)
    assert "\n" not in str(error.value)


INDEXES = {
    "its index": [pd.Index(STAMPS), pd.DatetimeIndex(DATES), pd.to_timedelta(STAMPS, unit="s")],
    "its index 'time'": [pd.Index([0, 100, 200], name="time")],
}


@pytest.mark.parametrize("gap", [False, True], ids=["whole", "with a gap"])
@pytest.mark.parametrize(
    ("series", "named"),
    [
        *((pd.Series(X, index=index), named) for named, indexes in INDEXES.items() for index in indexes),
        (xr.DataArray(X, coords={"time": STAMPS}, dims="time"), "its index 'time'"),
    ],
)
def test_a_series_with_timestamps_in_its_index_is_not_taken_to_have_none(series, named, gap):
    spec = rtamt.parse("x >= 3")
    monitor = spec.monitor()
    sentence = (
        f"'x' may have its timestamps in {named}, but those of a mapping are read from its key 'time': give them "
        f"there, or the bare values, with to_numpy(), if the index holds no times"
    )
    if gap:
        series = series.where(series > 4)
    for evaluate in (spec.evaluate, monitor.update_many, rtamt.read):
        with pytest.raises(rtamt.TraceError) as error:
            evaluate({"x": series})
        assert str(error.value) == sentence
    assert spec.evaluate({"x": series.to_numpy()[:1]}).robustness == 2
    assert spec.evaluate({"time": STAMPS[:1], "x": series[:1]}).robustness == 2


@pytest.mark.parametrize("name", ["elapsed_ms", "simMs", "millis", "clock ms", "clock_msec"])
def test_the_unit_at_the_end_of_the_name_of_a_chosen_time_column_is_read(name):
    trace = rtamt.read({name: [0, 100, 200], "x": X}, time=name)
    assert trace["x"].times.tolist() == STAMPS
    assert trace.notes == (f"'{name}' is in ms, by its name",)
    assert rtamt.read({name: [0, 100, 200], "x": X}, time=name, time_unit="us")["x"].times[1] == 0.0001


@pytest.mark.parametrize("name", ["t", "timestamp", "Time", "time_ms", "stamp [us]"])
def test_timestamps_of_a_dict_that_are_not_called_time_are_not_ignored(name):
    spec = rtamt.parse("x >= 3")
    sentence = (
        f"the data may have its timestamps in '{name}', but those of a mapping are read from its key 'time': rename "
        f"the key, or read the data with rtamt.read, which takes other names and units"
    )
    for evaluate in (spec.evaluate, spec.evaluate, spec.monitor().update_many):
        with pytest.raises(rtamt.TraceError) as error:
            evaluate({name: STAMPS, "x": X})
        assert str(error.value) == sentence
    with pytest.raises(rtamt.TraceError) as error:
        spec.evaluate_batch({name: [STAMPS], "x": [X]})
    assert str(error.value) == sentence
    assert spec.evaluate({name: STAMPS, "time": STAMPS, "x": X}).robustness == 2
    assert spec.evaluate({"speed": STAMPS, "x": X}).robustness == 2


def test_a_variable_with_the_name_of_timestamps_is_a_variable():
    assert rtamt.parse("t >= 3").evaluate({"t": X, "speed": X}).robustness == 2
    assert rtamt.parse('input float x = "t"\nx >= 3').evaluate({"t": X, "speed": X}).robustness == 2
    with pytest.raises(rtamt.TraceError, match="may have its timestamps in 't'"):
        rtamt.parse("x >= 3").evaluate({"t": X, "x": X})
    declared = rtamt.parse("input float t  input float x  x >= 3")
    assert declared.evaluate({"t": X, "x": X}).robustness == 2
    assert declared.evaluate_batch({"t": [X], "x": [X]}).robustness == 2
    assert declared.monitor().update_many({"t": X, "x": X}).values.tolist() == [2, 1, 3]
    assert rtamt.check_stream(declared, [{"t": X, "x": X}]).robustness == 2
    suite = rtamt.Suite([declared, rtamt.parse("t >= 4")], period=1)
    assert [row.robustness for row in suite.evaluate({"t": X, "x": X})] == [2, 1]


def test_a_range_that_is_the_index_of_a_frame_holds_its_timestamps():
    index = pd.RangeIndex(0, 300, 100, name="time_ms")
    for data in (pd.DataFrame({"x": X}, index), pd.Series(X, index, name="x")):
        assert rtamt.read(data)["x"].times.tolist() == STAMPS
    assert rtamt.read(pd.DataFrame({"x": X}, pd.RangeIndex(0, 6, 2))).channel("x").times is None
    table = pa.Table.from_pandas(pd.DataFrame({"x": X}, index))
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(table)
    assert str(error.value) == (
        "the timestamps 'time_ms' are a pandas index that was saved without its values: save frame.reset_index(), or "
        "read without timestamps (time='', --time-column '')"
    )
    assert rtamt.read(table, columns=["x"], time="")["x"].values.tolist() == X
    assert (
        rtamt.read(table.append_column("clock", pa.array(STAMPS)), columns=["x"], time="clock")["x"].times[1]
        == 0.1
    )


def test_a_column_without_numbers_is_said_to_be_left_out():
    trace = rtamt.read({"time": [0, 1], "x": ["a", "b"], "y": ["c", "d"], "z": [1, 2]})
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.parse("always(y > 0)").evaluate(trace)
    assert str(error.value) == (
        "'y' of a dict was left out, because its values are not all numbers in the range of doubles; "
        "columns=['y'] names the first that is none, and types=spec.types reads members of enumerations by their names"
    )
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.parse("always(left > 0)").evaluate(trace)
    assert str(error.value) == "a dict has no 'left'; signals: z"
