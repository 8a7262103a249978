"""Values of enumerations in files: text columns, value tables and constants, found by the names of members."""

from __future__ import annotations

from math import inf

import asammdf
import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from asammdf.blocks.conversion_utils import from_dict

import rtamt
from rtamt.cli import main
from tests.unit.readers.bags import SECOND, Bag

TEXT = "enum Mode { MANUAL, AUTO = 4, RTL } input Mode mode  mode == AUTO"
SPEC = rtamt.parse(TEXT)
COLUMN = ["MANUAL", "AUTO", "RTL"]
IS_AUTO = [-inf, inf, -inf]


def values(source, **more):
    return SPEC.evaluate(
        rtamt.read(source, columns=["mode"], types=SPEC.types, **more)
    ).signal.values.tolist()


@pytest.mark.parametrize(
    "source",
    [
        {"time": [0, 1, 2], "mode": COLUMN},
        {"time": [0, 1, 2], "mode": np.array(COLUMN)},
        {"time": [0, 1, 2], "mode": [0, 4, 5]},
        pd.DataFrame({"time": [0, 1, 2], "mode": COLUMN}),
        pd.DataFrame({"time": [0, 1, 2], "mode": pd.Categorical(COLUMN)}),
        pl.DataFrame({"time": [0, 1, 2], "mode": COLUMN}),
        pa.table({"time": [0, 1, 2], "mode": pa.array(COLUMN).dictionary_encode()}),
    ],
)
def test_text_columns_in_memory(source):
    assert values(source) == IS_AUTO


@pytest.mark.parametrize("count", [1, 3, 12, 13, 40])
@pytest.mark.parametrize("column", [list, np.array, lambda names: np.array(names, object)])
def test_columns_of_names_mean_their_codes(count, column):
    members = [f"M{7 * k}" for k in range(count)]
    spec = rtamt.parse(
        f"enum E {{ {', '.join(f'{m} = {k - 2}' for k, m in enumerate(members))} }} E e  e == {members[-1]}"
    )
    names = [members[(k * k) % count] for k in range(50)]
    codes = [members.index(name) - 2 for name in names]
    found = [spec.evaluate({"e": each}).signal.values.tolist() for each in (column(names), codes)]
    assert found[0] == found[1]
    with pytest.raises(rtamt.TraceError, match=r"^'e' is 'M' at sample 50, which is no member of E"):
        spec.evaluate({"e": column([*names, "M"])})


def test_frames_are_evaluated_without_reading_them_before():
    for frame in (pd.DataFrame({"mode": COLUMN}), pl.DataFrame({"mode": COLUMN})):
        assert SPEC.evaluate(frame).signal.values.tolist() == IS_AUTO


