"""Fleets with a monitor for each key; the reports are those of monitors: tests/laws/test_fleet_monitor_laws.py."""

from __future__ import annotations

import datetime as dt
from typing import Any

import numpy as np
import pytest

import rtamt
from rtamt.fleet.collectors import COLLECTORS

SPEC = rtamt.parse("always[0:1](x >= 3)")
PAIR = rtamt.parse("x >= 3 or y >= 3")


def filled(**settings: Any) -> rtamt.Fleet:
    fleet = rtamt.Fleet(SPEC, 3, **({"verdict": "eager"} | settings))
    fleet.update_many(["a", "b"], [0.0, 5.0], {"x": [4.0, 7.0]})
    return fleet


def test_dense_points_name_their_key_and_sample() -> None:
    fleet = rtamt.Fleet(SPEC, 5, time="dense")
    fleet.update_many([7, 8], [0, 0], {"x": [5, 1]})
    update = fleet.update_many([8, 7, 8], [2.5, 1, 4], {"x": [4, 9, 6]})
    assert update.keys.tolist() == [8, 8, 7, 8, 8]
    assert update.index.tolist() == [0, 0, 1, 2, 2]
    assert update.times.tolist() == [0.0, 1.5, 0.0, 2.5, 3.0]
    assert update.values.tolist() == [-2.0, -2.0, 2.0, 1.0, 1.0]
    assert len(update) == 5


def test_eager_verdicts_are_released_by_the_sample_that_decides_them() -> None:
    update = filled().update_many(["b", "a"], [6, 1], {"x": [1, 5]})
    assert update.keys.tolist() == ["b", "b", "a"]
    assert update.index.tolist() == [0, 0, 1]
    assert update.times.tolist() == update.ends.tolist() == [5.0, 6.0, 0.0]
    assert update.satisfied.tolist() == [False, False, True]
    assert update.decided_at.tolist() == [6.0, 6.0, 1.0]
    assert len(update) == 3


def test_causation_is_in_the_order_of_the_batch() -> None:
    update = rtamt.Fleet(rtamt.parse("always(x >= 3)"), 5, verdict="causation").update_many(
        [7, 8, 7], [0, 0, 1], {"x": [5, 1, 2]}
    )
    assert update.keys.tolist() == [7, 8, 7]
    assert update.violation.tolist() == [2.0, -2.0, -1.0]
    assert update.satisfaction.tolist() == [-np.inf] * 3
    assert len(update) == 3


@pytest.mark.parametrize("verdict", ["interval", "causation"])
@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_an_update_keeps_its_keys_when_the_caller_uses_their_array_for_the_next_batch(
    time: str, verdict: str
) -> None:
    fleet = rtamt.Fleet(SPEC, 5, verdict=verdict, time=time)
    keys, updates = np.array([7, 8]), []
    for t in range(3):
        updates.append(fleet.update_many(keys, [t, t], {"x": [5.0, 4.0]}))
        keys[:] = keys[::-1].copy()
    assert [update.keys.tolist() for update in updates] == [[7, 8], [8, 7], [7, 8]]


def test_late_samples_narrow_the_interval_and_those_that_are_too_late_are_counted() -> None:
    spec = rtamt.parse("once[0:2](x >= 3)")
    fleet = rtamt.Fleet(spec, 5, verdict="interval", lateness="2s")
    fleet.update_many([7, 7, 7], [0, 1, 3], {"x": [1, 2, 0]})
    update = fleet.update_many([7, 7, 8], [2, 0, 0], {"x": [8, 9, 5]})
    assert update.late.tolist() == [False, True, False]
    assert update.changes.index.tolist() == [0]
    assert update.changes.begins.tolist() == [2.0]
    assert update.changes.ends.tolist() == [3.0]
    assert update.changes.lower.tolist() == [5.0]
    assert update.lower.tolist() == [-2.0, -2.0, -np.inf]
    assert (fleet.late, fleet.waiting, len(update), len(update.changes)) == (1, 0, 3, 1)


def test_a_batch_that_fails_counts_no_late_sample() -> None:
    fleet = rtamt.Fleet(SPEC, 5, verdict="interval", lateness=1)
    fleet.update_many([7, 7], [0, 9], {"x": [1, 2]})
    with pytest.raises(rtamt.TraceError):
        fleet.update_many([7, 7], [1, 10], {"x": [1, np.nan]})
    assert fleet.late == 0
    assert 8 not in fleet


