"""The monitor that nodes carry messages to, with messages made of plain objects."""

from __future__ import annotations

import time
from fractions import Fraction
from math import inf, nan
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

import rtamt
from rtamt.errors import BoundError, UsageError
from rtamt.ros import Robustness, RosMonitor, Verdict, bind
from rtamt.ros.diagnostics import Level

SECOND = 10**9
#: What is said of messages that arrive at 0, which is a simulated clock that nobody has set.
NO_CLOCK = "simulated time has not begun: nobody publishes /clock"
HEAD = """
from rtamt_msgs.msg import FloatStamped
input FloatStamped req  output FloatStamped gnt  output FloatStamped rob  output FloatStamped all
@ topic(req, /req)  @ topic(gnt, /gnt)
"""


def message(value, at=None):
    """Return a message like those of ROS 1; ``at``: the seconds in its header."""
    if at is None:
        return SimpleNamespace(value=value)
    secs, nsecs = divmod(round(at * SECOND), SECOND)
    return SimpleNamespace(header=SimpleNamespace(stamp=SimpleNamespace(secs=secs, nsecs=nsecs)), value=value)


def monitor(formula, **settings):
    if settings.get("time") != "dense":
        settings = {"period": 1, **settings}
    return RosMonitor(bind(rtamt.parse(HEAD + formula)), **settings)


def numbers(records):
    return [(record.stamp / SECOND, record.value) for record in records if isinstance(record, Robustness)]


def verdicts(records):
    return [record.satisfied for record in records if isinstance(record, Verdict)]


def said(watched):
    return [notice.message for notice in watched.notices()]


def test_nothing_is_told_before_the_first_message_on_every_topic():
    watched = monitor("rob.value = req.value >= gnt.value")
    assert watched.tick(0) == []
    watched.message("/req", message(5), 0)
    assert watched.tick(SECOND) == []
    assert watched.conditions(SECOND)[0].message == "waiting for the first message on /gnt"
    watched.message("/gnt", message(3), SECOND)
    assert numbers(watched.tick(2 * SECOND)) == [(2, 2)]


def test_a_tick_samples_the_latest_message_and_nothing_between_ticks_is_told():
    watched = monitor("rob.value = req.value >= 0")
    watched.message("/req", message(1), 0)
    assert numbers(watched.tick(0)) == [(0, 1)]
    assert watched.message("/req", message(7), 1) == []
    watched.message("/req", message(2), 2)
    assert watched.tick(SECOND - 1) == []
    assert numbers(watched.tick(SECOND)) == [(1, 2)]
    assert watched.pause(SECOND + 1) == pytest.approx(0.1)
    assert watched.pause(2 * SECOND - 10**7) == pytest.approx(0.01)


def test_ticks_that_come_late_lose_no_sample():
    watched = monitor("rob.value = once[2,2](req.value >= 0)")
    watched.message("/req", message(1), 0)
    watched.tick(0)
    watched.message("/req", message(2), 1)
    assert numbers(watched.tick(3 * SECOND + 5)) == [(1, -inf), (2, 1), (3, 2)]


def test_the_verdict_is_unknown_until_the_horizon_has_passed_and_boolean_afterwards():
    watched = monitor("rob.value = eventually[0,2](req.value > 0)")
    watched.message("/req", message(0), 0)
    records = [watched.tick(i * SECOND) for i in range(4)]
    assert [numbers(r)[0][1] for r in records] == [0, 0, 0, 0]
    assert [verdicts(r)[0] for r in records] == [None, None, False, False]
    assert watched.conditions(0)[0].level == Level.ERROR
    assert watched.conditions(0)[0].message == "violated"


def test_each_assertion_is_published_and_other_names_are_sub_formulas():
    watched = monitor("asked = req.value >= 3; rob.value = once asked; all.value = historically asked")
    watched.message("/req", message(5), 0)
    watched.tick(0)
    watched.message("/req", message(1), 1)
    records = watched.tick(SECOND)
    assert [(r.output.topic, r.value) for r in records if isinstance(r, Robustness)] == [
        ("rtamt/rob", 2),
        ("rtamt/all", -2),
    ]


