"""Samples at which no member of a group is present, however the recording is given."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pandas as pd
import pytest

import rtamt
from rtamt.cli import main

if TYPE_CHECKING:
    from pathlib import Path

INF = float("inf")
GROUP = 'group cars = "car_*" { float x }\n'


def given(samples: list[float | None], folder: Path) -> dict[str, object]:
    times = [float(i) for i in range(len(samples))]
    file = folder / "drive.csv"
    cells = ("" if value is None else value for value in samples)
    file.write_text("time,car_1.x\n" + "".join(f"{i},{cell}\n" for i, cell in enumerate(cells)))
    frame = pd.DataFrame({"time": times, "car_1.x": pd.array(samples, dtype="Float64")})
    gaps = pd.DataFrame({"time": times, "car_1.x": pd.Series(samples, dtype="float64")})
    return {
        "dict": {"time": times, "car_1.x": samples},
        "frame": frame,
        "read frame": rtamt.read(frame),
        "read NaN": rtamt.read(gaps, skip_nan=["car_1.x"]),
        "file": rtamt.read(file),
    }


def at_seconds(signal: rtamt.Signal, n: int) -> list[float]:
    places = signal.times.searchsorted(list(range(n)), "right") - 1
    return [float(value) for value in signal.values[places]]


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize(
    ("samples", "forall", "exists"),
    [
        ([6.0, None, 3.0], [1, INF, -2], [1, -INF, -2]),
        ([None, None, 6.0], [INF, INF, 1], [-INF, -INF, 1]),
        ([6.0, 7.0, None], [1, 2, INF], [1, 2, -INF]),
        ([None, None], [INF, INF], [-INF, -INF]),
    ],
)
def test_a_row_without_any_member_is_a_sample_without_members(
    samples: list[float | None], forall: list[float], exists: list[float], time: str, tmp_path: Path
) -> None:
    for source, data in given(samples, tmp_path).items():
        for kind, expected in (("forall", forall), ("exists", exists)):
            found = rtamt.parse(f"{GROUP}{kind} v in cars: v.x > 5").evaluate(data, time=time)
            assert at_seconds(found.signal, len(samples)) == expected, (source, kind)


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("window", ["[1,3]", "(0,3]", "(0,4)"])
def test_a_mean_behind_the_first_sample_of_a_member_is_its_first_value(window: str, backend: str) -> None:
    parsed = rtamt.parse(f"{GROUP}float y\nexists v in cars: mean{window}(v.x) < y", backend=backend)
    data = {"y": [0.0, 0.0, 0.0], "car_1.x": [None, -1.5, 2.0]}
    assert parsed.evaluate(data).signal.values.tolist() == [-INF, 1.5, 1.5]


def test_a_chunk_of_a_file_may_have_rows_without_any_member(tmp_path: Path) -> None:
    for source, data in given([6.0, None, 3.0], tmp_path).items():
        if source != "read NaN":
            monitor = rtamt.parse(f"{GROUP}forall v in cars: v.x > 5").monitor()
            assert monitor.update_many(data).values.tolist() == [1, INF, -2], source


def test_a_slice_of_a_trace_keeps_rows_without_any_member(tmp_path: Path) -> None:
    trace = given([6.0, None, None, 3.0], tmp_path)["file"]
    assert isinstance(trace, rtamt.Trace)
    part = rtamt.parse(f"{GROUP}forall v in cars: v.x > 5").evaluate(trace[1:2])
    assert part.signal.times.tolist() == [1, 2]


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_file_in_which_no_member_is_ever_present_is_no_internal_error(
    time: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "rule.stl").write_text(f"{GROUP}require A: always exists v in cars: v.x > 5\n")
    (tmp_path / "never.csv").write_text("time,ego.x,car_1.x\n0,0,\n1,0,\n")
    arguments = ["check", str(tmp_path / "rule.stl"), str(tmp_path / "never.csv"), "--time", time]
    assert main(arguments) == 1
    assert "-inf" in capsys.readouterr().out


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_nan_of_pandas_in_a_field_of_a_group_names_how_to_make_the_member_absent(time: str) -> None:
    frame = pd.DataFrame({"time": [0.0, 1.0], "car_1.x": [6.0, float("nan")]})
    expected = (
        "'car_1.x' is NaN at sample 1, time 1 s: fill the gap or leave the sample out; where the member is absent, "
        "give None, a nullable dtype such as pandas' Float64, or rtamt.read(data, skip_nan=['car_1.x'])"
    )
    spec = rtamt.parse(f"{GROUP}forall v in cars: v.x > 5")
    with pytest.raises(rtamt.TraceError) as info:
        spec.evaluate(frame, time=time)
    assert str(info.value) == expected
    with pytest.raises(rtamt.TraceError) as info:
        spec.monitor().update_many(frame)
    assert str(info.value) == expected


@pytest.mark.parametrize("last", ["1", ""], ids=["present", "absent"])
@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("0,1,1\n1,2,1\n1,-1,1\n2,{}", "'car_1.p' has two samples at 1 s (sample 2 and the one before"),
        ("0,1,1\n1,,1\n1,-1,1\n2,{}", "'car_1.p' has two samples at 1 s (sample 2 and the one before"),
        (
            "0,1,1\n2,-1,1\n1,2,1\n3,{}",
            "the time of 'car_1.p' does not increase at sample 2: 1 s comes after 2 s",
        ),
    ],
    ids=["twice", "twice, once absent", "backwards"],
)
def test_two_samples_of_a_member_at_one_time_hid_a_violation(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], rows: str, message: str, last: str
) -> None:
    text, lines = 'group cars = "car_*"\nalways forall c in cars: c.p > 0\n', rows.format(last)
    path = tmp_path / "twice.csv"
    path.write_text(f"time,car_1.p,x\n{lines},1\n")
    assert main(["check", text, str(path), "--time", "dense"]) == 2
    assert message in capsys.readouterr().err
    cells = [line.split(",")[:2] for line in lines.splitlines()]
    data = {
        "time": [float(time) for time, _ in cells],
        "car_1.p": [float(value) if value else None for _, value in cells],
    }
    with pytest.raises(rtamt.TraceError, match=re.escape(message)):
        rtamt.parse(text).evaluate(data, time="dense")
