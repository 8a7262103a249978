"""The definition of bounds and early verdicts behind the interface of the core's ``EarlyMonitor``, discrete time.

Every query evaluates all samples so far: it is slow, and needs memory for the whole trace.
"""

from __future__ import annotations

import pickle
from functools import lru_cache
from math import floor, inf, isfinite
from typing import TYPE_CHECKING, Any

from rtamt.compiler.graph import FOREVER
from rtamt.engine.backend import RefusedError
from rtamt.language.definitions.enclosures import Enclosure
from rtamt.lazy.modules import np
from rtamt.reference.cores import Identity
from rtamt.reference.discrete_bounds import Knowledge, bounds
from rtamt.reference.discrete_causation import NOTHING, causation
from rtamt.signals.outcomes import Causation, Change, Interval

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from rtamt.language.formula import Formula

    Pair = tuple[float, float]


#: Of how many formulas the bounds before any sample are remembered.
_KEPT = 256


@lru_cache(_KEPT)
def _unseen(
    same: Identity, names: tuple[str, ...], limits: tuple[Pair, ...], period: Fraction
) -> list[Enclosure]:
    """Return the bounds of all parts of a formula before any sample; copies of monitors begin with the same."""
    columns = {name: Enclosure(np.empty(0), np.empty(0)) for name in names}
    parts: list[Enclosure] = []
    bounds(same.formula, Knowledge(columns, 0, dict(zip(names, limits, strict=True))), period, parts=parts)
    return parts


