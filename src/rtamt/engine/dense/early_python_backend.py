"""The definition of bounds and early verdicts behind the interface of the core's ``DenseEarlyMonitor``.

Every query evaluates all samples so far: it is slow, and needs memory for the whole trace.
Times are ticks; runs are half-open, from ``begin`` up to and without ``end``.
"""

from __future__ import annotations

import pickle
from functools import lru_cache, partial
from math import inf
from typing import TYPE_CHECKING, TypeAlias

from rtamt.compiler.graph import FOREVER, NEVER
from rtamt.engine.backend import RefusedError
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.reference.cores import Identity
from rtamt.reference.dense_bounds import DenseKnowledge, Parts, StepBounds, bounds, least
from rtamt.reference.dense_causation import causation
from rtamt.reference.dense_causation import least as least_caused
from rtamt.signals.runs import clipped, compared, merged, without

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from fractions import Fraction

    from rtamt.language.formula import Formula
    from rtamt.reference.dense_bounds import Samples
    from rtamt.reference.dense_causation import StepCauses
    from rtamt.signals.outcomes import Causation
    from rtamt.signals.runs import Decided, Pair, Run

#: Of how many formulas the bounds before any sample are remembered.
_KEPT = 256

#: The minimum of formulas, each over the trace of some variables.
Output: TypeAlias = "Sequence[tuple[Formula, tuple[str, ...]]]"


@dataclass(frozen=True, slots=True)
class _Came:
    """The samples so far: their bounds by input and tick, their number per input, and the newest tick."""

    known: tuple[Mapping[int, Pair], ...]
    counts: tuple[int, ...]
    newest: int = NEVER
    closed: int = NEVER
    finished: bool = False

    def after(self, tick: int, values: Sequence[tuple[int, float, float]]) -> _Came:
        known, counts = list(self.known), list(self.counts)
        for number, low, high in values:
            known[number] = {**known[number], tick: (low, high)}
            counts[number] += 1
        newest = max(self.newest, tick) if values else self.newest
        return replace(self, known=tuple(known), counts=tuple(counts), newest=newest)

    def closed_up_to(self, tick: int) -> _Came:
        return replace(self, closed=max(self.closed, tick))


@dataclass(frozen=True, slots=True)
class _Report:
    """The last report of an output: its bounds up to the newest sample, or its decisions."""

    runs: tuple[Run, ...] = ()
    decided: tuple[Decided, ...] = ()
    until: int = NEVER
    #: What the last call added to them.
    changed: tuple[Run, ...] = ()
    reached: tuple[Decided, ...] = ()


