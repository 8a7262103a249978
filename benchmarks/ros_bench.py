"""Monitors in one ROS 1 node on one core, a message each 10 ms: samples lost, latency.

    benchmarks/ros_bench.py [--monitors 200] [--rate 100] [--seconds 10]

One topic of messages, one requirement for each monitor, each with a topic of its own, in dense time, so that every
message is a sample and is answered at once. A talker publishes at the rate; a listener takes the stamps of
what a tenth of the monitors publish and the time at which it hears them, the talker's process and its own included.
The node runs on one core. Needs ROS 1 with rtamt_msgs and rtamt4ros built and sourced, and a master.
"""

from __future__ import annotations

import argparse
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import rospy
from rtamt_msgs.msg import FloatStamped

HEARD = 10  # one in so many monitors has a listener


def specification(monitors: int) -> str:
    """Return a requirement for each monitor, each with its own threshold and topic."""
    names = [f"rob{i}" for i in range(monitors)]
    lines = ["specification bench", "from rtamt_msgs.msg import FloatStamped", "input FloatStamped x"]
    lines += [f"output FloatStamped {name}" for name in names]
    lines += ["@ topic(x, /bench/x)", *(f"@ topic({name}, /bench/{name})" for name in names)]
    formula = "always[0,1]((x.value >= {low}) -> eventually[0,500ms](x.value <= {high}))"
    lines += [f"{name}.value = {formula.format(low=i % 7, high=i % 5)};" for i, name in enumerate(names)]
    return "\n".join(lines)


def main() -> None:
    """Run node, talker and listener; print what came of it."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--monitors", type=int, default=200)
    parser.add_argument("--rate", type=float, default=100.0)
    parser.add_argument("--seconds", type=float, default=10.0)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        spec = Path(folder, "bench.stl")
        spec.write_text(specification(args.monitors), encoding="utf-8")
        command = ["rosrun", "rtamt4ros", "ros_stl_monitor.py", str(spec), "--time", "dense"]
        if shutil.which("taskset"):
            command = ["taskset", "-c", "0", *command]
        node = subprocess.Popen(command)
        try:
            measure(args.monitors, args.rate, args.seconds, node.pid)
        finally:
            node.terminate()
            node.wait()


def measure(monitors: int, rate: float, seconds: float, pid: int) -> None:
    """Talk for some seconds, and print what was heard."""
    rospy.init_node("bench", anonymous=True, disable_signals=True)
    heard: dict[str, dict[int, float]] = {}

    def listen(message: FloatStamped, topic: str) -> None:
        heard[topic].setdefault(message.header.stamp.to_nsec(), time.time())

    for i in range(0, monitors, HEARD):
        topic = f"/bench/rob{i}"
        heard[topic] = {}
        rospy.Subscriber(topic, FloatStamped, listen, topic, tcp_nodelay=True)
    talker = rospy.Publisher("/bench/x", FloatStamped, queue_size=1000, tcp_nodelay=True)
    while talker.get_num_connections() < 1:
        time.sleep(0.1)
    time.sleep(3.0)  # until the listener is connected to every topic
    start, sent, before = time.time(), [], cpu(pid)
    for i in range(int(rate * seconds)):
        time.sleep(max(0.0, start + i / rate - time.time()))
        message = FloatStamped(value=float(i % 9))
        message.header.stamp = rospy.Time.from_sec(time.time())
        sent.append(message.header.stamp.to_nsec())
        talker.publish(message)
    time.sleep(2.0)
    used = cpu(pid) - before
    lost = sum(stamp not in told for told in heard.values() for stamp in sent)
    late = sorted(
        (told[stamp] - stamp / 1e9) * 1000 for told in heard.values() for stamp in sent if stamp in told
    )
    print(
        f"{monitors} monitors, {len(sent)} messages at {rate:g} Hz: {lost} of {len(sent) * len(heard)} answers lost"
    )
    print(
        f"latency from stamp to robustness: median {statistics.median(late):.3g} ms, "
        f"99 % {late[int(len(late) * 0.99)]:.3g} ms, most {late[-1]:.3g} ms"
    )
    print(f"the node used {100 * used / seconds:.0f} % of a core")


def cpu(pid: int) -> float:
    """Return the seconds of a core that a process has used."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


if __name__ == "__main__":
    sys.exit(main())