def test_a_silent_topic_is_stale_and_the_monitor_begins_anew_when_it_speaks():
    watched = monitor("rob.value = historically(req.value >= 0)", stale="2500ms")
    assert numbers(watched.message("/req", message(-1), SECOND)) == [(1, -1)]
    for i in (2, 3):
        assert numbers(watched.tick(i * SECOND)) == [(i, -1)]
    assert watched.tick(4 * SECOND) == []
    condition = watched.conditions(4 * SECOND)[0]
    assert (condition.level, condition.message) == (Level.STALE, "no message on /req for 3 s")
    assert said(watched) == ["/req is stale: no message for 3 s"]
    assert watched.tick(5 * SECOND) == []
    assert said(watched) == []
    watched.message("/req", message(4), 5 * SECOND)
    assert numbers(watched.tick(6 * SECOND)) == [(6, 4)]  # what came before the silence is forgotten
    assert said(watched) == ["/req speaks again: the monitors that read it begin anew"]


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
    assert said(watched) == [NO_CLOCK]


def test_simulated_time_that_goes_back_begins_anew():
    watched = monitor("rob.value = historically(req.value >= 0)")
    watched.message("/req", message(-1), 50 * SECOND)
    watched.tick(50 * SECOND)
    assert watched.tick(2 * SECOND) == []
    assert said(watched) == ["the clock went back by 48 s: all monitors begin anew"]
    watched.message("/req", message(3), 2 * SECOND)
    assert numbers(watched.tick(3 * SECOND)) == [(3, 3)]


def test_a_number_that_is_none_leaves_a_hole_and_is_said_once():
    watched = monitor("rob.value = historically(req.value >= 0)")
    watched.message("/req", message(-1), 0)
    watched.tick(0)
    watched.message("/req", message(nan), 1)
    assert watched.tick(SECOND) == []
    assert watched.tick(2 * SECOND) == []
    problem = "'req.value' is NaN at sample 1, time 1 s: fill the gap or leave the sample out"
    assert said(watched) == [NO_CLOCK, f"'rob.value' begins anew, its samples cannot be used: {problem}"]
    assert watched.conditions(0)[0].level == Level.ERROR
    watched.message("/req", message(3), 2 * SECOND)
    assert numbers(watched.tick(3 * SECOND)) == [(3, 3)]
    assert watched.conditions(3 * SECOND)[0].level == Level.OK


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_an_output_whose_sample_has_no_value_begins_anew_alone(time):
    watched = monitor(
        "rob.value = ln(req.value) >= 0; all.value = historically(req.value >= 0); gnt.value = once(req.value >= 9)",
        time=time,
    )
    told = []
    for i, value in enumerate((1, -1, 1), 1):
        told += watched.message("/req", message(value, at=i), i * SECOND) + watched.tick(i * SECOND)
    by_name = {
        output.name: numbers(r for r in told if r.output is output) for output in watched.binding.outputs
    }
    assert by_name["rob.value"] == [(1, 0), (3, 0)]
    assert by_name["all.value"] == [(1, 1), (2, -1), (3, -1)]
    assert by_name["gnt.value"] == [(1, -8), (2, -8), (3, -8)]
    (notice,) = said(watched)
    assert notice.startswith("'rob.value' begins anew, its samples cannot be used: ")
    assert len(watched.watches) == 2
    watched.message("/req", message(nan, at=4), 4 * SECOND)
    watched.tick(4 * SECOND)
    assert "'all.value' and 'gnt.value' begin anew, their samples cannot be used: " in "".join(said(watched))
    assert [c.name.split()[-1] for c in watched.conditions(0)] == ["rob.value", "all.value", "gnt.value"]


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_only_what_is_wanted_is_told_and_the_conditions_know_all(time):
    watched = monitor("rob.value = req.value >= 3; all.value = req.value <= 3", time=time)
    watched.wanted = {"rtamt/rob", "rtamt/all/verdict"}
    told = watched.message("/req", message(5, at=1), SECOND) + watched.tick(SECOND)
    assert (numbers(told), verdicts(told), len(told)) == ([(1, 2)], [False], 2)
    assert [condition.message for condition in watched.conditions(SECOND)] == ["satisfied", "violated"]
    assert [dict(condition.values)["robustness"] for condition in watched.conditions(SECOND)] == ["2", "-2"]


def test_a_message_without_the_number_is_refused_and_the_old_one_is_no_value_of_now():
    text = HEAD + 'rob.value = "req.values[1]" >= 0'
    watched = RosMonitor(bind(rtamt.parse(text)), period=1)
    watched.message("/req", SimpleNamespace(values=[1, 2]), 0)
    assert numbers(watched.tick(0)) == [(0, 2)]
    watched.message("/req", SimpleNamespace(values=[1]), 1)
    assert watched.tick(SECOND) == []
    problem = "a message has no 'req.values[1]': the array is shorter"
    assert said(watched) == [NO_CLOCK, f"a message on /req cannot be used: {problem}"]
    assert watched.conditions(0)[0].message == problem


