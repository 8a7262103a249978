"""The bytes of fleets with a monitor for each key, and for each requirement (docs/reference/fleet-state.md)."""

from __future__ import annotations

import json
import struct
import zlib
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, shown
from rtamt.fleet.fields import DATA, INTEGER, KIND, NATURAL, REAL, TEXT, Field, Source, damaged, many, row
from rtamt.fleet.fleet_snapshot import MONITORS, REQUIREMENTS
from rtamt.fleet.keys import MOST, is_padded
from rtamt.lazy.tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_VERSION = 1
_HEAD = struct.Struct("<8sHHI")
_CHECKSUM = struct.Struct("<I")

#: The kinds of keys: integers, texts and bytes, as in the other states of fleets.
_KINDS: dict[type, tuple[int, Field]] = {int: (1, INTEGER), str: (2, TEXT), bytes: (3, DATA)}


class Monitors(NamedTuple):
    """A fleet with a monitor for each key: ``newest``: the time of the last sample of each key, and its state.

    ``version``: of the states, in the layout of the back end. ``made_of``: what they depend on, by name.
    """

    version: int
    made_of: Mapping[str, str]
    capacity: int
    late: int
    keys: Sequence[Any]
    newest: Sequence[float]
    states: Sequence[bytes]


_FIELDS = row(TEXT, NATURAL, NATURAL)
_STATES = many(row(REAL, DATA), list)


def packed(fleet: Monitors) -> bytes:
    """Return a fleet as bytes."""
    out = bytearray(_HEAD.pack(MONITORS, _VERSION, 0, fleet.version))
    _FIELDS.put(out, (json.dumps(dict(fleet.made_of)), fleet.capacity, fleet.late))
    kind, field = next((_KINDS[type(key)] for key in fleet.keys), (0, INTEGER))
    KIND.put(out, kind)
    many(field).put(out, fleet.keys)
    _STATES.put(out, list(zip(fleet.newest, fleet.states, strict=True)))
    return _seal(out)


def unpacked(state: bytes) -> Monitors:
    """Return a fleet from bytes; raise :class:`UsageError` for other bytes."""
    version, source = _open(state, MONITORS)
    text, capacity, late = _FIELDS.get(source)
    try:
        made_of = json.loads(text)
    except (ValueError, RecursionError):
        made_of = None
    if not isinstance(made_of, dict) or not all(isinstance(each, str) for each in made_of.values()):
        raise damaged("it does not list what it was made of")
    kind = KIND.get(source)
    field = next((field for number, field in _KINDS.values() if number == kind), INTEGER)
    keys = many(field, list).get(source)
    found = _STATES.get(source)
    source.end()
    if kind > len(_KINDS) or (kind == 0) != (not keys) or any(map(is_padded, keys)):
        raise damaged("it has other keys than a fleet")
    if len(set(keys)) != len(keys) or len(found) != len(keys) or not len(keys) <= capacity < MOST:
        raise damaged("it does not have a state for each key")
    return Monitors(
        version, made_of, capacity, late, keys, [time for time, _ in found], [one for _, one in found]
    )


def packed_requirements(fleets: Mapping[str, bytes], late: int) -> bytes:
    """Return the states of the fleets of several requirements, by name, as bytes."""
    out = bytearray(_HEAD.pack(REQUIREMENTS, _VERSION, 0, 0))
    NATURAL.put(out, late)
    many(row(TEXT, DATA)).put(out, list(fleets.items()))
    return _seal(out)


def unpacked_requirements(state: bytes) -> tuple[dict[str, bytes], int]:
    """Return the states of fleets by the names of their requirements, and how many samples were late."""
    _, source = _open(state, REQUIREMENTS)
    late = NATURAL.get(source)
    found = many(row(TEXT, DATA), list).get(source)
    source.end()
    if len(dict(found)) != len(found):
        raise damaged("it has a requirement twice")
    return dict(found), late


def require_same(theirs: Mapping[str, str], ours: Mapping[str, str]) -> None:
    """Raise :class:`UsageError` for a state that was made of something else."""
    for name in ours:
        if theirs.get(name) != ours[name]:
            raise UsageError(
                f"the state is of a fleet that differs in {name}: {shown(theirs.get(name))}, and here "
                f"{shown(ours[name])}; a fleet with a monitor for each key continues with the same requirement and "
                f"settings"
            )


def _seal(body: bytearray) -> bytes:
    return bytes(body + _CHECKSUM.pack(zlib.crc32(body)))


def _open(state: bytes, magic: bytes) -> tuple[int, Source]:
    """Return the last number of the header, and what follows."""
    if len(state) < _HEAD.size + _CHECKSUM.size:
        raise damaged("it ends too early")
    found, version, reserved, number = _HEAD.unpack_from(state)
    if found != magic:
        raise damaged("it begins with other bytes")
    if version != _VERSION:
        raise damaged(f"its format has version {version}, and this is for version {_VERSION}")
    body = state[: -_CHECKSUM.size]
    if zlib.crc32(body) != _CHECKSUM.unpack(state[-_CHECKSUM.size :])[0]:
        raise damaged("its checksum does not match, so it was damaged on the way")
    if reserved:
        raise damaged("its header has an unknown value")
    return number, Source(body[_HEAD.size :])
