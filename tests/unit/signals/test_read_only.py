"""The arrays of a trace, from which verdicts are computed, cannot be written."""

from __future__ import annotations

import numpy as np
import pytest

import rtamt

DATA = {"time": [0.0, 1.0, 2.0], "x": [5.0, 4.0, 3.0]}


def arrays_of_trace():
    trace = rtamt.read(DATA)
    channel, signal = trace.channel("x"), trace["x"]
    return [channel.times, channel.values, signal.times, signal.values]


def test_the_arrays_of_a_trace_could_be_written():
    for array in arrays_of_trace():
        with pytest.raises(ValueError, match="read-only"):
            array[0] = -9.0


def test_the_arrays_of_an_extended_trace_are_those_of_its_making():
    values = np.array([5.0, 4.0, 3.0])
    trace = rtamt.read(DATA).extended({"y": rtamt.Signal(np.array([0.0, 1.0, 2.0]), values)})
    values[0] = -9.0  # the caller's array stays one that can be written
    assert rtamt.parse("always(y >= 1)").evaluate(trace).satisfied
