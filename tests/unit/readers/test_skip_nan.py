"""NaN in recordings: an error that says how to mend it, or, openly, no sample."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rtamt
from rtamt.readers import csv
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


@pytest.mark.parametrize("unit", ["s", "ms", "dates"])
@given(
    gaps=st.lists(st.booleans(), min_size=1, max_size=12),
    chunk=st.integers(1, 4),
    periods=st.integers(1, 5),
)
def test_a_value_is_held_for_as_long_as_is_said_whatever_the_chunks(
    tmp_path_factory, unit, gaps, chunk, periods
):
    path = tmp_path_factory.getbasetemp() / f"held_{unit}.csv"
    timestamps = {
        "s": [repr(i / 10) for i in range(len(gaps))],
        "ms": [str(1_700_000_000_000 + i * 100) for i in range(len(gaps))],
        "dates": [f"2026-01-01T00:00:{i // 10:02d}.{i % 10}" for i in range(len(gaps))],
    }[unit]
    cells = ["nan" if gap and i % 2 else "" if gap else str(i) for i, gap in enumerate(gaps)]
    path.write_text("time,x\n" + "".join(f"{t},{x}\n" for t, x in zip(timestamps, cells, strict=True)))
    options = {"columns": ["x"], "skip_nan": ["x"], "hold_for": f"{periods * 100}ms"}
    if unit == "ms":
        options["time_unit"] = "ms"
    expected, last, too_old = [], None, False
    for i, gap in enumerate(gaps):
        last = last if gap else i
        too_old |= last is not None and i - last > periods
        expected += [] if last is None else [float(last)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(csv, "BLOCK", chunk)
        if too_old:
            for read in (lambda: rtamt.read(path, **options), lambda: list(rtamt.scan(path, **options))):
                with pytest.raises(rtamt.TraceError, match=r"^'x' of .* has no sample from .* value is held"):
                    read()
        else:
            parts = list(rtamt.scan(path, **options))
            whole = rtamt.read(path, **options)
            assert whole["x"].values.tolist() == expected
            assert [value for part in parts for value in part["x"].values] == expected
            assert parts[-1].losses == whole.losses
            held = sum(gaps) - (len(gaps) - len(expected))
            assert any(f"held: {held} sample" in loss for loss in whole.losses) == (held > 0)


def test_a_value_that_is_held_for_too_long_is_an_error_in_both_time_domains(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("time,x\n0,1\n1,nan\n2,nan\n3,5\n")
    for time in ("discrete", "dense"):
        spec = rtamt.parse("always(x >= 2)", time=time)
        trace = rtamt.read(path, skip_nan=["x"], hold_for=2)
        assert spec.evaluate(trace).robustness == -1
        assert rtamt.first_violation(spec.evaluate(trace)) == 0
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(path, skip_nan=["x"], hold_for="1s")
    assert str(error.value) == (
        f"'x' of {path} has no sample from 0 s to 2 s (sample 2), longer than the 1 s for which a value is held: "
        f"fill the gap, or hold it for longer (hold_for=, on the command line --hold-for)"
    )
    with pytest.raises(
        rtamt.UsageError, match="the longest time for which a value is held is 0; it must be positive"
    ):
        rtamt.read(path, hold_for=0)
    with pytest.raises(rtamt.TraceError, match="which takes timestamps"):
        rtamt.read({"x": [1, None]}, hold_for=1)
