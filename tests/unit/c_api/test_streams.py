"""States of streams of the C API are those of fleets in Python."""

from __future__ import annotations

import ctypes
from ctypes import (
    POINTER,
    byref,
    c_char_p,
    c_double,
    c_int64,
    c_size_t,
    c_uint64,
    c_void_p,
    create_string_buffer,
    pointer,
)

import pytest

import rtamt
from tests.support.c_api import LIBRARY, OK, UNDEFINED

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
LIBRARY.rtamt_stream_message.argtypes = (c_void_p,)
LIBRARY.rtamt_stream_message.restype = c_char_p
LIBRARY.rtamt_stream_culprit.argtypes = (c_void_p, c_void_p)
LIBRARY.rtamt_stream_discard_text.argtypes = (c_void_p, c_char_p, c_double)
LIBRARY.rtamt_stream_drop_text.argtypes = (c_void_p, POINTER(c_char_p), c_size_t)
LIBRARY.rtamt_stream_update_text.argtypes = (
    c_void_p, POINTER(c_char_p), POINTER(c_double), POINTER(POINTER(c_double)), c_size_t, c_void_p,
    POINTER(c_size_t), POINTER(c_size_t),
)  # fmt: skip


class Sample(ctypes.Structure):
    """``rtamt_stream_sample``."""

    _fields_ = (("key", c_int64), ("text", c_char_p), ("time", c_double))


def restored(state: bytes, program: bytes = PROGRAM) -> tuple[c_void_p | None, str]:
    """Return a stream in a state, or why it is refused."""
    stream, message = c_void_p(), create_string_buffer(300)
    status: int = LIBRARY.rtamt_stream_restore(
        program, len(program), state, len(state), 0, 0.1, byref(stream), message, len(message)
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


def updated(stream: c_void_p, key: bytes, time: float, *values: float) -> tuple[int, int]:
    """Take a sample; return the status, and the index that is rejected."""
    rejected = c_size_t(9)
    columns = (POINTER(c_double) * len(values))(*(pointer(c_double(value)) for value in values))
    status: int = LIBRARY.rtamt_stream_update_text(
        stream, (c_char_p * 1)(key), (c_double * 1)(time), columns, 1, None, None, byref(rejected)
    )
    return status, rejected.value


def saved(stream: c_void_p) -> bytes:
    size = c_size_t()
    assert LIBRARY.rtamt_stream_save(stream, None, 0, byref(size)) == OK
    state = create_string_buffer(size.value)
    assert LIBRARY.rtamt_stream_save(stream, state, size, byref(size)) == OK
    return state.raw


def test_keys_of_a_state_that_are_bytes_are_texts_in_c() -> None:
    """The stream was restored, but took no key: not even those that it had."""
    fleet = rtamt.Fleet(SPEC, 5, lateness=2)
    fleet.update_many([b"a", b"\xff"], [0, 0], {"x": [9, 1], "y": [1, 1]})
    stream, message = restored(fleet.snapshot(), fleet.compile())
    assert stream is not None, message
    assert updated(stream, b"\xff", 1.0, 2.0, 1.0) == (OK, 1)
    fleet.update_many([b"\xff"], [1], {"x": [2], "y": [1]})
    assert saved(stream) == fleet.snapshot()
    assert LIBRARY.rtamt_stream_discard_text(stream, b"\xff", 1.0) == OK
    assert LIBRARY.rtamt_stream_drop_text(stream, (c_char_p * 1)(b"a"), 1) == OK
    assert rtamt.Fleet.restore(SPEC, saved(stream)).keys() == [b"\xff"]
    LIBRARY.rtamt_stream_destroy(stream)


def test_the_culprit_of_a_held_value_without_a_result_is_the_sample_after_the_gap() -> None:
    """It was the held value, at whose time no sample waits: nothing could be discarded."""
    spec = rtamt.parse("y / (x - delay[1](x, -1)) >= 3", period="1s")
    fleet = rtamt.Fleet(spec, 5, lateness=2, gaps="hold")
    fleet.update_many(["a", "a"], [0, 3], {"x": [1, 2], "y": [0, 0]})
    stream, message = restored(fleet.snapshot(), fleet.compile())
    assert stream is not None, message
    values = [{"x": 3.0, "y": 0.0}[name] for name in spec.input_names]
    assert updated(stream, b"a", 5.0, *values) == (UNDEFINED, 1)
    assert LIBRARY.rtamt_stream_message(stream).startswith(
        b"Key 'a', a sample that waited, has no value of 'y / (x - delay[1](x, -1))' at sample 1, time 1 s: it is "
    )
    culprit = Sample()
    assert LIBRARY.rtamt_stream_culprit(stream, byref(culprit)) == OK
    assert (culprit.text, culprit.time) == (b"a", 3.0)
    assert LIBRARY.rtamt_stream_discard_text(stream, b"a", 3.0) == OK
    LIBRARY.rtamt_stream_destroy(stream)


def test_programs_of_other_kinds_are_refused_with_what_streams_run() -> None:
    dense = rtamt.parse("always[0:2](x >= 3)", time="dense", resolution="1s").compile().to_bytes()
    early = SPEC.compile(verdict="interval").to_bytes()
    for program, kind in (
        (early, "This program of bounds is for one monitor"),
        (dense, "This program of dense time is for one monitor"),
        (
            rtamt.Fleet(SPEC, 3, verdict="eager").compile(),
            "This program has a monitor for each key, which fleets run",
        ),
    ):
        stream, message = restored(b"", program)
        assert stream is None
        assert message == (
            f"{kind}: a stream has delayed verdicts in discrete time, so compile it without --verdict and --time."
        )


def test_states_without_lateness_are_refused() -> None:
    for settings in ({}, {"gaps": "restart"}, {"gaps": "hold"}):
        stream, message = restored(rtamt.Fleet(SPEC, 5, **settings).snapshot())
        assert stream is None
        assert message == "This is not the state of a fleet: it is no state of a fleet with lateness."
