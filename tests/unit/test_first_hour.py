"""What new users try in their first hour: names as logs write them, text Booleans, extra columns, misspelt options."""

from __future__ import annotations

import json
import os
import runpy
import sqlite3
import struct
import subprocess
import sys
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import pytest

import rtamt
from rtamt.cli import main
from rtamt.signals.time_columns import is_stamps

ODD = ["trajectory_setpoint.position[2]", "a.b", "engine speed", 'the "fast" one', "/ns/x", "Ü", "3d"]


def quoted(name: str) -> str:
    return '"' + name.replace('"', '""') + '"'


@pytest.mark.parametrize("name", ODD)
@pytest.mark.parametrize("declared", ["", "input float {} [m/s]; "])
def test_a_quoted_name_works_wherever_a_name_does(name, declared, tmp_path, capsys, monkeypatch):
    text = f"{declared.format(quoted(name))}low = {quoted(name)} >= 3; require R: always[0:1](low)"
    spec = rtamt.parse(text)
    assert spec.input_names == (name,)
    data = {"time": [0, 1, 2], name: [5, 4, 2]}
    result = spec.evaluate(data)
    assert (result.robustness, result[f"{quoted(name)} >= 3"].values.tolist()) == (1.0, [2.0, 1.0, -1.0])
    assert spec.monitor().update(0, **{name: 5}) is None
    assert spec.monitor(time="dense").update_many({name: ([0.0, 2.0], [5, 4])}).values.tolist() == [2.0, 1.0]
    assert rtamt.parse(str(spec)).evaluate(data).robustness == 1.0
    assert name in str(result.explain()).replace('""', '"')
    (tmp_path / "log.csv").write_text(f"time,{quoted(name)},v\n0,5,5\n1,4,4\n2,2,2\n", encoding="utf-8")
    (tmp_path / "r.stl").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert main(["check", "r.stl", "log.csv", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["robustness"] == 1.0
    assert main(["check", "r.stl", "log.csv", "--name", f"{name}=v", "--quiet"]) == 0


def test_declared_units_are_shown_and_data_is_converted_to_them():
    spec = rtamt.parse(
        'input float "a.b[0]" [m/s]; float y [V]; const float limit = 2 [m/s]; "a.b[0]" >= limit + y'
    )
    assert [(d.name, d.unit) for d in spec.document.declarations] == [
        ("a.b[0]", "m/s"),
        ("y", "V"),
        ("limit", "m/s"),
    ]
    trace = rtamt.read({"time": [0, 1], "a.b[0]": [1, 2], "y [mV]": [0, 0]})
    assert spec.evaluate(trace).trace.units == {"a.b[0]": "m/s", "y": "V"}
    assert rtamt.evaluate_all([spec], trace)[0].trace.units == {"a.b[0]": "m/s", "y": "V"}


def test_quoted_names_in_bounds_and_topics():
    spec = rtamt.parse(
        'float "a b"; const float "my bound" = 2; @ topic("a b", /x/y) always[0:"my bound"]("a b" > 0)'
    )
    assert (spec.horizon, dict(spec.document.topics)) == (2, {"a b": "/x/y"})
    assert rtamt.parse(str(spec.formula)).horizon == 2


@pytest.mark.parametrize(("bound", "seconds"), [("10min", 600), ("1h", 3600), ("0.5 h", 1800)])
def test_minutes_and_hours_are_units(bound, seconds):
    spec = rtamt.parse(f"always[0:{bound}](x >= 3)", period=1)
    assert spec.horizon == seconds
    assert str(rtamt.parse(str(spec), period=1)) == str(spec)


def test_a_column_in_hours_is_exact_and_t_min_is_a_minimum():
    assert rtamt.read({"t [h]": [0, 0.1, 1], "x": [1, 2, 3]})["x"].times.tolist() == [0.0, 360.0, 3600.0]
    assert rtamt.parse("x").evaluate(
        {"time": [0, 1, 2], "x": [1, 2, 3]}, time_unit="min"
    ).signal.times.tolist() == [0, 1, 2]
    assert not is_stamps("t_min")


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_extra_keys_are_accepted_and_a_misspelt_one_is_found(time):
    spec = rtamt.parse("always[0:1](speed >= 3)", time=time)
    data = {"time": [0.0, 1.0, 2.0], "speed": [4, 5, 6], "note": ["a", "b", "c"]}
    assert spec.evaluate(data).robustness == 1.0
    assert rtamt.check_stream(spec, [data]).robustness == 1.0
    assert len(spec.monitor(time_unit="s").update_many(data)) > 0
    data["sped"] = data.pop("speed")
    with pytest.raises(
        rtamt.TraceError, match=r"the data has no 'speed'; did you mean 'sped'\? \(signals: sped, "
    ):
        spec.evaluate(data)


def test_a_misspelt_key_of_a_dense_chunk_is_an_error_though_a_variable_may_be_left_out():
    monitor = rtamt.parse("x + y >= 3").monitor(time="dense")
    with pytest.raises(rtamt.TraceError, match=r"^the formula has no variable 'yy'; did you mean 'y'\?"):
        monitor.update_many({"x": ([0.0], [1.0]), "yy": ([0.0], [1.0])})


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_the_name_of_a_file_is_no_data_and_the_error_names_read(time, tmp_path):
    with pytest.raises(
        rtamt.TraceError,
        match=r"^expected data, got 'file.csv'; to read a file write rtamt.read\('file.csv'\)",
    ):
        rtamt.parse("x >= 3").evaluate("file.csv", time=time)
    with pytest.raises(rtamt.TraceError, match=r"to read a file write rtamt.read\("):
        rtamt.parse("x >= 3").evaluate(tmp_path / "file.csv", time=time)


def test_elements_of_arrays_are_columns_and_their_index_is_no_unit(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("time,q[0],q[1],ratio [1]\n0,1,2,3\n")
    assert rtamt.read(path).names == ("q[0]", "q[1]", "ratio")
    assert rtamt.read(path).units == {"ratio": "1"}


def test_text_booleans_in_csv_are_one_and_zero(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("time,on,x\n0,true,1\n1,FALSE,2\n2,,3\n3,True,4\n")
    assert rtamt.read(path)["on"].values.tolist() == [1.0, 0.0, 1.0]
    path.write_text("time,on\n0,true\n1,yes\n")
    with pytest.raises(rtamt.TraceError, match="line 3: 'on' is 'yes', expected true or false"):
        rtamt.read(path, columns=["on"])


@pytest.mark.parametrize("first", ["0,1,2", "2026-05-01T12:00:00,1,2", "0,true,2"])
def test_a_csv_without_a_header_is_named_as_such(first, tmp_path):
    path = tmp_path / "log.csv"
    path.write_text(f"{first}\n1,2,3\n")
    with pytest.raises(
        rtamt.TraceError, match=r"line 1: expected a row of column names, .*: put the names above it"
    ):
        rtamt.read(path)


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_timestamps_that_were_never_set(time):
    with pytest.raises(
        rtamt.TraceError, match=r"^all 3 timestamps of '\w+' are 0 s, so they were never set: "
    ):
        rtamt.parse("x >= 3").evaluate({"time": [0, 0, 0], "x": [1, 2, 3]}, time=time)


def test_a_missing_database_is_not_made_and_one_that_is_there_is_only_read(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["check", "(x >= 3)", "--sql", "sqlite:///missing.db", "--query", "select 1"]) == 2
    assert capsys.readouterr().err == "rtamt: sqlite:///missing.db: there is no file 'missing.db'\n"
    assert not (tmp_path / "missing.db").exists()
    with sqlite3.connect("a #%.db") as connection:
        connection.execute("create table log as select 0 as time, 4 as x")
    connection.close()
    assert main(["check", "(x >= 3)", "--sql", "sqlite:///a #%.db", "--query", "select * from log"]) == 0
    assert (
        main(["check", "(x >= 3)", "--sql", "sqlite:///a #%.db", "--query", "drop table log returning *"])
        == 2
    )


def test_json_messages_in_mcap_are_named(tmp_path):
    def text(value: str) -> bytes:
        return struct.pack("<I", len(value)) + value.encode()

    def record(kind: int, data: bytes) -> bytes:
        return struct.pack("<BQ", kind, len(data)) + data

    magic = b"\x89MCAP0\r\n"
    channel = struct.pack("<HH", 1, 1) + text("/pose") + text("json") + struct.pack("<I", 0)
    message = struct.pack("<HIQQ", 1, 0, 1, 1) + b'{"x": 1}'
    records = [(1, text("") + text("")), (3, b"\x01\0" + text("Pose") + text("jsonschema") + text("{}"))]
    records += [(4, channel), (5, message), (15, bytes(4)), (2, bytes(20))]
    path = tmp_path / "log.mcap"
    path.write_bytes(magic + b"".join(record(*each) for each in records) + magic)
    with pytest.raises(
        rtamt.TraceError, match=r"cannot be read: the messages on /pose are json, and only those of ROS"
    ):
        rtamt.read(path)


@pytest.mark.parametrize(
    ("argv", "sentence"),
    [
        (["check", "braking", "log.csv"], "there is no file 'braking'; did you mean braking.stl?"),
        (["check", "braking"], "there is no file 'braking'; did you mean braking.stl?"),
        (["check", "brakng.stl", "log.csv"], "there is no file 'brakng.stl'; did you mean 'braking.stl'?"),
        (["check", "braking.stl", "lag.csv"], "there is no file 'lag.csv'; did you mean 'log.csv'?"),
        (["check", "braking.stl", "log.csv", "--perod", "1"], "unknown option '--perod'; did you mean '--period'?"),
        (["check", "braking.stl", "log.csv", "--perod=1"], "unknown option '--perod'; did you mean '--period'?"),
    ],
)  # fmt: skip
def test_the_nearest_name_is_offered(argv, sentence, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "braking.stl").write_text("x >= 3")
    (tmp_path / "log.csv").write_text("time,x\n0,4\n1,4\n")
    assert main(argv) == 2
    assert capsys.readouterr().err.startswith(f"rtamt: {sentence}")
    assert main(["check", "(braking)", "log.csv"]) == 2  # a formula: the error is about the data
    assert "has no column 'braking'" in capsys.readouterr().err


def test_info_lists_a_log_by_topics_and_filters_it(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "log.csv").write_text("time,battery.voltage,battery.current,gps.lat\n0,4,1,2\n1,4,1,2\n")
    assert main(["info", "log.csv"]) == 0
    out = capsys.readouterr().out
    assert "  battery            2 signals, each 2 samples, 0 s to 1 s\n    battery.voltage\n" in out
    assert main(["info", "log.csv", "VOLT", "gps"]) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()[1:]] == [
        "battery.voltage",
        "gps.lat",
    ]
    assert main(["info", "log.csv", "batery"]) == 2
    assert capsys.readouterr().err == (
        "rtamt: no signal's name contains 'batery'; did you mean 'battery'? (topics: battery, gps)\n"
    )


def test_help_is_grouped(capsys):
    with pytest.raises(SystemExit):
        main.__globals__["parser_of"](main.__globals__["COMMANDS"]["check"]).parse_args(["--help"])
    out = capsys.readouterr().out
    assert out.index("the specification:") < out.index("reading recordings:") < out.index("output:")


@pytest.mark.parametrize("text", ["#", "≥", "≤", "≠", "∧", "∨", "¬", "→", "□", "◇", "∞", "“", "’", "{"])
def test_characters_of_other_notations_get_a_hint(text):
    with pytest.raises(rtamt.ParseError, match=rf"^unexpected character '{text}'; (write|a comment)"):
        rtamt.parse(f"x > 3 {text} y")


@pytest.mark.parametrize(
    ("first", "moment"),
    [
        ("2026-05-01T12:00:00", "2026-05-01 12:00:01 (+1 s)"),
        ("1700000000", "2023-11-14 22:13:21 (+1 s)"),
        ("5", "6 s"),
    ],
)
def test_check_shows_the_first_violation_and_epoch_times_as_dates(
    first, moment, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    second = first[:-1] + str(int(first[-1]) + 1)
    (tmp_path / "log.csv").write_text(f"time,x\n{first},4\n{second},2\n")
    assert main(["check", "always(x >= 3)", "log.csv"]) == 1
    header, row = capsys.readouterr().out.splitlines()[2:4]
    assert header.split()[-3:] == ["first", "violation", "verdict"]
    assert f"  {moment}  violated" in row
    monkeypatch.setattr("rtamt.cli.runner.LARGE", 0)  # in chunks
    assert main(["check", "always(x >= 3)", "log.csv"]) == 1
    assert capsys.readouterr().out.splitlines()[3] == row


def test_what_the_environment_sets_for_ros_is_named_in_errors(tmp_path):
    (tmp_path / "r.stl").write_text(
        "from std_msgs.msg import Float64\ninput Float64 req\n@ topic(req, /req)\nout = always[0:1](req.data >= 3)\n"
    )

    def answer(**environment: str) -> str:
        command = [sys.executable, "-m", "rtamt", "ros2", "r.stl", "--period", "1"]
        done = subprocess.run(
            command,
            cwd=tmp_path,
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 2
        return done.stderr

    assert answer(CYCLONEDDS_URI="file://no.xml") == (  # before Cyclone DDS prints a line of its own
        "rtamt: the environment variable CYCLONEDDS_URI names the configuration file 'no.xml', which does not exist; "
        "correct the path, or unset the variable\n"
    )
    (tmp_path / "bad.xml").write_text("<CycloneDDS><Domain><Generall/></Domain></CycloneDDS>")
    cause, *_, sentence = answer(CYCLONEDDS_URI="bad.xml").splitlines()  # of Cyclone DDS, and ours
    assert "Generall" in cause
    assert sentence == (
        "rtamt: cannot join DDS domain 0 (the lines above give the cause): check the environment variable "
        "CYCLONEDDS_URI, which configures the network and is 'bad.xml'"
    )
    sentence = "unknown distribution 'jazy' of ROS 2 (from the environment variable ROS_DISTRO); did you mean 'jazzy'?"
    assert sentence in answer(ROS_DISTRO="jazy")


def test_a_folder_of_logs_is_gone_through_with_a_table_of_outcomes(tmp_path):
    (tmp_path / "good.csv").write_text("time,x [m],q[0]\n0,1,2\n1,3,2\n2,2,2\n")
    (tmp_path / "bad.csv").write_text("0,1\n1,2\n")
    field = runpy.run_path(str(Path(__file__).parents[2] / "tools" / "field.py"))
    with redirect_stdout(StringIO()) as out:
        assert field["main"](tmp_path, tmp_path / "out") == 0
    header, bad, good, *_ = out.getvalue().splitlines()
    assert header.split() == ["log", "signals", "samples", "seconds", "outcome"]
    assert "rejected: " in bad
    assert "expected a row of column names" in bad
    assert good.endswith("read, explained, plotted, reported")
    assert sorted(path.suffix for path in (tmp_path / "out").iterdir()) == [".html", ".png"]
