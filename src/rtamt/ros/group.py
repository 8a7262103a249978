"""Outputs that are monitored together: their numbers, sampled in discrete time, and their records."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque
from typing import TYPE_CHECKING, TypeAlias

from rtamt.language.contents import variables
from rtamt.language.units.durations import NANOSECOND
from rtamt.lazy.tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Container, Mapping, Sequence
    from fractions import Fraction

    from rtamt.ros.binding import Output
    from rtamt.ros.early_group import Bounds, EarlyStanding
    from rtamt.ros.output_group import Standing


class Robustness(NamedTuple):
    """The robustness of an output's pastified formula at ``stamp`` (nanoseconds)."""

    output: Output
    stamp: int
    value: float


class Verdict(NamedTuple):
    """Whether an output's formula held at ``stamp - horizon``.

    ``stamp``: nanoseconds. ``horizon``: seconds. ``satisfied`` is None while that instant lies before
    the first sample.
    """

    output: Output
    stamp: int
    horizon: float
    satisfied: bool | None


#: The number of messages kept while another topic is silent.
HELD = 1000

Record: TypeAlias = "Robustness | Verdict | Bounds"


class Group(ABC):
    """Outputs that read the same numbers, in either time domain.

    ``outputs``: as grouped by :func:`group_outputs`. ``topic_of``: from the name of a number to its topic.
    """

    standings: tuple[Standing, ...] | tuple[EarlyStanding, ...]

    def __init__(self, outputs: Sequence[Output], topic_of: Mapping[str, str]) -> None:
        self.names = variables(outputs[0].specification.formula)
        self.topics = frozenset(topic_of[name] for name in self.names)
        #: Why the last sample was rejected.
        self.fault: str | None = None

    @property
    @abstractmethod
    def samples(self) -> int:
        """The number of samples (in dense time, of numbers) since the beginning or the last reset."""

    @abstractmethod
    def take(
        self, stamp: int, values: Mapping[str, float], wanted: Container[str] | None = None
    ) -> list[Record]:
        """Take numbers of one instant, return records for the topics that are wanted (None: all).

        Raises :class:`StlError` if they cannot be used.
        """

    @abstractmethod
    def refresh(self) -> None:
        """Bring the standings up to date."""

    @abstractmethod
    def drop(self, topic: str) -> None:
        """Restart when a stale topic resumes."""

    @abstractmethod
    def forget(self) -> None:
        """Return to the state before the first message."""

    @abstractmethod
    def reset(self) -> None:
        """Forget all samples."""


class MessageGroup(Group):
    """Every message is a sample at the time in its header, each topic on its own time base."""

    def __init__(self, outputs: Sequence[Output], topic_of: Mapping[str, str]) -> None:
        super().__init__(outputs, topic_of)
        self._held: deque[tuple[int, dict[str, float]]] = deque(maxlen=HELD)

    def hold(self, stamp: int, values: Mapping[str, float]) -> None:
        """Keep the latest messages until every topic has one, which starts the trace."""
        self._held.append((stamp, self._mine(values)))

    def _mine(self, values: Mapping[str, float]) -> dict[str, float]:
        return {name: values[name] for name in self.names if name in values}

    def drop(self, topic: str) -> None:  # noqa: ARG002 - in dense time messages are samples
        """Restart when a stale topic resumes."""
        self.reset()

    def forget(self) -> None:
        """Return to the state before the first message."""
        self.reset()


class SampledGroup(Group):
    """Samples one period apart, each with the latest message of every topic at its instant.

    The first sample is at the first message of the topic that starts last; ``due`` is the instant of the
    next sample, None before the first. Messages wait until the sample at their instant has been taken, so that
    no sample uses a newer message, as ``Trace.resample`` does for a bag.
    """

    def __init__(self, outputs: Sequence[Output], topic_of: Mapping[str, str], period: Fraction) -> None:
        super().__init__(outputs, topic_of)
        self._step = int(period / NANOSECOND)
        self.due: int | None = None
        self._channels = {topic: _Channel() for topic in self.topics}
        self._earliest = 0  # no sample is earlier

    def hold(self, topic: str, instant: int, values: Mapping[str, float]) -> None:
        """Keep a message until the sample at its instant is due."""
        mine = {name: values[name] for name in self.names if name in values}
        self._channels[topic].hold(instant, mine)
        if self.due is None:
            self._begin()

    def _begin(self) -> None:
        firsts = [channel.first for channel in self._channels.values()]
        known = [first for first in firsts if first is not None]
        if len(known) == len(firsts):
            self.due = max(*known, self._earliest)
            return
        for channel in self._channels.values():
            channel.trim()

    def complete(self) -> int | None:
        """Return the instant up to which every topic has messages; None before that."""
        latest = [channel.latest for channel in self._channels.values()]
        known = [instant for instant in latest if instant is not None]
        return min(known) if len(known) == len(latest) else None

    def sample(self, until: int) -> tuple[int, Mapping[str, float]] | None:
        """Return the instant and the values of the next sample; None if it is later than ``until``."""
        if self.due is None or self.due > until:
            return None
        due, self.due = self.due, self.due + self._step
        values: dict[str, float] = {}
        for channel in self._channels.values():
            values |= channel.at(due)
        return due, values

    def drop(self, topic: str) -> None:
        """Restart when a stale topic resumes, since its old messages are no current values."""
        self._channels[topic] = _Channel()
        self._earliest = self.due or self._earliest
        self.due = None
        self.reset()

    def leap(self, now: int) -> None:
        """Restart at ``now``, with the existing messages."""
        self._earliest, self.due = now, None
        self.reset()
        self._begin()

    def clock_begins(self, now: int) -> None:
        """Treat messages before the simulated clock was set as arriving ``now``."""
        if self.due:  # samples were taken at 0, so that it was a valid instant
            return
        for channel in self._channels.values():
            channel.move(now)
        self.leap(now)

    def forget(self) -> None:
        """Return to the state before the first message."""
        self._channels = {topic: _Channel() for topic in self.topics}
        self._earliest, self.due = 0, None
        self.reset()


class _Channel:
    """The messages of a topic for one group: the current one, and those that wait for their sample."""

    __slots__ = ("_held", "_since", "_waiting", "latest")

    def __init__(self) -> None:
        self._since: int | None = None
        self._held: Mapping[str, float] = {}
        self._waiting: deque[tuple[int, Mapping[str, float]]] = deque()
        #: The time of the last message.
        self.latest: int | None = None

    @property
    def first(self) -> int | None:
        """The earliest instant with a value."""
        return self._waiting[0][0] if self._since is None and self._waiting else self._since

    def hold(self, instant: int, values: Mapping[str, float]) -> None:
        """Keep a message; times never decrease, even if timestamps and arrivals are mixed."""
        self.latest = instant if self.latest is None else max(self.latest, instant)
        self._waiting.append((self.latest, values))

    def at(self, instant: int) -> Mapping[str, float]:
        """Return the value at an instant; instants must increase from call to call."""
        while self._waiting and self._waiting[0][0] <= instant:
            self._since, self._held = self._waiting.popleft()
        return self._held

    def trim(self) -> None:
        """Drop the oldest messages above a limit while another topic is silent."""
        while len(self._waiting) > HELD:
            self._since, self._held = self._waiting.popleft()

    def move(self, now: int) -> None:
        """Treat all messages as arriving ``now``."""
        while self._waiting:
            self._since, self._held = self._waiting.popleft()
        if self._since is not None:
            self._since = self.latest = now
