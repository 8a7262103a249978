"""Check a recording in discrete time in chunks of samples one period apart."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from rtamt.engine.discrete.monitor import push_samples
from rtamt.engine.native import has_period
from rtamt.lazy.modules import np
from rtamt.signals import arrays, assumed_period
from rtamt.signals.discrete import Discrete
from rtamt.signals.inferred_period import infer_period
from rtamt.signals.sampling_period import check_increasing, elapsed
from rtamt.signals.signal import Signal
from rtamt.verdicts.chunks import Group, StreamResult
from rtamt.verdicts.streaming import Stream

if TYPE_CHECKING:
    from rtamt.engine.discrete.monitor import Monitor
    from rtamt.errors import TraceError
    from rtamt.settings import Semantics
    from rtamt.signals.arrays import Timestamps
    from rtamt.specification import Specification


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
        self._read = [one.input_names for one in spec.requirements.values()]
        self._latest: float | None = None
        # Of the chunks so far: the rest of a recording may show that its first column holds no timestamps.
        self._lacks_times: TraceError | None = None
        # The timestamps of positions where something is violated, and of the first.
        self._kept: dict[int, Any] = {}

    def take(self, chunk: Any) -> None:
        """See :class:`Stream`."""
        regular = assumed_period.is_known(chunk, self.samples, given=not self._inferred)
        if not regular and isinstance(chunk, arrays.WithTimeBases):
            self._lacks_times, regular = assumed_period.lack_of_times(chunk, self._read), True
        # The monitor takes the samples now, and nothing else reads them later.
        timestamps, columns, n = arrays.columns_of(
            chunk,
            self.spec.input_names,
            self.unit,
            self.spec.types,
            copy=False,
            regular=regular,
        )
        if not n:
            return
        if not regular:
            assumed_period.require_times_of_each(chunk, self._read)
        if self._monitor is None:
            self._monitor = self._begin(timestamps)
        known = push_samples(self._monitor, timestamps, columns, n)
        if self._inferred and timestamps is not None and self._period is not None:
            seconds = timestamps.seconds
            # With the gap from the previous chunk: each gap of the recording is one of one chunk.
            gaps_of = seconds if self._latest is None else np.concatenate(([self._latest], seconds))
            self.steady = self.steady and has_period(gaps_of, self._period)
            self._latest = float(seconds[-1])
        self._known(self._monitor, known)
        self.samples += n

    def _begin(self, timestamps: Timestamps | None) -> Monitor:
        if timestamps is not None:
            check_increasing(timestamps.seconds, dated=arrays.are_dates(timestamps.original))
        if self._period is None:
            self._period = (
                Fraction(1)
                if timestamps is None
                else infer_period(timestamps, elapsed(timestamps, self.unit))
            )
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
            output.take(range(begin, output.known), signal.values, times=signal.times)
            # A tracker decides on a position at the next one, which needs the previous timestamp.
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
        # The last one, whose verdict was decided at the end: all outputs end there.
        return next(iter(self._group.outputs.values())).last

    def finish(self) -> StreamResult:
        """See :class:`Stream`."""
        self.require_samples()
        if self._lacks_times is not None:
            raise self._lacks_times
        assert self._monitor is not None
        self._known(self._monitor, self._monitor.finish())
        found = {
            name: each.result(self._time, self.samples - 1, self.samples, self._period)
            for name, each in self.requirements.items()
        }
        return self.result(found, self._period)
