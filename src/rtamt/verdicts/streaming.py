"""Check a recording in chunks, with memory use independent of its length."""

from __future__ import annotations

from abc import ABC, abstractmethod
from fractions import Fraction
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.engine.dense.monitor import finish_ticks, known_ticks, push_ticks
from rtamt.engine.discrete.monitor import push_samples
from rtamt.errors import TraceError, UsageError
from rtamt.language.formula import Apply, own_variables
from rtamt.language.operators import STL
from rtamt.language.units.durations import check_unit
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.semantics import semantics_of
from rtamt.signals import arrays, dense_arrays
from rtamt.signals.discrete import Discrete
from rtamt.signals.domains import time_domain
from rtamt.signals.regular import TOLERANCE, check_increasing, has_period, infer_period
from rtamt.signals.signal import Signal
from rtamt.signals.ticks import TimeScale
from rtamt.verdicts.chunks import Group, Requirement, StreamResult
from rtamt.verdicts.decompose import anchor, check_in_chunks
from rtamt.verdicts.offline import end_of
from rtamt.verdicts.robustness_and_truth import outputs_under

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from rtamt.engine.dense.monitor import DenseMonitor
    from rtamt.engine.discrete.monitor import Monitor
    from rtamt.language.units.durations import Duration
    from rtamt.settings import Semantics
    from rtamt.signals.arrays import Timestamps
    from rtamt.signals.dense import Dense
    from rtamt.signals.dense_arrays import Samples
    from rtamt.signals.domain_interface import TimeDomain
    from rtamt.specification import Specification


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
    """Check a recording in chunks, with memory use independent of its length.

    ``chunks``: the input of ``update_many``, such as the traces of :func:`rtamt.scan`.

    The other arguments and the numbers are those of ``Specification.evaluate``; by default, the period is
    inferred from the timestamps of the first chunk. The future of the formula must be bounded, except for ``always``
    and ``eventually`` at its top. Raises :class:`BoundError` if it is not, and the errors of ``evaluate``.

    >>> import rtamt
    >>> chunks = ({"time": [t, t + 1], "x": [5, 4 - t]} for t in (0, 2, 4))
    >>> result = rtamt.check_stream(rtamt.parse("always(x >= 1)"), chunks)
    >>> result.robustness, result.satisfied, result.first_violation, result.samples
    (-1.0, False, 5.0, 6)
    """
    kind = spec.domain if time is None else time_domain(time)
    domain = type(kind).of(spec.period if period is None else period, tolerance, spec.resolution)
    rule = domain.sampling(spec.sampling)
    if rule is not None and rule.hold:
        raise UsageError(
            f"'{rule}' samples the whole recording; evaluate it, or sample the chunks and leave out 'hold'"
        )
    stream = _stream_of(domain)(spec, semantics, time_unit, domain)
    for chunk in chunks:
        stream.take(spec.binding.applied(chunk, partial=domain.continuous))
    return stream.finish()


def _stream_of(domain: TimeDomain) -> Callable[..., Stream]:
    found: Callable[..., Stream] | None = domain.part("stream")
    if found is None:
        raise UsageError(f"recordings in {domain.name} time are not checked in chunks; evaluate them whole")
    return found


def check_streamable(spec: Specification) -> None:
    """Raise :class:`BoundError` where a formula needs the whole recording at once, else as :func:`check_stream`."""
    spec.require_no_groups("a check in chunks")
    _stream_of(spec.domain)
    for alone in spec.requirements.values():
        outputs = outputs_under(alone.formula, alone.semantics, alone.roles)
        check_in_chunks(anchor(outputs.robustness), alone.text)


def has_episodes(spec: Specification) -> bool:
    """Return whether a check in chunks determines the episodes of each requirement, as an evaluation does."""
    return all(
        horizon(alone.formula) is not None
        or (isinstance(alone.formula, Apply) and alone.formula.op is STL["always"])
        for alone in spec.requirements.values()
    )


