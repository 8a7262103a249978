"""The monitor of nodes: clocks, timestamps of headers, and topics that fall silent."""

from __future__ import annotations

import time

import pytest

from rtamt.ros.diagnostics import Level
from tests.unit.ros.messages import NO_CLOCK, SECOND, log_of, message, monitor, numbers


def test_a_silent_topic_is_stale_and_the_monitor_begins_anew_when_it_speaks():
    watched = monitor("rob.value = historically(req.value >= 0)", stale="2500ms")
    assert numbers(watched.message("/req", message(-1), SECOND)) == [(1, -1)]
    for i in (2, 3):
        assert numbers(watched.tick(i * SECOND)) == [(i, -1)]
    assert watched.tick(4 * SECOND) == []
    condition = watched.conditions(4 * SECOND)[0]
    assert (condition.level, condition.message) == (Level.STALE, "no message on /req for 3 s")
    assert log_of(watched) == ["/req is stale: no message for 3 s"]
    assert watched.tick(5 * SECOND) == []
    assert log_of(watched) == []
    watched.message("/req", message(4), 5 * SECOND)
    assert numbers(watched.tick(6 * SECOND)) == [(6, 4)]  # what came before the silence is forgotten
    assert log_of(watched) == ["/req has messages again: the monitors that read it begin anew"]


def test_stale_after_ten_periods_unless_said_and_never_with_0():
    for settings, silent in (({"period": "100ms"}, True), ({"period": "100ms", "stale": 0}, False)):
        watched = monitor("rob.value = req.value >= 0", **settings)
        watched.message("/req", message(1), SECOND)
        watched.tick(SECOND)
        assert (watched.tick(int(2.1 * SECOND)) == []) is silent


def test_messages_before_the_first_simulated_instant_are_not_stale_when_the_clock_starts_late():
    watched = monitor("rob.value = req.value >= 0")
    watched.message("/req", message(1), 0)
    assert numbers(watched.tick(100 * SECOND)) == [(100, 1)]
    assert log_of(watched) == [NO_CLOCK]


def test_simulated_time_that_goes_back_begins_anew():
    watched = monitor("rob.value = historically(req.value >= 0)")
    watched.message("/req", message(-1), 50 * SECOND)
    watched.tick(50 * SECOND)
    assert watched.tick(2 * SECOND) == []
    assert log_of(watched) == ["the clock went back by 48 s: all monitors begin anew"]
    watched.message("/req", message(3), 2 * SECOND)
    assert numbers(watched.tick(3 * SECOND)) == [(3, 3)]


def test_a_sample_contained_a_message_newer_than_its_timestamp():
    watched = monitor("rob.value = req.value >= 0")
    told = watched.message("/req", message(1), 10 * SECOND)
    for at, value in ((10.5, 2), (11.25, 3), (12, 4), (12.5, 5)):  # nobody looks at the clock in time
        told += watched.message("/req", message(value), round(at * SECOND))
    told += watched.tick(13 * SECOND)
    assert numbers(told) == [(10, 1), (11, 2), (12, 4), (13, 5)]


def test_a_message_is_sampled_by_the_stamp_in_its_header_however_late_or_early_it_comes():
    watched = monitor("rob.value = req.value - gnt.value")
    told = []
    for arrival, topic, at, value in (
        (10.2, "/req", 10, 1), (10.2, "/gnt", 10.1, 10), (11.3, "/req", 11.2, 2), (11.4, "/gnt", 11, 20),
        (11.9, "/req", 12.2, 3), (13, "/gnt", 12.1, 30), (13, "/req", 12.4, 4),
    ):  # fmt: skip
        told += watched.message(topic, message(value, at=at), round(arrival * SECOND))
    assert numbers(told) == [(10.1, -9), (11.1, 1 - 20), (12.1, 2 - 30)]
    # At the latest a tick takes a sample; what is delivered after that is in the next one.
    assert numbers(watched.tick(13 * SECOND)) == []
    assert numbers(watched.tick(14 * SECOND)) == [(13.1, 4 - 30)]
    watched.message("/req", message(5, at=13), 14 * SECOND)
    assert numbers(watched.tick(15 * SECOND)) == [(14.1, 5 - 30)]


