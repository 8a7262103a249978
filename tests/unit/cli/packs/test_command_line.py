"""``rtamt check PACK TRACE``: flight logs, bags and tables, with signals that are missing."""

import json
import os
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

import rtamt
from rtamt.specification_loader import packs
from tests.unit.cli.packs.traces import BASE, DRIVING, DRIVING_VIOLATED, PX4, made
from tests.unit.readers.bags import SECOND, Bag
from tests.unit.readers.test_formats import ulog


def flight(path, **changed):
    """Write a flight log in the names of PX4 1.9, whose rates are fields of the attitude."""
    data = made(PX4, **changed)

    def rows(*columns):
        times = data[columns[0]][0]
        values = zip(*(data[column][1] for column in columns), strict=True)
        return [(round((10 + t) * 1e6), *row) for t, row in zip(times, values, strict=True)]

    attitude = [f"vehicle_attitude.q[{k}]" for k in range(4)]
    rates = [f"vehicle_angular_velocity.xyz[{k}]" for k in range(3)]
    topics = [
        ("vehicle_status", 0, "float arming_state", rows("vehicle_status.arming_state")),
        ("battery_status", 0, "float voltage_v;float cell_count",
         rows("battery_status.voltage_v", "battery_status.cell_count")),
        ("vehicle_attitude", 0, "float rollspeed;float pitchspeed;float yawspeed;float[4] q", rows(*rates, *attitude)),
        ("vehicle_rates_setpoint", 0, "float roll;float pitch;float yaw",
         rows(*(f"vehicle_rates_setpoint.{axis}" for axis in ("roll", "pitch", "yaw")))),
    ]  # fmt: skip
    return ulog(path, topics).name


def test_requirements_whose_topics_are_missing_have_a_row_and_no_effect_on_the_exit_code(run, tmp_path):
    name = flight(tmp_path / "flight.ulg")
    answer = run("check", "px4", name, "--json")
    rows = {row["requirement"]: row for row in map(json.loads, answer.out.splitlines())}
    assert list(rows) == list(rtamt.pack("px4").requirements)
    checked = {name for name, row in rows.items() if "unchecked" not in row}
    assert checked == {
        "ARM-1",
        "BAT-1",
        "BAT-4",
        "BAT-6",
        "ATT-5",
        "ATT-6",
        *(f"RATE-{k}" for k in range(1, 6)),
    }
    assert all(rows[name]["satisfied"] for name in checked)
    assert rows["BAT-2"] == {
        "requirement": "BAT-2",
        "trace": "flight.ulg",
        "unchecked": "not checked: no 'battery_status.remaining'",
        "description": "the battery is never critical in flight, as far as its capacity is known",
        "severity": "error",
    }
    assert (answer.code, answer.err) == (0, "")
    text = run("check", "px4", name).out
    assert "BAT-2, flight.ulg: not checked: no 'battery_status.remaining'\n" in text
    assert text.endswith("11 satisfied, 25 unchecked\n")


def test_a_violation_decides_the_exit_code_and_limits_can_be_set(run, tmp_path):
    name = flight(tmp_path / "flight.ulg", **{"battery_status.voltage_v": 14.4})
    assert run("check", "px4", name, "--quiet") == (0, "", "")
    assert run("check", "px4", name, "--quiet", "--set", "cell_empty=3.7").code == 1


def test_a_recording_of_another_system_is_an_error_and_not_a_silent_pass(run, write):
    answer = run("check", "px4", write("log.csv", "time,battery_status.voltage_v\n0,15\n1,15\n"))
    assert answer.code == 2
    assert (
        answer.err
        == "rtamt: log.csv: nothing was checked: every requirement reads signals that the recording lacks\n"
    )


@pytest.mark.skipif("RTAMT_FLIGHT" not in os.environ and not Path(__file__).parents[5].joinpath("shared").exists(),
                    reason="no recorded flight; RTAMT_FLIGHT names one")  # fmt: skip