def test_a_watermark_has_a_row_for_each_key() -> None:
    fleet = rtamt.Fleet(rtamt.parse("x >= 3", time="dense"), 5, verdict="interval", at="start", lateness=2)
    fleet.update_many([7, 8], [0, 1], {"x": [5, 4]})
    update = fleet.watermark(1)
    assert update.keys.tolist() == [7, 8]
    assert update.lower.tolist() == [2.0, 1.0]
    assert len(fleet.advance(9)) == 2
    assert fleet.update_many([7], [7], {"x": [5]}).late.tolist() == [True]


def test_masked_values_are_variables_without_a_sample() -> None:
    fleet = rtamt.Fleet(PAIR, 5, time="dense")
    x = np.ma.array([5.0, 0.0, 1.0], mask=[False, True, False])
    update = fleet.update_many(
        [7, 7, 7], [0, 0, 2], {"x": x, "y": np.ma.array([0.0, 4.0, 0.0], mask=[1, 0, 0])}
    )
    alone = PAIR.monitor(time="dense")
    expected = [alone.update(0, x=5.0), alone.update(0, y=4.0), alone.update(2, x=1.0, y=0.0)]
    assert update.times.tolist() == [time for each in expected for time in each.times.tolist()]
    assert update.values.tolist() == [value for each in expected for value in each.values.tolist()]
    assert len(fleet.update_many([7], [3], {"x": [5.0]})) == 0


def test_dates_are_reported_as_dates() -> None:
    start = dt.datetime(2026, 11, 22)
    fleet = rtamt.Fleet(rtamt.parse("x >= 3", time="dense"), 5)
    times = np.array([start, start + dt.timedelta(seconds=1)], "M8[s]")
    update = fleet.update_many([7, 7], times, {"x": [5, 4]})
    assert update.times.tolist() == times.astype("M8[ns]").tolist()
    assert fleet.expire(before=start.replace(tzinfo=dt.timezone.utc).timestamp() + 2) == 1


def test_a_copy_of_the_monitor_of_a_key_changes_nothing() -> None:
    fleet = filled()
    monitor: Any = fleet.monitor("a")
    assert len(monitor.update(1.0, x=0.0)) == 2
    assert len(fleet.update_many(["a"], [1], {"x": [0]})) == 2
    with pytest.raises(rtamt.UsageError) as caught:
        fleet.monitor("z")
    assert str(caught.value) == "the fleet has no key 'z'"
    with pytest.raises(rtamt.UsageError) as caught:
        rtamt.Fleet(SPEC, 3).monitor("a")
    assert str(caught.value) == (
        "a fleet of delayed verdicts in discrete time has a record for each key, and no monitor; read update_many()"
    )


def test_keys_come_and_go() -> None:
    fleet = filled()
    assert (len(fleet), fleet.capacity, fleet.memory > 0) == (2, 3, True)
    assert "a" in fleet
    assert 1 not in fleet
    assert fleet.expire(before=5.0) == 1
    assert fleet.keys() == ["b"]
    fleet.drop(["b", "b"])
    fleet.update_many([b"x"], [0], {"x": [1]})
    assert fleet.keys() == [b"x"]
    assert len(fleet.update_many([], [], {"x": []})) == 0


def test_a_dropped_key_starts_a_new_trace() -> None:
    fleet = filled()
    fleet.drop(["b"])
    update = fleet.update_many(["b", "b"], [0, 1], {"x": [4, 4]})
    assert update.times.tolist() == [0.0]
    assert update.satisfied.tolist() == [True]


