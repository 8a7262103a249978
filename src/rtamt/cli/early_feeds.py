"""What ``rtamt monitor --verdict`` prints before the horizon: verdicts as soon as they are settled, and bounds."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.cli.command import json_number, stamp_text
from rtamt.cli.stdin_reader import STDIN
from rtamt.cli.terminal import say
from rtamt.errors import StlError
from rtamt.signals.trace import in_seconds

if TYPE_CHECKING:
    from rtamt.signals.outcomes import Interval, Verdict
    from rtamt.verdicts.eager import EagerMonitor
    from rtamt.verdicts.early import EarlyMonitor
    from rtamt.verdicts.interval import Change, IntervalMonitor


class _Feed:
    """A monitor that takes times in seconds, and the stamps of its samples as the input has them."""

    monitor: EarlyMonitor

    def __init__(self) -> None:
        self._stamps: dict[float, Any] = {}

    def _seconds(self, stamp: Any) -> float:
        if stamp is None:
            return self.monitor.samples * float(self.monitor.period)
        if isinstance(stamp, float):
            return stamp
        time = float(in_seconds(np.array([stamp]))[0])
        self._stamps[time] = stamp
        return time

    def _stamp(self, time: float) -> str:
        stamp = self._stamps.get(time, time)
        return f'"{stamp_text(stamp)}"' if isinstance(stamp, np.datetime64) else stamp_text(stamp)


class EagerFeed(_Feed):
    """Prints each verdict once it is settled."""

    def __init__(self, monitor: EagerMonitor) -> None:
        super().__init__()
        self.monitor: EagerMonitor = monitor

    def take(self, stamp: Any, values: dict[str, float], line: int) -> str:
        """Take a sample and print what it settles; return what is wrong with it, if anything is."""
        try:
            self._print(self.monitor.update(self._seconds(stamp), **values))
        except StlError as error:
            return f"{STDIN}, line {line}: {error}"
        return ""

    def finish(self) -> None:
        """End the trace; print what was still open."""
        self._print(self.monitor.finish())

    def _print(self, verdicts: list[Verdict]) -> None:
        for verdict in verdicts:
            satisfied = json.dumps(verdict.satisfied)
            decided = self._stamp(verdict.decided_at)
            say(
                f'{{"time": {self._stamp(verdict.time)}, "satisfied": {satisfied}, "decided_at": {decided}}}',
                flush=True,
            )


class IntervalFeed(_Feed):
    """Prints bounds whenever they change: those at the start of the trace, or of every sample."""

    def __init__(self, monitor: IntervalMonitor) -> None:
        super().__init__()
        self.monitor: IntervalMonitor = monitor
        self._last: Interval | None = None
        self._since: float | None = None  # the sample that settled the verdict at the start

    def take(self, stamp: Any, values: dict[str, float], line: int) -> str:
        """Take a sample and print what it changes; return what is wrong with it, if anything is."""
        time = self._seconds(stamp)
        try:
            self.monitor.update(time, **values)
        except StlError as error:
            return f"{STDIN}, line {line}: {error}"
        if self.monitor.at == "start":
            self._print_start(time)
        else:
            self._print(self.monitor.changes())
        return ""

    def finish(self) -> None:
        """End the trace; print what was still open."""
        rest = self.monitor.finish()
        if self.monitor.at == "start":
            self._print_start(None)
        else:
            self._print(rest)

    def _print_start(self, time: float | None) -> None:
        now = self.monitor.interval()
        settled = now.lower > 0 or now.upper < 0
        if settled and self._since is None:
            self._since = time
        if now == self._last and time is not None:
            return
        self._last = now
        final = ', "final": true' if time is None else ""
        stamp = "" if time is None else f'"time": {self._stamp(time)}, '
        say(
            f"{{{stamp}{_ends(now)}, {json.dumps('status')}: {json.dumps(self._status(now))}{final}}}",
            flush=True,
        )

    def _status(self, now: Interval) -> str:
        """Say what is settled of the formula at the start of the trace."""
        since = "" if self._since is None else f" since {self._stamp(self._since).strip(chr(34))}"
        unit = " s" if since and not self._stamps else ""
        if now.upper < 0:
            return f"violated{since}{unit}"
        if now.lower > 0:
            return f"satisfied{since}{unit}" if now.lower == now.upper else "can no longer be violated"
        return "open"

    def _print(self, changes: list[Change]) -> None:
        for change in changes:
            until = f', "until": {self._stamp(change.end)}' if change.end != change.begin else ""
            say(
                f'{{"time": {self._stamp(change.begin)}{until}, {_ends(change.interval)}, '
                f'"final": {json.dumps(change.final)}}}',
                flush=True,
            )


def _ends(interval: Interval) -> str:
    """Return the bounds as members of a JSON object."""
    lower, upper = json.dumps(json_number(interval.lower)), json.dumps(json_number(interval.upper))
    return f'"lower": {lower}, "upper": {upper}'
