"""The samples of a dense stream, cut at the instants up to which all are known."""

from __future__ import annotations

from copy import copy
from typing import TYPE_CHECKING

from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.signals.sampling_period import merged

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.dense_arrays import Samples
    from rtamt.signals.ticks import TickArray


class Steps(NamedTuple):
    """A part of a step function: its points, the last at the end of the part, and its value before the first."""

    ticks: TickArray
    values: FloatArray
    before: float

    def at(self, ticks: TickArray) -> FloatArray:
        """Return the values at some ticks of the part."""
        return np.concatenate(((self.before,), self.values))[self.ticks.searchsorted(ticks, "right")]

    def since(self, begin: int) -> Steps:
        """Return the part from a tick on, with a point there."""
        later = int(self.ticks.searchsorted(begin, "right"))
        here = self.values[later - 1] if later else self.before
        ticks, values = np.append(begin, self.ticks[later:]), np.append(here, self.values[later:])
        return Steps(ticks, values, self.before)


def constant(value: float, end: int) -> Steps:
    """Return a part without changes.

    >>> constant(2.0, 7)
    Steps(ticks=array([7]), values=array([2.]), before=2.0)
    """
    return Steps(np.array([end]), np.array([value]), value)


class Member(NamedTuple):
    """A member in a part of a stream: 1 where it is present, else 0, and its fields, which are fillers elsewhere."""

    channel: Steps
    fields: Mapping[str, Steps]


def member_of(parts: Mapping[str, Steps], fillers: Mapping[str, float]) -> Member:
    """Return a member; its fields are NaN where they have no sample."""
    ticks = merged([part.ticks for part in parts.values()])
    columns = {field: part.at(ticks) for field, part in parts.items()}
    present = ~np.isnan(np.array(list(columns.values()))).any(axis=0)
    here = not any(np.isnan(part.before) for part in parts.values())
    fields = {
        field: Steps(
            ticks, np.where(present, column, fillers[field]), parts[field].before if here else fillers[field]
        )
        for field, column in columns.items()
    }
    return Member(Steps(ticks, present.astype(float), float(here)), fields)


class Inputs:
    """The samples of variables and of members' fields, which are NaN where they end the presence of a member.

    ``names``: the variables that start the trace, and move the instant up to which samples are known. Without any, the
    first sample of a member starts it, and the latest time of an update is that instant.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self.names = tuple(names)
        self.pending: dict[str, Samples] = {}
        #: The last value of each up to the frontier.
        self.held: dict[str, float] = {}
        self.first: dict[str, int] = {}
        self.last: dict[str, int] = {}
        self.counts: dict[str, int] = {}
        #: What has had a number, not only the end of a presence.
        self.valued: set[str] = set()
        self.samples = 0
        #: Up to when samples were cut off, and the latest time of an update.
        self.frontier: int | None = None
        self.now: int | None = None

    def copied(self) -> Inputs:
        """Return a copy that is independent."""
        twin = copy(self)
        for name in ("pending", "held", "first", "last", "counts"):
            setattr(twin, name, dict(getattr(self, name)))
        twin.valued = set(self.valued)
        return twin

    def take(self, chunk: Mapping[str, Samples], now: int | None) -> None:
        """Take samples that are later than those of the same name before."""
        for name, (ticks, values) in chunk.items():
            waiting = self.pending.get(name, (ticks[:0], values[:0]))
            self.pending[name] = np.concatenate((waiting[0], ticks)), np.concatenate((waiting[1], values))
            self.first.setdefault(name, int(ticks[0]))
            self.last[name] = int(ticks[-1])
            if name not in self.valued and not np.isnan(values).all():
                self.valued.add(name)
            self.counts[name] = self.counts.get(name, 0) + len(ticks)
            self.samples += len(ticks)
            now = self.last[name] if now is None else max(now, self.last[name])
        if now is not None:
            self.now = now if self.now is None else max(self.now, now)

    @property
    def start(self) -> int | None:
        """The start of the trace; None before it."""
        if not self.names:
            return min(self.first.values(), default=None)
        known = all(name in self.first for name in self.names)
        return max(self.first[name] for name in self.names) if known else None

    @property
    def known(self) -> int | None:
        """The instant up to which all samples are known; None before the start of the trace."""
        start = self.start if self.frontier is None else self.frontier
        if start is None:
            return None
        end = min((self.last[name] for name in self.names), default=self.now)
        return end if end is not None and end >= start else None

    @property
    def end(self) -> int | None:
        """The end of the trace if no more samples arrive."""
        return max((self.last[name] for name in self.names), default=self.now)

    def cut(self, until: int) -> tuple[int | None, dict[str, Steps]]:
        """Cut off the part up to a tick; return it, and its first tick if the trace starts there."""
        begin = self.start if self.frontier is None else None
        parts = {}
        for name in [*self.held, *(each for each in self.pending if each not in self.held)]:
            ticks, values = self.pending.pop(name, (np.empty(0, np.int64), np.empty(0)))
            due = int(ticks.searchsorted(until, "right"))
            if due < len(ticks):
                self.pending[name] = ticks[due:], values[due:]
            if not due and name not in self.held:
                continue
            part = Steps(ticks[:due], values[:due], self.held.get(name, np.nan))
            if due and ticks[due - 1] == until:
                whole = part
            else:
                last = values[due - 1] if due else part.before
                whole = Steps(np.append(part.ticks, until), np.append(part.values, last), part.before)
            parts[name] = whole if begin is None else whole.since(begin)
            self.held[name] = float(whole.values[-1])
        self.frontier = until
        return begin, parts

    def lacking(self, fields: Collection[str]) -> str | None:
        """Return the first field of a member that never had a sample, while another one had a number."""
        if self.valued.isdisjoint(fields):
            return None
        return next((name for name in fields if name not in self.first), None)

    def forget(self, fields: Collection[str]) -> None:
        """Forget the fields of a member that is absent, unless it has later samples."""
        if all(np.isnan(self.held.get(name, np.nan)) and name not in self.pending for name in fields):
            for name in fields:
                for each in (self.held, self.first, self.last, self.counts):
                    each.pop(name, None)
                self.valued.discard(name)
