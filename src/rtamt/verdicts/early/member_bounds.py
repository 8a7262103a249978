"""Verdicts and bounds before the horizon of quantifiers over members that come and go, in discrete time.

A monitor of bounds runs the formula of a quantifier for each member: whether the member will be present is not known,
and what it gives has bounds, which shrink. So has the column of the outer formula, which another monitor of bounds
reads: up to the newest sample all members are known; later ones may appear, so that later values are unknown.
"""

from __future__ import annotations

from copy import copy
from typing import TYPE_CHECKING, Any

from rtamt.engine.discrete.quantifiers import SampledMembers
from rtamt.engine.quantifiers import Plan, QuantifierExecutor
from rtamt.rewrite.presence import channel_of
from rtamt.usage_guard import exclusive
from rtamt.verdicts.early.discrete_interval import DiscreteIntervalMonitor

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence
    from fractions import Fraction

    from rtamt.engine import Watched
    from rtamt.engine.discrete.member_executors import Sample
    from rtamt.language.formula import Formula
    from rtamt.rewrite.quantifier_streams import Quantified
    from rtamt.signals.discrete import Discrete
    from rtamt.signals.members import Fields
    from rtamt.signals.outcomes import Change, Interval

    Bounds = tuple[float, float]


class _Monitor(DiscreteIntervalMonitor):
    """Bounds from samples in order, of which columns of quantifiers are made more precise later."""

    def _begin(self, time: float, known: dict[str, Any]) -> None:
        super()._begin(time, known)
        if self._early:
            self._start()

    def shrunk(self, output: int = 0) -> dict[int, Bounds]:
        """Return the bounds that the last update has changed, by sample."""
        changes = self._backend.changes(output)
        return {place: (low, high) for first, last, low, high in changes for place in range(first, last + 1)}

    def known(self, output: int = 0) -> dict[int, Bounds]:
        """Return the bounds that are kept, by sample."""
        backend = self._backend
        places = range(backend.held(output), backend.newest + 1)
        return {place: tuple(backend.bounds(output, place)) for place in places}

    def rest(self, output: int = 0) -> dict[int, Bounds]:
        """End the trace; return the bounds that were kept."""
        self.finish()
        first, values = self._rest[output]
        return {first + k: tuple(each) for k, each in enumerate(values)}


class _Executor:
    """The bounds of one member, and the quantifiers inside."""

    def __init__(self, plan: Plan, bound: Mapping[str, str], birth: int) -> None:
        self.plan, self.birth = plan, birth
        self.executor: _Monitor = copy(plan.template)
        self.inside = [_Quantifier(inner, bound) for inner in plan.inside]
        self.absent = 0
        #: What the member gives at samples at which that may still change.
        self.open: dict[int, Bounds] = {}

    def step(
        self, present: Any, values: Mapping[str, Any], sample: Sample | None, times: Mapping[int, Any]
    ) -> set[int]:
        """Take a sample; return those at which the bounds have changed."""
        plan, newest = self.plan, max(times)
        mine = dict(values)
        mine[plan.channel] = 0.0 if sample is None else 1.0
        for field, name in plan.fields.items():
            mine[name] = plan.fillers[field] if sample is None else sample[field]
        before: dict[int, dict[str, Bounds]] = {}
        for inner in self.inside:
            for place, bounds in inner.step(present, mine, times).items():
                before.setdefault(place, {})[inner.plan.column] = bounds
        own = {**mine, **before.pop(newest, {})}
        self.executor.update(times[newest], **{name: own[name] for name in self.executor.input_names})
        changed = self.executor.shrunk()
        for place, columns in before.items():
            if place >= self.birth:
                self.executor.update(times[place], **columns)
                changed |= self.executor.shrunk()
        return self._note(changed)

    def finish(self, times: Mapping[int, Any]) -> set[int]:
        """End the trace; return the samples at which the bounds have changed."""
        changed: dict[int, Bounds] = {}
        for inner in self.inside:
            for place, bounds in inner.finish(times).items():
                if place >= self.birth:
                    self.executor.update(times[place], **{inner.plan.column: bounds})
                    changed |= self.executor.shrunk()
        known, rest = self.executor.known(), self.executor.rest()
        changed |= {place: bounds for place, bounds in rest.items() if known.get(place, bounds) != bounds}
        return self._note(changed)

    def _note(self, changed: Mapping[int, Bounds]) -> set[int]:
        own = {place + self.birth: bounds for place, bounds in changed.items()}
        self.open |= own
        return set(own)

    def bounds(self, place: int) -> Bounds:
        """Return the bounds of the member's value at a sample."""
        known = self.open.get(place)
        if known is None:
            low, high = self.executor._backend.bounds(0, place - self.birth)
            known = low, high
        return known

    def state(self) -> Any:
        inside = [each.state() for each in self.inside]
        return self.executor._state(), self.birth, self.absent, dict(self.open), inside

    def restore(self, state: Any) -> None:
        own, self.birth, self.absent, known, inside = state
        self.open = dict(known)
        self.executor._resume(own)
        for inner, each in zip(self.inside, inside, strict=True):
            inner.restore(each)


