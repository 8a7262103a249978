"""What ``rtamt monitor --verdict`` prints before the horizon: verdicts as soon as they are settled, and bounds."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.cli.command import json_number, stamp_text
from rtamt.cli.stdin_reader import STDIN
from rtamt.cli.terminal import say
from rtamt.errors import StlError, TraceError
from rtamt.signals.outcomes import VerdictRun
from rtamt.verdicts.discrete_early import DiscreteEarlyMonitor

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.signals.outcomes import Interval, Verdict
    from rtamt.verdicts.dense_early import DenseEagerMonitor
    from rtamt.verdicts.eager import EagerMonitor
    from rtamt.verdicts.early import EarlyMonitor
    from rtamt.verdicts.interval import Change, IntervalMonitor


class EagerFeed:
    """Prints each verdict once it is settled."""

    def __init__(self, monitor: EagerMonitor | DenseEagerMonitor) -> None:
        self.monitor = monitor

    def take(self, stamp: Any, values: dict[str, float], line: int) -> str:
        """Take a sample and print what it settles; return what is wrong with it, if anything is."""
        try:
            self._print(self.monitor.update(_time(self.monitor, stamp), **values))
        except StlError as error:
            return f"{STDIN}, line {line}: {error}"
        return ""

    def finish(self) -> None:
        """End the trace; print what was still open."""
        self._print(self.monitor.finish())

    def _print(self, verdicts: Sequence[Verdict | VerdictRun]) -> None:
        for verdict in verdicts:
            if isinstance(verdict, VerdictRun):
                time = f'{_json(verdict.begin)}, "until": {_json(verdict.end)}'
            else:
                time = _json(verdict.time)
            satisfied, decided = json.dumps(verdict.satisfied), _json(verdict.decided_at)
            say(f'{{"time": {time}, "satisfied": {satisfied}, "decided_at": {decided}}}', flush=True)


class IntervalFeed:
    """Prints bounds whenever they change: those at the start of the trace, or of every instant."""

    def __init__(self, monitor: IntervalMonitor) -> None:
        self.monitor = monitor
        self._last: Interval | None = None
        self._since: Any = None  # the sample that settled the verdict at the start

    def take(self, stamp: Any, values: dict[str, float], line: int) -> str:
        """Take a sample and print what it changes; return what is wrong with it, if anything is."""
        try:
            time = _time(self.monitor, stamp)
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

    def _print_start(self, time: Any) -> None:
        now = self.monitor.interval()
        settled = now.lower > 0 or now.upper < 0
        if settled and self._since is None:
            self._since = time
        if now == self._last and time is not None:
            return
        self._last = now
        final = ', "final": true' if time is None else ""
        stamp = "" if time is None else f'"time": {_json(time)}, '
        say(
            f"{{{stamp}{_ends(now)}, {json.dumps('status')}: {json.dumps(self._status(now))}{final}}}",
            flush=True,
        )

    def _status(self, now: Interval) -> str:
        """Say what is settled of the formula at the start of the trace."""
        since = "" if self._since is None else f" since {stamp_text(self._since)}"
        unit = "" if self._since is None or isinstance(self._since, np.datetime64) else " s"
        if now.upper < 0:
            return f"violated{since}{unit}"
        if now.lower > 0:
            return f"satisfied{since}{unit}" if now.lower == now.upper else "can no longer be violated"
        return "open"

    def _print(self, changes: list[Change]) -> None:
        for change in changes:
            until = f', "until": {_json(change.end)}' if change.end != change.begin else ""
            say(
                f'{{"time": {_json(change.begin)}{until}, {_ends(change.interval)}, '
                f'"final": {json.dumps(change.final)}}}',
                flush=True,
            )


def _time(monitor: EarlyMonitor, stamp: Any) -> Any:
    """Return the time of a sample; without stamps, samples are one period apart."""
    if stamp is not None:
        return stamp
    if not isinstance(monitor, DiscreteEarlyMonitor):
        raise TraceError("in dense time every sample needs its time")
    return monitor.samples * float(monitor.period)


def _json(time: Any) -> str:
    return f'"{stamp_text(time)}"' if isinstance(time, np.datetime64) else stamp_text(time)


def _ends(interval: Interval) -> str:
    """Return the bounds as members of a JSON object."""
    lower, upper = json.dumps(json_number(interval.lower)), json.dumps(json_number(interval.upper))
    return f'"lower": {lower}, "upper": {upper}'
