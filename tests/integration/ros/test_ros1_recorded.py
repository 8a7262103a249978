"""What rosbag records is checked and played to the node; the paper's listings 3 to 7 run as a script."""

from __future__ import annotations

import rtamt
from tests.integration.ros.processes import PATIENCE
from tests.integration.ros.test_ros1 import FLOAT, LISTING_8, SECOND, publish, puppet, wait_for_connection

__all__ = ["puppet"]

#: Listings 3 to 7 of the paper, in the order in which Python needs them; the robustness has a topic of its own.
SCRIPT = """
import copy
import sys

import rospy
import rtamt


def init_spec(period, unit):
    spec = rtamt.StlDiscreteTimeOnlineSpecificationCpp()
    spec.set_sampling_period(period, unit)
    spec.name = 'HandMadeMonitor'
    spec.import_module('rtamt_msgs.msg', 'FloatStamped')
    spec.declare_var('req', 'FloatStamped')
    spec.declare_var('gnt', 'FloatStamped')
    spec.declare_var('rob', 'FloatStamped')
    spec.set_var_topic('req', 'rtamt/req')
    spec.set_var_topic('gnt', 'rtamt/gnt')
    spec.set_var_topic('rob', 'rtamt/rob')
    spec.spec = 'rob.value = G[0,10]((req.value>=3)->(F[0,5](gnt.value>=3)))'
    try:
        spec.parse()
        spec.pastify()
    except rtamt.STLParseException as err:
        sys.exit()
    return spec


def callback(data, args):
    spec = args[0]
    var_name = args[1]
    var = copy.deepcopy(data)
    spec.var_object_dict[var_name] = var


def sub_and_pub(spec):
    topic = spec.var_topic_dict[spec.out_var]
    out = spec.get_value(spec.out_var)
    pub = rospy.Publisher(topic, out.__class__, queue_size=10)
    for var_name in spec.free_vars:
        var_object = spec.get_value(var_name)
        topic = spec.var_topic_dict[var_name]
        rospy.Subscriber(topic, var_object.__class__, callback, [spec, var_name])
    return pub


def mon_update(spec, time_index):
    var_name_object_list = []
    for var_name in spec.free_vars:
        var_name_object = (var_name, spec.get_value(var_name))
        var_name_object_list.append(var_name_object)
    rob_msg = spec.update(time_index, var_name_object_list)
    rob_msg.header.seq = time_index
    rob_msg.header.stamp = rospy.Time.now()
    return rob_msg


def monitor(period, unit):
    spec = init_spec(period, unit)
    rospy.init_node(spec.name, anonymous=True)
    pub = sub_and_pub(spec)
    rate = rospy.Rate(spec.get_sampling_frequency())
    time_index = 0
    while not rospy.is_shutdown():
        rob_msg = mon_update(spec, time_index)
        pub.publish(rob_msg)
        time_index += 1
        rate.sleep()


monitor(1, 's')
"""


def test_what_rosbag_records_is_checked_and_played_to_the_node(ros, puppet):
    # It ends by itself when it has so many messages of each topic.
    recorder = ros.start("rosbag", "record", "--limit=20", "-O", "drive.bag", "/rtamt/req", "/rtamt/gnt")
    wait_for_connection(puppet, "rtamt/req", "rtamt/gnt")
    for i in range(20):
        publish(puppet, "rtamt/req", 5.0 if i in {2, 9} else 0.0, stamp=(100 + i) * SECOND)
        publish(puppet, "rtamt/gnt", 4.0 if i == 5 else 0.0, stamp=(100 + i) * SECOND)
    bag = ros.folder / "drive.bag"
    assert recorder.popen.wait(PATIENCE) == 0, recorder.output
    trace = rtamt.read(bag, columns=["/rtamt/req.value", "/rtamt/gnt.value"])
    assert trace["/rtamt/req.value"].times.tolist() == list(range(100, 120))
    trace = trace.rename({"req.value": "/rtamt/req.value", "gnt.value": "/rtamt/gnt.value"})
    offline = rtamt.parse(LISTING_8, time="dense").evaluate(trace)
    assert (offline.robustness, offline.satisfied) == (-2, False)

    node = ros.monitor(LISTING_8, "--time", "dense", "--stale", "0")
    wait_for_connection(puppet, "rtamt/req", "rtamt/gnt", "rtamt/rob")
    # Alive past its end, so that nothing is lost that is still on its way.
    ros.start("rosbag", "play", "--wait-for-subscribers", "--keep-alive", "-r", "100", "drive.bag")
    heard = puppet.wait_for(
        "rtamt/rob", lambda messages: bool(messages) and messages[-1]["header"]["stamp"] == 119 * SECOND
    )
    assert min(message["value"] for message in heard) == -2
    assert "anew" not in node.output


def test_listings_3_to_7_of_the_paper_run_as_a_script(ros, puppet):
    (ros.folder / "monitor.py").write_text(SCRIPT)
    ros.start(ros.env["RTAMT_PYTHON"], "monitor.py")
    wait_for_connection(puppet, "rtamt/req", "rtamt/gnt", "rtamt/rob")
    publish(puppet, "rtamt/req", 5.0)
    publish(puppet, "rtamt/gnt", 1.0)
    # A request is out five samples later: the grant is 2 short.
    heard = puppet.wait_for("rtamt/rob", lambda messages: any(m["value"] == -2 for m in messages))
    timestamps = [message["header"]["stamp"] for message in heard]
    assert timestamps == sorted(timestamps)
    assert FLOAT in ros.run("rostopic", "info", "rtamt/rob").stdout