# ---- which message a sample has, and the clock -------------------------------------------------------


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
    assert said(watched) == [
        "the stamps on /req are 999900 s behind the clock: its messages are sampled as of their arrival"
    ]


def test_discrete_stamps_that_go_back_begin_anew_and_equal_ones_are_left_out():
    watched = monitor("rob.value = historically(req.value >= 0)", stale=0)
    told = []
    for at, value in ((50, -1), (50, 9), (51, 3)):
        told += watched.message("/req", message(value, at=at), 52 * SECOND)
    assert numbers(told) == [(50, -1), (51, -1)]
    told = watched.message("/req", message(4, at=49), 53 * SECOND)
    assert numbers(told) == [(49, 4)]
    assert said(watched) == [
        "messages on /req with the stamp of the one before them are left out",
        "the stamps on /req went back by 2 s: all monitors begin anew",
    ]


@pytest.mark.parametrize("stale", [None, "3600s", 0])
def test_a_forward_jump_of_the_clock_iterated_period_by_period_for_ever(stale):
    watched = monitor("rob.value = historically(req.value >= 0)", stale=stale, period="10ms")
    watched.message("/req", message(-1), SECOND)
    assert numbers(watched.tick(SECOND + 10**7)) == [(1.01, -1)]
    said(watched)
    jumped = 1_600_000_000 * SECOND
    started = time.perf_counter()
    told = watched.tick(jumped)
    assert time.perf_counter() - started < 1
    # What is never stale still holds, but nothing before the jump counts.
    assert numbers(told) == ([(jumped / SECOND, -1)] if stale == 0 else [])
    assert said(watched) == ["the clock went forward by 1.6e+09 s at once: all monitors begin anew"]
    told = watched.message("/req", message(4), jumped + SECOND // 100) + watched.tick(jumped + SECOND // 50)
    assert [value for _, value in numbers(told)][-1] == (-1 if stale == 0 else 4)
    assert said(watched) == []


def test_dense_time_says_a_forward_jump_once():
    watched = monitor("rob.value = historically(req.value >= gnt.value)", time="dense")
    for topic in ("/req", "/gnt"):
        watched.message(topic, message(1), SECOND)
    watched.tick(1_600_000_000 * SECOND)
    assert said(watched) == ["the clock went forward by 1.6e+09 s at once: all monitors begin anew"]


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
    assert said(watched) == ["/gnt is stale: no message for 4 s"]


def test_messages_that_wait_for_another_topic_are_not_piled_up_and_the_first_sample_has_the_right_one():
    watched = monitor("rob.value = req.value - gnt.value", stale=0)
    for i in range(5000):
        assert watched.message("/req", message(i, at=1 + i / 100), SECOND + i * SECOND // 100) == []
    told = watched.message("/gnt", message(0, at=45.005), 51 * SECOND)
    assert numbers(told) == [(45.005, 4400)]


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        ({}, "discrete time samples the topics once a period: give the period, such as 100ms, or choose dense time, "
             "which reads every message at its own time"),
        ({"period": 1, "time": "dense"},
         "dense time has no sampling period: leave out the period, or choose discrete time"),
        ({"period": Fraction(1, 3)}, "the period 1/3 s is no whole number of nanoseconds"),
    ],
)  # fmt: skip
def test_there_is_no_default_period(settings, sentence):
    with pytest.raises(UsageError) as caught:
        RosMonitor(bind(rtamt.parse(HEAD + "rob.value = req.value >= 0")), **settings)
    assert str(caught.value) == sentence


# ---- dense time ----------------------------------------------------------------------------------


def test_dense_time_takes_the_stamps_of_the_headers_each_topic_on_its_own_clock():
    watched = monitor("rob.value = req.value >= gnt.value", time="dense")
    arrival = 100 * SECOND
    assert watched.message("/req", message(5, at=10), arrival) == []
    assert numbers(watched.message("/gnt", message(3, at=10.25), arrival)) == []
    assert numbers(watched.message("/req", message(6, at=10.75), arrival)) == [(10.25, 2)]
    assert numbers(watched.message("/gnt", message(3, at=11), arrival)) == [(10.75, 3)]


def test_dense_time_takes_the_arrival_of_messages_without_a_stamp():
    watched = monitor("rob.value = req.value >= 0", time="dense")
    assert numbers(watched.message("/req", message(1), 7 * SECOND)) == [(7, 1)]
    assert numbers(watched.message("/req", message(2, at=0), 8 * SECOND)) == [(8, 2)]