def test_a_real_flight(run):
    path = os.environ.get("RTAMT_FLIGHT") or str(Path(__file__).parents[5] / "shared/data/px4_flight.ulg")
    answer = run("check", "px4", path, "--json", "--set", "armed_only=false")
    rows = {row["requirement"]: row for row in map(json.loads, answer.out.splitlines())}
    verdicts = {name: row.get("satisfied", "unchecked") for name, row in rows.items()}
    assert verdicts["ATT-3"] is verdicts["ATT-4"] is verdicts["ATT-5"] is True
    assert verdicts["BAT-1"] == verdicts["GPS-1"] == verdicts["ATT-1"] == "unchecked"
    assert 0 < rows["ATT-3"]["robustness"] < 15
    # Old logs do not record arming: whoever does not know that would take the pack for satisfied.
    rows = [json.loads(line) for line in run("check", "px4", path, "--json").out.splitlines()]
    assert [row["requirement"] for row in rows if row.get("satisfied") is False] == ["ARM-1"]


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
@pytest.mark.parametrize("requirement", [None, "RSS-1"])
def test_a_drive(run, tmp_path, suffix, requirement):
    pandas = pytest.importorskip("pandas")
    data = made(DRIVING, **DRIVING_VIOLATED.get(requirement, {}))
    frame = pandas.DataFrame(
        {"time": data["ego_speed"][0], **{name: values for name, (_, values) in data.items()}}
    )
    frame = frame.drop(columns="side_gap").rename(columns={"ego_speed": "ego_speed [km/h]"})
    frame["ego_speed [km/h]"] *= 3.6
    path = tmp_path / f"drive.{suffix}"
    frame.to_csv(path, index=False) if suffix == "csv" else frame.to_parquet(path)
    answer = run("check", "driving", path.name, "--json")
    rows = {row["requirement"]: row for row in map(json.loads, answer.out.splitlines())}
    assert rows["RSS-2"]["unchecked"] == "not checked: no 'side_gap'"
    violated = {name for name, row in rows.items() if row.get("satisfied") is False}
    assert violated == ({"RSS-1", "RSS-3"} if requirement else set())
    assert answer.code == (1 if requirement else 0)


@pytest.mark.parametrize("kind", ["ros1", "mcap"])
def test_a_bag_of_a_mobile_base(run, tmp_path, kind):
    with Bag(tmp_path, kind) as bag:
        types = bag.store.types
        vector = types["geometry_msgs/msg/Vector3"]
        twist = "geometry_msgs/msg/Twist"
        data = made(BASE)
        for k, t in enumerate(data["/scan.ranges.min"][0]):
            x = float(data["/cmd_vel.linear.x"][1][k])
            message = types[twist](linear=vector(x=x, y=0.0, z=0.0), angular=vector(x=0.0, y=0.0, z=0.0))
            bag.write("/cmd_vel", twist, round((1 + t) * SECOND), message)
            bag.scan("/scan", 1 + t, [0.0, 0.3, 9.0] if t > 5 else [0.0, 0.1, 9.0])
    path = str(bag.path.relative_to(tmp_path))
    answer = run("check", "mobile_base", path, "--json", "--set", "radius=0.2")
    rows = {row["requirement"]: row for row in map(json.loads, answer.out.splitlines())}
    checked = {name for name, row in rows.items() if "unchecked" not in row}
    assert checked == {"LIMIT-1", "LIMIT-2", "OBST-1"}
    assert rows["LIMIT-1"]["robustness"] == pytest.approx(0.06)
    assert rows["OBST-1"]["robustness"] == pytest.approx(0.1 - 0.2)
    run("check", "mobile_base", path, "--set", "radius=0.2", "-o", "out.mcap")
    written = {
        name.split("/")[2].split(".")[0] for name in rtamt.read("out.mcap").names if name[:7] == "/rtamt/"
    }
    assert written == {"LIMIT_1", "LIMIT_2", "OBST_1"}


def test_a_table_of_a_mobile_base_may_have_the_nearest_range(run, write):
    """Its name was read as a unit: minutes, which cannot be converted to metres."""
    answer = run("check", "mobile_base", write("log.csv", "time,/scan.ranges.min\n0,1\n0.05,0.5\n"), "--json")
    (row,) = (row for row in map(json.loads, answer.out.splitlines()) if "unchecked" not in row)
    assert (answer.code, row["requirement"]) == (0, "OBST-1")
    assert row["robustness"] == pytest.approx(0.28)


