"""A node that is delivered every message gives what ``rtamt check`` finds in a bag with these messages."""

from __future__ import annotations

from bisect import bisect_right
from fractions import Fraction
from types import SimpleNamespace
from typing import NamedTuple

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.cli import main
from rtamt.cli.reading_options import Reading, on_time_base, read_for
from rtamt.ros import Robustness, RosMonitor, bind
from rtamt.ros.message_definitions import SATISFIED
from rtamt.verdicts.early.at_start import StartMonitor
from tests.unit.readers.bags import SECOND, Bag

pytest.importorskip("rosbags")

HEAD = """
from rtamt_msgs.msg import FloatStamped  from std_msgs.msg import Float64
input FloatStamped a  input FloatStamped b  input Float64 c
output FloatStamped rob  output FloatStamped other
@ topic(a, /a)  @ topic(b, /b)  @ topic(c, /c)  @ topic(rob, /rob)  @ topic(other, /other)
"""
#: Formulas over one, two and three topics, of the past and of a bounded future; {p}: a period.
PAST = (
    "historically(a.value >= b.value)",
    "once[0:{p}](a.value - c.data >= 1)",
    "a.value + b.value + c.data >= 1",
)
FUTURE = ("eventually[0:{p}](a.value > b.value)", "(a.value >= 1) until[0:{p}] (c.data >= b.value)")
PERIODS = (10**7, 10**8, SECOND, 123_456_789)
#: Near zero, a uptime, and the clock of today, also where a double has no nanoseconds any more.
ORIGINS = (SECOND, 86_400 * SECOND + 7, 1_700_000_000_123_456_789)


class Sent(NamedTuple):
    """A message: its instant, when it arrives (and is recorded), where, and the number in it."""

    at: int
    arrival: int
    topic: str
    value: float


