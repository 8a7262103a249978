"""Any file is a trace or an error with a sentence, which names it where its data is wrong, whatever its bytes."""

from __future__ import annotations

import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import openpyxl
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyarrow import feather, parquet

import rtamt
from rtamt.errors import TraceError, UsageError
from rtamt.readers.formats import FORMATS
from tests.unit.readers.test_formats import ulog

CORPUS = Path(__file__).parent / "corpus" / "files"

CSV = "t [ms],x,note\n0,1.5,go\n100,2,\n# a comment\n200,-3e2,stop\n"
TABLE = pa.table({"t": pa.array([0, 100, 200], pa.int64()), "x": [5.0, None, 6.0], "mode": ["a", "b", "a"]})

cells = st.sampled_from(
    ["0", "1", "2.5", "-1e3", "nan", "inf", "", " ", '"', '"1"', "x", "\x00", "#", "é", "1e999"]
)
rows = st.lists(st.lists(cells, max_size=4).map(",".join), max_size=6)
headers = st.sampled_from(
    ["t,x", "time [ms],x", "x", "t [h],x [V],x", "", "# t,x", "1,2", "t;x", "time,time", "t,,x"]
)
tables = st.tuples(headers, rows, st.sampled_from(["\n", "\r\n", "\r"])).map(
    lambda parts: parts[2].join([parts[0], *parts[1]]).encode()
)


@cache
def written(suffix: str) -> bytes:
    """Return a good file of a format."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "good" + suffix)
        if suffix == ".parquet":
            parquet.write_table(TABLE, path)
        elif suffix == ".arrow":
            feather.write_feather(TABLE, path)
        elif suffix == ".ulg":
            rows = [(1_000_000, 12.5), (1_500_000, 12.25)]
            ulog(path, [("battery", 0, "float x", rows), ("battery", 1, "float x", rows)], dropouts=[100])
        elif suffix == ".xlsx":
            book = openpyxl.Workbook()
            for row in (("t", "x", "note"), (0, 1.5, "go"), (1, None, "on"), (2, 3, "stop")):
                book.worksheets[0].append(row)
            book.save(path)
        else:
            path.write_text(CSV)
        return path.read_bytes()


@st.composite
def damaged(draw: st.DrawFn, suffix: str) -> bytes:
    data = bytearray(written(suffix))
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, len(data) - 1))
        kind = draw(st.sampled_from(("byte", "byte", "cut", "put")))
        if kind == "byte":
            data[at] = draw(st.integers(0, 255))
        elif kind == "cut":
            del data[at : at + draw(st.integers(1, 30))]
        else:
            data[at:at] = draw(st.binary(min_size=1, max_size=8))
        if not data:
            break
    return bytes(data)


def read(data: bytes, suffix: str) -> None:
    """Read a file with these bytes: a trace without NaN, or an error that names the file or the remedy."""
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder, "log" + suffix))
        Path(path).write_bytes(data)
        try:
            trace = rtamt.read(path)
        except UsageError as error:
            sentence = str(error)
        except TraceError as error:
            sentence = str(error) if "log" + suffix in str(error) else ""
        else:
            sentence = "read"
            # A flight log says NaN where there is no value; that is refused when a formula reads it.
            assert suffix == ".ulg" or not any(np.isnan(trace[name].values).any() for name in trace)
    assert sentence


@given(st.binary(max_size=60) | tables | damaged(".csv"))
def test_any_csv_file_is_a_trace_or_an_error_that_names_it(data: bytes) -> None:
    read(data, ".csv")


# Not MDF: at some damaged files asammdf brings down the process.
@pytest.mark.parametrize("suffix", [".parquet", ".arrow", ".xlsx", ".ulg"])
@given(data=st.data())
def test_any_binary_file_is_a_trace_or_an_error_that_names_it(data: st.DataObject, suffix: str) -> None:
    read(data.draw(damaged(suffix)), suffix)


def test_a_time_column_of_nothing_but_nulls_is_missing_its_first_stamp(tmp_path: Path) -> None:
    path = tmp_path / "log.arrow"
    feather.write_feather(pa.table({"t": pa.array([None, None], pa.int64()), "x": [1.0, 2.0]}), path)
    with pytest.raises(TraceError) as info:
        rtamt.read(path)
    assert str(info.value) == f"the time column 't' of {path} is empty at sample 0"


def test_a_parquet_file_whose_column_names_are_damaged_is_refused(tmp_path: Path) -> None:
    good = tmp_path / "good.parquet"
    parquet.write_table(pa.table({"t": [0.0], "needle": [1.0]}), good, store_schema=False)
    path = tmp_path / "log.parquet"
    path.write_bytes(good.read_bytes().replace(b"needle", b"\xff\xfeedle"))
    with pytest.raises(TraceError, match="cannot be read as Parquet: 'utf-8' codec can't decode byte 0xff"):
        rtamt.read(path)


@pytest.mark.parametrize("path", sorted(CORPUS.iterdir()), ids=lambda path: path.name)
def test_files_of_the_corpus(path: Path) -> None:
    assert path.suffix in {suffix for known in FORMATS for suffix in known.suffixes}
    read(path.read_bytes(), path.suffix)
