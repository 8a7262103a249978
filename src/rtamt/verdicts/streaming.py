"""Checking a recording that comes in chunks, in memory that does not grow with its length."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from datetime import timezone
from fractions import Fraction
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.engine.dense_evaluate import reach
from rtamt.engine.dense_monitor import DenseMonitor
from rtamt.engine.monitor import Monitor
from rtamt.errors import TraceError, UsageError
from rtamt.rewrite.check import check_bounds, check_dense
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.semantics import semantics_of
from rtamt.settings import positive_period, time_domain
from rtamt.signals import arrays, dense_arrays
from rtamt.signals.arrays import Signal
from rtamt.signals.ticks import TimeScale, kind_of, sequence_of
from rtamt.verdicts.decompose import Leaf, anchor, check_in_chunks
from rtamt.verdicts.first_violation import Tracker, ticks_of, together, value_of, violation_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from rtamt.language.formula import Formula
    from rtamt.rewrite.semantics import Judge
    from rtamt.settings import Duration, Semantics
    from rtamt.specification import Specification
    from rtamt.verdicts.first_violation import Positions


@dataclass(frozen=True, slots=True)
class StreamResult:
    """What a check in chunks gives.

    ``robustness``: ρ at the first instant. ``satisfied``: whether the formula holds there (Boolean
    semantics). ``first_violation``: when it is first violated, see :func:`rtamt.first_violation`; None
    where it holds. ``minimum``: the smallest ρ at any instant; None where the future is unbounded and
    chunks do not tell. ``samples``: rows in all chunks. ``period``: seconds from one sample to the
    next; None in dense time. ``requirements``: the same for each requirement, by name.
    """

    robustness: float
    satisfied: bool
    first_violation: Any
    minimum: float | None
    samples: int
    period: Fraction | None
    requirements: Mapping[str, StreamResult] = field(default_factory=lambda: MappingProxyType({}))


def check_stream(
    spec: Specification,
    chunks: Iterable[Any],
    *,
    time: str | None = None,
    period: Duration | None = None,
    tolerance: float = arrays.TOLERANCE,
    semantics: Semantics | None = None,
) -> StreamResult:
    """Check a recording that comes in chunks, in memory that does not grow with its length.

    ``chunks``: what ``update_many`` takes, such as the traces of :func:`rtamt.scan`. Other arguments as
    for ``Specification.evaluate``, which gives the same numbers; without a ``period`` it is taken from
    the stamps of the first chunk. The formula's future must be bounded, but for ``always`` and
    ``eventually`` at its top. Raises :class:`BoundError` where it is not, else as ``evaluate`` does.

    >>> import rtamt
    >>> chunks = ({"time": [t, t + 1], "x": [5, 4 - t]} for t in (0, 2, 4))
    >>> result = rtamt.check_stream(rtamt.parse("always(x >= 1)"), chunks)
    >>> result.robustness, result.satisfied, result.first_violation, result.samples
    (-1.0, False, 5.0, 6)
    """
    dense = (spec.time if time is None else time_domain(time)) == "dense"
    stream: _Stream = (
        _DenseStream(spec, semantics) if dense else _DiscreteStream(spec, semantics, period, tolerance)
    )
    for chunk in chunks:
        stream.take(chunk)
    return stream.finish()


def check_streamable(spec: Specification) -> None:
    """Raise :class:`BoundError` where a formula needs the whole recording at once."""
    for alone in spec.requirements.values():
        check_in_chunks(anchor(alone.judged(alone.formula)), alone.text)


class _Judged:
    """One requirement over chunks: the leaves of its robustness and of its truth, and what becomes of them."""

    def __init__(self, spec: Specification, semantics: str | Judge | None) -> None:
        formula = spec.judged(spec.formula, semantics)
        self.spec = spec
        self._robust = anchor(formula)
        check_in_chunks(self._robust, spec.text)
        self._boolean = anchor(spec.judged(spec.formula, "boolean"))
        # The whole formula last, for its minimum, where it can be known online.
        whole = [] if horizon(formula) is None else [Leaf(formula, "min", end=None)]
        self.leaves = [*self._robust.leaves, *self._boolean.leaves, *whole]
        self._trackers: list[Tracker] = []

    def begin(self, unit: Fraction, dense: bool) -> None:
        """Make the trackers, once the length of a period or tick (``unit``, seconds) is known."""
        self._trackers = [Tracker(leaf, unit, dense) for leaf in self.leaves]

    def take(self, formula: Formula, positions: Positions, signal: Signal, last: int | None) -> None:
        """Take what became known of a leaf's formula; ``last``: the last position that the minimum is about."""
        judged = len(self._robust.leaves) + len(self._boolean.leaves)
        for i, (leaf, tracker) in enumerate(zip(self.leaves, self._trackers, strict=True)):
            if leaf.formula != formula:
                continue
            if i == judged and last is not None:
                inside = positions <= last
                tracker.take(positions[inside], Signal(signal.times[inside], signal.values[inside]))
            else:
                tracker.take(positions, signal)

    def result(self, first: Any, samples: int, period: Fraction | None) -> StreamResult:
        """Return what came of all chunks; ``first``: the first time of the recording."""
        for tracker in self._trackers:
            tracker.finish()
        n = len(self._robust.leaves)
        robust, boolean = self._trackers[:n], self._trackers[n : n + len(self._boolean.leaves)]
        whole = self._trackers[n + len(boolean) :]
        satisfied = value_of(self.spec, self._boolean.skeleton, boolean) > 0
        return StreamResult(
            value_of(self.spec, self._robust.skeleton, robust),
            satisfied,
            None if satisfied else violation_of(self.spec, self._boolean, boolean, first),
            whole[0].value if whole else None,
            samples,
            period,
        )


