"""The monitors that must obey the laws of early verdicts, all with the interface of the library's own.

An implementation is four functions, which make a monitor of a formula: to add the engine's, add one to
:data:`IMPLEMENTATIONS`. The first one is the definition, which evaluates all that came again at every question.
"""

from __future__ import annotations

from copy import copy
from math import inf
from typing import TYPE_CHECKING, Any

from rtamt import Causation, CausationRun, Interval, Verdict, VerdictRun
from rtamt.rewrite.check import unbounded_future
from rtamt.rewrite.semantics import boolean
from rtamt.signals.discrete import DISCRETE
from rtamt.verdicts.early.dense_causation import DenseCausationMonitor
from rtamt.verdicts.early.dense_eager import DenseEagerMonitor
from rtamt.verdicts.early.dense_interval import DenseIntervalMonitor
from rtamt.verdicts.early.discrete_causation import DiscreteCausationMonitor
from rtamt.verdicts.early.discrete_eager import EagerMonitor
from rtamt.verdicts.early.discrete_interval import DiscreteIntervalMonitor

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.language.formula import Formula
    from rtamt.signals.outcomes import Change
    from tests.laws.early.cases import Range

from tests.laws.early.definition import DEFINITION, SECONDS, Implementation


def _now_and_then(monitor: Any, t: int) -> Any:
    """Return a copy before some samples: what is not needed any more is forgotten there, else only after many."""
    return copy(monitor) if t % 3 == 1 else monitor


class _Kept:
    """The monitor of the engine, with the bounds of samples that are long final and of the end, as it gave them."""

    backend = "cpp"

    def __init__(
        self, formula: Formula, names: tuple[str, ...], ranges: Mapping[str, Range], lateness: int = 0
    ) -> None:
        declared = {name: limits for name, limits in ranges.items() if name in names}
        self._monitor = DiscreteIntervalMonitor(
            formula,
            DISCRETE.online,
            at="every",
            ranges=declared,
            lateness=lateness,
            backend=self.backend,
        )
        self._kept: dict[int, Interval] = {}

    def _keep(self, changes: list[Change]) -> None:
        for change in changes:
            for t in range(int(change.begin), int(change.end) + 1):
                self._kept[t] = change.interval

    def update(self, t: int, **values: Any) -> None:
        self._monitor = _now_and_then(self._monitor, t)
        self._monitor.update(t, **values)
        self._keep(self._monitor.changes())
        if t in self._kept:
            assert self._monitor.interval(t) == self._kept[t]

    def interval(self, t: int) -> Interval:
        return self._kept[t] if t in self._kept else self._monitor.interval(t)

    def finish(self) -> None:
        self._keep(self._monitor.finish())


class _Settled:
    """The monitor of verdicts of the engine, whose times are seconds, here samples."""

    backend = "cpp"

    def __init__(self, formula: Formula, names: tuple[str, ...], ranges: Mapping[str, Range]) -> None:
        declared = {name: limits for name, limits in ranges.items() if name in names}
        self._monitor = EagerMonitor(boolean(formula), DISCRETE.online, ranges=declared, backend=self.backend)

    @staticmethod
    def _samples(verdicts: list[Verdict]) -> list[Verdict]:
        return [Verdict(int(each.time), each.satisfied, int(each.decided_at)) for each in verdicts]

    def update(self, t: int, **values: Any) -> list[Verdict]:
        self._monitor = _now_and_then(self._monitor, t)
        return self._samples(self._monitor.update(t, **values))

    def finish(self) -> list[Verdict]:
        return self._samples(self._monitor.finish())


class _Causes:
    """The monitor of causation of the engine."""

    backend = "cpp"

    def __init__(self, formula: Formula) -> None:
        self._monitor = DiscreteCausationMonitor(formula, DISCRETE.online, backend=self.backend)

    def update(self, t: int, **values: Any) -> Causation:
        self._monitor = _now_and_then(self._monitor, t)
        return self._monitor.update(t, **values)

    def causation(self, t: int) -> Causation:
        return self._monitor.causation(t)

    def runs(self) -> list[CausationRun]:
        return self._monitor.runs()


class _CausesByPython(_Causes):
    backend = "python"


