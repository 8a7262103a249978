"""Check a recording in chunks, only as far as its verdicts need."""

from __future__ import annotations

import sys
from abc import ABC, abstractmethod
from fractions import Fraction
from math import inf
from typing import TYPE_CHECKING, Any

from rtamt.engine import Watched
from rtamt.errors import TraceError
from rtamt.language.formula import Apply
from rtamt.language.operators import Tense, Window
from rtamt.language.units.durations import format_duration
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.lazy.modules import np
from rtamt.rewrite.early import ends_differently
from rtamt.rewrite.semantics import boolean
from rtamt.signals import arrays, assumed_period
from rtamt.signals.discrete import Discrete
from rtamt.signals.inferred_period import infer_period
from rtamt.signals.outcomes import Interval
from rtamt.signals.sampling_period import (
    TOLERANCE,
    check_increasing,
    check_regular,
    elapsed,
    has_period,
    merged,
)
from rtamt.verdicts.decompose import conjuncts
from rtamt.verdicts.early.discrete_eager import EagerMonitor
from rtamt.verdicts.early.discrete_interval import DiscreteIntervalMonitor
from rtamt.verdicts.robustness_and_truth import align_inputs, outputs_under

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from rtamt.language.formula import Formula
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.outcomes import Verdict
    from rtamt.signals.trace import Trace
    from rtamt.specification import Specification


@dataclass(frozen=True, slots=True)
class Decided:
    """A verdict that no later sample can change.

    ``start``: of the trace. ``decided_at``: the time of the sample that decided verdict and first violation.
    ``samples``: how many of its variables there were up to it. ``period``: None in dense time. ``bounds``: of the
    robustness, by then.
    """

    satisfied: bool
    start: Any
    first_violation: Any
    decided_at: Any
    samples: int
    period: Fraction | None
    bounds: Interval


def holds_at_end(spec: Specification) -> bool:
    """Return whether verdicts that are decided early also hold at the end of a trace.

    In dense time they do: signals hold their last values.

    >>> import rtamt
    >>> [holds_at_end(rtamt.parse(text)) for text in ("always(x > 0)", "eventually[1:2] once[0:5](x > 0)")]
    [True, False]
    """
    (truth,) = spec.domain.online.ground(boolean(spec.formula))
    return spec.domain.held_at_end or ends_differently(truth, {}) is None


def in_parts(trace: Trace, size: int = 4096) -> Iterator[Trace]:
    """Yield consecutive parts of a trace, each with about ``size`` timestamps.

    >>> import rtamt
    >>> [part["x"].values.tolist() for part in in_parts(rtamt.read({"time": [0, 1, 2], "x": [5, 6, 7]}), 2)]
    [[5.0, 6.0], [7.0]]
    """
    channels = {name: trace.channel(name) for name in trace}
    timed = [channel.times for channel in channels.values() if channel.times is not None]
    times = merged(timed) if timed else None
    longest = max((len(channel.values) for channel in channels.values()), default=0)
    for begin in range(0, longest if times is None else len(times), size):
        end = begin + size
        part = {}
        for name, channel in channels.items():
            here = slice(begin, end)
            if times is not None and channel.times is not None:
                last = None if end >= len(times) else np.searchsorted(channel.times, times[end])
                here = slice(np.searchsorted(channel.times, times[begin]), last)
            timestamps = None if channel.times is None else channel.times[here]
            part[name] = replace(channel, times=timestamps, values=channel.values[here])
        yield trace.with_channels(part)


class EarlyCheck(ABC):
    """Checks requirements over chunks until all of them are decided.

    ``specs``: each of one requirement for which :func:`holds_at_end`. Raises the errors of ``check_stream``.
    """

    def __init__(self, specs: Sequence[Specification]) -> None:
        self._specs = specs
        self._names = tuple(dict.fromkeys(name for spec in specs for name in spec.input_names))
        self._types = {name: type_ for spec in specs for name, type_ in spec.types.items()}
        self._open: dict[int, Watch] = {}
        self._found: dict[int, Decided] = {}

    @property
    def decided(self) -> list[Decided] | None:
        """The outcome of each specification; None while one is open."""
        return None if self._open or not self._found else [self._found[i] for i in range(len(self._specs))]

    @abstractmethod
    def take(self, chunk: Any) -> bool:
        """Take the next chunk; return whether everything is decided, so that no further one is needed."""

    @abstractmethod
    def _time(self, position: int) -> Any:
        """Return a position as a time in the caller's form."""

    def _close(
        self,
        number: int,
        start: int,
        violated: int | None,
        decided: int,
        samples: int,
        period: Fraction | None,
    ) -> None:
        """Note that a requirement is decided, where its trace starts, and where it is violated first."""
        watch = self._open.pop(number)
        self._found[number] = Decided(
            violated is None,
            self._time(start),
            None if violated is None else self._time(violated),
            self._time(decided),
            samples,
            period,
            watch.bounds,
        )


