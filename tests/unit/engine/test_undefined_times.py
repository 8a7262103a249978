"""The error for an undefined value has the time as the caller gives times, in every mode and both back ends."""

from __future__ import annotations

import datetime as dt

import numpy as np
import pytest

import rtamt

TEXT = "always[0:1](sqrt(x) >= 1)"
WHY = (
    "it is 0/0, inf - inf, 0 * inf, or a function outside its domain; "
    "change the formula or the data so that this cannot happen"
)
#: How times are given, the unit of numbers, and how messages have the times of 0 s and 1 s.
FORMATS = {
    "seconds": (float, None, ("0 s", "1 s")),
    "integers": (lambda t: 1000 * t, "ms", ("0 ms", "1000 ms")),
    "numbers": (lambda t: 1000.0 * t, "ms", ("0 ms", "1000 ms")),
    "minutes": (lambda t: t / 60, "min", ("0 min", "0.0166666666667 min")),
    "dates": (
        lambda t: np.datetime64(t, "s"),
        None,
        ("1970-01-01T00:00:00", "1970-01-01T00:00:01"),
    ),
    "durations": (lambda t: dt.timedelta(seconds=t), None, ("0 s", "1 s")),
}
MODES = {
    "delayed": {},
    "eager": {"verdict": "eager"},
    "interval": {"verdict": "interval"},
    "late": {"verdict": "interval", "lateness": "1s"},
    "causation": {"verdict": "causation"},
}

backends = pytest.mark.parametrize("backend", ["cpp", "python"])
formats = pytest.mark.parametrize("form", FORMATS)


def message(form, place):
    return f"'sqrt(x)' has no value at time {FORMATS[form][2][place]}: {WHY}"


def observe(monitor, given, values):
    for t, x in enumerate(values):
        monitor.update(given(t), x=x)
    monitor.finish()


@backends
@formats
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("values", [[-1], [4, -1, 4, 4]])
def test_of_a_monitor_in_dense_time(mode, values, form, backend):
    given, unit, _ = FORMATS[form]
    settings = MODES[mode] if unit is None else {**MODES[mode], "time_unit": unit}
    monitor = rtamt.parse(TEXT, time="dense", backend=backend).monitor(**settings)
    with pytest.raises(rtamt.EvaluationError) as error:
        observe(monitor, given, values)
    assert str(error.value) == message(form, len(values) > 1)


@backends
@formats
@pytest.mark.parametrize("inexact", [{}, {"uncertainty": {"x": 0.5}}], ids=["exact", "inexact"])
def test_of_a_recording_in_dense_time(inexact, form, backend):
    given, unit, _ = FORMATS[form]
    data = {"time": [given(t) for t in range(3)], "x": [4, -1, 4]}
    with pytest.raises(rtamt.EvaluationError) as error:
        rtamt.parse(TEXT, time="dense", backend=backend).evaluate(
            data, **inexact, **({} if unit is None else {"time_unit": unit})
        )
    assert str(error.value) == message(form, 1)
