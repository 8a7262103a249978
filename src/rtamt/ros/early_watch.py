"""An output that is monitored before its horizon: bounds and verdict at the start of the trace."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from rtamt.ros.watch import MessageWatch, SampledWatch, Watch
from rtamt.verdicts.at_start import StartMonitor

if TYPE_CHECKING:
    from collections.abc import Container, Mapping

    from rtamt.ros.binding import Output
    from rtamt.ros.watch import Record
    from rtamt.signals.domain_interface import TimeDomain


class Bounds(NamedTuple):
    """Bounds of an output's robustness at the start of the trace, and its verdict there, as known at ``stamp``.

    ``satisfied`` is None while the verdict is open, and ``decided_at`` the stamp of the sample that decided it.
    Times: nanoseconds.
    """

    output: Output
    stamp: int
    lower: float
    upper: float
    satisfied: bool | None
    decided_at: int | None


class EarlyStanding:
    """One output, and how it stood at the last sample."""

    def __init__(self, output: Output, monitor: StartMonitor) -> None:
        self.output = output
        self.topic = output.topic
        self._monitor = monitor

    @property
    def satisfied(self) -> bool | None:
        """Whether the formula holds at the start of the trace; None while that is open."""
        return self._monitor.satisfied

    @property
    def text(self) -> str:
        """What is known of the verdict."""
        return self._monitor.status if self._monitor.samples else "no verdict yet"

    @property
    def facts(self) -> tuple[tuple[str, str], ...]:
        """What diagnostics show of the output."""
        known = self._monitor.interval()
        decided = self._monitor.decided_at
        return (
            ("lower", f"{known.lower:.6g}"),
            ("upper", f"{known.upper:.6g}"),
            ("decided", "no" if decided is None else f"at {decided / 1e9:.15g} s"),
        )


class _AtStart(Watch):
    """One output whose bounds are reported whenever a sample is taken."""

    def __init__(self, output: Output, monitor: StartMonitor) -> None:
        self._start = monitor
        self.standings: tuple[EarlyStanding, ...] = (EarlyStanding(output, monitor),)

    @property
    def samples(self) -> int:
        """The number of samples since the beginning or the last reset."""
        return self._start.samples

    def take(
        self, stamp: int, values: Mapping[str, float], wanted: Container[str] | None = None
    ) -> list[Record]:
        """Take numbers of one instant, return the record of the output if its topic is wanted (None: all are)."""
        self._start.update(stamp, **{name: values[name] for name in self.names if name in values})
        (standing,) = self.standings
        if wanted is not None and standing.output.bounds not in wanted:
            return []
        known = self._start.interval()
        decided = self._start.decided_at
        return [Bounds(standing.output, stamp, known.lower, known.upper, self._start.satisfied, decided)]

    def look(self) -> None:
        """Bring the standings up to date: they always are."""

    def reset(self) -> None:
        """Forget all samples."""
        self._start.reset()


class EarlyWatch(_AtStart, SampledWatch):
    """Samples one period apart."""

    def __init__(self, output: Output, topic_of: Mapping[str, str], domain: TimeDomain) -> None:
        assert domain.period is not None
        SampledWatch.__init__(self, [output], topic_of, domain.period)
        _AtStart.__init__(self, output, StartMonitor(output.specification, time=domain, time_unit="ns"))


class EarlyDenseWatch(_AtStart, MessageWatch):
    """Samples at the times in the messages' headers, each topic on its own time base."""

    def __init__(self, output: Output, topic_of: Mapping[str, str], domain: TimeDomain) -> None:
        MessageWatch.__init__(self, [output], topic_of)
        _AtStart.__init__(self, output, StartMonitor(output.specification, time=domain, time_unit="ns"))

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
