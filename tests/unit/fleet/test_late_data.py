"""Late samples, gaps and their errors; that the order of arrival does not matter: tests/laws/test_fleet_laws.py."""

from __future__ import annotations

import contextlib
import datetime as dt
import pickle
import struct
import zlib
from typing import Any

import numpy as np
import pytest

import rtamt

SPEC = rtamt.parse("always[0:1](x >= 3)")


def streamed(**settings: Any) -> rtamt.Fleet:
    """Return a fleet in which a sample at 0 s has been monitored, and one at 2 s waits."""
    fleet = rtamt.Fleet(SPEC, 3, lateness="2s", **settings)
    update = fleet.update_many(["a", "a"], [0, 2], {"x": [5, 4]})
    assert not update.known.any()
    assert fleet.waiting == 1
    return fleet


def test_a_sample_waits_until_one_has_come_that_is_newer_by_the_lateness() -> None:
    fleet = streamed()
    update = fleet.update_many(["a", "a"], [3, 1], {"x": [7, 1]})
    assert update.known.tolist() == [False, True]
    assert update.values[1] == -2.0
    assert update.times[1] == 0.0
    assert len(update.released) == 0
    update = fleet.update_many(["b", "a"], [0, 5], {"x": [9, 9]})
    assert not update.known.any()
    assert update.released.keys.tolist() == ["a", "a"]
    assert update.released.times.tolist() == [1.0, 2.0]
    assert update.released.values.tolist() == [-2.0, 1.0]


def test_late_and_repeated_samples_are_counted_and_left_out() -> None:
    fleet = streamed()
    update = fleet.update_many(["a", "a", "a", "b"], [2, 3, 0, 0], {"x": [9, 9, 9, 9]})
    assert update.late.tolist() == [True, False, True, False]
    assert fleet.late == 2
    assert rtamt.Fleet.restore(SPEC, fleet.snapshot()).late == 2


def test_a_watermark_releases_what_waits_and_makes_earlier_samples_late() -> None:
    fleet = streamed(gaps="hold")
    assert len(fleet.advance(3).released) == 0
    update = fleet.watermark(2)
    assert len(update) == 0
    assert update.released.times.tolist() == [0.0, 1.0]
    assert update.released.values.tolist() == [2.0, 1.0]
    assert fleet.waiting == 0
    assert fleet.update_many(["new"], [1.9], {"x": [5]}).late.tolist() == [True]
    fleet.advance(dt.datetime(2026, 11, 22, tzinfo=dt.timezone.utc))
    assert fleet.update_many(["a"], [3], {"x": [5]}).late.tolist() == [True]


@pytest.mark.parametrize("gaps", ["restart", "hold"])
def test_what_waits_is_part_of_the_state(gaps: str) -> None:
    fleet = streamed(gaps=gaps)
    again = rtamt.Fleet.restore(SPEC, fleet.snapshot())
    assert again.snapshot() == fleet.snapshot()
    assert again.waiting == 1
    batch: Any = (["a", "c"], [4, 4], {"x": [8, 8]})
    assert repr(again.update_many(*batch)) == repr(fleet.update_many(*batch))


def test_a_held_value_fills_a_gap_of_whole_periods() -> None:
    fleet = rtamt.Fleet(rtamt.parse("x >= 3"), 3, gaps="hold")
    update = fleet.update_many([1, 2, 1], [0, 0, 3], {"x": [5, 5, 4]})
    assert update.values.tolist() == [2.0, 2.0, 1.0]
    assert update.released.times.tolist() == [1.0, 2.0]
    assert update.released.values.tolist() == [2.0, 2.0]
    with pytest.raises(rtamt.TraceError) as caught:
        fleet.update_many([2], [1.5], {"x": [5]})
    assert str(caught.value).startswith(
        "key 2 at index 0 of the batch: sample 1 at 1.5 s is 1.5 s after the one before, expected 1 s"
    )
    with pytest.raises(rtamt.TraceError) as caught:
        fleet.update_many([2, 1], [1, 10_005], {"x": [5, 5]})
    assert str(caught.value) == (
        "key 1 at index 1 of the batch: the gap from 3 s to 10005 s is longer than the 10000 samples for which a value "
        "is held; drop the key, or choose gaps='restart'"
    )
    with pytest.raises(rtamt.TraceError) as caught:
        fleet.update_many([2, 1], [1, 3], {"x": [5, 5]})
    assert str(caught.value) == (
        "key 1 at index 1 of the batch: time does not increase: 3 s comes after 3 s; sort the samples and drop "
        "repeated timestamps, or allow for lateness"
    )


