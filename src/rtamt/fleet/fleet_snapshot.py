"""The bytes of a fleet with late data or gaps: settings, what waits, and the state of the monitors.

docs/reference/fleet-state.md describes the format.
"""

from __future__ import annotations

import struct
import zlib
from math import isfinite, isnan, nan

from rtamt.errors import UsageError
from rtamt.fleet.gaps import GAPS, Gaps
from rtamt.lazy.tuples import NamedTuple

#: The first bytes of a state with late data or gaps, with a monitor for each key, and with one for each requirement.
_MAGIC, MONITORS, REQUIREMENTS = b"RTAMTFLE", b"RTAMTFLM", b"RTAMTFLS"
_VERSION = 1
_HEAD = struct.Struct("<8sHBBIdQ")
_CHECKSUM = struct.Struct("<I")


class FleetState(NamedTuple):
    """A state in parts: the settings that it was made with, what waits, and the state of the monitors."""

    gaps: Gaps
    lateness: float | None
    waiting: bytes | None
    records: bytes


def packed(state: FleetState) -> bytes:
    """Return a state as bytes (docs/reference/fleet-state.md)."""
    lateness = nan if state.lateness is None else state.lateness
    waiting = state.waiting or b""
    has_buffer = state.waiting is not None
    head = _HEAD.pack(_MAGIC, _VERSION, state.gaps.code, has_buffer, 0, lateness, len(waiting))
    body = head + waiting + state.records
    return body + _CHECKSUM.pack(zlib.crc32(body))


def unpacked(state: bytes) -> FleetState:
    """Return the parts of a state; raise :class:`UsageError` for malformed bytes."""
    if not state.startswith(_MAGIC):
        return FleetState(GAPS["reject"], None, None, state)
    if len(state) < _HEAD.size + _CHECKSUM.size:
        raise _damaged("it ends too early")
    _, version, code, has_buffer, reserved, lateness, length = _HEAD.unpack_from(state)
    if version != _VERSION:
        raise _damaged(f"its format has version {version}, and this is for version {_VERSION}")
    body = state[: -_CHECKSUM.size]
    if zlib.crc32(body) != _CHECKSUM.unpack(state[-_CHECKSUM.size :])[0]:
        raise _damaged("its checksum does not match, so it was damaged on the way")
    gaps = next((each for each in GAPS.values() if each.code == code), None)
    is_time = isnan(lateness) or (isfinite(lateness) and lateness >= 0)
    if gaps is None or has_buffer > 1 or reserved or not is_time or length > len(body) - _HEAD.size:
        raise _damaged("its header has an unknown value")
    end = _HEAD.size + length
    waiting = body[_HEAD.size : end] if has_buffer else None
    return FleetState(gaps, None if isnan(lateness) else lateness, waiting, body[end:])


def _damaged(reason: str) -> UsageError:
    return UsageError(f"this is not the state of a fleet: {reason}")
