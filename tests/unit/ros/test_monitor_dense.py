"""The monitor of nodes in dense time: timestamps, silence and unknown verdicts."""

from __future__ import annotations

from rtamt.ros import Verdict
from tests.unit.ros.messages import NO_CLOCK, SECOND, log_of, message, monitor, numbers


def test_dense_time_says_a_forward_jump_once():
    watched = monitor("rob.value = historically(req.value >= gnt.value)", time="dense")
    for topic in ("/req", "/gnt"):
        watched.message(topic, message(1), SECOND)
    watched.tick(1_600_000_000 * SECOND)
    assert log_of(watched) == ["the clock went forward by 1.6e+09 s at once: all monitors begin anew"]


def test_dense_time_takes_the_stamps_of_the_headers_each_topic_on_its_own_clock():
    watched = monitor("rob.value = req.value >= gnt.value", time="dense")
    arrival = 100 * SECOND
    assert watched.message("/req", message(5, at=10), arrival) == []
    assert numbers(watched.message("/gnt", message(3, at=10.25), arrival)) == []
    assert numbers(watched.message("/req", message(6, at=10.75), arrival)) == [(10.25, 2)]
    assert numbers(watched.message("/gnt", message(3, at=11), arrival)) == [(10.75, 3)]


def test_dense_time_was_silent_where_topics_have_no_time_in_common():
    watched = monitor("rob.value = req.value >= gnt.value", time="dense")
    for i in range(3):
        arrival = (1_700_000_000 + i) * SECOND
        assert watched.message("/req", message(1, at=1 + i), arrival) == []
        assert watched.message("/gnt", message(1), arrival) == []
    assert log_of(watched) == [
        "the timestamps on /req are 1.7e+09 s behind those on /gnt: dense time knows nothing after them; "
        "use one clock for both, or discrete time"
    ]


def test_dense_time_takes_the_arrival_of_messages_without_a_stamp():
    watched = monitor("rob.value = req.value >= 0", time="dense")
    assert numbers(watched.message("/req", message(1), 7 * SECOND)) == [(7, 1)]
    assert numbers(watched.message("/req", message(2, at=0), 8 * SECOND)) == [(8, 2)]


def test_dense_stamps_that_go_back_begin_anew_and_equal_ones_are_left_out_once_said():
    watched = monitor("rob.value = historically(req.value >= 0)", time="dense")
    watched.message("/req", message(-1, at=50), 0)
    for _ in range(2):
        assert watched.message("/req", message(9, at=50), 1) == []
    assert log_of(watched) == [
        NO_CLOCK,
        "messages on /req with the stamp of the one before them are left out",
    ]
    assert numbers(watched.message("/req", message(3, at=2), 2)) == [(2, 3)]
    assert log_of(watched) == ["the timestamps on /req went back by 48 s: all monitors begin anew"]


def test_dense_verdicts_are_unknown_until_the_horizon_has_passed():
    watched = monitor("rob.value = eventually[0,2](req.value > 3)", time="dense")
    records = []
    for at in (10, 11, 12, 13):
        records += watched.message("/req", message(3, at=at), 0)
    told = {record.stamp // SECOND: record.satisfied for record in records if isinstance(record, Verdict)}
    assert told == {10: None, 11: None, 12: False, 13: False}


def test_a_dense_verdict_stayed_unknown_until_the_first_message_after_the_horizon():
    watched = monitor("rob.value = eventually[0,2](req.value > 3)", time="dense")
    records = watched.message("/req", message(3, at=10), 0) + watched.message("/req", message(3, at=15), 0)
    told = [(record.stamp // SECOND, record.satisfied) for record in records if isinstance(record, Verdict)]
    assert told == [(10, None), (12, False), (15, False)]


def test_dense_silence_is_stale_and_what_others_say_meanwhile_is_not_piled_up():
    watched = monitor("rob.value = req.value >= gnt.value", time="dense", stale=5)
    watched.message("/req", message(5, at=1), SECOND)
    watched.message("/gnt", message(3, at=1), SECOND)
    for at in range(2, 500):
        watched.message("/req", message(at, at=at), at * SECOND)
        watched.tick(at * SECOND)
    (group,) = watched.groups
    assert group.samples == 0
    assert watched.conditions(500 * SECOND)[0].message == "no message on /gnt for 499 s"
    assert numbers(watched.message("/gnt", message(9, at=499.5), 500 * SECOND)) == []
    assert numbers(watched.message("/req", message(10, at=500), 500 * SECOND)) == [(499.5, 490)]
