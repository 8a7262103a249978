"""Parquet and Arrow files."""

import subprocess
import sys
from decimal import Decimal

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import feather, parquet

import rtamt
from rtamt.readers import arrow

TABLE = pa.table(
    {
        "t": pa.array([0, 100, 200], pa.int64()),
        "x": pa.array([5.0, None, 6.0]),
        "req": [{"value": 1}, {"value": 2}, {"value": 3}],
        "mode": pa.array(["a", "b", "a"]).dictionary_encode(),
    },
    schema=pa.schema(
        [
            pa.field("t", pa.int64(), metadata={"unit": "ms"}),
            pa.field("x", pa.float32(), metadata={"unit": "V"}),
            pa.field("req", pa.struct([("value", pa.int16())])),
            pa.field("mode", pa.dictionary(pa.int32(), pa.string())),
        ]
    ),
)


def stream(table, path):
    with pa.OSFile(str(path), "wb") as file, pa.ipc.new_stream(file, table.schema) as writer:
        writer.write_table(table)


@pytest.mark.parametrize(
    ("name", "write"),
    [
        ("log.parquet", parquet.write_table),
        ("log.pq", lambda table, path: parquet.write_table(table, path, row_group_size=1)),
        ("log.feather", feather.write_feather),
        ("log.arrow", lambda table, path: feather.write_feather(table, str(path), chunksize=2)),
        ("log.ipc", stream),
    ],
)
def test_a_file_is_read_with_its_units_gaps_and_fields(tmp_path, name, write):
    write(TABLE, tmp_path / name)
    trace = rtamt.read(tmp_path / name)
    assert trace.names == ("x", "req.value")
    assert trace["x"].times.tolist() == [0, 0.2]
    assert trace["req.value"].times.tolist() == [0, 0.1, 0.2]
    assert trace.channel("x").unit == "V"
    assert trace.notes == ("time is 't', by its name", "left out, not numbers: mode")
    assert rtamt.read(tmp_path / name, columns=["req.value"])["req.value"].values.tolist() == [1, 2, 3]


def test_dates_of_nanoseconds(tmp_path):
    dates = np.array(["2024-05-01T10:00:00.000000001", "2024-05-01T10:00:00.000000003"], dtype="M8[ns]")
    parquet.write_table(pa.table({"when": dates, "x": [1, 2]}), tmp_path / "log.parquet")
    assert rtamt.read(tmp_path / "log.parquet")["x"].times.tolist() == dates.tolist()


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.parquet", None, "there is no file '{path}'"),
        ("a.parquet", b"PAR1 nonsense", "'{path}' cannot be read as Parquet: "),
        ("a.arrow", b"nonsense", "'{path}' cannot be read as Arrow: "),
        (
            "a.parket",
            b"",
            "cannot tell how to read '{path}': its name ends in none of .csv, .tsv, .txt, .parquet",
        ),
    ],
)
def test_what_is_no_such_file(tmp_path, name, content, message):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(path)
    assert str(error.value).startswith(message.format(path=path))
    assert "\n" not in str(error.value)


def test_without_the_extra_one_sentence_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    (tmp_path / "a.parquet").touch()
    with pytest.raises(rtamt.UsageError) as error:
        rtamt.read(tmp_path / "a.parquet")
    assert str(error.value) == (
        "reading Parquet needs the package 'pyarrow', which is not installed: pip install 'rtamt[data]'"
    )


