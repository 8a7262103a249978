"""A monitor that two calls use at once: from threads, or because a value or a field calls it back.

Each sample is taken whole or refused, in some order, as if one call had come after the other; what is raised
is an error of the library's.
"""

from __future__ import annotations

import copy
import os
import pickle
import subprocess
import sys
import sysconfig
import threading
from contextlib import suppress
from itertools import count, product
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import rtamt
from rtamt.errors import StlError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    Action = Callable[[Any], Any]

BACKENDS = ("cpp", "python")


class Meddler:
    """A number that does something while it is read; what the library raises then is kept."""

    def __init__(self, action: Callable[[], Any]) -> None:
        self._action = action
        self.again = False

    def __float__(self) -> float:
        if not self.again:
            self.again = True
            with suppress(StlError):
                self._action()
        return 2.0


class Three:
    """The number 3, which reads another one first."""

    def __init__(self, other: Any) -> None:
        self._other = other

    def __float__(self) -> float:
        float(self._other)
        return 3.0


class Slow:
    """A number that lets other threads run while it is read."""

    def __init__(self, value: float) -> None:
        self._value = float(value)

    def __float__(self) -> float:
        for _ in range(20):
            pass
        return self._value


Real.register(Meddler)
Real.register(Slow)
Real.register(Three)


class Message:
    """A message whose field does something while it is read."""

    def __init__(self, number: Any) -> None:
        self._number = number

    @property
    def value(self) -> Any:
        return float(self._number)


# ---- a value that calls back ---------------------------------------------------------------------

# What takes a sample of x, given as any number; later than 2 and 10 s.
TAKING: dict[str, dict[str, Callable[[Any, Any], Any]]] = {
    "discrete": {
        "update": lambda m, x: m.update(3.0, x=x),
        "step": lambda m, x: m.step(x),
        "update_many": lambda m, x: m.update_many({"time": [3.0, 4.0], "x": [1.0, x]}),
        "time": lambda m, x: m.update(Three(x), x=2),
    },
    "dense": {
        "update": lambda m, x: m.update(3.0, x=x),
        "update_many": lambda m, x: m.update_many({"x": ([3.0, 4.0], [1.0, x])}),
    },
}
CALLING: dict[str, Action] = {
    "update": lambda m: m.update(10.0, x=7.0),
    "earlier": lambda m: m.update(2.5, x=7.0),
    "update_many": lambda m: m.update_many({"time": [11.0, 12.0], "x": [8.0, 1.0]}),
    "finish": lambda m: m.finish(),
    "reset": lambda m: m.reset(),
    "begin again": lambda m: (m.reset(), m.update(0.0, x=7.0)),
    "copy": copy.copy,
    "pickle": pickle.dumps,
    "samples": lambda m: m.samples,
    "memory": lambda m: m.memory,
    "watched": lambda m: m["x >= 5"],
}


def begun(domain: str, backend: str) -> Any:
    spec = rtamt.parse("once[0:2](x >= 3) or eventually[0:1](x >= 5)", backend=backend)
    options: dict[str, Any] = {"period": 1, "tolerance": 1e9} if domain == "discrete" else {"time": "dense"}
    monitor = spec.monitor(watch=["x >= 5"], **options)
    for time, x in ((0.0, 4.0), (2.0, 1.0)):
        monitor.update(time, x=x)
    return monitor


def seen(monitor: Any) -> list[str]:
    """Return all that can be seen of a monitor, by going on with it."""
    answers = [str(monitor.samples)]
    for call in (
        lambda: monitor["x >= 5"],
        lambda: monitor.update(50.0, x=6.0),
        lambda: monitor.update(51.0, x=2.0),
        monitor.finish,
    ):
        with suppress(StlError):
            answers.append(repr(call()))
    return answers


def tried(monitor: Any, *actions: Callable[[Any], Any]) -> Any:
    for action in actions:
        with suppress(StlError):
            action(monitor)
    return monitor


@pytest.mark.parametrize("calling", CALLING)
@pytest.mark.parametrize(
    ("domain", "taking"), [(domain, taking) for domain, ways in TAKING.items() for taking in ways]
)
@pytest.mark.parametrize("backend", BACKENDS)
def test_a_value_that_calls_its_monitor_leaves_it_as_one_call_after_the_other_would(
    backend: str, domain: str, taking: str, calling: str
) -> None:
    take, call = TAKING[domain][taking], CALLING[calling]
    monitor = begun(domain, backend)
    value = Meddler(lambda: call(monitor))
    tried(monitor, lambda m: take(m, value))
    assert value.again
    plain: Action = lambda m: take(m, 2.0)  # noqa: E731
    orders: tuple[tuple[Action, ...], ...] = ((call, plain), (plain, call), (call,), (plain,), ())
    assert seen(monitor) in [seen(tried(begun(domain, backend), *order)) for order in orders]


