"""Online in dense time: samples of any variables, each on its own clock; robustness as soon as it is known."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.engine import dense_signals
from rtamt.engine.compile import compile_program
from rtamt.engine.core import core
from rtamt.engine.dense_evaluate import undefined
from rtamt.engine.dense_reference import DenseReferenceMonitor
from rtamt.engine.dense_signals import FARTHEST, TickSignal, TimeScale
from rtamt.engine.signals import Signal
from rtamt.errors import TraceError, UsageError
from rtamt.language.formula import variables
from rtamt.rewrite.check import check_bounds, check_dense, check_online
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.horizon import horizon

if TYPE_CHECKING:
    from collections.abc import Collection
    from fractions import Fraction

    from rtamt.engine.dense_signals import Samples
    from rtamt.errors import EvaluationError
    from rtamt.language.formula import Formula


class DenseMonitor:
    """Watches one formula over signals that change at any instant.

    Built by ``Specification.monitor(time="dense")``. After every update it has told ρ for exactly
    the instants up to the earliest last sample of any variable, less the horizon: never an instant
    twice, never one late. What it returns is a Signal: a point for every change, and one at the
    last instant that became known.

    >>> import rtamt
    >>> monitor = rtamt.parse("always[0:1](x >= 3)").monitor(time="dense")
    >>> monitor.update(0.0, x=5.0)
    Signal(times=array([], dtype=float64), values=array([], dtype=float64))
    >>> monitor.update(2.5, x=4.0)
    Signal(times=array([0. , 1.5]), values=array([2., 1.]))
    """

    def __init__(
        self,
        formula: Formula,
        *,
        text: str | None = None,
        resolution: Fraction = dense_signals.NANOSECOND,
        backend: str = "cpp",
        known: Collection[str] = (),
    ) -> None:
        check_dense(formula, text)
        check_bounds(formula, resolution, text, "resolution")
        check_online(formula, text)
        depth = horizon(formula)
        assert depth is not None
        self.input_names: tuple[str, ...] = variables(formula)
        if not self.input_names:
            raise UsageError(
                "the formula reads no variable, so in dense time nothing says when to evaluate it"
            )
        self._depth = depth
        self._tick = resolution
        self._known_names = frozenset(known)
        self._scale: TimeScale | None = None
        self._finished = False
        self._reset_counts()
        self._backend: Any
        if backend == "python":
            self._program = None
            self._quick: Any = None
            self._refused: Any = ()
            self._undefined: Any = ()
            self._backend = DenseReferenceMonitor((formula,), self.input_names, resolution)
        else:
            program = compile_program((desugar(formula),), resolution, self.input_names, domain="dense")
            self._program = program
            self._backend = core().DenseMonitor(program.to_bytes(), list(self.input_names))
            self._quick = self._backend.update if (1 / resolution).denominator == 1 else None
            self._refused = core().Refused
            self._undefined = core().Undefined
        self._ticks_a_second = float(1 / resolution)

    @property
    def horizon(self) -> float:
        """Seconds after t at which ρ at t is known."""
        return float(self._depth)

    @property
    def samples(self) -> int:
        """How many samples of any variable the monitor has taken since the start or the last reset."""
        return sum(self._count.values())

    @property
    def memory(self) -> int:
        """Bytes of state: that of the events inside the windows."""
        return int(self._backend.state_bytes)

    def update(self, time: Any, /, **values: float) -> Signal:
        """Take the values of any variables at one instant (seconds, integer ns, or a datetime).

        Returns what became known. Raises :class:`TraceError` for wrong data and
        :class:`EvaluationError` where an operation has no value; the monitor is then as it was.
        """
        scale = self._scale
        # Plain numbers are seconds, and nothing else is: integers of numpy would be nanoseconds.
        plain = time.__class__ is float or time.__class__ is int
        if plain and scale is not None and scale.kind == "seconds" and self._quick is not None:
            try:
                tick = round(time * self._ticks_a_second)
                if not -FARTHEST < tick < FARTHEST:
                    raise OverflowError
                known = self._quick(tick, values)
            except (self._refused, TypeError, ValueError, OverflowError):
                pass  # the long way finds out what is wrong, and says it
            except self._undefined as error:
                raise self._no_value(error, scale) from None
            else:
                for name in values:
                    self._count[name] += 1
                    self._last[name] = tick
                if known is None and self._backend.known_until == self._told_until:
                    return self._nothing
                return self._quick_signal(known, scale)
        times = np.array([time]) if isinstance(time, (np.integer, np.datetime64)) else [time]
        return self.update_many({name: (times, [value]) for name, value in values.items()})

    def update_many(self, data: Any) -> Signal:
        """Take samples: a mapping from variable to (times, values), or to [time, value] pairs.

        Variables may be left out or have no samples. Returns and raises as :meth:`update` does.
        """
        if self._finished:
            raise UsageError("the monitor has finished its trace; call reset() before the next sample")
        columns = dense_signals.columns_of(data, self.input_names, self._known_names)
        given = [column for column in columns.values() if np.size(column[0])]
        if not given:
            return self._signal((np.empty(0, np.int64), np.empty(0)), None)
        scale = self._scale or TimeScale(self._tick, dense_signals.kind_of(given[0][0]))
        chunk = self._chunk(columns, scale)
        known, until = self._push(chunk, scale)
        if self._scale is None:
            self._scale = scale
            self._nothing = TickSignal(scale, (), ())
        for name, (ticks, _) in zip(self.input_names, chunk, strict=True):
            if len(ticks):
                self._last[name] = int(ticks[-1])
                self._count[name] += len(ticks)
        return self._signal(known, until)

    def finish(self) -> Signal:
        """Say that no more samples will come: every signal holds its last value. Returns the rest."""
        if self._finished:
            return self._signal((np.empty(0, np.int64), np.empty(0)), None)
        for name in self.input_names:
            if self._last[name] is None:
                raise TraceError(
                    f"'{name}' never had a sample, so that there is nothing to tell", variable=name
                )
        known = self._told(self._backend.finish, self._scale)
        self._finished = True
        return self._signal(known, max(last for last in self._last.values() if last is not None))

    def reset(self) -> None:
        """Forget the trace; the next sample is the first."""
        self._backend.reset()
        self._finished = False
        self._scale = None
        self._reset_counts()

    # ---- inside ----------------------------------------------------------------------------------

    def _reset_counts(self) -> None:
        self._last: dict[str, int | None] = dict.fromkeys(self.input_names)
        self._count = dict.fromkeys(self.input_names, 0)
        self._told_until: int | None = None
        self._value = float("nan")  # the last value told
        self._nothing = TickSignal(TimeScale(self._tick, "seconds"), (), ())

    def _quick_signal(self, known: tuple[list[int], list[float]] | None, scale: TimeScale) -> Signal:
        """Return what one instant made known: as :meth:`_signal`, from lists."""
        until = self._backend.known_until
        assert until is not None
        self._told_until = until
        if known is None:
            return TickSignal(scale, (until,), (self._value,))
        ticks, values = known
        self._value = values[-1]
        if ticks[-1] < until:
            ticks.append(until)
            values.append(values[-1])
        return TickSignal(scale, ticks, values)

    def _chunk(self, columns: dict[str, tuple[Any, Any]], scale: TimeScale) -> list[Samples]:
        empty = (np.empty(0, np.int64), np.empty(0))
        return [
            dense_signals.samples_of(columns[name], name, scale, self._count[name], self._last[name])
            if name in columns
            else empty
            for name in self.input_names
        ]

    def _push(self, chunk: list[Samples], scale: TimeScale) -> tuple[Samples, int | None]:
        given: Any = chunk if self._program is not None else dict(zip(self.input_names, chunk, strict=True))
        known = self._told(lambda: self._backend.push(given), scale)
        lasts = [
            int(ticks[-1]) if len(ticks) else self._last[name]
            for name, (ticks, _) in zip(self.input_names, chunk, strict=True)
        ]
        if any(last is None for last in lasts):
            return known, None
        return known, min(last for last in lasts if last is not None) - int(self._depth / self._tick)

    def _told(self, call: Any, scale: TimeScale | None) -> Samples:
        """Return the new events of an output; turn the core's failure into a sentence."""
        if self._program is None:
            told = call()[0]
            return told.times, told.values
        try:
            known: Samples = call()[0]
        except self._undefined as error:
            assert scale is not None
            raise self._no_value(error, scale) from None
        return known

    def _no_value(self, error: Exception, scale: TimeScale) -> EvaluationError:
        instruction, tick = error.args
        assert self._program is not None
        return undefined(self._program.origins[instruction], scale.show(tick))

    def _signal(self, known: Samples, until: int | None) -> Signal:
        """Return new events, and a point at the last instant that became known."""
        ticks, values = known
        if len(ticks):
            self._value = float(values[-1])
        fresh = until is not None and (self._told_until is None or until > self._told_until)
        if fresh and until is not None and (len(ticks) or self._told_until is not None):
            if not len(ticks) or ticks[-1] < until:
                ticks, values = np.append(ticks, until), np.append(values, self._value)
            self._told_until = until
        scale = self._scale or TimeScale(self._tick, "seconds")
        return Signal(scale.times(ticks), values)