@pytest.mark.parametrize("kind", [pa.time32("s"), pa.time64("us")])
def test_times_of_day_raised_not_implemented_error(kind):
    table = pa.table({"time": pa.array([0, 1], kind), "x": [1, 2]})
    with pytest.raises(rtamt.TraceError, match=r"the time column 'time' of an arrow table is datetime\.time"):
        rtamt.parse("x > 0").evaluate(rtamt.read(table))


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_table_of_arrow_that_was_not_read_raised_key_error(time):
    spec = rtamt.parse("historically(x > 0)", time=time)
    table = pa.table({"time": [0.0, 1.0], "x": [1, 2]})
    for entry in (
        spec.evaluate,
        spec.monitor().update_many,
        lambda data: rtamt.check_stream(spec, [data]),
        lambda data: spec.evaluate(data, uncertainty={"x": 0.5}),
    ):
        with pytest.raises(rtamt.TraceError, match=r"got an Arrow Table; write rtamt\.read\(table\)"):
            entry(table)
    assert spec.evaluate(rtamt.read(table)).robustness == 1


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_structured_array_that_was_not_read_is_an_error_that_says_so(time):
    spec = rtamt.parse("historically(x > 0)", time=time)
    array = np.array([(0.0, 1.0), (1.0, 2.0)], dtype=[("time", float), ("x", float)])
    for entry in (spec.evaluate, spec.monitor().update_many, lambda data: rtamt.check_stream(spec, [data])):
        with pytest.raises(
            rtamt.TraceError,
            match=r"^expected data, got a structured NumPy array; write rtamt\.read\(array\)$",
        ):
            entry(array)
    assert spec.evaluate(rtamt.read(array)).robustness == 1


def test_reading_parquet_in_chunks_kept_the_whole_file_in_memory(tmp_path):
    path = tmp_path / "long.parquet"
    random = np.random.default_rng(1)
    columns = {name: random.normal(size=2**21) for name in "ab"}
    parquet.write_table(pa.table(columns), path, row_group_size=2**19)  # 32 MB, in four groups
    del columns
    before = pa.total_allocated_bytes()
    most, rows = 0, 0
    for chunk in rtamt.scan(path):
        rows += len(chunk["a"].values)
        most = max(most, pa.total_allocated_bytes() - before)
    assert rows == 2**21
    assert most < 16 * 2**20


def test_reading_numbers_of_arrow_imported_pandas(tmp_path):
    path = tmp_path / "log.parquet"
    parquet.write_table(pa.table({"time": [0.0, 1.0], "x": [1, 2]}), path)
    code = f"import sys, rtamt; rtamt.read({str(path)!r}); sys.exit('pandas' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize(
    "kind", ["float32", "float64", "int8", "uint8", "int16", "uint16", "int32", "uint64"]
)
def test_numbers_of_arrow_are_those_of_its_own_conversion(kind):
    parts = [np.arange(n, dtype=kind) for n in (5, 0, 3)]
    column = pa.chunked_array([pa.array(part) for part in parts], pa.from_numpy_dtype(kind))
    for some in (column, column.slice(2, 4), column.slice(6), column.slice(0, 0)):
        found = arrow.values_of(some)
        assert found.dtype == kind
        np.testing.assert_array_equal(found, some.to_numpy())


def test_batches_of_one_sample_are_chunks_of_several(tmp_path):
    path = tmp_path / "log.arrow"
    table = pa.table({"time": np.arange(4) * 0.5, "x": [1.0, 2.0, -1.0, 3.0]})
    with pa.OSFile(str(path), "wb") as file, pa.ipc.new_file(file, table.schema) as writer:
        for batch in table.to_batches(max_chunksize=1):
            writer.write_batch(batch)
    (chunk,) = rtamt.scan(path)
    assert chunk["x"].values.tolist() == [1, 2, -1, 3]
    found = rtamt.check_stream(rtamt.parse("always(x >= 0)"), rtamt.scan(path))
    assert (found.robustness, float(found.period), found.first_violation) == (-1, 0.5, 1.0)


def test_structs_in_structs_have_a_column_for_each_field(tmp_path):
    table = pa.table({"time": [0.0, 1.0], "pose": [{"at": {"x": 1.0}}, {"at": {"x": 2.0}}]})
    parquet.write_table(table, tmp_path / "log.parquet")
    feather.write_feather(table, tmp_path / "log.feather")
    for name in ("log.parquet", "log.feather"):
        assert rtamt.read(tmp_path / name)["pose.at.x"].values.tolist() == [1, 2]
        (chunk,) = rtamt.scan(tmp_path / name, columns=["pose.at.x"])
        assert chunk["pose.at.x"].values.tolist() == [1, 2]