@pytest.mark.parametrize("calling", ["update", "reset", "finish", "update_many", "copy"])
@pytest.mark.parametrize("domain", ["discrete", "dense"])
@pytest.mark.parametrize("backend", BACKENDS)
def test_a_field_that_calls_its_monitor_leaves_it_as_one_call_after_the_other_would(
    backend: str, domain: str, calling: str
) -> None:
    options: dict[str, Any] = {"period": 1, "tolerance": 1e9} if domain == "discrete" else {"time": "dense"}
    call: dict[str, Action] = {
        "update": lambda m: m.update(10.0, req=Message(7.0)),
        "update_many": lambda m: m.update_many({"time": [11.0], "req.value": [8.0]}),
        **{name: CALLING[name] for name in ("reset", "finish", "copy")},
    }

    def fresh() -> Any:
        made = rtamt.parse("once[0:2](req.value >= 3)", backend=backend).monitor(**options)
        return tried(made, lambda m: m.update(2.0, req=Message(1.0)))

    def after(m: Any) -> list[str]:
        return [
            str(m.samples),
            *(repr(tried(m, lambda m, t=t: m.update(t, req=Message(t))).samples) for t in (50.0, 51.0)),
        ]

    monitor = fresh()
    value = Meddler(lambda: call[calling](monitor))
    tried(monitor, lambda m: m.update(3.0, req=Message(value)))
    assert value.again
    plain: Action = lambda m: m.update(3.0, req=Message(2.0))  # noqa: E731
    orders: tuple[tuple[Action, ...], ...] = (
        (call[calling], plain),
        (plain, call[calling]),
        (call[calling],),
    )
    assert after(monitor) in [after(tried(fresh(), *order)) for order in orders]


@pytest.mark.parametrize("domain", ["discrete", "dense"])
@pytest.mark.parametrize("backend", BACKENDS)
def test_a_value_that_is_read_by_reading_itself_ends_and_spares_the_monitor(
    backend: str, domain: str
) -> None:
    monitor = begun(domain, backend)
    before = seen(copy.copy(monitor))

    class Endless(Meddler):
        def __float__(self) -> float:
            monitor.update(3.0, x=self)
            return 1.0

    with pytest.raises((RecursionError, StlError)):
        monitor.update(3.0, x=Endless(print))
    assert seen(monitor) == before


@pytest.mark.parametrize("domain", ["discrete", "dense"])
@pytest.mark.parametrize("backend", BACKENDS)
def test_what_a_value_raises_by_itself_reaches_the_caller_and_spares_the_monitor(
    backend: str, domain: str
) -> None:
    monitor = begun(domain, backend)
    before = seen(copy.copy(monitor))

    class Rude(Meddler):
        def __float__(self) -> float:
            raise LookupError("mine")

    for call in TAKING[domain].values():
        with pytest.raises(LookupError, match=r"^'?mine'?$"):
            call(monitor, Rude(print))
    assert seen(monitor) == before


def test_a_list_that_is_emptied_while_it_is_read_is_no_danger() -> None:
    spec = rtamt.StlDiscreteTimeSpecification()
    for name in ("x", "y"):
        spec.declare_var(name, "float")
    spec.spec = "x - y"
    spec.parse()
    spec.update(0, [("x", 1.0), ("y", 1.0)])
    sample: list[Any] = []
    sample += [["x", Meddler(sample.clear)], ["y", 5.0]]
    assert spec.update(1, sample) == 1.0  # y, which was gone by then, keeps its value


# ---- threads -------------------------------------------------------------------------------------

THREADS = 3
NUMBERS: dict[str, Callable[[float], Any]] = {"float32": np.float32, "own": Slow, "float": float}