class PythonEarlyMonitor:
    """See ``EarlyMonitor`` in ``_core.pyi``.

    ``formulas``: the first is that of the start, and all but the first ``hidden`` are outputs. ``lags``: by how
    many samples the value of each output is final after its instant at the latest.
    """

    def __init__(
        self,
        formulas: Sequence[Formula],
        hidden: int,
        ranges: Sequence[Pair],
        names: Sequence[str],
        period: Fraction,
        tolerance: float,
        lateness: int | None,
        verdict: type | None,
        lags: Sequence[int],
        causes: bool = False,
    ) -> None:
        self._start, self._outputs = formulas[0], tuple(formulas[hidden:])
        self._ranges = dict(zip(names, ranges, strict=True))
        self._names = tuple(names)
        self._period, self._tolerance = period, tolerance
        self._lateness, self._verdict, self._causes = lateness, verdict, causes
        self._lags = tuple(lags)
        self._known: dict[int, dict[str, Pair]] = {}
        #: The times of samples that do not come a whole number of periods after the last such sample.
        self._anchors: dict[int, float] = {}
        self._last = 0.0  # of the newest sample
        self.samples, self.newest, self.closed, self.finished = 0, -1, -1, False
        self._reported: list[dict[int, Any]] = [{} for _ in self._outputs]
        # (first, last, satisfied, decided at) of samples that are not reached, in the order of decision.
        self._decided: list[list[tuple[int, float, bool, int]]] = [[] for _ in self._outputs]
        self._reports: list[list[Any]] = [[] for _ in self._outputs]
        #: The bounds of all parts of each formula, which are kept where an operation has no value yet.
        limits = tuple(ranges)
        *outputs, start = (
            _unseen(Identity(each), self._names, limits, period) for each in (*self._outputs, self._start)
        )
        self._earlier = [start, *outputs]
        #: The same before and after the newest sample, for what it causes.
        self._around = self._earlier, self._earlier
        self._answer_anew()

    @property
    def state_bytes(self) -> int:
        """Bytes of the samples."""
        return 16 * len(self._known) * len(self._names)

    def take(self, time: float, lower: Sequence[float], upper: Sequence[float], after: int) -> Any:
        """Take bounds of every input at one time, in order."""
        return self._take(time, list(zip(range(len(self._names)), lower, upper, strict=True)), after)

    def learn(self, time: float, values: Sequence[tuple[int, float, float]], after: int) -> Any:
        """Take bounds (input, lower, upper) of some inputs at one time."""
        return self._take(time, values, after)

    def _take(self, time: float, values: Sequence[tuple[int, float, float]], after: int) -> Any:
        index = self.place(time)
        if index is None or after != self.samples:
            raise RefusedError("order")
        before = self.state()
        first = index not in self._known
        known = self._known.setdefault(index, {})
        known.update({self._names[number]: (low, high) for number, low, high in values})
        if index > self.newest:
            if not self._anchors or self.time(index) != time:
                self._anchors[index] = time
            self.newest, self._last = index, time
        elif first:
            self._insert(index, time)
        self.samples += 1
        late = 0 if self._lateness is None else self._lateness + 1
        self.closed = max(self.closed, self.newest - late)
        try:
            earlier = self._earlier
            self._compute()
            self._around = earlier, self._earlier
            return self._result()
        except BaseException:
            self.restore(before)
            raise

    def _insert(self, index: int, time: float) -> None:
        """Keep the time of the first sample at an index before the newest one; later samples keep theirs."""
        if self.time(index) == time:
            return
        end = min((i for i in self._anchors if i > index), default=self.newest + 1)
        given = {i: self.time(i) for i in sorted(self._known) if index < i < end}
        self._anchors[index] = time
        for later, own in given.items():
            if self.time(later) != own:
                self._anchors[later] = own

    def _knowledge(self, *, finished: bool = False) -> Knowledge:
        n = self.newest + 1
        columns = {}
        for name in self._names:
            each = [self._known.get(i, {}).get(name, self._ranges[name]) for i in range(n)]
            columns[name] = Enclosure(*(np.array([pair[k] for pair in each], float) for k in (0, 1)))
        closed = min(n, self.closed + 1)
        return Knowledge(columns, n, self._ranges, finished, closed)

    def _answer_anew(self) -> None:
        """Drop the cached answers, by formula identity, which new samples make obsolete."""
        self._found: dict[int, Enclosure] = {}
        self._parts: dict[int, list[Enclosure]] = {}
        self._causation: dict[int, list[Causation]] = {}

    def _bounds(self, formula: Formula) -> Enclosure:
        if id(formula) not in self._found:
            start = self._anchors.get(0, 0.0)
            known = self._knowledge(finished=self.finished and self.newest >= 0)
            # The end of the trace cuts windows, which does not narrow bounds.
            earlier = [] if known.finished else self._earlier_of(formula)
            parts = self._parts[id(formula)] = []
            self._found[id(formula)] = bounds(
                formula, known, self._period, start, earlier=earlier, parts=parts
            )
        return self._found[id(formula)]

    def _place(self, formula: Formula) -> int:
        return next(i for i, each in enumerate((self._start, *self._outputs)) if each is formula)

    def _earlier_of(self, formula: Formula) -> list[Enclosure]:
        return self._earlier[self._place(formula)]

    def _narrow(self) -> None:
        """Compute the bounds of all that came, and keep them."""
        self._answer_anew()
        for formula in (*self._outputs, self._start):
            self._bounds(formula)  # which fails where an operation has no value
        self._earlier = [self._parts[id(formula)] for formula in (self._start, *self._outputs)]

    def _compute(self) -> None:
        """Compute what the last sample made known of each output, up to the newest sample."""
        self._narrow()
        self._reports = [
            self._verdicts(i) if self._verdict else self._changes(i) for i in range(len(self._outputs))
        ]

    def _pair(self, found: Enclosure, sample: int) -> Pair:
        place = min(sample, len(found.lower) - 1)
        return float(found.lower[place]), float(found.upper[place])

    def _verdicts(self, output: int) -> list[Any]:
        found = self._bounds(self._outputs[output])
        decided, reported = self._decided[output], self._reported[output]
        last = len(found.lower) - 1
        for sample in range(last + 1):
            low, high = self._pair(found, sample)
            if low > 0 or high < 0:
                # The last entry is that of all later samples too, unless the trace has ended.
                until = inf if sample == last and not self.finished else sample
                decided.append((sample, until, low > 0, self.newest))
        news = []
        for sample in range(self.newest + 1):
            verdicts = [each for each in decided if each[0] <= sample <= each[1]]
            if verdicts and sample not in reported:
                reported[sample] = verdicts[0][2:]
                news.append((sample, *reported[sample]))
        self._decided[output] = [each for each in decided if each[1] > self.newest]
        return news

    def _changes(self, output: int) -> list[Any]:
        found, reported = self._bounds(self._outputs[output]), self._reported[output]
        news: list[Any] = []
        for sample in range(self.newest + 1):
            pair = self._pair(found, sample)
            if reported.get(sample) == pair:
                continue
            reported[sample] = pair
            if news and news[-1][1] == sample - 1 and news[-1][2:] == pair:
                news[-1] = (news[-1][0], sample, *pair)
            else:
                news.append((sample, sample, *pair))
        return news

    def _result(self) -> Any:
        if self._causes:
            return Causation(*self.causation_at_start())
        return self.verdicts(0) if self._verdict else None

    def causation_at_start(self) -> Pair:
        """Violation and satisfaction that the newest sample causes at the start of the trace."""
        return self._caused(self._start, 0)

    def causation(self, output: int, sample: int) -> Pair:
        """Violation and satisfaction that the newest sample causes for an output at a sample."""
        return self._caused(self._outputs[output], sample)

    def _caused(self, formula: Formula, sample: int) -> Pair:
        if not self.samples:
            return inf, -inf
        found = self._causation_of(formula, every=sample > 0)
        each = found[min(sample, len(found) - 1)]
        return each.violation, each.satisfaction

    def _causation_of(self, formula: Formula, *, every: bool) -> list[Causation]:
        """Return what the newest sample causes at the start, or at every sample; the last entry is for all later."""
        found = self._causation.get(id(formula), [])
        if len(found) < 1 + every:
            m = None if every else 1  # the start is often all that is requested
            before, after = (every_part[self._place(formula)] for every_part in self._around)
            found = causation(formula, self._knowledge(), self._period, m, parts=(before, after))
            self._causation[id(formula)] = found
        return found

    def caused(self, output: int) -> list[tuple[int, int, float, float]]:
        """The same as runs (first, last, violation, satisfaction), where there is any."""
        if not self.samples:
            return []
        found = self._causation_of(self._outputs[output], every=True)
        if self.finished:
            found = found[: self.newest + 1]
        runs: list[tuple[int, int, float, float]] = []
        for sample, each in enumerate(found):
            if each == NOTHING:
                continue
            caused = each.violation + 0.0, each.satisfaction + 0.0  # no minus before a zero
            # The last one is that of all later samples too.
            last = FOREVER if sample == len(found) - 1 and not self.finished else sample
            if runs and runs[-1][1:] == (sample - 1, *caused):
                runs[-1] = (runs[-1][0], last, *caused)
            else:
                runs.append((sample, last, *caused))
        return runs

    def watermark(self, time: float) -> None:
        """Declare that no sample at or before a time will arrive."""
        if self.newest >= 0:
            steps = floor((time - self._last) / float(self._period) + self._tolerance)
            before, self.closed = self.closed, max(self.closed, self.newest + steps)
            try:
                self._narrow()
            except BaseException:
                self.closed = before
                self._answer_anew()
                raise

    def finish(self) -> Any:
        """End the trace; return what that makes known."""
        before = self.state()
        self.finished = True
        self._answer_anew()
        try:
            if self._verdict:
                self._compute()
                return self._result()
            rest = []
            for formula in self._outputs:
                found = self._bounds(formula)
                rest.append((0, [self._pair(found, i) for i in range(self.newest + 1)]))
            return rest, self.at_start() if self.newest >= 0 else None
        except BaseException:
            self.restore(before)
            raise

    def verdicts(self, output: int) -> list[Any]:
        """The verdicts of an output that the last call decided."""
        assert self._verdict is not None
        return [self._verdict(self.time(t), holds, self.time(at)) for t, holds, at in self._reports[output]]

    def at_start(self) -> Pair:
        """The bounds at the start of the trace."""
        return self._pair(self._bounds(self._start), 0)

    def supposed(
        self,
        output: int | None,
        sample: int,
        later: Sequence[tuple[int, int, Sequence[float], Sequence[float]]],
    ) -> Pair | None:
        """The bounds of an output at a sample, or at the start, if later samples had these bounds of all inputs."""
        if output is not None and sample < self.held(output):
            return None
        known = self._knowledge()
        columns, ranges, n = dict(known.columns), dict(self._ranges), known.n
        for first, last, lower, upper in later:
            for name, low, high in zip(self._names, lower, upper, strict=True):
                if first == last:
                    columns[name] = Enclosure(
                        np.append(columns[name].lower, low), np.append(columns[name].upper, high)
                    )
                else:
                    ranges[name] = (low, high)
            n += first == last
        formula = self._start if output is None else self._outputs[output]
        supposed = Knowledge(columns, n, ranges, closed=known.closed, reached=known.n)
        start = self._anchors.get(0, 0.0)
        earlier = self._earlier_of(formula)
        return self._pair(bounds(formula, supposed, self._period, start, earlier=earlier), sample)

    def bounds(self, output: int, sample: int) -> Pair | None:
        """The bounds of an output at a sample, None where the core has forgotten them."""
        return None if sample < self.held(output) else self._pair(self._bounds(self._outputs[output]), sample)

    def changes(self, output: int) -> list[Any]:
        """Runs (first, last, lower, upper) that the last call changed."""
        return self._reports[output]

    def reported(self, output: int) -> list[Change]:
        """The same as a list of changes with times."""
        settled = min(self.closed, self.newest) - self._lags[output]
        return [
            Change(
                self.time(first),
                self.time(last),
                Interval(low, high),
                self.finished or low == high or last <= settled,
            )
            for first, last, low, high in self._reports[output]
        ]

    def begin_at(self, _sample: int) -> bool:
        """Return False: the first sample is number 0."""
        return False

    def place(self, time: float) -> int | None:
        """The index of a time, or None."""
        if not isfinite(time) or self.newest < 0:
            return 0 if isfinite(time) else None
        period, last = float(self._period), self._last
        steps = round((time - last) / period)
        return None if abs(time - last - steps * period) > self._tolerance * period else self.newest + steps

    def known(self, variable: int, sample: int) -> Pair:
        """The bounds of an input at a sample."""
        name = self._names[variable]
        return self._known.get(sample, {}).get(name, self._ranges[name])

    def time(self, sample: int) -> float:
        """The time of a sample."""
        earlier = max((i for i in self._anchors if i <= sample), default=min(self._anchors, default=0))
        return self._anchors.get(earlier, 0.0) + (sample - earlier) * float(self._period)

    @property
    def earliest(self) -> float:
        """The first time that may still be reported."""
        return self._anchors[0]

    def held(self, output: int) -> int:
        """The first sample whose bounds are held: the last one that is final."""
        return max(0, min(self.closed, self.newest) - self._lags[output])

    def state(self) -> bytes:
        """The state after the samples so far."""
        kept = (
            "_known",
            "_anchors",
            "_last",
            "samples",
            "newest",
            "closed",
            "finished",
            "_reported",
            "_decided",
            "_reports",
            "_earlier",
            "_around",
        )
        return pickle.dumps({name: getattr(self, name) for name in kept})

    def restore(self, state: bytes) -> None:
        """Restore the state of a monitor that was made with the same arguments."""
        self.__dict__.update(pickle.loads(state))  # noqa: S301 - its own
        self._answer_anew()
