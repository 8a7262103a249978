"""States of streams of the C API are those of fleets in Python."""

from __future__ import annotations

import ctypes
from ctypes import POINTER, byref, c_char_p, c_double, c_size_t, c_uint64, c_void_p, create_string_buffer

import pytest

import rtamt
from tests.support.c_api import LIBRARY, OK

SPEC = rtamt.parse("always[0:2](x / y >= 3)", period="1s")
PROGRAM = SPEC.compile().to_bytes()
LIBRARY.rtamt_stream_restore.argtypes = (
    c_char_p, c_size_t, c_char_p, c_size_t, c_size_t, c_double, POINTER(c_void_p), c_char_p, c_size_t,
)  # fmt: skip
LIBRARY.rtamt_stream_save.argtypes = (c_void_p, c_void_p, c_size_t, POINTER(c_size_t))
LIBRARY.rtamt_stream_destroy.argtypes = (c_void_p,)
LIBRARY.rtamt_stream_waiting.argtypes = LIBRARY.rtamt_stream_late.argtypes = (c_void_p,)
LIBRARY.rtamt_stream_late.restype = c_uint64
LIBRARY.rtamt_stream_waiting.restype = c_size_t
LIBRARY.rtamt_stream_watermark.argtypes = (c_void_p, c_double, POINTER(c_size_t))


def restored(state: bytes) -> tuple[c_void_p | None, str]:
    """Return a stream in a state, or why it is refused."""
    stream, message = c_void_p(), create_string_buffer(300)
    status: int = LIBRARY.rtamt_stream_restore(
        PROGRAM, len(PROGRAM), state, len(state), 0, 0.1, byref(stream), message, len(message)
    )
    return (stream if status == OK else None), message.value.decode()


@pytest.mark.parametrize("gaps", ["restart", "hold"])
@pytest.mark.parametrize("keys", [["a", "Ä", "a", "a"], [7, -8, 7, 7], [b"a", b"\xff", b"a", b"a"]])
def test_a_state_of_python_goes_on_in_c_and_back(gaps: str, keys: list[object]) -> None:
    fleet = rtamt.Fleet(SPEC, 5, lateness=2, gaps=gaps)
    fleet.update_many(keys, [0, 1, 4, 3], {"x": [9, 1, 2, 3], "y": [1, 1, 2, 1]})
    fleet.update_many(keys[:1], [0], {"x": [1], "y": [1]})
    stream, message = restored(fleet.snapshot())
    assert stream is not None, message
    assert LIBRARY.rtamt_stream_waiting(stream) == fleet.waiting == 3
    assert LIBRARY.rtamt_stream_late(stream) == fleet.late == 1
    released, size = c_size_t(), c_size_t()
    assert LIBRARY.rtamt_stream_watermark(stream, 2.0, byref(released)) == OK
    fleet.watermark(2.0)
    assert LIBRARY.rtamt_stream_save(stream, None, 0, byref(size)) == OK
    state = ctypes.create_string_buffer(size.value)
    assert LIBRARY.rtamt_stream_save(stream, state, size, byref(size)) == OK
    LIBRARY.rtamt_stream_destroy(stream)
    again = rtamt.Fleet.restore(SPEC, state.raw)
    assert (again.late, again.waiting, sorted(again.keys(), key=str)) == (1, 2, sorted(set(keys), key=str))
    batch = keys[:1] * 3, [2, 5, 6], {"x": [4, 5, 6], "y": [1, 1, 1]}
    assert repr(again.update_many(*batch)) == repr(fleet.update_many(*batch))


def test_states_without_lateness_are_refused() -> None:
    for settings in ({}, {"gaps": "restart"}, {"gaps": "hold"}):
        stream, message = restored(rtamt.Fleet(SPEC, 5, **settings).snapshot())
        assert stream is None
        assert message == "This is not the state of a fleet: it is no state of a fleet with lateness."
