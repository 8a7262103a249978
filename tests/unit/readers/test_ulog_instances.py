"""Instance 0 of a topic in a flight log has two names: ``battery`` and, beside other instances, ``battery[0]``."""

from __future__ import annotations

import pytest

import rtamt
from rtamt.cli import main
from tests.unit.readers.test_formats import ulog

VOLTS = (12.0, 16.0, 15.0)
GROUP = 'group batteries = "battery[*]" { float x [V] }; '
EVERY = GROUP + "always forall b in batteries: b.x > 14"


@pytest.fixture(params=[1, 2, 3])
def flight(request, tmp_path):
    times = [1_000_000 * second for second in range(3)]
    topics = [
        ("battery", instance, "float x", [(time, VOLTS[instance]) for time in times])
        for instance in range(request.param)
    ]
    path = ulog(tmp_path / "flight.ulg", [*topics, ("status", 0, "float y", [(time, 1) for time in times])])
    return str(path), request.param


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_group_of_instances_contains_the_one_that_is_recorded_without_index(flight, time, capsys):
    path, instances = flight
    assert main(["check", EVERY, path, "--time", time]) == 1
    assert "-2" in capsys.readouterr().out
    result = rtamt.parse(EVERY).evaluate(rtamt.read(path), time=time)
    assert result.robustness == 12 - 14
    text = str(result.specification)
    assert [f"battery[{i}]" in text for i in range(3)] == [i < instances for i in range(3)]
    counted = GROUP + "(count b in batteries: b.x > 0) == 3"
    assert rtamt.parse(counted).evaluate(rtamt.read(path), time=time).satisfied is (instances == 3)


def test_the_explanation_names_instance_0_with_its_index(flight, capsys):
    path, _ = flight
    assert main(["explain", EVERY, path]) == 1
    assert '"battery[0].x" > 14' in capsys.readouterr().out


def test_a_monitor_of_a_group_of_instances_takes_the_chunks_of_a_flight_log(flight):
    path, instances = flight
    monitor = rtamt.parse(GROUP + "forall b in batteries: b.x > 14").monitor()
    signal = monitor.update_many(rtamt.read(path))
    assert signal.values.tolist() == [-2, -2, -2]
    assert sorted(monitor.members) == [f"battery[{i}]" for i in range(instances)]


@pytest.mark.parametrize(
    "pattern", ["battery*", "bat*"]
)  # of which the first does not match 'battery' itself
def test_a_pattern_that_matches_the_recorded_name_has_each_instance_once(flight, pattern):
    path, instances = flight
    text = f"""
        group all = "battery[*]" {{ float x }}; group own = "{pattern}" {{ float x }}
        always((count a in all: a.x > 0) == {instances} and (count b in own: b.x > 0) == {instances})"""
    assert main(["check", text, path]) == 0
    assert rtamt.parse(text).evaluate(rtamt.read(path)).satisfied


def test_a_group_has_instance_0_also_if_the_formula_reads_it_by_its_short_name(flight):
    path, _ = flight
    text = "input float battery.x [V]; " + EVERY + " and battery.x > 0"
    assert rtamt.parse(text).evaluate(rtamt.read(path)).robustness == -2
    assert main(["check", text, path]) == 1


def test_both_names_of_instance_0_read_the_same_samples(flight):
    path, _ = flight
    for name in ("battery.x", "battery[0].x"):
        text = f'input float "{name}" [V]; "{name}" > 14'
        assert rtamt.parse(text).evaluate(rtamt.read(path)).robustness == -2
        assert rtamt.parse(text).evaluate(rtamt.read(path, columns=[name])).robustness == -2
        assert rtamt.parse(text).evaluate(rtamt.read(path, units={"battery.x": "mV"})).robustness == -13.988
        assert main(["check", text, path]) == 1
    trace = rtamt.read(path)
    held = rtamt.parse('sample 1s hold skip nan; "battery[0].x" > 14')
    assert held.evaluate(trace).robustness == -2
    optional = rtamt.parse('optional input float "battery[0].x" require R: always("battery[0].x" > 14)')
    assert optional.unchecked(trace) == {}
    assert trace["battery[0].x"].values.tolist() == trace["battery.x"].values.tolist()
    assert trace.select(["battery[0].x"]).names == ("battery.x",)


def test_listings_keep_the_short_name(flight, capsys):
    path, _ = flight
    assert main(["info", path]) == 0
    assert "battery[0]" not in capsys.readouterr().out
    assert "battery[0].x" not in rtamt.read(path).names


def test_a_renamed_instance_leaves_the_group(tmp_path):
    topics = [("battery", i, "float x", [(1_000_000, VOLTS[i]), (2_000_000, VOLTS[i])]) for i in (0, 1)]
    trace = rtamt.read(ulog(tmp_path / "flight.ulg", topics)).rename({"v": "battery.x"})
    assert rtamt.parse(EVERY).evaluate(trace).robustness == 16 - 14


def test_zeros_at_the_end_of_a_flight_log_took_seconds_per_megabyte(tmp_path):
    samples = [(1_000_000 * k, 0.0) for k in range(1, 4)]  # whose last bytes are zeros, too
    path = ulog(tmp_path / "flight.ulg", [("t", 0, "float x", samples)])
    with open(path, "r+b") as file:
        file.truncate(2**27)
    trace = rtamt.read(path)
    assert trace["t.x"].values.tolist() == [0.0, 0.0, 0.0]
    assert trace.losses[0].startswith("the file is damaged, read up to 3 s, as far as possible")
