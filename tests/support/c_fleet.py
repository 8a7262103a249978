"""Fleets of the C API, for tests of the shared library."""

from __future__ import annotations

import ctypes
from ctypes import (
    POINTER,
    byref,
    c_char_p,
    c_double,
    c_int32,
    c_int64,
    c_size_t,
    c_uint8,
    c_uint32,
    c_uint64,
    c_void_p,
)
from math import inf
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from tests.support.c_api import LIBRARY, OK, RefusedError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

MODES = ("delayed", "eager", "interval", "causation")


class Value(ctypes.Structure):
    """``rtamt_fleet_value``."""

    _fields_ = (("value", c_double), ("time", c_double), ("known", c_int32), ("warming", c_int32))


class Row(ctypes.Structure):
    """``rtamt_fleet_row``."""

    _fields_ = (
        ("index", c_size_t),
        ("begin", c_double),
        ("end", c_double),
        ("lower", c_double),
        ("upper", c_double),
        ("decided_at", c_double),
        ("is_final", c_int32),
    )


class Batch(ctypes.Structure):
    """``rtamt_fleet_batch``."""

    _fields_ = (
        ("count", c_size_t),
        ("keys", POINTER(c_int64)),
        ("texts", POINTER(c_char_p)),
        ("times", POINTER(c_double)),
        ("columns", POINTER(POINTER(c_double))),
        ("uppers", POINTER(POINTER(c_double))),
        ("given", POINTER(POINTER(c_uint8))),
    )


_MADE = (c_size_t, c_double, POINTER(c_void_p), c_char_p, c_size_t)
_TYPES: dict[str, tuple[tuple[Any, ...], Any]] = {
    "create": ((c_char_p, c_size_t, *_MADE), ctypes.c_int),
    "restore": ((c_char_p, c_size_t, c_char_p, c_size_t, *_MADE), ctypes.c_int),
    "destroy": ((c_void_p,), None),
    "message": ((c_void_p,), c_char_p),
    "mode": ((c_void_p,), ctypes.c_int),
    "time": ((c_void_p,), ctypes.c_int),
    "inputs": ((c_void_p,), c_uint32),
    "input": ((c_void_p, c_uint32), c_char_p),
    "outputs": ((c_void_p,), c_uint32),
    "output": ((c_void_p, c_uint32), c_char_p),
    "take": ((c_void_p, POINTER(Batch), POINTER(Value), c_size_t, POINTER(c_size_t)), ctypes.c_int),
    "watermark": ((c_void_p, c_double, POINTER(Value), c_size_t), ctypes.c_int),
    "rows": ((c_void_p, POINTER(POINTER(Row))), c_size_t),
    "late": ((c_void_p,), c_uint64),
    "is_late": ((c_void_p, c_size_t), ctypes.c_int32),
    "drop": ((c_void_p, POINTER(c_int64), c_size_t), ctypes.c_int),
    "drop_text": ((c_void_p, POINTER(c_char_p), c_size_t), ctypes.c_int),
    "expire": ((c_void_p, c_double, POINTER(c_size_t)), ctypes.c_int),
    "size": ((c_void_p,), c_size_t),
    "key": ((c_void_p, c_size_t, POINTER(c_int64), POINTER(c_char_p)), ctypes.c_int),
    "save": ((c_void_p, c_void_p, c_size_t, POINTER(c_size_t)), ctypes.c_int),
}
for _name, (_arguments, _result) in _TYPES.items():
    _function = getattr(LIBRARY, f"rtamt_fleet_{_name}")
    _function.argtypes, _function.restype = _arguments, _result


class RejectedError(RefusedError):
    """A batch was rejected: status, sentence, and the index in the batch."""


class Report(NamedTuple):
    """What a call has made known: rows of values of outputs (None: not known), and rows of other instants.

    ``late``: which samples were later than the lateness allows.
    """

    values: list[tuple[float | None, ...]]
    rows: list[tuple[Any, ...]]
    late: list[bool]


