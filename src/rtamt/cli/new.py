"""``rtamt new``: write a specification file from a pattern."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

from rtamt.cli.command import CommandError, write_output
from rtamt.cli.parser import OK
from rtamt.cli.terminal import say, table
from rtamt.patterns import find_pattern, patterns, specification_of

if TYPE_CHECKING:
    import argparse

    from rtamt.patterns import Pattern

_DESCRIPTION = """\
Write a specification file that requires a pattern of the library, with the English sentence as its text. The command
prompts for omitted arguments. Without PATTERN, it lists the patterns.

Exit code: 0 written, 2 error."""

_EPILOG = """\
The patterns are the templates of patterns.stl and signals.stl; the list shows what each requires. Formulas and
durations are written as in specification files. Without -o, the specification is printed, unless the command has
prompted for arguments.

examples:
  rtamt new response_within "p=speed > 2" s=locked duration=1s
  rtamt new stays x=speed low=0 high=50 --id SPEED-1"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    parser.add_argument("pattern", metavar="PATTERN", nargs="?", help="a pattern, such as response_within")
    parser.add_argument(
        "arguments",
        metavar="NAME=TEXT",
        nargs="*",
        help="a parameter of the pattern: a formula, number or duration",
    )
    parser.add_argument(
        "--id", default="REQ-1", metavar="ID", help="the name of the requirement (default: REQ-1)"
    )
    parser.add_argument("-o", "--output", metavar="FILE", help="the file to write; it must not exist")


def run(args: argparse.Namespace) -> int:
    """Ask for what is missing, and write the specification."""
    pattern = _choose() if args.pattern is None else find_pattern(args.pattern)
    arguments = _arguments(args.arguments)
    missing = [name for name in pattern.parameters if name not in arguments]
    if missing:
        say(f"{pattern.signature}: {pattern.sentence}")
    for name in missing:
        arguments[name] = _answer(name)
    text = specification_of(pattern, arguments, args.id)
    path = args.output
    if path is None and missing:
        path = _answer(f"file [{pattern.name}.stl]") or f"{pattern.name}.stl"
    if path is None:
        say(text.rstrip(), exact=True)
        return OK
    if os.path.exists(path):
        raise CommandError(f"'{path}' exists; choose another name with -o")
    write_output(path, text)
    say(f"{path}: {pattern.described(arguments)}")
    return OK


def _choose() -> Pattern:
    """List the patterns, and ask for one."""
    say(table([("pattern", "requires"), *((each.signature, each.sentence) for each in patterns().values())]))
    return find_pattern(_answer("pattern"))


def _answer(what: str) -> str:
    """Ask for one line."""
    say(f"{what}: ", flush=True)
    line = sys.stdin.readline()
    if not line:
        raise CommandError(
            f"there is no answer for '{what}'; give it on the command line, see 'rtamt new --help'"
        )
    return line.strip()


def _arguments(given: list[str]) -> dict[str, str]:
    """Read ``NAME=TEXT``."""
    found: dict[str, str] = {}
    for text in given:
        name, sign, value = text.partition("=")
        if not sign or not name.isidentifier():
            raise CommandError(f"'{text}' is no argument of a pattern; write NAME=TEXT, such as p='x > 3'")
        if name in found:
            raise CommandError(f"'{name}' is given twice")
        found[name] = value
    return found
