"""Check a recording in chunks, only as far as its verdicts need, in dense time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.signals import dense_arrays
from rtamt.signals.dense import Dense
from rtamt.signals.sample_count import SampleCount
from rtamt.signals.ticks import TimeScale
from rtamt.verdicts.early.check import EarlyCheck, Watch
from rtamt.verdicts.early.dense import push_tick
from rtamt.verdicts.early.dense_eager import DenseEagerMonitor, decided_ticks
from rtamt.verdicts.early.dense_interval import DenseIntervalMonitor

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from fractions import Fraction

    from rtamt.signals.dense_arrays import Samples
    from rtamt.signals.outcomes import Interval
    from rtamt.specification import Specification


class DenseEarlyCheck(EarlyCheck):
    """The check in dense time, whose positions are ticks.

    A chunk may have samples of some variables only; those of each variable must be in order.
    """

    def __init__(self, specs: Sequence[Specification]) -> None:
        super().__init__(specs)
        tick = specs[0].resolution
        self._watches: dict[int, _Ticks] = {}
        for number, spec in enumerate(specs):
            formula = Dense(tick).check(spec.formula, spec.text)
            self._watches[number] = _Ticks(spec.with_formula(formula), tick)
        self._open = dict(self._watches)
        self._tick = tick
        self._scale: TimeScale | None = None
        self._counts = dict.fromkeys(self._names, 0)
        self._lasts: dict[str, int] = {}

    def take(self, chunk: Any) -> bool:
        """See :class:`EarlyCheck`."""
        columns = dense_arrays.columns_of(chunk, self._names, ())
        given = {name: column for name, column in columns.items() if len(column[0])}
        if not given:
            return False
        times = [each for each, _ in given.values()]
        scale = TimeScale.of(self._tick, times) if self._scale is None else self._scale.widened(times)
        self._scale = scale
        samples: dict[str, Samples] = {}
        rows: dict[int, dict[str, float]] = {}
        for name, column in given.items():
            ticks, values = dense_arrays.samples_of(
                column, name, scale, self._counts[name], self._lasts.get(name), self._types.get(name)
            )
            samples[name] = ticks, values
            self._counts[name] += len(ticks)
            self._lasts[name] = int(ticks[-1])
            for tick, value in zip(ticks.tolist(), values.tolist(), strict=True):
                rows.setdefault(tick, {})[name] = value
        for tick in sorted(rows):
            for number, watch in list(self._watches.items()):
                if watch.take(tick, rows[tick]):
                    watch.count.take(_up_to(tick, samples))
                    total = watch.count.total
                    self._close(number, watch.start, watch.violated_at, watch.newest, total, None)
                    del self._watches[number]
            if not self._open:
                return True
        for watch in self._watches.values():
            watch.count.take(samples)
        return False

    def _time(self, tick: int) -> Any:
        assert self._scale is not None
        return self._scale.time(tick)


def _up_to(tick: int, samples: Mapping[str, Samples]) -> dict[str, Samples]:
    """Return the samples up to a tick."""
    ends = {name: int(ticks.searchsorted(tick, "right")) for name, (ticks, _) in samples.items()}
    return {name: (ticks[: ends[name]], values[: ends[name]]) for name, (ticks, values) in samples.items()}


class _Ticks(Watch):
    """A requirement in dense time, whose trace starts when all of its variables have."""

    def __init__(self, spec: Specification, tick: Fraction) -> None:
        super().__init__(spec, tick)
        domain, (truth, robustness) = Dense(tick), self._formulas
        self._verdicts = DenseEagerMonitor(truth, domain, watch=self._watched, backend=spec.backend)
        self._bounds = DenseIntervalMonitor(robustness, domain, at="start", backend=spec.backend)
        #: The samples of its variables in the chunks before.
        self.count = SampleCount(self.names)
        self._firsts: dict[str, int] = {}
        #: The tick at which the trace starts, once all variables have.
        self.start = 0
        #: The tick of the newest sample of any variable.
        self.newest = 0

    def _interval(self) -> Interval:
        return self._bounds.interval()

    @property
    def violated_at(self) -> int | None:
        """The tick at which the requirement is first violated."""
        return None if self.violated is None else self.start + self.violated

    def take(self, position: int, row: Mapping[str, float]) -> bool:
        """See :class:`Watch`; ``row``: of some variables."""
        mine = {name: row[name] for name in self.names if name in row}
        if not mine:
            return False
        self.newest = max(position, self.newest) if self._firsts else position
        for name in mine:
            self._firsts.setdefault(name, position)
        self.start = max(self._firsts.values())
        push_tick(self._bounds, position, mine)
        push_tick(self._verdicts, position, mine)
        if len(self._firsts) < len(self.names):
            return False
        return self._update(self._runs(i, self.start) for i in range(len(self._parts)))

    def _runs(self, output: int, start: int) -> Iterator[tuple[int, int, bool]]:
        for begin, end, satisfied, _ in decided_ticks(self._verdicts, output):
            yield begin - start, end - start, satisfied
