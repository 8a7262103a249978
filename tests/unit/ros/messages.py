"""Messages made of plain objects, and what a monitor reports of them."""

from __future__ import annotations

from types import SimpleNamespace

import rtamt
from rtamt.ros import Robustness, RosMonitor, bind

SECOND = 10**9
#: What is said of messages that arrive at 0, which is a simulated clock that nobody has set.
NO_CLOCK = "simulated time has not begun: no node publishes /clock"
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


def monitor(formula, verdict=None, at=None, **settings):
    if settings.get("time") != "dense":
        settings = {"period": 1, **settings}
    return RosMonitor(bind(rtamt.parse(HEAD + formula), verdict, at), **settings)


def numbers(records):
    return [(record.stamp / SECOND, record.value) for record in records if isinstance(record, Robustness)]


def log_of(watched):
    return [notice.message for notice in watched.notices()]