def test_stamps_of_another_clock_are_replaced_by_the_arrival_and_it_is_said_once():
    watched = monitor("rob.value = req.value >= 0", period="100ms")
    told = []
    for i in range(6):
        told += watched.message("/req", message(i, at=100 + i / 20), 10**6 * SECOND + i * SECOND // 20)
        told += watched.tick(10**6 * SECOND + i * SECOND // 20)
    assert numbers(told) == [(10**6, 0), (10**6 + 0.1, 2), (10**6 + 0.2, 4)]
    assert log_of(watched) == [
        "the timestamps on /req are 999900 s behind the clock: its messages are sampled as of their arrival"
    ]


def test_discrete_stamps_that_go_back_begin_anew_and_equal_ones_are_left_out():
    watched = monitor("rob.value = historically(req.value >= 0)", stale=0)
    told = []
    for at, value in ((50, -1), (50, 9), (51, 3)):
        told += watched.message("/req", message(value, at=at), 52 * SECOND)
    assert numbers(told) == [(50, -1), (51, -1)]
    told = watched.message("/req", message(4, at=49), 53 * SECOND)
    assert numbers(told) == [(49, 4)]
    assert log_of(watched) == [
        "messages on /req with the stamp of the one before them are left out",
        "the timestamps on /req went back by 2 s: all monitors begin anew",
    ]


@pytest.mark.parametrize("stale", [None, "3600s", 0])
def test_a_forward_jump_of_the_clock_iterated_period_by_period_for_ever(stale):
    watched = monitor("rob.value = historically(req.value >= 0)", stale=stale, period="10ms")
    watched.message("/req", message(-1), SECOND)
    assert numbers(watched.tick(SECOND + 10**7)) == [(1.01, -1)]
    log_of(watched)
    jumped = 1_600_000_000 * SECOND
    started = time.perf_counter()
    told = watched.tick(jumped)
    assert time.perf_counter() - started < 1
    # What is never stale still holds, but nothing before the jump counts.
    assert numbers(told) == ([(jumped / SECOND, -1)] if stale == 0 else [])
    assert log_of(watched) == ["the clock went forward by 1.6e+09 s at once: all monitors begin anew"]
    told = watched.message("/req", message(4), jumped + SECOND // 100) + watched.tick(jumped + SECOND // 50)
    assert [value for _, value in numbers(told)][-1] == (-1 if stale == 0 else 4)
    assert log_of(watched) == []


def test_what_is_due_before_a_topic_is_stale_is_told_however_late_somebody_looks():
    watched = monitor("rob.value = req.value >= 0", stale="2500ms")
    told = watched.message("/req", message(1), SECOND)
    assert numbers(told + watched.tick(3 * SECOND) + watched.tick(5 * SECOND)) == [(1, 1), (2, 1), (3, 1)]
    watched = monitor("rob.value = req.value >= gnt.value", stale="2500ms")
    told = []
    for topic in ("/req", "/gnt"):
        told += watched.message(topic, message(1), SECOND)
    told += watched.message("/req", message(2), 3 * SECOND) + watched.message("/req", message(3), 5 * SECOND)
    assert numbers(told) == [(1, 0), (2, 0), (3, 1)]
    assert log_of(watched) == ["/gnt is stale: no message for 4 s"]


def test_messages_that_wait_for_another_topic_are_not_piled_up_and_the_first_sample_has_the_right_one():
    watched = monitor("rob.value = req.value - gnt.value", stale=0)
    for i in range(5000):
        assert watched.message("/req", message(i, at=1 + i / 100), SECOND + i * SECOND // 100) == []
    told = watched.message("/gnt", message(0, at=45.005), 51 * SECOND)
    assert numbers(told) == [(45.005, 4400)]


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_messages_before_simulated_time_has_begun_are_no_ok_and_said_once(time):
    watched = monitor("rob.value = req.value >= 3", time=time)
    assert log_of(watched) == []
    watched.message("/req", message(5, at=1), 0)
    watched.message("/req", message(5, at=2), 0)
    assert log_of(watched) == [NO_CLOCK]
    (condition,) = watched.conditions(0)
    assert (condition.level, condition.message) == (Level.WARN, NO_CLOCK)
    watched.tick(SECOND)
    assert watched.conditions(SECOND)[0].message == "satisfied"
    assert log_of(watched) == []