class Stream(ABC):
    """Requirements over chunks; that of a time domain takes the time domain as well.

    ``unit``: of times that are numbers.
    """

    def __init__(self, spec: Specification, semantics: Semantics | None, unit: str | None) -> None:
        spec.require_no_groups("a check in chunks")
        if not spec.input_names:
            raise UsageError("the formula reads no variable, so that there is nothing to check in chunks")
        chosen = None if semantics is None else semantics_of(semantics)
        self.spec = spec
        self.unit = None if unit is None else check_unit(unit)
        self.declared = spec._declared
        self.requirements = {name: Requirement(one, chosen) for name, one in spec.requirements.items()}
        self.samples = 0
        #: Whether the period that was inferred from the first chunk is that of all chunks.
        self.steady = True

    @abstractmethod
    def take(self, chunk: Any) -> None:
        """Take the next chunk."""

    @abstractmethod
    def finish(self) -> StreamResult:
        """End the recording; return the outcome of all chunks."""

    def result(self, found: Mapping[str, StreamResult], period: Fraction | None) -> StreamResult:
        """Return the result over all chunks, from the results of the requirements."""
        results = tuple(found[name] for name in self.requirements)
        violations = [each.first_violation for each in results if not each.satisfied]
        minima = [each.minimum for each in results]
        return StreamResult(
            min(each.robustness for each in results),
            not violations,
            min(violations, default=None),
            None if None in minima else min(minimum for minimum in minima if minimum is not None),
            self.samples,
            period,
            min(each.start for each in results),
            results[0].episodes if len(results) == 1 else None,
            self.steady,
            MappingProxyType({name: found[name] for name in self.requirements}),
        )

    def require_samples(self) -> None:
        """Raise :class:`TraceError` where no chunk had a sample."""
        if not self.samples:
            raise TraceError("the trace is empty: give at least one sample")


class DiscreteStream(Stream):
    """Chunks of samples one period apart; without a period it is inferred from the first chunk."""

    def __init__(
        self, spec: Specification, semantics: Semantics | None, unit: str | None, domain: Discrete
    ) -> None:
        super().__init__(spec, semantics, unit)
        self._tolerance = domain.tolerance
        self._period = domain.period
        self._inferred = domain.period is None
        self._group = Group(self.requirements, spec.input_names)
        self._monitor: Monitor | None = None
        # The timestamps of positions where something is violated, and of the first.
        self._kept: dict[int, Any] = {}

    def take(self, chunk: Any) -> None:
        """See :class:`Stream`."""
        timestamps, columns, n = arrays.columns_of(chunk, self.spec.input_names, self.unit, self.spec.types)
        if not n:
            return
        if self._monitor is None:
            self._monitor = self._begin(timestamps)
        elif self._inferred and timestamps is not None and self._period is not None:
            self.steady = self.steady and has_period(timestamps.seconds, self._period)
        self._known(self._monitor, push_samples(self._monitor, timestamps, columns, n))
        self.samples += n

    def _begin(self, timestamps: Timestamps | None) -> Monitor:
        if timestamps is not None:
            check_increasing(timestamps.seconds)
        if self._period is None:
            self._period = Fraction(1) if timestamps is None else infer_period(timestamps.seconds)
        domain = Discrete(self._period, self._tolerance)
        domain.check(self.spec.formula, self.spec.text)
        spec = self._group.begin(domain, self.spec)
        return spec.monitor(
            time=domain,
            semantics="standard",
            watch=self._group.formulas[1:],
            time_unit=self.unit,
        )

    def _known(self, monitor: Monitor, first: Signal) -> None:
        """Hand on what became known, the first output and those that are watched."""
        for i, (formula, output) in enumerate(self._group.outputs.items()):
            signal = monitor[formula] if i else first
            assert isinstance(signal, Signal)
            begin = output.known
            output.known += len(signal)
            output.take(np.arange(begin, output.known), signal.values, times=signal.times)
            # A tracker decides on a position when the next one comes: the stamp before is wanted, too.
            violated = (t.violated for t in output.trackers if t.violated is not None)
            for position in {0, *violated}:
                if position == begin - 1:
                    self._kept.setdefault(position, output.last)
                elif begin <= position < output.known:
                    self._kept.setdefault(position, arrays.plain(signal.times[position - begin]))
            if len(signal):
                output.last = arrays.plain(signal.times[-1])

    def _time(self, position: int) -> Any:
        if position in self._kept:
            return self._kept[position]
        # The last one, whose verdict was given at the end: there all outputs stand alike.
        return next(iter(self._group.outputs.values())).last

    def finish(self) -> StreamResult:
        """See :class:`Stream`."""
        self.require_samples()
        assert self._monitor is not None
        self._known(self._monitor, self._monitor.finish())
        found = {
            name: each.result(self._time, self.samples - 1, self.samples, self._period)
            for name, each in self.requirements.items()
        }
        return self.result(found, self._period)