class _Stream(ABC):
    """Requirements over chunks: a monitor for each leaf of any of them."""

    def __init__(self, spec: Specification, semantics: Semantics | None) -> None:
        if not spec.input_names:
            raise UsageError("the formula reads no variable, so that there is nothing to check in chunks")
        chosen = None if semantics is None else semantics_of(semantics)
        self.spec = spec
        self.declared = tuple(declaration.name for declaration in spec.document.declarations)
        self._judged = {name: _Judged(alone, chosen) for name, alone in spec.requirements.items()}
        self.monitors: dict[Formula, Any] = {}
        self.samples = 0
        #: The first time of the recording.
        self.first: Any = None

    @abstractmethod
    def take(self, chunk: Any) -> None:
        """Take the next chunk."""

    @abstractmethod
    def finish(self) -> StreamResult:
        """Say that no more chunks will come; return what came of all of them."""

    def begin(self, unit: Fraction, make: Callable[[Formula], Any], dense: bool) -> None:
        """Make monitors and trackers, once the length of a period or tick (``unit``, seconds) is known."""
        for judged in self._judged.values():
            judged.begin(unit, dense)
        for formula in dict.fromkeys(leaf.formula for each in self._judged.values() for leaf in each.leaves):
            self.monitors[formula] = make(together(formula, self.spec.input_names))

    def told(self, formula: Formula, positions: Positions, signal: Signal, last: int | None = None) -> None:
        """Hand on what a monitor told; ``last``: the last position that the minimum is about."""
        if len(signal) and self.first is None:
            self.first = signal.times[0]
        for judged in self._judged.values():
            judged.take(formula, positions, signal, last)

    def result(self, period: Fraction | None) -> StreamResult:
        """Return what came of all chunks."""
        if self.first is None:
            raise TraceError("the trace is empty: give at least one sample")
        found = {name: each.result(self.first, self.samples, period) for name, each in self._judged.items()}
        results = tuple(found.values())
        violations = [each.first_violation for each in results if not each.satisfied]
        minima = [each.minimum for each in results]
        return StreamResult(
            min(each.robustness for each in results),
            not violations,
            min(violations, default=None),
            None if None in minima else min(minimum for minimum in minima if minimum is not None),
            self.samples,
            period,
            MappingProxyType(found),
        )


