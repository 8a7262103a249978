"""Forged states of fleets, shards and checkpoints: nothing but an StlError comes out, at restoring or later.

The checksums are set right after every change. The same for the compiled core, under the address sanitizer:
forged_fuzz.cpp.
"""

from __future__ import annotations

import struct
import zlib
from contextlib import suppress
from functools import cache
from hashlib import sha256
from math import inf
from random import Random
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.errors import StlError
from rtamt.fleet import fleet_snapshot, monitors_snapshot
from rtamt.scale.arrivals import Arrivals
from rtamt.scale.checkpoints import Checkpoint
from rtamt.scale.inputs import inputs_of
from rtamt.scale.shard import Sample, Shard
from tests.fuzz.targets import damaged
from tests.unit.fleet.test_monitor_state import CASES

if TYPE_CHECKING:
    from collections.abc import Mapping

#: Of each kind of state, for `make fuzz`: some minutes in all.
MOST_EXAMPLES = 3000
#: What a monitor in a forged state may raise: the state may claim more instants without a verdict than fit in memory.
ALLOWED = (StlError, MemoryError)

SPEC = rtamt.parse("always[0:2](x >= 3)")
SUITE = rtamt.Suite(
    [rtamt.parse(f"specification {text}") for text in ("A once[0:2](x >= 3)", "B always[0:1](y >= 3)")]
)
SECONDS = [float(t) for t in range(6)]
FLEETS: dict[str, tuple[Any, dict[str, Any], list[Any]]] = {
    **CASES,
    "records": (SPEC, {}, SECONDS),
    "records of event time": (SPEC, {"lateness": 2, "gaps": "restart"}, SECONDS),
    "records of gaps": (SPEC, {"gaps": "hold"}, SECONDS),
    "records of a suite": (SUITE, {"lateness": 1}, SECONDS),
    "a suite of monitors": (SUITE, {"verdict": "eager"}, SECONDS),
}
SHARDS: dict[str, dict[str, Any]] = {
    "delayed": {},
    "event time": {"lateness": 2.0, "expire_after": 60.0},
    "dense": {"time": "dense", "expire_after": 60.0},
}


def columns_at(spec: Any, values: list[float]) -> dict[str, list[float]]:
    return {each.columns[0]: values for each in inputs_of(spec)}


@cache
def fleet_state(case: str, count: int) -> bytes:
    """Return the state of a fleet after some samples."""
    spec, made, times = FLEETS[case]
    fleet = rtamt.Fleet(spec, 5, **made)
    for i in range(count):
        fleet.update_many(["a", "b"], [times[i]] * 2, columns_at(spec, [7 * i % 5.0, 3 * i % 7.0]))
    return fleet.snapshot()


@cache
def shard_state(case: str, count: int) -> bytes:
    """Return the state of a shard after some samples."""
    shard = Shard(SPEC, **SHARDS[case])
    for i in range(count):
        shard.take([Sample(key, float(i), (float(i),)) for key in ("a", "b")], [float(i)] * 2)
    return shard.snapshot()


def sealed(body: bytes) -> bytes:
    return body + struct.pack("<I", zlib.crc32(body))


def forged(state: bytes, random: Random) -> bytes:
    """Return a state with changes somewhere, and with the checksums of what surrounds them."""
    if random.random() < 0.2:
        return sealed(damaged(state[:-4], random))
    if state.startswith(b"RTAMTSHD"):
        arrivals = Arrivals(inf)
        return arrivals.pack_state(forged(arrivals.unpack_state(state), random))
    if state.startswith(fleet_snapshot.REQUIREMENTS):
        fleets, late = monitors_snapshot.unpacked_requirements(state)
        name = random.choice(sorted(fleets))
        return monitors_snapshot.packed_requirements({**fleets, name: forged(fleets[name], random)}, late)
    if state.startswith(fleet_snapshot.MONITORS):
        monitors = monitors_snapshot.unpacked(state)
        states = list(monitors.states)
        if states:
            chosen = random.randrange(len(states))
            states[chosen] = damaged(states[chosen], random)
        return monitors_snapshot.packed(monitors._replace(states=states))
    parts = fleet_snapshot.unpacked(state)
    if parts.records is state:
        return sealed(damaged(state[:-4], random))
    if parts.waiting and random.random() < 0.5:
        return fleet_snapshot.packed(parts._replace(waiting=damaged(parts.waiting, random)))
    return fleet_snapshot.packed(parts._replace(records=forged(parts.records, random)))