def _require_period(times: FloatArray, period: Fraction) -> None:
    """Raise :class:`TraceError` where timestamps may have another period than the first ones.

    Only the whole recording shows its period then: the check of that follows.
    """
    if not has_period(times, period):
        raise TraceError(
            f"the sampling period may be another than {format_duration(period)}: give it with --period",
            variable=arrays.TIME,
        )


class DiscreteEarlyCheck(EarlyCheck):
    """The check in discrete time, whose positions count samples."""

    def __init__(self, specs: Sequence[Specification], tolerance: float = TOLERANCE) -> None:
        super().__init__(specs)
        self._tolerance = tolerance
        self._period = specs[0].period
        self._given = self._period is not None
        self._read = [spec.input_names for spec in specs]
        self._samples = 0
        self._last: float | None = None
        self._start: Any = None
        #: The times of samples from ``_first`` on, where something may be violated first.
        self._times: list[Any] = []
        self._first = 0

    def take(self, chunk: Any) -> bool:
        """See :class:`EarlyCheck`."""
        timestamps, columns, n = arrays.columns_of(
            chunk, self._names, types=self._types, first=self._samples, regular=self._given
        )
        if not n:
            return False
        if not self._given:
            assumed_period.require_times_of_each(chunk, self._read)
        if self._period is None:
            self._period = (
                Fraction(1) if timestamps is None else infer_period(timestamps, elapsed(timestamps))
            )
        if not self._samples:
            self._begin(self._period)
        if timestamps is not None:
            seconds, last, dated = timestamps.seconds, self._last, arrays.are_dates(timestamps.original)
            check_increasing(seconds, last, self._samples, dated=dated)
            check_regular(seconds, self._period, self._tolerance, last, self._samples, dated=dated)
            if not self._given:
                _require_period(seconds if last is None else np.concatenate(([last], seconds)), self._period)
            self._last = float(seconds[-1])
        step = float(self._period)
        self._times += (
            [i * step for i in range(self._samples, self._samples + n)]
            if timestamps is None
            else [arrays.plain(time) for time in timestamps.original]
        )
        if not self._samples:
            self._start = self._times[0]
        rows = {name: column.tolist() for name, column in columns.items()}
        for i in range(n):
            self._step(self._samples + i, {name: values[i] for name, values in rows.items()}, self._period)
            if not self._open:
                return True
        self._samples += n
        needed = min(self._samples, *(each.needed for each in self._open.values()))
        del self._times[: needed - self._first]
        self._first = max(self._first, needed)
        return False

    def _begin(self, period: Fraction) -> None:
        for number, spec in enumerate(self._specs):
            formula = Discrete(period).check(spec.formula, spec.text)
            self._open[number] = _Samples(spec.with_formula(formula), period)

    def _step(self, sample: int, row: Mapping[str, float], period: Fraction) -> None:
        for number, each in list(self._open.items()):
            if each.take(sample, row):
                self._close(number, 0, each.violated, sample, sample + 1, period)

    def _time(self, sample: int) -> Any:
        return self._times[sample - self._first] if sample else self._start


