"""The base class of monitors in the core: methods, references, threads."""

from __future__ import annotations

import gc
import numbers
import sys
import threading
import weakref
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import rtamt
from rtamt.compiler.program import Instruction
from rtamt.errors import UsageError
from tests.unit.engine.discrete.programs import CORE, A, B, monitor, program, state


class Watcher(CORE.MonitorBase):
    """As the monitors of Python are made: the back end takes the sample, and Python where that does not do."""

    def __init__(self, backend: Any) -> None:
        super().__init__()
        self._backend = backend
        self.asked: list[Any] = []

    def _update_carefully(self, *args: Any, **values: Any) -> str:
        self.asked.append((args, values))
        return "asked"

    _step_carefully = _update_carefully

    def _no_value(self, error: Exception) -> Exception:
        return ArithmeticError(*error.args)


def test_a_method_is_taken_over_where_the_monitor_takes_the_sample() -> None:
    watcher = Watcher(monitor())
    reference = monitor()
    assert watcher.update(0.5, b=2, a=np.float64(3)) == reference.update(0.5, {"a": 3.0, "b": 2.0})
    assert Watcher.update(watcher, 1.5, a=1, b=2) == reference.update(1.5, {"a": 1.0, "b": 2.0})
    step = watcher.step
    assert step(4, 5.0) == reference.step(4.0, 5.0)
    assert watcher.asked == []
    assert state(watcher._backend) == state(reference)


@pytest.mark.parametrize(
    ("args", "values"),
    [
        ((0.0,), {"a": 1.0}),
        ((0.0,), {"a": 1.0, "b": float("nan")}),
        ((0.0,), {"a": 1.0, "c": 1.0}),
        (("0",), {"a": 1.0, "b": 1.0}),
        ((), {"a": 1.0, "b": 1.0}),
        ((0.0, 1.0), {"a": 1.0, "b": 1.0}),
    ],
)
def test_what_the_monitor_refuses_goes_to_the_function_as_it_came(args: Any, values: Any) -> None:
    watcher = Watcher(monitor())
    before = state(watcher._backend)
    assert watcher.update(*args, **values) == "asked"
    assert watcher.asked == [(args, values)]
    assert state(watcher._backend) == before


def test_without_a_compiled_monitor_the_function_is_called() -> None:
    for backend in (CORE.DenseMonitor, object()):
        watcher = Watcher(backend)
        assert (watcher.update(0.0, a=1.0, b=1.0), watcher.step(1.0)) == ("asked", "asked")
    with pytest.raises(TypeError, match="MonitorBase"):
        Watcher.update(object(), 0.0)
    with pytest.raises(TypeError, match=r"^The monitor was never initialised\.$"):
        Watcher.__new__(Watcher).update(0.0)


def test_python_makes_the_error_of_an_undefined_value() -> None:
    ratio = program(A, B, Instruction("div", a=0, b=1), outputs=(2,), inputs=("a", "b"))
    watcher = Watcher(CORE.Monitor(ratio, ["a", "b"]))
    with pytest.raises(ArithmeticError) as raised:
        watcher.update(0.0, a=0.0, b=0.0)
    assert (raised.value.args, watcher.asked) == ((2, 0), [])


def test_a_monitor_that_holds_itself_is_collected() -> None:
    watcher = Watcher(object())
    watcher._backend = watcher
    there = weakref.ref(watcher)
    del watcher
    gc.collect()
    assert there() is None


def test_what_a_number_raises_by_itself_is_not_asked_about() -> None:
    class Stop:
        def __float__(self) -> float:
            raise KeyboardInterrupt

    numbers.Real.register(Stop)
    watcher = Watcher(monitor())
    with pytest.raises(KeyboardInterrupt):
        watcher.update(0.0, a=Stop(), b=1.0)
    assert watcher.asked == []


def test_calls_neither_lose_nor_keep_references() -> None:
    m = monitor(ignored={"c"})
    m.step(1.0, 1.0)
    value, name, pair, values = 1234.5, "unseen", ("a", 2.5), {"a": 1.5, "b": 2.5}
    watched = (None, value, name, pair, values)
    gc.collect()  # what others left behind holds None too
    before = [sys.getrefcount(thing) for thing in watched]
    for i in range(1000):
        m.update(2.0 * i + 1, values)
        m.update_pairs(2.0 * i + 2, [pair, ("b", value)])
        m.step(value, Fraction(1, 2))
        m.reset()
        m.step(value, 1.0)
        m.reset()
        m.step(value, value)
        for pairs in ([(name, value)], [pair, pair, value]):
            with pytest.raises(CORE.Refused):
                m.update_pairs(1e9, pairs)
        m.reset()
        m.step(value, value)
        m.reset()
    m.reset()
    gc.collect()
    after = [sys.getrefcount(thing) for thing in watched]
    assert max(abs(a - b) for a, b in zip(after, before, strict=True)) < 100


def complaint(m: Any) -> str | None:
    try:
        m.step(1.0, 1.0)
    except UsageError as error:
        return str(error)
    return None


def test_a_monitor_in_use_by_another_thread_says_so_and_goes_on_undisturbed() -> None:
    n = 2_000_000
    column = np.ones(n)
    m = monitor()
    answers: list[str | None] = []
    pushes = 0
    while set(answers) <= {None}:  # the two threads may miss each other
        assert pushes < 100
        thread = threading.Thread(target=lambda: m.push(None, [column, column]))
        thread.start()
        while thread.is_alive():
            answers.append(complaint(m))
        thread.join()
        pushes += 1
    assert set(answers) - {None} == {
        "the monitor is in use by another call, from another thread or from a value or operator that calls it "
        "back; give each thread a monitor of its own"
    }
    assert m.samples == pushes * n + answers.count(None)


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_field_is_read_once_a_sample(time: Any) -> None:
    reads: list[float] = []

    class Request:
        @property
        def value(self) -> float:
            reads.append(5.0)
            return 5.0

    monitor = rtamt.parse("gnt >= req.value").monitor(time=time)
    for t in range(3):
        monitor.update(float(t), gnt=1.0, req=Request())
    assert len(reads) == 3