class CFleet:
    """A fleet of the library."""

    def __init__(
        self,
        program: bytes,
        capacity: int,
        *,
        tolerance: float = 0.1,
        state: bytes | None = None,
        ranges: Mapping[str, tuple[float, float]] = MappingProxyType({}),
    ) -> None:
        # ``ranges``: what is known of a value that is missing in dense time.
        self._ranges = ranges
        self._handle = c_void_p()
        message = ctypes.create_string_buffer(400)
        made = capacity, tolerance, byref(self._handle), message, len(message)
        if state is None:
            status = LIBRARY.rtamt_fleet_create(program, len(program), *made)
        else:
            status = LIBRARY.rtamt_fleet_restore(program, len(program), state, len(state), *made)
        if status != OK:
            raise RefusedError(status, message.value.decode())
        self.mode = MODES[LIBRARY.rtamt_fleet_mode(self._handle)]
        self.dense = LIBRARY.rtamt_fleet_time(self._handle) == 1
        count = LIBRARY.rtamt_fleet_inputs(self._handle)
        self.inputs = [LIBRARY.rtamt_fleet_input(self._handle, i).decode() for i in range(count)]
        count = LIBRARY.rtamt_fleet_outputs(self._handle)
        self.outputs = [LIBRARY.rtamt_fleet_output(self._handle, i).decode() for i in range(count)]

    def __del__(self) -> None:
        LIBRARY.rtamt_fleet_destroy(self._handle)

    def __len__(self) -> int:
        return int(LIBRARY.rtamt_fleet_size(self._handle))

    def _sentence(self) -> str:
        sentence: str = LIBRARY.rtamt_fleet_message(self._handle).decode()
        assert sentence.endswith(".")
        return sentence

    def _check(self, status: int) -> None:
        if status != OK:
            raise RefusedError(status, self._sentence())

    def update(
        self, keys: Sequence[Any], times: Sequence[float], columns: Mapping[str, Sequence[Any]]
    ) -> Report:
        """Take a batch as ``Fleet.update_many`` does; a value is a number, bounds, None or missing (...)."""
        n, inputs = len(keys), len(self.inputs)
        lower, upper = ((POINTER(c_double) * inputs)() for _ in range(2))
        given = (POINTER(c_uint8) * inputs)()
        bounded = False
        for i, name in enumerate(self.inputs):
            if name not in columns:
                continue
            values = [self._value(name, each) for each in columns[name]]
            given[i] = (c_uint8 * n)(*(each is not None for each in values))
            pairs = [(0.0, 0.0) if each is None else each for each in values]
            bounded = bounded or any(isinstance(each, tuple) or each is None for each in columns[name])
            lower[i] = (c_double * n)(*(low for low, _ in pairs))
            upper[i] = (c_double * n)(*(high for _, high in pairs))
        batch = Batch(n, times=(c_double * n)(*times), columns=lower, given=given)
        if bounded and self.mode in ("eager", "interval"):
            batch.uppers = upper
        if keys and isinstance(keys[0], int):
            batch.keys = (c_int64 * n)(*keys)
        else:
            batch.texts = (c_char_p * n)(*(key.encode() if isinstance(key, str) else key for key in keys))
        results, rejected = (Value * (n * len(self.outputs)))(), c_size_t(n)
        status = LIBRARY.rtamt_fleet_take(
            self._handle, byref(batch), results, len(self.outputs), byref(rejected)
        )
        if status != OK:
            raise RejectedError(status, self._sentence(), rejected.value)
        return self._report(results, n)

    def _value(self, name: str, given: Any) -> tuple[float, float] | None:
        """Return the bounds of a value; None where the sample does not have it."""
        if given is ... or (given is None and not self.dense):
            return None
        if given is None:
            return self._ranges.get(name, (-inf, inf))
        return given if isinstance(given, tuple) else (given, given)

    def watermark(self, time: float) -> Report:
        """Set the watermark of all keys."""
        n = len(self)
        results = (Value * (n * len(self.outputs)))()
        self._check(LIBRARY.rtamt_fleet_watermark(self._handle, time, results, len(self.outputs)))
        return self._report(results, n)

    def _report(self, results: Any, count: int) -> Report:
        width = len(self.outputs)
        values = [
            tuple(each.value if each.known else None for each in results[i * width : (i + 1) * width])
            for i in range(count)
        ]
        rows = POINTER(Row)()
        found = LIBRARY.rtamt_fleet_rows(self._handle, byref(rows))
        late = [bool(LIBRARY.rtamt_fleet_is_late(self._handle, i)) for i in range(count)]
        return Report(
            values, [tuple(getattr(row, name) for name, _ in Row._fields_) for row in rows[:found]], late
        )

    @property
    def late(self) -> int:
        """How many samples were late."""
        return int(LIBRARY.rtamt_fleet_late(self._handle))

    def keys(self) -> list[Any]:
        """Return all keys."""
        found: list[Any] = []
        key, text = c_int64(), c_char_p()
        while LIBRARY.rtamt_fleet_key(self._handle, len(found), byref(key), byref(text)):
            found.append(key.value if text.value is None else text.value.decode())
        return found

    def drop(self, keys: Sequence[Any]) -> None:
        """Forget keys."""
        n = len(keys)
        if keys and isinstance(keys[0], int):
            self._check(LIBRARY.rtamt_fleet_drop(self._handle, (c_int64 * n)(*keys), n))
        else:
            texts = (c_char_p * n)(*(key.encode() for key in keys))
            self._check(LIBRARY.rtamt_fleet_drop_text(self._handle, texts, n))

    def expire(self, before: float) -> int:
        """Forget keys whose newest sample is before a time."""
        dropped = c_size_t()
        self._check(LIBRARY.rtamt_fleet_expire(self._handle, before, byref(dropped)))
        return dropped.value

    def snapshot(self) -> bytes:
        """Return the state."""
        size = c_size_t()
        self._check(LIBRARY.rtamt_fleet_save(self._handle, None, 0, byref(size)))
        state = ctypes.create_string_buffer(size.value)
        self._check(LIBRARY.rtamt_fleet_save(self._handle, state, size, byref(size)))
        return state.raw
