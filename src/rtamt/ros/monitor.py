"""The monitor of a node: messages and ticks in; robustness, verdicts and conditions out. It does not need ROS."""

from __future__ import annotations

from fractions import Fraction
from math import isnan
from typing import TYPE_CHECKING, Any

from rtamt.errors import StlError, UsageError
from rtamt.language.units.durations import NANOSECOND, duration, positive_period
from rtamt.ros.diagnostics import Condition, Level, Notice, begins_anew, seconds_text
from rtamt.ros.early_group import Bounds
from rtamt.ros.fields import reader, stamp_of
from rtamt.ros.group import MessageGroup, Robustness, SampledGroup, Verdict
from rtamt.signals.time_domains import DEFAULT, time_domain

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Mapping, Sequence

    from rtamt.language.units.durations import Duration
    from rtamt.ros.binding import Binding, Output
    from rtamt.ros.early_group import EarlyStanding
    from rtamt.ros.group import Group, Record
    from rtamt.ros.output_group import Standing

#: The default number of silent periods after which a topic is stale; in dense time, seconds.
STALE_PERIODS = 10
STALE_DENSE = Fraction(5)
#: The largest number of missed periods that is caught up, unless a topic becomes stale first.
CATCH_UP = 10_000
#: How far a timestamp may be ahead of the clock in nanoseconds; also the least distance allowed behind it.
SKEW = 10**9
#: The longest pause between two reads of the clock in seconds; bounds the delay until silence is noticed.
PAUSE = 0.1
_NO_CLOCK = "simulated time has not begun: no node publishes /clock"