def go_on(spec: Any, made: Mapping[str, Any], times: list[Any], state: bytes) -> bool:
    """Use a fleet in a state as far as it can be used; return whether it was restored."""
    try:
        fleet: Any = rtamt.Fleet.restore(spec, state, **made)
    except StlError:
        return False
    keys = fleet.keys()
    for i, time in enumerate(times):
        with suppress(*ALLOWED):
            fleet.update_many(keys, [time] * len(keys), columns_at(spec, [float(i)] * len(keys)))
    with suppress(*ALLOWED):
        assert fleet.snapshot()
    if made.get("verdict") == "interval":
        with suppress(*ALLOWED):
            fleet.watermark(times[-1])
    for key in keys:
        for name in ("episodes", "interval", "changes", "finish"):
            with suppress(*ALLOWED):  # of what has no monitors, too
                repr(getattr(fleet.monitor(key), name, int)())
    assert fleet.expire(before=inf) <= len(keys)
    return True


def test_unchanged_states_are_restored() -> None:
    for case, (spec, made, times) in FLEETS.items():
        assert go_on(spec, made, times[4:], fleet_state(case, 4)), case


@pytest.mark.parametrize("case", FLEETS)
@settings(max_examples=min(settings.default.max_examples, MOST_EXAMPLES))
@given(seed=st.integers(0, 2**63), count=st.sampled_from([1, 3, 4]))
def test_a_forged_state_of_a_fleet_is_refused_or_does_no_harm(case: str, seed: int, count: int) -> None:
    spec, made, times = FLEETS[case]
    go_on(spec, made, times[count:], forged(fleet_state(case, count), Random(seed)))


def test_samples_that_wait_without_a_variable_that_is_read_are_refused() -> None:
    """The core read beyond their values: the header promised that none waits, so that variables could be absent."""
    parts = fleet_snapshot.unpacked(fleet_state("records of event time", 3))
    assert parts.waiting is not None
    waiting = bytearray(parts.waiting)
    assert waiting[32:45] == struct.pack("<QI", 4, 1) + b"x"
    waiting[32:45] = struct.pack("<QI", 0, 1) + b"y"
    with pytest.raises(rtamt.UsageError) as caught:
        rtamt.Fleet.restore(
            SPEC, fleet_snapshot.packed(parts._replace(waiting=bytes(waiting))), lateness=2, gaps="restart"
        )
    assert str(caught.value) == "this is not the state of a fleet: what waits is too long"


@pytest.mark.parametrize("case", SHARDS)
@settings(max_examples=min(settings.default.max_examples, MOST_EXAMPLES))
@given(seed=st.integers(0, 2**63), count=st.sampled_from([0, 2, 5]))
def test_a_forged_state_of_a_shard_is_refused_or_does_no_harm(case: str, seed: int, count: int) -> None:
    state = forged(shard_state(case, count), Random(seed))
    stored = Checkpoint.from_bytes(Checkpoint("cars", 0, 7, state).to_bytes(), "0.checkpoint")
    try:
        shard = Shard(SPEC, state=stored.state, **SHARDS[case])
    except StlError:
        return
    for i in range(count, count + 4):
        with suppress(StlError):
            taken = shard.take([Sample(key, float(i), (float(i),)) for key in ("a", "b")], [30.0 * i] * 2)
            assert len(taken.rejected) <= 2
    with suppress(StlError):
        assert shard.snapshot()


@pytest.mark.parametrize("part", ["body", "header"])
@given(seed=st.integers(0, 2**63))
def test_a_damaged_checkpoint_is_refused_or_read(part: str, seed: int) -> None:
    content = Checkpoint("cars", 3, 17, b"state").to_bytes()[:-32]
    if part == "header":
        line, _, state = content.removeprefix(b"RTAMT-CHECKPOINT 1\n").partition(b"\n")
        content = b"RTAMT-CHECKPOINT 1\n" + damaged(line, Random(seed)) + b"\n" + state
    else:
        content = damaged(content, Random(seed))
    with suppress(StlError):
        found = Checkpoint.from_bytes(content + sha256(content).digest(), "cars-3")
        assert found.partition >= 0
        assert found.offset >= 0
