"""States of fleets with a monitor for each key: what is refused, and why."""

from __future__ import annotations

import struct
import zlib
from typing import Any

import pytest

import rtamt
from rtamt.fleet.monitors_snapshot import packed, unpacked

SPEC = rtamt.parse("always[0:1](x >= 3)")
CONTINUES = "; a fleet with a monitor for each key continues with the same requirement and settings"
SUITE = rtamt.Suite(rtamt.parse("require A: x >= 3; require B: always[0:1](y >= 3)"))


def filled(spec: Any = SPEC, **settings: Any) -> rtamt.Fleet[Any]:
    fleet: rtamt.Fleet[Any] = rtamt.Fleet(spec, 3, **({"verdict": "eager"} | settings))
    fleet.update_many(["a", "b"], [0.0, 5.0], {"x": [4.0, 7.0]} | ({"y": [1, 2]} if spec is SUITE else {}))
    return fleet


def resealed(state: bytes) -> bytes:
    return state[:-4] + struct.pack("<I", zlib.crc32(state[:-4]))


@pytest.mark.parametrize("spec", [SPEC, SUITE])
def test_each_flipped_bit_is_refused(spec: Any) -> None:
    state = filled(spec).snapshot()
    for place in range(0, 8 * len(state), 7):
        flipped = bytearray(state)
        flipped[place // 8] ^= 1 << place % 8
        with pytest.raises(rtamt.UsageError):
            rtamt.Fleet.restore(spec, bytes(flipped), verdict="eager")
    for size in range(len(state)):
        with pytest.raises(rtamt.UsageError):
            rtamt.Fleet.restore(spec, state[:size], verdict="eager")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda state: state[:12], "this is not the state of a fleet: it ends too early"),
        (
            lambda state: state[:30] + bytes([state[30] ^ 1]) + state[31:],
            "this is not the state of a fleet: its checksum does not match, so it was damaged on the way",
        ),
        (
            lambda state: resealed(state[:8] + b"\2\0" + state[10:]),
            "this is not the state of a fleet: its format has version 2, and this is for version 1",
        ),
        (
            lambda state: resealed(state[:10] + b"\1\0" + state[12:]),
            "this is not the state of a fleet: its header has an unknown value",
        ),
        (
            lambda state: resealed(state[:-4] + bytes(8)),
            "this is not the state of a fleet: it has bytes that nothing reads",
        ),
        (
            lambda state: packed(unpacked(state)._replace(keys=["a", "a"])),
            "this is not the state of a fleet: it does not have a state for each key",
        ),
        (
            lambda state: packed(unpacked(state)._replace(keys=["a", "b\0"])),
            "this is not the state of a fleet: it has other keys than a fleet",
        ),
        (
            lambda state: packed(unpacked(state)._replace(version=9)),
            "the state has monitors of version 9, and this version of rtamt has version 8: replay the samples that "
            "verdicts still depend on",
        ),
        (
            lambda state: packed(unpacked(state)._replace(states=[b"", b""])),
            "this is not the state of a fleet: it ends too early",
        ),
        (
            lambda _: rtamt.Fleet(SPEC, 3).snapshot(),
            "the state is not of a fleet that has a monitor for each key, as this one has: restore it with the "
            "specification and the settings, such as time= and verdict=, of the fleet that made it",
        ),
    ],
)
def test_other_bytes_are_refused_with_a_reason(change: Any, message: str) -> None:
    with pytest.raises(rtamt.UsageError) as caught:
        rtamt.Fleet.restore(SPEC, change(filled().snapshot()), verdict="eager")
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("spec", "settings", "message"),
    [
        (
            rtamt.parse("always[0:2](x >= 3)"), {},
            "the state is of a fleet that differs in the formula: 'always[0:1](x >= 3)', and here "
            "'always[0:2](x >= 3)'" + CONTINUES,
        ),
        (
            SPEC, {"verdict": "interval"},
            "the state is of a fleet that differs in the verdict mode: \"verdict='eager'\", and here "
            "\"verdict='interval'\"" + CONTINUES,
        ),
        (
            SPEC, {"ranges": {"x": (0, 9)}},
            "the state is of a fleet that differs in ranges: '[]', and here \"[('x', (0.0, 9.0))]\"" + CONTINUES,
        ),
        (
            rtamt.parse("input float x [m]; always[0:1](x >= 3)"), {},
            "the state is of a fleet that differs in the variables: 'x: float', and here 'x m: float'" + CONTINUES,
        ),
        (
            SPEC, {"capacity": 1}, "this state has 2 keys, more than the capacity of 1",
        ),
        (
            SPEC, {"verdict": "delayed"},
            "the state is not of a fleet that has a record for each key, as this one has: restore it with the "
            "specification and the settings, such as time= and verdict=, of the fleet that made it",
        ),
        (
            SUITE, {},
            "the state is not of a fleet that has a monitor for each key and requirement, as this one has: restore it "
            "with the specification and the settings, such as time= and verdict=, of the fleet that made it",
        ),
    ],
)  # fmt: skip
def test_a_state_of_another_fleet_is_refused(spec: Any, settings: dict[str, Any], message: str) -> None:
    with pytest.raises(rtamt.UsageError) as caught:
        rtamt.Fleet.restore(spec, filled().snapshot(), **({"verdict": "eager"} | settings))
    assert str(caught.value) == message


def test_a_state_may_have_another_capacity() -> None:
    state = filled().snapshot()
    assert rtamt.Fleet.restore(SPEC, state, verdict="eager").capacity == 3
    assert rtamt.Fleet.restore(SPEC, state, verdict="eager", capacity=9).capacity == 9


@pytest.mark.parametrize("keys", [[3, -1], ["Ä\U0001f600", "b"], [b"\xff", b"a"], []])
def test_keys_of_all_types_are_restored(keys: Any) -> None:
    fleet = rtamt.Fleet(SPEC, 3, time="dense")
    fleet.update_many(keys, [0.5] * len(keys), {"x": [1.0] * len(keys)})
    assert rtamt.Fleet.restore(SPEC, fleet.snapshot(), time="dense").keys() == keys
