"""What users do with a fleet; that its results are those of monitors is in tests/laws/test_fleet_laws.py."""

from __future__ import annotations

import copy
import datetime as dt
import pickle
import struct
import threading
import zlib
from typing import Any

import numpy as np
import polars as pl
import pytest

import rtamt

SPEC = rtamt.parse("always[0:1](x >= 3)")


def filled(spec: rtamt.Specification = SPEC, **settings: Any) -> rtamt.Fleet:
    fleet = rtamt.Fleet(spec, 3, **settings)
    fleet.update_many(["a", "b"], [0.0, 5.0], {"x": [1.0, 7.0]})
    return fleet


@pytest.mark.parametrize(
    ("keys", "times", "columns", "message"),
    [
        (
            ["a"],
            [3],
            {"x": [1]},
            "key 'a' at index 0 of the batch: sample 1 at 3 s is 3 s after the one before, expected 1 s "
            "(within 10%): give the right period, resample the trace, or use dense time (time='dense', "
            "on the command line --time dense)",
        ),
        (
            ["c", "a"],
            [0, 0],
            {"x": [1, 1]},
            "key 'a' at index 1 of the batch: time does not increase at sample 1: 0 s comes "
            "after 0 s; sort the samples and drop repeated timestamps",
        ),
        (
            ["a", "b"],
            [1, 6],
            {"x": [1, np.nan]},
            "key 'b' at index 1 of the batch: 'x' is NaN at sample 1, time 6 s: fill "
            "the gap or leave the sample out",
        ),
        (
            ["a"],
            [np.inf],
            {"x": [1]},
            "key 'a' at index 0 of the batch: time is inf at sample 1: give a finite number of seconds",
        ),
        (["a"], [1], {"x": [1], "z": [1]}, "the formula has no variable 'z'; variables: x"),
        (["a"], [1], {}, "the data has no 'x'; signals: none"),
        (["a", "b"], [1], {"x": [1]}, "there are 2 keys and 1 times: give one of each for every sample"),
        (
            ["a"],
            [1],
            {"x": [1, 2]},
            "'time' has 1 and 'x' has 2 samples: give one value of each at every sample",
        ),
        (["a"], [1], 5, "expected a mapping from variable to values, got int"),
        (
            ["a"],
            [1],
            np.array([("a", 1, 1)], [("key", "U1"), ("time", float), ("x", float)]),
            "expected a mapping from variable to values, got a structured array; "
            "give {name: table[name] for name in spec.input_names}",
        ),
        (
            ["a"],
            [1],
            pl.DataFrame({"x": [1]}),
            "expected a mapping from variable to values, got DataFrame; "
            "give {name: table[name] for name in spec.input_names}",
        ),
        ([1.5], [1], {"x": [1]}, "the keys are [1.5], expected a sequence of integers, texts, or bytes"),
        (5, [1], {"x": [1]}, "the keys are 5, expected a sequence of integers, texts, or bytes"),
        ("ab", [6, 6], {"x": [1, 1]}, "the keys are 'ab', expected a sequence of integers, texts, or bytes"),
        (
            b"ab",
            [6, 6],
            {"x": [1, 1]},
            "the keys are b'ab', expected a sequence of integers, texts, or bytes",
        ),
        (
            [-1, 2**63],
            [1, 1],
            {"x": [1, 1]},
            "the key 9223372036854775808 is beyond 64 bits with a sign; give it as text",
        ),
        (
            [1, "a"],
            [1, 1],
            {"x": [1, 1]},
            "the keys are of several types (int, str): give integers, texts, or bytes",
        ),
        (
            np.ma.array([7, 8], mask=[False, True]),
            [1, 1],
            {"x": [1, 1]},
            "the key at index 1 of the batch is masked: leave the sample out",
        ),
        (
            [2**63],
            [1],
            {"x": [1]},
            "the key 9223372036854775808 is beyond 64 bits with a sign; give it as text",
        ),
    ],
)
def test_wrong_data_is_named_by_key_and_index_and_changes_nothing(
    keys: Any, times: Any, columns: Any, message: str
) -> None:
    fleet = filled()
    before = fleet.snapshot()
    with pytest.raises(rtamt.TraceError) as caught:
        fleet.update_many(keys, times, columns)
    assert str(caught.value).startswith(message)
    assert fleet.snapshot() == before


