"""The result of an update in dense time: a signal whose points lie in the object itself."""

from __future__ import annotations

import copy
import gc
import pickle
import sys
from datetime import datetime, timedelta
from typing import Any

import numpy as np
import pytest

import rtamt
from rtamt.signals.signal import Signal

_core = pytest.importorskip("rtamt.engine._core")


def result(points: int, first: Any = 0.0, step: Any = 1.0) -> Any:
    """Return the result of an update that makes the values of y, which runs ahead of x, known at whole steps."""
    monitor = rtamt.parse("y >= 0 and x >= -99").monitor(time="dense")
    monitor.update(first - step, x=0.0, y=-1.0)
    for i in range(points):
        assert len(monitor.update(first + i * step, y=float(i))) == 0
    return monitor.update(first + (points - 1) * step, x=0.0)


@pytest.mark.parametrize("points", range(1, 9))
def test_results_of_every_length_are_signals(points: int) -> None:
    told = result(points)
    assert isinstance(told, Signal)
    assert len(told) == points
    assert told.points() == [(float(i), float(i)) for i in range(points)]
    assert told.times.tolist() == told.values.tolist() == [float(i) for i in range(points)]
    assert told.times is told.times  # made once
    assert repr(told) == f"Signal(times={told.times!r}, values={told.values!r})"


@pytest.mark.parametrize("points", [1, 5])
@pytest.mark.parametrize(
    ("first", "step"),
    [(0.0, 0.5), (datetime(2026, 11, 23), timedelta(seconds=1)), (timedelta(0), timedelta(milliseconds=1))],
)
def test_copies_are_signals_of_their_own(points: int, first: Any, step: Any) -> None:
    told = result(points, first, step)
    for copied in (copy.copy(told), copy.deepcopy(told), pickle.loads(pickle.dumps(told))):
        assert type(copied) is Signal
        assert np.array_equal(copied.times, told.times)
        assert copied.times.dtype == told.times.dtype
        assert copied.values.tolist() == told.values.tolist() == [float(i) for i in range(points)]
        assert copied.points() == told.points()


@pytest.mark.parametrize("points", [1, 5])
def test_results_leave_no_memory_and_no_references_behind(points: int) -> None:
    told = result(points)
    referred = told._scale, type(told), told.times

    def references() -> list[int]:
        gc.collect()
        return [sys.getrefcount(each) for each in referred]

    before = references()
    copies = [copy.copy(told) for _ in range(3)]  # they share the times
    assert [now - then for now, then in zip(references(), before, strict=True)] == [0, 0, 3]
    more = [result(points) for _ in range(10)]
    assert [now - then for now, then in zip(references(), before, strict=True)] == [0, 10, 3]
    del copies, more, told
    assert [now - then for now, then in zip(references(), before, strict=True)] == [-1, -1, -1]


def test_results_can_neither_be_made_nor_changed_nor_derived_from() -> None:
    told = result(2)
    with pytest.raises(TypeError, match=r"^cannot create 'rtamt.engine._core.UpdateSignal' instances$"):
        type(told)()
    with pytest.raises(TypeError, match=r"UpdateSignal' is not an acceptable base type$"):
        type("Derived", (type(told),), {})
    with pytest.raises(AttributeError):
        told._events = b""
    with pytest.raises(AttributeError):
        told.anything = 1


@pytest.mark.parametrize("base", [int, tuple, Exception, type("WithDict", (), {})])
def test_the_base_of_results_has_slots_alone(base: type) -> None:
    with pytest.raises(ValueError, match=r"^The base of an update signal has more than slots.$"):
        _core.update_signal_class(base)