def test_dense_stamps_that_go_back_begin_anew_and_equal_ones_are_left_out_once_said():
    watched = monitor("rob.value = historically(req.value >= 0)", time="dense")
    watched.message("/req", message(-1, at=50), 0)
    for _ in range(2):
        assert watched.message("/req", message(9, at=50), 1) == []
    assert said(watched) == [NO_CLOCK, "messages on /req with the stamp of the one before them are left out"]
    assert numbers(watched.message("/req", message(3, at=2), 2)) == [(2, 3)]
    assert said(watched) == ["the stamps on /req went back by 48 s: all monitors begin anew"]


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
    (watch,) = watched.watches
    assert watch.samples == 0
    assert watched.conditions(500 * SECOND)[0].message == "no message on /gnt for 499 s"
    assert numbers(watched.message("/gnt", message(9, at=499.5), 500 * SECOND)) == []
    assert numbers(watched.message("/req", message(10, at=500), 500 * SECOND)) == [(499.5, 490)]


@pytest.mark.parametrize("time", ["discrete", "dense"])
@given(st.lists(st.integers(-5, 5), min_size=1, max_size=20))
def test_outputs_in_one_program_tell_what_each_would_tell_alone(time, values):
    formulas = {
        "rob": "eventually[0,2](req.value >= 0)",
        "all": "historically(req.value > 1)",
        "gnt": "(req.value == 2) until[0,3] (req.value < 0)",
    }
    watched = [monitor("; ".join(f"{name}.value = {text}" for name, text in formulas.items()), time=time)]
    assert len(watched[0].watches) == 1
    watched += [monitor(f"{name}.value = {text}", time=time) for name, text in formulas.items()]
    together, *alone = ([] for _ in watched)
    for i, value in enumerate(values, 1):
        for node, told in zip(watched, (together, *alone), strict=True):
            came = node.message("/req", message(value, at=i), i * SECOND) + node.tick(i * SECOND)
            told += [
                (type(r), r.output.name, r.stamp, getattr(r, "value", None), getattr(r, "satisfied", None))
                for r in came
            ]
    assert sorted(together, key=repr) == sorted((r for told in alone for r in told), key=repr)


@given(st.lists(st.integers(-5, 5), min_size=1, max_size=30))
def test_robustness_equals_the_offline_answer_one_horizon_later_in_both_kinds_of_time(values):
    formula = "eventually[0,2](historically[0,3](req.value >= 0))"
    offline = rtamt.parse(formula.replace(".value", ""))
    discrete, dense = monitor(f"rob.value = {formula}"), monitor(f"rob.value = {formula}", time="dense")
    ticked, came = [], []
    for i, value in enumerate(values, 1):
        ticked += discrete.message("/req", message(value), i * SECOND) + discrete.tick(i * SECOND)
        came += dense.message("/req", message(value, at=i), i * SECOND)
    expected = offline.evaluate({"req": values}).signal.values.tolist()
    assert [value for _, value in numbers(ticked)][2:] == expected[:-2]
    told = dict(numbers(came))
    assert [told[i] for i in range(3, len(values) + 1)] == expected[:-2]


# ---- what is refused -----------------------------------------------------------------------------


def test_unbounded_future_is_refused_with_the_place():
    with pytest.raises(BoundError) as caught:
        monitor("rob.value = always(req.value >= 0)")
    assert str(caught.value).startswith("'rob.value': ")
    assert "^^^" in str(caught.value)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "input float x; x + 3",
            "the specification publishes nothing: give the requirement the name of a field of a declared message, "
            "such as rob.value = always(...)",
        ),
        (
            "from a.msg import F  input F x  output F rob  rob = x.value >= 3",
            "'rob' is a F and no number; say which field is the robustness, such as rob.value = ...",
        ),
        (
            "from a.msg import F  input F x  output F rob  rob.value = x >= 3",
            "'x' is a F and no number; read one of its fields, such as x.value",
        ),
        (
            "from a.msg import F  input float x  output F rob  rob.value = x >= 3",
            "'x' is a float, and a topic carries messages: import a type and declare it, such as "
            "'from std_msgs.msg import Float64' and 'input Float64 x', then read x.data",
        ),
        (
            "from a.msg import F  input F x  output F rob  @ topic(rob, t)  @ topic(x, t)  rob.value = x.v >= 3",
            "'rob.value' would be published on t, from which 'x' is read; give it a topic of its own: "
            "@ topic(rob, rtamt/rob)",
        ),
        (
            "from a.msg import F  input F x  output F rob  rob.a = x.v >= 3; rob.b = x.v >= 4",
            "'rob.a' and 'rob.b' would both be published on rtamt/rob; give each a variable and a topic of its own",
        ),
        (
            "from a.msg import F  from a.msg import G  input F x  input G y  output F rob  "
            "@ topic(x, t)  @ topic(y, t)  rob.a = x.v >= y.v",
            "'x' and 'y' are on the topic t with different types, a/F and a/G",
        ),
    ],
)
def test_what_cannot_be_bound_is_said(text, sentence):
    with pytest.raises(UsageError) as caught:
        bind(rtamt.parse(text))
    assert str(caught.value) == sentence


