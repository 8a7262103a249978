"""Results as MCAP files: topics, schemas, and times to the nanosecond."""

import json
import sys

import jsonschema
import numpy as np
import pytest
from mcap.reader import NonSeekingReader, make_reader

import rtamt
from rtamt.telemetry import metrics, write_mcap
from rtamt.telemetry.content import content_of
from tests.unit.telemetry.results import EPOCH, drive, messages, topics

REQUIREMENT = "/rtamt/requirements"


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("telemetry") / "drive.mcap"
    write_mcap(drive(), path, bounds=True)
    return path


@pytest.fixture(scope="module")
def found(path):
    return messages(path)


def seconds(*numbers):
    return [number * 10**9 for number in numbers]


def test_each_topic_has_a_schema_and_the_names_of_the_specification(path):
    kinds = {topic: (schema["title"], metadata) for topic, (schema, metadata) in topics(path).items()}
    speed = {"requirement": "SPEED", "formula": "always(speed <= 30)"}
    assert kinds["/rtamt/summary"] == ("rtamt.Summary", {})
    assert kinds["/rtamt/signals/speed"] == ("rtamt.Signal", {"variable": "speed"})
    assert {t: kind for t, kind in kinds.items() if t.startswith(f"{REQUIREMENT}/SPEED/")} == {
        f"{REQUIREMENT}/SPEED/robustness": ("rtamt.Number", speed),
        f"{REQUIREMENT}/SPEED/interval": ("rtamt.Interval", speed),
        f"{REQUIREMENT}/SPEED/verdict": ("rtamt.Verdict", speed),
        f"{REQUIREMENT}/SPEED/violations": ("rtamt.Violation", speed),
        f"{REQUIREMENT}/SPEED/known": ("rtamt.Interval", speed),
    }
    assert len(kinds) == 1 + 2 + 2 * 5


def test_every_message_satisfies_its_schema_and_has_no_other_member(path, found):
    schemas = {topic: schema for topic, (schema, _) in topics(path).items()}
    for topic, rows in found.items():
        strict = {**schemas[topic], "additionalProperties": False}
        for time, message in rows:
            jsonschema.validate(message, strict)
            stamp = message["timestamp"]
            assert stamp["sec"] * 10**9 + stamp["nsec"] == time


def test_signals_and_robustness_are_those_of_the_result(found):
    result = drive()
    speed = found["/rtamt/signals/speed"]
    assert [(time, row["value"]) for time, row in speed] == list(
        zip(seconds(0, 1, 2, 3, 4), [20, 32, 31, 20, 33], strict=True)
    )
    assert [row["name"] for _, row in found["/rtamt/signals/brake"]] == "false false true false true".split()
    for name, part in result.requirements.items():
        rows = found[f"{REQUIREMENT}/{name}/robustness"]
        values = [row.get("value", float(row.get("value_infinite", "nan"))) for _, row in rows]
        assert values == part.signal.values.tolist()


def test_a_verdict_is_written_at_the_start_at_every_change_and_at_the_end(found):
    assert [(time, row["verdict"]) for time, row in found[f"{REQUIREMENT}/SPEED/verdict"]] == [
        (0, "violated"),
        (*seconds(4), "violated"),
    ]
    result = rtamt.parse("x >= 3").evaluate({"x": [5, 4, 1, 1, 3]})
    assert verdicts(result) == [(0, "satisfied"), (2, "violated"), (4, "satisfied")]
    assert verdicts(rtamt.parse("x >= 3").evaluate({"x": [5]})) == [(0, "satisfied")]