class _DenseKept:
    """The monitor of bounds in dense time, with what it reported as changes, which must be what it gives when asked."""

    backend = "cpp"

    def __init__(
        self,
        formula: Formula,
        names: tuple[str, ...],
        ranges: Mapping[str, Range],
        lateness: int | None = None,
        *,
        replay: bool = False,
    ) -> None:
        declared = {name: limits for name, limits in ranges.items() if name in names}
        self._monitor = DenseIntervalMonitor(
            formula,
            SECONDS,
            ranges=declared,
            lateness=lateness,
            on_correction="replay" if replay else "reject",
            backend=self.backend,
        )
        self._kept: dict[int, Interval] = {}

    def _keep(self, changes: list[Change]) -> None:
        for change in changes:
            for t in range(int(change.begin), int(change.end)):
                assert self._kept.get(t) != change.interval or self._monitor._finished
                self._kept[t] = change.interval

    def update(self, t: int, **values: Any) -> None:
        self._monitor = _now_and_then(self._monitor, t)
        self._monitor.update(t, **values)
        if self._monitor.at == "every":
            self._keep(self._monitor.changes())

    def watermark(self, t: int) -> None:
        self._monitor.watermark(t)
        if self._monitor.at == "every":
            self._keep(self._monitor.changes())

    def start(self) -> Interval:
        return self._monitor.interval()

    def interval(self, t: int) -> Interval:
        held = self._monitor._backend.held(0)
        if held is not None and t < held:
            return self._kept[t]
        found = self._monitor.interval(t)
        assert self._kept.get(t, found) == found
        return found

    def finish(self) -> None:
        self._keep(self._monitor.finish())


class _DenseSettled:
    """The monitor of verdicts in dense time, whose times are seconds, here ticks."""

    backend = "cpp"

    def __init__(self, formula: Formula, names: tuple[str, ...], ranges: Mapping[str, Range]) -> None:
        declared = {name: limits for name, limits in ranges.items() if name in names}
        self._monitor = DenseEagerMonitor(boolean(formula), SECONDS, ranges=declared, backend=self.backend)

    @staticmethod
    def _ticks(runs: list[VerdictRun]) -> list[VerdictRun]:
        return [
            VerdictRun(int(each.begin), int(each.end), each.satisfied, int(each.decided_at)) for each in runs
        ]

    def update(self, t: int, **values: Any) -> list[VerdictRun]:
        self._monitor = _now_and_then(self._monitor, t)
        return self._ticks(self._monitor.update(t, **values))

    def finish(self) -> list[VerdictRun]:
        return self._ticks(self._monitor.finish())


class _DenseCauses:
    """The monitor of causation in dense time, whose runs must be what it gives when asked."""

    backend = "cpp"

    def __init__(self, formula: Formula) -> None:
        self._monitor = DenseCausationMonitor(formula, SECONDS, backend=self.backend)
        self._bounded = unbounded_future(formula) is None

    def update(self, t: int, **values: Any) -> Causation:
        self._monitor = _now_and_then(self._monitor, t)
        return self._checked(self._monitor.update(t, **values))

    def watermark(self, t: int) -> Causation:
        return self._checked(self._monitor.watermark(t))

    def finish(self) -> Causation:
        return self._checked(self._monitor.finish())

    def _checked(self, caused: Causation) -> Causation:
        assert self._monitor.causation() == caused
        for run in self._monitor.runs() if self._bounded else ():
            inside = Causation(run.violation, run.satisfaction)
            last = run.begin if run.end is None else run.end - 1
            assert self._monitor.causation(run.begin) == inside == self._monitor.causation(last)
            assert inside != Causation(inf, -inf)
        return caused

    def causation(self, t: int) -> Causation:
        found = self._monitor.causation(t)
        finished = self._monitor._finished and t > self._monitor._backend.newest
        runs = [r for r in self._monitor.runs() if r.begin <= t and (r.end is None or t < r.end)]
        assert finished or len(runs) == (found != Causation(inf, -inf))
        return found


class _DenseCausesByPython(_DenseCauses):
    backend = "python"


class _KeptByPython(_Kept):
    backend = "python"


class _SettledByPython(_Settled):
    backend = "python"


class _DenseKeptByPython(_DenseKept):
    backend = "python"


class _DenseSettledByPython(_DenseSettled):
    backend = "python"


ENGINE = Implementation("engine", _Kept, _Settled, _Causes, _DenseKept, _DenseSettled, _DenseCauses, "cpp")
PYTHON = Implementation(
    "Python back end",
    _KeptByPython,
    _SettledByPython,
    _CausesByPython,
    _DenseKeptByPython,
    _DenseSettledByPython,
    _DenseCausesByPython,
    "python",
)

IMPLEMENTATIONS = [DEFINITION, ENGINE, PYTHON]
