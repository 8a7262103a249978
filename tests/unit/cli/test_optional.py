"""Optional inputs and several recorded names: ``optional input float v = "a" or "b"``."""

import json
import pickle
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import rtamt
from rtamt.errors import ParseError, TraceError

TEXT = """\
optional input float v [V] = "battery_status.voltage_v" or "battery.voltage"
input float z
require BAT: historically(v >= 14)
require ALT: historically(z <= 50)
"""


@pytest.fixture
def spec():
    return rtamt.parse(TEXT)


def test_what_the_text_declares(spec):
    (voltage, height) = spec.document.declarations
    assert voltage.columns == ("battery_status.voltage_v", "battery.voltage")
    assert (voltage.optional, height.optional) == (True, False)
    assert spec.optional == {"v"}
    assert dict(spec.recorded) == {"v": "battery_status.voltage_v"}
    again = pickle.loads(pickle.dumps(spec))
    assert again.unchecked(["z"]) == spec.unchecked(["z"]) != {}


@pytest.mark.parametrize("name", ["battery_status.voltage_v", "battery.voltage", "v"])
def test_the_first_recorded_name_that_data_has_is_read(spec, name):
    data = {"time": [0, 1, 2], name: [15, 14.5, 13], "z": [1, 2, 3]}
    expected = [1.0, 0.5, -1.0]
    for each in (data, pd.DataFrame(data), rtamt.read(data)):
        assert spec.unchecked(each if isinstance(each, dict) else list(each)) == {}
        assert spec.evaluate(each).signal.values.tolist() == expected
    assert spec.monitor().update_many(data).values.tolist() == expected
    assert rtamt.evaluate_all([spec], data)[0].signal.values.tolist() == expected
    dense = {name: ([0.0, 1.0], [15, 13]), "z": ([0.0], [1])}
    assert spec.evaluate(dense, time="dense").signal.values.tolist()[-1] == -1.0


def test_of_two_recorded_names_the_first_one_counts(spec):
    data = {"battery.voltage": [1], "battery_status.voltage_v": [15], "z": [0]}
    assert spec.evaluate(data).robustness == 1.0
    assert spec.evaluate(rtamt.read({"time": [0], **data})).robustness == 1.0


def test_a_variable_that_is_not_optional_stays_an_error(spec):
    assert spec.unchecked(["v"]) == {}
    with pytest.raises(TraceError, match="'z'"):
        spec.evaluate({"v": [15]})


@pytest.mark.parametrize("format_", ["csv", "json"])
@pytest.mark.parametrize("name", ["battery_status.voltage_v", "battery.voltage"])
def test_a_stream_has_one_of_the_names(run, write, name, format_):
    write("spec.stl", TEXT)
    rows = [{"time": i, name: v, "z": 1} for i, v in enumerate([15, 13])]
    lines = [json.dumps(row) for row in rows]
    if format_ == "csv":
        lines = [f"time,{name},z", *(f"{row['time']},{row[name]},1" for row in rows)]
    answer = run("monitor", "spec.stl", stdin="\n".join(lines) + "\n")
    assert [json.loads(line)["robustness"] for line in answer.out.splitlines()] == [1, -1]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('optional input float v = "a" or "a"; v > 0', "the recorded name 'a' is given twice"),
        ('input float v = "a" or b; v > 0', "expected"),
        ("optional parameter float v = 3; v > 0", "only variables are optional: a parameter is not recorded"),
        ("optional const float v = 3; v > 0", "only variables are optional: a constant is not recorded"),
    ],
)
def test_messages(text, message):
    with pytest.raises(ParseError) as error:
        rtamt.parse(text)
    assert message in str(error.value)
    assert "^" in str(error.value)


def test_optional_is_no_reserved_word():
    spec = rtamt.parse("input float optional; optional > 3")
    assert spec.evaluate({"optional": [4]}).robustness == 1.0
    assert rtamt.parse("optional >= 3 and optional <= 5").input_names == ("optional",)
    assert rtamt.parse("optional = x >= 3; always(optional)").input_names == ("x",)


@pytest.mark.parametrize("bits", range(8))
def test_checks_are_those_of_the_requirements_whose_signals_are_there(bits):
    """A law over all subsets of three optional variables."""
    names = ["a", "b", "c"]
    there = [name for k, name in enumerate(names) if bits >> k & 1]
    declared = "".join(f'optional input float {name} = "log.{name}" or "old.{name}"\n' for name in names)
    text = declared + "require A: a > 0; require AB: a + b > 0; require C: c > 0; require ABC: a + b + c > 0"
    spec = rtamt.parse(text)
    lacking = spec.unchecked([f"old.{name}" for name in there])
    for name, one in spec.requirements.items():
        missing = set(one.input_names) - set(there)
        assert (name in lacking) == bool(missing)
        assert all(f"'log.{each}' or 'old.{each}'" in lacking[name] for each in missing)
        if not missing:
            data = {f"old.{each}": np.array([1.0]) for each in there}
            assert one.evaluate(data).robustness == len(one.input_names)


@pytest.mark.parametrize(("row", "verdict"), [("0,1", "satisfied"), ("0,51", "violated")])
def test_a_plot_of_several_requirements_is_of_those_whose_signals_are_there(run, write, row, verdict):
    spec, trace = write("a.stl", TEXT), write("a.csv", f"time,z\n{row}\n")
    done = run("plot", spec, trace, "-o", "a.svg")
    assert done.code == 0, done.err
    assert f": {verdict}, robustness" in done.out
    assert "not checked: BAT: no 'battery_status.voltage_v' or 'battery.voltage'" in done.err
    done = run("plot", spec, write("b.csv", "time,y\n0,1\n"), "-o", "b.svg")
    assert done.code == 2
    assert "'z'" in done.err


def test_the_robustness_of_what_was_checked_is_written_although_something_was_not(run, write):
    """Nothing was written, without a word."""
    done = run("check", write("a.stl", TEXT), write("a.csv", "time,z\n0,1\n1,3\n"), "-o", "out.csv")
    assert done.code == 0
    assert Path("out.csv").read_text() == "time,ALT\n0.0,49.0\n1.0,47.0\n"


def test_a_requirement_over_a_group_is_checked_although_another_lacks_its_signal(run, write):
    """The missing signal was an error of every requirement."""
    text = 'group cars = "car_*"\noptional input float w\nrequire CARS: always(forall v in cars: v.speed <= 30)\n'
    spec = write("a.stl", text + "require W: always(w > 1)\n")
    trace = write("a.csv", "time,car_1.speed,car_2.speed\n0,10,20\n1,31,2\n")
    done = run("check", spec, trace, "--json")
    rows = {row["requirement"]: row for row in map(json.loads, done.out.splitlines())}
    assert (done.code, rows["CARS"]["robustness"]) == (1, -1)
    assert rows["W"]["unchecked"] == "not checked: no 'w'"
    plotted = run("plot", spec, trace, "-o", "a.svg")
    assert "violated, robustness -1" in plotted.out
    assert "not checked: W: no 'w'" in plotted.err
