"""``rtamt compile``: compile a requirement to a program that runs without Python."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.cli.command import (
    add_specification_options,
    add_time_option,
    add_worst_case_option,
    read_specification,
    write_output,
)
from rtamt.cli.parser import OK
from rtamt.cli.terminal import say
from rtamt.errors import UsageError
from rtamt.verdicts.modes import DELAYED, MODES

if TYPE_CHECKING:
    import argparse

    from rtamt.specification import Specification

#: The modes for which there are programs of one monitor.
_OF_ONE_MONITOR = (DELAYED, "interval")

_DESCRIPTION = """\
Compile a requirement to a program, which the C library of this package runs without Python.
Its outputs are the robustness and the verdict; the parameters and
named constants of the requirement are its parameters."""

_EPILOG = """\
docs/reference/program.md describes the format, and rtamt/c_api/rtamt.h the C functions that run it.
'rtamt info FILE' lists the contents of a program.

examples:
  rtamt compile "always[0:10]((req >= 3) -> eventually[0:500ms](gnt >= 3))" --period 100ms --dump
  rtamt compile "once[0:2](x >= 3)" --time dense --dump -o build/once.rtamt
  rtamt compile "always[0:2](x >= 3)" --fleet --verdict eager -o build/fleet.rtamt"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_specification_options(parser)
    add_time_option(parser)
    parser.add_argument(
        "--verdict",
        choices=tuple(MODES),
        default=DELAYED,
        help="delayed: robustness and verdict of every sample, one horizon later; interval: bounds and verdict at the "
        "start of the trace, valid for every continuation; eager and causation: with --fleet (default: delayed)",
    )
    add_worst_case_option(parser)
    parser.add_argument(
        "--fleet",
        action="store_true",
        help="for fleets, which monitor many keys: what rtamt_fleet_create runs, in every --verdict mode",
    )
    parser.add_argument("-o", "--output", metavar="FILE", help="the file to write, such as spec.rtamt")
    parser.add_argument("--dump", action="store_true", help="list the instructions")


def run(args: argparse.Namespace) -> int:
    """Write the program, list it, or both."""
    if args.output is None and not args.dump:
        raise UsageError("nothing to do: give -o FILE to write the program, or --dump to list it")
    spec = read_specification(args, args.time)
    if args.fleet:
        return _write_fleet(args, spec)
    if args.verdict not in _OF_ONE_MONITOR:
        raise UsageError(f"--verdict {args.verdict} is compiled for fleets; add --fleet")
    program = spec.compile(verdict=args.verdict, worst_case=args.worst_case)
    if args.output is not None:
        code = program.to_bytes()
        write_output(args.output, code)
        say(
            f"{args.output}: {len(program.instructions)} instructions, {len(code)} bytes, {program.domain.name} time"
        )
    if args.dump:
        say(program.disassemble())
    return OK


def _write_fleet(args: argparse.Namespace, spec: Specification) -> int:
    """Write the program of a fleet."""
    from rtamt.fleet.fleet import Fleet  # with all monitors, which other programs do not need

    if args.dump or args.worst_case:
        option = "--dump" if args.dump else "--worst-case"
        raise UsageError(f"{option} is for programs of one monitor; leave it or --fleet out")
    code = Fleet(spec, 1, verdict=args.verdict).compile()
    write_output(args.output, code)
    say(f"{args.output}: a fleet, {len(code)} bytes, {args.time} time, {args.verdict} verdicts")
    return OK
