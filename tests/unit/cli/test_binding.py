"""Recorded names and units on the command line: every command finds them, and --name replaces them."""

import json

import numpy as np
import pytest

from tests.unit.readers.bags import Bag

SPEC = """\
input float z [m] = "setpoint.position[2]"
input float v [m/s]
require R: always(z <= 3 and v <= 10)
"""
LOG = "time,setpoint.position[2],other,v [km/h]\n0,1,2,18\n1,2,2,27\n2,4,2,36\n"
NOTE = "log.csv: v was converted from km/h to m/s"


@pytest.fixture(autouse=True)
def _files(write):
    write("spec.stl", SPEC)
    write("log.csv", LOG)


def test_check_finds_and_notes(run, write):
    answer = run("check", "spec.stl", "log.csv")
    assert (answer.code, answer.err) == (1, "")
    assert f"note: {NOTE}" in answer.out
    (row,) = map(json.loads, run("check", "spec.stl", "log.csv", "--json").out.splitlines())
    assert (row["robustness"], row["notes"]) == (-1.0, ["v was converted from km/h to m/s"])
    early = json.loads(run("check", "spec.stl", "log.csv", "--json", "--early").out)
    assert (early["lower"], early["notes"][0]) == ("-inf", "v was converted from km/h to m/s")
    write("names.stl", "input float z; always(z <= 3)")  # the same variable, elsewhere
    write("both.csv", LOG.replace("other", "z"))
    rows = [
        json.loads(line)
        for line in run("check", "spec.stl", "names.stl", "both.csv", "--json").out.splitlines()
    ]
    assert [row["robustness"] for row in rows] == [-1.0, 1.0]


def test_reports_show_the_note(run):
    assert run("report", "spec.stl", "log.csv", "-o", "page.html").code in (0, 1)
    run("check", "spec.stl", "log.csv", "--junit", "junit.xml", "--html", "check.html")
    for name in ("page.html", "junit.xml", "check.html"):
        with open(name, encoding="utf-8") as file:
            assert "v was converted from km/h to m/s" in file.read()


def test_other_commands(run):
    assert "critical point at 2 s: 'z <= 3' is -1" in run("explain", "spec.stl", "log.csv").out
    assert run("plot", "spec.stl", "log.csv", "-o", "plot.svg").code == 0
    info = run("info", "spec.stl").out
    assert 'input float z [m] = "setpoint.position[2]"' in info


def test_a_name_on_the_command_line_replaces_that_of_the_file(run):
    answer = run("check", "spec.stl", "log.csv", "--name", "z=other", "--json")
    assert json.loads(answer.out)["robustness"] == 0.0
    assert answer.err == (
        "rtamt: --name z=other replaces 'setpoint.position[2]', the recorded name in the specification\n"
    )
    assert run("check", "spec.stl", "log.csv", "--name", "z=setpoint.position[2]").err == ""


def test_a_missing_recorded_name_names_both(run, write):
    write("log.csv", LOG.replace("position[2]", "position[1]"))
    answer = run("check", "spec.stl", "log.csv")
    assert answer.code == 2
    assert (
        "log.csv has no column 'setpoint.position[2]', the recorded name of 'z'; did you mean" in answer.err
    )
    stream = run("monitor", "spec.stl", stdin='{"time": 0, "z": 1, "v": 3}')
    assert "stdin, line 1: the data has no 'setpoint.position[2]', the recorded name of 'z'" in stream.err


def test_streams(run, write):
    write("spec.stl", SPEC.replace("always", "historically"))
    answer = run("monitor", "spec.stl", stdin=LOG)
    assert [json.loads(line)["robustness"] for line in answer.out.splitlines()] == [2.0, 1.0, -1.0]
    assert answer.err == "rtamt: note: stdin: v was converted from km/h to m/s\n"
    lines = (
        '{"time": 0, "setpoint.position[2]": 1, "v": 5}\n{"time": 1, "setpoint": {"position[2]": 4}, "v": 5}'
    )
    answer = run("monitor", "spec.stl", stdin=lines)
    assert [json.loads(line)["robustness"] for line in answer.out.splitlines()] == [2.0, -1.0]
    dense = run(
        "monitor", "spec.stl", "--time", "dense", stdin="time,setpoint.position[2],v [km/h]\n0,1,18\n1,4,\n"
    )
    assert [json.loads(line)["robustness"] for line in dense.out.splitlines()] == [2.0, -1.0]
    wrong = run("monitor", "spec.stl", stdin=LOG.replace("km/h", "kg"))
    assert (
        "stdin, line 1: 'v' is recorded in kg, which cannot be converted to m/s, its declared unit"
        in wrong.err
    )


def test_formats_that_know_their_units(run, tmp_path, write):
    pa, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    asammdf = pytest.importorskip("asammdf")
    height = pa.field("setpoint.position[2]", pa.float64(), metadata={"unit": "ft"})
    schema = pa.schema([pa.field("time", pa.float64()), height])
    parquet.write_table(
        pa.table({"time": [0.0, 1.0], height.name: [1.0, 10.0]}, schema=schema), tmp_path / "log.parquet"
    )
    with asammdf.MDF(version="4.10") as file:
        file.append(
            [asammdf.Signal(np.array([1.0, 10.0]), np.array([0.0, 1.0]), unit="ft", name=height.name)]
        )
        file.save(tmp_path / "log.mf4")
    write("spec.stl", SPEC.replace(" and v <= 10", ""))
    for name in ("log.parquet", "log.mf4"):
        answer = run("check", "spec.stl", name, "--json")
        row = json.loads(answer.out)
        assert row["robustness"] == pytest.approx(3 - 3.048, rel=1e-12), name
        assert row["notes"] == ["z was converted from ft to m"]


def test_a_number_in_messages_of_a_bag(run, tmp_path, write):
    with Bag(tmp_path, "mcap") as bag:
        for at, value in ((0.0, 1.0), (1.0, 2.0), (2.0, 5.0)):
            bag.plain("/height", at, value)
    write("spec.stl", 'input float z [m] = "/height.data"\nrequire R: always(z <= 3)')
    row = json.loads(run("check", "spec.stl", str(bag.path.relative_to(tmp_path)), "--json").out)
    assert (row["robustness"], row["first_violation"]) == (-2.0, pytest.approx(2.0))