class PythonDenseEarlyMonitor:
    """Verdicts (``verdicts``) or bounds of some outputs, the first of which is that of the start.

    ``hidden``: how many outputs are requested only at the start. ``lateness``: in ticks, how long after the newest
    sample of any input a sample may arrive; None if those of each input arrive in order.
    """

    def __init__(
        self,
        outputs: Sequence[Output],
        hidden: int,
        ranges: Sequence[Pair],
        names: Sequence[str],
        tick: Fraction,
        lateness: int | None,
        verdicts: bool,
        causes: bool = False,
    ) -> None:
        self._waits = causes  # for all traces to start
        self._before: _Came | None = None  # the last event
        self._causes: dict[int, StepCauses | None] = {}  # of all formulas that were requested
        self._formulas, self._hidden = tuple(outputs), hidden
        self._ranges = dict(zip(names, ranges, strict=True))
        self._names = tuple(names)
        self._tick, self._lateness, self._decides = tick, lateness, verdicts
        self._came = _Came(({},) * len(self._names), (0,) * len(self._names))
        self._reports = (_Report(),) * (len(outputs) - hidden)
        # Of all formulas, and at the start, for all that came.
        self._found: list[StepBounds | None] | None = None
        self._start: Pair | None = None
        # The bounds of all parts of each of them, which are kept where an operation has no value yet.
        self._earlier: tuple[tuple[Parts, ...], ...] = tuple(
            tuple(_unseen(Identity(each), names, self._limits(names), tick) for each, names in output)
            for output in outputs
        )
        self._earlier_before = self._earlier  # the last event

    # ---- samples ---------------------------------------------------------------------------------

    def learn(self, tick: int, values: Sequence[tuple[int, float, float]], after: int) -> None:
        """Take samples of some inputs, (input, lower, upper), at a tick; ``after``: the caller's number of samples.

        The trace starts when every input has a sample, and earlier ones can no longer arrive.
        """
        if after != self.samples or self.finished or tick <= self.closed:
            raise RefusedError("order")
        lasts = self.last_times
        if self._lateness is None and any(tick <= lasts[number] for number, _, _ in values):
            raise RefusedError("order")
        came = self._came.after(tick, values)
        if self._lateness is not None and values:
            came = came.closed_up_to(came.newest - self._lateness - 1)
        self._take(came, tick)

    def watermark(self, tick: int) -> None:
        """Declare that no sample at or before a tick will arrive."""
        self._take(self._came.closed_up_to(tick), tick)

    def finish(self) -> None:
        """End the trace: every input holds its last value for ever. Each has a sample."""
        self._take(replace(self._came, finished=True), self.newest)

    def _take(self, came: _Came, now: int) -> None:
        """Go on with all that came; an operation without a value leaves everything as it was."""
        if self._lateness is not None:
            self._rehearse(came)
        found, earlier = [], []
        for place in range(len(self._formulas)):
            parts = list(self._earlier[place])
            found.append(self._bounds(place, came, parts=parts))
            earlier.append(tuple(parts))
        self._reports = tuple(
            before if each is None else self._reported(before, each, came.newest, now)
            for before, each in zip(self._reports, found[self._hidden :], strict=True)
        )
        self._before, self._came, self._found, self._causes = self._came, came, found, {}
        self._start = None
        self._earlier_before, self._earlier = self._earlier, tuple(earlier)

    def _rehearse(self, came: _Came) -> None:
        """Raise the error for samples that have no value if their trace starts at the latest first one of them."""
        knowledge = self._knowledge(came)
        for formulas, parts in zip(self._formulas, self._earlier, strict=True):
            for (formula, names), unseen in zip(formulas, parts, strict=True):
                known = knowledge.of(names)
                first = known.latest_first
                if known.start is None and first is not None:
                    bounds(formula, replace(known, begins=first), self._tick, earlier=unseen)

    def _limits(self, names: tuple[str, ...]) -> tuple[Pair, ...]:
        return tuple(self._ranges[name] for name in names)

    def _knowledge(self, came: _Came) -> DenseKnowledge:
        samples, closed = {}, {}
        for name, known in zip(self._names, came.known, strict=True):
            ticks = sorted(known)
            samples[name] = ticks, [known[t][0] for t in ticks], [known[t][1] for t in ticks]
            ordered = ticks[-1:] if self._lateness is None else []
            closed[name] = max([came.closed, *ordered])
        return DenseKnowledge(samples, self._ranges, came.finished, closed)

    def _bounds(
        self,
        output: int,
        came: _Came,
        later: Mapping[str, Samples] | None = None,
        parts: list[Parts] | None = None,
    ) -> StepBounds | None:
        """Return the bounds of an output; None while the trace has not started.

        ``later``: see DenseKnowledge. ``parts``: of each formula of the output, what becomes known of its parts.
        """
        knowledge = replace(self._knowledge(came), later=later or {})
        if self._waits and knowledge.start is None:
            return None
        begun, formulas = [], self._formulas[output]
        for place, (formula, names) in enumerate(formulas):
            known = knowledge.of(names)
            if known.start is None:
                continue  # what has no value elsewhere is an error before this trace has started, too
            report = None if parts is None else partial(parts.__setitem__, place)
            earlier = self._earlier[output][place]
            begun.append(bounds(formula, known, self._tick, earlier=earlier, report=report))
        return least(begun) if len(begun) == len(formulas) else None

    def _parts(
        self, formula: int, came: _Came, later: Mapping[str, Samples] | None = None
    ) -> list[StepBounds]:
        """Return the bounds of each formula of an output; of one whose trace has not started from the ranges."""
        knowledge = replace(self._knowledge(came), later=later or {})
        unseen = DenseKnowledge(dict.fromkeys(self._names, ((), (), ())), self._ranges)
        parts = []
        for (each, names), earlier in zip(self._formulas[formula], self._earlier[formula], strict=True):
            known = knowledge.of(names)
            known = unseen.of(names) if known.start is None else known
            parts.append(bounds(each, known, self._tick, earlier=earlier))
        return parts

    def _now(self, formula: int) -> StepBounds | None:
        if self._found is None:
            self._found = [self._bounds(place, self._came) for place in range(len(self._formulas))]
        return self._found[formula]

    def _reported(self, before: _Report, found: StepBounds, newest: int, now: int) -> _Report:
        """Return the reported part of an output from now on."""
        return _verdicts(before, found, newest, now) if self._decides else _changes(before, found, newest)

    def set_time_scale(self, signal: type, rate: float) -> None:
        """Ignore the time scale: callers convert all times."""

    # ---- results ---------------------------------------------------------------------------------

    @property
    def samples(self) -> int:
        """The number of samples of all inputs so far."""
        return sum(self._came.counts)

    @property
    def counts(self) -> tuple[int, ...]:
        """The same of each input."""
        return self._came.counts

    @property
    def last_times(self) -> tuple[int, ...]:
        """The tick of the newest sample of each input, NEVER if there is none."""
        return tuple(max(known, default=NEVER) for known in self._came.known)

    @property
    def newest(self) -> int:
        """The tick of the newest sample of any input, NEVER if there is none."""
        return self._came.newest

    @property
    def closed(self) -> int:
        """The last tick at or before which no sample will arrive, NEVER if there is none."""
        return self._came.closed

    @property
    def complete(self) -> int:
        """The tick up to which all inputs are as well known as they will ever be, NEVER before all traces start.

        What a trace does not begin with counts as known.
        """
        knowledge = self._knowledge(self._came)
        complete = FOREVER
        for output in self._formulas:
            for _, names in output:
                own = knowledge.of(names)
                if own.start is None:
                    return NEVER
                complete = min(complete, max(own.complete, own.start - 1))
        return complete

    def place(self, tick: int) -> int:
        """The position of a time, which is the tick itself."""
        return tick

    @property
    def finished(self) -> bool:
        """Whether the trace has ended."""
        return self._came.finished

    @property
    def state_bytes(self) -> int:
        """Bytes of the samples."""
        return 24 * sum(map(len, self._came.known))

    def verdicts(self, output: int) -> list[Decided]:
        """Runs (begin, end, satisfied, decided at) of an output that the last call decided or reached."""
        return list(self._reports[output].reached)

    def changes(self, output: int) -> list[Run]:
        """Runs (begin, end, lower, upper) of an output that the last call changed, up to the newest sample."""
        return list(self._reports[output].changed)

    def runs(self, output: int) -> list[Run]:
        """All current runs of an output up to the newest sample that are held."""
        return list(self._reports[output].runs)

    def bounds(self, output: int, tick: int) -> Pair | None:
        """The bounds of an output at a tick, None where the trace has not started or they are forgotten."""
        found = self._now(self._hidden + output)
        return None if found is None or tick < found.times[0] else found.at(tick)

    def supposed(
        self, output: int | None, tick: int, later: Sequence[tuple[int, int, float, float]]
    ) -> Pair | None:
        """The bounds of an output at a tick, or at the start, if inputs had bounds (input, from, lower, upper)."""
        first = self.held(output) if output is not None else self._knowledge(self._came).start
        if first is None or (output is not None and tick < first):
            return None
        rows = {
            name: [each[1:] for each in later if each[0] == number] for number, name in enumerate(self._names)
        }
        supposed = {name: tuple(zip(*each, strict=True)) for name, each in rows.items() if each}
        if output is None:
            return _at_starts(self._parts(0, self._came, supposed))
        found = self._bounds(self._hidden + output, self._came, supposed)
        return None if found is None else found.at(tick)

    def held(self, output: int) -> int | None:
        """The first tick whose bounds are held; None before the trace has started."""
        found = self._now(self._hidden + output)
        return None if found is None else found.times[0]

    def at_start(self) -> Pair:
        """The bounds at the start of the trace, for each formula at the start of its own trace."""
        if self._start is None:
            self._start = _at_starts(self._parts(0, self._came))
        return self._start

    def _caused(self, formula: int) -> StepCauses | None:
        """Return the causation of the last event; None before the start of the trace."""
        if formula not in self._causes:
            self._causes[formula] = self._caused_of(formula, range(len(self._formulas[formula])))
        return self._causes[formula]

    def _caused_of(self, output: int, places: Iterable[int]) -> StepCauses | None:
        """Return the same of some of the formulas of an output."""
        now = self._knowledge(self._came)
        if now.start is None:
            return None
        before = None if self._before is None else self._knowledge(self._before)
        if before is not None and before.start is None:
            before = None  # what arrived until all traces have started is one event
        causes = []
        for place in places:
            formula, names = self._formulas[output][place]
            parts = self._earlier_before[output][place], self._earlier[output][place]
            was = None if before is None else before.of(names)
            causes.append(causation(formula, was, now.of(names), self._tick, parts))
        return least_caused(causes)

    def causation_at_start(self) -> Pair:
        """Violation and satisfaction that the last event caused at the start of the trace, as bounds there."""
        count = len(self._formulas[0])
        parts = [self._caused(0)] if count == 1 else [self._caused_of(0, [k]) for k in range(count)]
        begun = [part.causes[0] for part in parts if part is not None]
        violation = min((cause.violation for cause in begun), default=inf)
        satisfaction = max((cause.satisfaction for cause in begun), default=-inf)
        if begun and len(parts) > 1:
            satisfaction = min(satisfaction, self.at_start()[0])
        return violation + 0.0, satisfaction + 0.0

    def causation(self, output: int, tick: int | None) -> Pair | None:
        """The same of an output at a tick, or at the start; None before the trace."""
        found = self._caused(self._hidden + output)
        if found is None or (tick is not None and tick < found.times[0]):
            return None
        return _pair(found.causes[0] if tick is None else found.at(tick))

    def caused(self, output: int) -> list[Run]:
        """The same as runs (begin, end, violation, satisfaction), where there is any."""
        found = self._caused(self._hidden + output)
        if found is None:
            return []
        last = self.newest + 1 if self.finished else FOREVER
        runs = (
            (t, end, *_pair(cause))
            for t, end, cause in zip(found.times, (*found.times[1:], FOREVER), found.causes, strict=True)
        )
        return list(clipped(merged(run for run in runs if run[2:] != (inf, -inf)), found.times[0], last))

    def known(self, number: int, tick: int) -> Pair:
        """The bounds of an input at the tick of a sample."""
        return self._came.known[number].get(tick, self._ranges[self._names[number]])

    def state(self) -> bytes:
        """The state after the samples so far."""
        return pickle.dumps((self._before, self._came, self._reports, self._earlier_before, self._earlier))

    def restore(self, state: bytes) -> None:
        """Restore the state of a monitor that was made with the same arguments."""
        kept = pickle.loads(state)  # noqa: S301 - its own
        self._before, self._came, self._reports, self._earlier_before, self._earlier = kept
        self._found, self._start, self._causes = None, None, {}


