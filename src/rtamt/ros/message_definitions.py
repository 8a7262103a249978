"""The message definitions of ``rtamt_msgs``, for programs without ROS."""

from __future__ import annotations

from types import MappingProxyType

FLOAT_STAMPED = "rtamt_msgs/msg/FloatStamped"
VERDICT = "rtamt_msgs/msg/Verdict"
BOUNDS = "rtamt_msgs/msg/Bounds"

#: The values of ``Verdict.verdict`` and ``Bounds.verdict``.
UNKNOWN, SATISFIED, VIOLATED = 0, 1, 2

#: From a type to its definition, equal to the files in ``ros/rtamt_msgs/msg``.
DEFINITIONS = MappingProxyType(
    {
        FLOAT_STAMPED: """\
# A number with the time at which it held: inputs of specifications, and their robustness.
std_msgs/Header header
float64 value
""",
        VERDICT: """\
# Whether a requirement held at the instant header.stamp - horizon.
uint8 UNKNOWN=0    # that instant lies before the first sample
uint8 SATISFIED=1
uint8 VIOLATED=2

std_msgs/Header header
string name        # of the requirement in its specification, such as rob.value
uint8 verdict
float64 horizon    # seconds
""",
        BOUNDS: """\
# What is known at header.stamp of a requirement from begin to end: its robustness and its verdict.
uint8 OPEN=0
uint8 SATISFIED=1
uint8 VIOLATED=2

std_msgs/Header header
string name        # of the requirement in its specification, such as rob.value
float64 lower      # bounds of the robustness, valid for every continuation
float64 upper
uint8 verdict
int64 decided_at   # nanoseconds, as header.stamp: the sample that decided the verdict; 0 while it is open
int64 begin        # nanoseconds: the first instant; of the start of the trace, that alone
int64 end          # nanoseconds: the last sample; in dense time this instant is excluded
""",
    }
)
