"""An output that is monitored before its horizon: bounds and verdict at the start of the trace, in discrete time."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from rtamt.ros.watch import SampledWatch
from rtamt.verdicts.at_start import StartMonitor

if TYPE_CHECKING:
    from collections.abc import Container, Mapping
    from fractions import Fraction

    from rtamt.ros.binding import Output
    from rtamt.ros.watch import Record


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


class EarlyWatch(SampledWatch):
    """One output whose bounds are reported whenever a sample is taken."""

    def __init__(self, output: Output, topic_of: Mapping[str, str], period: Fraction) -> None:
        super().__init__([output], topic_of, period)
        self._start = StartMonitor(output.specification, period=period, time_unit="ns")
        self.standings: tuple[EarlyStanding, ...] = (EarlyStanding(output, self._start),)

    @property
    def samples(self) -> int:
        """The number of samples since the beginning or the last reset."""
        return self._start.samples

    def take(
        self, stamp: int, values: Mapping[str, float], wanted: Container[str] | None = None
    ) -> list[Record]:
        """Take one sample, return the record of its output if its topic is wanted (None: all are)."""
        self._start.update(stamp, **{name: values[name] for name in self.names})
        (standing,) = self.standings
        if wanted is not None and standing.output.bounds not in wanted:
            return []
        known = self._start.interval()
        return [
            Bounds(
                standing.output,
                stamp,
                known.lower,
                known.upper,
                self._start.satisfied,
                self._start.decided_at,
            )
        ]

    def look(self) -> None:
        """Bring the standings up to date: they always are."""

    def reset(self) -> None:
        """Forget all samples."""
        self._start.reset()
