"""The C API as a Python program sees it, without the extension module: for tests of the shared library."""

from __future__ import annotations

import ctypes
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_int32, c_int64, c_size_t, c_uint32, c_void_p

import numpy as np

from rtamt import c_api

OK, REFUSED, UNDEFINED, NO_MEMORY = range(4)


class Value(ctypes.Structure):
    """``rtamt_value``."""

    _fields_ = (("value", c_double), ("known", c_int32))


class Sample(ctypes.Structure):
    """``rtamt_sample``."""

    _fields_ = (("tick", c_int64), ("value", c_double), ("input", c_uint32))


def _load() -> ctypes.CDLL:
    library = ctypes.CDLL(str(c_api.library()))
    library.rtamt_create.argtypes = (c_char_p, c_size_t, POINTER(c_void_p), c_char_p, c_size_t)
    library.rtamt_destroy.argtypes = (c_void_p,)
    library.rtamt_message.argtypes = (c_void_p,)
    library.rtamt_message.restype = c_char_p
    library.rtamt_set_parameter.argtypes = (c_void_p, c_uint32, c_double)
    library.rtamt_step.argtypes = (c_void_p, POINTER(c_double), c_size_t, POINTER(Value), c_size_t)
    library.rtamt_push.argtypes = (c_void_p, POINTER(Sample), c_size_t)
    library.rtamt_finish.argtypes = (c_void_p,)
    library.rtamt_reset.argtypes = (c_void_p,)
    library.rtamt_last_output.argtypes = (
        c_void_p,
        c_uint32,
        POINTER(POINTER(c_int64)),
        POINTER(POINTER(c_double)),
    )
    library.rtamt_last_output.restype = c_size_t
    library.rtamt_save.argtypes = (c_void_p, c_void_p, c_size_t, POINTER(c_size_t))
    library.rtamt_restore.argtypes = (c_void_p, c_char_p, c_size_t)
    return library


LIBRARY = _load()


class RefusedError(Exception):
    """What the library said no to: the status and the sentence."""


class Monitor:
    """One monitor of the library."""

    def __init__(self, program: bytes) -> None:
        self._handle = c_void_p()
        message = ctypes.create_string_buffer(400)
        status = LIBRARY.rtamt_create(program, len(program), byref(self._handle), message, len(message))
        if status != OK:
            raise RefusedError(status, message.value.decode())

    def __del__(self) -> None:
        LIBRARY.rtamt_destroy(self._handle)

    def _check(self, status: c_int) -> None:
        if status != OK:
            raise RefusedError(status, LIBRARY.rtamt_message(self._handle).decode())

    def step(self, row, outputs=2):
        """Return what one sample made known of each output; None is nothing."""
        known = (Value * outputs)()
        values = (c_double * len(row))(*row)
        self._check(LIBRARY.rtamt_step(self._handle, values, len(row), known, outputs))
        return [each.value if each.known else None for each in known]

    def push(self, samples):
        """Take (input, tick, value) triples; return the new events of the first output."""
        array = (Sample * len(samples))(*(Sample(tick, value, name) for name, tick, value in samples))
        self._check(LIBRARY.rtamt_push(self._handle, array, len(samples)))
        return self.last_output(0)

    def finish(self):
        """Return the rest of the first output."""
        self._check(LIBRARY.rtamt_finish(self._handle))
        return self.last_output(0)

    def last_output(self, output):
        """Return steps and values that the last call made known."""
        steps, values = POINTER(c_int64)(), POINTER(c_double)()
        count = LIBRARY.rtamt_last_output(self._handle, output, byref(steps), byref(values))
        return np.array(steps[:count], np.int64), np.array(values[:count], float)

    def set_parameter(self, index, value):
        """Set a parameter before the first sample."""
        self._check(LIBRARY.rtamt_set_parameter(self._handle, index, value))

    def reset(self):
        """Forget the trace."""
        LIBRARY.rtamt_reset(self._handle)

    def save(self) -> bytes:
        """Return the state."""
        size = c_size_t()
        self._check(LIBRARY.rtamt_save(self._handle, None, 0, byref(size)))
        state = ctypes.create_string_buffer(size.value)
        self._check(LIBRARY.rtamt_save(self._handle, state, size, byref(size)))
        return state.raw

    def restore(self, state: bytes) -> None:
        """Take over a state."""
        self._check(LIBRARY.rtamt_restore(self._handle, state, len(state)))