@pytest.mark.parametrize(
    ("keys", "times", "values", "error", "message"),
    [
        (
            ["b", "a"],
            [0, 3],
            [1, np.nan],
            rtamt.TraceError,
            "key 'a' at index 1 of the batch: 'x' is NaN at 3 s: fill the gap or leave the sample out",
        ),
        (
            ["b", "a"],
            [0, np.inf],
            [1, 1],
            rtamt.TraceError,
            "key 'a' at index 1 of the batch: time is inf: give a finite number of seconds",
        ),
        (
            ["b", "c", "d"],
            [0, 0, 0],
            [1, 1, 1],
            rtamt.UsageError,
            "key 'd' at index 2 of the batch is new, and the fleet has its 3 keys already; drop or expire keys, or "
            "make a fleet of a larger capacity",
        ),
        (
            ["b", "a"],
            [0, 6],
            [1, 1],
            rtamt.TraceError,
            "key 'a', a sample that waited: sample 1 at 2 s is 2 s after the one before, expected 1 s (within 10%): "
            "give the right period, resample the trace, or use dense time (time='dense', "
            "on the command line --time dense); or drop the key",
        ),
        ([1], [0], [1], rtamt.UsageError, "the keys of a fleet are all integers, all texts, or all bytes"),
    ],
)
def test_wrong_data_changes_nothing(keys: Any, times: Any, values: Any, error: Any, message: str) -> None:
    fleet = streamed()
    before = fleet.snapshot()
    with pytest.raises(error) as caught:
        fleet.update_many(keys, times, {"x": values})
    assert str(caught.value) == message
    assert fleet.snapshot() == before
    assert (fleet.waiting, len(fleet)) == (1, 1)


def test_a_gap_that_a_watermark_shows_changes_nothing() -> None:
    fleet = streamed()
    before = fleet.snapshot()
    with pytest.raises(rtamt.TraceError, match="a sample that waited: sample 1 at 2 s"):
        fleet.watermark(2)
    assert fleet.snapshot() == before
    with pytest.raises(rtamt.TraceError, match="the watermark is NaN"):
        fleet.watermark(np.nan)
    held = streamed(gaps="hold")
    held.update_many(["a"], [20_000], {"x": [1]})
    before = held.snapshot()
    with pytest.raises(rtamt.TraceError) as caught:
        held.watermark(np.inf)
    assert str(caught.value).startswith(
        "key 'a', a sample that waited: the gap from 2 s to 20000 s is longer"
    )
    assert held.snapshot() == before


def test_a_value_of_another_type_is_rejected_when_it_arrives() -> None:
    spec = rtamt.parse("bool p\nalways[0:1] p", period=1)
    fleet = rtamt.Fleet(spec, 3, lateness=2)
    with pytest.raises(rtamt.TraceError, match=r"index 1 of the batch, key 'a', time 1 s"):
        fleet.update_many(["a", "a"], [0, 1], {"p": [1, 0.5]})
    assert len(fleet) == 0


def test_keys_that_only_wait_are_keys() -> None:
    fleet = rtamt.Fleet(SPEC, 3, lateness=2)
    fleet.update_many(["a", "b"], [0, 50], {"x": [5, 4]})
    fleet.watermark(0)
    assert sorted(fleet.keys()) == ["a", "b"]
    assert "b" in fleet
    with pytest.raises(rtamt.UsageError, match="the fleet has no key 'z'"):
        fleet.drop(["a", "z"])
    fleet.drop(["b"])
    assert fleet.keys() == ["a"]
    assert fleet.waiting == 0
    fleet.update_many(["c"], [60], {"x": [1]})
    assert fleet.expire(before=30) == 1
    assert fleet.keys() == ["c"]
    assert fleet.memory > 0


def test_a_state_without_event_time_goes_on_in_event_time() -> None:
    fleet = rtamt.Fleet(SPEC, 3)
    fleet.update_many(["a", "b"], [0, 5], {"x": [5, 4]})
    streaming = rtamt.Fleet.restore(SPEC, fleet.snapshot(), lateness=2, gaps="restart")
    update = streaming.update_many(["a", "b", "a"], [0, 6, 1], {"x": [5, 2, 9]})
    assert update.late.tolist() == [True, False, False]
    assert streaming.watermark(9).released.values.tolist() == [2.0, -1.0]