class _Quantifier(QuantifierExecutor):
    """The bounds of what the members of a quantifier give together."""

    running: dict[str, _Executor]

    def __init__(self, plan: Plan, bound: Mapping[str, str]) -> None:
        super().__init__(plan, bound)
        self.lag = _total_lag(plan)

    def step(self, present: Any, values: Mapping[str, Any], times: Mapping[int, Any]) -> dict[int, Bounds]:
        """Take a sample; return the bounds of the column at the samples at which they have changed.

        ``times``: of the samples that are open, the last of which is the newest.
        """
        plan, newest = self.plan, max(times)
        here = present[plan.group]
        for member in here:
            if member not in self.running and plan.differs(self.bound, member):
                self.running[member] = _Executor(plan, self.binding(member), newest)
        changed = {newest}
        for member, running in list(self.running.items()):
            sample = here.get(member)
            running.absent = 0 if sample is not None else running.absent + 1
            if plan.keep is not None and running.absent > plan.keep + self.lag:
                del self.running[member]
                continue
            changed |= running.step(present, values, sample, times)
            running.open = {place: each for place, each in running.open.items() if place >= newest - self.lag}
        return self._together(changed)

    def finish(self, times: Mapping[int, Any]) -> dict[int, Bounds]:
        """End the trace; return the bounds of the column at the samples at which they have changed."""
        changed: set[int] = set()
        for running in self.running.values():
            changed |= running.finish(times)
        return self._together({place for place in changed if place in times})

    def _together(self, places: Collection[int]) -> dict[int, Bounds]:
        plan, found = self.plan, {}
        for place in sorted(places):
            low = high = plan.none
            for running in self.running.values():
                if place >= running.birth:
                    lower, upper = running.bounds(place)
                    low, high = plan.join.numbers(low, lower), plan.join.numbers(high, upper)
            found[place] = low, high
        return found

    def state(self) -> Any:
        return {member: running.state() for member, running in self.running.items()}

    def restore(self, state: Any) -> None:
        self.running = {}
        for member, each in state.items():
            self.running[member] = _Executor(self.plan, self.binding(member), 0)
            self.running[member].restore(each)


def _total_lag(of: Plan | Quantified) -> Any:
    """Return after how long what a quantifier gives cannot change any more: samples of a plan, else seconds."""
    return of.lag + max(map(_total_lag, of.inside), default=0)


