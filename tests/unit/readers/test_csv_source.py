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
