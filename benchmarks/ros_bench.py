"""Monitors in one ROS 1 node on one core, a message each 10 ms: samples lost, latency; `make bench-ros`.

    benchmarks/ros_bench.py [--monitors 200] [--rate 100] [--seconds 10] [--heard 1 20] [--output FILE]

One topic of messages, one requirement for each monitor, each with a topic of its own, in dense time, so that every
message is a sample and is answered at once. A talker publishes at the rate and takes the time at which it hears
the robustness on some of the topics; its own process, which is Python too, is part of the latency. Beside it a
node that monitors nothing and publishes each message again on as many topics: what rospy alone costs.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from tests.integration.ros.processes import free_port  # noqa: E402 - found in the path set above
from tests.integration.ros.workspace import build, missing  # noqa: E402 - found in the path set above

HEADER = """\
| node | topics heard | answers | lost | median (ms) | 99 % (ms) | most (ms) | node's processor time a message (ms) |
|---|---|---|---|---|---|---|---|"""


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
    """Run node, talker and listener for every number of topics; print a table, and write it."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--monitors", type=int, default=200)
    parser.add_argument("--rate", type=float, default=100.0)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--heard", type=int, nargs="+", default=[1, 20])
    parser.add_argument("--output", type=Path, help="where the table is written as well")
    args = parser.parse_args()
    if missing():
        sys.exit(f"ROS 1 is not installed ({', '.join(missing())}); `make test` installs it where it may")
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        env = build(home)
        port = free_port()
        env |= {"ROS_MASTER_URI": f"http://127.0.0.1:{port}", "ROS_LOG_DIR": str(home / "log")}
        (home / "bench.stl").write_text(specification(args.monitors), encoding="utf-8")
        monitor = ["rosrun", "rtamt4ros", "ros_stl_monitor.py", str(home / "bench.stl"), "--time", "dense"]
        traffic = [env["RTAMT_PYTHON"], str(HERE / "ros_traffic.py")]
        core = ["rosmaster", "--core", "-p", str(port)]
        master = subprocess.Popen(core, env=env, stdout=subprocess.DEVNULL)
        lines = [
            f"# {args.monitors} monitors in one ROS 1 node on one core, {args.rate:g} messages a second",
            "",
            f"Latency from the timestamp of a message to the robustness at a subscriber, {args.seconds:g} s each; "
            f"load before it {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors.",
            "",
            HEADER,
        ]
        print("\n".join(lines), flush=True)
        try:
            for topics in args.heard:
                drive = [*traffic, "drive", str(topics), str(args.rate), str(args.seconds)]
                for name, node in (("monitors", monitor), ("rospy alone", [*traffic, "relay", str(topics)])):
                    lines.append(row(name, topics, measured(node, drive, env)))
                    print(lines[-1], flush=True)
        finally:
            master.terminate()
            master.wait()
        if args.output is not None:
            args.output.write_text("\n".join(lines) + "\n", encoding="utf-8")


def measured(node: list[str], drive: list[str], env: dict[str, str]) -> dict[str, Any]:
    """Run a node and its traffic generator on one core; return the measurements."""
    pinned = ["taskset", "-c", "0", *node]
    process = subprocess.Popen(pinned, env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        time.sleep(3.0)  # until it is there
        told = subprocess.run([*drive, str(process.pid)], env=env, capture_output=True, text=True, check=True)
    finally:
        process.terminate()
        process.wait()
    found: dict[str, Any] = json.loads(told.stdout)
    return found


def row(name: str, topics: int, told: dict[str, Any]) -> str:
    """Return a row of the table."""
    times = " | ".join(f"{told[key]:.3g}" for key in ("median", "p99", "most", "cpu"))
    return f"| {name} | {topics} | {told['answers']} | {told['lost']} | {times} |"


if __name__ == "__main__":
    main()