def test_text_columns_of_csv_and_parquet(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("time,mode\n0,MANUAL\n1, AUTO \n2,5\n")
    assert values(path) == IS_AUTO
    assert rtamt.read(path, types=SPEC.types).names == ("mode",)
    chunks = rtamt.scan(path, columns=["mode"], types=SPEC.types)
    assert rtamt.check_stream(SPEC, chunks).robustness == -inf
    pq.write_table(pa.table({"time": [0, 1, 2], "mode": COLUMN}), tmp_path / "log.parquet")
    assert values(tmp_path / "log.parquet") == IS_AUTO


def test_an_empty_cell_is_a_missing_member(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("time,mode\n0,MANUAL\n1,\n2,AUTO\n")
    trace = rtamt.read(path, columns=["mode"], types=SPEC.types)
    assert (trace["mode"].times.tolist(), trace["mode"].values.tolist()) == ([0, 2], [0, 4])


def test_an_unknown_name_in_a_file_is_an_error_with_its_line(tmp_path, capsys):
    path, text = tmp_path / "log.csv", tmp_path / "mode.stl"
    path.write_text("time,mode\n0,MANUAL\n1,Auto\n")
    text.write_text(TEXT)
    with pytest.raises(rtamt.TraceError) as info:
        values(path)
    assert (
        str(info.value)
        == f"{path}, line 3: 'mode' is 'Auto', which is no member of Mode; did you mean 'AUTO'?"
    )
    assert main(["check", str(text), str(path)]) == 2
    assert "line 3: 'mode' is 'Auto'" in capsys.readouterr().err
    with pytest.raises(rtamt.TraceError) as info:
        values({"mode": ["AUTO", "Hover"]})
    assert str(info.value) == (
        "'mode' is 'Hover' at sample 1 of a dict, which is no member of Mode; its members are MANUAL, AUTO, RTL"
    )


def test_the_value_table_of_a_measurement_is_read_by_name(tmp_path):
    table = {f"val_{i}": i for i in range(3)} | {f"text_{i}": name for i, name in enumerate(COLUMN)}
    with asammdf.MDF(version="4.10") as file:
        raw = np.array([0, 1, 2], dtype="u1")
        file.append([asammdf.Signal(raw, np.arange(3.0), name="mode", conversion=table)])
        file.save(tmp_path / "log.mf4")
    assert values(tmp_path / "log.mf4") == IS_AUTO
    assert rtamt.read(tmp_path / "log.mf4")["mode"].values.tolist() == [0, 1, 2]


def test_a_number_without_a_text_in_the_value_table_is_no_member(tmp_path):
    """The file has the number 4 for no mode; AUTO, whose code is 4 in the specification, is 1 in the file."""
    table = {f"val_{i}": i for i in range(3)} | {f"text_{i}": name for i, name in enumerate(COLUMN)}
    table["default_addr"] = {"a": 1.0, "b": 0.0}
    with asammdf.MDF(version="4.10") as file:
        raw = np.array([4, 4, 4], dtype="u1")
        file.append([asammdf.Signal(raw, np.arange(3.0), name="mode", conversion=from_dict(table))])
        file.save(tmp_path / "log.mf4")
    assert values(tmp_path / "log.mf4") == [-inf, -inf, -inf]


def test_constants_of_a_message_are_read_by_name(tmp_path):
    """Members have other codes than the constants UNKNOWN=0, SATISFIED=1, VIOLATED=2 of the message."""
    with Bag(tmp_path, "mcap") as bag:
        kind = "rtamt_msgs/msg/Verdict"
        for at in range(4):
            message = bag.store.types[kind](header=bag.header(at * SECOND), name="", verdict=at, horizon=0.0)
            bag.write("/verdict", kind, at * SECOND, message)
    spec = rtamt.parse("enum V { VIOLATED, SATISFIED = 2, } V v  v == VIOLATED; v == SATISFIED")
    trace = rtamt.read(bag.path, columns=["v"], names={"v": "/verdict.verdict"}, types=spec.types)
    # 0 and 3 are no constants of these names: they equal no member, also where a member has that code.
    assert trace["v"].values.tolist() == [3, 2, 0, 3]


LINEAR = """
enum Mode { MANUAL, AUTO = 2, RTL = 4 }
input Mode mode
input bool armed
input float x
require A: always(mode != AUTO)
require B: always(armed or x <= 4)
"""
STEPS = "time,mode,armed,x\n0,MANUAL,true,8\n1,RTL,false,4\n2,MANUAL,false,0\n"


def test_linear_resampling_holds_members_of_enumerations_and_booleans(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text(STEPS, encoding="utf-8")
    spec = rtamt.parse(LINEAR, period="500ms")
    trace = rtamt.read(path, types=spec.types).resample("500ms", how="linear")
    assert trace["mode"].values.tolist() == [0, 0, 4, 4, 0]
    assert trace["armed"].values.tolist() == [1, 1, 0, 0, 0]
    assert trace["x"].values.tolist() == [8, 6, 4, 2, 0]
    assert spec.evaluate(trace).satisfied


@pytest.mark.parametrize("early", [(), ("--early",)])
def test_commands_hold_them_in_linear_resampling(tmp_path, capsys, early):
    log, spec = tmp_path / "log.csv", tmp_path / "spec.stl"
    log.write_text(STEPS, encoding="utf-8")
    spec.write_text(LINEAR, encoding="utf-8")
    assert main(["check", str(spec), str(log), "--resample", "500ms", "--how", "linear", *early]) == 0
    assert "2 satisfied" in capsys.readouterr().out