@st.composite
def traffic(draw, period, latency=True):
    """Draw messages on three topics in the order of their arrival: bursts, gaps, jitter, equal timestamps.

    Those on /c have no header, so that they are of their arrival. ``latency``: whether the others arrive later.
    """
    gaps = st.sampled_from(
        [0, 1, period // 7, period // 2, period - 1, period, period + 1, 3 * period, 40 * period]
    )
    late = draw(st.integers(0, 3 * period)) if latency else 0
    sent = []
    for topic in draw(st.permutations(["/a", "/b", "/c"])):
        at = draw(st.sampled_from(ORIGINS[:1])) + draw(gaps)
        for gap in draw(st.lists(gaps, max_size=12)):
            value = float(draw(st.integers(-3, 3)))
            delay = 0 if topic == "/c" else draw(st.integers(0, late))
            sent.append(Sent(at, at + delay, topic, value))
            at += gap
        sent.append(Sent(at, at, topic, 0.5))
    origin = draw(st.sampled_from(ORIGINS))
    # A topic is delivered in order, whatever the network does to others.
    ordered, newest = [], {}
    for one in sorted(sent, key=lambda one: (one.topic, one.at)):
        newest[one.topic] = max(newest.get(one.topic, -1) + (one.topic != "/c"), one.arrival)
        ordered.append(one._replace(at=one.at + origin, arrival=newest[one.topic] + origin))
    return sorted(ordered, key=lambda one: one.arrival)


def header(at):
    return SimpleNamespace(stamp=SimpleNamespace(secs=at // SECOND, nsecs=at % SECOND))


def delivered(monitor, sent, looks=()):
    """Return the records of a node to which an injected transport carries messages; ``looks``: at the clock."""
    records, looks = [], sorted(looks)
    read = {known.topic for known in monitor.binding.inputs}
    for one in sent:
        if one.topic not in read:
            continue
        while looks and looks[0] < one.arrival:
            records += monitor.tick(looks.pop(0))
        message = SimpleNamespace(data=one.value)
        if one.topic != "/c":
            message = SimpleNamespace(header=header(one.at), value=one.value)
        records += monitor.message(one.topic, message, one.arrival)
    return records


def recorded(folder, sent):
    """Write the messages as a bag; return its path."""
    with Bag(folder, "mcap") as bag:
        for one in sent:
            if one.topic == "/c":
                bag.write(
                    one.topic,
                    "std_msgs/msg/Float64",
                    one.arrival,
                    bag.store.types["std_msgs/msg/Float64"](data=one.value),
                )
            else:
                kind = "rtamt_msgs/msg/FloatStamped"
                message = bag.store.types[kind](header=bag.header(one.at), value=one.value)
                bag.write(one.topic, kind, one.arrival, message)
    return bag.path


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """Return a maker of empty folders: a test of Hypothesis has one for all its examples."""
    return lambda: tmp_path_factory.mktemp("bag")


def checked(folder, text, sent, *options):
    """Return robustness and truth, by topic, as ``rtamt check -o out.mcap`` writes them: (stamp, value) pairs."""
    spec, out = folder / "spec.stl", folder / "out.mcap"
    spec.write_text(text, encoding="utf-8")
    bag = recorded(folder, sent)
    assert main(["check", "--quiet", *options, "-o", str(out), "--", str(spec), str(bag)]) in (0, 1)
    found = rtamt.read(out)

    def points(column):
        channel = found.channel(column)
        times = channel.times.tolist()  # nanoseconds, or seconds where these are exact
        timestamps = [
            time if isinstance(time, int) else round(Fraction(repr(time)) * 10**9) for time in times
        ]
        return list(zip(timestamps, channel.values.tolist(), strict=True))

    topics = [name.removesuffix(".value") for name in found.names if name in ("/rob.value", "/other.value")]
    return {
        topic: (
            points(f"{topic}.value"),
            [(t, v == SATISFIED) for t, v in points(f"{topic}/verdict.verdict")],
        )
        for topic in topics
    }


def values_on(records, topic):
    """Return robustness and truth of an output: (stamp, value) pairs."""
    mine = [record for record in records if record.output.topic == topic]
    numbers = [(r.stamp, r.value) for r in mine if isinstance(r, Robustness)]
    return numbers, [(r.stamp, r.satisfied) for r in mine if not isinstance(r, Robustness)]


@st.composite
def cases(draw):
    """Draw a period (ns), a specification with two outputs, messages, and whether each arrives at its instant."""
    period = draw(st.sampled_from(PERIODS))
    formulas = [draw(st.sampled_from(PAST + FUTURE)).format(p=f"{2 * period}ns") for _ in range(2)]
    text = f"{HEAD} rob.value = {formulas[0]}; other.value = {formulas[1]}"
    on_time = draw(st.booleans())
    return period, text, draw(traffic(period, latency=not on_time)), on_time


def outputs_of(monitor):
    """Return the outputs with their groups."""
    return [(group, standing) for group in monitor.groups for standing in group.standings]


@settings(max_examples=40)
@given(cases())
def test_a_node_in_discrete_time_gives_what_check_finds_in_a_bag_bit_for_bit(folders, case):
    period, text, sent, on_time = case
    monitor = RosMonitor(bind(rtamt.parse(text)), period=Fraction(period, 10**9), stale=0)
    # Where nothing is late the clock may be looked at whenever one likes.
    looks = [one.at + period // 3 for one in sent] if on_time else []
    records = delivered(monitor, sent, looks)
    records += monitor.tick(max(one.arrival for one in sent))
    found = checked(folders(), text, sent, "--period", f"{period}ns")
    assert len(found) == 2
    for group, standing in outputs_of(monitor):
        expected, truth = found[standing.topic]
        last = max(one.at for one in sent if one.topic in group.topics)
        numbers, verdicts = values_on([r for r in records if r.stamp <= last], standing.topic)
        assert [stamp for stamp, _ in numbers] == [stamp for stamp, _ in expected]
        known = max(0, len(expected) - standing.lag)
        assert [value for _, value in numbers[standing.lag :]] == [value for _, value in expected[:known]]
        assert [held for _, held in verdicts] == (
            [None] * (len(expected) - known) + [held for _, held in truth[:known]]
        )
    assert [notice.message for notice in monitor.notices() if "left out" not in notice.message] == []


def value_at(points, stamp):
    """Return the value of a step function."""
    return points[bisect_right(points, stamp, key=lambda point: point[0]) - 1][1]


@settings(max_examples=40)
@given(cases())
def test_a_node_in_dense_time_gives_what_check_finds_in_a_bag_bit_for_bit(folders, case):
    _, text, sent, _ = case
    monitor = RosMonitor(bind(rtamt.parse(text)), time="dense", stale=0)
    records = delivered(monitor, sent)
    found = checked(folders(), text, sent, "--time", "dense")
    assert len(found) == 2
    for group, standing in outputs_of(monitor):
        expected = found[standing.topic]
        ends = [max(one.at for one in sent if one.topic == topic) for topic in group.topics]
        for node, bag in zip(values_on(records, standing.topic), expected, strict=True):
            begin, end = bag[0][0] + standing.lag, min(ends)
            assert (not node and end < bag[0][0]) or node[-1][0] == end
            for stamp in {stamp for stamp, _ in node} | {stamp + standing.lag for stamp, _ in bag}:
                if begin <= stamp <= end:
                    assert value_at(node, stamp) == value_at(bag, stamp - standing.lag)


EARLY = (
    "always(a.value >= b.value)",
    "eventually(a.value - c.data >= 1)",
    "always(a.value >= 0 -> eventually[0:{p}](c.data >= 0))",
    "(a.value >= b.value) until (c.data >= 2)",
)


@settings(max_examples=20)
@given(st.data(), st.sampled_from(PERIODS), st.sampled_from(EARLY))
def test_a_node_before_the_end_agrees_with_the_monitor_and_with_check_on_the_bag(
    folders, data, period, formula
):
    sent = data.draw(traffic(period))
    text = f"{HEAD} rob.value = {formula.format(p=f'{2 * period}ns')}"
    spec = rtamt.parse(text)
    monitor = RosMonitor(bind(spec), period=Fraction(period, 10**9), stale=0)
    records = delivered(monitor, sent)
    records += monitor.tick(max(one.arrival for one in sent))
    (group,) = monitor.groups
    last = max(one.at for one in sent if one.topic in group.topics)
    records = [record for record in records if record.stamp <= last]
    bag = recorded(folders(), sent)
    reading = Reading(resample=f"{period}ns")
    samples = on_time_base(read_for([spec], str(bag), reading), spec, str(bag), reading)
    start = StartMonitor(spec, period=Fraction(period, 10**9))
    rows = zip(*(samples[name].values.tolist() for name in spec.input_names), strict=True)
    for i, (record, row) in enumerate(zip(records, rows, strict=True)):
        start.update(i * period / 10**9, **dict(zip(spec.input_names, row, strict=True)))
        assert (record.lower, record.upper) == (start.interval().lower, start.interval().upper)
        assert record.satisfied == start.satisfied
        decided = next((r.stamp for r in records if r.satisfied is not None), None)
        assert record.decided_at == (None if record.satisfied is None else decided)
    _, truth = checked(folders(), text, sent, "--period", f"{period}ns")["/rob"]
    start.finish()
    assert start.satisfied == truth[0][1]
    assert records[-1].satisfied in (None, truth[0][1])


@settings(max_examples=20)
@given(st.data(), st.sampled_from(EARLY))
def test_a_node_in_dense_time_agrees_with_check_on_the_bag_before_the_end(folders, data, formula):
    sent = data.draw(traffic(SECOND))
    text = f"{HEAD} rob.value = {formula.format(p='2s')}"
    monitor = RosMonitor(bind(rtamt.parse(text)), time="dense", stale=0)
    records = delivered(monitor, sent)
    found = checked(folders(), text, sent, "--time", "dense")["/rob"]
    (_, robustness), *_ = found[0]
    (_, truth), *_ = found[1]
    lower = upper = None
    for record in records:
        assert record.lower <= robustness <= record.upper
        assert record.satisfied in (None, truth)
        assert (record.decided_at is None) == (record.satisfied is None)
        assert lower is None or (lower <= record.lower and record.upper <= upper)
        lower, upper = record.lower, record.upper


def listened(reports):
    """Return the samples that an output takes from now on: stamps and values."""
    samples, take = [], reports.take

    def taking(stamp, values):
        samples.append((stamp, dict(values)))
        return take(stamp, values)

    reports.take = taking
    return samples


def expected_records(output, time, samples):
    """Yield what a monitor of an output reports of samples, in the form of a node's records."""
    eager = output.early == "eager"
    verdict = {"verdict": "eager"} if eager else {"verdict": "interval", "at": "every"}
    monitor = output.specification.monitor(
        **verdict, time=time, time_unit="ns", **({"period": 1} if time == "discrete" else {})
    )
    for stamp, values in samples:
        found = monitor.update(stamp, **values)
        for each in found if eager else monitor.changes():
            begin, end = (each.time, each.time) if hasattr(each, "time") else (each.begin, each.end)
            if eager:
                yield stamp, each.satisfied, each.decided_at, begin, end
            else:
                yield stamp, each.interval.lower, each.interval.upper, begin, end


@settings(max_examples=25)
@given(st.data(), st.sampled_from(["eager", "interval"]), st.sampled_from(["discrete", "dense"]))
def test_every_output_of_a_node_has_the_reports_of_a_monitor_of_its_own(data, verdict, time):
    first, second = (data.draw(st.sampled_from([*PAST, *FUTURE])).format(p="2s") for _ in range(2))
    spec = rtamt.parse(f"{HEAD} rob.value = {first}; other.value = {second}")
    bound = bind(spec, verdict, "every" if verdict == "interval" else None)
    monitor = RosMonitor(bound, time=time, stale=0, **({"period": 1} if time == "discrete" else {}))
    taken = {group._reports.output.name: listened(group._reports) for group in monitor.groups}
    sent = data.draw(traffic(SECOND))
    records = delivered(monitor, sent)
    assert len(taken) == 2
    for output in bound.outputs:
        mine = [record for record in records if record.output is output]
        got = [
            (r.stamp, r.satisfied, r.decided_at, r.begin, r.end)
            if verdict == "eager"
            else (r.stamp, r.lower, r.upper, r.begin, r.end)
            for r in mine
        ]
        samples = taken[output.name]
        assert got == list(expected_records(output, time, samples))
        # In dense time each message is a sample, and none that comes before every topic has one is lost.
        read = {
            known.topic for known in bound.inputs if set(known.fields) & set(output.specification.input_names)
        }
        arrivals = {(one.topic, one.at) for one in sent if one.topic in read}
        if time == "dense" and {topic for topic, _ in arrivals} == read:
            assert len(samples) == len(arrivals)
