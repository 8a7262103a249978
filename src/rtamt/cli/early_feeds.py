"""Output of ``rtamt monitor --verdict`` before the horizon: settled verdicts, bounds, and causation."""

from __future__ import annotations

import json
import sys
from math import inf
from typing import TYPE_CHECKING, Any

from rtamt.cli.command import json_number, stamp_text
from rtamt.cli.json_lines import STDIN
from rtamt.cli.live_view import format_time
from rtamt.cli.terminal import say
from rtamt.errors import StlError, TraceError
from rtamt.language.value_types import BOOLEAN, value_text
from rtamt.lazy.modules import np
from rtamt.signals.outcomes import Interval, VerdictRun
from rtamt.verdicts.early.at_start import SAFE
from rtamt.verdicts.early.discrete import DiscreteEarlyMonitor
from rtamt.verdicts.early.member_bounds import MemberIntervalMonitor

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.cli.live_view import Live
    from rtamt.language.value_types import ValueType
    from rtamt.signals.coding import Types
    from rtamt.signals.outcomes import Causation, Cause, Change, Verdict
    from rtamt.verdicts.early.at_start import StartMonitor
    from rtamt.verdicts.early.causation import CausationMonitor
    from rtamt.verdicts.early.dense_eager import DenseEagerMonitor
    from rtamt.verdicts.early.discrete_eager import EagerMonitor
    from rtamt.verdicts.early.interval import IntervalMonitor
    from rtamt.verdicts.early.monitor import EarlyMonitor

_DISCRETE = DiscreteEarlyMonitor, MemberIntervalMonitor


class EagerFeed:
    """Prints each verdict once it is settled; ``explain``: with the samples that decided it, of these types."""

    def __init__(
        self, monitor: EagerMonitor | DenseEagerMonitor, types: Types, *, explain: bool = False
    ) -> None:
        self.monitor = monitor
        self._types = types
        self._explain = explain

    def take(self, timestamp: Any, values: dict[str, float], line: int) -> str:
        """Take a sample and print what it settles; return what is wrong with it, if anything is."""
        try:
            self._print(self.monitor.update(_time(self.monitor, timestamp), **values))
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
            causes = self._causes(verdict) if self._explain else ""
            say(f'{{"time": {time}, "satisfied": {satisfied}, "decided_at": {decided}{causes}}}', flush=True)

    def _causes(self, verdict: Any) -> str:
        """Return a member of a JSON object."""
        causes = (
            f'{{"variable": {json.dumps(each.variable)}, "time": {_json(each.time)}, '
            f'"value": {self._value(each)}}}'
            for each in self.monitor.explain(verdict)
        )
        return f', "causes": [{", ".join(causes)}]'

    def _value(self, cause: Cause) -> str:
        """Return a value as input may have it: the name of a member, true or false, or a number."""
        type_ = self._types.get(cause.variable)
        if isinstance(cause.value, tuple):
            return f"[{', '.join(_written(end, type_) for end in cause.value)}]"
        return _written(cause.value, type_)


class StartFeed:
    """Prints bounds and verdict at the start of the trace whenever they change.

    On a terminal the live view replaces the lines; into a pipe or a file, both are written.
    """

    def __init__(self, start: StartMonitor, live: Live | None = None, *, late: bool = False) -> None:
        self._late = late
        self.start = start
        self._live = live
        self.monitor = start.bounds
        self._last: tuple[Interval, str] | None = None

    def take(self, timestamp: Any, values: dict[str, float], line: int) -> str:
        """Take a sample and print what it changes; return what is wrong with it, if anything is."""
        try:
            time = _time(self.monitor, timestamp, late=self._late)
            self.start.update(time, **values)
        except StlError as error:
            return f"{STDIN}, line {line}: {error}"
        now = self.start.interval(), self._status()
        if now != self._last:
            self._last = now
            self._say(f'{{"time": {_json(time)}, {self._members(*now)}}}')
        if self._live is not None:
            self._live.bounds(*now, self.start.satisfied)
        return ""

    def finish(self) -> None:
        """End the trace; print what is known at its end."""
        self.start.finish()
        now = self.start.interval(), self._status()
        self._say(f'{{{self._members(*now)}, "final": true}}')
        if self._live is not None:
            self._live.bounds(*now, self.start.satisfied)

    def _say(self, line: str) -> None:
        if self._live is None or not sys.stdout.isatty():
            say(line, flush=True)

    def _members(self, interval: Interval, status: str) -> str:
        return f'{_ends(interval)}, "status": {json.dumps(status)}'

    def _status(self) -> str:
        """Return the state of the verdict, and since when."""
        status, since = self.start.status, self.start.decided_at
        if since is None or status == SAFE:
            return status
        unit = "" if isinstance(since, np.datetime64) else " s"
        return f"{status} since {stamp_text(since)}{unit}"


