"""The Python back end of a monitor in dense time: the definition behind the compiled monitor's interface.

Slow and plain, for machines where nothing can be compiled and for operators that have only a
definition.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.engine.dense_reference import DenseReferenceMonitor
from rtamt.engine.python_backend import Refused

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from rtamt.engine.dense_reference import Known
    from rtamt.engine.dense_signals import Samples
    from rtamt.engine.ticks import TimeScale
    from rtamt.language.formula import Formula


class PythonDenseMonitor:
    """One monitor over the definition; see ``_core.DenseMonitor`` for what each method means."""

    def __init__(self, formulas: Sequence[Formula], names: tuple[str, ...], tick: Fraction) -> None:
        self._names = names
        self._monitor = DenseReferenceMonitor(formulas, names, tick)
        self._outputs = len(formulas)
        self._told: list[Samples]  # what the last update made known
        self._start_over()

    @property
    def state_bytes(self) -> int:
        """Bytes of signal kept; grows with the trace."""
        return self._monitor.state_bytes

    @property
    def counts(self) -> list[int]:
        """How many samples of each input came."""
        return list(self._counts)

    @property
    def last_times(self) -> list[int | None]:
        """The tick of the last sample of each input, or None."""
        return list(self._last)

    def tell(self, signal: type, scale: TimeScale, rate: float | None) -> None:
        """Take note of nothing: every update goes the long way."""

    def update(self, *_: Any) -> Any:
        """Refuse: there is no quick way here."""
        raise Refused("time")

    def push(self, columns: Sequence[Samples]) -> Samples:
        """Take a chunk, checked by the caller; return what became known of the first output."""
        given = dict(zip(self._names, columns, strict=True))
        self._told = self._closed(self._monitor.push(given))
        for i, (ticks, _) in enumerate(columns):
            if len(ticks):
                self._counts[i] += len(ticks)
                self._last[i] = int(ticks[-1])
        return self._told[0]

    def finish(self) -> Samples:
        """End the trace; return the rest of the first output."""
        self._told = self._closed(self._monitor.finish())
        return self._told[0]

    def told(self, output: int) -> Samples:
        """Return what the last update made known of an output."""
        return self._told[output]

    def reset(self) -> None:
        """Forget the trace."""
        self._monitor.reset()
        self._start_over()

    def _start_over(self) -> None:
        self._counts = [0 for _ in self._names]
        self._last: list[int | None] = [None for _ in self._names]
        self._until: list[int | None] = [None] * self._outputs
        self._values = [float("nan")] * self._outputs  # the last values told
        self._told = [(np.empty(0, np.int64), np.empty(0))] * self._outputs

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