def test_what_waits_has_the_variables_that_are_read() -> None:
    fleet = streamed()
    less = rtamt.Fleet.restore(rtamt.parse("true"), fleet.snapshot(), gaps="restart")
    assert less.watermark(9).released.times.tolist() == [2.0]
    with pytest.raises(rtamt.UsageError) as caught:
        rtamt.Fleet.restore(rtamt.parse("x >= 3 and y >= 3"), fleet.snapshot())
    assert str(caught.value) == (
        "the state has samples that wait for earlier ones, without 'y', which the specification reads: release them "
        "with watermark() before the specification changes"
    )


def sealed(body: bytes) -> bytes:
    return body + struct.pack("<I", zlib.crc32(body))


def test_damaged_states_are_rejected_or_harmless() -> None:
    fleet = streamed(gaps="hold")
    fleet.update_many(["b", "b"], [3, 1], {"x": [1, 2]})
    whole = fleet.snapshot()
    with pytest.raises(rtamt.UsageError, match="its checksum does not match"):
        rtamt.Fleet.restore(SPEC, whole[:-1] + bytes([whole[-1] ^ 1]))
    rejected = 0
    random = np.random.default_rng(3)
    for _ in range(400):
        state = bytearray(whole[:-4])
        for _ in range(random.integers(1, 3)):
            state[random.integers(0, len(state))] ^= int(random.integers(1, 256))
        inner = len(state) - len(fleet._samples.records.snapshot())
        state[inner:] = sealed(bytes(state[inner:-4]))
        try:
            forged = rtamt.Fleet.restore(SPEC, sealed(bytes(state)), capacity=10)
        except rtamt.UsageError:
            rejected += 1
            continue
        with contextlib.suppress(rtamt.TraceError, rtamt.UsageError):
            forged.update_many(["a", "b", "c"], [4, 5, 6], {"x": [1, 2, 3]})
        with contextlib.suppress(rtamt.TraceError):
            forged.watermark(9)
        assert len(forged.snapshot()) > 100
    assert 100 < rejected < 400


def waited(gaps: str = "restart") -> tuple[rtamt.Fleet, Any]:
    """Return a fleet in which a sample waits that has no value, and the batch that releases it."""
    fleet = rtamt.Fleet(rtamt.parse("once[0:1](sqrt(x) >= 3)"), 3, lateness=1, gaps=gaps)
    fleet.update_many(["a", "b", "a"], [0, 0, 1], {"x": [16, 1, -4]})
    return fleet, (["a", "b"], [2, 2], {"x": [25, 4]})


def test_a_sample_that_waits_and_has_no_value_rejects_batches_until_it_is_discarded() -> None:
    fleet, batch = waited()
    for _ in range(2):
        with pytest.raises(rtamt.WaitedError) as caught:
            fleet.update_many(*batch)
        assert (caught.value.key, caught.value.time, fleet.waiting) == ("a", 1.0, 2)
    with pytest.raises(rtamt.WaitedError):
        fleet.watermark(1)
    assert str(caught.value) == (
        "key 'a', a sample that waited: 'sqrt(x)' has no value at sample 1, time 1 s: it is 0/0, inf - inf, 0 * inf, "
        "or a function outside its domain; change the formula or the data so that this cannot happen; forget the "
        "sample with discard('a', 1.0), then give the batch again"
    )
    fleet = rtamt.Fleet.restore(rtamt.parse("once[0:1](sqrt(x) >= 3)"), fleet.snapshot())
    assert fleet.discard("a", 1.0)
    assert not fleet.discard("a", 1.0)
    fleet.update_many(*batch)
    update = fleet.update_many(["a", "b"], [3, 3], {"x": [1, 1]})
    assert update.released.keys.tolist() == ["a", "b"]
    assert update.released.values.tolist() == [2.0, -1.0]


#: 0/0 where x and y are held.
CHANGE = rtamt.parse("y / (x - delay[1](x, -1)) >= 3")


