"""``rtamt fmu``: export a requirement as an FMU."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from rtamt import fmi
from rtamt.cli.command import (
    add_specification_options,
    add_time_option,
    add_verdict_option,
    add_worst_case_option,
    read_specification,
)
from rtamt.cli.parser import OK
from rtamt.cli.terminal import say

if TYPE_CHECKING:
    import argparse

_DESCRIPTION = """\
Export the monitor of a requirement as a Functional Mock-up Unit (FMU) for co-simulation, which Simulink, Dymola,
OpenModelica and fmpy import. The FMU needs neither Python nor a compiler."""

_EPILOG = """\
The variables of the requirement are inputs; robustness, verdict, known and known_since are outputs;
parameters and named constants are parameters. docs/how-to/fmi.md describes how communication steps become samples.

examples:
  rtamt fmu "(req >= 3) -> eventually[0:50ms](gnt >= 3)" -o build/response.fmu --period 10ms
  rtamt fmu "historically(x <= 3)" -o build/limit.fmu --fmi 3"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_specification_options(parser)
    add_time_option(parser)
    add_verdict_option(parser)
    add_worst_case_option(parser)
    parser.add_argument("-o", "--output", metavar="FILE", required=True, help="the FMU to write, FILE.fmu")
    parser.add_argument(
        "--fmi", type=int, choices=(2, 3), default=2, help="the version: FMI 2.0 or 3.0 (default: 2)"
    )


def run(args: argparse.Namespace) -> int:
    """Write the FMU."""
    fmi.export(
        read_specification(args, args.time),
        args.output,
        version=args.fmi,
        verdict=args.verdict,
        worst_case=args.worst_case,
    )
    say(f"{args.output}: FMI {args.fmi}.0, co-simulation, {Path(args.output).stat().st_size / 1024:.0f} KiB")
    return OK