class RosMonitor:
    """Monitors the requirements of a specification over messages.

    ``binding``: from :func:`~rtamt.ros.binding.bind`. ``time``: ``"discrete"``, where the latest message
    of each topic is sampled every ``period`` (seconds, or text such as ``"100ms"``), or ``"dense"``, where
    every message is a sample, each topic on its own time base. ``stale``: the time without a message after
    which a topic is stale; 0 for never, by default ten periods, in dense time 5 s. ``skip_nan``: whether messages
    with NaN in what is read of them are ignored. All times are integer nanoseconds; 0 means a simulated clock that is
    not set yet.

    The time of a message is the timestamp in its header, or else its arrival. In discrete time, the first sample
    is taken when the last of an output's topics has its first message. A sample is taken as
    soon as every topic has a message at its instant or later, and at the latest when :meth:`tick` reaches it;
    a message that is delivered later is part of the next sample. If every message is delivered, and
    :meth:`tick` is not called before the messages up to that instant are delivered, the results equal those
    of ``rtamt check --period`` on a bag with these messages.

    Bounded future is pastified (the paper's Definition 4): robustness is reported from the first sample on
    and refers to the instant one horizon ago; verdicts are unknown until the horizon has passed. Of outputs that are
    bound early, such as those of unbounded future, bounds and verdict at the start of the trace are reported with
    every sample (:class:`Bounds`).

    Samples are never invented. An output is silent until each of its topics has had
    a message, and while one is stale. It restarts when timestamps go back, when a stale topic resumes,
    after an invalid number, and when the clock jumps by more than the stale time or, in discrete
    time, :data:`CATCH_UP` periods; each event is reported once, by :meth:`notices`.

    >>> from types import SimpleNamespace as Message
    >>> import rtamt
    >>> from rtamt.ros import RosMonitor, bind
    >>> monitor = RosMonitor(bind(rtamt.parse('''
    ...     from rtamt_msgs.msg import FloatStamped
    ...     input FloatStamped req  output FloatStamped rob
    ...     rob.value = once[0:1](req.value >= 3)''')), period=1)
    >>> monitor.tick(0)
    []
    >>> robustness, verdict = monitor.message("rtamt/req", Message(value=5.0), 500_000_000)
    >>> robustness.stamp, robustness.value, verdict.satisfied
    (500000000, 2.0, True)
    >>> [record.stamp for record in monitor.tick(2_000_000_000)]
    [1500000000, 1500000000]
    """

    def __init__(
        self,
        binding: Binding,
        *,
        period: Duration | None = None,
        time: str = DEFAULT,
        stale: Duration | None = None,
        skip_nan: bool = False,
    ) -> None:
        self.binding = binding
        self._skip_nan = skip_nan
        self._domain = time_domain(time)
        self.time = self._domain.name
        self.period = self._period(period)
        self._stale = self._stale_after(stale)
        # The largest step of the clock between two reads; 0 for any step.
        self._leap = self._stale
        if self.period is not None:
            most = int(self.period * 10**9) * CATCH_UP
            self._leap = min(self._stale or most, most)
        self._readers: dict[str, list[tuple[str, Callable[[Any], float]]]] = {}
        for known in binding.inputs:
            self._readers.setdefault(known.topic, []).extend(
                (name, reader(name, binding.value_types.get(name))) for name in known.fields
            )
        topic_of = {name: known.topic for known in binding.inputs for name in known.fields}
        #: The outputs, grouped by the numbers that they read.
        self.groups = self._groups(binding.outputs, topic_of)
        self._by_message = [group for group in self.groups if isinstance(group, MessageGroup)]
        self._sampled = [group for group in self.groups if isinstance(group, SampledGroup)]
        #: Topics for which records are created, such as those with subscribers; None: all.
        self.wanted: Container[str] | None = None
        self._values: dict[str, float] = {}
        self._heard: dict[str, int] = {}  # the arrival of a topic's last message
        self._timestamps: dict[str, int] = {}  # the timestamp of its last message
        self._last: int | None = None  # the latest tick or arrival
        self._silent: set[str] = set()
        self._notices: list[Notice] = []
        self._faults: dict[str, str] = {}  # topics whose last message was unusable, and why
        self._repeated: set[str] = set()  # topics whose last message repeated a timestamp
        self._foreign: set[str] = set()  # topics whose timestamps are from another clock
        self._compared: set[MessageGroup] = set()  # groups whose topics have been checked for a common clock
        self._timeless = False  # whether messages before the simulated clock is set have been reported

    def _groups(self, outputs: Sequence[Output], topic_of: Mapping[str, str]) -> Sequence[Group]:
        make = self._domain.part("ros_groups")
        if make is None:
            raise UsageError(f"nodes do not monitor in {self.time} time; choose discrete or dense time")
        # Timestamps are nanoseconds, and so are ticks.
        groups: Sequence[Group] = make(
            outputs, topic_of, type(self._domain).of(self.period, self._domain.tolerance, NANOSECOND)
        )
        return groups

    def _period(self, period: Duration | None) -> Fraction | None:
        """Return seconds; None in dense time."""
        if not self._domain.sampled:
            if period is not None:
                raise UsageError(
                    "dense time has no sampling period: leave out the period, or choose discrete time"
                )
            return None
        if period is None:
            raise UsageError(
                "discrete time samples the topics once a period: give the period, such as 100ms, or "
                "choose dense time, which reads every message at its own time"
            )
        exact = positive_period(period)
        if (exact * 10**9).denominator != 1:
            raise UsageError(f"the period {exact} s is no whole number of nanoseconds")
        return exact

    def _stale_after(self, stale: Duration | None) -> int:
        """Return nanoseconds; 0 for never."""
        if stale is None:
            return int((STALE_DENSE if self.period is None else self.period * STALE_PERIODS) * 10**9)
        exact = duration(stale)
        if exact < 0:
            raise UsageError(f"a topic cannot be stale after {stale!r}; give a time, or 0 for never")
        return int(exact * 10**9)

    # ---- inputs ----------------------------------------------------------------------------------

    def message(self, topic: str, message: Any, now: int) -> list[Record]:
        """Take a message that arrived at ``now``; return the new records."""
        self._advance(now)
        records = self._look_for_silence(now)
        if now == 0 and not self._timeless:
            self._timeless = True
            self._log(Level.WARN, _NO_CLOCK)
        try:
            values = {name: read(message) for name, read in self._readers[topic]}
        except StlError as error:
            self._reject(topic, str(error))
            return records
        if self._skip_nan and any(map(isnan, values.values())):
            return records
        stamp = stamp_of(message) or now
        last = self._timestamps.get(topic)
        # Before the simulated clock is set, messages without a timestamp are ordered by arrival only.
        if last is not None and stamp <= last and (stamp or self._by_message):
            if stamp == last:
                self._repeat(topic)
                return records
            self._begin_anew(f"the timestamps on {topic} went back by {seconds_text(last - stamp)}")
        self._note_arrival(topic, now)
        self._timestamps[topic] = stamp
        self._faults.pop(topic, None)
        self._repeated.discard(topic)
        self._values.update(values)
        for group in self._by_message:
            if topic not in group.topics:
                continue
            if self._all_arrive(group):
                self._compare_clocks(group)
                records += self._feed(group, stamp, values)
            else:
                group.hold(stamp, values)
        for sampled in self._sampled:
            if topic in sampled.topics:
                instant = now if self._is_foreign(topic, stamp, now) else stamp
                sampled.hold(topic, instant, values)
                if now and (complete := sampled.complete()) is not None:
                    records += self._sample(sampled, complete)
        return records

    def tick(self, now: int) -> list[Record]:
        """Advance the clock: take the samples due by ``now`` (discrete time), and detect silent topics.

        Missed ticks are caught up: every period has its sample. Returns the new records.
        """
        self._advance(now)
        records = self._look_for_silence(now)
        for group in self._sampled:
            records += self._sample(group, now)
        return records

    def _sample(self, group: SampledGroup, until: int) -> list[Record]:
        """Take the samples due up to an instant, unless a topic is silent."""
        records: list[Record] = []
        if self._all_arrive(group):
            while (sample := group.sample(until)) is not None:
                records += self._feed(group, *sample)
        return records

    def _is_foreign(self, topic: str, stamp: int, now: int) -> bool:
        """Return whether a timestamp is from another clock, such as that of a bag played without its clock.

        The time of such a message is its arrival, which is reported once.
        """
        foreign = now != 0 and not -max(self._leap, SKEW) <= stamp - now <= SKEW
        if foreign and topic not in self._foreign:
            self._foreign.add(topic)
            apart = f"{seconds_text(abs(stamp - now))} {'behind' if stamp < now else 'ahead of'}"
            self._log(
                Level.WARN,
                f"the timestamps on {topic} are {apart} the clock: its messages are sampled as of their arrival",
            )
        return foreign

    def _compare_clocks(self, group: MessageGroup) -> None:
        """Report topics whose timestamps are far behind those of others: nothing later is known of the output."""
        if group in self._compared or not all(self._heard[topic] for topic in group.topics):
            return
        self._compared.add(group)
        ahead = {topic: self._timestamps[topic] - self._heard[topic] for topic in sorted(group.topics)}
        last, first = min(ahead, key=ahead.__getitem__), max(ahead, key=ahead.__getitem__)
        apart = ahead[first] - ahead[last]
        if apart > max(self._leap, SKEW):
            self._log(
                Level.WARN,
                f"the timestamps on {last} are {seconds_text(apart)} behind those on {first}: dense time knows nothing "
                f"after them; use one clock for both, or discrete time",
            )

    def pause(self, now: int) -> float:
        """Return how many seconds a node may sleep before it calls :meth:`tick`, at most :data:`PAUSE`."""
        due = [group.due for group in self._sampled if group.due is not None and self._all_arrive(group)]
        return min(PAUSE, max(0.0, (min(due) - now) / 1e9)) if due else PAUSE

    def _all_arrive(self, group: Group) -> bool:
        return group.topics <= self._heard.keys() and not group.topics & self._silent

    def _feed(self, group: Group, stamp: int, values: Mapping[str, float]) -> list[Record]:
        """Feed a sample to a group; a rejected sample leaves a gap, so that the group restarts."""
        try:
            records = group.take(stamp, values, self.wanted)
        except StlError as error:
            group.reset()
            if group.fault is None:
                self._log(Level.ERROR, f"{begins_anew(group)} samples cannot be used: {error}")
            group.fault = str(error)
            return []
        group.fault = None
        return records

    # ---- errors ----------------------------------------------------------------------------------

    def _advance(self, now: int) -> None:
        if self._last is not None and now < self._last:
            self._begin_anew(f"the clock went back by {seconds_text(self._last - now)}")
        elif self._last == 0 and now:  # the clock starts: earlier messages arrive now, and are not stale
            self._heard = dict.fromkeys(self._heard, now)
            for group in self._sampled:
                group.clock_begins(now)
        elif self._last is not None and self._leap and now - self._last > self._leap:
            self._skip_ahead(now, now - self._last)
        self._last = now

    def _skip_ahead(self, now: int, by: int) -> None:
        """Handle a jump of the clock: samples of the time between would be invented, and might be endless."""
        for topic in [
            topic for topic, heard in self._heard.items() if self._stale and now - heard > self._stale
        ]:
            self._forget(topic)
            self._timestamps.pop(topic, None)
            self._silent.discard(topic)
        for group in self._sampled:
            group.leap(now)
        self._log(
            Level.WARN, f"the clock went forward by {seconds_text(by)} at once: all monitors begin anew"
        )

    def _begin_anew(self, why: str) -> None:
        for group in self.groups:
            group.forget()
        self._values.clear()
        self._heard.clear()
        self._timestamps.clear()
        self._silent.clear()
        self._log(Level.WARN, f"{why}: all monitors begin anew")

    def _reject(self, topic: str, problem: str) -> None:
        """Handle a message without a valid number: the previous value is no longer current."""
        if topic not in self._faults:
            self._log(Level.ERROR, f"a message on {topic} cannot be used: {problem}")
        self._faults[topic] = problem
        self._forget(topic)

    def _repeat(self, topic: str) -> None:
        """Handle a repeated timestamp: a signal has one value at an instant, the first."""
        if topic not in self._repeated:
            self._log(Level.WARN, f"messages on {topic} with the stamp of the one before them are left out")
        self._repeated.add(topic)

    def _forget(self, topic: str) -> None:
        self._heard.pop(topic, None)
        for group in self.groups:
            if topic in group.topics:
                group.drop(topic)

    def _look_for_silence(self, now: int) -> list[Record]:
        """Find the topics that have become stale; return the records due before that."""
        records: list[Record] = []
        if not self._stale:
            return records
        stale = {
            topic
            for topic, heard in self._heard.items()
            if topic not in self._silent and now - heard > self._stale
        }
        for sampled in self._sampled:
            if stale & sampled.topics and self._all_arrive(sampled):
                records += self._sample(
                    sampled, min(self._heard[topic] for topic in sampled.topics) + self._stale
                )
        for topic in stale:
            self._silent.add(topic)
            self._log(
                Level.WARN, f"{topic} is stale: no message for {seconds_text(now - self._heard[topic])}"
            )
            for group in self.groups:
                if topic in group.topics:
                    group.drop(topic)
        return records

    def _note_arrival(self, topic: str, now: int) -> None:
        if topic in self._silent:
            self._silent.discard(topic)
            self._log(Level.OK, f"{topic} has messages again: the monitors that read it begin anew")
        self._heard[topic] = now

    def _log(self, level: Level, message: str) -> None:
        self._notices.append(Notice(level, message))

    # ---- notices and conditions ---------------------------------------------------------------------

    def note(self, message: str) -> None:
        """Add a warning to the notices."""
        self._log(Level.WARN, message)

    def notices(self) -> list[Notice]:
        """Return the events since the last call; each is reported once."""
        said, self._notices = self._notices, []
        return said

    def conditions(self, now: int) -> list[Condition]:
        """Return the condition of every output, for ``/diagnostics``."""
        for group in self.groups:
            group.refresh()
        conditions = {
            standing.output.name: self._condition(group, standing, now)
            for group in self.groups
            for standing in group.standings
        }
        return [conditions[output.name] for output in self.binding.outputs]

    def _condition(self, group: Group, standing: Standing | EarlyStanding, now: int) -> Condition:
        output = standing.output
        inputs = ((name, self._values[name]) for name in group.names if name in self._values)
        values = (
            *((name, f"{value:.6g}") for name, value in inputs),
            ("topic", output.topic),
            ("samples", str(group.samples)),
            *standing.facts,
        )
        missing = sorted(topic for topic in group.topics if topic not in self._heard)
        faulty = [self._faults[topic] for topic in missing if topic in self._faults]
        silent = sorted(group.topics & self._silent)
        if group.fault is not None or faulty:
            level, text = Level.ERROR, group.fault or faulty[0]
        elif silent:
            ages = [f"{topic} for {seconds_text(now - self._heard[topic])}" for topic in silent]
            level, text = Level.STALE, f"no message on {', '.join(ages)}"
        elif now == 0 and self._heard and standing.satisfied is not False:
            level, text = Level.WARN, _NO_CLOCK
        elif missing:
            level, text = Level.WARN, f"waiting for the first message on {', '.join(missing)}"
        elif standing.satisfied is False:
            level, text = Level.ERROR, standing.text
        else:
            level, text = Level.OK, standing.text
        return Condition(f"{self.binding.name}: {output.name}", level, text, values)


__all__ = ["Bounds", "Robustness", "RosMonitor", "Verdict"]
