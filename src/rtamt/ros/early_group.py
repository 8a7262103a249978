"""Outputs that are monitored before their horizon: bounds and verdicts, at the start of the trace or everywhere."""

from __future__ import annotations

from abc import ABC, abstractmethod
from math import inf
from typing import TYPE_CHECKING, Any

from rtamt.lazy.tuples import NamedTuple
from rtamt.ros.binding import EAGER, EVERY
from rtamt.ros.group import Group, MessageGroup, SampledGroup
from rtamt.signals.outcomes import VerdictRun
from rtamt.verdicts.early.at_start import OPEN, SATISFIED, VIOLATED, StartMonitor

if TYPE_CHECKING:
    from collections.abc import Container, Mapping

    from rtamt.ros.binding import Output
    from rtamt.ros.group import Record
    from rtamt.signals.time_domain_interface import TimeDomain


class Bounds(NamedTuple):
    """Bounds of an output's robustness from ``begin`` to ``end``, and its verdict there, as known at ``stamp``.

    ``satisfied`` is None while the verdict is open, and ``decided_at`` the stamp of the sample that decided it, None
    if that is not known. ``end``: the last sample, in dense time the instant after the last one. Times: nanoseconds.
    """

    output: Output
    stamp: int
    lower: float
    upper: float
    satisfied: bool | None
    decided_at: int | None
    begin: int
    end: int


class Reports(ABC):
    """One output and its monitor: samples in, records out. ``satisfied``: the last verdict; None: open."""

    _monitor: Any

    def __init__(self, output: Output) -> None:
        self.output = output
        self.topic = output.topic
        self.satisfied: bool | None = None

    @abstractmethod
    def take(self, stamp: int, values: Mapping[str, float]) -> list[Bounds]:
        """Take numbers of one instant; return the records."""

    def reset(self) -> None:
        """Forget all samples."""
        self._monitor.reset()
        self.satisfied = None

    @property
    def samples(self) -> int:
        """The number of samples since the beginning or the last reset."""
        return int(self._monitor.samples)

    @property
    def text(self) -> str:
        """The state of the verdict."""
        if not self.samples:
            return "no verdict yet"
        return OPEN if self.satisfied is None else SATISFIED if self.satisfied else VIOLATED

    @property
    def facts(self) -> tuple[tuple[str, str], ...]:
        """The text of the output for diagnostics."""
        return ()


#: What a node shows of an output.
EarlyStanding = Reports


class _AtStart(Reports):
    """Bounds and verdict at the start of the trace, with every sample."""

    def __init__(self, output: Output, domain: TimeDomain) -> None:
        super().__init__(output)
        self._monitor = StartMonitor(output.specification, time=domain, time_unit="ns")
        self._firsts: dict[str, int] = {}

    def take(self, stamp: int, values: Mapping[str, float]) -> list[Bounds]:
        self._monitor.update(stamp, **values)
        for name in values:
            self._firsts.setdefault(name, stamp)
        self.satisfied = self._monitor.satisfied
        known, start = self._monitor.interval(), max(self._firsts.values())
        decided = self._monitor.decided_at
        return [Bounds(self.output, stamp, known.lower, known.upper, self.satisfied, decided, start, start)]

    def reset(self) -> None:
        super().reset()
        self._firsts.clear()

    @property
    def text(self) -> str:
        return self._monitor.status if self.samples else super().text

    @property
    def facts(self) -> tuple[tuple[str, str], ...]:
        known = self._monitor.interval()
        decided = self._monitor.decided_at
        return (
            ("lower", f"{known.lower:.6g}"),
            ("upper", f"{known.upper:.6g}"),
            ("decided", "no" if decided is None else f"at {decided / 1e9:.15g} s"),
        )


