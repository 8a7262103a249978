"""Output of ``rtamt monitor`` one horizon later: the robustness, in discrete and in dense time."""

from __future__ import annotations

from collections import deque
from math import inf
from typing import TYPE_CHECKING, Any

from rtamt.cli.json_lines import STDIN
from rtamt.errors import StlError
from rtamt.language.units.moments import time_text
from rtamt.lazy.modules import np
from rtamt.signals.sampling_period import TOLERANCE
from rtamt.signals.signal import Signal
from rtamt.signals.trace import in_seconds

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.cli.robustness_lines import Output
    from rtamt.engine.dense.monitor import DenseMonitor
    from rtamt.engine.discrete.monitor import Monitor

#: By how much, as a fraction, a gap may miss a period that it is: timestamps since 1970 are no more precise.
_BLUR = 5e-7


class SampleFeed:
    """A monitor with the timestamps of the samples whose robustness is not known yet.

    ``assumed``: whether the period is assumed, not set. A file is read with the period that its timestamps
    have, which a stream shows too late: the timestamps must then equal the assumed ones, not just approximate them.
    """

    def __init__(self, monitor: Monitor, output: Output, names: Sequence[str], *, assumed: bool) -> None:
        self.monitor = monitor
        self._output = output
        #: Of each requirement what is known, but not yet of all together.
        self._parts: dict[str, deque[float]] = {name: deque() for name in names}
        self._period = float(monitor.period)
        self._assumed = assumed
        self._last: float | None = None
        self._timestamps: deque[Any] = deque()

    def take(self, timestamp: Any, values: dict[str, float], line: int) -> str:
        """Take a sample and print what became known; return what is wrong with the sample, if anything is.

        ``timestamp``: seconds, or a date or duration of numpy, which is printed with all its digits.
        """
        if timestamp is None:
            timestamp = self.monitor.samples * self._period
        time = timestamp if isinstance(timestamp, float) else float(in_seconds(np.array([timestamp]))[0])
        if self._assumed and self._last is not None and self._differs(time - self._last):
            at = time_text(time, dated=isinstance(timestamp, np.datetime64))
            return (
                f"{STDIN}, line {line}: sample {self.monitor.samples} at {at} is {time - self._last:g} s "
                f"after the one before, expected {self._period:g} s: give the right period with --period, "
                f"or use --time dense"
            )
        try:
            robustness = self.monitor.update(time, **values)
        except StlError as error:
            return f"{STDIN}, line {line}: {error}"
        self._last = time
        self._timestamps.append(timestamp)
        for name, known in self._parts.items():
            value = self.monitor[name]
            if isinstance(value, float):
                known.append(value)
        if robustness is not None:
            self._point(self._timestamps.popleft(), robustness)
        return ""

    def _differs(self, gap: float) -> bool:
        """Return whether a gap is near the period, so that the monitor would take it, but not the period."""
        return _BLUR < abs(gap / self._period - 1) <= TOLERANCE

    def finish(self) -> None:
        """End the trace; print what was not known yet."""
        rest = self.monitor.finish()
        for name, known in self._parts.items():
            signal = self.monitor[name]
            assert isinstance(signal, Signal)
            known.extend(signal.values.tolist())
        for timestamp, robustness in zip(self._timestamps, rest.values.tolist(), strict=True):
            self._point(timestamp, robustness)

    def _point(self, time: Any, robustness: float) -> None:
        self._output.point(time, robustness, {name: known.popleft() for name, known in self._parts.items()})


class EventFeed:
    """A monitor in dense time: a sample may hold some of the variables, a result any number of points."""

    def __init__(self, monitor: DenseMonitor, output: Output, names: Sequence[str]) -> None:
        self.monitor = monitor
        self._output = output
        self._names = names
        #: Changes of the requirements that lie beyond what is known of all together.
        self._ahead: list[tuple[Any, str, float]] = []
        self._latest: dict[str, float] = {}
        self._robustness = inf

    def take(self, time: Any, values: dict[str, float], line: int) -> str:
        """Take a sample and print what became known; return what is wrong with the sample, if anything is."""
        if time is None:
            return f"{STDIN}, line {line}: in dense time every sample needs its time"
        try:
            signal = self.monitor.update(time, **values)
        except StlError as error:
            return f"{STDIN}, line {line}: {error}"
        self._print(signal)
        return ""

    def finish(self) -> None:
        """End the signals; print what was not known yet."""
        self._print(self.monitor.finish())

    def _print(self, signal: Signal) -> None:
        """Print a line at every change of the robustness and of the requirements, as far as all are known."""
        for name in self._names:
            part = self.monitor[name]
            self._ahead += [(t, name, v) for t, v in zip(part.times, part.values.tolist(), strict=True)]
        if not len(signal):
            return
        overall = dict(zip(signal.times, signal.values.tolist(), strict=True))
        due = [change for change in self._ahead if change[0] <= signal.times[-1]]
        self._ahead = [change for change in self._ahead if change[0] > signal.times[-1]]
        for time in sorted({*overall, *(time for time, _, _ in due)}):
            before = dict(self._latest)
            self._latest.update((name, value) for at, name, value in due if at == time)
            if time in overall or self._latest != before:
                self._robustness = overall.get(time, self._robustness)
                started = {name: self._latest[name] for name in self._names if name in self._latest}
                self._output.point(time, self._robustness, started)