@pytest.fixture
def hasty() -> Iterator[None]:
    """Let Python switch between threads as often as it can."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(before)


def at_once(work: Callable[[int], Any]) -> None:
    """Call ``work`` with a number of its own in each thread; raise what one of them raises."""
    failures: list[Exception] = []
    barrier = threading.Barrier(THREADS)

    def run(k: int) -> None:
        try:
            barrier.wait()
            work(k)
        except Exception as error:  # noqa: BLE001 - handed on
            failures.append(error)

    threads = [threading.Thread(target=run, args=(k,)) for k in range(1, THREADS + 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for failure in failures:
        raise failure


def pairs_of(clock: Iterator[int], number: Callable[[float], Any]) -> dict[str, Callable[[Any, int], Any]]:
    """Return ways to give samples of which x and y are the number of a thread."""

    def chunk(k: int) -> list[Any]:
        return [number(k)] * 3

    def times() -> list[float]:
        first = 10.0 * next(clock)
        return [first, first + 1, first + 2]

    return {
        "step": lambda m, k: m.step(number(k), number(k)),
        "update": lambda m, k: m.update(10.0 * next(clock), x=number(k), y=number(k)),
        "update_many": lambda m, k: m.update_many({"time": times(), "x": chunk(k), "y": chunk(k)}),
    }


@pytest.mark.usefixtures("hasty")
@pytest.mark.parametrize("number", NUMBERS)
@pytest.mark.parametrize(
    ("domain", "way"),
    [
        *product(["discrete"], ["step", "update", "update_many"]),
        *product(["dense"], ["update", "update_many"]),
    ],
)
@pytest.mark.parametrize("backend", BACKENDS)
def test_threads_that_share_a_monitor_never_mix_their_samples(
    backend: str, domain: str, way: str, number: str
) -> None:
    spec = rtamt.parse("historically[0:3](x - y >= 0)", backend=backend)
    options: dict[str, Any] = {"period": 1, "tolerance": 1e9} if domain == "discrete" else {"time": "dense"}
    monitor = spec.monitor(**options)
    give = pairs_of(count(1), NUMBERS[number])[way]
    each = (2000 if backend == "cpp" else 60) // (1 if way != "update_many" else 4)
    taken: list[Any] = []

    def work(k: int) -> None:
        for _ in range(each):
            with suppress(StlError):
                taken.append(give(monitor, k))

    at_once(work)
    wrong = [told for told in taken if np.any(getattr(told, "values", told) != 0.0)]
    assert not wrong
    in_one = (3 if way == "update_many" else 1) * (2 if domain == "dense" else 1)
    assert monitor.samples == in_one * len(taken)
    assert taken  # whoever enters first is not refused; how many follow depends on the scheduler


@pytest.mark.usefixtures("hasty")
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("domain", ["discrete", "dense"])
def test_threads_that_do_all_there_is_to_do_raise_only_what_the_library_means(
    domain: str, backend: str
) -> None:
    monitor = begun(domain, backend)
    clock = count(20)
    actions: list[Action] = [
        *CALLING.values(),
        *(lambda m, f=f: f(m, Slow(2.0)) for f in TAKING[domain].values()),
        lambda m: m.update(next(clock), x=np.float32(1)),
        lambda m: m.update(next(clock), x="no number"),
        lambda m: m.update_many({"time": [next(clock)], "x": [1.0]}),
    ]

    def work(k: int) -> None:
        for i in range(120 if backend == "cpp" else 40):
            tried(monitor, actions[(k * 7 + i * (k + 1)) % len(actions)])

    at_once(work)
    monitor.reset()
    assert monitor.samples == 0


@pytest.mark.usefixtures("hasty")
@pytest.mark.parametrize("number", NUMBERS)
def test_threads_that_share_a_specification_of_rtamts_classes_never_mix_their_samples(number: str) -> None:
    read = NUMBERS[number]
    spec = rtamt.StlDiscreteTimeSpecification()
    dense = rtamt.StlDenseTimeSpecification()
    for each in (spec, dense):
        for name in ("x", "y"):
            each.declare_var(name, "float")
        each.spec = "historically[0:3](x - y >= 0)"
        each.parse()
    clock = count(1)
    taken: list[Any] = []
    points: list[Any] = []

    def work(k: int) -> None:
        for _ in range(300):
            t = next(clock)
            with suppress(rtamt.RTAMTException):
                taken.append(spec.update(t, [("x", read(k)), ("y", read(k))]))
            with suppress(rtamt.RTAMTException):
                points.extend(dense.update(["x", [[t, read(k)]]], ["y", [[t, read(k)]]]))

    at_once(work)
    assert set(taken) == {0.0}
    assert {value for _, value in points} == {0.0}
    assert spec._stream.monitor.samples == len(taken)


@pytest.mark.usefixtures("hasty")
def test_lists_that_another_thread_changes_are_read_pair_by_pair() -> None:
    spec = rtamt.StlDiscreteTimeSpecification()
    for name in ("x", "y"):
        spec.declare_var(name, "float")
    spec.spec = "x - y"
    spec.parse()
    spec.update(0, [("x", 1.0), ("y", 1.0)])
    pair: list[Any] = ["x", 1.0]
    sample: list[Any] = [pair, ["y", 1.0]]
    clock = count(1)
    taken: list[float] = []

    def work(k: int) -> None:
        for i in range(1000):
            if k == 1:
                pair[1] = float(2 + i % 2)
                sample.append(["y", float(2 + i % 2)])
                sample.pop()
            else:
                with suppress(rtamt.RTAMTException):
                    taken.append(spec.update(next(clock), sample))

    at_once(work)
    assert taken
    assert set(taken) <= {x - y for x in (1.0, 2.0, 3.0) for y in (1.0, 2.0, 3.0)}


def test_the_core_leaves_the_gil_of_a_free_threaded_python_off() -> None:
    code = "import sys, rtamt.engine._core; print(getattr(sys, '_is_gil_enabled', lambda: True)())"
    environment = {name: value for name, value in os.environ.items() if name != "PYTHON_GIL"}
    ran = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    assert ran.stdout.strip() == str(not sysconfig.get_config_var("Py_GIL_DISABLED"))