def test_encoded_numbers_are_signals(tmp_path):
    runs = pa.RunEndEncodedArray.from_arrays(pa.array([2, 3], pa.int32()), pa.array([1.0, 2.0]))
    table = pa.table({"time": [0.0, 1.0, 2.0], "x": runs, "y": pa.array([5.0, 5.0, 6.0]).dictionary_encode()})
    path = tmp_path / "log.arrow"
    with pa.OSFile(str(path), "wb") as file, pa.ipc.new_file(file, table.schema) as writer:
        writer.write_table(table)
    trace = rtamt.read(path)
    assert trace["x"].values.tolist() == [1, 1, 2]
    assert trace["y"].values.tolist() == [5, 5, 6]


def test_the_index_that_pandas_writes_without_a_name_may_hold_the_timestamps(tmp_path):
    path = tmp_path / "log.parquet"
    parquet.write_table(pa.table({"x": [1.0, 2.0], "__index_level_0__": [0.0, 0.5]}), path)
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(path)
    assert str(error.value) == (
        f"{path} has a column that may hold the timestamps: '__index_level_0__'; choose one with time=, or on the "
        f"command line --time-column ('' for none)"
    )


def test_decimals_are_the_nearest_doubles(tmp_path):
    """The cast of pyarrow reads 0.70 as 0.7000000000000001."""
    numbers = [Decimal(cents).scaleb(-2) for cents in range(-500, 500, 7)]
    for places in (2, 4, 20):
        column = pa.array([*numbers, None], pa.decimal128(38, places))
        times = pa.array([Decimal(at) / 10 for at in range(len(column))], pa.decimal128(10, 1))
        parquet.write_table(pa.table({"time": times, "x": column}), tmp_path / "log.parquet")
        trace = rtamt.read(tmp_path / "log.parquet")
        assert trace["x"].times.tolist() == [at / 10 for at in range(len(numbers))]
        assert trace["x"].values.tolist() == [float(number) for number in numbers]


class Celsius(pa.ExtensionType):
    """A type of a program of its own: numbers with a name."""

    def __init__(self):
        super().__init__(pa.float32(), "example.celsius")

    def __arrow_ext_serialize__(self):
        return b""

    @classmethod
    def __arrow_ext_deserialize__(cls, storage_type, serialized):
        return cls()


def extended(type_, values):
    return pa.ExtensionArray.from_storage(type_, pa.array(values, type_.storage_type))


@pytest.mark.parametrize("write", [None, parquet.write_table, feather.write_feather, stream])
def test_columns_of_extension_types_are_those_of_their_storage(tmp_path, write):
    """Without columns=, they were left out as no numbers; a byte of bool8 that is not 0 is true."""
    table = pa.table(
        {
            "time": [0.0, 1.0, 2.0, 3.0],
            "armed": extended(pa.bool8(), [1, 0, None, 5]),
            "temperature": extended(Celsius(), [20.5, 21.5, 22.5, None]),
            "id": extended(pa.uuid(), [bytes(16)] * 4),
        }
    )
    suffix = {parquet.write_table: "parquet"}.get(write, "arrow")
    path = tmp_path / f"log.{suffix}"
    if write is not None:
        write(table, path)
    trace = rtamt.read(table if write is None else path)
    assert trace["armed"].values.tolist() == [1, 0, 1]
    assert trace["armed"].times.tolist() == [0, 1, 3]
    assert trace["temperature"].values.tolist() == [20.5, 21.5, 22.5]
    assert trace.notes == ("left out, not numbers: id",)
    spec = rtamt.parse("bool armed  float temperature  always(armed or temperature >= 21)", time="dense")
    assert spec.evaluate(trace).satisfied
