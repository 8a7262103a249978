"""``rtamt compile``: compile a requirement to a program that runs without Python."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.cli.command import (
    add_specification_options,
    add_time_option,
    add_verdict_option,
    add_worst_case_option,
    read_specification,
    write_output,
)
from rtamt.cli.parser import OK
from rtamt.cli.terminal import say
from rtamt.errors import UsageError

if TYPE_CHECKING:
    import argparse

_DESCRIPTION = """\
Compile a requirement to a program, which the C library of this package runs without Python.
Its outputs are the robustness and the verdict; the parameters and
named constants of the requirement are its parameters."""

_EPILOG = """\
docs/reference/program.md describes the format, and rtamt/c_api/rtamt.h the C functions that run it.
'rtamt info FILE' lists the contents of a program.

examples:
  rtamt compile "always[0:10]((req >= 3) -> eventually[0:500ms](gnt >= 3))" --period 100ms --dump
  rtamt compile "once[0:2](x >= 3)" --time dense --dump -o build/once.rtamt"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_specification_options(parser)
    add_time_option(parser)
    add_verdict_option(parser)
    add_worst_case_option(parser)
    parser.add_argument("-o", "--output", metavar="FILE", help="the file to write, such as spec.rtamt")
    parser.add_argument("--dump", action="store_true", help="list the instructions")


def run(args: argparse.Namespace) -> int:
    """Write the program, list it, or both."""
    if args.output is None and not args.dump:
        raise UsageError("nothing to do: give -o FILE to write the program, or --dump to list it")
    spec = read_specification(args, args.time)
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
