"""Checking a recording that comes in chunks, in memory that does not grow with its length."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from fractions import Fraction
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.engine.dense_evaluate import reach
from rtamt.engine.dense_monitor import DenseMonitor
from rtamt.engine.monitor import Monitor
from rtamt.errors import TraceError, UsageError
from rtamt.language.units import check_unit
from rtamt.rewrite.check import check_bounds, check_dense
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.semantics import semantics_of
from rtamt.settings import positive_period, time_domain
from rtamt.signals import arrays, dense_arrays
from rtamt.signals.regular import TOLERANCE, check_increasing, infer_period
from rtamt.signals.ticks import TimeScale
from rtamt.verdicts.decompose import Leaf, anchor, check_in_chunks
from rtamt.verdicts.first_violation import Tracker, align_inputs, value_of, violation_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from rtamt.language.formula import Formula
    from rtamt.rewrite.semantics import PredicateSemantics
    from rtamt.settings import Duration, Semantics
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.dense_arrays import Samples
    from rtamt.signals.signal import Signal
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
    tolerance: float = TOLERANCE,
    semantics: Semantics | None = None,
    time_unit: str | None = None,
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
        _DenseStream(spec, semantics, time_unit)
        if dense
        else _DiscreteStream(spec, semantics, time_unit, period, tolerance)
    )
    for chunk in chunks:
        stream.take(chunk)
    return stream.finish()


def check_streamable(spec: Specification) -> None:
    """Raise :class:`BoundError` where a formula needs the whole recording at once."""
    for alone in spec.requirements.values():
        check_in_chunks(anchor(alone.apply_semantics(alone.formula)), alone.text)


class _RequirementInChunks:
    """One requirement over chunks: the leaves of its robustness and of its truth, and what becomes of them."""

    def __init__(self, spec: Specification, semantics: str | PredicateSemantics | None) -> None:
        formula = spec.apply_semantics(spec.formula, semantics)
        self.spec = spec
        self._robust = anchor(formula)
        check_in_chunks(self._robust, spec.text)
        self._boolean = anchor(spec.apply_semantics(spec.formula, "boolean"))
        # The whole formula last, for its minimum, where it can be known online.
        whole = [] if horizon(formula) is None else [Leaf(formula, "min", end=None)]
        self.leaves = [*self._robust.leaves, *self._boolean.leaves, *whole]
        self.trackers: list[Tracker] = []

    def begin(self, unit: Fraction, dense: bool) -> None:
        """Make the trackers, once the length of a period or tick (``unit``, seconds) is known."""
        self.trackers = [Tracker(leaf, unit, dense) for leaf in self.leaves]

    def take(self, formula: Formula, positions: Positions, values: FloatArray, last: int | None) -> None:
        """Take what became known of a leaf's formula; ``last``: the last position that the minimum is about."""
        judged = len(self._robust.leaves) + len(self._boolean.leaves)
        for i, (leaf, tracker) in enumerate(zip(self.leaves, self.trackers, strict=True)):
            if leaf.formula != formula:
                continue
            if i == judged and last is not None:
                inside = positions <= last
                tracker.take(positions[inside], values[inside])
            else:
                tracker.take(positions, values)

    def result(self, time: Callable[[int], Any], samples: int, period: Fraction | None) -> StreamResult:
        """Return what came of all chunks; ``time``: from a position to a time as the caller tells it."""
        for tracker in self.trackers:
            tracker.finish()
        n = len(self._robust.leaves)
        robust, boolean = self.trackers[:n], self.trackers[n : n + len(self._boolean.leaves)]
        whole = self.trackers[n + len(boolean) :]
        satisfied = value_of(self.spec, self._boolean.skeleton, boolean) > 0
        return StreamResult(
            value_of(self.spec, self._robust.skeleton, robust) + 0.0,  # as of an evaluation
            satisfied,
            None if satisfied else time(violation_of(self.spec, self._boolean, boolean)),
            whole[0].value if whole else None,
            samples,
            period,
        )


