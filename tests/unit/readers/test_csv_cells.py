"""CSV columns as a trace: exact integers, dates, empty cells, and what is said of the rest."""

import numpy as np
import pytest

import rtamt
from rtamt.readers import csv as csv_module


@pytest.fixture
def read(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def read(content, **options):
        (tmp_path / "log.csv").write_text(content, encoding="utf-8")
        return rtamt.read("log.csv", **options)

    return read


@pytest.mark.parametrize("block", [1, 2, 65_536])
def test_every_signal_has_the_samples_that_its_cells_hold(read, monkeypatch, block):
    monkeypatch.setattr(csv_module, "BLOCK", block)
    trace = read("time,x,y\n0,5,\n0.5, ,1\n1,inf,\n")
    np.testing.assert_array_equal(trace["x"].times, [0, 1])
    np.testing.assert_array_equal(trace["x"].values, [5, np.inf])
    np.testing.assert_array_equal(trace["y"].times, [0.5])


@pytest.mark.parametrize("block", [1, 65_536])
def test_integers_that_a_double_cannot_hold_are_exact(read, monkeypatch, block):
    monkeypatch.setattr(csv_module, "BLOCK", block)
    trace = read("time,x\n7,1\n1700000000000000001,2\n1700000000000000003,\n", units={"time": "ns"})
    np.testing.assert_array_equal(trace["x"].times, np.array([7, 1700000000000000001]))
    assert trace["x"].times.dtype == "m8[ns]"


def test_dates_keep_their_nanoseconds(read):
    trace = read("time,x\n2026-01-01T00:00:00.000000001,1\n2026-01-02,2\n")
    np.testing.assert_array_equal(
        trace["x"].times, np.array(["2026-01-01T00:00:00.000000001", "2026-01-02"], "M8[ns]")
    )


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("time,x\n0,5\n1,abc\n", "log.csv, line 3: 'x' is 'abc', expected a number"),
        ("time,x\n0,5\n1,1_000\n", "log.csv, line 3: 'x' is '1_000', expected a number"),
        (
            "time,x\n0,5\n1,nan\n",
            "log.csv, line 3: 'x' is NaN: fill the gap, or leave such samples out with skip_nan=, "
            "on the command line --skip-nan",
        ),
        ("time,x\n0,5\n1\n", "log.csv, line 3: 1 value, but 2 columns (time, x)"),
        (
            "time,x\n2026-01-01,5\n17,5\n",
            "log.csv, line 3: 'time' is '17', expected a date such as 2026-05-01T12:00:00.5, like those before",
        ),
        (
            "time,x\n2026-01-01T00:00Z,5\n2026-01-02T00:00,5\n",
            "log.csv, line 3: 'time' is '2026-01-02T00:00', with no time zone, and those before have one; "
            "use one way for all",
        ),
        (
            "time,x\n2026-01-01,5\n2026-02-30,5\n",
            "log.csv, line 3: 'time' is '2026-02-30', which is no date of the calendar",
        ),
        (
            "time,x\n1500-01-01,5\n",
            "log.csv, line 2: 'time' is '1500-01-01', a year that nanoseconds since 1970 cannot reach",
        ),
    ],
)
def test_messages(read, content, message):
    with pytest.raises(rtamt.TraceError) as info:
        read(content, columns=["x"])
    assert str(info.value) == message
