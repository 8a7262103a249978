"""Robots: a specification file in, live robustness topics out. Nothing in here needs ROS to be tested.

===========  ==========================================================================
module       what it holds
===========  ==========================================================================
binding      from the annotations of a specification to topics, types and fields
fields       a number in a message: ``pose.position.x``, ``ranges[3]``; its time stamp
monitor      messages and ticks in; robustness, verdicts and conditions out
report       what is wrong, in the words of ROS's diagnostics
outbox       what comes out, as messages
messages     the definitions of our own messages
bags         which column of a bag a variable is; a bag written anew with what was found
dds          ROS 2 on Cyclone DDS alone
options      the arguments that every node takes
===========  ==========================================================================

The nodes are thin: they carry messages to :class:`~rtamt.ros.monitor.RosMonitor` and publish what comes
out. They live with the ROS packages, in the directory ``ros/``.
"""

from rtamt.ros.binding import Binding, Input, MessageType, Output, bind
from rtamt.ros.monitor import Robustness, RosMonitor, Verdict

__all__ = ["Binding", "Input", "MessageType", "Output", "Robustness", "RosMonitor", "Verdict", "bind"]