class _DiscreteStream(_Stream):
    def __init__(
        self, spec: Specification, semantics: Semantics | None, period: Duration | None, tolerance: float
    ) -> None:
        super().__init__(spec, semantics)
        self._period = spec.period if period is None else positive_period(period)
        self._tolerance = tolerance
        self._told: dict[Formula, int] = {}

    def take(self, chunk: Any) -> None:
        times, columns, n = arrays.columns_of(chunk, self.spec.input_names, self.declared)
        if n and not self.monitors:
            if self._period is None:
                self._period = Fraction(1) if times is None else arrays.infer_period(times)
            check_bounds(self.spec.formula, self._period, self.spec.text)
            self.begin(self._period, self._monitor, dense=False)
        for formula, monitor in self.monitors.items():
            data = columns if times is None else {arrays.TIME: times, **columns}
            self._take(formula, monitor.update_many(data))
        self.samples += n

    def _monitor(self, formula: Formula) -> Monitor:
        assert self._period is not None
        return Monitor(formula, period=self._period, tolerance=self._tolerance, backend=self.spec.backend)

    def _take(self, formula: Formula, signal: Signal) -> None:
        begin = self._told.get(formula, 0)
        self._told[formula] = begin + len(signal)
        self.told(formula, np.arange(begin, begin + len(signal)), signal)

    def finish(self) -> StreamResult:
        for formula, monitor in self.monitors.items():
            self._take(formula, monitor.finish())
        return self.result(self._period)


class _DenseStream(_Stream):
    def __init__(self, spec: Specification, semantics: Semantics | None) -> None:
        super().__init__(spec, semantics)
        check_dense(spec.formula, spec.text)
        check_bounds(spec.formula, spec.resolution, spec.text, "resolution")
        self.begin(spec.resolution, self._monitor, dense=True)
        self._scale: TimeScale | None = None
        self._start: int | None = None
        self._last: dict[str, tuple[int, float]] = {}

    def _monitor(self, formula: Formula) -> DenseMonitor:
        return DenseMonitor(formula, resolution=self.spec.resolution, backend=self.spec.backend)

    def take(self, chunk: Any) -> None:
        columns = dense_arrays.columns_of(chunk, self.spec.input_names, self.declared)
        given = {
            name: (_in_utc(sequence_of(times, name)), values)
            for name, (times, values) in columns.items()
            if len(times)
        }
        if not given:
            return
        for formula, monitor in self.monitors.items():
            signal = monitor.update_many(given)
            if self._scale is None:
                first, _ = next(iter(given.values()))
                self._scale = TimeScale(self.spec.resolution, kind_of(first))
            self._take(formula, signal)
        assert self._scale is not None
        for name, (times, values) in given.items():
            self._last[name] = (int(self._scale.ticks(times[-1:], name)[0]), float(values[-1]))
        self.samples += max(len(times) for times, _ in given.values())

    def _take(self, formula: Formula, signal: Signal, last: int | None = None) -> None:
        ticks = ticks_of(signal, self.spec.resolution)
        if self._start is None and len(ticks):
            self._start = int(ticks[0])
        self.told(formula, ticks - (self._start or 0), signal, last)

    def finish(self) -> StreamResult:
        for name in self.spec.input_names:
            if name not in self._last:
                raise TraceError(f"'{name}' has no samples: give at least one", variable=name)
        assert self._scale is not None
        end = max(tick for tick, _ in self._last.values())
        for formula, monitor in self.monitors.items():
            # The last values hold for ever, and past windows slide on over them until all has settled.
            settled = self._scale.times(np.array([end + reach(desugar(formula), self.spec.resolution) + 1]))
            held = {name: (settled, [value]) for name, (_, value) in self._last.items()}
            for signal in (monitor.update_many(held), monitor.finish()):
                self._take(formula, signal, last=end - (self._start or 0))
        return self.result(None)


def _in_utc(times: Any) -> Any:
    """Return datetimes with time zones as those of numpy, which know of none; other times as they are."""
    if kind_of(times) != "zoned":
        return times
    return np.array([time.astimezone(timezone.utc).replace(tzinfo=None) for time in times], dtype="M8[us]")
