"""Check a recording in dense time in chunks in which each variable has its own timestamps."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from rtamt.engine.dense.monitor import finish_ticks, known_ticks, push_ticks
from rtamt.errors import TraceError
from rtamt.language.contents import own_variables
from rtamt.lazy.modules import np
from rtamt.signals import arrays, dense_arrays
from rtamt.signals.sample_count import SampleCount
from rtamt.signals.ticks import TimeScale
from rtamt.verdicts.chunks import Group, Requirement, StreamResult
from rtamt.verdicts.offline import end_of
from rtamt.verdicts.streaming import Stream

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtamt.engine.dense.monitor import DenseMonitor
    from rtamt.settings import Semantics
    from rtamt.signals.dense import Dense
    from rtamt.signals.dense_arrays import Samples
    from rtamt.specification import Specification


class DenseStream(Stream):
    """Chunks in which each variable has its own timestamps."""

    def __init__(
        self, spec: Specification, semantics: Semantics | None, unit: str | None, domain: Dense
    ) -> None:
        super().__init__(spec, semantics, unit)
        self._domain = domain
        domain.check(spec.formula, spec.text)
        self._groups = [(group, self._monitor(group)) for group in self._grouped()]
        # As those of a whole recording: of each requirement the samples of its own variables.
        self._sampled = {frozenset(group.names): SampleCount(group.names) for group, _ in self._groups}
        self._every = self._sampled.setdefault(frozenset(spec.input_names), SampleCount(spec.input_names))
        self._scale: TimeScale | None = None
        self._counts: dict[str, int] = {}
        self._first: dict[str, int] = {}
        self._last: dict[str, tuple[int, float]] = {}
        self._taken = False

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
        self._taken = self._taken or bool(columns)
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
        for count in self._sampled.values():
            count.take(samples)
        self.samples = self._every.total

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
        if not self._taken:
            self.require_samples()
        for name in self.spec.input_names:
            if name not in self._last:
                raise TraceError(f"'{name}' has no samples: give at least one", variable=name)
        assert self._scale is not None
        found: dict[str, StreamResult] = {}
        for group, monitor in self._groups:
            # The last values hold for ever, and past windows slide on over them until all has settled.
            start, end = self._start(group), max(self._last[name][0] for name in group.names)
            leaves = (leaf for each in group.requirements.values() for leaf in each.leaves)
            until = max((end_of(leaf, start, end, self._domain.resolution) for leaf in leaves), default=end)
            behind = [(name, self._last[name]) for name in group.names]
            held = {
                name: (np.array([until]), np.array([value])) for name, (last, value) in behind if last < until
            }
            self._known(group, monitor, push_ticks(monitor, held, self._scale), end)
            self._known(group, monitor, finish_ticks(monitor), end)
            time = partial(self._time, start)
            count = self._sampled[frozenset(group.names)].total
            found |= {
                name: each.result(time, end - start, count, None) for name, each in group.requirements.items()
            }
        return self.result(found, None)

    def _time(self, start: int, position: int) -> Any:
        assert self._scale is not None
        return self._scale.time(start + position)