def test_a_held_value_without_a_result_is_blamed_on_the_sample_after_the_gap() -> None:
    """The error named the time of the held value, at which no sample waits: it could not be discarded."""
    fleet = rtamt.Fleet(CHANGE, 3, lateness=2, gaps="hold")
    fleet.update_many(["a", "a"], [0, 3], {"x": [1, 2], "y": [0, 0]})
    with pytest.raises(rtamt.WaitedError, match="at sample 1, time 1 s: ") as caught:
        fleet.update_many(["b", "a"], [0, 5], {"x": [1, 2], "y": [0, 0]})
    assert (caught.value.key, caught.value.time) == ("a", 3.0)
    assert fleet.discard("a", 3.0)
    fleet = rtamt.Fleet(CHANGE, 3, lateness=0, gaps="hold")
    fleet.update_many(["a"], [0], {"x": [1], "y": [0]})
    with pytest.raises(rtamt.EvaluationError, match="key 'a' at index 1 of the batch: "):
        fleet.update_many(["b", "a"], [0, 3], {"x": [1, 2], "y": [0, 0]})


def test_a_discarded_sample_may_come_again_with_another_value() -> None:
    fleet, batch = waited("reject")
    assert fleet.discard("a", 1.0)
    fleet.update_many(["a"], [1.0], {"x": [36.0]})
    assert fleet.update_many(*batch).released.values.tolist() == [3.0, -2.0]


@pytest.mark.parametrize("settings", [{}, {"verdict": "eager"}, {"time": "dense"}, {"lateness": 1}])
def test_where_no_sample_waits_none_is_discarded(settings: dict[str, Any]) -> None:
    fleet: Any = rtamt.Fleet(rtamt.parse("x >= 3"), 3, **settings)
    fleet.update_many(["a"], [0], {"x": [1]})
    assert [fleet.discard(key, time) for key, time in (("a", 9.0), ("z", 0.0))] == [False, False]


def test_errors_of_samples_that_waited_can_be_pickled() -> None:
    fleet, batch = waited()
    with pytest.raises(rtamt.WaitedError) as caught:
        fleet.update_many(*batch)
    again = pickle.loads(pickle.dumps(caught.value))
    assert (str(again), again.key, again.time) == (str(caught.value), "a", 1.0)


def test_what_waits_of_some_keys_can_be_released() -> None:
    fleet = streamed()
    fleet.update_many(["a", "b"], [1, 7], {"x": [6, 9]})
    update = fleet.release(["a", "a"])
    assert (len(update), fleet.waiting, fleet.keys()) == (0, 1, ["a", "b"])
    assert update.released.keys.tolist() == ["a", "a"]
    assert update.released.times.tolist() == [0.0, 1.0]
    assert update.released.values.tolist() == [2.0, 1.0]
    late = fleet.update_many(["a", "a"], [2, 3], {"x": [1, 8]})
    assert (late.late.tolist(), fleet.late) == ([True, False], 1)
    assert fleet.release(["b"]).released.times.tolist() == []
    assert fleet.release(["a"]).released.values.tolist() == [1.0]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            {},
            "the fleet was made without lateness=, so that no sample waits; make it with Fleet(..., lateness=...)",
        ),
        (
            {"gaps": "hold"},
            "the fleet was made without lateness=, so that no sample waits; make it with Fleet(..., ",
        ),
        ({"lateness": 1}, "the fleet has no key 'z' (index 1); nothing was released"),
        (
            {"verdict": "eager"},
            "no sample of this fleet waits, since each key has a monitor, which takes each sample at once",
        ),
    ],
)
def test_what_cannot_be_released_is_an_error(settings: dict[str, Any], message: str) -> None:
    fleet: Any = rtamt.Fleet(SPEC, 3, **settings)
    fleet.update_many(["a"], [0], {"x": [1]})
    with pytest.raises(rtamt.UsageError) as caught:
        fleet.release(["a", "z"])
    assert str(caught.value).startswith(message)


def test_a_release_that_fails_changes_nothing() -> None:
    fleet, _ = waited()
    state = fleet.snapshot()
    with pytest.raises(rtamt.WaitedError):
        fleet.release(["a"])
    assert fleet.snapshot() == state
    held = rtamt.Fleet(SPEC, 3, lateness=90_000, gaps="hold")
    held.update_many(["a", "a"], [0, 20_000], {"x": [1, 2]})
    with pytest.raises(
        rtamt.TraceError, match=r"^key 'a', a sample that waited: the gap from 0 s to 20000 s"
    ):
        held.release(["a"])
    assert held.waiting == 2