@pytest.mark.parametrize(
    ("action", "message"),
    [
        (
            lambda f: f.update_many(list("cde"), [0, 0, 0], {"x": [1, 1, 1]}),
            "key 'd' at index 1 of the batch is new, and the "
            "fleet has its 3 keys already; drop or expire keys, or make a fleet of a larger capacity",
        ),
        (
            lambda f: f.update_many([1], [0], {"x": [1]}),
            "the keys of a fleet are all integers, all texts, or all bytes",
        ),
        (lambda f: f.drop(["a", "z"]), "the fleet has no key 'z' (index 1); no key was dropped"),
        (
            lambda _: rtamt.Fleet("x > 3", 3),
            "expected a specification, got 'x > 3'; write rtamt.parse(...) or rtamt.load(...)",
        ),
        (lambda _: rtamt.Fleet(SPEC, 0), "capacity is 0, expected a number of keys, at least 1"),
        (
            lambda _: rtamt.Fleet(SPEC, 3, gaps="holds"),
            "gaps is 'holds'; did you mean 'hold'? (policies: hold, reject, restart)",
        ),
        (
            lambda f: f.watermark(3),
            "the fleet was made without lateness=, so that no sample waits; make it with Fleet(..., lateness=...)",
        ),
        (lambda _: rtamt.Fleet(SPEC, 3, lateness=-1), "a duration may not be negative, got -1"),
        (
            lambda _: rtamt.Fleet(SPEC, 2**31),
            "capacity is 2147483648, expected a number of keys below 2**31",
        ),
        (
            lambda _: rtamt.Fleet(SPEC, 2**70),
            "capacity is 1180591620717411303424, expected a number of keys below 2**31",
        ),
        (
            lambda _: rtamt.Fleet(rtamt.parse("once[0:10000000](x >= 3)"), 2**31 - 1),
            "a fleet for 2147483647 keys needs more memory than this machine gives; lower the capacity",
        ),
        (
            lambda f: rtamt.Fleet.restore(SPEC, f.snapshot(), capacity=1),
            "this state has 2 keys, more than the capacity of 1",
        ),
        (
            lambda f: rtamt.Fleet.restore(SPEC, f.snapshot(), period=0.5),
            "this state is for samples 1 s apart, and the specification is for samples 0.5 s apart",
        ),
        (
            lambda _: rtamt.Fleet.restore(SPEC, b"RTAMTFLT"),
            "this is not the state of a fleet: it has 8 bytes, too few",
        ),
        (
            lambda _: rtamt.Fleet.restore(SPEC, "text"),
            "expected the bytes that snapshot() returns, got 'text'",
        ),
    ],
)
def test_wrong_use_is_rejected_with_a_sentence(action: Any, message: str) -> None:
    fleet = filled()
    before = fleet.snapshot()
    with pytest.raises(rtamt.UsageError) as caught:
        action(fleet)
    assert str(caught.value).startswith(message)
    assert fleet.snapshot() == before


def test_an_undefined_value_is_named_by_key_and_index() -> None:
    fleet = filled(rtamt.parse("(x - 2) / (x - 2) >= 1"))
    with pytest.raises(rtamt.EvaluationError) as caught:
        fleet.update_many(["b", "a", "a"], [6, 1, 2], {"x": [1, 4, 2]})
    assert "key 'a' at index 2 of the batch: '(x - 2) / (x - 2)' has no value at sample 2, time 2 s" in str(
        caught.value
    )


def test_a_gap_begins_a_new_trace_where_that_is_asked_for() -> None:
    fleet = filled(gaps="restart")
    update = fleet.update_many(["a", "a", "b", "a"], [1, 9, 6, 10], {"x": [4, 5, 8, 2]})
    assert update.known.tolist() == [True, False, True, True]
    assert update.values[update.known].tolist() == [-2.0, 4.0, -1.0]
    assert update.times[update.known].tolist() == [0.0, 5.0, 9.0]
    with pytest.raises(rtamt.TraceError, match="time does not increase"):
        fleet.update_many(["a"], [9], {"x": [1]})


def test_keys_come_and_go() -> None:
    fleet = filled()
    assert len(fleet) == 2
    assert "a" in fleet
    assert "c" not in fleet
    assert 1 not in fleet
    assert 1.5 not in fleet
    assert fleet.expire(before=5.0) == 1
    assert fleet.keys() == ["b"]
    fleet.drop(np.array(["b", "b"]))
    assert fleet.keys() == []
    fleet.update_many([b"x"], [0], {"x": [1]})
    assert fleet.keys() == [b"x"]


@pytest.mark.parametrize("keys", [["a", "a\0"], [b"a", b"a\0"], np.array(["a", "a\0"], object)])
def test_keys_that_numpy_would_take_for_the_same_are_rejected(keys: Any) -> None:
    fleet = rtamt.Fleet(SPEC, 3)
    with pytest.raises(rtamt.TraceError, match="a key ends with the character 0"):
        fleet.update_many(keys, [0, 0], {"x": [1, 2]})
    assert keys[1] not in fleet
    assert len(fleet) == 0


