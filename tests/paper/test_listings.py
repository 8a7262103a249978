"""The paper's listings 3 to 8 run: its monitor over ROS messages, where ROS is a few small doubles."""

from __future__ import annotations

import copy
import sys
from dataclasses import dataclass, field
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

import rtamt


@dataclass
class Header:
    """What ROS calls a header."""

    seq: int = 0
    stamp: float = 0.0


@dataclass
class FloatStamped:
    """The message type of the paper's example."""

    header: Header = field(default_factory=Header)
    value: float = 0.0

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        """Return what makes this a message class for the imports of listing 8."""
        return {"header": "std_msgs/Header", "value": "double"}


class World:
    """A double of rospy: a clock, topics, and a loop that ends when the traces do."""

    def __init__(self, traces: dict[str, list[float]]) -> None:
        self.traces = traces
        self.ticks = 0
        self.node = ""
        self.frequency = 0.0
        self.subscribed: dict[str, tuple[type, Any, Any]] = {}
        self.published: list[FloatStamped] = []
        self.topic_of_output = ""
        self.type_of_output: type | None = None
        self.Time = SimpleNamespace(now=lambda: 1000.0 + self.ticks)

    def init_node(self, name: str, anonymous: bool) -> None:
        assert anonymous
        self.node = name

    def Publisher(self, topic: str, cls: type, queue_size: int) -> Any:  # noqa: N802 - rospy's name
        assert queue_size == 10
        self.topic_of_output, self.type_of_output = topic, cls
        return SimpleNamespace(publish=lambda message: self.published.append(copy.deepcopy(message)))

    def Subscriber(self, topic: str, cls: type, callback: Any, args: Any) -> None:  # noqa: N802 - the same
        self.subscribed[topic] = (cls, callback, args)

    def Rate(self, frequency: float) -> Any:  # noqa: N802 - the same
        self.frequency = frequency
        self.deliver()
        return SimpleNamespace(sleep=self.tick)

    def is_shutdown(self) -> bool:
        return any(self.ticks >= len(trace) for trace in self.traces.values())

    def tick(self) -> None:
        self.ticks += 1
        self.deliver()

    def deliver(self) -> None:
        for topic, trace in self.traces.items():
            if self.ticks < len(trace) and topic in self.subscribed:
                cls, callback, args = self.subscribed[topic]
                message = cls()
                message.value = trace[self.ticks]
                callback(message, args)


@pytest.fixture(autouse=True)
def messages(monkeypatch):
    """Make ``from rtamt_msgs.msg import FloatStamped`` work."""
    module = ModuleType("rtamt_msgs.msg")
    module.FloatStamped = FloatStamped
    monkeypatch.setitem(sys.modules, "rtamt_msgs", ModuleType("rtamt_msgs"))
    monkeypatch.setitem(sys.modules, "rtamt_msgs.msg", module)


# ---- the listings, as printed; `rospy` is the double -------------------------------------------------
# fmt: off

rospy: Any = None


def monitor(period, unit):  # listing 3
    # Init STL SPEC
    spec = init_spec(period, unit)
    # Init ROS node
    rospy.init_node(spec.name, anonymous=True)
    # Init subscriber and publisher
    pub = sub_and_pub(spec)
    # Set monitoring frequency
    rate = rospy.Rate(spec.get_sampling_frequency())
    # Control loop
    time_index = 0
    while not rospy.is_shutdown():
        rob_msg = mon_update(spec, time_index)
        pub.publish(rob_msg)
        time_index += 1

        # Wait until next evaluation
        rate.sleep()


def callback(data, args):  # listing 4
    spec = args[0]
    var_name = args[1]

    var = copy.deepcopy(data)
    spec.var_object_dict[var_name] = var


def init_spec(period, unit):  # listing 5
    spec = rtamt.StlDiscreteTimeOnlineSpecificationCpp()
    spec.set_sampling_period(period, unit)

    spec.name = 'HandMadeMonitor'
    spec.import_module('rtamt_msgs.msg', 'FloatStamped')
    spec.declare_var('req', 'FloatStamped')
    spec.declare_var('gnt', 'FloatStamped')
    spec.declare_var('rob', 'FloatStamped')
    spec.set_var_topic('req', 'rtamt/req')
    spec.set_var_topic('gnt', 'rtamt/gnt')
    spec.set_var_topic('rob', 'rtamt/gnt')
    spec.spec = \
        'rob.value = G[0,10]((req.value>=3)->(F[0,5](gnt.value>=3)))'

    try:
        spec.parse()
        spec.pastify()
    except rtamt.STLParseException as err:  # noqa: F841 - as printed
        sys.exit()
    return spec


def sub_and_pub(spec):  # listing 6
    # Publish STL output var (robustness)
    topic = spec.var_topic_dict[spec.out_var]
    out = spec.get_value(spec.out_var)
    pub = rospy.Publisher(topic, out.__class__, queue_size=10)

    # Subscribe STL input vars
    for var_name in spec.free_vars:
        var_object = spec.get_value(var_name)
        topic = spec.var_topic_dict[var_name]
        rospy.Subscriber(topic, var_object.__class__, callback, [spec, var_name])

    return pub


