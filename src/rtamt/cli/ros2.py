"""``rtamt ros2``: monitor a specification on ROS 2 topics, without a ROS installation."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from rtamt.cli.parser import OK
from rtamt.cli.terminal import say

if TYPE_CHECKING:
    import argparse

_DESCRIPTION = """\
Monitor a specification on ROS 2 topics, and publish its robustness and verdicts. The node runs on
Cyclone DDS, without an installation of ROS. 'ros2 node list' and 'ros2 topic list' show it."""

_EPILOG = """\
SPEC declares the topics that are read and written, and their types (the paper's listing 8). Verdicts are published
on the topic of the robustness with the suffix '/verdict', the state of every output on /diagnostics.
ROS_DOMAIN_ID selects the domain, CYCLONEDDS_URI the network, ROS_DISTRO the distribution.

examples:
  rtamt ros2 spec.stl --period 1 --unit s
  rtamt ros2 spec.stl --time dense --reliability best_effort --messages ~/workspace/src"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    from rtamt.ros.options import add_options

    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_options(parser)
    parser.add_argument("--node", metavar="NAME", help="the node's name (default: the specification's)")
    parser.add_argument(
        "--reliability",
        default="reliable",
        metavar="{reliable,best_effort}",
        help="of subscriptions; best_effort is compatible with every publisher (default: reliable)",
    )
    parser.add_argument(
        "--durability",
        default="volatile",
        metavar="{volatile,transient_local}",
        help="transient_local also receives messages published earlier (default: volatile)",
    )
    parser.add_argument(
        "--depth", type=int, default=100, metavar="N", help="messages kept for a slow reader (default: 100)"
    )
    parser.add_argument("--sim-time", action="store_true", help="use the time published on /clock")
    parser.add_argument(
        "--distro", metavar="NAME", help="the ROS 2 distribution, such as humble (default: jazzy)"
    )
    parser.add_argument(
        "--messages",
        action="append",
        default=[],
        metavar="FOLDER",
        help="a folder with packages of custom message definitions; repeatable",
    )


def run(args: argparse.Namespace) -> int:
    """Monitor until the node is terminated."""
    from rtamt.metrics import exported
    from rtamt.ros.dds.node import Node
    from rtamt.ros.dds.participant import Participant, Quality
    from rtamt.ros.dds.types import Types
    from rtamt.ros.options import options

    quality = Quality(args.reliability, args.durability, args.depth)
    monitor = options(args, {}).monitor()
    types = Types(args.distro, args.messages)
    monitor.binding.check(types.load)
    participant = Participant(args.node or monitor.binding.name, types, quality)
    with exported(args) as metrics:
        node = Node(monitor, participant, types, simulated=args.sim_time, metrics=metrics)
        for output in monitor.binding.outputs:
            say(
                f"{output.name} on {output.topic}: {output.specification.formula}",
                file=sys.stderr,
                flush=True,
            )
        node.run()
    return OK