def verdicts(result):
    (finding,) = content_of(result).findings
    return [(time // 10**9, verdict) for time, verdict in finding.verdicts]


def test_every_episode_has_an_event_at_its_begin_and_one_at_its_end(found):
    events = found[f"{REQUIREMENT}/SPEED/violations"]
    assert [(time, row["event"], row["worst"]) for time, row in events] == [
        (*seconds(1), "begin", -2.0),
        (*seconds(2), "end", -2.0),
        (*seconds(4), "begin", -3.0),
        (*seconds(4), "end", -3.0),
    ]
    assert events[0][1] == {
        "timestamp": {"sec": 1, "nsec": 0},
        "requirement": "SPEED",
        "event": "begin",
        "begin": {"sec": 1, "nsec": 0},
        "end": {"sec": 2, "nsec": 0},
        "at": {"sec": 1, "nsec": 0},
        "worst": -2.0,
    }


def test_the_summary_has_a_row_for_each_requirement(found):
    ((time, summary),) = found["/rtamt/summary"]
    assert time == 0
    assert summary["requirements"][0] == {
        "requirement": "SPEED",
        "formula": "always(speed <= 30)",
        "verdict": "violated",
        "robustness": -3.0,
        "lower": -3.0,
        "upper": -3.0,
        "first_violation": {"sec": 1, "nsec": 0},
        "episodes": 2,
    }
    assert [row["requirement"] for row in summary["requirements"]] == ["SPEED", "BRAKE"]


def test_the_bounds_at_the_start_narrow(found):
    uppers = [row["upper"] for _, row in found[f"{REQUIREMENT}/SPEED/known"]]
    assert uppers == [10, -2, -2, -2, -3]
    assert all(row["lower_infinite"] == "-inf" for _, row in found[f"{REQUIREMENT}/SPEED/known"][:-1])


TIMES = {
    "dates": (np.array([EPOCH, EPOCH + 10**9], "M8[ns]"), {}),
    "durations since 1970": (np.array([EPOCH, EPOCH + 10**9], "m8[ns]"), {}),
    "seconds since 1970": ([1_700_000_000.1, 1_700_000_001.1], {}),
    "integers": ([EPOCH, EPOCH + 10**9], {"time_unit": "ns"}),
    "milliseconds": ([100, 1100], {"time_unit": "ms"}),
    "decimals": ([0.1, 1.1], {}),
}


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize("given", TIMES)
def test_messages_are_logged_at_the_times_of_the_trace_to_the_nanosecond(tmp_path, time, given):
    times, options = TIMES[given]
    exact = {"seconds since 1970": EPOCH - 1, "milliseconds": 10**8, "decimals": 10**8}.get(given, EPOCH)
    result = rtamt.parse("always(x >= 3)").evaluate({"time": times, "x": [5, 1]}, time=time, **options)
    write_mcap(result, tmp_path / "x.mcap")
    rows = messages(tmp_path / "x.mcap")
    for topic in ("/rtamt/signals/x", "/rtamt/requirements/requirement_1/interval"):
        assert [at for at, _ in rows[topic]][-1] == exact + 10**9
        assert rows[topic][0][0] == exact
    assert [at for at, _ in rows["/rtamt/requirements/requirement_1/violations"]] == [exact + 10**9] * 2
    ((_, summary),) = rows["/rtamt/summary"]
    first = summary["requirements"][0]["first_violation"]
    assert first["sec"] * 10**9 + first["nsec"] == exact + 10**9


def test_in_dense_time_robustness_changes_between_the_doubles_of_the_timestamps(tmp_path):
    # Robustness changes 5 ns before 1700000001.1; doubles of seconds are 238 ns apart there.
    spec = rtamt.parse("eventually[0:5ns](x >= 3)", time="dense")
    result = spec.evaluate({"x": [[1_700_000_000.1, 1], [1_700_000_001.1, 4], [1_700_000_002.1, 4]]})
    write_mcap(result, tmp_path / "x.mcap")
    rows = messages(tmp_path / "x.mcap")["/rtamt/requirements/requirement_1/robustness"]
    start = 1_700_000_000_100_000_000
    assert [(at - start, row["value"]) for at, row in rows] == [
        (0, -2.0),
        (10**9 - 5, 1.0),
        (2 * 10**9, 1.0),
    ]


def test_messages_of_all_topics_are_in_order_of_time(tmp_path):
    spec = rtamt.parse("require A: x >= 3\nrequire B: eventually[0:1](y >= 3)", time="dense")
    result = spec.evaluate({"x": [[0.5, 1], [2, 4]], "y": [[0, 1], [1.5, 4]]})
    write_mcap(result, tmp_path / "x.mcap")
    with (tmp_path / "x.mcap").open("rb") as file:
        times = [m.log_time for _, _, m in NonSeekingReader(file).iter_messages(log_time_order=False)]
    assert times == sorted(times)
    assert len(times) > 8


def test_missing_and_uncertain_samples_have_bounds_and_an_unknown_verdict(tmp_path):
    spec = rtamt.parse("x >= 3")
    result = spec.evaluate({"x": [1, None, 5]}, ranges={"x": (0, 10)}, uncertainty={"x": 0.5})
    write_mcap(result, tmp_path / "x.mcap")
    rows = messages(tmp_path / "x.mcap")
    name = "/rtamt/requirements/requirement_1"
    plain = {
        topic: [{k: v for k, v in row.items() if k != "timestamp"} for _, row in rows[topic]]
        for topic in rows
    }
    assert plain["/rtamt/signals/x"] == [{"lower": 0.5, "upper": 1.5}, {"lower": 4.5, "upper": 5.5}]
    assert plain[f"{name}/interval"] == [
        {"lower": -2.5, "upper": -1.5},
        {"lower": -3.0, "upper": 7.0},
        {"lower": 1.5, "upper": 2.5},
    ]
    assert f"{name}/robustness" not in rows
    assert [row["verdict"] for row in plain[f"{name}/verdict"]] == ["violated", "unknown", "satisfied"]
    assert [(row["event"], row["worst"]) for row in plain[f"{name}/violations"]] == [
        ("begin", -1.5),
        ("end", -1.5),
    ]
    assert plain["/rtamt/summary"][0]["requirements"][0]["verdict"] == "violated"


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_member_of_a_group_has_no_samples_where_it_is_absent(tmp_path, time):
    spec = rtamt.parse('group cars = "car_*" { float x }\nalways(forall v in cars: v.x > 5)', time=time)
    data = {"time": [0, 1, 2], "car_1.x": [30.0, 31.0, 32.0], "car_7.x": [None, 14.0, None]}
    write_mcap(spec.evaluate(data), tmp_path / "x.mcap")
    rows = messages(tmp_path / "x.mcap")
    assert [row["value"] for _, row in rows["/rtamt/signals/car_1_x"]] == [30, 31, 32]
    assert [(at, row["value"]) for at, row in rows["/rtamt/signals/car_7_x"]] == [(10**9, 14.0)]
    assert [row["name"] for _, row in rows["/rtamt/signals/valid_car_7"]] == ["false", "true", "false"]


def test_bounds_over_time_need_exact_samples(tmp_path):
    result = rtamt.parse("x >= 3").evaluate({"x": [1, 5]}, uncertainty={"x": 0.5})
    with pytest.raises(rtamt.UsageError) as error:
        write_mcap(result, tmp_path / "x.mcap", bounds=True)
    assert str(error.value) == (
        "bounds over time of 'requirement_1' need samples that are known exactly; leave out bounds: the robustness of "
        "missing or uncertain samples has bounds at each instant"
    )


def test_infinite_robustness_is_a_member_of_its_own(tmp_path):
    result = rtamt.parse("once[1:1](x >= 3)").evaluate({"x": [1, 5]})
    write_mcap(result, tmp_path / "x.mcap")
    rows = messages(tmp_path / "x.mcap")["/rtamt/requirements/requirement_1/robustness"]
    assert [row for _, row in rows] == [
        {"timestamp": {"sec": 0, "nsec": 0}, "value_infinite": "-inf"},
        {"timestamp": {"sec": 1, "nsec": 0}, "value": -2.0},
    ]


def test_results_by_name_may_be_of_several_recordings_and_names_are_kept_apart(tmp_path):
    spec = rtamt.parse("x >= 3")
    results = {"run/1": spec.evaluate({"x": [5]}), "run 1": spec.evaluate({"x": [1]}), "drive": drive()}
    write_mcap(results, tmp_path / "x.mcap")
    names = {
        metadata.get("requirement"): topic for topic, (_, metadata) in topics(tmp_path / "x.mcap").items()
    }
    assert names["run/1"].startswith(f"{REQUIREMENT}/run_1/")
    assert names["run 1"].startswith(f"{REQUIREMENT}/run_1_2/")
    assert names["drive: SPEED"].startswith(f"{REQUIREMENT}/drive_SPEED/")


def test_no_results(tmp_path):
    with pytest.raises(rtamt.UsageError) as error:
        write_mcap({}, tmp_path / "x.mcap")
    assert str(error.value) == "there are no results; give those of one requirement or more"


def test_negative_times(tmp_path):
    result = rtamt.parse("x >= 3").evaluate({"time": [-1.5, -0.5], "x": [1, 2]})
    with pytest.raises(rtamt.UsageError) as error:
        write_mcap(result, tmp_path / "x.mcap")
    assert str(error.value) == (
        "the trace starts at -1.5 s, and an MCAP file has no times before 0; add an offset to the timestamps"
    )
    assert not (tmp_path / "x.mcap").exists()


def test_a_file_that_cannot_be_written(tmp_path):
    with pytest.raises(rtamt.TraceError) as error:
        write_mcap(drive(), tmp_path / "none" / "x.mcap")
    assert str(error.value) == f"cannot write '{tmp_path}/none/x.mcap': No such file or directory"


def test_without_the_package(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "mcap.writer", None)
    with pytest.raises(rtamt.UsageError) as error:
        write_mcap(drive(), tmp_path / "x.mcap")
    assert str(error.value) == (
        "writing MCAP files needs the package 'mcap', which is not installed: pip install 'rtamt[telemetry]'"
    )


def test_messages_are_plain_json(path):
    # No NaN or Infinity, which Python's reader accepts and others refuse.
    def refuse(constant):
        raise AssertionError(constant)

    with path.open("rb") as file:
        for _, _, message in make_reader(file).iter_messages():
            json.loads(message.data, parse_constant=refuse)


def test_a_violation_after_the_last_sample_was_an_error(tmp_path):
    spec = rtamt.parse("always(minimum[1:1](x) >= 1)", time="dense")
    result = spec.evaluate({"x": ([1, 5, 7], [4, 4, -1])})  # at 8 s, where the last value holds
    write_mcap(result, tmp_path / "late.mcap")
    ((_, summary),) = messages(tmp_path / "late.mcap")["/rtamt/summary"]
    assert summary["requirements"][0]["first_violation"] == {"sec": 8, "nsec": 0}
    assert metrics(result)["requirement_1/first_violation"] == 7