@lru_cache(_KEPT)
def _unseen(same: Identity, names: tuple[str, ...], limits: tuple[Pair, ...], tick: Fraction) -> Parts:
    """Return the bounds of the parts of a formula before any sample; copies of monitors begin with the same."""
    ranges = dict(zip(names, limits, strict=True))
    found: list[Parts] = []
    bounds(
        same.formula, DenseKnowledge(dict.fromkeys(names, ((), (), ())), ranges), tick, report=found.append
    )
    return found[0]


def _at_starts(parts: Sequence[StepBounds]) -> Pair:
    return min(part.lower[0] for part in parts), min(part.upper[0] for part in parts)


def _pair(caused: Causation) -> Pair:
    return caused.violation + 0.0, caused.satisfaction + 0.0  # no minus before a zero


def _runs(found: StepBounds) -> list[Run]:
    ends = [*found.times[1:], FOREVER]
    return list(zip(found.times, ends, found.lower, found.upper, strict=True))


def _verdicts(before: _Report, found: StepBounds, newest: int, now: int) -> _Report:
    signs = [(begin, end, low > 0, now) for begin, end, low, high in _runs(found) if low > 0 or high < 0]
    fresh = list(without(signs, before.decided))
    reached = [
        *clipped(fresh, NEVER, newest + 1),
        *clipped(before.decided, before.until + 1, newest + 1),
    ]
    decided = merged(sorted([*before.decided, *fresh]))
    return _Report(decided=decided, until=newest, reached=merged(sorted(reached)))


def _changes(before: _Report, found: StepBounds, newest: int) -> _Report:
    runs = tuple(clipped(_runs(found), NEVER, newest + 1))
    changed = ((begin, end, *now) for begin, end, was, now in compared(before.runs, runs) if was != now)
    return _Report(runs=runs, until=newest, changed=merged(changed))