def mon_update(spec, time_index):  # listing 7
    var_name_object_list = []
    for var_name in spec.free_vars:
        var_name_object = (var_name, spec.get_value(var_name))
        var_name_object_list.append(var_name_object)

    # Update the monitor
    # spec.update is of the form
    # spec.update(time_index,[('a',aObj),...)])
    rob_msg = spec.update(time_index, var_name_object_list)

    rob_msg.header.seq = time_index
    rob_msg.header.stamp = rospy.Time.now()

    return rob_msg


SPEC_STL = """\
// name
specification spec_x

// imports
from rtamt_msgs.msg import FloatStamped

// variable declarations
input FloatStamped req
output FloatStamped gnt
output FloatStamped rob

// annotations
@ topic(req, rtamt/req)
@ topic(gnt, rtamt/gnt)
@ topic(rob, rtamt/rob)

// bfSTL property
rob.value = G[0,10]((req.value>=3)->(F[0,5](gnt.value>=3)))
"""  # listing 8

# fmt: on
# ---- what they give ----------------------------------------------------------------------------------

N = 40
REQ = [6.0 if 12 <= t < 14 else 0.0 for t in range(N)]
GNT = [5.0 if t == 18 else 0.0 for t in range(N)]


def expected_by_definition() -> list[float]:
    """Return ρ of G[0,10](req >= 3 -> F[0,5](gnt >= 3)) at t - 15, for each t from 15 on."""

    def grant_follows(t: int) -> float:
        return max(-(REQ[t] - 3), *(GNT[u] - 3 for u in range(t, t + 6)))

    return [min(grant_follows(t) for t in range(now - 15, now - 4)) for now in range(15, N)]


def test_listings_3_to_7_run_the_monitor(monkeypatch):
    world = World({"rtamt/req": REQ, "rtamt/gnt": GNT})
    monkeypatch.setattr(sys.modules[__name__], "rospy", world)

    monitor(1, "s")

    assert world.node == "HandMadeMonitor"
    assert world.frequency == 1.0
    assert (world.topic_of_output, world.type_of_output) == ("rtamt/gnt", FloatStamped)
    assert {topic: entry[0] for topic, entry in world.subscribed.items()} == {
        "rtamt/req": FloatStamped,
        "rtamt/gnt": FloatStamped,
    }
    assert [message.header.seq for message in world.published] == list(range(N))
    assert [message.header.stamp for message in world.published] == [1000.0 + t for t in range(N)]
    assert [message.value for message in world.published[15:]] == expected_by_definition()
    assert {2.0, 3.0} <= set(expected_by_definition())  # a request that was granted, and none at all


def test_listing_5_leaves_the_program_when_the_text_is_wrong(monkeypatch):
    real = rtamt.StlDiscreteTimeOnlineSpecificationCpp.parse

    def spoil(spec):
        spec.spec += ")"
        real(spec)

    monkeypatch.setattr(rtamt.StlDiscreteTimeOnlineSpecificationCpp, "parse", spoil)
    with pytest.raises(SystemExit):
        init_spec(1, "s")


def test_listing_7_returns_the_declared_message_each_time(monkeypatch):
    world = World({})
    monkeypatch.setattr(sys.modules[__name__], "rospy", world)
    spec = init_spec(1, "s")
    first = mon_update(spec, 0)
    assert mon_update(spec, 1) is first
    assert spec.get_value("rob") is first
    assert (first.header.seq, first.header.stamp) == (1, 1000.0)


def test_listing_8_says_the_same_as_listing_5(tmp_path):
    path = tmp_path / "spec.stl"
    path.write_text(SPEC_STL)
    spec = rtamt.StlDiscreteTimeOnlineSpecificationCpp()
    spec.spec = spec.get_spec_from_file(path)
    spec.parse()
    spec.pastify()

    by_hand = init_spec(1, "s")
    assert spec.name == "spec_x"
    assert spec.spec_print() == by_hand.spec_print()
    assert spec.var_topic_dict == {"req": "rtamt/req", "gnt": "rtamt/gnt", "rob": "rtamt/rob"}
    assert (spec.out_var, spec.out_var_field) == ("rob", "value")
    assert spec.free_vars == {"req", "gnt"}
    for t in range(N):
        pairs = [("req", FloatStamped(value=REQ[t])), ("gnt", FloatStamped(value=GNT[t]))]
        assert spec.update(t, pairs).value == by_hand.update(t, pairs).value


def test_the_online_example_of_section_2_in_discrete_time():
    # Listings 1 and 2 are dense; the same requirement over samples is 3 where the request was granted.
    spec = rtamt.StlDiscreteTimeSpecification()
    spec.declare_var("req", "float")
    spec.declare_var("gnt", "float")
    spec.spec = "G[0,10]((req>=3)->(F[0,5](gnt>=3)))"
    spec.parse()
    spec.pastify()
    assert spec.spec_print() == "historically[0,10]((once[5,5]((req)>=(3.0)))->(once[0,5]((gnt)>=(3.0))))"
    req = [0.0, 0.0, 6.0, 0.0] + [0.0] * 16
    gnt = [0.0] * 6 + [6.0, 6.0] + [0.0] * 12
    rho = [spec.update(t, [("req", req[t]), ("gnt", gnt[t])]) for t in range(20)]
    assert rho[15:] == [3.0] * 5
