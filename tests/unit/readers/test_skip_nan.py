"""NaN in recordings: an error that says how to mend it, or, openly, no sample."""

import numpy as np
import pytest

import rtamt
from tests.unit.readers.test_formats import ulog

NAN = float("nan")


@pytest.fixture
def flight(tmp_path):
    """A flight log whose set-point is NaN where there is none."""
    rows = [(1_000_000, 1.0), (1_500_000, NAN), (2_000_000, NAN), (2_500_000, 4.0)]
    heights = [(1_000_000, 1.0), (2_000_000, 2.0), (2_600_000, 3.5)]
    topics = [("setpoint", 0, "float x", rows), ("height", 0, "float x", heights)]
    return ulog(tmp_path / "flight.ulg", topics)


def test_a_nan_of_a_flight_log_is_an_error_where_a_formula_reads_it_and_only_there(flight):
    trace = rtamt.read(flight)
    assert rtamt.parse("always(height.x >= 1)").evaluate(trace, time="dense").robustness == 0
    with pytest.raises(
        rtamt.TraceError, match=r"^'setpoint\.x' is NaN at sample 1, time 1\.5 s: fill the gap"
    ):
        rtamt.parse("always(setpoint.x >= 1)").evaluate(trace, time="dense")


def test_nan_that_is_skipped_is_no_sample_and_told(flight):
    trace = rtamt.read(flight, skip_nan=["setpoint.x"])
    assert trace["setpoint.x"].times.tolist() == [1.0, 2.5]
    assert trace.notes == ("left out, NaN: 2 samples of setpoint.x, the first at 1.5 s",)
    result = rtamt.parse("always(abs(setpoint.x - height.x) <= 1)").evaluate(trace, time="dense")
    assert result.robustness == -1  # from 2.5 s to 2.6 s: 4 - 2


@pytest.mark.parametrize("before", [0, 5000], ids=["first lines", "a later block"])
def test_text_with_nan(tmp_path, before):
    path = tmp_path / "log.csv"
    rows = "".join(f"{i},1,1\n" for i in range(before))
    path.write_text(f"t,x,y\n{rows}{before},nan,1\n{before + 1},NaN,2\n{before + 2},5,3\n")
    trace = rtamt.read(path, skip_nan=["x"])
    assert (len(trace["x"]), len(trace["y"])) == (before + 1, before + 3)
    assert f"left out, NaN: 2 samples of x, the first at {before} s" in trace.notes
    with pytest.raises(rtamt.TraceError, match=rf"log\.csv, line {before + 2}: 'x' is NaN: fill the gap, or"):
        rtamt.read(path, columns=["x"])
    path.write_text("t,x\n0,1\n1,nan\n2,nan\n3,5\n")
    chunks = rtamt.scan(path, skip_nan=["x"])
    found = rtamt.check_stream(rtamt.parse("always(x >= 2)"), chunks, time="dense")
    assert (found.robustness, found.first_violation) == (-1, 0)


def test_names_and_nulls_beside_nan():
    data = {"time": [0, 1, 2, 3], "raw": np.ma.masked_array([5, NAN, NAN, 4.0], [False, True, False, False])}
    trace = rtamt.read(data, names={"v": "raw"}, skip_nan=["v"])
    assert trace["v"].times.tolist() == [0, 3]


@pytest.mark.parametrize(
    ("skip", "error", "message"),
    [
        ("x", rtamt.UsageError, "skip_nan is the text 'x'; give a list of names, such as ['x']"),
        (
            ["speeed"],
            rtamt.TraceError,
            "NaN is to be skipped in 'speeed', which is none of the signals that are read of a dict; "
            "did you mean 'speed'?",
        ),
    ],
)
def test_messages(skip, error, message):
    with pytest.raises(error) as failure:
        rtamt.read({"time": [0, 1], "speed": [1, 2]}, skip_nan=skip)
    assert str(failure.value) == message
