"""CSV files are read the same with pyarrow and without: numbers to the last bit, empty cells, times, and errors."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import rtamt
from rtamt.readers import csv_arrow
from rtamt.readers.csv import Column, Header
from rtamt.readers.csv_source import open_csv

pytest.importorskip("pyarrow")

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

PLAIN = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False).map(repr),
    st.integers(-(10**6), 10**6).map(str),
    st.decimals(allow_nan=False, allow_infinity=False, places=4, min_value=-1000, max_value=1000).map(str),
    st.from_regex(r"[+-]?[0-9]{0,20}\.?[0-9]{0,20}([eE][+-]?[0-9]{1,3})?", fullmatch=True),
)
ODD = st.sampled_from(
    [
        *(
            "",
            " 1",
            "1 ",
            '"2"',
            "nan",
            "NaN",
            "inf",
            "-Infinity",
            "NA",
            "null",
            "true",
            "1_0",
            "0x10",
            "#c",
            "x",
        ),
        *(
            "9007199254740993",
            "1e400",
            "-",
            "+",
            ".",
            "e5",
            "1e",
            "--1",
            "2024-05-01T10:00:00Z",
            "\u0661",
            "\r",
        ),
    ]
)


@st.composite
def files(draw: st.DrawFn) -> bytes:
    """A file whose rows are plain numbers up to some row, and perhaps something else there."""
    width, end = draw(st.integers(1, 3)), draw(st.sampled_from(["\n", "\r\n", "\r"]))
    rows = draw(st.lists(st.lists(PLAIN, min_size=width, max_size=width), max_size=8))
    odd = draw(st.lists(st.lists(st.one_of(PLAIN, ODD), min_size=0, max_size=3), max_size=2))
    names = ["time", "x", "y"][:width]
    delimiter = draw(st.sampled_from([",", ";", "\t"]))
    text = end.join(delimiter.join(row) for row in [names, *rows, *odd, *rows[:1]])
    return draw(st.sampled_from([b"", b"\xef\xbb\xbf"])) + (text + draw(st.sampled_from(["", end]))).encode()


def outcome(path: Path) -> Any:
    """Return the columns as they were read, to the bit, or the error."""
    try:
        (table,) = open_csv(str(path)).tables
        columns = table.load(table.fields)
    except rtamt.TraceError as error:
        return str(error), error.variable
    missing = [np.ma.getmaskarray(column).tolist() for column in columns]
    return [(column.dtype, np.ma.getdata(column).tobytes()) for column in columns], missing


@contextmanager
def reading(size: int, least: int) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(csv_arrow, "_SIZE", size)
        patch.setattr(csv_arrow, "_WORTH", least)
        yield


@given(files(), st.integers(1, 60))
@example(b"time,x\n0,1\n1,\n", 3)
@example(b"time,x\n0,9007199254740993\n1,0.5\n", 3)
@example(b"x\n1\n\n2\n", 60)
@example(b"x\n\n1\n", 60)
@example(b"x\r\n1\r\n\r\n", 60)
@example(b"time,x\n\n0,1\n\n", 60)
def test_law_pyarrow_reads_what_numpy_reads(tmp_path_factory, text, size):
    path = tmp_path_factory.getbasetemp() / "law.csv"
    path.write_bytes(text)
    with reading(size, least=0):
        found = outcome(path)
    with reading(size, least=len(text) + 1):
        assert found == outcome(path)


@given(st.lists(st.tuples(st.integers(0, 10**9), st.floats(-1e15, 1e15)), min_size=1, max_size=9))
def test_law_plain_files_are_read_by_pyarrow_to_their_end(tmp_path_factory, rows):
    path = tmp_path_factory.getbasetemp() / "plain.csv"
    path.write_text("time,x\n" + "".join(f"{t},{x!r}\n" for t, x in rows), encoding="utf-8")
    header = Header(str(path), ("time", "x"), ",", 1)
    with reading(16, least=0):
        found = list(csv_arrow.plain_blocks(str(path), header, [Column("x", 1)]))
    assert sum(block.lines for block in found) == len(rows)
    assert found[-1].end == path.stat().st_size
    assert np.concatenate([part[0] for block in found for part in block.parts]).tolist() == [
        x for _, x in rows
    ]


def test_columns_that_are_not_read_may_hold_text(tmp_path):
    path = tmp_path / "modes.csv"
    path.write_text(
        "time,mode,x\n" + "".join(f"{t},{'höhe' if t % 2 else ''},{t}\n" for t in range(9)), encoding="utf-8"
    )
    header = Header(str(path), ("time", "mode", "x"), ",", 1)
    with reading(16, least=0):
        found = list(csv_arrow.plain_blocks(str(path), header, [Column("x", 2)]))
    assert sum(block.lines for block in found) == 9
    assert found[-1].end == path.stat().st_size


@pytest.mark.parametrize("cell", ['"a,b"', '"a', "#", "\r", "a,b", "h\xf6he"])
def test_rows_that_pyarrow_reads_differently_are_not_left_to_it(tmp_path, cell):
    path = tmp_path / "odd.csv"
    path.write_bytes(f"time,mode,x\n0,a,1\n1,{cell},2\n2,b,3\n".encode("latin-1"))
    header = Header(str(path), ("time", "mode", "x"), ",", 1)
    with reading(8, least=0):
        found = list(csv_arrow.plain_blocks(str(path), header, [Column("x", 2)]))
    assert [block.lines for block in found] == [1]
