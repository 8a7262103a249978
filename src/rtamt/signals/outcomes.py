"""Partial results: bounds of the robustness, and verdicts with the sample that decided them."""

from __future__ import annotations

from rtamt.errors import EvaluationError
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals.signal import Signal

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rtamt.signals.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Interval:
    """Bounds of a number: the robustness of every trace that is consistent with the known samples.

    >>> from rtamt import Interval
    >>> Interval(-2.0, 3.0)
    Interval(lower=-2.0, upper=3.0)
    """

    lower: float
    upper: float


class Change(NamedTuple):
    """The bounds that samples from ``begin`` to ``end`` have now, which changed; ``final`` if they stay.

    In dense time: instants from ``begin`` up to but excluding ``end``. ``retracted``: whether the bounds are
    outside what they were, after a correction.
    """

    begin: Any
    end: Any
    interval: Interval
    final: bool
    retracted: bool = False


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether a formula holds at one sample of discrete time, and the earliest sample that decides it.

    Times are in the form in which the samples were given. ``decided_at`` may be earlier than ``time``.

    >>> from rtamt import Verdict
    >>> Verdict(0.0, False, 2.5)
    Verdict(time=0.0, satisfied=False, decided_at=2.5)
    """

    time: Any
    satisfied: bool
    decided_at: Any


@dataclass(frozen=True, slots=True)
class VerdictRun:
    """The verdict in dense time at every instant from ``begin`` up to but excluding ``end``.

    ``decided_at`` is the time of the earliest sample that decides all of the run. A sample decides the
    tick of its own time too, so that runs end one tick after the newest sample where later instants are open.

    >>> from rtamt import VerdictRun
    >>> VerdictRun(0.0, 2.5, satisfied=False, decided_at=2.5)
    VerdictRun(begin=0.0, end=2.5, satisfied=False, decided_at=2.5)
    """

    begin: Any
    end: Any
    satisfied: bool
    decided_at: Any


@dataclass(frozen=True, slots=True)
class Cause:
    """A value of one variable that is needed to decide a verdict, see ``EagerMonitor.explain``.

    >>> from rtamt import Cause
    >>> Cause("x", 2.0, -1.0)
    Cause(variable='x', time=2.0, value=-1.0)
    """

    variable: str
    time: Any
    value: Any


@dataclass(frozen=True, slots=True)
class Causation:
    """By how much the newest sample alone violates and satisfies a formula (CAV 2023).

    In dense time that is all that the last call made known. ``violation``: the robustness would be at most this because
    of the sample; +inf if the sample does not contribute. ``satisfaction``: it would be at least this; -inf if the
    sample does not contribute.

    >>> from rtamt import Causation
    >>> Causation(violation=-2.0, satisfaction=-2.0)
    Causation(violation=-2.0, satisfaction=-2.0)
    """

    violation: float
    satisfaction: float


@dataclass(frozen=True, slots=True)
class CausationRun:
    """Causation at every sample from ``begin`` to ``end``; None: unbounded.

    In dense time: at every instant from ``begin`` up to but excluding ``end``.

    >>> from rtamt import CausationRun
    >>> CausationRun(0.0, 2.5, violation=-2.0, satisfaction=-2.0)
    CausationRun(begin=0.0, end=2.5, violation=-2.0, satisfaction=-2.0)
    """

    begin: Any
    end: Any
    violation: float
    satisfaction: float


class BoundedSignal(Signal):
    """Bounds of a signal: ``times``, ``lower`` and ``upper``, arrays of the same length.

    ``values`` are defined if the signal is known exactly, and raise :class:`EvaluationError` otherwise.
    """

    __slots__ = ("_upper",)

    def __init__(self, times: NDArray[Any], lower: FloatArray, upper: FloatArray) -> None:
        super().__init__(times, lower)
        self._upper = upper

    @property
    def lower(self) -> FloatArray:
        """The greatest lower bound that is known, for each time."""
        return self._values

    @property
    def upper(self) -> FloatArray:
        """The least upper bound that is known, for each time."""
        return self._upper

    def at(self, i: int) -> Interval:
        """Return the bounds at one of the times."""
        return Interval(float(self.lower[i]) + 0.0, float(self.upper[i]) + 0.0)  # no minus before a zero

    def value(self, i: int) -> float:
        """Return the value at one of the times; raise :class:`EvaluationError` if it is not known."""
        lower, upper = float(self.lower[i]), float(self.upper[i])
        if lower != upper:
            raise EvaluationError(
                f"the robustness at {_format_time(self.times[i])} is only known to lie between {lower:g} and "
                f"{upper:g}, because samples are missing or uncertain; read result.interval or result.intervals, "
                f"or evaluate without gaps: hold the values before them (hold_for= of rtamt.read), or resample "
                f"(trace.resample(period=...))"
            )
        return lower

    @property
    def values(self) -> FloatArray:
        """One value for each time, where all are known; else an error that names the first that is not."""
        open_ = self.lower != self.upper
        if open_.any():
            self.value(int(open_.argmax()))
        return self.lower

    def __repr__(self) -> str:
        return f"BoundedSignal(times={self.times!r}, lower={self.lower!r}, upper={self.upper!r})"


def _format_time(time: Any) -> str:
    return str(time) if isinstance(time, np.datetime64 | np.timedelta64) else f"time {time:.15g}"