class Point:
    """A message as genpy makes them: fields in slots."""

    __slots__ = ["x", "y"]

    def __init__(self):
        self.x = self.y = 0.0


class Arm:
    """Another, nested and with arrays."""

    __slots__ = ["fingers", "hand", "torque"]

    def __init__(self):
        self.hand, self.fingers, self.torque = Point(), [], [0.0, 0.0, 0.0]


@pytest.mark.parametrize("name", ["a.hand.x", '"a.torque[2]"', '"a.fingers[7].x"'])
def test_any_path_of_fields_is_read(name):
    spec = rtamt.parse(f"from m.msg import Arm  input Arm a  output Arm rob  rob.hand.x = {name} >= 3")
    bind(spec).check(lambda _: Arm)
    arm = Arm()
    arm.hand.x, arm.torque[2], arm.fingers = 5.0, 5.0, [Point()] * 7 + [arm.hand]
    watched = RosMonitor(bind(spec), period=1)
    watched.message("rtamt/a", arm, 0)
    assert numbers(watched.tick(0)) == [(0, 2)]


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("a.hnad.x", "'a' has no field 'hnad'; did you mean 'hand'? (fields: hand, fingers, torque)"),
        ("a.hand", "'a.hand' is no number but a Point; name one of its fields, such as a.hand.x"),
        ("a.hand.x.z", "'a.hand.x' is a number and has no field 'z'"),
        ('"a.hand[1].x"', "'a.hand' is no array, so that there is no 'a.hand[1].x' in a m/Arm"),
        ('"a.hand x"', "'a.hand x' is no path of fields, such as pose.position.x or ranges[3]"),
    ],
)
def test_a_field_that_is_not_there_is_said_before_the_first_message(name, sentence):
    spec = rtamt.parse(f"from m.msg import Arm  input Arm a  output Arm rob  rob.hand.x = {name} >= 3")
    with pytest.raises(UsageError) as caught:
        bind(spec).check(lambda _: Arm)
    assert str(caught.value) == sentence


def test_a_module_that_cannot_be_imported_is_said():
    binding = bind(rtamt.parse("from no_msgs.msg import F  input F a  output F rob  rob.x = a.x >= 3"))
    with pytest.raises(UsageError) as caught:
        binding.check()
    assert str(caught.value) == (
        "the message module 'no_msgs.msg' cannot be imported: No module named 'no_msgs'; "
        "is the workspace built, and its setup file sourced?"
    )


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_messages_before_simulated_time_has_begun_are_no_ok_and_said_once(time):
    watched = monitor("rob.value = req.value >= 3", time=time)
    assert said(watched) == []
    watched.message("/req", message(5, at=1), 0)
    watched.message("/req", message(5, at=2), 0)
    assert said(watched) == [NO_CLOCK]
    (condition,) = watched.conditions(0)
    assert (condition.level, condition.message) == (Level.WARN, NO_CLOCK)
    watched.tick(SECOND)
    assert watched.conditions(SECOND)[0].message == "satisfied"
    assert said(watched) == []


def test_each_requirement_is_published_also_where_no_declared_message_is_for_it():
    text = """
        from rtamt_msgs.msg import FloatStamped
        input FloatStamped x  output FloatStamped rob
        require rob.value: x.value >= 1
        require REQ-12 "at most": historically(x.value <= 3)"""
    binding = bind(rtamt.parse(text))
    assert [(output.name, output.topic, output.field) for output in binding.outputs] == [
        ("rob.value", "rtamt/rob", "rob.value"),
        ("REQ-12", "rtamt/REQ_12", "REQ_12.value"),
    ]
    assert {output.type.ros for output in binding.outputs} == {"rtamt_msgs/FloatStamped"}
    monitor = RosMonitor(binding, period=1)
    records = monitor.message("rtamt/x", SimpleNamespace(value=4.0), 500_000_000)
    told = {record.output.name: record.value for record in records if isinstance(record, Robustness)}
    assert told == {"rob.value": 3, "REQ-12": -1}