@pytest.mark.parametrize(
    ("keys", "times", "columns", "error", "message"),
    [
        (
            ["c", "a"], [0, 0], {"x": [1, 1]}, rtamt.TraceError,
            "key 'a' at index 1 of the batch: time does not increase at sample 1: 0 s comes after 0 s; sort the "
            "samples and drop repeated timestamps",
        ),
        (
            ["c", "a"], [0, 1], {"x": [1, np.nan]}, rtamt.TraceError,
            "key 'a' at index 1 of the batch: 'x' is NaN at sample 1, time 1 s: fill the gap or leave the sample out",
        ),
        (["a"], [1], {"x": [1], "z": [1]}, rtamt.TraceError, "the formula has no variable 'z'; variables: x"),
        (
            ["a", "b"], [1], {"x": [1]}, rtamt.TraceError,
            "there are 2 keys and 1 times: give one of each for every sample",
        ),
        (
            ["a"], [1], {"x": [1, 2]}, rtamt.TraceError,
            "'time' has 1 and 'x' has 2 samples: give one value of each at every sample",
        ),
        (["a"], [1], {"x": "5"}, rtamt.TraceError, "'x' is '5', expected a column of values"),
        (["a"], [1], {"x": 5}, rtamt.TraceError, "'x' is 5, expected a column of values"),
        (
            list("cde"), [0, 0, 0], {"x": [1, 1, 1]}, rtamt.UsageError,
            "key 'd' at index 1 of the batch is new, and the fleet has its 3 keys already; drop or expire keys, or "
            "make a fleet of a larger capacity",
        ),
        (
            [1], [0], {"x": [1]}, rtamt.UsageError,
            "the keys of a fleet are all integers, all texts, or all bytes",
        ),
    ],
)  # fmt: skip
def test_a_batch_that_fails_changes_nothing(
    keys: Any, times: Any, columns: Any, error: Any, message: str
) -> None:
    fleet, other = filled(), filled()
    with pytest.raises(error) as caught:
        fleet.update_many(keys, times, columns)
    assert str(caught.value).startswith(message)
    assert sorted(fleet.keys()) == ["a", "b"]
    batch: Any = (["b", "a", "c"], [6, 1, 0], {"x": [1, 5, 2]})
    assert repr(fleet.update_many(*batch)) == repr(other.update_many(*batch))


def test_an_undefined_value_is_named_by_key_and_index() -> None:
    fleet = rtamt.Fleet(rtamt.parse("x / x >= 1"), 3, verdict="causation")
    with pytest.raises(rtamt.EvaluationError, match=r"^key 8 at index 1 of the batch: 'x / x' has no value"):
        fleet.update_many([7, 8], [0, 0], {"x": [1, 0]})
    assert len(fleet) == 0


@pytest.mark.parametrize(
    ("action", "message"),
    [
        (
            lambda: filled(gaps="hold"),
            "gaps='hold' needs delayed verdicts in discrete time, and this fleet has a monitor for each key "
            "(verdict='eager'): leave gaps= out",
        ),
        (
            lambda: filled(verdict="causation", lateness=1),
            "lateness= needs delayed verdicts in discrete time or verdict='interval', and this fleet has a monitor for "
            "each key (verdict='causation'): give the samples of a key in the order of their times",
        ),
        (
            lambda: filled().watermark(3),
            "the monitors of this fleet (verdict='eager') have no watermark(); choose verdict='interval'",
        ),
        (lambda: filled().drop(["a", "z"]), "the fleet has no key 'z' (index 1); no key was dropped"),
        (
            lambda: rtamt.Fleet(rtamt.parse('group cars = "car_*"; forall v in cars: v.x > 5'), 3),
            "the formula quantifies over 'cars', whose members are known with the data, and a fleet needs them before",
        ),
    ],
)
def test_wrong_use_is_rejected_with_a_sentence(action: Any, message: str) -> None:
    with pytest.raises(rtamt.UsageError) as caught:
        action()
    assert str(caught.value).startswith(message)


def test_a_back_end_without_records_has_a_monitor_for_each_key() -> None:
    spec = rtamt.parse("always[0:1](x >= 3)", backend="python")
    batches: Any = [([7, 8, 7], [0, 4, 1], {"x": [5, 1, 4]}), ([8, 7], [5, 2], {"x": [9, 1]})]
    found, expected = rtamt.Fleet(spec, 3), rtamt.Fleet(SPEC, 3)
    for batch in batches:
        assert repr(found.update_many(*batch)) == repr(expected.update_many(*batch))


def test_each_monitor_has_a_collector_that_names_its_mode() -> None:
    assert (
        len({each.what for each in COLLECTORS.values()}) == len(COLLECTORS) - 1
    )  # eager: in both time domains