class _Decided(Reports):
    """Verdicts of every instant, each once it is decided; its sign bounds the robustness."""

    def __init__(self, output: Output, domain: TimeDomain) -> None:
        super().__init__(output)
        settings: dict[str, Any] = {"verdict": "eager", "time": domain, "time_unit": "ns"}
        self._monitor = output.specification.monitor(**settings)

    def take(self, stamp: int, values: Mapping[str, float]) -> list[Bounds]:
        records = []
        for verdict in self._monitor.update(stamp, **values):
            run = isinstance(verdict, VerdictRun)
            begin, end = (verdict.begin, verdict.end) if run else (verdict.time, verdict.time)
            lower, upper = (0.0, inf) if verdict.satisfied else (-inf, 0.0)
            times = int(verdict.decided_at), int(begin), int(end)
            records.append(Bounds(self.output, stamp, lower, upper, verdict.satisfied, *times))
            self.satisfied = verdict.satisfied
        return records


class _Changes(Reports):
    """Bounds of every instant, whenever they change; their sign is the verdict."""

    def __init__(self, output: Output, domain: TimeDomain) -> None:
        super().__init__(output)
        self._monitor = output.specification.monitor(
            verdict="interval", at="every", time=domain, time_unit="ns"
        )

    def take(self, stamp: int, values: Mapping[str, float]) -> list[Bounds]:
        self._monitor.update(stamp, **values)
        records = []
        for change in self._monitor.changes():
            lower, upper = change.interval.lower, change.interval.upper
            satisfied = True if lower > 0 else False if upper < 0 else None
            times = int(change.begin), int(change.end)
            records.append(Bounds(self.output, stamp, lower, upper, satisfied, None, *times))
            if (
                satisfied is not None
            ):  # the instants after the last verdict are open for as long as the horizon
                self.satisfied = satisfied
        return records


def reports_of(output: Output, domain: TimeDomain) -> Reports:
    """Return what is reported of an output, as :func:`~rtamt.ros.binding.bind` chose."""
    return {EAGER: _Decided, EVERY: _Changes}.get(output.early, _AtStart)(output, domain)


class _Reporting(Group):
    """One output with a record for each sample."""

    def __init__(self, reports: Reports) -> None:
        self._reports = reports
        self.standings: tuple[EarlyStanding, ...] = (reports,)

    @property
    def samples(self) -> int:
        """The number of samples since the beginning or the last reset."""
        return self._reports.samples

    def take(
        self, stamp: int, values: Mapping[str, float], wanted: Container[str] | None = None
    ) -> list[Record]:
        """Take numbers of one instant, return the records of the output if its topic is wanted (None: all are)."""
        records = self._reports.take(stamp, {name: values[name] for name in self.names if name in values})
        return [] if wanted is not None and self._reports.output.bounds not in wanted else list(records)

    def refresh(self) -> None:
        """Bring the standings up to date: they always are."""

    def reset(self) -> None:
        """Forget all samples."""
        self._reports.reset()


class EarlyGroup(_Reporting, SampledGroup):
    """Samples one period apart."""

    def __init__(self, reports: Reports, topic_of: Mapping[str, str], domain: TimeDomain) -> None:
        assert domain.period is not None
        SampledGroup.__init__(self, [reports.output], topic_of, domain.period)
        _Reporting.__init__(self, reports)


class EarlyDenseGroup(_Reporting, MessageGroup):
    """Samples at the times in the messages' headers, each topic on its own time base."""

    def __init__(self, reports: Reports, topic_of: Mapping[str, str]) -> None:
        MessageGroup.__init__(self, [reports.output], topic_of)
        _Reporting.__init__(self, reports)

    def take(
        self, stamp: int, values: Mapping[str, float], wanted: Container[str] | None = None
    ) -> list[Record]:
        """Take the numbers of one message, and of those that waited for it."""
        records: list[Record] = []
        while self._held:
            before, held = self._held.popleft()
            records += super().take(before, held, wanted)
        return records + super().take(stamp, values, wanted)

    def reset(self) -> None:
        """Forget all samples."""
        super().reset()
        self._held.clear()