def test_reports_of_unchecked_requirements(run, tmp_path):
    name = flight(tmp_path / "flight.ulg")
    options = ["--junit", "report.xml", "--sarif", "report.sarif", "--html", "report.html", "--quiet"]
    assert run("check", "px4", name, *options).code == 0
    root = ET.parse(tmp_path / "report.xml").getroot()
    assert (root.get("tests"), root.get("skipped"), root.get("failures")) == ("36", "25", "0")
    (suite,) = (s for s in root if s.get("name") == "BAT-2")
    assert suite[0][0].tag == "skipped"
    results = json.loads((tmp_path / "report.sarif").read_text())["runs"][0]["results"]
    assert [r["kind"] for r in results].count("notApplicable") == 25
    page = (tmp_path / "report.html").read_text()
    assert "not checked: no &#39;battery_status.remaining&#39;" in page
    answer = run("explain", "px4", name)
    assert answer.code == 0
    assert "BAT-2, flight.ulg: not checked" in answer.err


# ---- names ---------------------------------------------------------------------------------------


def test_a_file_that_is_called_like_a_pack_is_not_taken_silently(run, write):
    write("px4", "always(x >= 0)")
    write("log.csv", "time,x\n0,1\n")
    answer = run("check", "px4", "log.csv")
    assert answer == (
        2,
        "",
        "rtamt: 'px4' is a pack and a file in this folder; write pack:px4 for the pack, or ./px4 for the file\n",
    )
    assert run("check", "./px4", "log.csv").code == 0
    assert "nothing was checked" in run("check", "pack:px4", "log.csv").err


def test_an_unknown_pack(run):
    answer = run("check", "pack:px5", "log.csv")
    assert (answer.code, answer.err) == (
        2,
        "rtamt: there is no pack 'px5'; did you mean 'px4'? (packs: px4, driving, mobile_base)\n",
    )


def test_a_misspelled_pack_is_not_taken_for_a_formula(run, write):
    write("log.csv", "time,px5\n0,1\n")
    answer = run("check", "px5", "log.csv")
    assert answer == (
        2,
        "",
        "rtamt: there is no pack 'px5'; did you mean 'px4'? (packs: px4, driving, mobile_base) "
        "(if a formula is meant, put it in parentheses)\n",
    )
    assert run("check", "(px5)", "log.csv", "--period", "1").code == 0


def test_packs_are_listed_and_printed(run, write):
    listing = run("packs").out
    assert [line.split()[0] for line in listing.splitlines()[1:]] == list(packs())
    text = run("packs", "px4").out
    assert list(rtamt.parse(text).requirements) == list(rtamt.pack("px4").requirements)
    write("mine.stl", text)
    assert run("lint", "mine.stl").code == 0


def test_a_pack_and_a_file_are_checked_together(run, write):
    write("mine.stl", "always(ego_speed <= 30)")
    write("drive.csv", "time,ego_speed,speed_limit\n0,20,30\n0.1,20,30\n")
    answer = run("check", "driving", "mine.stl", "drive.csv", "--json")
    rows = [json.loads(line) for line in answer.out.splitlines()]
    assert [row["requirement"] for row in rows if "unchecked" not in row] == ["LIMIT-1", "mine.stl"]


def test_a_requirement_whose_optional_signal_is_only_nan_is_unchecked(run, write):
    table = write("flight.csv", "time,set,c\n0,nan,2\n1,nan,2\n2,nan,3\n")
    text = (
        'optional input float a = "set.old" or "set"\ninput float c\nsample 1s hold skip nan\n'
        "require A: always(a > 0)\nrequire C: always(c > 0)\n"
    )
    answer = run("check", write("flight.stl", text), table)
    assert answer.code == 0
    assert "not checked: no 'set.old' or 'set' other than NaN" in answer.out
    assert "1 satisfied, 1 unchecked" in answer.out
    assert rtamt.parse(text).unchecked(rtamt.read(table, skip_nan=["set"])) == {
        "A": "no 'set.old' or 'set' other than NaN"
    }
