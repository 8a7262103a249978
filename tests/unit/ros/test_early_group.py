"""Outputs that are monitored before their horizon: bounds and verdict at the start of the trace."""

from __future__ import annotations

from math import inf
from types import SimpleNamespace

import pytest

import rtamt
from rtamt.errors import UsageError
from rtamt.ros import Bounds, bind
from rtamt.ros.diagnostics import Level
from rtamt.ros.message_definitions import SATISFIED, UNKNOWN, VIOLATED
from rtamt.ros.publisher import Publisher
from tests.unit.ros.messages import HEAD, SECOND, log_of, message, monitor, numbers


def follow(watched, values):
    """Feed a value a second from 1 s on; return the records."""
    records = []
    for i, value in enumerate(values, 1):
        records += watched.message("/req", message(value, at=i), i * SECOND)
    return records


def test_unbounded_future_is_watched_at_the_start_of_the_trace():
    watched = monitor("rob.value = always(req.value >= 0)")
    records = follow(watched, [4, -1, 5])
    assert [(r.stamp // SECOND, r.lower, r.upper, r.satisfied, r.decided_at) for r in records] == [
        (1, -inf, 4.0, None, None),
        (2, -inf, -1.0, False, 2 * SECOND),
        (3, -inf, -1.0, False, 2 * SECOND),
    ]
    (condition,) = watched.conditions(3 * SECOND)
    assert (condition.level, condition.message) == (Level.ERROR, "violated")
    assert ("decided", "at 2 s") in condition.values


def test_what_can_no_longer_be_violated_is_in_order():
    watched = monitor("rob.value = eventually(req.value >= 0)")
    assert watched.conditions(0)[0].message == "waiting for the first message on /req"
    follow(watched, [-1])
    assert watched.conditions(SECOND)[0].message == "open"
    follow(watched, [-1, 3])
    condition = watched.conditions(2 * SECOND)[0]
    assert (condition.level, condition.message) == (Level.OK, "can no longer be violated")


def test_bounded_future_is_watched_at_the_start_where_that_is_asked_for():
    watched = monitor("rob.value = eventually[0,1](req.value >= 0)", verdict="interval")
    assert [(r.lower, r.upper) for r in follow(watched, [-1, 2, 5])] == [(-1, inf), (2, 2), (2, 2)]


def test_early_and_delayed_outputs_are_watched_side_by_side():
    watched = monitor("rob.value = always(req.value >= 0); all.value = historically(req.value >= 0)")
    records = follow(watched, [4, -1])
    assert numbers(records) == [(1, 4), (2, -1)]
    assert [r.satisfied for r in records if isinstance(r, Bounds)] == [None, False]


def test_a_trace_that_begins_anew_has_a_new_verdict():
    watched = monitor("rob.value = always(req.value >= 0)", stale="2s")
    follow(watched, [4, -1])
    watched.tick(20 * SECOND)
    records = watched.message("/req", message(3, at=20), 20 * SECOND)
    records += watched.message("/req", message(3, at=21), 21 * SECOND)
    assert [(r.stamp // SECOND, r.satisfied) for r in records] == [(20, None), (21, None)]


def test_a_sample_that_cannot_be_used_begins_anew():
    watched = monitor("rob.value = always(ln(req.value) >= 0)")
    follow(watched, [4, -1])
    assert any("samples cannot be used" in sentence for sentence in log_of(watched))
    assert [r.satisfied for r in watched.message("/req", message(5, at=3), 3 * SECOND)] == [None]


def test_only_topics_that_somebody_hears_have_records():
    watched = monitor("rob.value = always(req.value >= 0)")
    watched.wanted = {"rtamt/rob"}
    assert follow(watched, [4]) == []
    watched.wanted = {"rtamt/rob/bounds"}
    assert len(watched.message("/req", message(4, at=2), 2 * SECOND)) == 1


def test_bounds_are_messages_on_a_topic_of_their_own():
    watched = monitor("rob.value = always(req.value >= 0)")

    def load(kind):
        fields = {"value": 0.0} if kind.name == "FloatStamped" else {}
        return lambda: SimpleNamespace(header=SimpleNamespace(stamp=0), **fields)

    outbox = Publisher(watched.binding, load, lambda stamp: stamp)
    assert list(outbox.topics) == ["rtamt/rob/bounds"]
    sent = [outbox.message(record) for record in follow(watched, [4, -1])]
    assert [
        (m.header.stamp, m.name, m.lower, m.upper, m.verdict, m.decided_at, m.begin, m.end) for m in sent
    ] == [
        (SECOND, "rob.value", -inf, 4.0, UNKNOWN, 0, SECOND, SECOND),
        (2 * SECOND, "rob.value", -inf, -1.0, VIOLATED, 2 * SECOND, SECOND, SECOND),
    ]
    assert SATISFIED != VIOLATED


def test_dense_time_has_a_record_for_every_message():
    watched = monitor("rob.value = always(req.value >= gnt.value)", time="dense")
    assert watched.message("/req", message(5, at=1), SECOND) == []
    records = watched.message("/gnt", message(3, at=1.5), 2 * SECOND)
    records += watched.message("/gnt", message(7, at=2.5), 3 * SECOND)
    records += watched.message("/req", message(9, at=2.75), 3 * SECOND)
    # The grant counts once a request is known up to its time.
    assert [(r.stamp / SECOND, r.upper, r.satisfied, r.decided_at) for r in records] == [
        (1, inf, None, None),
        (1.5, inf, None, None),
        (2.5, inf, None, None),
        (2.75, -2.0, False, 2.75 * SECOND),
    ]


def test_unknown_verdict_is_refused():
    with pytest.raises(UsageError, match="the verdict is 'soon'; choose from delayed, eager, interval"):
        bind(rtamt.parse(HEAD + "rob.value = req.value >= 0"), "soon")


def test_bounds_of_every_instant_are_those_of_bounded_future():
    spec = rtamt.parse(HEAD + "rob.value = always(req.value >= 0)")
    with pytest.raises(UsageError) as error:
        bind(spec, "interval", "every")
    assert str(error.value) == (
        "'rob.value' has unbounded future, so that its bounds are those of the start; leave out at='every'"
    )
    with pytest.raises(UsageError, match=r"^at is 'end'; choose from start, every$"):
        bind(spec, "interval", "end")
    with pytest.raises(UsageError, match=r"^at='every' belongs to verdict='interval'$"):
        bind(spec, "eager", "every")


EPOCH = 1_700_000_000
VALUES = (4, -1, -2, 5, 0, 3)


def feed(verdict, at, time):
    """Return the records of a node that has a message each second, and how it stands."""
    watched = monitor("rob.value = eventually[0,2](req.value >= 3)", verdict=verdict, at=at, time=time)
    records = []
    for i, value in enumerate(VALUES):
        stamp = EPOCH + i
        records += watched.message("/req", message(value, at=stamp), stamp * SECOND)
    return records, watched.conditions((EPOCH + len(VALUES)) * SECOND)[0]


def alone(time, **settings):
    """Return the monitor of the same requirement, and what each sample makes known."""
    period = "1s" if time == "discrete" else None
    made = rtamt.parse("eventually[0,2](x >= 3)", period=period, time=time).monitor(
        time_unit="ns", **settings
    )
    for i, value in enumerate(VALUES):
        found = made.update((EPOCH + i) * SECOND, x=value)
        yield (EPOCH + i) * SECOND, found if found is not None else made.changes()


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_node_publishes_each_verdict_once_it_is_decided(time):
    records, condition = feed("eager", None, time)
    expected = []
    for stamp, verdicts in alone(time, verdict="eager"):
        for each in verdicts:
            span = (each.time, each.time) if time == "discrete" else (each.begin, each.end)
            bounds = (0.0, inf) if each.satisfied else (-inf, 0.0)
            expected.append((stamp, *bounds, each.satisfied, each.decided_at, *span))
    assert [tuple(record[1:]) for record in records] == expected
    assert expected
    assert (condition.level, condition.message) == (Level.OK, "satisfied")


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_the_verdict_of_a_node_with_bounds_of_every_instant_is_the_last_that_was_decided(time):
    watched = monitor(
        "rob.value = eventually[0,2](req.value >= 3)", verdict="interval", at="every", time=time
    )
    shown = []
    for stamp, value in enumerate((4, -1, -2, -5, 7), 1):
        watched.message("/req", message(value, at=stamp), stamp * SECOND)
        condition = watched.conditions(stamp * SECOND)[0]
        shown.append((condition.level, condition.message))
    satisfied, violated = (Level.OK, "satisfied"), (Level.ERROR, "violated")
    assert shown[:3] == [satisfied] * 3
    assert shown[3] == violated  # although later instants are open
    assert shown[4] == satisfied


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_node_publishes_the_bounds_of_every_instant_when_they_change(time):
    records, _ = feed("interval", "every", time)
    expected = [
        (stamp, each.interval.lower, each.interval.upper, each.begin, each.end)
        for stamp, changes in alone(time, verdict="interval", at="every")
        for each in changes
    ]
    assert [(r.stamp, r.lower, r.upper, r.begin, r.end) for r in records] == expected
    assert all(r.satisfied == (True if r.lower > 0 else False if r.upper < 0 else None) for r in records)
