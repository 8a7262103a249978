"""``rtamt diff``: a trace on which two versions of a specification disagree."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.analysis import diff
from rtamt.cli.command import add_specification_options, add_time_option, read_specifications
from rtamt.cli.conclusions import add_analysis_options, show

if TYPE_CHECKING:
    import argparse

_DESCRIPTION = """\
Compare two versions of a specification, requirement by requirement: a solver looks for a trace that one version
satisfies and the other violates, and the engine evaluates it. Requirements are matched by their names. Requires z3:
pip install 'rtamt[analysis]'.

Exit code: 0 no difference up to N samples, 1 a difference, 2 an error or a requirement without an answer."""

_EPILOG = """\
Traces stay in the ranges and rates that the new version declares.

examples:
  rtamt diff "always(x >= 3)" "always(x > 3)" --samples 20"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_specification_options(parser)
    parser.add_argument("new", metavar="NEW", help="the new version")
    add_time_option(parser)
    add_analysis_options(parser)


def run(args: argparse.Namespace) -> int:
    """Compare the two versions."""
    old, new = read_specifications(args, args.time, [args.spec, args.new])
    found = diff(old, new, samples=args.samples, limit=args.limit)
    return show(f"{args.spec} -> {args.new}", found, args)
