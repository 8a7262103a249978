"""The monitor that nodes carry messages to, with messages made of plain objects."""

from __future__ import annotations

from fractions import Fraction
from math import inf, nan
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

import rtamt
from rtamt.errors import UsageError
from rtamt.language.value_types import Enumeration
from rtamt.ros import Robustness, RosMonitor, Verdict, bind
from rtamt.ros.diagnostics import Level
from rtamt.ros.fields import reader
from tests.unit.ros.messages import HEAD, NO_CLOCK, SECOND, log_of, message, monitor, numbers


def verdicts(records):
    return [record.satisfied for record in records if isinstance(record, Verdict)]


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


def test_a_number_that_is_none_leaves_a_hole_and_is_said_once():
    watched = monitor("rob.value = historically(req.value >= 0)")
    watched.message("/req", message(-1), 0)
    watched.tick(0)
    watched.message("/req", message(nan), 1)
    assert watched.tick(SECOND) == []
    assert watched.tick(2 * SECOND) == []
    problem = "'req.value' is NaN at sample 1, time 1 s: fill the gap or leave the sample out"
    assert log_of(watched) == [NO_CLOCK, f"'rob.value' begins anew, its samples cannot be used: {problem}"]
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
    (notice,) = log_of(watched)
    assert notice.startswith("'rob.value' begins anew, its samples cannot be used: ")
    assert len(watched.groups) == 2
    watched.message("/req", message(nan, at=4), 4 * SECOND)
    watched.tick(4 * SECOND)
    assert "'all.value' and 'gnt.value' begin anew, their samples cannot be used: " in "".join(
        log_of(watched)
    )
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
    assert log_of(watched) == [NO_CLOCK, f"a message on /req cannot be used: {problem}"]
    assert watched.conditions(0)[0].message == problem


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


@pytest.mark.parametrize("time", ["discrete", "dense"])
@given(st.lists(st.integers(-5, 5), min_size=1, max_size=20))
def test_outputs_in_one_program_tell_what_each_would_tell_alone(time, values):
    formulas = {
        "rob": "eventually[0,2](req.value >= 0)",
        "all": "historically(req.value > 1)",
        "gnt": "(req.value == 2) until[0,3] (req.value < 0)",
    }
    watched = [monitor("; ".join(f"{name}.value = {text}" for name, text in formulas.items()), time=time)]
    assert len(watched[0].groups) == 1
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


def test_constants_of_a_message_are_members_of_an_enumeration_by_name():
    class Verdict(SimpleNamespace):
        UNKNOWN, SATISFIED, VIOLATED = 0, 1, 2

    read = reader("v.verdict", Enumeration("V", (("VIOLATED", 0), ("SATISFIED", 7))))
    assert [read(Verdict(verdict=code)) for code in (0, 1, 2, 3)] == [8, 7, 0, 3]
    plain = reader("v.verdict", Enumeration("V", (("ON", 1),)))
    assert [plain(Verdict(verdict=code)) for code in (0, 1)] == [0, 1]


def test_a_field_of_a_message_may_be_of_an_enumeration():
    text = """from rtamt_msgs.msg import Verdict
    from rtamt_msgs.msg import FloatStamped
    enum V { VIOLATED, SATISFIED }
    input Verdict v  V v.verdict  output FloatStamped rob
    @ topic(v, /v)  @ topic(rob, /rob)
    rob.value = v.verdict == SATISFIED"""

    class Message(SimpleNamespace):
        UNKNOWN, SATISFIED, VIOLATED = 0, 1, 2

    watched = RosMonitor(bind(rtamt.parse(text)), time="dense")
    records = [
        record
        for at, code in enumerate((1, 2), 1)
        for record in watched.message("/v", Message(verdict=code), at * SECOND)
    ]
    assert numbers(records) == [(1, inf), (2, -inf)]