def test_masked_arrays_without_a_masked_key_are_keys() -> None:
    fleet = rtamt.Fleet(SPEC, 3)
    fleet.update_many(np.ma.array([7, 8], mask=[False, False]), [0, 0], {"x": [1, 2]})
    assert sorted(fleet.keys()) == [7, 8]
    assert np.ma.array([7])[0] in fleet
    assert np.ma.masked not in fleet


def test_texts_in_the_other_byte_order_are_the_same_keys() -> None:
    fleet = rtamt.Fleet(SPEC, 3)
    texts = ["a", "b", "\U00010000"]
    for order in "<>":
        fleet.update_many(np.array(texts, f"{order}U2"), np.full(3, float(order == ">")), {"x": [1, 2, 3]})
    assert sorted(fleet.keys()) == texts


def test_a_state_with_keys_that_are_no_texts_is_rejected() -> None:
    fleet = rtamt.Fleet(SPEC, 3)
    fleet.update_many(["ä"], [0], {"x": [1]})
    body = fleet.snapshot()[:-4].replace("ä".encode(), b"\xc3\x28")
    with pytest.raises(rtamt.UsageError, match="this is not the state of a fleet: a key is no UTF-8"):
        rtamt.Fleet.restore(SPEC, body + struct.pack("<I", zlib.crc32(body)))


@pytest.mark.parametrize(
    "keys",
    [
        np.arange(200, dtype=np.uint16),
        [f"schlüssel-{i}" for i in range(200)],
        [str(i).encode() for i in range(200)],
    ],
)
def test_dropping_keys_leaves_the_others_where_they_were(keys: Any) -> None:
    fleet = rtamt.Fleet(SPEC, 1000)
    values = np.arange(200.0)
    fleet.update_many(keys, np.zeros(200), {"x": values})
    fleet.drop(keys[:150:2])
    left = [key for i, key in enumerate(keys) if i % 2 or i >= 150]
    assert sorted(fleet.keys()) == sorted(left)
    order = np.random.default_rng(1).permutation(len(left))
    index = [i for i in range(200) if i % 2 or i >= 150]
    update = fleet.update_many([left[i] for i in order], np.ones(len(left)), {"x": np.full(len(left), 1e9)})
    assert update.values.tolist() == [index[i] - 3.0 for i in order]


def test_a_snapshot_is_the_same_after_a_restart() -> None:
    fleet = filled()
    fleet.update_many(["c", "a"], [1, 1], {"x": [2, 3]})
    fleet.drop(["b"])
    assert rtamt.Fleet.restore(SPEC, fleet.snapshot()).snapshot() == fleet.snapshot()
    assert rtamt.Fleet.restore(SPEC, fleet.snapshot(), capacity=500).capacity == 500


def test_a_changed_requirement_keeps_what_has_not_changed() -> None:
    old = rtamt.parse("once[0:2](x >= 3)")
    fleet = rtamt.Fleet(old, 10)
    fleet.update_many([1, 1, 1], [0, 1, 2], {"x": [9, 4, 1]})
    same = rtamt.Fleet.restore(rtamt.parse("once[0:2](x >= 3) and x <= 5"), fleet.snapshot())
    update = same.update_many([1], [3], {"x": [0]})
    assert (update.values.tolist(), update.warming.tolist()) == ([1.0], [False])
    wider = rtamt.Fleet.restore(rtamt.parse("once[0:3](x >= 3)"), fleet.snapshot())
    update = wider.update_many([1, 2, 1, 1, 1], [3, 0, 4, 5, 6], {"x": [0, 8, 0, 7, 0]})
    assert update.warming.tolist() == [True, False, True, True, False]
    assert update.known.tolist() == [False, True, False, False, True]
    assert update.values[update.known].tolist() == [5.0, 4.0]


def test_an_empty_batch_makes_nothing_known() -> None:
    assert len(filled().update_many([], [], {"x": []})) == 0


