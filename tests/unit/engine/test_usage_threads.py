"""A monitor that threads use at once: each sample is taken whole or rejected, as if calls came one after the other."""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
import threading
from contextlib import suppress
from itertools import count, product
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import rtamt
from rtamt.errors import StlError
from tests.unit.engine.meddling import BACKENDS, CALLING, TAKING, Slow, after_actions, start_monitor

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    Action = Callable[[Any], Any]

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
    monitor = start_monitor(domain, backend)
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
            after_actions(monitor, actions[(k * 7 + i * (k + 1)) % len(actions)])

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


#: The thread still holds the monitor when the process ends.
HELD_AT_EXIT = """\
import threading, rtamt
monitor = rtamt.parse("x >= 3").monitor()
monitor.update(0, x=4)
threading.Thread(target=lambda: threading.Event().wait() or monitor, daemon=True).start()
"""


def test_a_process_that_ends_beside_a_daemon_thread_with_a_monitor_prints_nothing() -> None:
    ran = subprocess.run([sys.executable, "-c", HELD_AT_EXIT], capture_output=True, text=True, check=True)
    assert (ran.stdout, ran.stderr) == ("", "")
