"""When the keys of a shard had their last message, so that silent ones can be forgotten.

The clock is that of the messages: the latest of their timestamps. So which keys expire, and before which message,
depends on the messages alone, not on their batches, or on when they are read.
"""

from __future__ import annotations

import struct
import zlib
from math import inf, isfinite
from typing import TYPE_CHECKING

from rtamt.fleet.fields import DATA, REAL, TEXT, Source, damaged, mapping, row

if TYPE_CHECKING:
    from collections.abc import Iterable

_MAGIC = b"RTAMTSHD"
_HEAD = struct.Struct("<8sHHI")
_VERSION = 1
_FIELDS = row(REAL, mapping(TEXT, REAL), DATA)


class Arrivals:
    """The time of the last message of each key. ``lifetime``: seconds after which a silent key expires.

    >>> arrivals = Arrivals(60.0)
    >>> [arrivals.note("car-1", 0.0), arrivals.note("car-2", 61.0), arrivals.note("car-1", 61.0)]
    [False, False, True]
    >>> arrivals.note("car-3", 122.0), arrivals.pop_expired()
    (False, ['car-2', 'car-1'])
    """

    def __init__(self, lifetime: float) -> None:
        self._lifetime = lifetime
        self._clock = -inf
        #: In the order of their times.
        self._last: dict[str, float] = {}

    def note(self, key: str, time: float) -> bool:
        """Note a message; return whether its key has expired before it. ``time``: NaN if it has no timestamp."""
        if time > self._clock and isfinite(time):
            if self._clock == -inf:  # only now it is known what time it is
                self._last = dict.fromkeys(self._last, time)
            self._clock = time
        last = self._last.pop(key, None)
        self._last[key] = self._clock
        return last is not None and self._clock - last > self._lifetime

    def pop_expired(self) -> list[str]:
        """Return the keys that have expired, and forget them."""
        found = []
        for key, last in self._last.items():
            if not self._clock - last > self._lifetime:
                break
            found.append(key)
        for key in found:
            del self._last[key]
        return found

    def begin(self, keys: Iterable[str]) -> None:
        """Let the lifetime of keys whose messages were not noted begin now."""
        for key in keys:
            self._last.setdefault(key, self._clock)

    # ---- state -----------------------------------------------------------------------------------

    def pack_state(self, state: bytes) -> bytes:
        """Return these times and the state of a fleet as bytes."""
        out = bytearray(_HEAD.pack(_MAGIC, _VERSION, 0, 0))
        _FIELDS.put(out, (self._clock, self._last, state))
        return bytes(out + struct.pack("<I", zlib.crc32(out)))

    def unpack_state(self, state: bytes) -> bytes:
        """Restore the times of a state, if it has any; return the state of the fleet."""
        if not state.startswith(_MAGIC):
            return state
        if len(state) < _HEAD.size + 4 or zlib.crc32(state[:-4]) != int.from_bytes(state[-4:], "little"):
            raise damaged("its checksum does not match, so it was damaged on the way")
        _, version, *reserved = _HEAD.unpack_from(state)
        if version != _VERSION or any(reserved):
            raise damaged(f"its format has version {version}, and this is for version {_VERSION}")
        source = Source(state[_HEAD.size : -4])
        clock, last, rest = _FIELDS.get(source)
        source.end()
        times = list(last.values())
        if clock == inf or times != sorted(times) or not all(time <= clock for time in times):
            raise damaged("its keys are not in the order of their last messages")
        self._clock, self._last = clock, last
        return bytes(rest)