class IntervalFeed:
    """Prints the bounds of every instant whenever they change; the live view is that of :class:`StartFeed`."""

    def __init__(
        self,
        monitor: IntervalMonitor | MemberIntervalMonitor,
        live: Live | None = None,
        *,
        late: bool = False,
    ) -> None:
        self._late = late
        self.monitor = monitor
        self._live = live
        #: The bounds at the drawn samples, in the order of arrival.
        self._known: dict[Any, Interval] = {}

    def take(self, timestamp: Any, values: dict[str, float], line: int) -> str:
        """Take a sample and print what it changes; return what is wrong with it, if anything is."""
        try:
            time = _time(self.monitor, timestamp, late=self._late)
            self.monitor.update(time, **values)
        except StlError as error:
            return f"{STDIN}, line {line}: {error}"
        self._print(self.monitor.changes(), time)
        return ""

    def finish(self) -> None:
        """End the trace; print what was still open."""
        self._print(self.monitor.finish())

    def _print(self, changes: list[Change], now: Any = None) -> None:
        if self._live is not None:
            self._draw(self._live, changes, now)
            if sys.stdout.isatty():
                return
        for change in changes:
            until = f', "until": {_json(change.end)}' if change.end != change.begin else ""
            retracted = ', "retracted": true' if change.retracted else ""
            say(
                f'{{"time": {_json(change.begin)}{until}, {_ends(change.interval)}, '
                f'"final": {json.dumps(change.final)}{retracted}}}',
                flush=True,
            )

    def _draw(self, live: Live, changes: list[Change], now: Any) -> None:
        """Draw the bounds at the latest samples, which become points as the trace continues."""
        if now is not None:
            self._known[now] = Interval(-inf, inf)
            if len(self._known) > live.MOST:
                del self._known[next(iter(self._known))]
        discrete = isinstance(self.monitor, _DISCRETE)
        for change in changes:
            for time in self._known:
                if change.begin <= time < change.end or (discrete and time == change.end):
                    self._known[time] = change.interval
        if self._known:
            time, last = next(reversed(self._known.items()))
            satisfied = True if last.lower > 0 else False if last.upper < 0 else None
            live.instants(list(self._known.values()), f"at {format_time(time)}", satisfied)


class CausationFeed:
    """Prints the causation of each sample at the start of the trace."""

    def __init__(self, monitor: CausationMonitor) -> None:
        self.monitor = monitor

    def take(self, timestamp: Any, values: dict[str, float], line: int) -> str:
        """Take a sample and print what it causes; return what is wrong with it, if anything is."""
        try:
            time = _time(self.monitor, timestamp)
            caused = self.monitor.update(time, **values)
        except StlError as error:
            return f"{STDIN}, line {line}: {error}"
        say(f'{{"time": {_json(time)}, {_caused(caused)}}}', flush=True)
        return ""

    def finish(self) -> None:
        """End the trace, in dense time with what that causes: variables hold their last values."""
        caused = self.monitor.finish()
        if caused is not None:
            say(f'{{{_caused(caused)}, "final": true}}', flush=True)


def _time(monitor: EarlyMonitor | MemberIntervalMonitor, timestamp: Any, *, late: bool = False) -> Any:
    """Return the time of a sample; without timestamps, samples are one period apart, and none is ``late``."""
    if timestamp is not None:
        return timestamp
    if late:
        raise TraceError(
            "a sample that may be late needs its time: name the column of timestamps, or leave out --lateness and "
            "--on-correction"
        )
    if not isinstance(monitor, _DISCRETE):
        raise TraceError("in dense time every sample needs its time")
    return monitor.samples * float(monitor.period)


def _written(value: float, type_: ValueType | None) -> str:
    text = value_text(value, type_)
    if text is None:
        return json.dumps(json_number(value))
    return text if type_ is BOOLEAN else json.dumps(text)


def _json(time: Any) -> str:
    return f'"{stamp_text(time)}"' if isinstance(time, np.datetime64) else stamp_text(time)


def _caused(caused: Causation) -> str:
    """Return causation as members of a JSON object."""
    violation, satisfaction = map(json_number, (caused.violation, caused.satisfaction))
    return f'"violation": {json.dumps(violation)}, "satisfaction": {json.dumps(satisfaction)}'


def _ends(interval: Interval) -> str:
    """Return the bounds as members of a JSON object."""
    lower, upper = json.dumps(json_number(interval.lower)), json.dumps(json_number(interval.upper))
    return f'"lower": {lower}, "upper": {upper}'