class Watch(ABC):
    """The parts of a requirement that must all hold, watched from sample to sample.

    ``unit``: the length of a period or tick in seconds.
    """

    def __init__(self, spec: Specification, unit: Fraction) -> None:
        outputs = outputs_under(spec.formula, spec.semantics, spec.roles)
        self.names = spec.input_names
        #: Whether bounds hold at the end too; otherwise only the verdict gives the sign.
        self._bounded = spec.domain.held_at_end or ends_differently(outputs.robustness, {}) is None
        self._parts = [_Part(part, unit) for part in conjuncts(outputs.truth)]
        first, *others = (part.formula for part in self._parts)
        self._formulas = (
            align_inputs(first, self.names, spec.types),
            align_inputs(outputs.robustness, self.names, spec.types),
        )
        self._watched = [Watched(str(i), formula, None) for i, formula in enumerate(others, 1)]

    @property
    def needed(self) -> int:
        """The first position, not counting the start, that may be the first violation."""
        return min(part.certain if part.is_window else sys.maxsize for part in self._parts)

    @property
    def violated(self) -> int | None:
        """The position at which the requirement is first violated, from the first instant on."""
        return min((part.violated for part in self._parts if part.violated is not None), default=None)

    @property
    def bounds(self) -> Interval:
        """The bounds of the robustness once the requirement is decided."""
        if self._bounded:
            return self._interval()
        return Interval(0.0, inf) if self.violated is None else Interval(-inf, 0.0)

    @abstractmethod
    def take(self, position: int, row: Mapping[str, float]) -> bool:
        """Take values of variables at a position; return whether the requirement is decided."""

    @abstractmethod
    def _interval(self) -> Interval:
        """Return the bounds of the robustness at the start."""

    def _update(self, runs: Iterable[Iterable[tuple[int, int, bool]]]) -> bool:
        """Take what was decided of each part; return whether everything is, and where it is violated first."""
        for part, each in zip(self._parts, runs, strict=True):
            part.take(each)
        violated = self.violated
        if violated is None:
            return all(part.satisfied for part in self._parts)
        return all(part.certain >= violated for part in self._parts)


class _Samples(Watch):
    """A requirement in discrete time."""

    def __init__(self, spec: Specification, period: Fraction) -> None:
        super().__init__(spec, period)
        domain, (truth, robustness) = Discrete(period).online, self._formulas
        self._step = float(period)
        self._verdicts = EagerMonitor(truth, domain, watch=self._watched, backend=spec.backend)
        self._bounds = DiscreteIntervalMonitor(robustness, domain, at="start", backend=spec.backend)

    def _interval(self) -> Interval:
        return self._bounds.interval()

    def take(self, position: int, row: Mapping[str, float]) -> bool:
        """See :class:`Watch`."""
        time, mine = position * self._step, {name: row[name] for name in self.names}
        self._bounds.update(time, **mine)
        found = [self._verdicts.update(time, **mine)]
        found += [self._verdicts[watched.name] for watched in self._watched]
        return self._update(map(self._runs, found))

    def _runs(self, verdicts: Iterable[Verdict]) -> Iterator[tuple[int, int, bool]]:
        for verdict in verdicts:
            sample = round(verdict.time / self._step)
            yield sample, sample + 1, verdict.satisfied


class _Part:
    """``always`` over a window from the start of the trace, or any other formula at the start.

    ``certain``: the first position of the window at which it is not decided that the formula holds; behind the window
    the largest number.
    """

    def __init__(self, formula: Formula, unit: Fraction) -> None:
        self.formula, self.certain, self._last, self.is_window = formula, 0, 0.0, False
        if (
            isinstance(formula, Apply)
            and formula.op.tense is Tense.FUTURE
            and formula.op.kernel == Window("min")
        ):
            (self.formula,), interval, self.is_window = formula.args, formula.interval, True
            self.certain = 0 if interval is None else int(interval.begin / unit)
            end = None if interval is None else interval.end
            self._last = inf if end is None else int(end / unit)
        self._ahead: dict[int, int] = {}  # runs that hold, after one that is open: from begin up to end
        self.violated: int | None = None

    @property
    def satisfied(self) -> bool:
        """Whether the part holds."""
        return self.certain > self._last

    def take(self, runs: Iterable[tuple[int, int, bool]]) -> None:
        """Take decided verdicts: runs from a position up to another."""
        for begin, end, holds in runs:
            first = max(begin, self.certain)
            if first >= end or first > self._last:
                continue
            if holds:
                self._ahead[first] = end
            elif self.violated is None or first < self.violated:
                self.violated = first
        while self.certain in self._ahead:
            self.certain = self._ahead.pop(self.certain)
        if self.satisfied:
            self.certain = sys.maxsize
