"""The Python back end of a monitor: the definition behind the interface of the compiled monitor.

Slow and simple: for machines without a compiled core, and for operators that have only a
definition. It raises :class:`RefusedError` in the same cases as the compiled monitor.
"""

from __future__ import annotations

from collections import deque
from fractions import Fraction
from math import inf, isfinite, isnan
from typing import TYPE_CHECKING, Any

from rtamt.engine.backend import RefusedError
from rtamt.lazy.modules import np
from rtamt.reference.discrete_robustness import ReferenceMonitor, history
from rtamt.rewrite.horizon import horizon
from rtamt.signals import arrays
from rtamt.signals.counting import is_implausible
from rtamt.usage_guard import UsageGuard, exclusive, in_use

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.language.formula import Formula
    from rtamt.signals.arrays import FloatArray


class PythonMonitor:
    """One monitor over the definition; ``_core.Monitor`` documents the methods.

    ``period`` is in seconds, ``unit`` is how many seconds a unit of the timestamps has.
    """

    def __init__(
        self,
        formulas: Sequence[Formula],
        names: tuple[str, ...],
        period: Fraction,
        tolerance: float = inf,
        strict: bool = True,
        unit: Fraction = Fraction(1),
    ) -> None:
        depths = [horizon(formula, period) for formula in formulas]
        lags = [int(depth / period) for depth in depths if depth is not None]
        assert len(lags) == len(depths), "unbounded future is refused before"
        reach: list[int] = []
        for formula in formulas:
            behind = history(formula, period)
            if behind is None:
                reach = []
                break
            reach.append(behind)
        # A formula without variables still counts samples: one column that nothing reads.
        self._names = names
        # One sample more than the next value needs, so that parts of the last value can still be queried.
        self._monitor = _Questioned(
            formulas, names or ("#",), period, lags, max(reach) + 1 if reach else None
        )
        self._period = float(period / unit)
        self._unit = float(unit)
        self._tolerance = tolerance
        self._strict = strict
        self._timestamps: deque[float] = deque(maxlen=max(lags, default=0) + 1)
        self._values: dict[str, float] = {}
        self._finished = False
        self._usage = UsageGuard()
        self._news: list[FloatArray] = [np.empty(0) for _ in formulas]  # of the last update
        self.violations = 0

    @property
    @exclusive
    def samples(self) -> int:
        """The number of samples."""
        return self._monitor.samples

    @property
    @exclusive
    def last_time(self) -> float | None:
        """The timestamp of the last sample; None before the first."""
        return self._last_time

    @property
    def _last_time(self) -> float | None:
        return self._timestamps[-1] if self._timestamps else None

    @property
    @exclusive
    def state_bytes(self) -> int:
        """Bytes of signal kept; grows with the trace where the past is unbounded."""
        return self._monitor.state_bytes

    @exclusive
    def last(self, part: Formula) -> float:
        """Return the value of a past formula of the monitor, or a part of one, at the last sample."""
        return self._monitor.last(part)

    def latest(self, output: int) -> float | None:
        """Return the new value of an output after the last sample, or None."""
        news = self._news[output]
        return float(news[-1]) if len(news) else None

    @exclusive
    def recent(self, count: int) -> FloatArray:
        """Return the timestamps of the last ``count`` samples."""
        return np.array(list(self._timestamps)[len(self._timestamps) - count :], dtype=np.float64)

    def update(self, time: float, values: Mapping[str, float]) -> float | None:
        """Take one sample with a value for every variable."""
        if set(values) != set(self._names):
            raise RefusedError("variables")
        number = _number(time)
        if is_implausible(number):
            raise RefusedError("time")
        return self._take(number, {name: _number(values[name]) for name in self._names})

    def update_pairs(self, time: float, pairs: Sequence[tuple[str, float]]) -> float | None:
        """Take one sample; a variable that is left out keeps its value."""
        values = {}
        for name, value in pairs:
            if name not in self._names:
                raise RefusedError("unknown variable")
            values[name] = _number(value)
        return self._take(_number(time), values)

    def step(self, *values: float) -> float | None:
        """Take one sample, values in the order of the inputs, one period after the last."""
        if len(values) != len(self._names):
            raise RefusedError("number of values")
        return self._take(None, {n: _number(v) for n, v in zip(self._names, values, strict=True)})

    @exclusive
    def push(
        self, times: FloatArray, columns: Sequence[FloatArray], after: int | None = None
    ) -> list[FloatArray]:
        """Take many checked samples, unless the number of earlier samples differs from ``after``."""
        if after not in {None, self._monitor.samples}:
            raise in_use()
        off = [self._off(a, b) for a, b in zip([self._last_time, *times], times, strict=False)]
        if len(times):
            self._begin(float(times[0]))
        known = self._news = self._monitor.push(list(columns) or [np.zeros(len(times))])
        self._timestamps.extend(float(time) for time in times)
        self.violations += sum(off)
        if len(times):
            self._values = {name: float(c[-1]) for name, c in zip(self._names, columns, strict=True)}
        return known

    def accepts(self, _times: FloatArray, _columns: Sequence[FloatArray]) -> bool:
        """Leave all checks to the caller."""
        return False

    def take_columns(self, data: Any, time: str) -> None:
        """Leave all data to be converted by the caller."""

    @exclusive
    def finish(self) -> list[FloatArray]:
        """Return the values that were still unknown; afterwards only ``reset`` is possible."""
        known = self._monitor.finish()
        self._finished = True
        return known

    @exclusive
    def reset(self) -> None:
        """Forget the trace."""
        self._monitor.reset()
        self._finished = False
        self._timestamps.clear()
        self._values = {}
        self._news = [np.empty(0) for _ in self._news]
        self.violations = 0

    @exclusive
    def state(self) -> tuple[Any, ...]:
        """Return the state after the samples so far."""
        mine = tuple(self._timestamps), self._values, self._news, self._finished, self.violations
        return mine, self._monitor.state()

    def restore(self, state: tuple[Any, ...]) -> None:
        """Restore the state of a monitor of the same program."""
        (timestamps, self._values, self._news, self._finished, self.violations), definition = state
        self._timestamps.extend(timestamps)
        self._monitor.restore(definition)

    @exclusive
    def _take(self, time: float | None, given: Mapping[str, float]) -> float | None:
        """Take a sample; variables left out keep their values, and the default time is one period after the last."""
        if self._finished:
            raise RefusedError("finished")
        last = self._last_time
        if time is None:
            time = 0.0 if last is None else last + self._period
        late = last is not None and (time < last or (self._strict and time == last))
        if not isfinite(time) or late:
            raise RefusedError("time")
        off = self._off(last, time)
        if off and self._strict:
            raise RefusedError("period")
        values = {**self._values, **given}
        if len(values) != len(self._names):
            raise RefusedError("missing variable")
        columns = [np.array([values[name]]) for name in self._names] or [np.zeros(1)]
        self._begin(time)
        self._news = self._monitor.push(columns)
        known = self._news[0]
        self._timestamps.append(time)
        self._values = values
        self.violations += off
        return float(known[0]) if len(known) else None

    def _begin(self, time: float) -> None:
        """Let the definition's messages count time from the first timestamp."""
        if not self._timestamps:
            self._monitor.start = time * self._unit

    def _off(self, before: float | None, time: float) -> bool:
        """Return whether a gap deviates from the period by more than the tolerance; the first sample has no gap."""
        return before is not None and abs(time - before - self._period) > self._tolerance * self._period


class _Questioned(ReferenceMonitor):
    """The definition's monitor, with access to its state and to the last value of parts of its formulas."""

    def state(self) -> tuple[Any, ...]:
        """Return the state after the samples so far; it is never changed in place."""
        return self.start, self._samples, self._first, tuple(self._kept), self._finished

    def restore(self, state: tuple[Any, ...]) -> None:
        """Restore a state."""
        self.start, self._samples, self._first, kept, self._finished = state
        self._kept = list(kept)

    def last(self, part: Formula) -> float:
        """Return the value of ``part`` at the last sample, by repeating that sample for the part alone."""
        again = _Questioned((part,), self._inputs, self._period, (0,), None, self.start)
        again._first, again._samples = self._first, self._samples - 1
        again._kept = [column[:-1] for column in self._kept]
        return float(again.push([column[-1:] for column in self._kept])[0][0])


def _number(value: Any) -> float:
    number = arrays.number_of(value)
    if number is None or isnan(number):
        raise RefusedError("not a number")
    return number
