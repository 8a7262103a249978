"""Values and fields that call the monitor that reads them, and monitors to try them on."""

from __future__ import annotations

import copy
import pickle
from contextlib import suppress
from numbers import Real
from typing import TYPE_CHECKING, Any

import rtamt
from rtamt.errors import StlError

if TYPE_CHECKING:
    from collections.abc import Callable

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


def start_monitor(domain: str, backend: str) -> Any:
    spec = rtamt.parse("once[0:2](x >= 3) or eventually[0:1](x >= 5)", backend=backend)
    options: dict[str, Any] = {"period": 1, "tolerance": 1e9} if domain == "discrete" else {"time": "dense"}
    monitor = spec.monitor(watch=["x >= 5"], **options)
    for time, x in ((0.0, 4.0), (2.0, 1.0)):
        monitor.update(time, x=x)
    return monitor


def observe(monitor: Any) -> list[str]:
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


def after_actions(monitor: Any, *actions: Callable[[Any], Any]) -> Any:
    for action in actions:
        with suppress(StlError):
            action(monitor)
    return monitor