class DenseStream(Stream):
    """Chunks in which each variable has its own timestamps."""

    def __init__(
        self, spec: Specification, semantics: Semantics | None, unit: str | None, domain: Dense
    ) -> None:
        super().__init__(spec, semantics, unit)
        self._domain = domain
        domain.check(spec.formula, spec.text)
        self._groups = [(group, self._monitor(group)) for group in self._grouped()]
        self._scale: TimeScale | None = None
        self._counts: dict[str, int] = {}
        self._first: dict[str, int] = {}
        self._last: dict[str, tuple[int, float]] = {}

    def _grouped(self) -> Iterator[Group]:
        """Yield the requirements that read the same variables: each trace starts when its variables have started."""
        alike: dict[frozenset[str], dict[str, Requirement]] = {}
        for name, each in self.requirements.items():
            variables = own_variables(each.spec.formula, self.spec.input_names)
            alike.setdefault(frozenset(variables), {})[name] = each
        for names, some in alike.items():
            yield Group(some, [name for name in self.spec.input_names if name in names])

    def _monitor(self, group: Group) -> DenseMonitor:
        spec = group.begin(self._domain, self.spec)
        return spec.monitor(time=self._domain, semantics="standard", watch=group.formulas[1:])

    def take(self, chunk: Any) -> None:
        """See :class:`Stream`."""
        arrays.require_no_unit(chunk, self.unit)
        columns = dense_arrays.columns_of(chunk, self.spec.input_names, self.declared)
        given = {name: column for name, column in columns.items() if len(column[0])}
        if not given:
            return
        times = [each for each, _ in given.values()]
        if self._scale is None:
            self._scale = TimeScale.of(self._domain.resolution, times, self.unit)
        self._scale = self._scale.widened(times)
        samples = {}
        for name, column in columns.items():
            last = self._last[name][0] if name in self._last else None
            samples[name] = dense_arrays.samples_of(
                column, name, self._scale, self._counts.get(name, 0), last, self.spec.types.get(name)
            )
        for name, (ticks, values) in samples.items():
            if len(ticks):
                self._first.setdefault(name, int(ticks[0]))
                self._last[name] = int(ticks[-1]), float(values[-1])
                self._counts[name] = self._counts.get(name, 0) + len(ticks)
        for group, monitor in self._groups:
            self._known(group, monitor, push_ticks(monitor, samples, self._scale))
        self.samples += max(map(len, times))

    def _start(self, group: Group) -> int:
        """Return when the trace of a group starts, once all of its variables have."""
        return max(self._first[name] for name in group.names)

    def _known(self, group: Group, monitor: DenseMonitor, first: Samples, end: int | None = None) -> None:
        """Hand on what became known, the first output and those that are watched; ``end``: that of the trace."""
        if not all(name in self._first for name in group.names):
            return
        start = self._start(group)
        for i, (formula, output) in enumerate(group.outputs.items()):
            ticks, values = known_ticks(monitor, formula) if i else first
            output.take(ticks - start, values, None if end is None else end - start)

    def finish(self) -> StreamResult:
        """See :class:`Stream`."""
        self.require_samples()
        for name in self.spec.input_names:
            if name not in self._last:
                raise TraceError(f"'{name}' has no samples: give at least one", variable=name)
        assert self._scale is not None
        end = max(tick for tick, _ in self._last.values())
        found: dict[str, StreamResult] = {}
        for group, monitor in self._groups:
            # The last values hold for ever, and past windows slide on over them until all has settled.
            start = self._start(group)
            leaves = (leaf for each in group.requirements.values() for leaf in each.leaves)
            until = max((end_of(leaf, start, end, self._domain.resolution) for leaf in leaves), default=end)
            behind = [(name, self._last[name]) for name in group.names]
            held = {
                name: (np.array([until]), np.array([value])) for name, (last, value) in behind if last < until
            }
            self._known(group, monitor, push_ticks(monitor, held, self._scale), end)
            self._known(group, monitor, finish_ticks(monitor), end)
            time = partial(self._time, start)
            found |= {
                name: each.result(time, end - start, self.samples, None)
                for name, each in group.requirements.items()
            }
        return self.result(found, None)

    def _time(self, start: int, position: int) -> Any:
        assert self._scale is not None
        return self._scale.time(start + position)
