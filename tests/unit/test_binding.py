"""Recorded names and units of variables: ``input float z [m] = "setpoint.position[2]"``."""

import pickle

import numpy as np
import pandas as pd
import pytest

import rtamt
from rtamt.errors import ParseError, TraceError

TEXT = """\
input float z [m] = "setpoint.position[2]"
input float v [m/s]
require R: historically(z <= 3 and v <= 10)
"""
COLUMN = "setpoint.position[2]"


@pytest.fixture
def spec():
    return rtamt.parse(TEXT)


@pytest.fixture
def trace():
    return rtamt.read({"time": [0, 1, 2], COLUMN: [1, 2, 2.5], "v [km/h]": [18, 27, 45]})


def test_what_the_text_declares(spec):
    assert dict(spec.recorded) == {"z": COLUMN}
    assert pickle.loads(pickle.dumps(spec)).recorded == spec.recorded
    assert [d.columns for d in spec.document.declarations] == [(COLUMN,), ()]


@pytest.mark.parametrize("name", [COLUMN, "z"])
def test_data_in_memory_has_either_name(spec, name):
    data = {name: [1, 2], "v": [3, 4]}
    for each in (data, pd.DataFrame(data)):
        assert spec.evaluate(each).robustness == 2.0
    dense = {name: ([0.0, 1.0], [1, 2]), "v": ([0.0], [3])}
    assert spec.evaluate(dense, time="dense").robustness == 2.0
    assert data.keys() == {name, "v"}


def test_every_way_to_evaluate_converts_and_finds_the_recorded_name(spec, trace):
    expected = [2.0, 1.0, -2.5]
    result = spec.evaluate(trace)
    assert result.signal.values.tolist() == expected
    assert result.trace.units == {"z": "m", "v": "m/s"}
    assert rtamt.evaluate_batch(spec, [trace])[0].signal.values.tolist() == expected
    assert rtamt.evaluate_all([spec, spec], trace)[1].signal.values.tolist() == expected
    assert spec.monitor().update_many(trace).values.tolist() == expected
    assert spec.monitor(time="dense").update_many(trace).values.tolist() == expected
    assert rtamt.check_stream(spec, [trace[0:1], trace[2:2]]).minimum == -2.5
    assert rtamt.check_stream(spec, [trace], time="dense").minimum == -2.5
    assert trace["v [km/h]" if "v [km/h]" in trace.names else "v"].values.tolist() == [18, 27, 45]


def test_specifications_of_one_call_may_bind_a_name_differently(trace):
    texts = [
        'input float v = "setpoint.position[2]"; v <= 3',
        "input float v; v <= 3",
        "input float v [m/s]; v <= 3",
    ]
    results = rtamt.evaluate_all([rtamt.parse(text) for text in texts], trace)
    assert [result.robustness for result in results] == [2.0, -15.0, -2.0]


def test_two_variables_may_swap_their_names_however_often_a_trace_is_bound():
    spec = rtamt.parse('input float a = "b"  input float b = "a"  historically(a >= 0 and b >= 10)')
    trace = rtamt.read({"time": [0, 1], "a": [11, 12], "b": [1, 2]})
    once = spec.binding.applied(trace)
    assert spec.binding.applied(once)["a"].values.tolist() == once["a"].values.tolist() == [1, 2]
    assert spec.evaluate(once).robustness == spec.evaluate(trace).robustness == 1.0
    read = rtamt.read({"time": [0, 1], "a [m]": [11, 12], "b [m]": [1, 2]}, names=spec.recorded)
    assert spec.evaluate(read).robustness == 1.0
    assert spec.evaluate({"a": [11, 12], "b": [1, 2]}).robustness == 1.0


def test_a_conversion_is_noted_once(spec, trace):
    bound = spec.binding.applied(spec.binding.applied(trace))
    assert bound.remarks == ("v was converted from km/h to m/s",)
    assert bound.channel("v").unit == "m/s"
    same = rtamt.read({"time": [0], COLUMN: [1], "v [m/s]": [1]})
    assert spec.binding.applied(same).remarks == ()


def test_a_unit_that_only_one_side_knows_is_taken_as_it_is(spec):
    assert spec.evaluate({"time": [0], COLUMN: [1], "v": [18]}).robustness == -8.0
    assert rtamt.parse("v <= 10").evaluate(rtamt.read({"time": [0], "v [km/h]": [18]})).robustness == -8.0


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"y": [1], "v": [2]}, "the data has no 'setpoint.position[2]', the recorded name of 'z'; signals: y, v"),
        ({"setpoint.position[1]": [1], "v": [2]}, "the data has no 'setpoint.position[2]', the recorded name of 'z'; "
         "did you mean 'setpoint.position[1]'? (signals: setpoint.position[1], v)"),
    ],
)  # fmt: skip
def test_a_missing_recorded_name_names_both(spec, data, message):
    for each in (data, pd.DataFrame(data)):
        with pytest.raises(TraceError) as caught:
            spec.evaluate(each)
        assert str(caught.value) == message
    with pytest.raises(TraceError) as caught:
        spec.evaluate(rtamt.read(data))
    assert str(caught.value) == message.replace("the data", "a dict")
    with pytest.raises(TraceError) as caught:
        rtamt.read(data, columns=spec.input_names, names=spec.recorded)
    assert "no column 'setpoint.position[2]', the recorded name of 'z'" in str(caught.value)


def test_a_chunk_of_dense_time_need_not_have_every_variable(spec):
    monitor = spec.monitor(time="dense")
    monitor.update_many({COLUMN: ([0.0], [1])})
    assert monitor.update_many({"v": ([0.0], [3])}).values.tolist() == [2.0]


def test_a_message_is_bound_to_its_topic_and_fields_follow():
    text = 'from nav_msgs.msg import Odometry  input Odometry odom = "/base/odom"; always(odom.pose.x <= 3)'
    spec = rtamt.parse(text)
    assert dict(spec.document.topics) == {"odom": "/base/odom"}
    assert dict(spec.recorded) == {}
    fields = rtamt.parse('float odom = "state"; odom.x <= 3')
    assert dict(fields.recorded) == {"odom.x": "state.x"}
    assert fields.evaluate({"state.x": [1]}).robustness == 2.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("float z = 3; z > 1", "a variable has no value of its own; define it after the declarations: z = ..., or give "
         'its recorded name in quotes: z = "..."'),
        ('float z = " "; z > 1', "a recorded name is one line of visible characters"),
        ('float z = "a" [m]; z > 1', 'the unit stands before the recorded name: z [...] = "a"'),
        ('const float z = "a"; z > 1', "expected a number, got '\"a\"'"),
    ],
)  # fmt: skip
def test_messages(text, message):
    with pytest.raises(ParseError) as caught:
        rtamt.parse(text)
    assert caught.value.message == message


def test_types_and_units_of_a_bound_variable():
    spec = rtamt.parse(
        'enum Mode { MANUAL, AUTO } input Mode mode = "nav[0]"  input bool armed = "arm"; mode == AUTO and armed'
    )
    assert spec.evaluate({"nav[0]": [1, 0], "arm": [1, 1]}).satisfied
    assert np.isinf(spec.evaluate({"nav[0]": [0], "arm": [1]}).robustness)
