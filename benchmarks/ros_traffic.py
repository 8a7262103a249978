"""The traffic generator of ros_bench.py, and a node that only relays messages; needs a Python with rospy.

ros_traffic.py drive TOPICS RATE SECONDS PID    one JSON object: latencies, and what was lost
ros_traffic.py relay TOPICS                     each message of /bench/x again on so many topics
"""

from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path

import rospy
from rtamt_msgs.msg import FloatStamped

QUEUE = 100  # as the node's


def drive(topics: int, rate: float, seconds: float, pid: int) -> None:
    """Talk for some seconds, and print what was heard."""
    rospy.init_node("bench", anonymous=True, disable_signals=True)
    heard: dict[str, dict[int, float]] = {}

    def listen(message: FloatStamped, topic: str) -> None:
        heard[topic].setdefault(message.header.stamp.to_nsec(), time.time())

    listeners = []
    for i in range(topics):
        topic = f"/bench/rob{i}"
        heard[topic] = {}
        listeners.append(rospy.Subscriber(topic, FloatStamped, listen, topic, tcp_nodelay=True))
    talker = rospy.Publisher("/bench/x", FloatStamped, queue_size=1000, tcp_nodelay=True)
    while talker.get_num_connections() < 1 or any(known.get_num_connections() < 1 for known in listeners):
        time.sleep(0.1)
    # A subscriber sees a connection before the publisher does.
    start, sent, before = time.time() + 2.0, [], cpu(pid)
    for i in range(int(rate * seconds)):
        time.sleep(max(0.0, start + i / rate - time.time()))
        message = FloatStamped(value=float(i % 9))
        message.header.stamp = rospy.Time.from_sec(time.time())
        sent.append(message.header.stamp.to_nsec())
        talker.publish(message)
    time.sleep(2.0)
    used = cpu(pid) - before
    late = sorted(
        (told[stamp] - stamp / 1e9) * 1000 for told in heard.values() for stamp in sent if stamp in told
    )
    print(
        json.dumps(
            {
                "answers": len(sent) * topics,
                "lost": len(sent) * topics - len(late),
                "median": late[len(late) // 2],
                "p99": late[int(len(late) * 0.99)],
                "most": late[-1],
                "cpu": used / len(sent) * 1000,
            }
        )
    )


def cpu(pid: int) -> float:
    """Return the seconds of a core that a process has used."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def relay(topics: int) -> None:
    """Publish every message again: what rospy alone costs."""
    rospy.init_node("relay", anonymous=True)
    publishers = [
        rospy.Publisher(f"/bench/rob{i}", FloatStamped, queue_size=QUEUE, tcp_nodelay=True)
        for i in range(topics)
    ]

    def again(message: FloatStamped) -> None:
        for publisher in publishers:
            if publisher.get_num_connections():
                told = FloatStamped(value=message.value)
                told.header.stamp = message.header.stamp
                publisher.publish(told)

    rospy.Subscriber("/bench/x", FloatStamped, again, tcp_nodelay=True)
    rospy.spin()


if __name__ == "__main__":
    if sys.argv[1] == "drive":
        drive(int(sys.argv[2]), float(sys.argv[3]), float(sys.argv[4]), int(sys.argv[5]))
    else:
        relay(int(sys.argv[2]))
