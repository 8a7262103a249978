"""``rtamt analyze``: requirements that never hold, always hold, contradict or repeat others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import rtamt
from rtamt.analysis import NotCoveredError, analyze
from rtamt.cli.arguments import specification_paths
from rtamt.cli.command import CommandError, add_specification_options, add_time_option, read_specifications
from rtamt.cli.conclusions import add_analysis_options, show
from rtamt.cli.parser import ERROR, complain
from rtamt.errors import StlError

if TYPE_CHECKING:
    import argparse
    from collections.abc import Mapping
    from typing import Any

_DESCRIPTION = """\
Analyse requirements without a recording: a solver looks for traces that satisfy or violate them. A finding is a
requirement that no trace satisfies or that every trace satisfies, requirements that contradict each other, one that the
others imply, and an implication whose condition is never true. The engine evaluates each trace that the solver finds.
Requires z3: pip install 'rtamt[analysis]'.

Exit code: 0 no finding, 1 a finding, 2 an error, a query without an answer, or no requirement that is covered."""

_EPILOG = """\
Traces have 1 to N samples, and stay in the ranges and rates that the specification declares:

  input float speed [m/s] in [0, 60] rate [-8, 3]

Nonlinear arithmetic, dense time, groups, and longer traces than N samples are not covered; a note says so.

examples:
  rtamt analyze examples/request_grant/spec.stl --samples 40
  rtamt analyze examples/requirements/lockheed_martin/finite_state_machine.stl --json
  rtamt analyze examples/request_grant/spec.stl --samples 40 --recordings examples/request_grant/b_vacuous.csv"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_specification_options(parser)
    parser.add_argument("more", metavar="SPEC", nargs="*", help="more specifications; a folder: those in it")
    add_time_option(parser)
    parser.add_argument(
        "--recordings",
        metavar="TRACE",
        nargs="+",
        default=[],
        help="recordings, of which one must trigger each implication",
    )
    add_analysis_options(parser)


def run(args: argparse.Namespace) -> int:
    """Analyse every specification."""
    recordings = {path: rtamt.read(path) for path in args.recordings}
    codes = [_analyze(name, args, recordings) for name in specification_paths([args.spec, *args.more])]
    return max(codes)


def _analyze(name: str, args: argparse.Namespace, recordings: Mapping[str, Any]) -> int:
    try:
        (spec,) = read_specifications(args, args.time, [name])
        found = analyze(spec, samples=args.samples, limit=args.limit, recordings=recordings)
    except NotCoveredError as error:
        complain(f"{name}: {error.message}")
    except CommandError as error:
        complain(error)
    except StlError as error:
        complain(f"{name}: {error}")
    else:
        return show(name, found, args)
    return ERROR
