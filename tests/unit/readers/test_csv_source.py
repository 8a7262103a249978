"""CSV files block by block: where blocks end, and where plain numbers do, changes nothing."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rtamt
from rtamt.readers import csv

CELLS = st.sampled_from(["1", "2", "0.5", "", '"3"', " 4 ", "1e3", "inf", "9007199254740993"])


@given(st.lists(st.tuples(CELLS, CELLS), min_size=1, max_size=12), st.integers(1, 5))
def test_law_blocks_change_nothing(tmp_path_factory, rows, size):
    path = tmp_path_factory.mktemp("law") / "log.csv"
    lines = [f"{i},{x},{y}" for i, (x, y) in enumerate(rows)]
    path.write_text("\n".join(["time,x,y", *lines, ""]), encoding="utf-8")
    whole = rtamt.read(path)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(csv, "BLOCK", size)
        parts = rtamt.read(path)
        chunks = list(rtamt.scan(path))
    for name, column in (("x", 0), ("y", 1)):
        expected = [float(row[column].strip(' "')) for row in rows if row[column]]
        timestamps = [i for i, row in enumerate(rows) if row[column]]
        for trace in (whole, parts):
            assert trace[name].values.tolist() == expected
            assert trace[name].times.tolist() == timestamps
        assert np.concatenate([chunk[name].values for chunk in chunks]).tolist() == expected


def test_dates_after_numbers_are_named_whatever_the_block(tmp_path, monkeypatch):
    monkeypatch.setattr(csv, "BLOCK", 1)
    (tmp_path / "log.csv").write_text("time,x\n0,1\n2024-05-01,2\n")
    with pytest.raises(
        rtamt.TraceError, match=r"log.csv, line 3: 'time' is '2024-05-01', expected a number$"
    ):
        rtamt.read(tmp_path / "log.csv")


def test_a_column_of_dates_is_found_by_its_cells(tmp_path):
    (tmp_path / "log.csv").write_text("when,x,note\n2024-05-01T10:00:00Z,1,a\n2024-05-01T10:00:01Z,2,b\n")
    trace = rtamt.read(tmp_path / "log.csv")
    assert trace.notes == ("time is 'when', the one column of dates", "left out, not numbers: note")
    assert str(trace.end) == "2024-05-01T10:00:01.000000000"


@pytest.mark.parametrize("index", [("0.0", "0.5"), ("0", "500"), ("1", "3")])
def test_a_first_column_without_a_name_may_hold_the_timestamps(tmp_path, index):
    path = tmp_path / "log.csv"
    path.write_text(f",x\n{index[0]},1\n{index[1]},2\n")
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(path)
    assert str(error.value) == (
        f"{path} has a column that may hold the timestamps: one without a name; name it, or choose one with time=, or "
        f"on the command line --time-column ('' for none)"
    )
    assert rtamt.read(path, time="")["x"].times.tolist() == [0, 1]


@pytest.mark.parametrize("cells", [("0", "1"), ("7", "8"), ("a", "b"), ("2", "1"), ("", "")])
def test_a_first_column_without_a_name_may_number_the_rows(tmp_path, cells):
    path = tmp_path / "log.csv"
    path.write_text(f",x\n{cells[0]},1\n{cells[1]},2\n")
    assert rtamt.read(path, columns=["x"])["x"].times.tolist() == [0, 1]


def test_a_column_called_time_comes_before_one_without_a_name(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text(",time,x\n0,0,1\n10,0.5,2\n")
    assert rtamt.read(path, columns=["x"])["x"].times.tolist() == [0, 0.5]


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-be", "utf-16-le"])
def test_a_file_in_utf_16_is_an_error_that_says_so(tmp_path, encoding):
    path = tmp_path / "log.csv"
    path.write_bytes("time,x\n0,1\n".encode(encoding))
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(path)
    assert str(error.value) == (
        f"'{path}' is not UTF-8 text; save it as CSV in UTF-8 (spreadsheets offer this under 'save as')"
    )
