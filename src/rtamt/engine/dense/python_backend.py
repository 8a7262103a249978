"""The Python back end of a monitor in dense time: the definition behind the compiled monitor's interface.

Slow and simple: for machines without a compiled core, and for operators that have only a
definition.
"""

from __future__ import annotations

from rtamt.engine.backend import RefusedError
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.reference.dense_robustness import DenseReferenceMonitor
from rtamt.usage_guard import UsageGuard, exclusive

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from rtamt.language.formula import Formula
    from rtamt.reference.dense_robustness import Events, Known
    from rtamt.signals.dense_arrays import Samples
    from rtamt.signals.ticks import TimeScale


class PythonDenseMonitor:
    """One monitor over the definition; ``_core.DenseMonitor`` documents the methods."""

    def __init__(self, formulas: Sequence[Formula], names: tuple[str, ...], tick: Fraction) -> None:
        self._names = names
        self._tick = tick
        self._monitor = DenseReferenceMonitor(formulas, names, tick)
        self._outputs = len(formulas)
        self._usage = UsageGuard()
        self._last: list[int | None]
        self._until: list[int | None]  # up to when each output was reported
        self._results: list[Samples]  # the results of the last update
        self._latest: tuple[Mapping[str, Events], Sequence[Events]]  # the trace before it, and its chunk
        self._start_over()

    @property
    @exclusive
    def state_bytes(self) -> int:
        """Bytes of signal kept; grows with the trace."""
        return self._monitor.state_bytes

    @property
    @exclusive
    def counts(self) -> list[int]:
        """The number of samples of each input."""
        return list(self._counts)

    @property
    @exclusive
    def last_times(self) -> list[int | None]:
        """The tick of the last sample of each input, or None."""
        return list(self._last)

    def set_time_scale(self, signal: type, scale: TimeScale, rate: float, whole: bool = False) -> None:
        """Ignore the time scale: every update takes the slow path."""

    def update(self, *_: Any) -> Any:
        """Refuse: there is no fast path."""
        raise RefusedError("time")

    @exclusive
    def push(self, columns: Sequence[Events]) -> Samples:
        """Take a chunk, checked by the caller; return what became known of the first output."""
        for (ticks, _), last in zip(columns, self._last, strict=True):
            if len(ticks) and last is not None and ticks[0] <= last:
                raise RefusedError("time")
        given = dict(zip(self._names, columns, strict=True))
        before = self._monitor.kept
        self._results = self._closed(self._monitor.push(given))
        self._latest = before, columns
        for i, (ticks, _) in enumerate(columns):
            if len(ticks):
                self._counts[i] += len(ticks)
                self._last[i] = int(ticks[-1])
        return self._results[0]

    @exclusive
    def finish(self) -> Samples:
        """End the trace; return the rest of the first output."""
        self._results = self._closed(self._monitor.finish())
        return self._results[0]

    @exclusive
    def last_output(self, output: int) -> Samples:
        """Return the new values of an output after the last update."""
        return self._results[output]

    @exclusive
    def points(self) -> list[list[tuple[int, float]]]:
        """The same of every output: a list for each, of pairs of tick and value."""
        return [list(zip(ticks.tolist(), values.tolist(), strict=True)) for ticks, values in self._results]

    @exclusive
    def part(self, formula: Formula) -> Samples:
        """Return the results of the last chunk for a formula, by repeating the chunk for this formula alone."""
        before, columns = self._latest
        again = PythonDenseMonitor((formula,), self._names, self._tick)
        again.push([before.get(name, ([], [])) for name in self._names])
        return again.push(columns)

    @exclusive
    def reset(self) -> None:
        """Forget the trace."""
        self._monitor.reset()
        self._start_over()

    @exclusive
    def state(self) -> tuple[Any, ...]:
        """Return the state after the samples so far."""
        mine = self._counts, self._last, self._until, self._values, self._results
        return tuple(list(items) for items in mine), self._latest, self._monitor.state()

    def restore(self, state: tuple[Any, ...]) -> None:
        """Restore the state of a monitor of the same program."""
        (self._counts, self._last, self._until, self._values, self._results), self._latest, definition = state
        self._monitor.restore(definition)

    def _start_over(self) -> None:
        self._counts = [0 for _ in self._names]
        self._last = [None for _ in self._names]
        self._until = [None] * self._outputs
        self._values = [float("nan")] * self._outputs  # the last values reported
        self._latest = ({}, [([], []) for _ in self._names])
        self._results = [(np.empty(0, np.int64), np.empty(0))] * self._outputs

    def _closed(self, known: Sequence[Known]) -> list[Samples]:
        """Return the new events of each output, and a point at the last instant that became known."""
        return [self._with_point(output, *news) for output, news in enumerate(known)]

    def _with_point(self, output: int, ticks: Any, values: Any, until: int | None) -> Samples:
        if len(ticks):
            self._values[output] = float(values[-1])
        if until is None or until == self._until[output]:
            return ticks, values
        self._until[output] = until
        if len(ticks) and ticks[-1] == until:
            return ticks, values
        return np.append(ticks, until), np.append(values, self._values[output])
