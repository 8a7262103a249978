"""The inputs that a search varies: numbers in a range, and input signals built from them.

::

    Range(0, 325)                                  a number
    PiecewiseConstant(7, low=0, high=100)          a signal of 7 numbers, each held equally long
    PiecewiseLinear(4, low=0, high=1)              a signal through 4 numbers, straight between them
    Step(time=Range(0, 5), after=2)                a signal that changes once
    Pulse(amplitude=Range(1, 1.75), frequency=0.2) a square wave
    Sine(amplitude=1, frequency=Range(0.2, 1))     a sine

Every number of a signal may also be a :class:`Range`. It is then a search parameter, named after
the input and the number: ``pc.frequency``, ``throttle.0``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from bisect import bisect_right
from math import isfinite
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

from rtamt.errors import UsageError, shown, with_article
from rtamt.lazy.dataclasses import dataclass, fields
from rtamt.lazy.modules import np
from rtamt.signals.arrays import is_number

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    Function: TypeAlias = Callable[[Any], Any]


@dataclass(frozen=True, slots=True)
class Range:
    """The numbers from ``low`` to ``high``, both included."""

    low: float
    high: float

    def __post_init__(self) -> None:
        for end in (self.low, self.high):
            if not is_number(end) or not isfinite(end):
                raise UsageError(f"a range ends at {shown(end)}; give a finite number")
        if not self.low < self.high:
            raise UsageError(
                f"the range from {self.low} to {self.high} holds nothing; give the lower end first"
            )

    def at(self, fraction: float) -> float:
        """Return the number at a fraction of the range: ``low`` at 0, ``high`` at 1."""
        return min(self.high, self.low + fraction * (self.high - self.low))


Number: TypeAlias = float | Range


class Input(Protocol):
    """A signal built from numbers; each :class:`Range` among them is a parameter."""

    def parameters(self) -> dict[str, Range]:
        """Return the ranges of the parameters by name."""

    def signal(self, values: Mapping[str, float], duration: float) -> Function:
        """Return the signal for a value of every parameter: a function of time in seconds."""


@dataclass(frozen=True, slots=True)
class Waypoints:
    """A function of time through points: piecewise constant or piecewise linear."""

    times: tuple[float, ...]
    values: tuple[float, ...]
    linear: bool

    def __call__(self, time: Any) -> Any:
        """Return the value at a time, or at each of an array of times (seconds)."""
        if not self.linear and isinstance(time, float):  # Python plants call this at every step
            return self.values[max(0, bisect_right(self.times, time) - 1)]
        if self.linear:
            return _like(time, np.interp(time, self.times, self.values))
        index = np.searchsorted(self.times, time, side="right") - 1
        return _like(time, np.asarray(self.values)[np.maximum(index, 0)])


@dataclass(frozen=True, slots=True)
class _Points:
    """``points`` numbers between ``low`` and ``high``, spread evenly over the simulation."""

    points: int
    low: float
    high: float

    def __post_init__(self) -> None:
        least = self._least()
        if self.points < least:
            raise UsageError(
                f"{with_article(type(self).__name__)} has {shown(self.points)} points; it needs {least} or more"
            )
        Range(self.low, self.high)

    def _least(self) -> int:
        return 1

    def parameters(self) -> dict[str, Range]:
        """Return the range of each point, by its number."""
        return {str(k): Range(self.low, self.high) for k in range(self.points)}

    def _values(self, values: Mapping[str, float]) -> tuple[float, ...]:
        return tuple(float(values[str(k)]) for k in range(self.points))


class PiecewiseConstant(_Points):
    """A signal of ``points`` numbers, each held for the same part of the simulation.

    >>> throttle = PiecewiseConstant(2, low=0, high=100)
    >>> signal = throttle.signal({"0": 10.0, "1": 80.0}, duration=30)
    >>> signal(14.9), signal(15.0)
    (10.0, 80.0)
    """

    __slots__ = ()

    def signal(self, values: Mapping[str, float], duration: float) -> Function:
        """Return the signal: a function of time in seconds."""
        times = tuple(k * duration / self.points for k in range(self.points))
        return Waypoints(times, self._values(values), linear=False)


class PiecewiseLinear(_Points):
    """A signal through ``points`` numbers, the first at the beginning and the last at the end.

    >>> PiecewiseLinear(2, low=0, high=1).signal({"0": 0.0, "1": 1.0}, duration=10)(2.5)
    0.25
    """

    __slots__ = ()

    def _least(self) -> int:
        return 2

    def signal(self, values: Mapping[str, float], duration: float) -> Function:
        """Return the signal: a function of time in seconds."""
        times = tuple(k * duration / (self.points - 1) for k in range(self.points))
        return Waypoints(times, self._values(values), linear=True)


class _Shape(ABC):
    """A signal given by an expression; fields that are ranges are its parameters."""

    __slots__ = ()

    def __post_init__(self) -> None:
        for name, value in self._given().items():
            if not isinstance(value, Range) and not (is_number(value) and isfinite(value)):
                raise UsageError(
                    f"'{name}' of {type(self).__name__} is {shown(value)}; give a number or a Range"
                )

    def _given(self) -> dict[str, Number]:
        return {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type] # classes derived from it are

    def parameters(self) -> dict[str, Range]:
        """Return the ranges among the numbers of this signal."""
        return {name: value for name, value in self._given().items() if isinstance(value, Range)}

    def signal(self, values: Mapping[str, float], duration: float) -> Function:  # noqa: ARG002 - the interface of Input
        """Return the signal: a function of time in seconds."""
        return type(self)(**{**self._given(), **values})

    def __call__(self, time: Any) -> Any:
        """Return the value at a time, or at each of an array of times (seconds)."""
        numbers = []
        for name, value in self._given().items():
            if isinstance(value, Range):
                raise UsageError(
                    f"'{name}' of this {type(self).__name__} is a Range: a signal needs a number there"
                )
            numbers.append(value)
        return _like(time, self._at(np.asarray(time, float), *numbers))

    @abstractmethod
    def _at(self, time: Any, *numbers: float) -> Any:
        """Return the values at an array of times, from the numbers in the order of the fields."""


@dataclass(frozen=True, slots=True)
class Step(_Shape):
    """``before`` until ``time`` (seconds), ``after`` from then on.

    >>> Step(time=1, after=2)([0.9, 1.0]).tolist()
    [0.0, 2.0]
    """

    time: Number = 0.0
    before: Number = 0.0
    after: Number = 1.0

    def _at(self, time: Any, *numbers: float) -> Any:
        when, before, after = numbers
        return np.where(time < when, before, after)


@dataclass(frozen=True, slots=True)
class Pulse(_Shape):
    """A square wave of ``frequency`` (Hz): ``amplitude`` over ``base`` for the ``duty`` part of each period.

    The first pulse begins at ``delay`` (seconds); before it the signal is ``base``.

    >>> Pulse(amplitude=2, frequency=0.5)([0, 0.9, 1, 2]).tolist()
    [2.0, 2.0, 0.0, 2.0]
    """

    amplitude: Number = 1.0
    frequency: Number = 1.0
    duty: Number = 0.5
    base: Number = 0.0
    delay: Number = 0.0

    def _at(self, time: Any, *numbers: float) -> Any:
        amplitude, frequency, duty, base, delay = numbers
        since = time - delay
        high = (since >= 0) & (np.mod(since * frequency, 1.0) < duty)
        return np.where(high, base + amplitude, base)


@dataclass(frozen=True, slots=True)
class Sine(_Shape):
    """``offset + amplitude * sin(2 pi frequency t + phase)``; ``frequency`` in Hz, ``phase`` in radians.

    >>> round(Sine(amplitude=2, frequency=0.25)(1.0), 9)
    2.0
    """

    amplitude: Number = 1.0
    frequency: Number = 1.0
    phase: Number = 0.0
    offset: Number = 0.0

    def _at(self, time: Any, *numbers: float) -> Any:
        amplitude, frequency, phase, offset = numbers
        return offset + amplitude * np.sin(2 * np.pi * frequency * time + phase)


def _like(time: Any, values: Any) -> Any:
    """Return a number for a number, an array for an array."""
    return float(values) if np.ndim(time) == 0 else np.asarray(values, float)
