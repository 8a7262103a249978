"""Monitor specifications on ROS topics; no module needs a ROS installation.

The nodes are thin: they pass messages to :class:`~rtamt.ros.monitor.RosMonitor` and publish its output. They are
part of the ROS packages, in the directory ``ros/``.

===================  ===============================================================================
module               purpose
===================  ===============================================================================
binding              annotations of a specification to topics, types and fields
fields               read a number from a message: ``pose.position.x``, ``ranges[3]``; its timestamp
monitor              messages and ticks to robustness, verdicts and conditions
group                what is monitored together: its samples, and what is reported of it
output_group         outputs whose robustness is reported
early_group          outputs that are monitored before their horizon
groups               the groups of each time domain
diagnostics          conditions as ROS diagnostics
metrics              metrics of a node, from its records
publisher            output as messages
message_definitions  the definitions of ``rtamt_msgs``
bags                 columns of a bag; a copy of a bag with added results
recording_times      when messages of a bag were recorded, by the timestamps in their headers
dds                  ROS 2 nodes directly on Cyclone DDS
options              the arguments of all nodes
===================  ===============================================================================
"""

from rtamt.ros.binding import Binding, Input, MessageType, Output, bind
from rtamt.ros.monitor import Bounds, Robustness, RosMonitor, Verdict

__all__ = [
    "Binding",
    "Bounds",
    "Input",
    "MessageType",
    "Output",
    "Robustness",
    "RosMonitor",
    "Verdict",
    "bind",
]