class MemberIntervalMonitor(SampledMembers):
    """Bounds of the robustness of a formula with quantifiers, from the samples so far.

    Built by ``Specification.monitor(verdict="interval")``; :meth:`update` is that of ``MemberMonitor``.

    >>> import rtamt
    >>> spec = rtamt.parse('group cars = "car_*"; always forall v in cars: v.x > 3')
    >>> monitor = spec.monitor(verdict="interval")
    >>> monitor.update(0, **{"car_1.x": 5})
    >>> monitor.interval()
    Interval(lower=-inf, upper=2.0)
    """

    def __init__(
        self,
        formula: Formula,
        domain: Discrete,
        quantified: Sequence[Quantified],
        fields: Fields,
        *,
        text: str | None = None,
        backend: str = "cpp",
        watch: Sequence[Watched] = (),
        at: str | None = None,
        **settings: Any,
    ) -> None:
        # ``settings``: ``names``, ``declared``, ``factory`` and ``types`` of :class:`QuantifierMonitor`.
        def bounds(of: Formula, inside: Sequence[Quantified], **settings: Any) -> _Monitor:
            late = max(map(_total_lag, inside), default=0) or None
            if late is not None:  # the end cuts windows, which may contradict what was known
                settings |= {"lateness": late, "on_correction": "replay"}
            return _Monitor(of, domain, text=text, backend=backend, **settings)

        def template(of: Quantified) -> _Monitor:
            present = channel_of(of.binder.variable)
            return bounds(of.formula, of.inside, at="every", ranges={present: (0.0, 1.0)})

        assert domain.period is not None
        self._period = domain.period
        plans = [Plan(each, domain.period, template, fields) for each in quantified]
        self._late = max(map(_total_lag, plans), default=0)
        super().__init__(
            bounds(formula, quantified, watch=watch, at=at),
            plans,
            fields,
            watch=watch,
            **settings,
        )
        self.at: str = self._outer.at

    def _begin(self) -> None:
        """See :class:`QuantifierMonitor`."""
        self._samples = 0
        #: The times of the samples at which columns may still change, by index.
        self._times: dict[int, Any] = {}
        #: Of each output of the outer monitor the bounds that the last update has changed, by sample.
        self._changed: dict[int, dict[int, Bounds]] = {}
        super()._begin()

    def _executors(self) -> list[_Quantifier]:
        """See :class:`QuantifierMonitor`."""
        return [_Quantifier(plan, {}) for plan in self._plans]

    @property
    def period(self) -> Fraction:
        """The sampling period in seconds."""
        return self._period

    @property
    def samples(self) -> int:
        """The number of samples since the start or the last reset."""
        return self._samples

    @exclusive
    def update(self, time: Any, /, **values: Any) -> None:
        """Take one sample: its time, a number for every variable, and the members that are present.

        Raises :class:`TraceError` for wrong data and :class:`EvaluationError` where an operation has no value; the
        monitor is then unchanged.
        """
        self._try_update(time, *self._read(values, time))

    def _next_time(self) -> float:
        """See :class:`SampledMembers`."""
        return self._samples * float(self._period)

    def _advance(self, time: Any, numbers: Sample, present: Any) -> None:
        """See :class:`QuantifierMonitor`."""
        newest, outer = self._samples, self._outer
        self._changed = {}
        times = {place: then for place, then in self._times.items() if place >= newest - self._late}
        times[newest] = time
        before: dict[int, dict[str, Any]] = {}
        for each in self._quantifiers:
            for place, bounds in each.step(present, numbers, times).items():
                before.setdefault(place, {})[each.plan.column] = bounds
        row = {**numbers, **before.pop(newest, {})}
        outer.update(time, **{name: row[name] for name in outer.input_names})
        self._note()
        for place, columns in before.items():
            self._refine(times[place], columns)
        self._times, self._samples = times, newest + 1

    def _refine(self, time: Any, columns: Mapping[str, Any]) -> None:
        read = {name: bounds for name, bounds in columns.items() if name in self._outer.input_names}
        if read:
            self._outer.update(time, **read)
            self._note()

    def _note(self) -> None:
        """Note what an update of the outer monitor has changed."""
        for output in self._outer._outputs:
            self._changed[output] = self._changed.get(output, {}) | self._outer.shrunk(output)

    # ---- results -----------------------------------------------------------------------------------

    def interval(self, time: Any = None) -> Interval:
        """Return the bounds at the start of the trace, or at an instant that is not long final (``at="every"``)."""
        found: Interval = self._outer.interval(time)
        return found

    def changes(self) -> list[Change]:
        """Return the runs of samples up to the newest one whose bounds the last update changed, with the new bounds."""
        if self.at == "start":
            raise self._outer._start_only()
        return self._changes(0)

    def __getitem__(self, name: str | Formula) -> list[Change]:
        """Return the changes of a formula that is watched, as :meth:`changes` does for the formula itself."""
        return self._changes(self._outer._output(name) - self._outer._hidden)

    def _changes(self, output: int) -> list[Change]:
        """Return the changes of the last update as runs of equal bounds."""
        found: list[tuple[int, int, Bounds]] = []
        for place, bounds in sorted(self._changed.get(output, {}).items()):
            if found and found[-1][1:] == (place - 1, bounds):
                found[-1] = found[-1][0], place, bounds
            else:
                found.append((place, place, bounds))
        return [self._outer._change(first, last, *bounds, output=output) for first, last, bounds in found]

    @exclusive
    def finish(self) -> list[Change]:
        """End the trace; return the bounds that were still open, which are final now."""
        if self._finished:
            return []
        outer = self._outer
        outputs = outer._outputs
        known = {output: outer.known(output) for output in outputs}
        for each in self._quantifiers:
            for place, bounds in each.finish(self._times).items():
                self._refine(self._times[place], {each.plan.column: bounds})
        for output in outputs:
            rest, before = outer.rest(output), known[output]
            self._changed[output] = {
                place: each for place, each in rest.items() if before.get(place, each) != each
            }
        outer.finish()
        self._finished = True
        return [] if self.at == "start" else self._changes(0)

    def _own(self) -> Any:
        """See :class:`QuantifierMonitor`."""
        return self._samples, dict(self._times), {name: dict(each) for name, each in self._changed.items()}

    def _set_own(self, own: Any) -> None:
        """See :class:`QuantifierMonitor`."""
        self._samples, times, changed = own
        self._times, self._changed = dict(times), dict(changed)
