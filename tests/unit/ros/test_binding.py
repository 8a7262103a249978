"""What binds topics and fields to variables, and what cannot be bound."""

from __future__ import annotations

import pytest

import rtamt
from rtamt.errors import BoundError, UsageError
from rtamt.ros import RosMonitor, bind
from tests.unit.ros.messages import monitor, numbers


@pytest.mark.parametrize(("settings", "verdict"), [({"time": "dense"}, "delayed"), ({}, "delayed")])
def test_unbounded_future_is_refused_with_the_place(settings, verdict):
    with pytest.raises(BoundError) as caught:
        monitor("rob.value = always(req.value >= 0)", verdict=verdict, **settings)
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