class _Stream(ABC):
    """Requirements over chunks: a monitor for each leaf of any of them."""

    def __init__(self, spec: Specification, semantics: Semantics | None, unit: str | None) -> None:
        if not spec.input_names:
            raise UsageError("the formula reads no variable, so that there is nothing to check in chunks")
        chosen = None if semantics is None else semantics_of(semantics)
        self.spec = spec
        self.unit = None if unit is None else check_unit(unit)
        self.declared = tuple(declaration.name for declaration in spec.document.declarations)
        self.parts = {name: _RequirementInChunks(alone, chosen) for name, alone in spec.requirements.items()}
        self.monitors: dict[Formula, Any] = {}
        self.samples = 0

    @abstractmethod
    def take(self, chunk: Any) -> None:
        """Take the next chunk."""

    @abstractmethod
    def finish(self) -> StreamResult:
        """Say that no more chunks will come; return what came of all of them."""

    def begin(self, unit: Fraction, make: Callable[[Formula], Any], dense: bool) -> None:
        """Make monitors and trackers, once the length of a period or tick (``unit``, seconds) is known."""
        for part in self.parts.values():
            part.begin(unit, dense)
        for formula in dict.fromkeys(leaf.formula for each in self.parts.values() for leaf in each.leaves):
            self.monitors[formula] = make(align_inputs(formula, self.spec.input_names))

    def told(
        self, formula: Formula, positions: Positions, values: FloatArray, last: int | None = None
    ) -> None:
        """Hand on what a monitor told; ``last``: the last position that the minimum is about."""
        for part in self.parts.values():
            part.take(formula, positions, values, last)

    @abstractmethod
    def time(self, position: int) -> Any:
        """Return a position at which something was violated as the caller tells time."""

    def result(self, period: Fraction | None) -> StreamResult:
        """Return what came of all chunks."""
        if not self.samples:
            raise TraceError("the trace is empty: give at least one sample")
        found = {name: each.result(self.time, self.samples, period) for name, each in self.parts.items()}
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
        self,
        spec: Specification,
        semantics: Semantics | None,
        unit: str | None,
        period: Duration | None,
        tolerance: float,
    ) -> None:
        super().__init__(spec, semantics, unit)
        self._period = spec.period if period is None else positive_period(period)
        self._tolerance = tolerance
        self._told: dict[Formula, int] = {}
        self._last: dict[Formula, Any] = {}  # the last stamp of which each monitor told something
        self._kept: dict[
            int, Any
        ] = {}  # the stamps of positions where something is violated, and of the first

    def take(self, chunk: Any) -> None:
        stamps, columns, n = arrays.columns_of(chunk, self.spec.input_names, self.declared, self.unit)
        if not n:
            return
        if not self.monitors:
            if stamps is not None:
                check_increasing(stamps.seconds)
            if self._period is None:
                self._period = Fraction(1) if stamps is None else infer_period(stamps.seconds)
            check_bounds(self.spec.formula, self._period, self.spec.text)
            self.begin(self._period, self._monitor, dense=False)
        for formula, monitor in self.monitors.items():
            data = columns if stamps is None else {arrays.TIME: stamps.told, **columns}
            self._take(formula, monitor.update_many(data))
        self.samples += n

    def _monitor(self, formula: Formula) -> Monitor:
        assert self._period is not None
        return Monitor(
            formula, period=self._period, tolerance=self._tolerance, backend=self.spec.backend, unit=self.unit
        )

    def _take(self, formula: Formula, signal: Signal) -> None:
        begin = self._told.get(formula, 0)
        self._told[formula] = begin + len(signal)
        self.told(formula, np.arange(begin, begin + len(signal)), signal.values)
        # A tracker judges a position when the next one comes: the stamp before is wanted, too.
        trackers = (tracker for part in self.parts.values() for tracker in part.trackers)
        for position in {0, *(tracker.violated for tracker in trackers if tracker.violated is not None)}:
            if position == begin - 1:
                self._kept.setdefault(position, self._last[formula])
            elif begin <= position < begin + len(signal):
                self._kept.setdefault(position, arrays.plain(signal.times[position - begin]))
        if len(signal):
            self._last[formula] = arrays.plain(signal.times[-1])

    def time(self, position: int) -> Any:
        if position in self._kept:
            return self._kept[position]
        # The last one, which was judged at the end: there all monitors stand alike.
        return next(iter(self._last.values()))

    def finish(self) -> StreamResult:
        for formula, monitor in self.monitors.items():
            self._take(formula, monitor.finish())
        return self.result(self._period)


class _DenseStream(_Stream):
    def __init__(self, spec: Specification, semantics: Semantics | None, unit: str | None) -> None:
        super().__init__(spec, semantics, unit)
        check_dense(spec.formula, spec.text)
        check_bounds(spec.formula, spec.resolution, spec.text, "resolution")
        self.begin(spec.resolution, self._monitor, dense=True)
        self._scale: TimeScale | None = None
        self._start: int | None = None
        self._counts: dict[str, int] = {}
        self._last: dict[str, tuple[int, float]] = {}

    def _monitor(self, formula: Formula) -> DenseMonitor:
        return DenseMonitor(formula, resolution=self.spec.resolution, backend=self.spec.backend)

    def take(self, chunk: Any) -> None:
        arrays.require_no_unit(chunk, self.unit)
        columns = dense_arrays.columns_of(chunk, self.spec.input_names, self.declared)
        given = {name: column for name, column in columns.items() if len(column[0])}
        if not given:
            return
        times = [each for each, _ in given.values()]
        if self._scale is None:
            self._scale = TimeScale.of(self.spec.resolution, times, self.unit)
        self._scale = self._scale.widened(times)
        samples = {}
        for name, column in columns.items():
            last = self._last[name][0] if name in self._last else None
            samples[name] = dense_arrays.samples_of(
                column, name, self._scale, self._counts.get(name, 0), last
            )
        for formula, monitor in self.monitors.items():
            self._take(formula, monitor.push(samples, self._scale))
        for name, (ticks, values) in samples.items():
            if len(ticks):
                self._last[name] = int(ticks[-1]), float(values[-1])
                self._counts[name] = self._counts.get(name, 0) + len(ticks)
        self.samples += max(map(len, times))

    def _take(self, formula: Formula, known: Samples, last: int | None = None) -> None:
        ticks, values = known
        if self._start is None and len(ticks):
            self._start = int(ticks[0])
        self.told(formula, ticks - (self._start or 0), values, last)

    def time(self, position: int) -> Any:
        assert self._scale is not None
        assert self._start is not None
        return self._scale.time(self._start + position)

    def finish(self) -> StreamResult:
        for name in self.spec.input_names:
            if name not in self._last:
                raise TraceError(f"'{name}' has no samples: give at least one", variable=name)
        assert self._scale is not None
        end = max(tick for tick, _ in self._last.values())
        for formula, monitor in self.monitors.items():
            # The last values hold for ever, and past windows slide on over them until all has settled.
            settled = np.array([end + reach(desugar(formula), self.spec.resolution) + 1])
            held = {name: (settled, np.array([value])) for name, (_, value) in self._last.items()}
            known = monitor.push(held, self._scale)
            self._take(formula, known, end - (self._start or 0))
            self._take(formula, monitor.rest(), end - (self._start or 0))
        return self.result(None)