def test_two_threads_cannot_use_a_fleet_at_once() -> None:
    fleet = rtamt.Fleet(SPEC, 100_000)
    keys, found = np.arange(100_000), []

    def feed() -> None:
        try:
            for t in range(5):
                fleet.update_many(keys, np.full(len(keys), float(t)), {"x": keys})
        except (rtamt.UsageError, rtamt.TraceError) as error:
            found.append(str(error))

    threads = [threading.Thread(target=feed) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(fleet) == 100_000
    assert all(
        "is in use by another call" in text or "time does not increase" in text or "after the one" in text
        for text in found
    )


def test_the_state_is_as_its_page_describes() -> None:
    fleet = rtamt.Fleet(rtamt.parse("once[0:2](x >= 3)", period="500ms"), 7)
    fleet.update_many(["a", "bc"], [0.0, 4.0], {"x": [5.0, 1.0]})
    fleet.update_many(["a"], [0.5], {"x": [4.0]})
    state = fleet.snapshot()
    assert struct.unpack_from("<8sHHBBHIIQQQdQQQ", state) == (
        b"RTAMTFLT", 1, 1, 2, 0, 0, 1, 0, 128, 2, 7, 0.5, 0, 32, 32
    )  # fmt: skip
    hash_, head, tail, head_size, tail_size = struct.unpack_from("<QQQII", state, 80)
    assert (head, tail, head_size, tail_size) == (16, 32, 16, 40)
    assert hash_ == of_window(5)
    first, second = state[112:240], state[240:368]
    assert struct.unpack_from("<dqdII5d", first) == (0.5, 2, 2.0, 2, 0, 2.0, 1.0, 0.0, 0.0, 0.0)
    assert struct.unpack_from("<dqdII", second) == (4.0, 1, -2.0, 1, 0)
    assert state[368:-4] == b"\x01\0\0\0a\x02\0\0\0bc"
    assert struct.unpack("<I", state[-4:]) == (zlib.crc32(state[:-4]),)


def of_window(width: int) -> int:
    """Return the hash of once[0:width - 1](x >= 3), as the page defines it."""

    def number(n: int) -> bytes:
        return struct.pack("<q", n)

    def text(word: str) -> bytes:
        return number(len(word)) + word.encode()

    def fnv(data: bytes) -> bytes:
        value = 0xCBF29CE484222325
        for byte in data:
            value = (value ^ byte) * 0x100000001B3 % 2**64
        return struct.pack("<Q", value)

    def lag() -> bytes:
        return number(0)

    x = fnv(number(1) + text("input") + number(0) + text("x") + struct.pack("<d", 0.0) + lag())
    three = fnv(number(1) + text("const") + number(0) + number(0) + struct.pack("<d", 3.0) + lag())
    sub = fnv(number(1) + text("sub") + number(2) + x + three + number(0) + struct.pack("<d", 0.0) + lag())
    window = text("slide_max") + number(1) + sub + number(width) + struct.pack("<d", 0.0) + lag()
    return int.from_bytes(fnv(number(1) + window), "little")


@pytest.mark.parametrize(
    ("old", "new", "value"),
    [
        (
            "enum M { OFF, ON }\nM m\nonce[0:1](m == OFF)",
            "enum M { ON, OFF }\nM m\nonce[0:1](m == ON)",
            "OFF",
        ),
        ("float m [km/h]\nonce[0:1](m > 30)", "float m [m/s]\nonce[0:1](m > 30)", 50.0),
        ('float m = "speed"\nonce[0:1](m > 30)', 'float m = "rpm"\nonce[0:1](m > 30)', 50.0),
    ],
)
def test_a_signal_that_is_declared_otherwise_is_another_one_when_a_state_is_restored(old, new, value):
    """What was remembered of the old one became a verdict on the new one."""
    fleet = rtamt.Fleet(rtamt.parse(old, period=1), 4)
    fleet.update_many(np.array([7]), np.array([0.0]), {"m": np.array([value])})
    restored = rtamt.Fleet.restore(rtamt.parse(new, period=1), fleet.snapshot())
    batch = restored.update_many(np.array([7]), np.array([1.0]), {"m": np.array([value])})
    assert batch.warming.tolist() == [True]
    same = rtamt.Fleet.restore(rtamt.parse(old, period=1), fleet.snapshot())
    assert same.update_many(np.array([7]), np.array([1.0]), {"m": np.array([value])}).warming.tolist() == [
        False
    ]


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, pickle.dumps])
def test_a_fleet_that_is_copied_or_pickled_names_the_snapshot_instead(again: Any) -> None:
    with pytest.raises(rtamt.UsageError) as caught:
        again(filled())
    assert str(caught.value) == (
        "a fleet can be neither copied nor pickled: take fleet.snapshot(), and make another fleet of it with "
        "rtamt.Fleet.restore(spec, state)"
    )


@pytest.mark.parametrize("settings", [{}, {"lateness": "1s"}, {"verdict": "eager"}])
def test_keys_expire_before_a_date(settings: Any) -> None:
    fleet = rtamt.Fleet(rtamt.parse("x >= 3"), 3, **settings)
    fleet.update_many([7, 8], [1767225600.0, 1767225660.0], {"x": [5.0, 4.0]})
    assert fleet.expire(before=dt.datetime(2026, 1, 1, 0, 0, 30, tzinfo=dt.timezone.utc)) == 1
    assert fleet.keys() == [8]


def test_a_name_that_utf_8_lacks_is_rejected_before_the_core_takes_it():
    message = r"^a program cannot contain '\\udcff', which UTF-8 lacks: correct the name in 'x\\udcff'$"
    with pytest.raises(rtamt.UsageError, match=message):
        rtamt.Fleet(rtamt.parse('"x\udcff" >= 3', period="1s"), 4)
